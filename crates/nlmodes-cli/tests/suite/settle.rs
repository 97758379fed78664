//! `settle`: what points of responses become, disturbed along the vector of their largest multiplier.

use std::error::Error;
use std::fs;
use std::path::Path;
use std::process::Output;

use assert_cmd::Command;
use serde_json::Value;
use tempfile::{TempDir, tempdir};

type Outcome = Result<(), Box<dyn Error>>;

/// The rod of two elements with `EA = ρA = L = g₀ = 1`, tip dropped, 1 %, a force of 0.2 at its middle, before a rigid
/// stop: three motions at each frequency between its folds.
const RIGID: &str = r#"
[structure]
kind = "rod"
length_m = 1.0
elements = 2
start = "clamped"
material = { youngs_modulus_pa = 1.0, density_kg_m3 = 1.0 }
section = { area_m2 = 1.0 }
[[contact]]
at_m = 1.0
direction = "axial"
side = "positive"
gap_m = 1.0
[damping]
ratio = 0.01
[[force]]
at_m = 0.5
[[response]]
kind = "frequency"
frequency_hz = [0.40, 0.45]
levels_n = [0.2]
[method]
harmonics = 30
mass_redistribution = "drop"
[output]
figures = false
page = false
"#;

/// Two masses of 1 kg on springs of 1 N/m before a stop of 100 N/m, NLvib's third example.
const ELASTIC: &str = r#"
[structure]
kind = "rod"
length_m = 2.0
elements = 2
mass_matrix = "lumped"
start = "clamped"
material = { youngs_modulus_pa = 1.0, density_kg_m3 = 1.0 }
section = { area_m2 = 1.0 }
[[structure.mass_point]]
at_m = 2.0
mass_kg = 0.5
[[contact]]
at_m = 2.0
direction = "axial"
side = "positive"
gap_m = 1.0
stiffness_n_m = 100.0
[damping]
rayleigh = { stiffness_s = 0.03 }
[[force]]
at_m = 1.0
direction = "axial"
[[response]]
kind = "frequency"
frequency_hz = [0.10, 0.15]
levels_n = [0.3, 2.0]
[method]
kind = "hbm"
harmonics = 20
[output]
figures = false
page = false
"#;

fn call(folder: &Path, arguments: &[&str]) -> Result<Output, Box<dyn Error>> {
    Ok(Command::cargo_bin("nlmodes-cli")?.args(arguments).current_dir(folder).output()?)
}

fn results(scene: &str) -> Result<TempDir, Box<dyn Error>> {
    let folder = tempdir()?;
    fs::write(folder.path().join("scene.toml"), scene)?;
    let output = call(folder.path(), &["run", "scene.toml", "--quiet", "--out", "out"])?;
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    Ok(folder)
}

/// A point of `branch.csv`: frequency, level, amplitude, largest multiplier with its angle.
struct Point {
    number: String,
    hz: f64,
    level: f64,
    amplitude: f64,
    multiplier: f64,
    angle: f64,
}

fn points(folder: &Path) -> Result<Vec<Point>, Box<dyn Error>> {
    let mut table = csv::Reader::from_path(folder.join("out/branch.csv"))?;
    let names = table.headers()?.clone();
    let place = |name: &str| names.iter().position(|own| own == name).ok_or(name.to_owned());
    let columns = ["frequency_hz", "level", "fundamental_m", "largest_multiplier", "multiplier_angle_deg"];
    let columns = columns.map(place);
    let mut found = Vec::new();
    for record in table.records() {
        let record = record?;
        let number = |k: usize| -> f64 {
            let cell = columns[k].as_ref().ok().and_then(|k| record.get(*k));
            cell.and_then(|cell| cell.parse().ok()).unwrap_or(f64::NAN)
        };
        let [hz, level, amplitude, multiplier, angle] = [0, 1, 2, 3, 4].map(number);
        found.push(Point { number: record[0].to_owned(), hz, level, amplitude, multiplier, angle });
    }
    Ok(found)
}

