//! `nlmodes-cli compare`: contact solvers give the same branch, as shown in the table.

use std::collections::HashMap;
use std::error::Error;
use std::path::Path;
use std::process::Output;

use assert_cmd::Command;
use tempfile::{TempDir, tempdir};

type Outcome = Result<(), Box<dyn Error>>;
type Table = Vec<HashMap<String, String>>;

fn compare(scene: &str, more: &[&str], out: &TempDir) -> Result<Output, Box<dyn Error>> {
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut command = Command::cargo_bin("nlmodes-cli")?;
    command.args(["compare", &format!("configs/{scene}.toml"), "--out"]).arg(out.path().join("table")).args(more);
    Ok(command.current_dir(workspace).output()?)
}

fn table(out: &TempDir) -> Result<Table, Box<dyn Error>> {
    let mut reader = csv::Reader::from_path(out.path().join("table/compare.csv"))?;
    Ok(reader.deserialize().collect::<Result<_, _>>()?)
}

fn number(row: &HashMap<String, String>, column: &str) -> f64 {
    row[column].parse().unwrap_or(f64::NAN)
}

/// All default solvers, one branch.
fn assert_same_branch(scene: &str, more: &[&str], fewest_points: f64) -> Outcome {
    let out = tempdir()?;
    let output = compare(scene, more, &out)?;
    let said = String::from_utf8_lossy(&output.stdout);
    assert_eq!(output.status.code(), Some(0), "{scene}: {said}{}", String::from_utf8_lossy(&output.stderr));
    let rows = table(&out)?;
    let solvers: Vec<&str> = rows.iter().map(|row| row["contact_solver"].as_str()).collect();
    assert_eq!(solvers, ["active-set", "proximal", "clarabel", "lemke"]);
    for (k, row) in rows.iter().enumerate() {
        assert!(said.contains(&row["contact_solver"]));
        assert!(number(row, "points") >= fewest_points, "{scene}: {row:?}");
        assert!(number(row, "violation") < 1e-12, "{scene}: {row:?}");
        assert!(number(row, "time_s") > 0.0 && number(row, "evaluations") > 0.0, "{scene}: {row:?}");
        assert!(number(row, "contact_iterations") > 0.0, "{scene}: {row:?}");
        let same = row["difference_of"] == "points" && number(row, "difference") < 1e-8;
        assert!(k == 0 && row["difference"].is_empty() || same, "{scene}: {row:?}");
    }
    Ok(())
}

#[test]
fn a_rod_with_stops_at_tip_and_middle_is_the_same_with_every_solver() -> Outcome {
    assert_same_branch("rod_two_stops", &[], 20.0)
}

#[test]
fn a_beam_between_two_stops_is_the_same_with_every_solver() -> Outcome {
    assert_same_branch("beam_two_stops", &[], 20.0)
}

#[test]
fn a_beam_over_ten_stops_is_the_same_with_every_solver() -> Outcome {
    assert_same_branch("beam_ten_stops", &["--set", "method.harmonics=2"], 20.0)
}

#[test]
fn a_solver_that_declines_is_a_row_with_its_reason() -> Outcome {
    let out = tempdir()?;
    let output = compare("rod_two_stops", &["--contact-solver", "closed-form,active-set,lemke"], &out)?;
    assert_eq!(output.status.code(), Some(1));
    assert!(String::from_utf8(output.stdout)?.contains("no branch: "));
    let rows = table(&out)?;
    assert_eq!(rows[0]["end"], "no-branch");
    assert!(rows[0]["message"].contains("at most 1 contact(s), not 2"), "{rows:?}");
    assert_eq!(rows[1]["difference"], "");
    assert!(number(&rows[2], "difference") < 1e-8);
    Ok(())
}

#[test]
fn a_branch_that_ends_early_is_told_with_status_1() -> Outcome {
    let out = tempdir()?;
    let arguments = ["--set", "continuation.max_points=3", "--contact-solver", "active-set,closed-form"];
    let output = compare("rod", &arguments, &out)?;
    assert_eq!(output.status.code(), Some(1));
    let rows = table(&out)?;
    assert!(rows.iter().all(|row| row["end"] == "max-points" && number(row, "points") >= 1.0), "{rows:?}");
    assert!(String::from_utf8(output.stdout)?.contains("early: the limit of 3 points was reached"));
    Ok(())
}

#[test]
fn wrong_calls_end_with_status_2_and_without_a_table() -> Outcome {
    let names = ["active-set", "proximal", "clarabel", "lemke", "closed-form"];
    let calls: [(&[&str], &[&str]); 3] = [
        (&["--contact-solver", "active-set,newton"], &names),
        (&["--set", "method.contact_solver=newton"], &names[..4]),
        (&["--set", "method.mode=4000"], &["method.mode"]),
    ];
    for (arguments, parts) in calls {
        let out = tempdir()?;
        let output = compare("rod", arguments, &out)?;
        let said = String::from_utf8(output.stderr)?;
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(parts.iter().all(|part| said.contains(part)), "{said}");
        assert!(std::fs::read_dir(out.path())?.next().is_none());
    }
    Ok(())
}
