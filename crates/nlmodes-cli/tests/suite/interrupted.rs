//! Runs that end early keep their results, and continue from there; results of another scene are not touched.

use std::error::Error;
use std::fs;
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};

use npyz::npz::NpzArchive;
use serde_json::Value;
use tempfile::tempdir;

type Outcome<T = ()> = Result<T, Box<dyn Error>>;

/// A branch of 157 points that takes about a second; its stability would be known at the end of a run only.
const ROD: [&str; 9] = [
    "run",
    "configs/rod.toml",
    "--set",
    "structure.elements=20",
    "--set",
    "method.harmonics=12",
    "--set",
    "output.stability=\"never\"",
    "--verbose",
];

fn program() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_nlmodes-cli"));
    command.current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("../.."));
    command
}

/// Runs the rod to its end.
fn rod(out: &Path, more: &[&str]) -> Outcome<Output> {
    Ok(program().args(ROD).arg("--out").arg(out).args(more).output()?)
}

/// The table of an uninterrupted run.
fn whole(folder: &Path, more: &[&str]) -> Outcome<String> {
    let out = folder.join("whole");
    let output = rod(&out, more)?;
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    table(&out)
}

fn table(out: &Path) -> Outcome<String> {
    Ok(fs::read_to_string(out.join("branch.csv"))?)
}

/// Whether the rows of a table are the first ones of the whole, but for `stress_pa` and `stress_at`, its last columns,
/// which are known at the end of a run.
fn begins(whole: &str, table: &str) -> bool {
    let rows = |table: &str| -> Vec<Option<String>> {
        table.lines().map(|line| line.rsplitn(3, ',').nth(2).map(str::to_owned)).collect()
    };
    rows(whole).starts_with(&rows(table))
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn summary(out: &Path) -> Outcome<Value> {
    Ok(serde_json::from_str(&fs::read_to_string(out.join("summary.json"))?)?)
}

/// Starts the rod and waits until it has reported this many points.
fn started(out: &Path, more: &[&str], points: usize) -> Outcome<Child> {
    let mut call = program();
    call.args(ROD).arg("--out").arg(out).args(more).stdout(Stdio::null()).stderr(Stdio::piped());
    let mut child = call.spawn()?;
    let stderr = child.stderr.as_mut().ok_or("no standard error")?;
    let lines = BufReader::with_capacity(1, stderr).lines().map_while(Result::ok);
    assert_eq!(lines.filter(|line| line.contains("residual")).take(points).count(), points);
    Ok(child)
}

/// The coefficients of all points; the archive itself contains the time of writing.
fn coefficients(out: &Path) -> Outcome<Vec<u8>> {
    let (mut archive, mut bytes) = (NpzArchive::open(out.join("harmonics.npz"))?, Vec::new());
    archive.zip_archive().by_name("coefficients.npy")?.read_to_end(&mut bytes)?;
    Ok(bytes)
}

fn rows(table: &str) -> usize {
    table.lines().count() - 1
}

#[test]
fn a_run_that_is_killed_keeps_its_points_and_goes_on() -> Outcome {
    let folder = tempdir()?;
    let expected = whole(folder.path(), &[])?;
    let out = folder.path().join("killed");
    // Twice during the run; the second run continues from the results of the first.
    for points in [25, 20] {
        let before = table(&out).map_or(0, |table| rows(&table));
        let mut child = started(&out, &["--resume"], points)?;
        child.kill()?;
        child.wait()?;
        let left = table(&out)?;
        assert!(begins(&expected, &left), "{left}");
        assert!(rows(&left) >= points.max(before), "{} rows", rows(&left));
    }
    // A line that was being written when the power failed.
    let steps = out.join("steps.jsonl");
    let text = fs::read_to_string(&steps)?;
    fs::write(&steps, format!("{text}{{\"step\":{{\"points\":[{{\"x\":[1.0"))?;
    let output = rod(&out, &["--resume"])?;
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    assert!(said(&output).contains("were taken over"), "{}", said(&output));
    assert_eq!(table(&out)?, expected);
    assert!(coefficients(&out)? == coefficients(&folder.path().join("whole"))?);
    assert!(fs::read_dir(&out)?.flatten().all(|file| !file.file_name().to_string_lossy().ends_with(".tmp")));
    Ok(())
}

#[cfg(unix)]
#[test]
fn ctrl_c_ends_with_summary_and_figures_and_the_run_goes_on_later() -> Outcome {
    let folder = tempdir()?;
    let (expected, out) = (whole(folder.path(), &[])?, folder.path().join("stopped"));
    let mut child = started(&out, &[], 15)?;
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status()?.success());
    assert_eq!(child.wait()?.code(), Some(1));
    let found = summary(&out)?;
    assert_eq!(found["end"]["reason"], "stopped");
    assert_eq!(found["points"], rows(&table(&out)?));
    assert!(out.join("report.html").is_file() && out.join("frequency_energy.svg").is_file());
    let output = rod(&out, &["--resume"])?;
    assert_eq!((output.status.code(), table(&out)?), (Some(0), expected));
    assert_eq!(summary(&out)?["end"]["reason"], "max-energy");
    Ok(())
}

