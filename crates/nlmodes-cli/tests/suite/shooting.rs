//! Scenes with `method.kind = "shooting"`, and stability in result files.

use std::error::Error;
use std::fs;
use std::path::Path;
use std::process::Output;

use assert_cmd::Command;
use tempfile::{TempDir, tempdir};

type Outcome = Result<(), Box<dyn Error>>;

fn call(arguments: &[&str]) -> Result<Output, Box<dyn Error>> {
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    Ok(Command::cargo_bin("nlmodes-cli")?.args(arguments).current_dir(workspace).output()?)
}

/// The rod of five elements, up to four times the energy at grazing.
fn results(set: &[&str]) -> Result<TempDir, Box<dyn Error>> {
    let out = tempdir()?;
    let path = out.path().to_string_lossy();
    let mut arguments = vec!["run", "configs/rod.toml", "--quiet", "--out", &path];
    let common = ["structure.elements=5", "continuation.max_energy_ratio=4", "continuation.frequency_hz=[40.0, 90.0]"];
    common.iter().chain(set).for_each(|value| arguments.extend(["--set", value]));
    let output = call(&arguments)?;
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    Ok(out)
}

/// A column of `branch.csv`.
fn column(directory: &Path, name: &str) -> Result<Vec<String>, Box<dyn Error>> {
    let mut table = csv::Reader::from_path(directory.join("branch.csv"))?;
    let index = table.headers()?.iter().position(|head| head == name).ok_or("no such column")?;
    table.records().map(|row| Ok(row?[index].to_owned())).collect()
}

#[test]
fn a_branch_by_shooting_has_all_files_and_its_points_return_exactly() -> Outcome {
    let out = results(&["method.kind=\"shooting\""])?;
    for name in
        ["harmonics.npz", "starts.npz", "frequency_energy.svg", "participation.csv", "history_P1.svg", "report.html"]
    {
        assert!(out.path().join(name).is_file(), "{name}");
    }
    let (stable, largest) = (column(out.path(), "stable")?, column(out.path(), "largest_multiplier")?);
    let angle = column(out.path(), "multiplier_angle_deg")?;
    let summary: serde_json::Value = serde_json::from_str(&fs::read_to_string(out.path().join("summary.json"))?)?;
    let count = |kind: &str| stable.iter().filter(|s| *s == kind).count() as u64;
    assert!(count("false") > 0 && count("true") + count("false") == stable.len() as u64);
    assert_eq!(summary["stability"]["unstable_points"].as_u64(), Some(count("false")));
    assert_eq!(summary["method"]["name"], "exact shooting, linear motion between located contact instants");
    for ((stable, largest), angle) in stable.iter().zip(&largest).zip(&angle) {
        assert_eq!(stable == "true", largest.parse::<f64>()? <= 1.0 + 1e-6);
        // Period doubling on this segment: the multiplier is real and negative.
        assert!(if stable == "true" { angle.is_empty() } else { (angle.parse::<f64>()? - 180.0).abs() < 1e-6 });
    }
    let events = column(out.path(), "event")?;
    assert_eq!(events.iter().filter(|e| e.contains("stability-change")).count(), 2, "{events:?}");
    assert!(fs::read_to_string(out.path().join("frequency_energy.svg"))?.contains("branch unstable"));
    // The full structure, also from an unstable point.
    let unstable = stable.iter().position(|s| s == "false").ok_or("none is unstable")?.to_string();
    let output = call(&["verify", &out.path().to_string_lossy(), "--point", &unstable])?;
    let text = String::from_utf8(output.stdout)?;
    let missing = text.split_once("in the energy norm").and_then(|(_, rest)| rest.split_whitespace().next());
    assert!(missing.ok_or("no energy norm")?.parse::<f64>()? < 1e-10, "{text}");
    Ok(())
}

#[test]
fn contact_nodes_with_mass_on_springs_are_those_of_harmonic_balance() -> Outcome {
    let spring = "method.contact_stiffness_n_m=3e10";
    let at = [
        "continuation.start_energy_ratio=2",
        "continuation.max_points=2",
        spring,
        "method.mass_redistribution=\"none\"",
    ];
    let one = |kind: &str, harmonics: &str| -> Result<f64, Box<dyn Error>> {
        let out = tempdir()?;
        let path = out.path().to_string_lossy();
        let mut arguments =
            vec!["run", "configs/rod.toml", "--quiet", "--out", &path, "--set", kind, "--set", harmonics];
        arguments.extend(["--set", "structure.elements=4", "--set", "continuation.frequency_hz=[40.0, 90.0]"]);
        at.iter().for_each(|value| arguments.extend(["--set", value]));
        // The limit of points ends the branch early.
        assert_eq!(call(&arguments)?.status.code(), Some(1));
        Ok(column(out.path(), "frequency_hz")?[0].parse()?)
    };
    let exact = one("method.kind=\"shooting\"", "method.harmonics=3")?;
    let balanced = one("method.kind=\"hbm\"", "method.harmonics=100")?;
    assert!((exact / balanced - 1.0).abs() < 1e-9, "{exact} and {balanced} Hz");
    Ok(())
}

#[test]
fn a_mass_rule_changes_nothing_where_open_modes_leave_no_mass_at_contacts() -> Outcome {
    let one = |rule: &str, stiffness: &str| -> Result<Vec<String>, Box<dyn Error>> {
        let open = ["reduction.kind=\"open-modes\"", "reduction.modes=4", "method.kind=\"shooting\"", rule, stiffness];
        column(results(&open)?.path(), "frequency_hz")
    };
    let any = "method.harmonics=3";
    for stiffness in ["contact.0.stiffness_n_m=3e10", any] {
        let plain = one(any, stiffness)?;
        assert!(plain.len() > 5);
        for rule in ["none", "move", "conserve"] {
            assert_eq!(one(&format!("method.mass_redistribution=\"{rule}\""), stiffness)?, plain, "{rule}");
        }
    }
    Ok(())
}

#[test]
fn stability_may_be_left_out_or_asked_for() -> Outcome {
    let never = results(&["output.stability=\"never\"", "method.kind=\"shooting\""])?;
    assert!(column(never.path(), "stable")?.iter().all(String::is_empty));
    let harmonic = results(&["output.stability=\"always\"", "method.harmonics=20"])?;
    assert!(column(harmonic.path(), "stable")?.iter().any(|s| s == "false"));
    Ok(())
}