fn settled(folder: &Path, point: &str) -> Result<Value, Box<dyn Error>> {
    let output = call(folder, &["settle", "out", "--point", point, "--json"])?;
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let printed: Value = serde_json::from_slice(&output.stdout)?;
    let written: Value = serde_json::from_slice(&fs::read(folder.join("out/settled.json"))?)?;
    assert_eq!(printed, written);
    Ok(printed)
}

#[test]
fn motions_before_a_rigid_stop_return_and_the_middle_one_between_folds_goes_to_one_of_the_others() -> Outcome {
    let folder = results(RIGID)?;
    let all = points(folder.path())?;
    let stable = all.iter().find(|p| p.multiplier < 0.95 && p.amplitude > 2.0).ok_or("no stable point")?;
    let found = settled(folder.path(), &stable.number)?;
    assert_eq!((&found["kind"], &found["periods"], &found["returns"]), (&"periodic".into(), &1.into(), &true.into()));
    // The exact motion next to the point is that of 30 harmonics, up to their error, with its multiplier.
    let multiplier = found["multiplier"].as_array().ok_or("no multiplier")?;
    let size = multiplier.iter().filter_map(Value::as_f64).map(|v| v * v).sum::<f64>().sqrt();
    assert!((size - stable.multiplier).abs() < 0.02, "{size} {}", stable.multiplier);
    let fundamental = found["before"]["fundamental_m"].as_f64().ok_or("no amplitude")?;
    assert!((fundamental / stable.amplitude - 1.0).abs() < 1e-2, "{fundamental} {}", stable.amplitude);
    let most = found["before"]["largest_m"].as_f64().ok_or("no largest value")?;
    assert!((most - 1.0).abs() < 1e-9, "it touches a rigid stop: {most}");
    // Between the folds: to the upper or to the lower motion of this frequency.
    let middle = all.iter().filter(|p| p.multiplier > 1.05 && p.angle == 0.0);
    let middle: Vec<&Point> = middle.step_by(6).take(4).collect();
    assert!(middle.len() > 2);
    for point in middle {
        let found = settled(folder.path(), &point.number)?;
        assert_eq!(found["kind"], "other", "{}", point.number);
        assert!(found["largest_multiplier"].as_f64().is_some_and(|most| most < 1.0));
        let near = found["nearest_point"].as_u64().ok_or("no point")? as usize;
        let after = found["after"]["fundamental_m"].as_f64().ok_or("no amplitude")?;
        assert!((all[near].hz / point.hz - 1.0).abs() < 0.02 && all[near].multiplier < 1.0);
        assert!((all[near].amplitude / after - 1.0).abs() < 0.1, "{} {after}", all[near].amplitude);
        assert!((after / point.amplitude - 1.0).abs() > 0.05, "not itself");
    }
    // In words, with the number of the point to which it goes.
    let unstable = all.iter().find(|p| p.multiplier > 1.05).ok_or("no unstable point")?;
    let text = String::from_utf8(call(folder.path(), &["settle", "out", "--point", &unstable.number])?.stdout)?;
    assert!(text.contains("becomes                another motion, that of point "), "{text}");
    Ok(())
}

#[test]
fn behind_a_period_doubling_of_an_elastic_stop_the_motion_has_two_periods_and_behind_a_torus_two_lines() -> Outcome {
    let folder = results(ELASTIC)?;
    let all = points(folder.path())?;
    // Below the lower fold of the lower level, at 0.1153 Hz, where there is no other motion.
    let own = |p: &&Point| p.level < 1.0 && p.hz < 0.115;
    let doubled = |p: &&Point| own(p) && p.angle.abs() == 180.0 && (1.3..1.9).contains(&p.multiplier);
    let mut periods = Vec::new();
    for point in all.iter().filter(doubled).step_by(2) {
        let found = settled(folder.path(), &point.number)?;
        assert_eq!((&found["kind"], &found["returns"]), (&"periodic".into(), &false.into()), "{}", point.number);
        periods.push(found["periods"].as_u64().ok_or("no periods")?);
        let multiplier = found["multiplier"][0].as_f64().ok_or("no multiplier")?;
        assert!(multiplier < -1.0 && found["multiplier"][1] == 0.0, "{multiplier}");
        let distance = found["distance_to_exact"].as_f64().ok_or("no distance")?;
        assert!(distance < 0.05, "the point of 20 harmonics is near to it: {distance}");
    }
    assert!(periods.len() > 1 && periods.iter().all(|p| *p == 2), "{periods:?}");
    // A pair of multipliers has left the unit circle: the beat is the turn of that pair, in periods of the load.
    let torus = |p: &&Point| p.level > 1.0 && (0.1440..0.1464).contains(&p.hz) && p.multiplier > 1.003;
    let point = all.iter().rfind(torus).ok_or("no point behind a torus")?;
    let found = settled(folder.path(), &point.number)?;
    assert_eq!(found["kind"], "two-lines", "{found}");
    let beat = found["beat_hz"].as_f64().ok_or("no beat")? / point.hz;
    assert!((beat - point.angle.abs() / 360.0).abs() < 0.02, "{beat} {}", point.angle);
    assert_eq!(found["frequencies_hz"][0].as_f64(), found["frequency_hz"].as_f64());
    Ok(())
}

