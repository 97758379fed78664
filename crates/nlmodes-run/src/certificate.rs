//! How far the numbers of a branch were looked at, and which of them not to use.
//!
//! A [`Check`] compares: its value is a relative change, its limit what counts as small. A check that was not made says so, and how to have it made; it never counts for or
//! against a number. From the checks each [`Number`] is judged: to be used, not to be used, or without anything that speaks for it.

mod contacts;
mod energy;
mod exact;
mod finer;
pub(crate) mod mesh;
mod numbers;
mod table;
#[cfg(test)]
mod tests;

use nlmodes::model::MassShift;
use nlmodes::study::ComputedBranch;
use nlmodes_scene::assemble::OpenStructure;
use nlmodes_scene::scene::Scene;
use serde::Serialize;

pub use numbers::{Number, NumberUse, Use};
pub use table::tables;

/// What was looked at in a branch, and what follows for its numbers.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Certificate {
    /// All of it in a sentence.
    pub verdict: String,
    /// Points at which checks look that take a point: that of the largest contact force, one in the middle, the last.
    pub points: Vec<usize>,
    /// What was compared, or could have been.
    pub checks: Vec<Check>,
    /// The numbers of the results, and whether to use them.
    pub numbers: Vec<NumberUse>,
}

/// How a check came out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Outcome {
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
    pub outcome: Outcome,
    /// The largest change that was found, relative; none where nothing was.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub value: Option<f64>,
    /// The point where it was found, of those that were looked at.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub point: Option<usize>,
    /// The largest that is good.
    pub limit: f64,
    /// What was compared, or why not.
    pub words: String,
    /// How to have it looked at, where it was not.
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
        let outcome = if value <= limit { Outcome::Good } else { Outcome::Doubtful };
        let value = value.is_finite().then_some(value);
        Self { name, number, outcome, value, point: None, limit, words: words.into(), how: None }
    }

    /// With the point where its value was found.
    fn at(self, worst: Worst) -> Self {
        Self { point: (worst.value != 0.0).then_some(worst.point), ..self }
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
            outcome: Outcome::NotLookedAt,
            value: None,
            point: None,
            limit,
            words: words.into(),
            how: Some(how),
        }
    }
}

/// The largest change, and the point where it was found.
#[derive(Debug, Clone, Copy, Default)]
struct Worst {
    value: f64,
    point: usize,
}

impl Worst {
    /// Takes note of what was found at a point; what is no number is worst of all.
    fn take(&mut self, point: usize, value: f64) {
        if value.is_nan() || value > self.value {
            *self = Self { value, point };
        }
    }
}

/// Largest scaled residual of equations that count as solved.
const RESIDUAL: f64 = 1e-8;

/// How to have all computed.
const CERTIFY: &str = "`run --certify`";

/// What a branch is looked at with.
#[derive(Debug, Clone, Copy)]
pub struct Sources<'a> {
    /// Its scene.
    pub scene: &'a Scene,
    /// The open modes from which its structure is made, if it is.
    pub open: Option<&'a OpenStructure>,
    /// What its linear mode loses with the mass of the contacts, if that is taken away.
    pub shift: Option<MassShift>,
    /// Whether all is computed that can be, or only what costs next to nothing.
    pub thorough: bool,
}

impl Certificate {
    /// Of a branch.
    pub fn of(computed: &ComputedBranch, sources: Sources<'_>) -> Self {
        let points = few_points(computed);
        let mut checks = vec![
            residual(computed.branch.points.iter().map(|point| point.residual)),
            contacts::complementarity(computed, &points),
            energy::drift(computed, &points, sources),
        ];
        checks.extend(finer::harmonics(computed, &points, sources));
        checks.extend(finer::modes(computed, &points, sources));
        checks.extend(exact::checks(computed, &points, sources));
        checks.extend([mesh::frequency(sources.scene), mesh::contact_mass(sources.shift, sources.open.is_some())]);
        Self::new(points, checks)
    }

    /// What checks at these points come to.
    pub(crate) fn new(points: Vec<usize>, checks: Vec<Check>) -> Self {
        let numbers = Number::ALL.map(|number| NumberUse::new(number, &checks)).to_vec();
        Self { verdict: verdict(&checks, &numbers), points, checks, numbers }
    }
}

/// Whether the equations are solved.
pub(crate) fn residual(of: impl Iterator<Item = f64>) -> Check {
    let mut worst = Worst::default();
    of.enumerate().for_each(|(point, residual)| worst.take(point, residual));
    let (largest, words) = (worst.value, "largest scaled residual of all points");
    Check::found("equations", None, largest, RESIDUAL, words).at(worst)
}

/// What all checks come to.
fn verdict(checks: &[Check], numbers: &[NumberUse]) -> String {
    let looked = checks.iter().filter(|check| check.outcome != Outcome::NotLookedAt).count();
    let doubtful = checks.iter().filter(|check| check.outcome == Outcome::Doubtful).count();
    let of = |wanted: Use| {
        let names = numbers.iter().filter(|n| n.usable == wanted).map(|n| n.number.name());
        names.collect::<Vec<_>>().join(", ")
    };
    let mut text = format!("{looked} of {} checks made, {doubtful} of them doubtful", checks.len());
    for (wanted, said) in [(Use::No, "do not use"), (Use::NotShown, "nothing speaks for"), (Use::Yes, "to be used")] {
        let names = of(wanted);
        if !names.is_empty() {
            text += &format!("; {said}: {names}");
        }
    }
    text
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

/// `1, 5 and 9`, to be read behind "point" or "points".
fn listed(points: &[usize]) -> String {
    let names: Vec<String> = points.iter().map(usize::to_string).collect();
    match names.split_last() {
        Some((last, [])) => format!("point {last}"),
        Some((last, others)) => format!("points {} and {last}", others.join(", ")),
        None => "no point".to_owned(),
    }
}
