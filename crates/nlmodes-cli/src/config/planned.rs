//! Tables that belong to scenes of another command.

use toml::de::DeTable;

use crate::config::Problem;

const RECORDS: [&str; 5] = ["recording", "channel", "linear_modes", "extraction", "stop"];

/// The problem of a scene that belongs to a command that this version does not have.
pub fn problem(root: &DeTable<'_>) -> Option<Problem> {
    let first = |names: &[&str]| {
        let entries = root.iter().filter(|(key, _)| names.contains(&key.get_ref().as_ref()));
        let entry = entries.min_by_key(|(key, _)| key.span().start);
        entry.map(|(key, value)| (key.get_ref().to_string(), value.span()))
    };
    if let Some((key, range)) = first(&["virtual_test"]) {
        let problem = Problem::error("this is a scene of a virtual test, which this version does not have yet");
        return Some(problem.at(range, format!("`{key}` belongs to such a test")));
    }
    let (key, range) = first(&RECORDS)?;
    let problem = Problem::error("this is a scene for `experiment extract`, which this version does not have yet");
    Some(problem.at(range, format!("`{key}` describes measured records")))
}
