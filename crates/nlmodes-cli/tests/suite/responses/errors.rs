//! Errors of responses: against the same scene with more harmonics, and harmonics chosen for an accuracy.

use std::fs;

use serde_json::Value;
use tempfile::tempdir;

use super::{Outcome, ROD, number, rows, run, said, summary};

const RESPONSE: &str = "[[response]]\nkind = \"frequency\"\nfrequency_hz = [0.3, 0.6]\nlevels_n = [0.2]\n";

fn with(method: &str, text: &str) -> Result<Value, Box<dyn std::error::Error>> {
    let folder = tempdir()?;
    let text = ROD.replace("harmonics = 20\n", &format!("{method}\n")) + RESPONSE + text;
    let output = run(folder.path(), &text, &[])?;
    assert!(output.status.success(), "{}", said(&output));
    Ok(serde_json::from_str(&fs::read_to_string(folder.path().join("out/summary.json"))?)?)
}

fn f(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}

/// The errors that are stated of the peak and of the jump are what they change by with many harmonics, within a
/// factor of three, and each level tells both.
#[test]
fn stated_errors_are_those_against_many_harmonics() -> Outcome {
    let reference = &with("harmonics = 64", "")?["levels"][0].clone();
    let up = |level: &Value| -> Value {
        let jumps = level["jumps"].as_array().cloned().unwrap_or_default();
        jumps.into_iter().find(|jump| jump["direction"] == "up").unwrap_or_default()
    };
    for harmonics in [6, 12] {
        let found = with(&format!("harmonics = {harmonics}"), "")?;
        let level = &found["levels"][0];
        let (own, exact) = (up(level), up(reference));
        let is = (f(&exact["frequency_hz"]) / f(&own["frequency_hz"]) - 1.0).abs();
        let said = f(&own["frequency_error"]);
        assert!(said > is / 3.0 && said < 3.0 * is, "{harmonics}: jump {said:e} for {is:e}");
        let (own, exact) = (&level["peak"], &reference["peak"]);
        let is = (f(&exact["amplitude_m"]) / f(&own["amplitude_m"]) - 1.0).abs();
        let said = f(&own["amplitude_error"]);
        assert!(said > is / 3.0 && said < 3.0 * is + 1e-4, "{harmonics}: peak {said:e} for {is:e}");
        let errors = &found["errors"];
        for number in ["frequency", "displacement", "impulse", "peak_force"] {
            assert!(f(&errors[number]["estimate"]) > 0.0, "{number}: {errors}");
        }
        let command = errors["impulse"]["command"].as_str().unwrap_or_default();
        assert_eq!(command, format!("--set method.harmonics={}", 2 * harmonics));
    }
    Ok(())
}

/// An accuracy chooses the harmonics, and the peak has it; where none reaches it, that is reported, and the curve is
/// there.
#[test]
fn an_accuracy_chooses_the_harmonics_of_a_response() -> Outcome {
    let peak = |found: &Value| f(&found["levels"][0]["peak"]["amplitude_m"]);
    let end = |found: &Value| found["curves"][0]["end"]["message"].as_str().unwrap_or_default().to_owned();
    let reference = peak(&with("harmonics = 64", "")?);
    for accuracy in [1e-2, 1e-3] {
        let found = with(&format!("accuracy = {accuracy}"), "")?;
        assert!(end(&found).ends_with(" harmonics reach the accuracy"), "{}", end(&found));
        let off = (peak(&found) / reference - 1.0).abs();
        assert!(off < 2.0 * accuracy, "{accuracy}: {off:e}");
    }
    let found = with("accuracy = 1e-9\nmax_harmonics = 8", "")?;
    assert!(end(&found).contains("the accuracy is not reached: twice 8 harmonics change it by "), "{}", end(&found));
    Ok(())
}

/// A run reports each level in some lines: its largest amplitude, its stable ranges, its jumps.
#[test]
fn a_run_reports_where_a_sweep_jumps() -> Outcome {
    let folder = tempdir()?;
    let output = run(folder.path(), &(ROD.to_owned() + RESPONSE), &[])?;
    let text = String::from_utf8(output.stdout)?;
    let mut lines = text.lines().skip_while(|line| !line.starts_with("0.2 N: largest amplitude "));
    let level: Vec<&str> = lines.by_ref().take(4).collect();
    assert!(level.len() == 4 && level[0].contains("; largest contact force "), "{text}");
    for part in ["    stable from 0.3 to ", "    a sweep up jumps at 0.", "    a sweep down jumps at 0."] {
        assert!(level.iter().any(|line| line.starts_with(part)), "{part}: {text}");
    }
    let page = fs::read_to_string(folder.path().join("out/report.html"))?;
    assert!(page.contains("Levels: peaks, stable ranges, jumps") && page.contains("a sweep up jumps at 0."));
    Ok(())
}

