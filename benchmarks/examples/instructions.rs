//! Instructions that each kernel takes, counted by callgrind: the same on a busy machine and on an idle one.
//!
//! ```text
//! cargo run --release -p nlmodes-benchmarks --example instructions               counts all kernels beside those on file
//! cargo run --release -p nlmodes-benchmarks --example instructions -- --check    the same; status 1 if one became worse by more than 5 %
//! cargo run --release -p nlmodes-benchmarks --example instructions -- --write    keeps the counts in benchmarks/instructions.toml
//! cargo run --release -p nlmodes-benchmarks --example instructions -- --scaling  a point over its modes and its harmonics, as tables
//! cargo run --release -p nlmodes-benchmarks --example instructions -- --profile  also the functions that a kernel spends its time in
//! ```
//!
//! Parts of kernels' names behind the option select kernels. Needs `valgrind`. The counts depend on the compiler and on
//! the processor: those of another one are shown, and none counts as worse. Without `--release` the counts are others,
//! kept in benchmarks/instructions_dev.toml as they come out with the build settings of `.ci/run`, which checks them.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

use nlmodes_benchmarks::Failure;
use nlmodes_benchmarks::kernels::{KERNELS, Kernel, corrector_step, residual};
use serde::{Deserialize, Serialize};

/// Growth that counts as a change for the worse: what a compiler inlines in one function hangs on its neighbours.
const TOLERANCE: f64 = 0.05;

/// What stands in the file.
#[derive(Debug, Default, Serialize, Deserialize)]
struct Counts {
    /// Compiler and processor that they come from.
    made_with: String,
    instructions: BTreeMap<String, u64>,
}

fn main() -> ExitCode {
    match run(&std::env::args().skip(1).collect::<Vec<_>>()) {
        Ok(status) => status,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(2)
        }
    }
}

fn run(arguments: &[String]) -> Result<ExitCode, Failure> {
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words.as_slice() {
        ["--kernel", name] => run_counted(name),
        ["--scaling"] => scaling(),
        [] => compare(&[], false),
        ["--check", rest @ ..] => compare(rest, true),
        ["--write"] => write(),
        ["--profile", rest @ ..] => profile(rest),
        _ => Err(format!("unknown arguments {words:?}; expected --check, --write, --scaling or --profile").into()),
    }
}

/// The kernel of that name, run under callgrind by this program.
fn run_counted(name: &str) -> Result<ExitCode, Failure> {
    let mut kernel = prepare(name)?;
    // Work space and closed sets are there from the second run on.
    (0..RUNS).for_each(|_| kernel());
    counted(&mut kernel);
    Ok(ExitCode::SUCCESS)
}

fn prepare(name: &str) -> Result<Kernel, Failure> {
    if let Some((_, prepare)) = KERNELS.iter().find(|(known, _)| *known == name) {
        return prepare();
    }
    match name.split(' ').collect::<Vec<_>>().as_slice() {
        ["residual", modes, harmonics] => residual(modes.parse()?, harmonics.parse()?),
        ["step", modes, harmonics] => corrector_step(modes.parse()?, harmonics.parse()?),
        _ => Err(format!("no kernel {name:?}").into()),
    }
}

/// Runs that are counted together.
const RUNS: u64 = 2;

/// Callgrind counts while this function runs.
#[inline(never)]
fn counted(kernel: &mut Kernel) {
    for _ in 0..RUNS {
        kernel();
    }
}

/// Instructions of one run.
fn count(name: &str, out: &Path) -> Result<u64, Failure> {
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--collect-atstart=no", "--toggle-collect=instructions::counted*"])
        .arg(format!("--callgrind-out-file={}", out.display()))
        .arg(std::env::current_exe()?)
        .args(["--kernel", name])
        .output()
        .map_err(|error| format!("valgrind does not run: {error}"))?;
    let text = String::from_utf8_lossy(&output.stderr);
    let collected = text.lines().find_map(|line| line.split("Collected :").nth(1)?.trim().parse::<u64>().ok());
    match collected {
        Some(instructions) if output.status.success() && instructions > 0 => Ok(instructions / RUNS),
        _ => Err(format!("callgrind counted nothing for {name:?}:\n{text}").into()),
    }
}

fn nowhere() -> &'static Path {
    Path::new("/dev/null")
}

fn file() -> PathBuf {
    let name = if cfg!(debug_assertions) { "instructions_dev.toml" } else { "instructions.toml" };
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

/// Names of the kernels with one of these parts, of all where there is none.
fn selected<'a>(parts: &'a [&str]) -> impl Iterator<Item = &'static str> + 'a {
    let names = KERNELS.iter().map(|(name, _)| *name);
    names.filter(move |name| parts.is_empty() || parts.iter().any(|part| name.contains(part)))
}

