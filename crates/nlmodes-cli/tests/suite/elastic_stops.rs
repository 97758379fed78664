//! Elastic stops from the command line: conventional harmonic balance, and MS-HBM with an elastic stop.

use std::error::Error;
use std::path::Path;
use std::process::Output;

use assert_cmd::Command;
use tempfile::{TempDir, tempdir};

type Outcome = Result<(), Box<dyn Error>>;

const HARMONIC_BALANCE: [&str; 6] = [
    "method.kind=hbm",
    "method.mass_redistribution=none",
    "method.contact_stiffness_n_m=2.3e6",
    "structure.material.youngs_modulus_pa=187.60e9",
    "title=T",
    "continuation.max_energy_ratio=3.0",
];

fn call(command: &str, scene: &str, set: &[&str], more: &[&str], out: &TempDir) -> Result<Output, Box<dyn Error>> {
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut call = Command::cargo_bin("nlmodes-cli")?;
    call.args([command, &format!("configs/{scene}.toml")]).args(more);
    set.iter().for_each(|value| _ = call.args(["--set", value]));
    if command == "run" {
        call.arg("--out").arg(out.path());
    }
    Ok(call.current_dir(workspace).output()?)
}

fn last_row(out: &TempDir) -> Result<csv::StringRecord, Box<dyn Error>> {
    let mut reader = csv::Reader::from_path(out.path().join("branch.csv"))?;
    reader.records().last().ok_or("an empty table")?.map_err(Into::into)
}

fn column(row: &csv::StringRecord, index: usize) -> f64 {
    row[index].parse().unwrap_or(f64::NAN)
}

#[test]
fn harmonic_balance_runs_from_its_own_scene_and_from_the_other_one() -> Outcome {
    let (own, other) = (tempdir()?, tempdir()?);
    let calls = [("beam_hbm", &own), ("beam", &other)];
    for (scene, out) in calls {
        let output = call("run", scene, &HARMONIC_BALANCE, &["--quiet"], out)?;
        assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
        // Computed elsewhere; see crates/nlmodes/tests/beam_hbm.rs.
        let last = last_row(out)?;
        assert!((column(&last, 1) - 48.148_150_48).abs() < 1e-6, "{last:?}");
        // Penetration and force correspond.
        let force = 2.3e6 * (column(&last, 6) - 1.03e-3);
        assert!((column(&last, 9) / force - 1.0).abs() < 1e-9, "{last:?}");
    }
    let branch = |out: &TempDir| std::fs::read_to_string(out.path().join("branch.csv"));
    assert_eq!(branch(&own)?, branch(&other)?);
    for name in
        ["summary.json", "harmonics.npz", "frequency_amplitude.svg", "history_P1.svg", "motion_1.svg", "report.html"]
    {
        assert!(own.path().join(name).exists(), "{name}");
    }
    let figure = std::fs::read_to_string(own.path().join("frequency_amplitude.svg"))?;
    assert!(figure.contains("HBM, 5 harmonics") && !figure.contains("MS-HBM"));
    Ok(())
}

#[test]
fn samples_and_full_series_agree_with_exact_switching_and_cosines() -> Outcome {
    for (set, tolerance) in [("method.switching=sampled", 1e-3), ("method.symmetry=none", 1e-9)] {
        let out = tempdir()?;
        let set: Vec<&str> = HARMONIC_BALANCE.into_iter().chain([set]).collect();
        let output = call("run", "beam", &set, &["--quiet"], &out)?;
        assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
        let found = column(&last_row(&out)?, 1);
        assert!((found / 48.148_150_48 - 1.0).abs() < tolerance, "{set:?}: {found}");
    }
    Ok(())
}

#[test]
fn a_stop_of_its_own_stiffness_yields_with_either_method() -> Outcome {
    let stop = "contact.0.stiffness_n_m=2.3e6";
    let hbm = ["method.kind=hbm", "continuation.max_energy_ratio=3.0", stop];
    let ms_hbm = ["continuation.max_energy_ratio=3.0", stop];
    let mut found = Vec::new();
    for set in [&hbm[..], &ms_hbm[..]] {
        let out = tempdir()?;
        let output = call("run", "beam", set, &["--quiet"], &out)?;
        assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
        found.push(last_row(&out)?);
    }
    // Both leave out the mass of the tip, as in the scene; they differ in whether the tip, a million times stiffer than
    // the beam, moves in harmonics.
    assert!((column(&found[0], 1) / column(&found[1], 1) - 1.0).abs() < 1e-5, "{found:?}");
    assert!(found.iter().all(|row| column(row, 6) > 1.04e-3), "{found:?}");
    Ok(())
}

#[test]
fn check_says_what_a_stop_is() -> Outcome {
    let out = tempdir()?;
    let said = |scene: &str, set: &[&str]| -> Result<String, Box<dyn Error>> {
        let output = call("check", scene, set, &[], &out)?;
        assert_eq!(output.status.code(), Some(0));
        Ok(String::from_utf8(output.stdout)?)
    };
    assert!(said("beam", &[])?.contains("rigid"));
    assert!(said("beam", &["contact.0.stiffness_n_m=5e6"])?.contains("5000000 N/m"));
    assert!(said("beam_hbm", &[])?.contains("2300000 N/m"));
    // The stiffness of a stop has priority over that of the method.
    assert!(said("beam_hbm", &["contact.0.stiffness_n_m=5e6"])?.contains("5000000 N/m"));
    Ok(())
}
