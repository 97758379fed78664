//! `run` of virtual tests: from a rig to the table.

use std::collections::HashMap;
use std::error::Error;
use std::f64::consts::TAU;
use std::fs;
use std::path::{Path, PathBuf};

use assert_cmd::Command;
use serde_json::Value;

type Outcome = Result<(), Box<dyn Error>>;
type Row = HashMap<String, String>;

fn scene() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../configs/virtual_test.toml")
}

/// Exit status and what was said.
fn call(arguments: &[&str], scene: &Path, out: &Path, set: &[&str]) -> Result<(i32, String), Box<dyn Error>> {
    let mut command = Command::cargo_bin("nlmodes-cli")?;
    command.args(arguments).arg(scene).arg("--out").arg(out);
    set.iter().for_each(|set| _ = command.args(["--set", set]));
    let output = command.output()?;
    let said = String::from_utf8(output.stdout)? + &String::from_utf8(output.stderr)?;
    Ok((output.status.code().ok_or("no status")?, said))
}

fn rows(out: &Path, table: &str) -> Result<Vec<Row>, Box<dyn Error>> {
    Ok(csv::Reader::from_path(out.join(table))?.deserialize().collect::<Result<_, _>>()?)
}

fn number(row: &Row, column: &str) -> f64 {
    row[column].parse().unwrap_or(f64::NAN)
}

fn floats(value: &Value) -> Vec<f64> {
    value.as_array().into_iter().flatten().filter_map(Value::as_f64).collect()
}

/// One level below contact and one above.
const SHORT: [&str; 3] = [
    "virtual_test.schedule.levels_v=[0.75, 2.0]",
    "virtual_test.schedule.order=once",
    "virtual_test.records.levels=[2]",
];

#[test]
fn a_test_below_and_above_contact_gives_points_on_the_backbone() -> Outcome {
    let out = tempfile::tempdir()?;
    let (status, said) = call(&["run"], &scene(), out.path(), &SHORT)?;
    assert_eq!(status, 0, "{said}");
    assert!(said.contains("modal model: 6 modes of the structure with given frequencies, 40.10, 268.62"), "{said}");
    assert!(said.contains("level 2 of 2: 2 V"), "{said}");
    let points = rows(out.path(), "modal_points.csv")?;
    let (below, above) = (&points[0], &points[1]);
    assert_eq!((below["record"].as_str(), below["drive_v"].as_str(), points.len()), ("level-1", "0.75", 2));
    // Noise of the sensors; without it the test of the linear structure is far sharper.
    assert!((number(below, "damping") / 0.0019 - 1.0).abs() < 2e-3);
    assert!((number(below, "pbmif") - 1.0).abs() < 1e-4 && below["contact_stiffness_n_m"].is_empty());
    assert!((number(above, "contact_stiffness_n_m") / 2.3e6 - 1.0).abs() < 0.01);
    assert!(number(above, "damping") > 3e-3 && number(above, "pbmif") < 0.5);
    assert!(points.iter().all(|point| (number(point, "lag_deg") - 90.0).abs() < 0.05 && point["findings"].is_empty()));
    // Harmonic balance knows nothing of rig and loop; a shaker's force has harmonics of its own, hence not closer.
    let backbone = rows(out.path(), "backbone.csv")?;
    let amplitude = number(above, "modal_amplitude");
    let crossings = backbone.windows(2).filter_map(|pair| {
        let [a, b] = [&pair[0], &pair[1]].map(|row| (number(row, "modal_amplitude"), number(row, "frequency_hz")));
        let share = (amplitude - a.0) / (b.0 - a.0);
        (0.0..=1.0).contains(&share).then_some(a.1 + share * (b.1 - a.1))
    });
    let nearest = crossings.map(|hz| (hz - number(above, "frequency_hz")).abs()).fold(f64::INFINITY, f64::min);
    assert!(nearest < 0.1, "{nearest} Hz");
    let files = [
        "frequency_amplitude.svg",
        "frequency_contact.svg",
        "damping_amplitude.svg",
        "history_1.svg",
        "history_2.svg",
        "summary.json",
    ];
    for file in files {
        assert!(out.path().join(file).exists(), "{file}");
    }
    assert!(out.path().join("records/level-2.csv").exists() && !out.path().join("records/level-1.csv").exists());
    extracted_alone(out.path(), above)
}

/// The kept record through `experiment extract`, which knows nothing of its origin.
fn extracted_alone(out: &Path, expected: &Row) -> Outcome {
    let channel = |name: &str, quantity: &str, role: &str, position: &str| {
        format!(
            "[[channel]]\nname = \"{name}\"\nquantity = \"{quantity}\"\nrole = \"{role}\"\nposition_m = {position}\n"
        )
    };
    let channels = channel("force_N", "force", "excitation", "0.06298")
        + &channel("x_drive_m", "displacement", "drive-point", "0.06298")
        + &channel("v_drive_mps", "velocity", "drive-point", "0.06298")
        + &channel("x_stop_m", "displacement", "response", "0.6297552")
        + &channel("f_contact_N", "force", "contact", "0.6297552");
    let recording = "[recording]\nfiles = [\"records/level-2.csv\"]\ntime_column = \"time_s\"\n";
    let more = "[extraction]\npbmif_harmonics = 100\n[stop]\nposition_m = 0.6297552\ngap_m = 1.03e-3\n";
    fs::write(out.join("record.toml"), recording.to_owned() + &channels + more)?;
    let (status, said) = call(&["experiment", "extract"], &out.join("record.toml"), &out.join("extracted"), &[])?;
    assert_eq!(status, 0, "{said}");
    let found = &rows(&out.join("extracted"), "modal_points.csv")?[0];
    // The rig's record has the phase of its oscillator too, from which the frequency is known a little better.
    assert!((number(found, "frequency_hz") - number(expected, "frequency_hz")).abs() < 1e-3);
    for (column, tolerance) in [("lag_deg", 0.02), ("pbmif", 2e-3), ("peak_contact_force_n", 0.5)] {
        assert!((number(found, column) - number(expected, column)).abs() < tolerance, "{column}");
    }
    Ok(())
}

