//! Cost of a branch, in evaluations of residual and Jacobian and in points: counts that are the same on every machine.

use std::error::Error;
use std::path::Path;

use assert_cmd::Command;
use serde_json::Value;
use tempfile::tempdir;

/// Scene, its settings, and the maximum number of evaluations for its branch: a tenth above the actual one, to allow
/// for another compiler's rounding. Without symmetry, half of those of the rod are the search for the branches at its
/// branch point. The unknowns of ten stops are modal coordinates.
const MOST: [(&str, &str, u64); 9] = [
    ("rod", "method.harmonics=3", 803),
    ("rod", "method.harmonics=20", 1885),
    ("rod", "method.symmetry=none", 1507),
    ("beam", "method.harmonics=5", 282),
    ("beam_two_stops", "method.mass_redistribution=\"drop\"", 657),
    ("beam_ten_stops", "method.mass_redistribution=\"drop\"", 561),
    ("rod_two_stops", "method.mass_redistribution=\"drop\"", 394),
    ("beam_two_stops", "method.symmetry=\"even\"", 478),
    ("beam_ten_stops", "method.symmetry=\"even\"", 470),
];

#[test]
fn branches_take_no_more_evaluations_than_they_did() -> Result<(), Box<dyn Error>> {
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut table = Vec::new();
    for (scene, setting, most) in MOST {
        let out = tempdir()?;
        let folder = out.path().join("out");
        let mut command = Command::cargo_bin("nlmodes-cli")?;
        let quick =
            ["--set", setting, "--set", "output.figures=false", "--set", "output.page=false", "--quiet", "--out"];
        let run = command.arg("run").arg(format!("configs/{scene}.toml")).args(quick).arg(&folder);
        run.current_dir(&workspace).assert().success();
        let summary: Value = serde_json::from_str(&std::fs::read_to_string(folder.join("summary.json"))?)?;
        let [points, evaluations] = ["points", "evaluations"].map(|key| summary[key].as_u64().unwrap_or(u64::MAX));
        table.push((scene, setting, points, evaluations, most));
    }
    assert!(
        table.iter().all(|(_, _, _, evaluations, most)| evaluations <= most),
        "scene, setting, points, evaluations, most: {table:?}"
    );
    Ok(())
}
