//! Cases that another program asks for, line by line.

use std::io::{self, Write};
use std::num::NonZeroUsize;
use std::path::Path;

use nlmodes_study::{Settings, Study, serve};
use serde_json::Value;

const ROD: &str = r#"
[structure]
kind = "rod"
length_m = 1.0
elements = 4
start = "clamped"
material = { youngs_modulus_pa = 210e9, density_kg_m3 = 7800.0 }
section = { area_m2 = 1e-4 }
[[contact]]
at_m = 1.0
direction = "axial"
side = "positive"
gap_m = 1e-3
[method]
harmonics = 1
[continuation]
max_energy_ratio = 2.0
"#;

const STUDY: &str = r#"
scene = "rod.toml"
[[vary]]
key = "contact.0.gap_m"
name = "gap"
values = [1e-3]
[[quantity]]
name = "f_2"
of = "frequency_hz"
at = { energy_ratio = 2.0 }
"#;

fn study(directory: &Path) -> Study {
    let read = Study::parse_with_scene("study.toml", STUDY, ROD).map_err(|refused| refused.text(false));
    Study { directory: directory.to_path_buf(), ..read.unwrap().scene }
}

fn settings() -> Settings {
    Settings { jobs: NonZeroUsize::new(1), ..Settings::default() }
}

#[test]
fn each_line_has_its_answer_and_a_line_that_is_none_its_reason() {
    let place = tempfile::tempdir().unwrap();
    let lines =
        "{\"id\": \"a\", \"set\": {\"gap\": 1e-3}}\n\n{\"gap\": 2e-3}\nnonsense\n[1]\n{\"set\": 3}\n{\"gapp\": 1}\n";
    let mut out = Vec::new();
    serve(&study(place.path()), settings(), lines.as_bytes(), &mut out).unwrap();
    let answers: Vec<Value> =
        String::from_utf8(out).unwrap().lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!(answers.len(), 6);
    assert_eq!((&answers[0]["id"], &answers[0]["status"]), (&"a".into(), &"complete".into()));
    // Doubling the gap scales the motion, and has no other effect.
    let [one, two] = [0, 1].map(|k: usize| answers[k]["quantities"]["f_2"].as_f64().unwrap());
    assert!(answers[1].get("id").is_none() && (one / two - 1.0).abs() < 1e-9, "{one} {two}");
    for (answer, says) in answers[2..].iter().zip(["not JSON", "expected an object", "`set` is no object", "gapp"]) {
        let reason = answer["reason"].as_str().unwrap();
        assert!(answer["status"] == "failed" && reason.contains(says), "{answer}");
    }
}

/// A closed pipe.
struct Gone;

impl Write for Gone {
    fn write(&mut self, _: &[u8]) -> io::Result<usize> {
        Err(io::ErrorKind::BrokenPipe.into())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[test]
fn nothing_is_computed_for_a_reader_that_has_gone() {
    let place = tempfile::tempdir().unwrap();
    let lines: String = (1..100).map(|k| format!("{{\"gap\": {k}e-5}}\n")).collect();
    serve(&study(place.path()), settings(), lines.as_bytes(), &mut Gone).unwrap();
    assert_eq!(std::fs::read_dir(place.path().join("cases")).unwrap().count(), 1);
}
