//! `experiment design`, and free decays of `experiment extract`.

use std::collections::HashMap;
use std::error::Error;
use std::f64::consts::TAU;
use std::fs;
use std::path::{Path, PathBuf};

use assert_cmd::Command;
use nlmodes::experiment::records::{Channel, Quantity, Record, Role, write_record};
use serde_json::Value;

type Outcome = Result<(), Box<dyn Error>>;

fn configs() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../configs")
}

fn run(arguments: &[&str], scene: &Path, more: &[&str]) -> Result<(i32, String), Box<dyn Error>> {
    let output = Command::cargo_bin("nlmodes-cli")?.args(arguments).arg(scene).args(more).output()?;
    let said = String::from_utf8(output.stdout)? + &String::from_utf8(output.stderr)?;
    Ok((output.status.code().ok_or("no status")?, said))
}

fn design(scene: &str, out: &Path, more: &[&str]) -> Result<(i32, String, Value), Box<dyn Error>> {
    let mut all = vec!["--out", out.to_str().ok_or("no text")?, "--quiet"];
    if scene == "virtual_test.toml" {
        all.extend(["--set", "virtual_test.schedule.order=\"once\"", "--set", "virtual_test.records.levels=[1]"]);
    }
    all.extend(more);
    let (status, said) = run(&["experiment", "design"], &configs().join(scene), &all)?;
    let file = out.join("design.json");
    let found = if file.exists() { serde_json::from_str(&fs::read_to_string(file)?)? } else { Value::Null };
    Ok((status, said, found))
}

#[test]
fn a_test_is_planned_from_its_scene() -> Outcome {
    let out = tempfile::tempdir()?;
    let (status, said, found) =
        design("virtual_test.toml", out.path(), &["--set", "virtual_test.schedule.levels_v=[0.75, 1.2]"])?;
    assert_eq!(status, 0, "{said}");
    let levels = found["levels"].as_array().ok_or("no levels")?;
    let number = |level: &Value, key: &str| level[key].as_f64().unwrap_or(f64::NAN);
    // As in the table of benchmarks/results/virtual_test.md.
    for (level, frequency, force) in [(&levels[0], 40.1008, 3.458), (&levels[1], 40.4824, 5.596)] {
        assert_eq!(level["held"], Value::Bool(true), "{said}");
        assert!((number(level, "frequency_hz") - frequency).abs() < 2e-3, "{level}");
        assert!((number(level, "force_n") / force - 1.0).abs() < 2e-3, "{level}");
    }
    assert!((number(&levels[1], "peak_contact_force_n") - 12.2).abs() < 1.0, "{}", levels[1]);
    let ranges = found["ranges"].as_array().ok_or("no ranges")?;
    let stop = ranges.iter().find(|range| range["channel"] == "x_stop_m").ok_or("no displacement at the stop")?;
    // The stop is at 1.03 mm.
    assert!((number(stop, "largest") / 1.03e-3 - 1.0).abs() < 0.05 && number(stop, "range") == 2e-3, "{stop}");
    // Linear: the slowest is the structure's own decay, e^{−ζωT} = e^{−2πζ} with 1.9e-3, and a little from the shaker.
    let own = (-TAU * 0.0019_f64).exp();
    assert!((number(&levels[0], "largest_multiplier") / own - 1.0).abs() < 2e-3, "{}", levels[0]);
    assert!(number(&levels[1], "largest_multiplier") < 0.95 && levels[1]["announced"] == Value::Null, "{}", levels[1]);
    assert!(number(&levels[1], "settling_by_multipliers_s") < 8.0 && said.contains("|μ|"), "{said}");
    // Grazing: 2 ζ ω² q/φ at each place, so that force times stroke is the same everywhere.
    let places = found["drive_places"].as_array().ok_or("no places")?;
    let work: Vec<f64> = places.iter().map(|place| number(place, "force_n") * number(place, "stroke_m")).collect();
    assert!(work.len() > 15 && work.iter().all(|w| (w / work[0] - 1.0).abs() < 1e-9), "{work:?}");
    Ok(())
}

#[test]
fn a_level_that_the_loop_does_not_hold_is_said() -> Outcome {
    let out = tempfile::tempdir()?;
    let more = ["--set", "virtual_test.schedule.levels_v=[0.75]", "--set", "virtual_test.schedule.longest_hold_s=0.5"];
    let (status, said, found) = design("virtual_test.toml", out.path(), &more)?;
    assert_eq!((status, &found["levels"][0]["held"]), (1, &Value::Bool(false)), "{said}");
    assert!(said.contains("no: ") && said.contains("held-too-short"), "{said}");
    assert!(said.contains("phase control will not hold level 1, 0.75 V: it takes some 1"), "{said}");
    Ok(())
}

/// Between 6 and 6.75 N of an ideal force the beam has no steady level: docs/experiment.md.
#[test]
fn a_level_outside_the_circle_is_announced_and_is_not_held() -> Outcome {
    let out = tempfile::tempdir()?;
    let text = fs::read_to_string(configs().join("virtual_test.toml"))?;
    let text = text.replace("kind = \"shaker\"", "kind = \"force\"").replace("levels = [3, 11]", "levels = [1]");
    let (before, behind) = text.split_once("levels_v = ").ok_or("no levels")?;
    let (_, behind) = behind.split_once("order = \"there-and-back\"").ok_or("no order")?;
    let scene = out.path().join("force.toml");
    fs::write(&scene, format!("{before}levels_n = [4.0, 5.4, 6.4]{behind}"))?;
    let (status, said, found) = design(scene.to_str().ok_or("no text")?, out.path(), &[])?;
    let level = |k: usize, key: &str| found["levels"][k][key].clone();
    assert_eq!((status, level(1, "held"), level(2, "held")), (1, Value::Bool(true), Value::Bool(false)), "{said}");
    assert!(level(1, "largest_multiplier").as_f64() < Some(0.95) && level(1, "jumps") == Value::Bool(true), "{said}");
    assert!(level(2, "largest_multiplier").as_f64().is_none_or(|largest| largest > 1.02), "{said}");
    assert!(said.contains("phase control will not hold level 3, 6.4 N: ") && said.contains("aperiodic"), "{said}");
    Ok(())
}

