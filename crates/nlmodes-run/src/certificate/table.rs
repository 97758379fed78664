//! Certificates as tables of the page.

use nlmodes::report::DataTable;

use super::{Certificate, Check, Outcome, share};

impl Outcome {
    /// In words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Good => "good",
            Self::Doubtful => "doubtful",
            Self::NotLookedAt => "not looked at",
        }
    }
}

/// What to use, and what it was judged by, of the branch of this name; without a name where it is the only one.
pub fn tables(certificate: &Certificate, name: Option<&str>) -> [DataTable; 2] {
    let of = |title: &str| name.map_or_else(|| title.to_owned(), |name| format!("{title} ({name})"));
    let mut numbers = DataTable::new(of("Which numbers to use"), &["number", "use it", "why"]);
    numbers.rows = certificate
        .numbers
        .iter()
        .map(|n| vec![format!("{} ({})", n.number.meaning(), n.number.name()), n.usable.name().into(), n.words.clone()])
        .collect();
    let head = ["looked at", "of", "came out", "largest", "good up to", "what was compared"];
    let mut checks = DataTable::new(of("What was looked at, and what was not"), &head);
    checks.rows = certificate.checks.iter().map(row).collect();
    [numbers, checks]
}

fn row(check: &Check) -> Vec<String> {
    let at = check.point.map_or_else(String::new, |point| format!(" (point {point})"));
    let value = check.value.map_or_else(|| "–".to_owned(), |value| format!("{}{at}", share(value)));
    let how = check.how.map_or_else(String::new, |how| format!("; to have it looked at: {how}"));
    vec![
        check.name.into(),
        check.number.map_or("all numbers", super::Number::meaning).into(),
        check.outcome.name().into(),
        value,
        share(check.limit),
        format!("{}{how}", check.words),
    ]
}
