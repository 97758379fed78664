//! Files derived from results by other calls, which a run replaces or removes: verification reports of `run --certify`,
//! figures as PDF and PNG.

use std::path::Path;

use serde_json::Value;

use crate::files::{folders, made_of_figures, summary};

/// How much of it there is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Replaced {
    /// Certificates for which all was computed that can be.
    pub certificates: usize,
    /// Figures as PDF or PNG.
    pub drawn: usize,
}

impl Replaced {
    /// Contents of a directory and this many levels of folders below it.
    pub fn below(directory: &Path, depth: usize) -> Self {
        let own = Self { certificates: thorough(directory), drawn: made_of_figures(directory).count() };
        let below = if depth > 0 { folders(directory) } else { Vec::new() };
        below.iter().map(|folder| Self::below(folder, depth - 1)).fold(own, Self::and)
    }

    fn and(self, other: Self) -> Self {
        Self { certificates: self.certificates + other.certificates, drawn: self.drawn + other.drawn }
    }
}

/// Complete verification reports in the summary of a directory.
fn thorough(directory: &Path) -> usize {
    let summary = summary(directory);
    let others = summary["other_branches"].as_array().into_iter().flatten();
    [&summary].into_iter().chain(others).filter(|branch| branch["certificate"]["thorough"] == Value::Bool(true)).count()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;
    use std::fs;

    #[test]
    fn certificates_and_figures_of_other_calls_are_counted_in_all_folders() {
        let directory = tempfile::tempdir().unwrap();
        let put = |name: &str, text: &str| {
            let path = directory.path().join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        };
        put("summary.json", &json!({ "certificate": { "thorough": false } }).to_string());
        // Files of somebody else stay, and are not counted.
        ["a.svg", "mine.pdf", "frequency_energy.svg", "report.html"].iter().for_each(|name| put(name, ""));
        assert_eq!(Replaced::below(directory.path(), 3), Replaced::default());
        let certified = json!({ "thorough": true });
        let others = json!([{ "certificate": certified }, { "points": 3 }]);
        put("h5/summary.json", &json!({ "certificate": certified, "other_branches": others }).to_string());
        ["frequency_energy.pdf", "frequency_energy.png", "h5/contacts_90mm.pdf", "h5/summary.pdf"]
            .iter()
            .for_each(|name| put(name, ""));
        assert_eq!(Replaced::below(directory.path(), 3), Replaced { certificates: 2, drawn: 3 });
        assert_eq!(Replaced::below(directory.path(), 0), Replaced { certificates: 0, drawn: 2 });
    }
}
