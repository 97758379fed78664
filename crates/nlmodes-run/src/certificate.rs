//! Verification report: checks of the numbers of a branch, and which of them not to use.
//!
//! A [`Check`] is a comparison: its value is a relative change, its limit the permitted one. A check that was not made
//! states this and how to have it made; it counts neither for nor against a number. From the checks each [`Number`]
//! gets a verdict: to be used, not to be used, or not shown.

mod contacts;
mod energy;
mod exact;
pub(crate) mod finer;
pub(crate) mod mesh;
mod numbers;
mod points;
mod table;
#[cfg(test)]
mod tests;

use nlmodes::branches::{ComputedBranch, Watch};
use nlmodes::modal::ModalPoint;
use nlmodes::model::MassShift;
use nlmodes::report::HtmlReport;
use nlmodes_scene::assemble::OpenStructure;
use nlmodes_scene::scene::Scene;
use serde::Serialize;

pub use numbers::{Number, NumberUse, Use};
pub use points::{Place, PointInDoubt};
pub use table::tables;

/// The verification report of a branch: checks, and verdicts on its numbers.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Certificate {
    /// All of it in a sentence.
    pub verdict: String,
    /// Whether all checks were made, as requested by `run --certify`.
    pub thorough: bool,
    /// Points at which point-wise checks were made; nothing is known of the others.
    pub points: Vec<Place>,
    /// Those of them that did not pass a check, and those that do not solve the equations.
    pub points_in_doubt: Vec<PointInDoubt>,
    /// What was compared, or could have been.
    pub checks: Vec<Check>,
    /// The numbers of the results, and whether to use them.
    pub numbers: Vec<NumberUse>,
}

impl Certificate {
    /// Its text, with the name of the branch after the first word: a sentence, and why each number is to be used or
    /// not.
    pub fn text(&self, name: &str) -> String {
        let number = |number: &NumberUse| {
            let (what, usable) = (number.number.name(), number.usable.name());
            format!("  {what}: {usable}: {}\n", number.words)
        };
        format!("Certificate{name}: {}\n", self.verdict) + &self.numbers.iter().map(number).collect::<String>()
    }
}

/// How a check came out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum CheckOutcome {
    /// Within its limit.
    Good,
    /// Beyond it.
    Doubtful,
    /// Not computed.
    NotLookedAt,
}

/// A comparison.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Check {
    /// What is looked at.
    pub name: &'static str,
    /// The number that it speaks of; all where there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub number: Option<Number>,
    /// How it came out.
    pub outcome: CheckOutcome,
    /// The largest change that was found, relative; none where nothing was.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub value: Option<f64>,
    /// The point with this value, among those checked.
    #[serde(skip)]
    pub point: Option<usize>,
    /// Where that is on the curve.
    #[serde(flatten)]
    pub place: Option<Place>,
    /// The points checked, for a point-wise check.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub looked: Vec<usize>,
    /// The points, of these or of all, that did not pass.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub failed: Vec<usize>,
    /// Those from which no motion was found to compare with.
    #[serde(skip_serializing_if = "Vec::is_empty", serialize_with = "points::numbers")]
    pub lost: Vec<Place>,
    /// The largest that is good.
    pub limit: f64,
    /// What was compared, or why not.
    pub words: String,
    /// How to have it made, if it was not.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub how: Option<&'static str>,
}

impl Check {
    pub(crate) fn found(
        name: &'static str,
        number: Option<Number>,
        value: f64,
        limit: f64,
        words: impl Into<String>,
    ) -> Self {
        let outcome = if value <= limit { CheckOutcome::Good } else { CheckOutcome::Doubtful };
        let value = value.is_finite().then_some(value);
        Self { outcome, value, how: None, ..Self::missing(name, number, limit, words, "") }
    }

    /// With the points checked, and the one with this value.
    fn at(self, worst: &Worst) -> Self {
        let looked = worst.all.iter().map(|(point, _)| *point).collect();
        self.where_it_failed(worst).looking_at(looked)
    }

    fn looking_at(self, looked: Vec<usize>) -> Self {
        Self { looked, ..self }
    }

    /// With the points at which it failed, and that where its value was found.
    fn where_it_failed(self, worst: &Worst) -> Self {
        // NaN does not pass either.
        let is_good = |value: f64| value <= self.limit;
        let failed = worst.all.iter().filter(|(_, value)| !is_good(*value)).map(|(point, _)| *point).collect();
        Self { point: (worst.value != 0.0).then_some(worst.point), failed, ..self }
    }

