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

/// Exit status and output.
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
    assert!(nearest < 0.03, "{nearest} Hz");
    // Both backbones are in the figure beside the measured points (Fig. 8 a).
    let figure = fs::read_to_string(out.path().join("frequency_amplitude.svg"))?;
    for label in ["measured", "computed: HBM, 40 harmonics", "computed: MS-HBM, rigid stop, 40 harmonics"] {
        assert!(figure.contains(label), "{label}");
    }
    let files = [
        "backbone_ms-hbm.csv",
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
fn records_of_a_rigid_stop_give_the_same_point_from_each_format() -> Outcome {
    let out = tempfile::tempdir()?;
    let path = out.path().join("rigid.toml");
    // Measured frequencies by the keys of the test itself, as they may be there too.
    let (head, test) = rigid_test()?;
    fs::write(&path, format!("{head}[virtual_test]\n{MEASURED}{test}"))?;
    let results = out.path().join("results");
    fs::create_dir_all(results.join("records"))?;
    fs::write(results.join("records/notes.txt"), "not of the program")?;
    for (format, tolerance) in [("uff", 1e-9), ("npy", 1e-9), ("wav", 1e-6)] {
        let format_key = format!("virtual_test.records.format={format}");
        let (status, said) = call(&["run", "--force"], &path, &results, &[&format_key])?;
        assert_eq!(status, 0, "{said}");
        let mut kept = Vec::new();
        for entry in fs::read_dir(results.join("records"))? {
            kept.push(entry?.file_name().to_string_lossy().into_owned());
        }
        kept.sort();
        // Those of the formats before are gone, what the program did not write is not.
        assert_eq!(kept, [format!("level-1.{format}"), "notes.txt".to_owned()]);
        let measured = &rows(&results, "modal_points.csv")?[0];
        assert!(number(measured, "peak_contact_force_n") > 5.0, "{format}");
        let found = extracted(&results, format, &format!("{head}[structure.modes]\n{MEASURED}"))?;
        for column in ["frequency_hz", "modal_amplitude", "damping", "pbmif", "peak_contact_force_n", "participation_2"]
        {
            let [found, expected] = [&found, measured].map(|row| number(row, column));
            // Shapes of the elements and of the modal model differ by rounding, of which a small share has more.
            let size = if column == "participation_2" { 1.0 } else { expected.abs() };
            assert!((found - expected).abs() < tolerance * size, "{format}, {column}: {found}, {expected}");
        }
    }
    Ok(())
}

const MEASURED: &str = "frequencies_hz = [40.10, 268.62, 758.26, 1371.82, 2427.72, 3508.31]\n\
                        damping_ratios = [0.0019, 0.0076, 0.0005, 0.0017, 0.0010, 0.0014]\n";

/// The structure of the scene, and a short test of it before a rigid stop.
fn rigid_test() -> Result<(String, String), Box<dyn Error>> {
    let text = fs::read_to_string(scene())?;
    let (head, rest) = text.split_once("[structure.modes]").ok_or("no imposed modes")?;
    let (_, test) = rest.split_once("[virtual_test]\n").ok_or("no test")?;
    let (test, _) = test.split_once("[virtual_test.schedule]").ok_or("no schedule")?;
    let lines = test.lines().filter(|line| !line.starts_with("stiffness_n_m"));
    let test: String = lines.map(|line| format!("{line}\n")).collect();
    let short = "[virtual_test.schedule]\nlevels_v = [1.0]\nrecord_s = 0.5\n[virtual_test.records]\n\
                 [extraction]\nharmonics = 20\npbmif_harmonics = 100\n";
    Ok((head.to_owned(), test + short))
}

/// The row of a kept record through `experiment extract`, with the modes of the structure and all channels in the order
/// of the file.
fn extracted(results: &Path, format: &str, structure: &str) -> Result<Row, Box<dyn Error>> {
    let mut names = vec!["force_N", "x_drive_m", "v_drive_mps"];
    names.extend(["a1_mps2", "a2_mps2", "a3_mps2", "a4_mps2", "a5_mps2", "a6_mps2"]);
    names.extend(["x_stop_m", "v_stop_mps", "f_contact_N", "drive_phase"]);
    let positions = [0.06298, 0.06298, 0.06298, 0.20, 0.31, 0.39, 0.48, 0.55, 0.59, 0.62975520, 0.62975520, 0.62975520];
    let mut text = structure.to_owned();
    text += &format!("[recording]\nfiles = [\"records/level-1.{format}\"]\nsample_rate_hz = 20000.0\n");
    for (k, name) in names.iter().enumerate() {
        let (quantity, role) = match (*name, k) {
            ("force_N", _) => ("force", "excitation"),
            ("f_contact_N", _) => ("force", "contact"),
            ("drive_phase", _) => ("phase", "excitation-phase"),
            (_, 1) => ("displacement", "drive-point"),
            (_, 2) => ("velocity", "drive-point"),
            (name, _) if name.starts_with('x') => ("displacement", "response"),
            (name, _) if name.starts_with('v') => ("velocity", "response"),
            _ => ("acceleration", "response"),
        };
        text += &format!("[[channel]]\nname = \"{name}\"\nquantity = \"{quantity}\"\nrole = \"{role}\"\n");
        text += &positions.get(k).map_or_else(String::new, |x| format!("position_m = {x}\n"));
    }
    text += "[extraction]\nharmonics = 20\npbmif_harmonics = 100\n[stop]\nposition_m = 0.62975520\ngap_m = 1.03e-3\n";
    fs::write(results.join("record.toml"), text)?;
    let out = results.join(format!("extracted_{format}"));
    let (status, said) = call(&["experiment", "extract"], &results.join("record.toml"), &out, &[])?;
    assert_eq!(status, 0, "{format}: {said}");
    Ok(rows(&out, "modal_points.csv")?.swap_remove(0))
}

#[test]
fn a_backbone_that_ends_early_is_said_by_status_and_summary() -> Outcome {
    let out = tempfile::tempdir()?;
    let set = [
        "virtual_test.schedule.levels_v=[0.75]",
        SHORT[1],
        "virtual_test.records.levels=[1]",
        "virtual_test.backbone.harmonics=1",
        "virtual_test.backbone.methods=[\"ms-hbm\"]",
        "virtual_test.backbone.end_frequency_hz=1000",
    ];
    let (status, said) = call(&["run", "--quiet"], &scene(), out.path(), &set)?;
    assert_eq!(status, 1, "{said}");
    assert!(said.contains("warning: the backbone (computed: MS-HBM, rigid stop, 1 harmonic) ended early: "), "{said}");
    let summary: Value = serde_json::from_str(&fs::read_to_string(out.path().join("summary.json"))?)?;
    let reasons = summary["incomplete_because"].as_array().ok_or("no reasons")?;
    assert_eq!((summary["complete"].as_bool(), reasons.len()), (Some(false), 1));
    assert!(reasons[0].as_str().is_some_and(|reason| said.contains(reason)));
    assert!(out.path().join("backbone_ms-hbm.csv").exists() && !out.path().join("backbone.csv").exists());
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
fn the_forces_of_several_controlled_harmonics_are_in_a_table() -> Outcome {
    let out = tempfile::tempdir()?;
    let kept = "virtual_test.records.levels=[1]";
    let with = |harmonics: usize| format!("virtual_test.loop.controlled_harmonics={harmonics}");
    let run = |harmonics: usize| {
        call(&["run", "--force"], &scene(), out.path(), &[SHORT[0], SHORT[1], kept, &with(harmonics)])
    };
    let (status, said) = run(3)?;
    assert_eq!(status, 0, "{said}");
    let (points, forces) = (rows(out.path(), "modal_points.csv")?, rows(out.path(), "appropriation.csv")?);
    assert_eq!(forces.len(), 3 * points.len());
    for (k, row) in forces.iter().enumerate() {
        assert_eq!(
            (row["point"].as_str(), row["harmonic"].as_str()),
            ((k / 3 + 1).to_string().as_str(), (k % 3 + 1).to_string().as_str())
        );
        let phase: f64 = row["phase_deg"].parse()?;
        // The fundamental is a quarter of a period ahead of the displacement; noise of the loop at an instant.
        assert!(k % 3 > 0 || (phase - 90.0).abs() < 0.5, "{phase}");
    }
    // At a level with contact the third harmonic is a force to speak of.
    let of = |k: usize| -> Result<f64, Box<dyn Error>> { Ok(forces[k]["force_n"].parse()?) };
    let last = forces.len() - 3;
    assert!(of(last + 2)? > 5e-3 * of(last)?, "{} {}", of(last + 2)?, of(last)?);
    assert_eq!(run(1)?.0, 0);
    assert!(!out.path().join("appropriation.csv").exists());
    let (status, said) = run(9)?;
    assert!(status == 2 && said.contains("controlled_harmonics") && said.contains("from 1 to 8"), "{said}");
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