/// A lamp on an arm between two rubber snubbers, shaken at its clamp.
const ARM: &str = r#"
title = "arm"
[structure]
kind = "beam"
length_mm = 300.0
elements = 24
start = "clamped"
end = "free"
material = { youngs_modulus_gpa = 70.0, density_kg_m3 = 2700.0, poissons_ratio = 0.33 }
section = { width_mm = 25.0, height_mm = 6.0 }
mass_point = [{ at_mm = 300.0, mass_kg = 0.15 }]
[[contact]]
at_mm = 250.0
direction = "transverse"
side = "positive"
gap_mm = 0.5
stiffness_n_mm = 50.0
[[contact]]
at_mm = 250.0
direction = "transverse"
side = "negative"
gap_mm = 0.5
stiffness_n_mm = 50.0
[damping]
ratio_percent = 1.5
[base_motion]
direction = "transverse"
acceleration_g = 1.0
[[response]]
kind = "frequency"
frequency_hz = [28.0, 56.0]
[method]
harmonics = 5
"#;

/// Around the fold at the largest amplitude the multipliers of many points are too close to one to decide: the jump is
/// that of the fold all the same, and a loss of stability is at its located event.
#[test]
fn undecided_points_beside_a_fold_do_not_hide_its_jump() -> Outcome {
    let folder = tempdir()?;
    run(folder.path(), ARM, &[])?;
    let levels = &summary(folder.path())?["levels"][0];
    let list = |key: &str| levels[key].as_array().cloned().unwrap_or_default();
    let of = |key: &str, name: &str, value: &str| -> Vec<f64> {
        list(key).iter().filter(|found| found[name] == value).map(|found| f(&found["frequency_hz"])).collect()
    };
    let up = of("jumps", "direction", "up");
    let is_an_end = |at: f64| list("stable").iter().any(|range| f(&range[1]) == at);
    assert!(matches!(up[..], [at] if (at - 51.47).abs() < 0.02 && is_an_end(at)), "{levels}");
    let located = of("losses", "event", "neimark-sacker");
    let points = rows(folder.path().join("out/branch.csv"))?;
    let events = points.iter().filter(|row| row["event"].contains("neimark-sacker"));
    let events: Vec<f64> = events.map(|row| number(row, "frequency_hz")).collect();
    let is_an_event = |at: &f64| events.iter().any(|event| (event / at - 1.0).abs() < 1e-12);
    assert!(!located.is_empty() && located.iter().all(is_an_event), "{located:?} {events:?}");
    Ok(())
}

/// The largest amplitude of an oscillator that does not touch is that of its closed form, `F/(2 D k √(1 − D²))` at
/// `ω √(1 − 2 D²)`.
#[test]
fn the_peak_of_a_linear_response_is_that_of_its_closed_form() -> Outcome {
    let (ratio, force, omega): (f64, f64, f64) = (0.003, 1e-3, 10.0);
    let text = format!(
        "[structure]\nkind = \"reduced\"\nfrequencies_hz = [{:?}]\ncontact_rows = [[1.0]]\n\
         residual_flexibility_m_n = [[0.0]]\n[[contact]]\nrow = 1\ngap_m = 1.0\nstiffness_n_m = 50.0\n\
         [damping]\nratio = {ratio:?}\n[[force]]\nrow = 1\namplitude_n = {force:?}\n\
         [[response]]\nkind = \"frequency\"\nfrequency_hz = [1.0, 2.2]\n",
        omega / std::f64::consts::TAU
    );
    let folder = tempdir()?;
    let output = run(folder.path(), &text, &[])?;
    assert!(output.status.success(), "{}", said(&output));
    let summary: Value = serde_json::from_str(&fs::read_to_string(folder.path().join("out/summary.json"))?)?;
    let peak = &summary["levels"][0]["peak"];
    let hz = omega * (1.0 - 2.0 * ratio * ratio).sqrt() / std::f64::consts::TAU;
    let amplitude = force / (2.0 * ratio * omega * omega * (1.0 - ratio * ratio).sqrt());
    assert!((f(&peak["frequency_hz"]) / hz - 1.0).abs() < 1e-7, "{peak} for {hz} Hz");
    assert!((f(&peak["amplitude_m"]) / amplitude - 1.0).abs() < 1e-10, "{peak} for {amplitude} m");
    assert!(summary["levels"][0]["largest_force"].is_null());
    Ok(())
}