#[cfg(unix)]
#[test]
fn a_second_ctrl_c_ends_at_once_and_harms_nothing() -> Outcome {
    let folder = tempdir()?;
    let (expected, out) = (whole(folder.path(), &[])?, folder.path().join("stopped"));
    let interrupt = |child: &Child| -> Outcome {
        assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status()?.success());
        Ok(())
    };
    // The second one may come when the run has just ended by itself.
    for _ in 0..10 {
        let mut child = started(&out, &["--resume"], 15)?;
        interrupt(&child)?;
        let stderr = child.stderr.as_mut().ok_or("no standard error")?;
        let mut lines = BufReader::with_capacity(1, stderr).lines().map_while(Result::ok);
        assert!(lines.any(|line| line.starts_with("interrupted")));
        drop(interrupt(&child));
        let code = child.wait()?.code();
        assert!(begins(&expected, &table(&out)?));
        // The existing files are complete.
        if out.join("summary.json").is_file() {
            summary(&out)?;
        }
        if code == Some(130) {
            let output = rod(&out, &["--resume"])?;
            assert_eq!((output.status.code(), table(&out)?), (Some(0), expected));
            return Ok(());
        }
        assert_eq!(code, Some(1));
        fs::remove_dir_all(&out)?;
    }
    Err("no run ended at the second Ctrl-C".into())
}

#[test]
fn beginning_anew_over_an_interrupted_run_is_said() -> Outcome {
    let folder = tempdir()?;
    let out = folder.path().join("killed");
    let mut child = started(&out, &[], 10)?;
    child.kill()?;
    child.wait()?;
    let output = rod(&out, &["--set", "continuation.max_points=12"])?;
    assert_eq!(output.status.code(), Some(2), "{}", said(&output));
    let output = rod(&out, &[])?;
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let first = said(&output);
    let warning = first.lines().next().unwrap_or_default();
    assert!(warning.starts_with("warning") && warning.contains("an interrupted run") && warning.contains("--resume"));
    // A complete run is not an interrupted one, and a resumed run overwrites nothing.
    for more in [&["--resume"][..], &[]] {
        assert!(!said(&rod(&out, more)?).contains("an interrupted run of this scene"));
    }
    Ok(())
}

/// The numbers, the lengths or the meaning of a line in the middle are altered: from there on the branch is computed
/// again.
#[test]
fn steps_that_were_altered_do_not_count() -> Outcome {
    let folder = tempdir()?;
    let (expected, out) = (whole(folder.path(), &[])?, folder.path().join("whole"));
    let sound = fs::read_to_string(out.join("steps.jsonl"))?;
    let lines: Vec<&str> = sound.split_inclusive('\n').collect();
    let step: Value = serde_json::from_str(lines[lines.len() / 2])?;
    let altered = |change: &dyn Fn(&mut Value)| {
        let mut step = step.clone();
        change(&mut step["step"]);
        format!("{step}\n")
    };
    let half = lines.len() / 2;
    let changed = [
        altered(&|step| step["points"][0]["x"][0] = (step["points"][0]["x"][0].as_f64().unwrap_or(0.0) + 1e-3).into()),
        altered(&|step| step["points"][0]["p"] = 1e300.into()),
        altered(&|step| drop(step["points"][0]["x"].as_array_mut().and_then(Vec::pop))),
        altered(&|step| step["points"][0]["tangent"] = Value::Array(Vec::new())),
        altered(&|step| step["points"] = Value::Array(Vec::new())),
        altered(&|step| step["next"] = 0.0.into()),
        altered(&|step| step["evaluations"] = u64::MAX.into()),
    ];
    for line in changed {
        let text = [&lines[..half], &[line.as_str()], &lines[half + 1..]].concat().concat();
        fs::write(out.join("steps.jsonl"), text)?;
        let output = rod(&out, &["--resume"])?;
        assert_eq!((output.status.code(), table(&out)?), (Some(0), expected.clone()), "{line}");
        assert_eq!(fs::read_to_string(out.join("steps.jsonl"))?, sound, "{line}");
    }
    Ok(())
}

