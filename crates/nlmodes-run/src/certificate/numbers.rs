//! The numbers of a branch, and the estimated error of each.

use std::collections::BTreeMap;

use nlmodes_scene::scene::Requirement;
use serde::{Serialize, Serializer};

use super::finer::UNTOUCHED;
use super::{Check, CheckOutcome, Place, margin, share};

/// A number of the results, or several with a common error.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Number {
    /// The nonlinear modal frequency.
    Frequency,
    /// The largest displacement of the first contact, and with it motions in time.
    Displacement,
    /// The impulse of each contact.
    Impulse,
    /// The largest contact force.
    PeakForce,
}

impl Number {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Frequency, Self::Displacement, Self::Impulse, Self::PeakForce];

    /// What it is.
    pub fn meaning(self) -> &'static str {
        match self {
            Self::Frequency => "frequency",
            Self::Displacement => "displacement",
            Self::Impulse => "impulse",
            Self::PeakForce => "largest contact force",
        }
    }

    /// Its column in the tables.
    pub fn column(self) -> &'static str {
        match self {
            Self::Frequency => "frequency_hz",
            Self::Displacement => "peak_m",
            Self::Impulse => "impulse_ns",
            Self::PeakForce => "peak_contact_force_n",
        }
    }

    /// The error that a scene requires of it.
    fn required(self, required: &Requirement) -> Option<f64> {
        match self {
            Self::Frequency => required.frequency,
            Self::Displacement => required.displacement,
            Self::Impulse => required.impulse,
            Self::PeakForce => required.peak_force,
        }
    }
}

/// Where an error comes from.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct ErrorSource {
    /// What is neglected.
    pub kind: SourceKind,
    /// The same with its number: `3 harmonics`.
    pub name: String,
    /// The arguments of `run` that make the error smaller, or what else does.
    pub command: String,
}

/// What is neglected. Errors of different kinds are independent of each other; of one kind the largest counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum SourceKind {
    /// Harmonics beyond the highest.
    Harmonics,
    /// Modes beyond the highest.
    Modes,
    /// Finer elements.
    Mesh,
    /// The mass of the contacts.
    ContactMass,
    /// Digits that files do not have.
    Digits,
    /// The motion of dashpots beyond the modes.
    Dashpots,
}

/// A number with its estimated error.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NumberError {
    /// The number.
    #[serde(skip)]
    pub number: Number,
    /// Estimated relative error: root of the sum of squares of the sources, at the point where it is largest among
    /// those compared; none where nothing was compared.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub estimate: Option<f64>,
    /// Where it is not known: that of the sources which are, at all points alike.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub at_least: Option<f64>,
    /// The largest source.
    #[serde(skip_serializing_if = "Option::is_none", serialize_with = "kind_of")]
    pub source: Option<ErrorSource>,
    /// What makes it smaller.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub command: Option<String>,
    /// The error that is required, and where it is met.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub met: Option<Met>,
    /// Points that do not meet the required error.
    #[serde(skip)]
    pub beyond: Vec<usize>,
    /// Why nothing was compared.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub why: String,
}

fn kind_of<S: Serializer>(source: &Option<ErrorSource>, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(source.as_ref().map_or("", |source| &source.name))
}

/// Relative error from which on known sources are told although others are not known.
const WORTH_TELLING: f64 = 1e-3;

/// A required error, and where it is met.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Met {
    /// The largest relative error that is required.
    pub required: f64,
    /// Whether it is met at all points that were compared.
    pub everywhere: bool,
    /// Share of the compared points that meet it.
    pub share: f64,
    /// Segments of the curve, from point to point of those compared, that do not: frequencies of their ends, Hz.
    pub except_hz: Vec<[f64; 2]>,
}

impl NumberError {
    /// From the comparisons of all points `all`; `required` where the scene asks for an error.
    pub(super) fn new(number: Number, checks: &[Check], all: &[Place], required: &Requirement) -> Self {
        let own: Vec<&Check> = checks.iter().filter(|check| check.number == Some(number)).collect();
        let found = || own.iter().filter(|check| check.outcome != CheckOutcome::NotMade);
        let constant = of_kinds(found().filter(|check| check.looked.is_empty()).copied());
        let mut points: BTreeMap<usize, Vec<&Check>> = BTreeMap::new();
        found().for_each(|check| check.looked.iter().for_each(|(k, _)| points.entry(*k).or_default().push(check)));
        let at = |k: usize, of: &[&Check]| {
            let value = |check: &&Check| check.looked.iter().find(|(point, _)| *point == k).map(|(_, value)| *value);
            let mut kinds = constant.clone();
            of.iter().for_each(|check| take(&mut kinds, check, value(check)));
            kinds
        };
        let each: Vec<(usize, Kinds)> = points.iter().map(|(k, of)| (*k, at(*k, of))).collect();
        let worst = each.iter().map(|(_, kinds)| kinds).max_by(|a, b| total(a).total_cmp(&total(b)));
        let kinds = worst.unwrap_or(&constant);
        let is_known = found().any(|check| check.is_truncation()) && total(kinds).is_finite();
        let why = own.iter().find(|check| check.outcome == CheckOutcome::NotMade).map_or("", |check| &check.words);
        let at_least = Some(total(&constant)).filter(|least| !is_known && *least >= WORTH_TELLING);
        let kinds = if is_known { kinds } else { &constant };
        let source = kinds.values().max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, source)| source.clone());
        let source = source.filter(|_| at_least.is_some() || (is_known && total(kinds) > 0.0));
        let required = number.required(required).filter(|most| is_known || at_least.is_some_and(|least| least > *most));
        Self {
            number,
            estimate: is_known.then(|| total(kinds)),
            at_least,
            command: source.as_ref().map(|source| source.command.clone()).filter(|command| !command.is_empty()),
            source,
            beyond: required.map_or(Vec::new(), |required| beyond(required, &each)),
            met: required.map(|required| met(required, &each, total(&constant), all)),
            why: if is_known { String::new() } else { why.to_owned() },
        }
    }

    /// `frequency ±0.7 %`, with what is required; that it is not known, and why.
    pub(super) fn text(&self) -> String {
        let name = self.number.meaning();
        let met = self.met.as_ref().map_or_else(String::new, Met::text);
        match self.estimate {
            Some(estimate) => format!("{name} {}{met}", margin(estimate)),
            None => format!("{} not known, {}", self.name_with_least(), self.why),
        }
    }

    /// Its name and, where it is not known, what is: `frequency (at least ±1.7 %, mass of the contacts left out)`.
    fn name_with_least(&self) -> String {
        let name = self.number.meaning();
        let (Some(least), Some(source)) = (self.at_least, &self.source) else { return name.to_owned() };
        let met = self.met.as_ref().map_or_else(String::new, Met::text);
        format!("{name} (at least {}, {}{met})", margin(least), source.name)
    }
}

