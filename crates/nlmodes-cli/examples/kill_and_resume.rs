//! Kills runs of `nlmodes-cli` at random instants, checks their files, resumes them, and compares with an uninterrupted
//! run.
//!
//! ```text
//! cargo run -p nlmodes-cli --example kill_and_resume -- configs/rod.toml --kills 100 --set method.harmonics=5
//! ```

use std::error::Error;
use std::fs;
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitCode, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use npyz::npz::NpzArchive;

type Outcome<T = ()> = Result<T, Box<dyn Error>>;

/// The call, and the number of kills.
struct Arguments {
    kills: usize,
    seed: u64,
    /// Everything else goes to `nlmodes-cli run`.
    call: Vec<String>,
}

/// Results of the kills.
#[derive(Default)]
struct Figures {
    kills: usize,
    /// Runs that had finished before the kill.
    too_late: usize,
    before_first_point: usize,
    /// Largest number of points that were reported as found but missing in the table.
    lost: usize,
    /// Points in the table that the resumed run had to compute again: maximum, and total.
    again: (usize, usize),
    torn: usize,
    files: usize,
    resumed: usize,
}

fn main() -> ExitCode {
    match arguments().and_then(|arguments| run(&arguments)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn arguments() -> Outcome<Arguments> {
    let mut found = Arguments { kills: 100, seed: 1, call: Vec::new() };
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        match word.as_str() {
            "--kills" => found.kills = words.next().ok_or("--kills needs a number")?.parse()?,
            "--seed" => found.seed = words.next().ok_or("--seed needs a number")?.parse()?,
            _ => found.call.push(word),
        }
    }
    if found.call.is_empty() {
        found.call.push("configs/rod.toml".into());
    }
    Ok(found)
}

fn run(arguments: &Arguments) -> Outcome {
    let folder = tempfile::tempdir()?;
    let whole = folder.path().join("whole");
    let began = Instant::now();
    let status = start(&arguments.call, &whole)?.0.wait()?;
    let time = began.elapsed();
    let expected = tables(&whole)?;
    let points: usize = expected.iter().map(|(_, text)| rows(text)).sum();
    println!("not killed: {points} points in {:.2} s, {status}", time.as_secs_f64());
    let mut random = Random(arguments.seed);
    let mut figures = Figures::default();
    while figures.kills < arguments.kills {
        let directory = folder.path().join("killed");
        // The resumed run is killed as well in half of the cases.
        loop {
            let wait = time.mul_f64(1.05 * random.next());
            kill_once(&arguments.call, &directory, wait, &expected, &mut figures)?;
            if random.next() < 0.5 || figures.kills >= arguments.kills {
                break;
            }
        }
        let (mut child, _, said) = start(&arguments.call, &directory)?;
        let ended = child.wait()?;
        figures.resumed += 1;
        if ended.code() != status.code() {
            return Err(format!("the run that went on ended with {ended}: {}", said.join().unwrap_or_default()).into());
        }
        if tables(&directory)? != expected {
            return Err(format!("another branch after kill {}", figures.kills).into());
        }
        if coefficients(&directory)? != coefficients(&whole)? {
            return Err(format!("other coefficients after kill {}", figures.kills).into());
        }
        fs::remove_dir_all(&directory)?;
    }
    tell(&figures, points);
    if figures.lost > 0 { Err("points were lost".into()) } else { Ok(()) }
}

fn tell(figures: &Figures, points: usize) {
    let Figures { kills, too_late, before_first_point, lost, again, torn, files, resumed } = figures;
    println!("{kills} kills, {before_first_point} before the first point; {too_late} more came too late");
    println!("points found but not in the table: at most {lost} of {points}");
    println!("points in the table that were computed again: at most {}, {} in all", again.0, again.1);
    println!("last lines torn: {torn}; files read after the kills: {files}, unreadable: 0");
    println!(
        "runs that went on to the end: {resumed}, all with the table and the coefficients of the run that was not \
            killed"
    );
}

type Said = thread::JoinHandle<String>;

/// A run, the points that it reports, and its other output.
fn start(call: &[String], directory: &Path) -> Outcome<(Child, Arc<AtomicUsize>, Said)> {
    let mut child = Command::new(program()?)
        .arg("run")
        .args(call)
        .args(["--resume", "--verbose", "--out"])
        .arg(directory)
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()?;
    let (found, stderr) = (Arc::new(AtomicUsize::new(0)), child.stderr.take().ok_or("no standard error")?);
    let count = Arc::clone(&found);
    let said = thread::spawn(move || {
        let (mut rest, mut last) = (String::new(), None);
        let number = |line: &str| -> Option<usize> {
            let digits = line.split("point ").nth(1)?;
            digits.split([':', ',']).next()?.parse().ok()
        };
        for line in BufReader::new(stderr).lines().map_while(Result::ok) {
            if line.contains("point ") && line.contains(" residual ") {
                let found = number(&line);
                // A branch in both directions reports its start twice.
                if found > last {
                    count.fetch_add(1, Ordering::SeqCst);
                }
                last = found.max(last);
            } else if let (true, Some(kept)) = (line.starts_with("back to point"), number(&line)) {
                // An internal resonance is skipped, or the number of harmonics is changed some points earlier: those
                // points do not count, whether of this run or of the previous one.
                let withdrawn = last.map_or(0, |last: usize| (last + 1).saturating_sub(kept));
                count.store(count.load(Ordering::SeqCst).saturating_sub(withdrawn), Ordering::SeqCst);
                last = kept.checked_sub(1);
            } else {
                if line.starts_with("part ") {
                    last = None;
                }
                rest += &format!("{line}\n");
            }
        }
        rest
    });
    Ok((child, found, said))
}

/// The program in the same directory.
fn program() -> Outcome<PathBuf> {
    let own = std::env::current_exe()?;
    let folder = own.parent().and_then(Path::parent).ok_or("this program lies in no folder")?;
    let program = folder.join("nlmodes-cli");
    if program.is_file() { Ok(program) } else { Err(format!("{} is not built", program.display()).into()) }
}

fn kill_once(
    call: &[String],
    directory: &Path,
    wait: Duration,
    expected: &[(PathBuf, String)],
    figures: &mut Figures,
) -> Outcome {
    let before: usize = tables(directory)?.iter().map(|(_, text)| rows(text)).sum();
    let (mut child, found, said) = start(call, directory)?;
    thread::sleep(wait);
    if child.try_wait()?.is_some() {
        figures.too_late += 1;
        return Ok(());
    }
    child.kill()?;
    child.wait()?;
    figures.kills += 1;
    let rest = said.join().map_err(|_| "the reader of standard error failed")?;
    if rest.contains("error") {
        return Err(rest.into());
    }
    let new = found.load(Ordering::SeqCst);
    let mut total = 0;
    for (name, text) in tables(directory)? {
        let whole = text.rfind('\n').map_or("", |end| &text[..=end]);
        figures.torn += usize::from(whole.len() < text.len());
        let (_, reference) = expected.iter().find(|(known, _)| *known == name).ok_or("a table too many")?;
        if !reference.starts_with(whole) && !withdraws(call) && !call.iter().any(|word| word.contains("both")) {
            return Err(format!("{} is not the beginning of the table of the whole run", name.display()).into());
        }
        total += rows(whole);
    }
    if total == 0 {
        figures.before_first_point += 1;
    }
    // Points reported again are those that an earlier kill had left in the table but not in the steps.
    let fewer = if withdraws(call) { 0 } else { before.saturating_sub(total) };
    let lost = fewer.max(new.saturating_sub(total));
    figures.lost = figures.lost.max(lost);
    let kept = steps(directory, figures)?;
    let again = total.saturating_sub(kept);
    figures.again = (figures.again.0.max(again), figures.again.1 + again);
    read_all(directory, figures)
}

/// Whether points can be withdrawn: those on internal-resonance branches that are skipped, and those at which
/// `accuracy` changes the number of harmonics, as set by the scene or the call.
fn withdraws(call: &[String]) -> bool {
    let says = |text: &str| {
        let keys = text.lines().filter(|line| !line.trim_start().starts_with('#'));
        keys.into_iter().any(|line| line.contains("\"skip\"") || line.contains("=skip") || line.contains("accuracy"))
    };
    call.iter().any(|word| says(word) || fs::read_to_string(word).is_ok_and(|scene| says(&scene)))
}

/// Points in the steps on disk, from which a run continues.
fn steps(directory: &Path, figures: &mut Figures) -> Outcome<usize> {
    let mut points = 0;
    for path in files(directory)?.into_iter().filter(|path| path.ends_with("steps.jsonl")) {
        let text = fs::read_to_string(path)?;
        for line in text.split_inclusive('\n') {
            if !line.ends_with('\n') {
                figures.torn += 1;
                continue;
            }
            let line: serde_json::Value = serde_json::from_str(line)?;
            points += line["step"]["points"].as_array().map_or(0, Vec::len);
        }
    }
    Ok(points)
}

/// Every file must be readable.
fn read_all(directory: &Path, figures: &mut Figures) -> Outcome {
    for path in files(directory)? {
        let unreadable = |why: &dyn std::fmt::Display| format!("{} is unreadable: {why}", path.display());
        let mut text = String::new();
        match path.extension().unwrap_or_default().to_str().unwrap_or_default() {
            "tmp" | "jsonl" => continue,
            "npz" => drop(NpzArchive::open(&path).map_err(|error| unreadable(&error))?.by_name("omega")?),
            "json" => {
                let bytes = fs::read(&path)?;
                drop(serde_json::from_slice::<serde_json::Value>(&bytes).map_err(|error| unreadable(&error))?);
            }
            extension => {
                fs::File::open(&path)?.read_to_string(&mut text)?;
                let end = match extension {
                    "svg" => "</svg>",
                    "html" => "</html>",
                    _ => "",
                };
                if !text.trim_end().ends_with(end) {
                    return Err(unreadable(&"it is cut off").into());
                }
            }
        }
        figures.files += 1;
    }
    Ok(())
}

/// The tables of a run by their names.
fn tables(directory: &Path) -> Outcome<Vec<(PathBuf, String)>> {
    let mut found = Vec::new();
    for path in files(directory)?.into_iter().filter(|path| path.ends_with("branch.csv")) {
        found.push((path.strip_prefix(directory)?.to_path_buf(), fs::read_to_string(&path)?));
    }
    found.sort();
    Ok(found)
}

/// The arrays of all archives; the archives themselves contain the time of writing.
fn coefficients(directory: &Path) -> Outcome<Vec<(PathBuf, Vec<u8>)>> {
    let mut found = Vec::new();
    for path in files(directory)?.into_iter().filter(|path| path.ends_with("harmonics.npz")) {
        let mut archive = NpzArchive::open(&path)?;
        let names: Vec<String> = archive.array_names().map(str::to_owned).collect();
        for name in names {
            let mut bytes = Vec::new();
            archive.zip_archive().by_name(&format!("{name}.npy"))?.read_to_end(&mut bytes)?;
            found.push((path.strip_prefix(directory)?.join(name), bytes));
        }
    }
    found.sort();
    Ok(found)
}

fn rows(text: &str) -> usize {
    text.lines().count().saturating_sub(1)
}

fn files(directory: &Path) -> Outcome<Vec<PathBuf>> {
    let mut found = Vec::new();
    let Ok(entries) = fs::read_dir(directory) else { return Ok(found) };
    for entry in entries {
        let path = entry?.path();
        if path.is_dir() { found.extend(files(&path)?) } else { found.push(path) }
    }
    Ok(found)
}

/// SplitMix64 (Steele, Lea, Flood 2014), between 0 and 1.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut x = self.0;
        x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((x ^ (x >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}