    /// Doubtful, since from these points no motion was found to compare with.
    fn without(mut self, lost: &[Place]) -> Self {
        if !lost.is_empty() {
            self.outcome = CheckOutcome::Doubtful;
            self.lost = lost.to_vec();
            let points = || lost.iter().map(|place| place.point);
            self.looked.extend(points());
            self.failed.extend(points());
            self.looked.sort_unstable();
            self.failed.sort_unstable();
        }
        self
    }

    pub(crate) fn missing(
        name: &'static str,
        number: Option<Number>,
        limit: f64,
        words: impl Into<String>,
        how: &'static str,
    ) -> Self {
        Self {
            name,
            number,
            outcome: CheckOutcome::NotLookedAt,
            value: None,
            point: None,
            place: None,
            looked: Vec::new(),
            failed: Vec::new(),
            lost: Vec::new(),
            limit,
            words: words.into(),
            how: Some(how),
        }
    }
}

/// The largest change, its point, and the change at each point.
#[derive(Debug, Clone, Default)]
struct Worst {
    value: f64,
    point: usize,
    all: Vec<(usize, f64)>,
}

impl Worst {
    /// Records the change at a point, if any; NaN is the worst.
    fn take(&mut self, point: usize, value: impl Into<Option<f64>>) {
        let Some(value) = value.into() else { return };
        if value.is_nan() || value > self.value {
            (self.value, self.point) = (value, point);
        }
        self.all.push((point, value));
    }
}

/// Callback with the name of the check and the point, and its number of how many, before each slow one; `false` ends
/// the checks.
pub type Looking<'a> = &'a mut dyn FnMut(&'static str, usize, [usize; 2]) -> bool;

/// Message for checks that were cancelled.
const BROKEN_OFF: &str = "it was asked to end";

/// Largest scaled residual of equations that count as solved.
const RESIDUAL: f64 = 1e-8;

/// How to have all computed.
const CERTIFY: &str = "`run --certify`";

/// Data for the checks of a branch.
#[derive(Debug, Clone, Copy)]
pub struct Sources<'a> {
    /// Its scene.
    pub scene: &'a Scene,
    /// The free-interface modes of its structure, if it is reduced to them.
    pub open: Option<&'a OpenStructure>,
    /// Effect of removing the mass of the contacts on its linear mode, if it is removed.
    pub shift: Option<MassShift>,
    /// Whether all is computed that can be, or only what costs next to nothing.
    pub thorough: bool,
    /// Who may end what takes long.
    pub watch: &'a Watch,
}

impl Certificate {
    /// Of a branch.
    pub fn of(computed: &ComputedBranch, sources: Sources<'_>, look: Looking<'_>) -> Self {
        let (points, all) = (few_points(computed), &computed.branch.points);
        let mut checks = vec![
            residual(all.iter().map(|point| point.residual)),
            contacts::complementarity(computed, &points),
            energy::drift(computed, &points, sources),
        ];
        checks.extend(finer::harmonics(computed, &points, sources, look));
        checks.extend(finer::modes(computed, &points, sources, look));
        checks.extend(exact::checks(computed, &points, sources, look));
        checks.extend([mesh::frequency(sources.scene), mesh::contact_mass(sources.shift, sources.open.is_some())]);
        Self { thorough: sources.thorough, ..Self::new(&points::places(all), checks) }
    }

    /// Result of checks at these points.
    pub(crate) fn new(all: &[Place], mut checks: Vec<Check>) -> Self {
        checks.iter_mut().for_each(|check| check.place = check.point.and_then(|point| all.get(point).copied()));
        let numbers = Number::ALL.map(|number| NumberUse::new(number, &checks)).to_vec();
        let (points, points_in_doubt) = (points::looked_at(&checks, all), points::in_doubt(&checks, all));
        let verdict = verdict(&checks, &numbers) + &points::sentence(all.len(), &points, &points_in_doubt);
        Self { verdict, thorough: false, points, points_in_doubt, checks, numbers }
    }