/// All numbers with their errors: those with the same largest source, or the same reason why they are not known, one
/// after the other, with that source or reason once.
pub(super) fn all(errors: &[NumberError]) -> String {
    let source = |error: &NumberError| error.source.as_ref().map(|source| source.name.clone());
    let known = |error: &NumberError| error.estimate.map(|_| source(error));
    let groups = errors.chunk_by(|a, b| (known(a), &a.why) == (known(b), &b.why));
    let one = |group: &[NumberError]| match &group[0] {
        first if first.estimate.is_none() => {
            let names: Vec<String> = group.iter().map(NumberError::name_with_least).collect();
            let are = if first.why == UNTOUCHED { "have none of harmonics" } else { "not known" };
            format!("{} {are}, {}", names.join(", "), first.why)
        }
        first => {
            let texts: Vec<String> = group.iter().map(NumberError::text).collect();
            texts.join(", ") + &source(first).map_or_else(String::new, |source| format!(" ({source})"))
        }
    };
    groups.map(one).collect::<Vec<_>>().join(" · ")
}

impl Met {
    /// Whether the requirement is met, and where it is not.
    fn text(&self) -> String {
        if self.everywhere {
            return format!(", {} required: met", share(self.required));
        }
        let stretch = |[low, high]: &[f64; 2]| {
            let hertz = |hz: f64| super::points::digits(hz, 4);
            if low == high { format!("{} Hz", hertz(*low)) } else { format!("{} to {} Hz", hertz(*low), hertz(*high)) }
        };
        let all: Vec<String> = self.except_hz.iter().map(stretch).collect();
        let (required, all) = (share(self.required), all.join(", "));
        if self.share == 0.0 {
            return format!(", {required} required: met at no compared point ({all})");
        }
        format!(", {required} required: met at {:.0} % of the compared points, not at {all}", 100.0 * self.share)
    }
}

type Kinds = BTreeMap<SourceKind, (f64, ErrorSource)>;

/// The largest of each kind.
fn of_kinds<'a>(checks: impl Iterator<Item = &'a Check>) -> Kinds {
    let mut kinds = Kinds::new();
    checks.for_each(|check| take(&mut kinds, check, check.value));
    kinds
}

fn take(kinds: &mut Kinds, check: &Check, value: Option<f64>) {
    let (Some(source), Some(value)) = (&check.source, value) else { return };
    let own = kinds.entry(source.kind).or_insert_with(|| (0.0, source.clone()));
    if value.is_nan() || value > own.0 {
        *own = (value, source.clone());
    }
}

/// Independent errors together.
fn total(kinds: &Kinds) -> f64 {
    kinds.values().map(|(value, _)| value * value).sum::<f64>().sqrt()
}

/// Points with a larger error than that; NaN is one.
fn beyond(required: f64, each: &[(usize, Kinds)]) -> Vec<usize> {
    let errors = each.iter().map(|(k, kinds)| (*k, total(kinds)));
    errors.filter(|(_, error)| error.is_nan() || *error > required).map(|(k, _)| k).collect()
}

fn met(required: f64, each: &[(usize, Kinds)], constant: f64, all: &[Place]) -> Met {
    let mut values: Vec<(usize, f64)> = each.iter().map(|(k, kinds)| (*k, total(kinds))).collect();
    if values.is_empty() {
        values = (0..all.len()).map(|k| (k, constant)).collect();
    }
    let good = values.iter().filter(|(_, value)| *value <= required).count();
    let mut except: Vec<[f64; 2]> = Vec::new();
    let mut is_open = false;
    for (k, value) in &values {
        let Some(place) = all.get(*k).filter(|_| value.is_nan() || *value > required) else {
            is_open = false;
            continue;
        };
        match except.last_mut().filter(|_| is_open) {
            Some([low, high]) => (*low, *high) = (low.min(place.frequency_hz), high.max(place.frequency_hz)),
            None => except.push([place.frequency_hz; 2]),
        }
        is_open = true;
    }
    let share = if values.is_empty() { 0.0 } else { good as f64 / values.len() as f64 };
    Met { required, everywhere: !values.is_empty() && good == values.len(), share, except_hz: except }
}