#[test]
fn more_points_may_be_asked_for_when_a_run_goes_on() -> Outcome {
    let folder = tempdir()?;
    let out = folder.path().join("few");
    let both = ["--set", "continuation.start_energy_ratio=1.5", "--set", "continuation.direction=both"];
    let few = [&both[..], &["--set", "continuation.max_points=7"]].concat();
    for set in [&["--set", "continuation.at_branch_point=all"][..], &both] {
        let (folder, out) = (tempdir()?, out.join(set.len().to_string()));
        let expected = whole(folder.path(), set)?;
        let few = if set.len() == 2 { [set, &["--set", "continuation.max_points=30"]].concat() } else { few.clone() };
        assert_eq!(rod(&out, &few)?.status.code(), Some(1));
        let output = rod(&out, &[set, &["--resume"]].concat())?;
        assert_eq!(output.status.code(), Some(0), "{}", said(&output));
        assert_eq!(table(&out)?, expected);
    }
    Ok(())
}

#[cfg(unix)]
#[test]
fn a_full_disk_is_said_and_what_was_found_is_kept() -> Outcome {
    let folder = tempdir()?;
    let (expected, out) = (whole(folder.path(), &[])?, folder.path().join("full"));
    // A file-size limit in blocks of 512 bytes represents a full disk.
    let call = format!("trap '' XFSZ; ulimit -f 60; exec {} \"$@\"", env!("CARGO_BIN_EXE_nlmodes-cli"));
    let output = Command::new("sh")
        .args(["-c", &call, "sh"])
        .args(ROD)
        .arg("--out")
        .arg(&out)
        .current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("../.."))
        .output()?;
    assert_eq!(output.status.code(), Some(1), "{}", said(&output));
    for part in ["cannot write", "steps.jsonl", "--resume"] {
        assert!(said(&output).contains(part), "{}", said(&output));
    }
    let left = table(&out)?;
    assert!(rows(&left) > 3 && begins(&expected, &left) && left != expected);
    assert_eq!(rod(&out, &["--resume"])?.status.code(), Some(0));
    assert_eq!(table(&out)?, expected);
    Ok(())
}

#[test]
fn a_directory_that_cannot_be_made_is_said() -> Outcome {
    let folder = tempdir()?;
    let file = folder.path().join("file");
    fs::write(&file, "")?;
    for command in [&["run", "configs/rod.toml"][..], &["experiment", "extract", "configs/measured_record.toml"]] {
        let output = program().args(command).arg("--quiet").arg("--out").arg(file.join("results")).output()?;
        assert_eq!(output.status.code(), Some(1), "{}", said(&output));
        assert!(said(&output).contains("cannot write") && said(&output).contains("expected a directory"));
    }
    Ok(())
}

#[test]
fn results_of_another_scene_are_left_alone() -> Outcome {
    let folder = tempdir()?;
    let out = folder.path().join("results");
    let run = |more: &[&str]| -> Outcome<Output> {
        let small = ["--set", "structure.elements=20", "--set", "continuation.max_energy_ratio=1.2"];
        Ok(program().args(["run", "configs/rod.toml", "--out"]).arg(&out).args(small).args(more).output()?)
    };
    assert_eq!(run(&[])?.status.code(), Some(0));
    let before = table(&out)?;
    // Also under another title.
    assert_eq!(run(&["--set", "title=\"The same\""])?.status.code(), Some(0));
    for more in [&["--set", "method.harmonics=2"][..], &["--set", "method.harmonics=2", "--resume"]] {
        let output = run(more)?;
        assert_eq!(output.status.code(), Some(2));
        for part in ["another scene", "method.harmonics: 3 there, 2 here", "--out", "--force"] {
            assert!(said(&output).contains(part), "{}", said(&output));
        }
        assert_eq!(table(&out)?, before);
    }
    assert_eq!(run(&["--set", "method.harmonics=[1,2]"])?.status.code(), Some(2));
    assert_eq!(run(&["--set", "method.harmonics=[1,2]", "--force"])?.status.code(), Some(0));
    assert!(!out.join("branch.csv").exists() && out.join("h2/branch.csv").exists());
    let scenes: Value = serde_json::from_str(&fs::read_to_string(out.join("run.json"))?)?;
    assert_eq!(scenes["scenes"][0]["structure"]["elements"], 20);
    Ok(())
}

