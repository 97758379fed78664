//! Verification report: the estimated error of each number of a branch, and checks that its equations hold.
//!
//! A [`Check`] is a comparison. One of the equations has a limit and passes or fails; one that estimates what something
//! neglected does to a [`Number`] has none: from all of these each number gets its [`NumberError`], the sources of
//! different kinds as independent ones. A check that was not made states why, and how to have it made.

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

use std::collections::{BTreeMap, HashSet};
use std::time::Duration;

use nlmodes::branches::{ComputedBranch, Watch};
use nlmodes::modal::ModalPoint;
use nlmodes::model::MassShift;
use nlmodes::report::HtmlReport;
use nlmodes_scene::assemble::OpenStructure;
use nlmodes_scene::scene::{Requirement, Scene};
use serde::Serialize;

pub use numbers::{ErrorSource, Met, Number, NumberError, SourceKind};
pub use points::{Place, PointInDoubt};
pub use table::tables;

/// The verification report of a branch: the errors of its numbers, and the checks.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Certificate {
    /// All of it in a sentence.
    pub verdict: String,
    /// Whether all checks were made, as requested by `run --certify`.
    pub thorough: bool,
    /// Points at which point-wise checks were made; nothing is known of the others.
    pub points: Vec<Place>,
    /// Those at which equations do not hold, a required error is not met, or no motion to compare with was found.
    pub points_in_doubt: Vec<PointInDoubt>,
    /// What was compared, or could have been.
    pub checks: Vec<Check>,
    /// The numbers of the results, and their errors; beside the report in `summary.json`.
    #[serde(skip)]
    pub errors: Vec<NumberError>,
    /// Number of all points.
    #[serde(skip)]
    all: usize,
}

/// How a check came out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum CheckOutcome {
    /// Within its limit.
    Good,
    /// Beyond it.
    Doubtful,
    /// An estimated error, which has no limit of its own.
    Estimated,
    /// Not computed.
    NotMade,
}

/// A comparison.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Check {
    /// What is compared.
    pub name: &'static str,
    /// The number to which it applies; all where there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub number: Option<Number>,
    /// What is neglected, for an estimate.
    #[serde(skip)]
    pub source: Option<ErrorSource>,
    /// How it came out.
    pub outcome: CheckOutcome,
    /// The largest change that was found, relative; none where nothing was.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub value: Option<f64>,
    /// The point with this value, and where that is on the curve.
    #[serde(flatten)]
    pub place: Option<Place>,
    /// The points of a point-wise check, and the value of each.
    #[serde(skip_serializing_if = "Vec::is_empty", serialize_with = "points::of_values")]
    pub looked: Vec<(usize, f64)>,
    /// Those from which no motion was found to compare with.
    #[serde(skip_serializing_if = "Vec::is_empty", serialize_with = "points::numbers")]
    pub lost: Vec<Place>,
    /// The largest that is good, for a check of the equations.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub limit: Option<f64>,
    /// What was compared, or why not.
    pub words: String,
    /// How to have it made, if it was not.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub how: Option<&'static str>,
}

impl Check {
    /// A check of the equations, good up to `limit`.
    pub(crate) fn found(name: &'static str, value: f64, limit: f64, words: impl Into<String>) -> Self {
        let outcome = if value <= limit { CheckOutcome::Good } else { CheckOutcome::Doubtful };
        let value = value.is_finite().then_some(value);
        Self { outcome, value, how: None, limit: Some(limit), ..Self::missing(name, None, words, "") }
    }

    /// An estimate of what something neglected does to a number.
    pub(crate) fn estimate(
        name: &'static str,
        (number, source): (Number, ErrorSource),
        value: f64,
        words: impl Into<String>,
    ) -> Self {
        Self { number: Some(number), source: Some(source), ..Self::measured(name, value, words) }
    }

    /// A measure of the motion that is the error of no number.
    pub(crate) fn measured(name: &'static str, value: f64, words: impl Into<String>) -> Self {
        let (outcome, value) = (CheckOutcome::Estimated, value.is_finite().then_some(value));
        Self { outcome, value, how: None, ..Self::missing(name, None, words, "") }
    }

