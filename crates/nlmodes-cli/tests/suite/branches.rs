//! Trees of branches, skipped internal resonances and starts elsewhere, as files.

use std::error::Error;
use std::fs;
use std::path::Path;

use assert_cmd::Command;
use serde_json::Value;
use tempfile::{TempDir, tempdir};

type Outcome = Result<(), Box<dyn Error>>;

/// Runs the rod of Section 3 with three harmonics; gives its summary.
fn rod(out: &TempDir, set: &[&str]) -> Result<Value, Box<dyn Error>> {
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut call = Command::cargo_bin("nlmodes-cli")?;
    call.args(["run", "configs/rod.toml", "--quiet", "--force", "--out"]).arg(out.path());
    set.iter().for_each(|value| _ = call.args(["--set", value]));
    let output = call.current_dir(workspace).output()?;
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    Ok(serde_json::from_str(&fs::read_to_string(out.path().join("summary.json"))?)?)
}

fn rows(path: &Path) -> Result<Vec<csv::StringRecord>, Box<dyn Error>> {
    Ok(csv::Reader::from_path(path)?.records().collect::<Result<_, _>>()?)
}

#[test]
fn a_tree_has_a_folder_for_each_branch_and_a_later_run_leaves_none_behind() -> Outcome {
    let out = tempdir()?;
    let summary = rod(&out, &["continuation.at_branch_point=\"all\""])?;
    let others = summary["other_branches"].as_array().ok_or("no list of branches")?;
    assert_eq!((others.len(), &summary["arms_not_followed"]), (2, &Value::from(0)));
    let first = rows(&out.path().join("branch.csv"))?;
    for other in others {
        let folder = out.path().join(other["directory"].as_str().ok_or("no folder")?);
        assert_eq!(rows(&folder.join("branch.csv"))?.len() as u64, other["points"].as_u64().ok_or("no number")?);
        assert!(folder.join("harmonics.npz").exists());
        let from = other["from_point"].as_u64().ok_or("no origin")? as usize;
        assert!(first[from][11].contains("branch-point"), "{:?}", first[from]);
    }
    let summary = rod(&out, &[])?;
    assert_eq!(summary["other_branches"], Value::Array(Vec::new()));
    assert!(!out.path().join("branch_1").exists() && !out.path().join("branch_2").exists());
    Ok(())
}

#[test]
fn a_skipped_tongue_is_marked_in_table_summary_and_figure() -> Outcome {
    let out = tempdir()?;
    let summary = rod(&out, &["continuation.internal_resonance=\"skip\""])?;
    let table = rows(&out.path().join("branch.csv"))?;
    assert_eq!(table.len() as u64, summary["points"].as_u64().ok_or("no number")?);
    let feet: Vec<usize> = (0..table.len()).filter(|&i| &table[i][12] == "3:mode 2").collect();
    let [near, far] = feet[..] else { return Err(format!("{feet:?} are the feet").into()) };
    assert!(table[near][11].contains("tongue-foot") && table[far][11].contains("resumed") && far == near + 1);
    assert!(table.iter().enumerate().all(|(i, row)| row[0] == *i.to_string()));
    let tongue = &summary["internal_resonances"][0];
    assert_eq!((&tongue["name"], &tongue["skipped"]), (&Value::from("3:mode 2"), &Value::from(true)));
    assert_eq!(tongue["end"]["point"], Value::from(far));
    let figure = fs::read_to_string(out.path().join("frequency_energy.svg"))?;
    assert!(figure.contains("3:mode 2") && figure.contains("skipped-tongue"));
    Ok(())
}

#[test]
fn a_branch_starts_at_an_energy_and_goes_both_ways() -> Outcome {
    let out = tempdir()?;
    let set = ["method.harmonics=2", "continuation.start_energy_ratio=1.5", "continuation.direction=both"];
    let summary = rod(&out, &set)?;
    let table = rows(&out.path().join("branch.csv"))?;
    let energies: Vec<f64> = table.iter().map(|row| row[2].parse()).collect::<Result<_, _>>()?;
    assert!(energies.windows(2).all(|w| w[1] > w[0]), "{energies:?}");
    let start = table.iter().position(|row| row[11].contains("start")).ok_or("no start")?;
    let grazing = summary["grazing"]["energy_j"].as_f64().ok_or("no energy")?;
    assert!((energies[start] / grazing - 1.5).abs() < 1e-9 && start > 0);
    Ok(())
}

#[test]
fn two_methods_of_one_scene_have_a_folder_each_and_common_figures() -> Outcome {
    let out = tempdir()?;
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut call = Command::cargo_bin("nlmodes-cli")?;
    call.args(["run", "configs/beam_methods.toml", "--quiet", "--out"]).arg(out.path());
    let output = call.current_dir(workspace).output()?;
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    // Each modulus as in Table 1, and the same ends as the scenes with one method.
    for (folder, modulus, end) in [("ms-hbm", 181.36e9, 52.092_099), ("hbm", 187.60e9, 51.393_472)] {
        let summary: Value = serde_json::from_str(&fs::read_to_string(out.path().join(folder).join("summary.json"))?)?;
        let updated = summary["scene"]["updating"]["done"]["to"][0].as_f64().ok_or("nothing updated")?;
        assert!((updated / modulus - 1.0).abs() < 5e-6, "{updated}");
        let last = rows(&out.path().join(folder).join("branch.csv"))?.pop().ok_or("an empty table")?;
        assert!((last[1].parse::<f64>()? - end).abs() < 1e-4, "{last:?}");
    }
    for figure in ["frequency_energy", "frequency_amplitude", "participation"] {
        let text = fs::read_to_string(out.path().join(format!("{figure}.svg")))?;
        assert!(text.contains(">MS-HBM, 5 harmonics<") && text.contains(">HBM, 5 harmonics<"), "{figure}");
    }
    let summary: Value = serde_json::from_str(&fs::read_to_string(out.path().join("summary.json"))?)?;
    assert_eq!(summary["branches"].as_array().map(Vec::len), Some(2));
    Ok(())
}
