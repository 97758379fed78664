//! The numbers of a branch, and the verdicts on them.

use serde::Serialize;

use super::{Check, CheckOutcome, Place, named, share};

/// A number of the results, or several with a common verdict.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub enum Number {
    /// The nonlinear modal frequency.
    #[serde(rename = "frequency_hz")]
    Frequency,
    /// The largest displacement of the first contact, and with it motions in time.
    #[serde(rename = "peak_m")]
    Displacement,
    /// The impulse of each contact.
    #[serde(rename = "impulse_ns")]
    Impulse,
    /// The largest contact force.
    #[serde(rename = "peak_contact_force_n")]
    PeakForce,
}

impl Number {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Frequency, Self::Displacement, Self::Impulse, Self::PeakForce];

    /// Its name in the tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Frequency => "frequency_hz",
            Self::Displacement => "peak_m",
            Self::Impulse => "impulse_ns",
            Self::PeakForce => "peak_contact_force_n",
        }
    }

    /// What it is.
    pub fn meaning(self) -> &'static str {
        match self {
            Self::Frequency => "frequency",
            Self::Displacement => "largest displacement, motions in time",
            Self::Impulse => "impulse of each contact",
            Self::PeakForce => "largest contact force",
        }
    }

    /// Largest relative change that is good.
    pub fn limit(self) -> f64 {
        match self {
            Self::Frequency => 1e-3,
            Self::Displacement => 1e-2,
            Self::Impulse => 2e-2,
            Self::PeakForce => 5e-2,
        }
    }
}

/// Whether to use a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Use {
    /// Everything that could change it was checked, and is within its limit.
    Yes,
    /// A check speaks against it.
    No,
    /// The truncation of harmonics was not checked.
    NotShown,
}

impl Use {
    /// In words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Yes => "yes",
            Self::No => "no",
            Self::NotShown => "not shown",
        }
    }
}

/// A number, whether to use it, and why.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NumberUse {
    /// The number.
    pub number: Number,
    /// Whether to use it.
    #[serde(rename = "use")]
    pub usable: Use,
    /// The largest relative change found by a check; none without a check.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub largest_change: Option<f64>,
    /// Why, and what to do.
    pub words: String,
}

impl NumberUse {
    /// Its verdict.
    pub(super) fn new(number: Number, checks: &[Check]) -> Self {
        let speaks = |check: &&Check| check.number.is_none_or(|n| n == number);
        let own = |check: &&Check| check.number == Some(number);
        let made = checks.iter().filter(own).filter(|check| check.outcome != CheckOutcome::NotLookedAt);
        let largest_change = made.filter_map(|check| check.value).reduce(f64::max);
        let against: Vec<&Check> =
            checks.iter().filter(speaks).filter(|c| c.outcome == CheckOutcome::Doubtful).collect();
        let truncation = |name: &str| {
            checks.iter().filter(own).any(|check| check.name == name && check.outcome == CheckOutcome::Good)
        };
        let (usable, words) = if !against.is_empty() {
            (Use::No, format!("{}{}", refused(&against), instead(number, checks)))
        } else if truncation("harmonics") || truncation("exact motion") {
            (Use::Yes, used(number, largest_change.unwrap_or(0.0)))
        } else {
            let missing = checks.iter().find(|check| check.name == "harmonics" && own(check));
            (Use::NotShown, not_shown(number, missing.and_then(|check| check.how).unwrap_or(super::CERTIFY)))
        };
        Self { number, usable, largest_change, words }
    }
}

/// What speaks against a number.
fn refused(against: &[&Check]) -> String {
    let one = |check: &&Check| match check.value {
        _ if !check.lost.is_empty() => {
            let more = check.name;
            let at = named(&check.lost);
            let found = check.value.filter(|value| *value > check.limit).map_or_else(String::new, |value| {
                format!(", and {}{}, good is up to {}", share(value), place(check), share(check.limit))
            });
            format!("{more}: no motion with twice as many leads from {at} and back{found}")
        }
        Some(value) => {
            format!("{}: {}{}, good is up to {}", check.name, share(value), place(check), share(check.limit))
        }
        None => format!("{}: {}", check.name, check.words),
    };
    against.iter().map(one).collect::<Vec<_>>().join("; ")
}

/// ` at point 7 (66.123 Hz, 0.0124 J)`; nothing where it is at none.
fn place(check: &Check) -> String {
    let energy = |place: &Place| place.energy_j.map_or_else(String::new, |_| format!(", {} J", place.joule()));
    check
        .place
        .map_or_else(String::new, |place| format!(" at point {} ({} Hz{})", place.point, place.hertz(), energy(&place)))
}

/// What to use instead of a largest force, depending on the verdict on impulses.
fn instead(number: Number, checks: &[Check]) -> &'static str {
    if number != Number::PeakForce {
        return "";
    }
    match NumberUse::new(Number::Impulse, checks).usable {
        Use::Yes => "; impulse_ns (contacts.csv) is good: use that",
        Use::No => "; the impulse is not good either: more harmonics",
        Use::NotShown => "",
    }
}

fn used(number: Number, change: f64) -> String {
    let reserve = match number {
        Number::Frequency => "",
        Number::Displacement | Number::Impulse => "; on this mesh",
        Number::PeakForce => {
            "; on this mesh: what finer elements change, before a rigid stop often much, was not looked at"
        }
    };
    format!("to {}{reserve}", share(change))
}

fn not_shown(number: Number, how: &str) -> String {
    let why = match number {
        Number::PeakForce => "; of all numbers this one takes most harmonics: do not use it before that",
        _ => "",
    };
    format!("what harmonics leave out was not looked at; to have it looked at: {how}{why}")
}