    /// With the value at each point.
    fn at(self, worst: &Worst) -> Self {
        Self { looked: worst.all.clone(), ..self }
    }

    /// From these points no motion was found to compare with.
    fn without(self, lost: &[Place]) -> Self {
        Self { lost: lost.to_vec(), ..self }
    }

    pub(crate) fn missing(
        name: &'static str,
        number: Option<Number>,
        words: impl Into<String>,
        how: &'static str,
    ) -> Self {
        Self {
            name,
            number,
            source: None,
            outcome: CheckOutcome::NotMade,
            value: None,
            place: None,
            looked: Vec::new(),
            lost: Vec::new(),
            limit: None,
            words: words.into(),
            how: (!how.is_empty()).then_some(how),
        }
    }

    /// Whether it compares with motions of more harmonics.
    fn is_truncation(&self) -> bool {
        self.source.as_ref().is_some_and(|source| source.kind == SourceKind::Harmonics)
    }

    /// The points that fail a limit.
    fn failed(&self) -> impl Iterator<Item = usize> {
        // NaN does not pass either.
        let fails = |value: f64| self.limit.is_some_and(|limit| value.is_nan() || value > limit);
        self.looked.iter().filter(move |(_, value)| fails(*value)).map(|(point, _)| *point)
    }

    /// The point of the largest value, if that is not zero.
    fn worst(&self) -> Option<usize> {
        let largest = self.looked.iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
        (largest.1 != 0.0).then_some(largest.0)
    }
}

/// The largest change, and the change at each point.
#[derive(Debug, Clone, Default)]
struct Worst {
    value: f64,
    all: Vec<(usize, f64)>,
}

impl Worst {
    /// Records the change at a point, if any; NaN is the worst.
    fn take(&mut self, point: usize, value: impl Into<Option<f64>>) {
        let Some(value) = value.into() else { return };
        if value.is_nan() || value > self.value {
            self.value = value;
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
    /// How long the points of the branch took.
    pub points_time: Duration,
    /// Who may end what takes long.
    pub watch: &'a Watch,
}

impl Certificate {
    /// Of a branch.
    pub fn of(computed: &ComputedBranch, sources: Sources<'_>, look: Looking<'_>) -> Self {
        let (points, all) = (few_points(computed), &computed.branch.points);
        let mut checks =
            vec![residual(all.iter().map(|point| point.residual)), contacts::complementarity(computed, &points)];
        checks.push(energy::drift(computed, &points, sources));
        checks.extend(finer::harmonics(computed, &points, sources, look));
        checks.extend(finer::modes(computed, &points, sources, look));
        checks.extend(exact::checks(computed, &points, sources, look));
        checks.push(mesh::frequency(sources.scene, sources.open));
        checks.extend(mesh::contact_mass(sources.shift));
        checks.extend(sources.open.and_then(|open| mesh::digits(open, sources.scene.method.mode)));
        let required = required(sources.scene);
        Self { thorough: sources.thorough, ..Self::new(&points::places(all), checks, &required) }
    }

    /// Result of checks at these points.
    pub(crate) fn new(all: &[Place], mut checks: Vec<Check>, required: &Requirement) -> Self {
        checks.iter_mut().for_each(|check| check.place = check.worst().and_then(|point| all.get(point).copied()));
        let errors = Number::ALL.map(|number| NumberError::new(number, &checks, all, required)).to_vec();
        let (points, points_in_doubt) = (points::compared(&checks, all), points::in_doubt(&checks, &errors, all));
        let mut found =
            Self { verdict: String::new(), thorough: false, points, points_in_doubt, checks, errors, all: all.len() };
        found.verdict = found.text("");
        found
    }

    /// The errors of the numbers in a sentence, and whether the equations hold; `name` is that of the branch, if there
    /// are several.
    pub fn text(&self, name: &str) -> String {
        let mut commands: Vec<&str> = self.errors.iter().filter_map(|error| error.command.as_deref()).collect();
        let mut known = HashSet::new();
        commands.retain(|command| known.insert(*command));
        let smaller =
            if commands.is_empty() { String::new() } else { format!("; smaller with {}", commands.join(", ")) };
        let is_known = self.errors.iter().any(|error| error.estimate.is_some());
        let lost = self.checks.iter().find(|check| !check.lost.is_empty());
        let points = match self.points.len() - lost.map_or(0, |check| check.lost.len().min(self.points.len())) {
            0 => String::new(),
            n if n == self.all => format!(", all {n} points compared"),
            n => format!(", {n} of {} points compared", self.all),
        };
        let lost = match lost {
            Some(check) if is_known => format!("; {}", finer::not_found(&check.lost)),
            Some(_) => "; more harmonics or an elastic stop may have one".to_owned(),
            None => String::new(),
        };
        let broken = self.broken().map_or_else(String::new, |broken| format!("; {broken}"));
        format!("Estimated errors{name}{points}: {}{lost}{smaller}{broken}", numbers::all(&self.errors))
    }

    /// The error of each number, by its name.
    pub(crate) fn by_number(&self) -> BTreeMap<Number, &NumberError> {
        self.errors.iter().map(|error| (error.number, error)).collect()
    }

    /// At the head of a page: the errors, and as a warning what does not hold or is not met. `name` is that of the
    /// branch, if there are several.
    pub(crate) fn on_the_head<'a>(&self, page: HtmlReport<'a>, name: Option<&str>) -> HtmlReport<'a> {
        let page = match self.warning(name) {
            Some(text) => page.warning(text),
            None => page,
        };
        page.line(format!("{}.", self.text(&of(name))))
    }