#[test]
fn a_structure_with_a_stop_gets_levels_about_grazing() -> Outcome {
    let out = tempfile::tempdir()?;
    let (status, said, found) = design("beam.toml", out.path(), &["--set", "damping.ratio=0.03"])?;
    assert!(status == 0 || status == 1, "{said}");
    let levels = found["levels"].as_array().ok_or("no levels")?;
    let force = |k: usize| levels[k]["peak_contact_force_n"].as_f64().unwrap_or(0.0);
    assert_eq!(levels.len(), 6, "{said}");
    assert!(force(0) == 0.0 && force(1) == 0.0 && force(2) > 0.0 && force(3) > force(2), "{said}");
    assert!(said.contains("assumed: an ideal force") && said.contains("times the force of grazing"), "{said}");
    let (status, said, _) = design("beam.toml", out.path(), &[])?;
    assert!(status == 2 && said.contains("damping ratios of the modes"), "{said}");
    let (status, said, _) = design("beam_two_stops.toml", out.path(), &["--set", "damping.ratio=0.03"])?;
    assert!(status == 2 && said.contains("before one stop; the scene has 2"), "{said}");
    Ok(())
}

#[test]
fn a_record_that_rings_down_gives_its_locked_level_and_its_decay() -> Outcome {
    let folder = tempfile::tempdir()?;
    let (rate, omega, zeta) = (4000.0, TAU * 40.0, 0.004);
    let phase = |t: f64| omega * t;
    let (mut force, mut x) = (vec![], vec![]);
    for j in 0..20_000 {
        let t = j as f64 / rate;
        let noise = 1e-4 * f64::sin((j * j) as f64 * 0.7);
        let free = (t - 1.0).max(0.0);
        force.push(if free == 0.0 { -2.0 * phase(t).sin() } else { 0.0 } + noise);
        x.push(1e-3 * (f64::exp(-zeta * omega * free) * phase(t).cos() + noise));
    }
    let record = Record::new("r", rate)
        .with(Channel::new("force", Quantity::Force, Role::Excitation, None), force)
        .with(Channel::new("x", Quantity::Displacement, Role::DrivePoint, None), x);
    write_record(&folder.path().join("r.npy"), &record)?;
    let scene = |decay: &str| {
        format!(
            "[recording]\nfiles = [\"r.npy\"]\nsample_rate_hz = 4000.0\n[[channel]]\nname = \"force\"\n\
             quantity = \"force\"\nrole = \"excitation\"\nposition_m = 0.1\n[[channel]]\nname = \"x\"\n\
             quantity = \"displacement\"\nrole = \"drive-point\"\nposition_m = 0.1\n[linear_modes]\n\
             frequencies_hz = [40.0]\ndamping_ratios = [0.004]\npositions_m = [0.1]\nshapes = [[1.0]]\n{decay}"
        )
    };
    let path = folder.path().join("scene.toml");
    for (decay, first) in [("[free_decay]\n", 1.0), ("[free_decay]\nfrom_s = 2.0\nto_s = 4.5\n", 2.0)] {
        let out = folder.path().join("out");
        drop(fs::remove_dir_all(&out));
        fs::write(&path, scene(decay))?;
        let (status, said) = run(&["experiment", "extract"], &path, &["--out", out.to_str().ok_or("no text")?])?;
        assert_eq!(status, 0, "{said}");
        let rows: Vec<HashMap<String, f64>> = csv::Reader::from_path(out.join("decay.csv"))?
            .deserialize::<HashMap<String, String>>()
            .map(|row| Ok(row?.into_iter().map(|(name, cell)| (name, cell.parse().unwrap_or(f64::NAN))).collect()))
            .collect::<Result<_, csv::Error>>()?;
        assert!(rows.len() > 10 && rows[0]["time_s"] > first, "{said}");
        for row in &rows {
            assert!((row["frequency_hz"] - 40.0).abs() < 4.0 * row["frequency_hz_uncertainty"] + 1e-4, "{row:?}");
            assert!((row["damping"] - zeta).abs() < 4.0 * row["damping_uncertainty"] + 1e-5, "{row:?}");
            let amplitude = 1e-3 * f64::exp(-zeta * omega * (row["time_s"] - 1.0));
            // The mean over three periods of a decay.
            assert!((row["modal_amplitude"] / amplitude - 1.0).abs() < 5e-3, "{row:?} {amplitude}");
        }
        assert!(out.join("decay.svg").exists() && said.contains("free from "), "{said}");
        let table = fs::read_to_string(out.join("modal_points.csv"))?;
        assert!(table.contains("r.npy,locked,0.0,"), "{table}");
    }
    for (decay, expected) in [
        ("[free_decay]\nfrom_s = 3.0\nto_s = 2.0\n", "expected more than `from_s`, 3 s"),
        ("[free_decay]\n[[segment]]\nfrom_s = 1.0\nto_s = 2.0\n", "either segments or a free decay"),
    ] {
        fs::write(&path, scene(decay))?;
        let (status, said) = run(&["experiment", "extract"], &path, &[])?;
        assert!(status == 2 && said.contains(expected), "{said}");
    }
    Ok(())
}
