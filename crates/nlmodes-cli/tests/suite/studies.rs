//! `nlmodes-cli study` as a user meets it: killed, shared among processes, collected, asked by another program.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use serde_json::Value;

/// The program.
fn program() -> PathBuf {
    assert_cmd::cargo::cargo_bin("nlmodes-cli")
}

const ROD: &str = r#"
[structure]
kind = "rod"
length_m = 1.0
elements = 6
start = "clamped"
material = { youngs_modulus_pa = 210e9, density_kg_m3 = 7800.0 }
section = { area_m2 = 1e-4 }
[[contact]]
at_m = 1.0
direction = "axial"
side = "positive"
gap_m = 1e-3
[method]
harmonics = 3
[continuation]
max_energy_ratio = 2.0
"#;

const STUDY: &str = r#"
title = "Rod"
scene = "rod.toml"
[design]
kind = "sobol"
samples = 24
[[vary]]
key = "contact.0.gap_m"
name = "gap"
uniform = [1e-3, 2e-3]
[[vary]]
key = "structure.material.youngs_modulus_pa"
name = "modulus"
normal = { mean = 210e9, std = 5e9 }
[[quantity]]
name = "f_2"
of = "frequency_hz"
at = { energy_ratio = 2.0 }
"#;

struct Place(tempfile::TempDir);

impl Place {
    fn new() -> Self {
        let place = tempfile::tempdir().unwrap();
        fs::write(place.path().join("rod.toml"), ROD).unwrap();
        fs::write(place.path().join("study.toml"), STUDY).unwrap();
        Self(place)
    }

    fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(program());
        command.current_dir(self.0.path()).arg("study").args(arguments).stdin(Stdio::null());
        command
    }

    fn run(&self, arguments: &[&str]) -> Output {
        self.command(arguments).output().unwrap()
    }

    fn read(&self, name: &str) -> String {
        fs::read_to_string(self.0.path().join(name)).unwrap()
    }

    fn cases(&self, out: &str) -> Vec<PathBuf> {
        let entries = fs::read_dir(self.0.path().join(out).join("cases"));
        entries.map(|entries| entries.flatten().map(|entry| entry.path()).collect()).unwrap_or_default()
    }
}