    /// Equations that do not hold and required errors that are not met, in a sentence; nothing where there are none.
    pub fn warning(&self, name: Option<&str>) -> Option<String> {
        let unmet = self.errors.iter().filter(|error| error.met.as_ref().is_some_and(|met| !met.everywhere));
        let all: Vec<String> = self.broken().into_iter().chain(unmet.map(NumberError::text)).collect();
        (!all.is_empty()).then(|| format!("Not met{}: {}.", of(name), all.join("; ")))
    }

    /// The equations that do not hold.
    fn broken(&self) -> Option<String> {
        let one = |check: &Check| match (check.value, check.limit) {
            (Some(value), Some(limit)) => {
                let at = check.place.map_or_else(String::new, |place| format!(" at point {}", place.name()));
                format!("{}: {}{at}, good is up to {}", check.name, share(value), share(limit))
            }
            _ => format!("{}: {}", check.name, check.words),
        };
        let doubtful = self.checks.iter().filter(|check| check.outcome == CheckOutcome::Doubtful);
        let all: Vec<String> = doubtful.map(one).collect();
        (!all.is_empty()).then(|| all.join("; "))
    }
}

/// ` of branch 2`, or nothing.
fn of(name: Option<&str>) -> String {
    name.map_or_else(String::new, |name| format!(" of {name}"))
}

/// The errors that a scene requires: of the frequency that of `method.accuracy`, where `output.require` has none.
pub(crate) fn required(scene: &Scene) -> Requirement {
    let mut required = scene.require;
    required.frequency = required.frequency.or(scene.method.accuracy.map(|accuracy| accuracy.error));
    required
}

/// Whether the equations are solved.
pub(crate) fn residual(of: impl Iterator<Item = f64>) -> Check {
    let mut worst = Worst::default();
    of.enumerate().for_each(|(point, residual)| worst.take(point, residual));
    worst.all.retain(|(_, value)| value.is_nan() || *value >= worst.value.min(RESIDUAL));
    Check::found("equations", worst.value, RESIDUAL, "largest scaled residual of all points").at(&worst)
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

/// A relative change as one reads it: `13 %`, `0.86 %`, `3e-5 %`.
pub(crate) fn share(value: f64) -> String {
    match 100.0 * value {
        0.0 => "0".to_owned(),
        percent if percent < 0.01 => format!("{percent:.0e} %"),
        percent if percent < 1.0 => format!("{percent:.2} %"),
        percent if percent < 10.0 => format!("{percent:.1} %"),
        percent => format!("{percent:.0} %"),
    }
}

/// `±0.7 %`; an estimate larger than the number itself says no more than that.
pub(crate) fn margin(error: f64) -> String {
    if error < 1.0 { format!("±{}", share(error)) } else { "±100 % or more".to_owned() }
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
