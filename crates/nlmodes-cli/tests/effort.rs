//! What a branch costs, in evaluations of residual and Jacobian and in points: counts that are the same on every machine.

use std::error::Error;
use std::path::Path;

use assert_cmd::Command;
use serde_json::Value;
use tempfile::tempdir;

/// Scene, and the most evaluations that its branch may take: a tenth above what it takes, which leaves room for another compiler's rounding.
const MOST: [(&str, u64); 5] =
    [("rod", 1140), ("beam", 310), ("beam_two_stops", 740), ("beam_ten_stops", 605), ("rod_two_stops", 405)];

#[test]
fn branches_take_no_more_evaluations_than_they_did() -> Result<(), Box<dyn Error>> {
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut table = Vec::new();
    for (scene, most) in MOST {
        let out = tempdir()?;
        let folder = out.path().join("out");
        let mut command = Command::cargo_bin("nlmodes-cli")?;
        let quick = ["--set", "output.figures=false", "--set", "output.page=false", "--quiet", "--out"];
        let run = command.arg("run").arg(format!("configs/{scene}.toml")).args(quick).arg(&folder);
        run.current_dir(&workspace).assert().success();
        let summary: Value = serde_json::from_str(&std::fs::read_to_string(folder.join("summary.json"))?)?;
        let [points, evaluations] = ["points", "evaluations"].map(|key| summary[key].as_u64().unwrap_or(u64::MAX));
        table.push((scene, points, evaluations, most));
    }
    assert!(
        table.iter().all(|(_, _, evaluations, most)| evaluations <= most),
        "scene, points, evaluations, most: {table:?}"
    );
    Ok(())
}
