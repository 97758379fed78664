//! Certificates as tables of the page.

use nlmodes::report::DataTable;

use super::{Certificate, Check, CheckOutcome, Place, share};

impl CheckOutcome {
    /// In words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Good => "good",
            Self::Doubtful => "doubtful",
            Self::NotLookedAt => "not looked at",
        }
    }
}

/// What to use, and the reasons, for the branch of this name; without a name if it is the only one.
///
/// `branch` is its number on the page, from 0, where its points can be chosen there.
pub fn tables(certificate: &Certificate, name: Option<&str>, branch: Option<usize>) -> [DataTable; 3] {
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
    let mut points = DataTable::new(
        of("Points that were looked at"),
        &["point", "frequency, Hz", "energy, J", "came out", "what speaks against it"],
    );
    points.chooses = branch;
    let doubt = |point: usize| certificate.points_in_doubt.iter().find(|doubt| doubt.place.point == point);
    let mut all: Vec<Place> = certificate.points.clone();
    all.extend(certificate.points_in_doubt.iter().map(|doubt| doubt.place));
    all.sort_by_key(|place| place.point);
    all.dedup_by_key(|place| place.point);
    let of_point = |place: Place| {
        let (outcome, against) = match doubt(place.point) {
            Some(doubt) => (CheckOutcome::Doubtful, doubt.against.join(", ")),
            None => (CheckOutcome::Good, String::new()),
        };
        vec![place.point.to_string(), place.hertz(), place.joule(), outcome.name().into(), against]
    };
    points.rows = all.into_iter().map(of_point).collect();
    [numbers, points, checks]
}

fn row(check: &Check) -> Vec<String> {
    let at = check.place.map_or_else(String::new, |place| format!(" (point {}, {} Hz)", place.point, place.hertz()));
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
