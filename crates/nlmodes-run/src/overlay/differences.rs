use std::f64::consts::TAU;
use std::ops::Range;

use nlmodes::modal::{ContactPeriod, Event, ModalBranch, ModalPoint};

use super::Laid;
use super::said::median;

/// Relative difference of frequencies, or sizes, below which two motions are one.
const SAME: f64 = 1e-9;

/// What two motions that are compared have in common.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Equal {
    /// The modal amplitude.
    Amplitude,
    /// The averaged kinetic energy, where there is no amplitude.
    Energy,
    /// The frequency.
    Frequency,
}

impl Equal {
    /// In words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Amplitude => "modal amplitude",
            Self::Energy => "energy",
            Self::Frequency => "frequency",
        }
    }

    /// The size by which this point is compared.
    fn of(point: &ModalPoint) -> Self {
        if point.modal_amplitude.is_finite() { Self::Amplitude } else { Self::Energy }
    }

    /// It, of a point.
    fn value(self, point: &ModalPoint) -> f64 {
        match self {
            Self::Amplitude => point.modal_amplitude,
            Self::Energy => point.kinetic_energy,
            Self::Frequency => point.omega,
        }
    }

    /// Quantity that distinguishes several motions with the same value.
    fn other(self, point: &ModalPoint) -> f64 {
        match self {
            Self::Amplitude | Self::Energy => point.omega,
            Self::Frequency => Self::of(point).value(point),
        }
    }
}

/// A point that is laid over, against the branch where that has something in common with it.
#[derive(Debug, Clone, PartialEq)]
pub struct Difference {
    /// Number of the point that is laid over.
    pub point: usize,
    /// What both have in common.
    pub equal: Equal,
    /// Modal amplitude (m√kg) of both, NaN where something else is equal.
    pub amplitude: f64,
    /// Averaged kinetic energy (J) of both, NaN where something else is equal.
    pub energy: f64,
    /// Frequency of the point, Hz.
    pub frequency: f64,
    /// Frequency of the branch there, Hz.
    pub own_frequency: f64,
    /// Integral of all contact forces over a period at the point, N·s, NaN where it is not known.
    pub impulse: f64,
    /// That of the branch there, N·s.
    pub own_impulse: f64,
    /// Largest contact force of the point, N, NaN where it is not known.
    pub force: f64,
    /// That of the branch there, N.
    pub own_force: f64,
    /// Impulse of each stop at the point and of the branch there, N·s; none where one of them is not known.
    pub stops: Vec<[f64; 2]>,
    /// Number of motions with the equal value on the branch or on the overlaid curve, whichever is larger: with
    /// several, as at an internal resonance or beyond a fold, the two may be on different half-branches. One if both
    /// are between grazing and the first turn.
    pub motions: usize,
    /// Whether it is known nevertheless which of several motions of the branch belongs to the point: the one whose
    /// difference is most like those of the points of the same test that have no other.
    pub is_matched: bool,
}

impl Difference {
    /// Relative difference of the frequencies, over that of the branch.
    pub fn relative(&self) -> f64 {
        self.frequency / self.own_frequency - 1.0
    }

    /// Whether it is known which motion of the branch belongs to the point.
    pub fn is_clear(&self) -> bool {
        self.motions == 1 || self.is_matched
    }
}

/// The differences at equal modal amplitude, or energy where a point has no amplitude, of all points within those of
/// the branch, which is linear between its points; of several motions the one with the nearest frequency is used, for
/// points of a test the one whose difference is most like those of the points that have one motion only: if a test is 3
/// % softer throughout, the nearest motion at an internal resonance is the wrong one. A point without contact is not
/// compared with motions with contact.
pub fn differences(laid: &Laid, own: &ModalBranch) -> Vec<Difference> {
    let mut found = all(laid, own, Equal::of);
    if !laid.is_scattered {
        return found;
    }
    let mut clear: Vec<f64> = found.iter().filter(|d| d.motions == 1).map(Difference::relative).collect();
    clear.sort_by(f64::total_cmp);
    let Some(usual) = median(&clear) else { return found };
    for difference in found.iter_mut().filter(|difference| difference.motions > 1) {
        let point = &laid.branch.points[difference.point];
        let partners = partners(point, &own.points, difference.equal);
        let unlike = |there: &There| (point.omega / there.omega - 1.0 - usual).abs();
        if let Some(there) = partners.iter().min_by(|a, b| unlike(a).total_cmp(&unlike(b))) {
            let matched = against((difference.point, point), there, difference.equal, difference.motions);
            *difference = Difference { is_matched: true, ..matched };
        }
    }
    found
}

/// The same at equal frequency; of several motions of a frequency the one counts whose amplitude, or energy, is
/// nearest.
pub fn at_equal_frequency(laid: &Laid, own: &ModalBranch) -> Vec<Difference> {
    all(laid, own, |_| Equal::Frequency)
}

fn all(laid: &Laid, own: &ModalBranch, equal: fn(&ModalPoint) -> Equal) -> Vec<Difference> {
    let points = laid.branch.points.iter().enumerate();
    points.filter_map(|(number, point)| difference((number, point), laid, own, equal(point))).collect()
}

/// What a branch has where it is compared.
#[derive(Debug, Clone)]
struct There {
    omega: f64,
    /// Quantity that distinguishes it from other motions with the same value.
    other: f64,
    impulse: f64,
    force: f64,
    /// Impulse of each stop.
    stops: Vec<f64>,
}