    /// The numbers not to use, as a warning at the head of a page, and those not shown, as a line there. `name` is that
    /// of the branch, if there are several.
    pub(crate) fn on_the_head<'a>(&self, page: HtmlReport<'a>, name: Option<&str>) -> HtmlReport<'a> {
        let page = match self.not_to_use(name) {
            Some(text) => page.warning(text),
            None => page,
        };
        match self.open(name) {
            Some(text) => page.line(text),
            None => page,
        }
    }

    /// The numbers not to use in a sentence; nothing where there are none. `name` is that of the branch among several.
    pub fn not_to_use(&self, name: Option<&str>) -> Option<String> {
        let refused = self.numbers.iter().filter(|number| number.usable == Use::No);
        let refused: Vec<String> = refused.map(|n| format!("{} ({})", n.number.meaning(), n.words)).collect();
        let of = name.map_or_else(String::new, |name| format!(" of {name}"));
        let why = "the certificate, at the foot of the page and in summary.json, says more";
        (!refused.is_empty()).then(|| format!("Do not use{of}: {}; {why}.", refused.join("; ")))
    }

    /// The numbers for which nothing speaks, and how that can be had; nothing where there are none.
    fn open(&self, name: Option<&str>) -> Option<String> {
        let open = named_so(&self.numbers, Use::NotShown, Number::meaning);
        let of = name.map_or_else(String::new, |name| format!(" of {name}"));
        let certify = self.checks.iter().any(|check| check.how == Some(CERTIFY));
        let how = if certify { format!("; {CERTIFY} looks at them") } else { String::new() };
        (!open.is_empty()).then(|| format!("Neither shown to be right nor wrong{of}: {open}{how}."))
    }
}

/// Whether the equations are solved.
pub(crate) fn residual(of: impl Iterator<Item = f64>) -> Check {
    let mut worst = Worst::default();
    of.enumerate().for_each(|(point, residual)| worst.take(point, residual));
    let (largest, words) = (worst.value, "largest scaled residual of all points");
    Check::found("equations", None, largest, RESIDUAL, words).where_it_failed(&worst)
}

/// Result of all checks.
fn verdict(checks: &[Check], numbers: &[NumberUse]) -> String {
    let looked = checks.iter().filter(|check| check.outcome != CheckOutcome::NotLookedAt).count();
    let doubtful = checks.iter().filter(|check| check.outcome == CheckOutcome::Doubtful).count();
    let mut text = format!("{looked} of {} checks made, {doubtful} of them doubtful", checks.len());
    for (wanted, said) in [(Use::No, "do not use"), (Use::NotShown, "nothing speaks for"), (Use::Yes, "to be used")] {
        let names = named_so(numbers, wanted, Number::name);
        if !names.is_empty() {
            text += &format!("; {said}: {names}");
        }
    }
    text
}

/// Names of the numbers with this verdict.
fn named_so(numbers: &[NumberUse], wanted: Use, name: fn(Number) -> &'static str) -> String {
    let names = numbers.iter().filter(|n| n.usable == wanted).map(|n| name(n.number));
    names.collect::<Vec<_>>().join(", ")
}

/// The point of the largest contact force, one in the middle and the last, each once.
fn few_points(computed: &ComputedBranch) -> Vec<usize> {
    let points = &computed.branch.points;
    let Some(last) = points.len().checked_sub(1) else { return Vec::new() };
    let force = |k: &usize| points[*k].peak_contact_force;
    let strongest = (0..points.len()).max_by(|a, b| force(a).total_cmp(&force(b)));
    let mut few: Vec<usize> = strongest.into_iter().chain([last / 2, last]).collect();
    few.sort_unstable();
    few.dedup();
    few
}

/// A relative change as one reads it: `13 %`, `0.86 %`, `3e-7`.
fn share(value: f64) -> String {
    match 100.0 * value {
        0.0 => "0".to_owned(),
        percent if percent < 0.01 => format!("{value:.0e}"),
        percent if percent < 1.0 => format!("{percent:.2} %"),
        percent if percent < 10.0 => format!("{percent:.1} %"),
        percent => format!("{percent:.0} %"),
    }
}

/// Maximum number of points listed, and of those listed with frequency.
const NAMED: [usize; 2] = [8, 3];

/// `points 1 (60.8 Hz), 5 (62.1 Hz) and 9 (66.2 Hz)`; of many the first, and between which frequencies all lie.
fn listed(points: &[usize], of: &[ModalPoint]) -> String {
    let place = |point: &usize| of.get(*point).map(|found| Place::of(*point, found));
    named(&points.iter().filter_map(place).collect::<Vec<_>>())
}

/// The same of places.
fn named(places: &[Place]) -> String {
    let [most, each] = NAMED;
    let name = |place: &Place| if places.len() > each { place.point.to_string() } else { place.name() };
    let names: Vec<String> = places.iter().take(most).map(name).collect();
    let range = if places.len() > each { points::range(places) } else { String::new() };
    match (names.split_last(), places.len() - names.len()) {
        (None, _) => "no point".to_owned(),
        (Some((last, [])), _) => format!("point {last}"),
        (Some((last, others)), 0) => format!("points {} and {last}{range}", others.join(", ")),
        (_, more) => format!("points {} and {more} more{range}", names.join(", ")),
    }
}
