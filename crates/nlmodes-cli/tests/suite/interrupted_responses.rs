//! Interrupted runs of damped and forced motions are resumed where they ended.

use std::error::Error;
use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::thread::sleep;
use std::time::Duration;

use serde_json::Value;
use tempfile::tempdir;

type Outcome<T = ()> = Result<T, Box<dyn Error>>;

/// Four curves of a rod with a rigid stop: a damped mode, two levels over frequency, phase resonances.
const SCENE: &str = r#"
[structure]
kind = "rod"
length_m = 1.0
elements = 10
start = "clamped"
end = "free"
material = { youngs_modulus_pa = 1.0, density_kg_m3 = 1.0 }
section = { area_m2 = 1.0 }

[[contact]]
at_m = 1.0
direction = "axial"
side = "positive"
gap_m = 1.0

[damping]
ratio = 0.02

[[force]]
at_m = 0.5
direction = "axial"
amplitude_n = 0.2

[[response]]
kind = "damped-mode"

[[response]]
kind = "frequency"
frequency_hz = [0.2, 0.4]
levels_n = [0.1, 0.2]

[[response]]
kind = "phase-resonance"
levels_n = [0.1, 0.2]

[method]
kind = "ms-hbm"
harmonics = 8

[continuation]
max_energy_ratio = 10.0
"#;

fn program() -> Command {
    Command::new(env!("CARGO_BIN_EXE_nlmodes-cli"))
}

fn run(scene: &Path, out: &Path, more: &[&str]) -> Outcome<Output> {
    Ok(program().arg("run").arg(scene).arg("--out").arg(out).args(more).output()?)
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Whole lines of the steps.
fn steps(out: &Path) -> usize {
    fs::read(out.join("steps.jsonl")).map_or(0, |bytes| bytes.iter().filter(|byte| **byte == b'\n').count())
}

/// Starts a run and ends it by a signal as soon as there are this many lines of steps; `None` if it finished before.
fn ended_at(scene: &Path, out: &Path, lines: usize, signal: &str) -> Outcome<Option<i32>> {
    let mut call = program();
    call.arg("run").arg(scene).arg("--out").arg(out).arg("--resume").stdout(Stdio::null()).stderr(Stdio::null());
    let mut child = call.spawn()?;
    while steps(out) < lines {
        assert!(child.try_wait()?.is_none(), "the run ended before {lines} steps");
        sleep(Duration::from_millis(1));
    }
    assert!(Command::new("kill").args([signal, &child.id().to_string()]).status()?.success());
    Ok(child.wait()?.code())
}

/// Tables, and the entry of each curve in the summary except its time.
fn results(out: &Path) -> Outcome<(String, String, Value)> {
    let read = |name: &str| fs::read_to_string(out.join(name));
    let mut summary: Value = serde_json::from_str(&read("summary.json")?)?;
    let mut curves = summary["curves"].take();
    for curve in curves.as_array_mut().into_iter().flatten() {
        curve["wall_time_s"].take();
    }
    Ok((read("branch.csv")?, read("contacts.csv")?, curves))
}

#[cfg(unix)]
#[test]
fn responses_that_are_killed_go_on_with_the_curves_of_an_uninterrupted_run() -> Outcome {
    let folder = tempdir()?;
    let (scene, whole, out) = (folder.path().join("rod.toml"), folder.path().join("whole"), folder.path().join("cut"));
    fs::write(&scene, SCENE)?;
    let output = run(&scene, &whole, &[])?;
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let (expected, n, mut before) = (results(&whole)?, steps(&whole), Vec::new());
    // Once in each curve, alternately by `kill -9` and by Ctrl-C; the next run continues from the results of the last
    // one.
    for (share, signal) in [(0.1, "-KILL"), (0.3, "-INT"), (0.5, "-KILL"), (0.7, "-INT"), (0.9, "-KILL")] {
        let lines = (share * n as f64) as usize;
        let code = ended_at(&scene, &out, lines, signal)?;
        assert_eq!(code, (signal == "-INT").then_some(1), "{share}");
        assert!(steps(&out) >= lines && steps(&out) < n);
        // The earlier lines are still there, including the step cut short by Ctrl-C: they would be gone if the curves
        // had been recomputed.
        let left = fs::read(out.join("steps.jsonl"))?;
        assert!(left.starts_with(&before), "{share}");
        let whole_lines = left.iter().rposition(|byte| *byte == b'\n').map_or(0, |last| last + 1);
        before = left[..whole_lines].to_vec();
    }
    let output = run(&scene, &out, &["--resume"])?;
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    assert!(results(&out)? == expected);
    // A complete run takes no further step.
    assert!(fs::read(out.join("steps.jsonl"))?.starts_with(&before));
    let before = fs::read(out.join("steps.jsonl"))?;
    assert_eq!(run(&scene, &out, &["--resume"])?.status.code(), Some(0));
    assert!(results(&out)? == expected && fs::read(out.join("steps.jsonl"))? == before);
    Ok(())
}

/// As after a crash: among the short steps before contact begins, where the phase of the motion turns, and elsewhere.
#[test]
fn responses_go_on_behind_any_of_their_steps() -> Outcome {
    let folder = tempdir()?;
    let (scene, whole, out) = (folder.path().join("rod.toml"), folder.path().join("whole"), folder.path().join("cut"));
    fs::write(&scene, SCENE)?;
    let bare = ["--set", "output.stability=never", "--set", "output.page=false", "--set", "output.figures=false"];
    assert_eq!(run(&scene, &whole, &bare)?.status.code(), Some(0));
    let (expected, text) = (results(&whole)?, fs::read_to_string(whole.join("steps.jsonl"))?);
    let lines: Vec<&str> = text.split_inclusive('\n').collect();
    for kept in [99, 100, 101, 103, lines.len() / 2, lines.len() - 40] {
        let _ = fs::remove_dir_all(&out);
        fs::create_dir(&out)?;
        fs::copy(whole.join("run.json"), out.join("run.json"))?;
        fs::write(out.join("steps.jsonl"), lines[..kept].concat())?;
        assert_eq!(run(&scene, &out, &[&["--resume"], bare.as_slice()].concat())?.status.code(), Some(0), "{kept}");
        assert!(results(&out)? == expected, "cut behind line {kept}");
        assert!(fs::read_to_string(out.join("steps.jsonl"))? == text, "cut behind line {kept}");
    }
    Ok(())
}

#[test]
fn responses_of_another_scene_are_not_gone_on_with() -> Outcome {
    let folder = tempdir()?;
    let (scene, out) = (folder.path().join("rod.toml"), folder.path().join("results"));
    fs::write(&scene, SCENE)?;
    assert_eq!(run(&scene, &out, &["--set", "continuation.max_points=20"])?.status.code(), Some(1));
    let before = fs::read(out.join("steps.jsonl"))?;
    let output = run(&scene, &out, &["--resume", "--set", "damping.ratio=0.03"])?;
    assert_eq!(output.status.code(), Some(2));
    for part in ["another scene", "damping", "0.02", "0.03"] {
        assert!(said(&output).contains(part), "{}", said(&output));
    }
    assert!(fs::read(out.join("steps.jsonl"))? == before);
    Ok(())
}