fn done(cases: &[PathBuf]) -> Vec<(PathBuf, std::time::SystemTime)> {
    let time = |path: &Path| fs::metadata(path.join("case.json")).and_then(|data| data.modified()).ok();
    cases.iter().filter_map(|case| Some((case.clone(), time(case)?))).collect()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[test]
fn a_study_that_is_killed_again_and_again_gives_the_same_table_and_computes_nothing_twice() {
    let place = Place::new();
    let began = Instant::now();
    let whole = place.run(&["run", "study.toml", "--out", "whole", "--quiet"]);
    assert_eq!(whole.status.code(), Some(0), "{}", text(&whole.stderr));
    let step = (began.elapsed() / 8).max(Duration::from_millis(20));
    let mut known: Vec<(PathBuf, std::time::SystemTime)> = Vec::new();
    for kill in 0..5u32 {
        let mut child = place.command(&["run", "study.toml", "--out", "killed", "--quiet"]).spawn().unwrap();
        // Instants that have nothing to do with what is being done.
        thread::sleep(step + step * (kill * 7 % 5) / 5);
        child.kill().unwrap();
        child.wait().unwrap();
        let now = done(&place.cases("killed"));
        assert!(known.iter().all(|case| now.contains(case)), "a case that was done is gone or was done again");
        known = now;
    }
    let rest = place.run(&["run", "study.toml", "--out", "killed", "--quiet"]);
    assert_eq!(rest.status.code(), Some(0), "{}", text(&rest.stderr));
    let now = done(&place.cases("killed"));
    assert!(now.len() == 24 && known.iter().all(|case| now.contains(case)), "{}", now.len());
    assert_eq!(place.read("killed/study.csv"), place.read("whole/study.csv"));
    let bytes = |out: &str| fs::read(place.0.path().join(out).join("study.parquet")).unwrap();
    assert_eq!(bytes("killed"), bytes("whole"));
}

#[test]
fn two_processes_share_a_study_and_a_third_collects_what_is_there() {
    let place = Place::new();
    let first = place.run(&["run", "study.toml", "--out", "shared", "--quiet", "--shard", "0/2"]);
    assert_eq!(first.status.code(), Some(0), "{}", text(&first.stderr));
    let early = place.run(&["collect", "study.toml", "--out", "shared"]);
    assert_eq!(early.status.code(), Some(1));
    assert!(text(&early.stderr).contains("12 of 24 cases are missing"), "{}", text(&early.stderr));
    assert_eq!(place.read("shared/study.csv").matches("not computed yet").count(), 12);
    assert_eq!(place.run(&["status", "study.toml", "--out", "shared"]).status.code(), Some(1));
    // Both take the rest at the same time: each case is computed by one of them.
    let mut both: Vec<_> =
        (0..2).map(|_| place.command(&["run", "study.toml", "--out", "shared", "--quiet"]).spawn().unwrap()).collect();
    for child in &mut both {
        child.wait().unwrap();
    }
    let last = place.run(&["collect", "study.toml", "--out", "shared"]);
    assert_eq!(last.status.code(), Some(0), "{}", text(&last.stderr));
    let said = text(&last.stdout);
    assert!(said.contains("complete") && said.contains("rank correlation with modulus: 1.000"), "{said}");
    let page = place.read("shared/report.html");
    assert!(page.contains("Content-Security-Policy") && !page.contains("http://") && !page.contains("https://"));
    assert!(place.read("shared/f_2_over_gap.svg").contains("<svg"));
    let summary: Value = serde_json::from_str(&place.read("shared/study.json")).unwrap();
    assert_eq!((summary["complete"].as_u64(), summary["missing"].as_u64()), (Some(24), Some(0)));
}

#[test]
fn another_program_asks_for_cases_line_by_line() {
    let place = Place::new();
    let mut child = place.command(&["serve", "study.toml", "--jobs", "2"]);
    let mut child = child.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
    let lines = [
        r#"{"id": "a", "set": {"gap": 1.5e-3, "modulus": 2.1e11}}"#,
        r#"{"id": "b", "set": {"contact.0.gap_m": 1.5e-3, "modulus": 2.1e11}}"#,
        r#"{"gap": 1e-3, "modulus": 1.9e11}"#,
        r#"{"id": 4, "set": {"gapp": 1e-3}}"#,
        "nonsense",
    ];
    child.stdin.take().unwrap().write_all((lines.join("\n") + "\n").as_bytes()).unwrap();
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0));
    let answers: Vec<Value> = text(&output.stdout).lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!(answers.len(), 5);
    let of = |id: &Value| answers.iter().find(|answer| answer["id"] == *id).unwrap().clone();
    let (a, b) = (of(&"a".into()), of(&"b".into()));
    assert!(a["status"] == "complete" && a["quantities"]["f_2"] == b["quantities"]["f_2"] && a["case"] == b["case"]);
    // Frequencies go with the root of the modulus.
    let third = answers.iter().find(|answer| answer["id"].is_null() && answer["status"] == "complete").unwrap();
    let ratio = third["quantities"]["f_2"].as_f64().unwrap() / a["quantities"]["f_2"].as_f64().unwrap();
    assert!((ratio - (1.9f64 / 2.1).sqrt()).abs() < 1e-7, "{ratio}");
    let wrong = of(&4.into());
    assert!(wrong["status"] == "failed" && wrong["reason"].as_str().unwrap().contains("gapp"), "{wrong}");
    assert!(answers.iter().any(|answer| answer["reason"].as_str().unwrap().contains("not JSON")));
    assert_eq!(place.cases("results/study").len(), 2);
}

#[test]
fn an_array_job_asks_for_time_and_memory_and_has_each_shard() {
    let place = Place::new();
    let output = place.run(&["slurm", "study.toml", "--shards", "3"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let script = place.read("study.sbatch");
    for part in
        ["#SBATCH --array=0-2", "#SBATCH --time=0-00:10:00", "--shard ${SLURM_ARRAY_TASK_ID}/3 &", "#SBATCH --requeue"]
    {
        assert!(script.contains(part), "{part}\n{script}");
    }
    // Without a cluster a task is a script like any other.
    for task in ["0", "1", "2"] {
        let mut task_of = Command::new("bash");
        let status = task_of.arg("study.sbatch").env("SLURM_ARRAY_TASK_ID", task).current_dir(place.0.path()).status();
        assert!(status.unwrap().success());
    }
    assert_eq!(place.run(&["collect", "study.toml", "--quiet"]).status.code(), Some(0));
}

#[test]
fn a_study_that_is_wrong_is_refused_with_status_2_and_nothing_is_written() {
    let place = Place::new();
    let wrong = STUDY.replace("uniform = [1e-3, 2e-3]", "uniform = [2e-3, 1e-3]");
    fs::write(place.0.path().join("study.toml"), wrong).unwrap();
    let output = place.run(&["run", "study.toml"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("study.toml:10"), "{}", text(&output.stderr));
    assert!(!place.0.path().join("results").exists());
}