/// All motions of a branch with this in common, each once.
fn motions(points: &[ModalPoint], equal: Equal, wanted: f64) -> Vec<There> {
    let mut found: Vec<There> = Vec::new();
    for pair in points.windows(2).filter(|pair| !pair[1].has_event(Event::Resumed)) {
        let (a, b) = (equal.value(&pair[0]), equal.value(&pair[1]));
        if !(a.min(b)..=a.max(b)).contains(&wanted) {
            continue;
        }
        let share = if a == b { 0.0 } else { (wanted - a) / (b - a) };
        let between = |a: f64, b: f64| a + share * (b - a);
        let at = |value: &dyn Fn(&ModalPoint) -> f64| between(value(&pair[0]), value(&pair[1]));
        let both = pair[0].contacts.iter().zip(&pair[1].contacts);
        found.push(There {
            omega: at(&|p| p.omega),
            other: at(&|p| equal.other(p)),
            impulse: at(&impulse),
            force: at(&|p| p.peak_contact_force),
            stops: both.map(|(a, b)| between(a.impulse, b.impulse)).collect(),
        });
    }
    // What is met at a point is met on both sides of it.
    found.dedup_by(|a, b| (a.other - b.other).abs() <= SAME * b.other.abs());
    found
}

/// Numbers of the points from grazing on, as long as the equal quantity grows: on these, two branches of a mode
/// correspond, whatever their internal resonances beyond. A skipped internal resonance between two points of equal size
/// does not end the range. Empty for a branch that does not begin or end at grazing.
fn first_arm(points: &[ModalPoint], equal: Equal) -> Range<usize> {
    let goes_on = |pair: &[ModalPoint], from: usize| {
        let [a, b] = [from, 1 - from].map(|k| equal.value(&pair[k]));
        b > a || (pair[1].has_event(Event::Resumed) && (b - a).abs() <= SAME * a)
    };
    let grazes = |point: Option<&ModalPoint>| point.is_some_and(ModalPoint::leaves_linear_mode);
    if grazes(points.first()) {
        0..1 + points.windows(2).take_while(|pair| goes_on(pair, 0)).count()
    } else if grazes(points.last()) {
        let count = points.windows(2).rev().take_while(|pair| goes_on(pair, 1)).count();
        points.len() - 1 - count..points.len()
    } else {
        0..0
    }
}

fn difference(
    (number, point): (usize, &ModalPoint),
    laid: &Laid,
    own: &ModalBranch,
    equal: Equal,
) -> Option<Difference> {
    let all = partners(point, &own.points, equal);
    let (points, arms) = (&laid.branch.points, [&laid.branch.points, &own.points].map(|p| first_arm(p, equal)));
    let first = arms[1].clone();
    let beside = if arms[0].contains(&number) { partners(point, &own.points[first], equal) } else { Vec::new() };
    if let ([one], false) = (beside.as_slice(), laid.is_scattered) {
        return Some(against((number, point), one, equal, 1));
    }
    let off = |there: &There| (there.other - equal.other(point)).abs();
    let nearest = all.iter().min_by(|a, b| off(a).total_cmp(&off(b)))?;
    // Points of a test are not a curve, and have no half-branches.
    let count = if laid.is_scattered {
        all.len()
    } else {
        let alike = motions(points, equal, equal.value(point)).len().max(all.len());
        // A point on the first half-branch whose partner is on another one is not unique either.
        if arms[0].contains(&number) && !arms[1].is_empty() { alike.max(2) } else { alike }
    };
    Some(against((number, point), nearest, equal, count))
}

/// The motions of these points that have what is equal, and touch a stop if this point does: a branch without forces
/// may touch or not.
fn partners(point: &ModalPoint, points: &[ModalPoint], equal: Equal) -> Vec<There> {
    let touches_as_well = |there: &There| point.peak_contact_force != 0.0 || there.force.is_nan() || there.force <= 0.0;
    motions(points, equal, equal.value(point)).into_iter().filter(touches_as_well).collect()
}

/// A point compared with one of this many motions of the branch.
fn against((number, point): (usize, &ModalPoint), there: &There, equal: Equal, motions: usize) -> Difference {
    let of = |size: Equal| if equal == size { equal.value(point) } else { f64::NAN };
    Difference {
        point: number,
        equal,
        amplitude: of(Equal::Amplitude),
        energy: of(Equal::Energy),
        frequency: point.omega / TAU,
        own_frequency: there.omega / TAU,
        impulse: impulse(point),
        own_impulse: there.impulse,
        force: point.peak_contact_force,
        own_force: there.force,
        stops: of_stops(&point.contacts, &there.stops),
        motions,
        is_matched: false,
    }
}

/// Impulses of the same stops; none where these are not as many.
fn of_stops(contacts: &[ContactPeriod], own: &[f64]) -> Vec<[f64; 2]> {
    if contacts.len() != own.len() {
        return Vec::new();
    }
    contacts.iter().zip(own).map(|(contact, own)| [contact.impulse, *own]).collect()
}

/// That of the point, NaN if no contact is known.
fn impulse(point: &ModalPoint) -> f64 {
    point.impulse().unwrap_or(f64::NAN)
}

#[cfg(test)]
mod tests;