/// Next to points of three harmonics before a stiff stop there may be no exact motion: the points themselves are
/// followed, to one of the motions of this frequency.
#[test]
fn a_point_without_an_exact_motion_next_to_it_is_followed_from_its_own_state() -> Outcome {
    let folder = results(&ELASTIC.replace("harmonics = 20", "harmonics = 3").replace("[0.3, 2.0]", "[2.0]"))?;
    let all = points(folder.path())?;
    let unstable: Vec<&Point> = all.iter().filter(|p| p.multiplier > 1.3).collect();
    assert!(unstable.len() > 10, "{}", unstable.len());
    let mut without = 0;
    for point in unstable.iter().step_by(unstable.len() / 8) {
        let found = settled(folder.path(), &point.number)?;
        assert_eq!(found["distance_to_exact"].is_null(), found["multiplier"].is_null());
        assert!(found["distance_to_exact"].as_f64().is_none_or(|off| off < 0.1), "{found}");
        if found["multiplier"].is_null() {
            without += 1;
            let size = found["before"]["fundamental_m"].as_f64().ok_or("no amplitude")?;
            assert!((size / point.amplitude - 1.0).abs() < 1e-6, "{size} {}", point.amplitude);
        }
    }
    assert!(without > 2, "{without}");
    Ok(())
}

/// A chain of two masses with a cubic spring, and a Hertz stop in place of the elastic one.
fn with_laws() -> String {
    let hertz =
        ELASTIC.replace("stiffness_n_m = 100.0", "stiffness_hertz_n_m15 = 150.0").replace("kind = \"hbm\"\n", "");
    let spring = "[[spring]]\nat_m = 1.0\ndirection = \"axial\"\nlaw = { polynomial = [0.0, 0.0, 0.5] }\n[damping]";
    hertz.replace("[damping]", spring).replace("[0.3, 2.0]", "[0.3]").replace("[0.10, 0.15]", "[0.116, 0.15]")
}

#[test]
fn with_laws_of_force_the_exact_motion_has_the_multiplier_of_the_point_and_unstable_stretches_are_certified() -> Outcome
{
    let folder = tempdir()?;
    fs::write(folder.path().join("scene.toml"), with_laws())?;
    let output = call(folder.path(), &["run", "scene.toml", "--certify", "--out", "out"])?;
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let said = String::from_utf8(output.stdout)?;
    let all = points(folder.path())?;
    let summary: Value = serde_json::from_slice(&fs::read(folder.path().join("out/summary.json"))?)?;
    let stretches = summary["levels"][0]["unstable"].as_array().ok_or("no unstable stretch")?;
    assert!(!stretches.is_empty() && said.contains("unstable from "), "{said}");
    for stretch in stretches {
        let number = stretch["point"].as_u64().ok_or("no point")? as usize;
        let (point, found) = (&all[number], settled(folder.path(), &number.to_string())?);
        assert_eq!(stretch["becomes"]["kind"], found["kind"], "{number}");
        // Files have fewer digits than the motions in memory.
        let after = |of: &Value| of["after"]["largest_m"].as_f64();
        if let (Some(a), Some(b)) = (after(&stretch["becomes"]), after(&found)) {
            assert!((a / b - 1.0).abs() < 1e-6, "{number}: {a} {b}");
        }
        let multiplier = found["multiplier"].as_array().ok_or("no multiplier")?;
        let size = multiplier.iter().filter_map(Value::as_f64).map(|v| v * v).sum::<f64>().sqrt();
        assert!((size / point.multiplier - 1.0).abs() < 0.05, "{number}: {size} {}", point.multiplier);
    }
    // A stable one comes back.
    let stable = all.iter().find(|p| p.multiplier < 0.9 && p.amplitude > 1.0).ok_or("no stable point")?;
    let found = settled(folder.path(), &stable.number)?;
    assert_eq!((&found["kind"], &found["returns"]), (&"periodic".into(), &true.into()), "{found}");
    assert!(found["distance_to_exact"].as_f64().is_some_and(|off| off < 2e-2), "{found}");
    Ok(())
}