fn compare(parts: &[&str], strict: bool) -> Result<ExitCode, Failure> {
    let kept: Counts = match std::fs::read_to_string(file()) {
        Ok(text) => toml::from_str(&text)?,
        Err(_) => Counts::default(),
    };
    let comparable = kept.made_with == made_with()?;
    if !kept.made_with.is_empty() && !comparable {
        println!("The counts on file were made with {}, these with {}.\n", kept.made_with, made_with()?);
    }
    println!("| kernel | instructions | on file | change |\n| --- | ---: | ---: | ---: |");
    let mut worse = Vec::new();
    for name in selected(parts) {
        let now = count(name, nowhere())?;
        let Some(&before) = kept.instructions.get(name) else {
            println!("| {name} | {now} | | |");
            continue;
        };
        let change = now as f64 / before as f64 - 1.0;
        println!("| {name} | {now} | {before} | {:+.2} % |", 100.0 * change);
        if comparable && change > TOLERANCE {
            worse.push(name);
        }
    }
    if worse.is_empty() {
        return Ok(ExitCode::SUCCESS);
    }
    println!("\nMore than {} % worse: {}.", 100.0 * TOLERANCE, worse.join("; "));
    Ok(if strict { ExitCode::FAILURE } else { ExitCode::SUCCESS })
}

fn write() -> Result<ExitCode, Failure> {
    let mut counts = Counts { made_with: made_with()?, ..Counts::default() };
    for (name, _) in KERNELS {
        counts.instructions.insert(name.to_owned(), count(name, nowhere())?);
    }
    let profile = if cfg!(debug_assertions) { "" } else { "--release " };
    let command = format!("cargo run {profile}-p nlmodes-benchmarks --example instructions -- --write");
    let head = format!("# Instructions of one run of each kernel, by `{command}`.\n");
    std::fs::write(file(), format!("{head}{}", toml::to_string(&counts)?))?;
    compare(&[], false)
}

/// Instruction sets for which kernels have code of their own.
const VECTORS: [&str; 3] = ["avx2", "fma", "avx512f"];

/// Compiler and processor: by the latter's instruction sets and caches the kernels choose their code and blocks at run
/// time.
fn made_with() -> Result<String, Failure> {
    let output = Command::new("rustc").arg("--version").output()?;
    let known = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let of =
        |name: &str| known.lines().find_map(|line| line.strip_prefix(name)?.split_once(": ").map(|(_, value)| value));
    let sets: Vec<&str> = of("flags").unwrap_or_default().split(' ').filter(|set| VECTORS.contains(set)).collect();
    let processor = of("model name").unwrap_or(std::env::consts::ARCH);
    Ok(format!("{}, {processor}, {}", String::from_utf8(output.stdout)?.trim(), sets.join(" ")))
}

/// Where the instructions of the kernels go.
fn profile(parts: &[&str]) -> Result<ExitCode, Failure> {
    for name in selected(parts) {
        let out = std::env::temp_dir().join(format!("callgrind.{}", std::process::id()));
        println!("## {name}: {} instructions\n", count(name, &out)?);
        let listing = Command::new("callgrind_annotate").arg(&out).output()?;
        std::fs::remove_file(&out)?;
        String::from_utf8_lossy(&listing.stdout)
            .lines()
            .skip_while(|line| !line.contains("file:function"))
            .take(30)
            .for_each(|line| println!("{line}"));
        println!();
    }
    Ok(ExitCode::SUCCESS)
}

/// Residual and Newton step over the number of modes, and over that of harmonics.
fn scaling() -> Result<ExitCode, Failure> {
    let powers = |from: u32, to: u32| (from..=to).map(|k| 1_usize << k);
    let table = |title: &str, first: &str, cases: Vec<(usize, usize, usize)>| -> Result<(), Failure> {
        println!("### {title}\n\n| {first} | residual and Jacobian | Newton step | residual / {first} |");
        println!("| ---: | ---: | ---: | ---: |");
        for (shown, modes, harmonics) in cases {
            let [residual, step] =
                ["residual", "step"].map(|kind| count(&format!("{kind} {modes} {harmonics}"), nowhere()));
            let (residual, step) = (residual?, step?);
            println!("| {shown} | {residual} | {step} | {} |", residual / shown as u64);
        }
        println!();
        Ok(())
    };
    table("20 harmonics", "modes", powers(3, 9).map(|modes| (modes, modes, 20)).collect())?;
    table("99 modes", "harmonics", powers(0, 8).map(|harmonics| (harmonics, 99, harmonics)).collect())?;
    Ok(ExitCode::SUCCESS)
}