#[test]
fn an_extraction_does_not_replace_other_results() -> Outcome {
    let folder = tempdir()?;
    let out = folder.path().join("measured");
    let extract = |more: &[&str]| -> Outcome<Output> {
        let call = ["experiment", "extract", "configs/measured_record.toml", "--quiet", "--out"];
        Ok(program().args(call).arg(&out).args(more).output()?)
    };
    assert_eq!((extract(&[])?.status.code(), extract(&[])?.status.code()), (Some(0), Some(0)));
    let other = ["--set", "extraction.harmonics=7"];
    assert_eq!(extract(&other)?.status.code(), Some(2));
    assert_eq!(extract(&[&other[..], &["--force"]].concat())?.status.code(), Some(0));
    Ok(())
}

#[test]
fn new_scenes_are_sound_and_are_never_written_over_a_file() -> Outcome {
    let folder = tempdir()?;
    for kind in ["rod", "beam", "virtual-test"] {
        let call = |arguments: &[&str]| program().current_dir(folder.path()).args(arguments).output();
        let file = format!("{kind}.toml");
        assert_eq!(call(&["new", kind])?.status.code(), Some(0));
        let checked = call(&["check", &file])?;
        assert_eq!((checked.status.code(), said(&checked).as_str()), (Some(0), ""), "{kind}");
        let text = fs::read_to_string(folder.path().join(&file))?;
        let again = call(&["new", kind])?;
        assert_eq!(again.status.code(), Some(2));
        assert!(said(&again).contains("left alone"), "{}", said(&again));
        assert_eq!(fs::read_to_string(folder.path().join(&file))?, text);
        // Defaults and template agree: each commented key is one of the schema.
        assert!(text.lines().filter(|line| line.contains('#')).count() > 20);
    }
    Ok(())
}

#[test]
fn new_scenes_run_to_their_ends() -> Outcome {
    let folder = tempdir()?;
    for kind in ["rod", "beam", "virtual-test"] {
        let call = |arguments: &[&str]| program().current_dir(folder.path()).args(arguments).output();
        assert_eq!(call(&["new", kind])?.status.code(), Some(0));
        let output = call(&["run", &format!("{kind}.toml"), "--quiet"])?;
        assert_eq!((output.status.code(), said(&output).as_str()), (Some(0), ""), "{kind}");
    }
    Ok(())
}

/// Linear modes of many elements take long, and so does the search for a backbone: before the first point nothing is
/// lost, and the program ends at once.
#[cfg(unix)]
#[test]
fn before_the_first_point_ctrl_c_ends_at_once() -> Outcome {
    let folder = tempdir()?;
    let large = ["--set", "structure.elements=20000", "--set", "method.harmonics=60"];
    let mut child =
        program().args(["run", "configs/rod.toml", "--out"]).arg(folder.path().join("r")).args(large).spawn()?;
    std::thread::sleep(std::time::Duration::from_secs(2));
    assert!(child.try_wait()?.is_none(), "it was to be at work on the modes");
    let began = std::time::Instant::now();
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status()?.success());
    assert_eq!(child.wait()?.code(), Some(1));
    assert!(began.elapsed().as_secs_f64() < 1.0, "{:?}", began.elapsed());
    assert!(!folder.path().join("r/branch.csv").exists());
    Ok(())
}

#[test]
fn completions_know_the_commands() -> Outcome {
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let output = program().args(["completions", shell]).output()?;
        let script = String::from_utf8(output.stdout)?;
        assert!(
            output.status.success() && ["completions", "resume", "extract"].iter().all(|word| script.contains(word))
        );
    }
    Ok(())
}

#[test]
fn quiet_says_nothing_and_verbose_every_point() -> Outcome {
    let folder = tempdir()?;
    let run = |more: &str| -> Outcome<Output> {
        let small = ["--set", "structure.elements=20", "--set", "continuation.max_energy_ratio=1.2"];
        let small = [&small[..], &["--set", "method.mass_redistribution=\"conserve\""]].concat();
        let small = [&small[..], &["--set", "output.stability=\"never\""]].concat();
        let out: PathBuf = folder.path().join(more);
        Ok(program().args(["run", "configs/rod.toml", more, "--out"]).arg(out).args(small).output()?)
    };
    let quiet = run("--quiet")?;
    assert!(quiet.stdout.is_empty() && quiet.stderr.is_empty());
    let verbose = run("--verbose")?;
    let points = said(&verbose).lines().filter(|line| line.contains("residual")).count();
    assert_eq!(points, rows(&table(&folder.path().join("--verbose"))?));
    assert!(!verbose.stderr.contains(&0x1b) && !verbose.stdout.contains(&0x1b));
    Ok(())
}