/// Responses and the nonlinear mode with laws return after a period, the better the more harmonics they have.
#[test]
fn points_with_laws_of_force_return_after_a_period() -> Outcome {
    let missing = |text: &str, of: &str| -> Result<f64, Box<dyn Error>> {
        let line = text.lines().find(|line| line.starts_with(of)).ok_or_else(|| format!("no {of}: {text}"))?;
        Ok(line[of.len()..].split_whitespace().next().ok_or("no number")?.parse()?)
    };
    let mode = "[[response]]\nkind = \"mode\"\nfrequency_hz = [0.05, 0.3]\n[method]";
    let scene = with_laws().replace("[method]", mode).replace("[0.116, 0.15]", "[0.10, 0.12]");
    let mut found: Vec<[f64; 2]> = Vec::new();
    for harmonics in ["harmonics = 6", "harmonics = 24"] {
        let folder = results(&scene.replace("harmonics = 20", harmonics))?;
        let all = points(folder.path())?;
        let forced = all.iter().rfind(|p| p.level > 0.0 && p.multiplier < 0.95).ok_or("no stable point")?;
        let mode = all.iter().filter(|p| p.level.is_nan()).nth(12).ok_or("no point of the mode")?;
        let verified = |point: &Point| -> Result<String, Box<dyn Error>> {
            let output = call(folder.path(), &["verify", "out", "--point", &point.number])?;
            assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
            Ok(String::from_utf8(output.stdout)?)
        };
        let (of_response, of_mode) = (verified(forced)?, verified(mode)?);
        assert!(of_response.contains("stable") && !of_mode.contains("exact motion"), "{of_response}\n{of_mode}");
        let after = "what is missing after it";
        found.push([missing(&of_response, after)?, missing(&of_mode, after)?]);
    }
    let [few, many] = &found[..] else { return Err("two runs".into()) };
    assert!((0..2).all(|k| many[k] < 1e-3 && many[k] < 0.3 * few[k]), "{few:?} {many:?}");
    Ok(())
}

#[test]
fn what_is_no_point_of_a_response_is_refused_with_what_was_expected() -> Outcome {
    let folder = results(&RIGID.replace("harmonics = 30", "harmonics = 5"))?;
    let said = |arguments: &[&str], status: i32| -> Result<String, Box<dyn Error>> {
        let output = call(folder.path(), arguments)?;
        assert_eq!(output.status.code(), Some(status));
        Ok(String::from_utf8(output.stderr)?)
    };
    let text = said(&["settle", "out", "--point", "9999"], 2)?;
    assert!(text.starts_with("error: out: ") && text.contains("there is no point 9999: the table has "), "{text}");
    let text = said(&["settle", "nowhere", "--point", "0"], 2)?;
    assert!(text.contains("error: nowhere: there is no such directory"), "{text}");
    let text = said(&["settle", "out", "--point", "0", "--disturbance=-1"], 2)?;
    assert!(text.contains("the disturbance: -1, expected a positive number"), "{text}");
    fs::remove_file(folder.path().join("out/harmonics.npz"))?;
    let text = said(&["settle", "out", "--point", "0"], 2)?;
    assert!(text.contains("there is no harmonics.npz here"), "{text}");
    Ok(())
}
