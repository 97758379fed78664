//! Certificates as tables of the page.

use nlmodes::report::DataTable;

use super::{Certificate, Check, CheckOutcome, NumberError, Place, margin, share};

impl CheckOutcome {
    /// In words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Good => "good",
            Self::Doubtful => "doubtful",
            Self::Estimated => "estimated",
            Self::NotMade => "not made",
        }
    }
}

/// The errors of the numbers and the checks, for the branch of this name; without a name if it is the only one.
///
/// `branch` is its number on the page, from 0, where its points can be chosen there.
pub fn tables(certificate: &Certificate, name: Option<&str>, branch: Option<usize>) -> [DataTable; 3] {
    let of = |title: &str| name.map_or_else(|| title.to_owned(), |name| format!("{title} ({name})"));
    let mut numbers =
        DataTable::new(of("Estimated errors"), &["number", "relative error", "largest source", "smaller with"]);
    numbers.rows = certificate.errors.iter().map(error).collect();
    let head = ["check", "of", "came out", "largest", "good up to", "what was compared"];
    let mut checks = DataTable::new(of("Checks"), &head);
    checks.rows = certificate.checks.iter().map(row).collect();
    let mut points = DataTable::new(
        of("Points that were compared"),
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

fn error(error: &NumberError) -> Vec<String> {
    let met = error.met.as_ref().map_or_else(String::new, |met| {
        let is = if met.everywhere { "met" } else { "not met" };
        format!(" ({} required: {is})", share(met.required))
    });
    let source = match &error.source {
        Some(source) => source.name.clone(),
        None => error.why.clone(),
    };
    vec![
        format!("{} ({})", error.number.meaning(), error.number.column()),
        error.estimate.map_or_else(|| "not known".to_owned(), |estimate| format!("{}{met}", margin(estimate))),
        source,
        error.command.clone().unwrap_or_default(),
    ]
}

fn row(check: &Check) -> Vec<String> {
    let at = check.place.map_or_else(String::new, |place| format!(" (point {}, {} Hz)", place.point, place.hertz()));
    let value = check.value.map_or_else(|| "–".to_owned(), |value| format!("{}{at}", share(value)));
    let how = check.how.map_or_else(String::new, |how| format!("; to have it made: {how}"));
    vec![
        check.name.into(),
        check.number.map_or("all numbers", super::Number::meaning).into(),
        check.outcome.name().into(),
        value,
        check.limit.map_or_else(|| "–".to_owned(), share),
        format!("{}{how}", check.words),
    ]
}