#[test]
fn phase_resonance_of_the_linear_structure_is_where_the_other_modes_put_it() -> Outcome {
    let out = tempfile::tempdir()?;
    let text = fs::read_to_string(scene())?;
    let (head, rest) = text.split_once("[virtual_test.stop]").ok_or("no stop")?;
    let (_, tail) = rest.split_once("[virtual_test.schedule]").ok_or("no schedule")?;
    let (_, extraction) = tail.split_once("[extraction]").ok_or("no extraction")?;
    let force = "[virtual_test.exciter]\nkind = \"force\"\n[virtual_test.schedule]\nlevels_n = [2.0]\n\
                 frequency_drift_1_s = 1e-8\namplitude_drift_1_s = 1e-5\nlag_tolerance_deg = 1e-3\n";
    let path = out.path().join("linear.toml");
    fs::write(&path, format!("{head}{force}[extraction]{extraction}"))?;
    let results = out.path().join("results");
    let (status, said) = call(&["run"], &path, &results, &[])?;
    assert_eq!(status, 0, "{said}");
    let summary: Value = serde_json::from_str(&fs::read_to_string(results.join("summary.json"))?)?;
    let modes = &summary["modes"];
    let (omega, shape) = (floats(&modes["frequencies_hz"]), floats(&modes["drive_shape"]));
    let omega: Vec<f64> = omega.iter().map(|hz| TAU * hz).collect();
    let residual = modes["drive_residual_flexibility_m_n"].as_f64().ok_or("no residual")?;
    let others: f64 = residual + (1..6).map(|k| (shape[k] / omega[k]).powi(2)).sum::<f64>();
    // f₁ (1 + 2 ζ₁² ω₁² R / φ²): the other modes move the drive point in phase with the force.
    let expected = 40.10 * (1.0 + 2.0 * (0.0019 * omega[0] / shape[0]).powi(2) * others);
    assert!((expected - 40.10075).abs() < 1e-4, "{expected}");
    let point = &rows(&results, "modal_points.csv")?[0];
    assert!((number(point, "frequency_hz") - expected).abs() < 1e-5, "{} {expected}", point["frequency_hz"]);
    assert!((number(point, "damping") - 0.0019).abs() < 1e-6, "{}", point["damping"]);
    assert_eq!(point["drive_n"], "2.0");
    Ok(())
}

#[test]
fn a_level_that_does_not_settle_is_said_and_written() -> Outcome {
    let out = tempfile::tempdir()?;
    let hurried = [SHORT[0], SHORT[1], "virtual_test.schedule.longest_hold_s=0.2", "virtual_test.records.format=npy"];
    let (status, said) = call(&["run", "--quiet"], &scene(), out.path(), &hurried[..3])?;
    assert_eq!(status, 2, "records.levels names level 11 of 2: {said}");
    let kept = "virtual_test.records.levels=[1]";
    let (status, said) = call(&["run", "--quiet"], &scene(), out.path(), &[&hurried[..], &[kept]].concat())?;
    assert_eq!(status, 1, "{said}");
    assert!(said.contains("levels did not settle"), "{said}");
    let points = rows(out.path(), "modal_points.csv")?;
    assert_eq!(points.len(), 2);
    assert!(points[0]["findings"].contains("drift"), "{}", points[0]["findings"]);
    assert!(out.path().join("records/level-1.npy").exists());
    Ok(())
}

#[test]
fn the_same_seed_gives_the_same_table_and_another_one_another() -> Outcome {
    let table = |seed: &str| -> Result<Vec<u8>, Box<dyn Error>> {
        let out = tempfile::tempdir()?;
        let one = "virtual_test.schedule.levels_v=[2.0]";
        call(&["run"], &scene(), out.path(), &[one, SHORT[1], "virtual_test.records.levels=[1]", seed])?;
        Ok(fs::read(out.path().join("modal_points.csv"))?)
    };
    let first = table("virtual_test.seed=1")?;
    assert!(first == table("virtual_test.seed=1")? && first != table("virtual_test.seed=2")?);
    Ok(())
}

#[test]
fn other_commands_say_which_one_runs_such_a_scene() -> Outcome {
    for arguments in [&["modes"][..], &["experiment", "extract"]] {
        let output = Command::cargo_bin("nlmodes-cli")?.args(arguments).arg(scene()).output()?;
        let said = String::from_utf8(output.stderr)?;
        assert_eq!(output.status.code(), Some(2));
        assert!(
            said.contains("this scene describes a virtual test") && said.contains("`nlmodes-cli run` runs it"),
            "{said}"
        );
    }
    Ok(())
}
