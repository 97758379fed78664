//! A few points solved again with twice as many harmonics, and with twice as many held modes.

use nlmodes::branches::{BranchError, ComputedBranch, Watch};
use nlmodes::hbm::CondensedStructure;
use nlmodes::modal::ModalPoint;
use nlmodes_reduction::OpenModes;

use super::{BROKEN_OFF, CERTIFY, Check, Looking, Number, Place, Sources, Worst, listed, named};

const HARMONICS: &str = "harmonics";
const MODES: &str = "modes";
/// Forces, impulses and amplitudes below this share of the largest ones of the branch do not count by themselves.
const FLOOR: f64 = 1e-2;

/// Most points that are solved again, and the largest number of unknowns of which so many are.
const MANY: usize = 48;
const SMALL: usize = 500;

/// Evenly chosen points beside these few, where solving them again costs next to nothing.
fn many(computed: &ComputedBranch, few: &[usize]) -> Vec<usize> {
    let harmonics = computed.branch.points.iter().map(|p| p.coefficients.n_harmonics()).max().unwrap_or(0);
    let contacts = computed.structure.model().contacts().len();
    let last = computed.branch.points.len().saturating_sub(1);
    let mut points = few.to_vec();
    if contacts * (4 * harmonics + 1) <= SMALL {
        points.extend((0..MANY).map(|k| k * last / (MANY - 1)));
        points.sort_unstable();
        points.dedup();
    }
    points
}

/// What twice as many harmonics change.
pub fn harmonics(computed: &ComputedBranch, few: &[usize], sources: Sources<'_>, look: Looking<'_>) -> Vec<Check> {
    if computed.is_exact() {
        let words = "exact in time: no harmonics are left out";
        return Number::ALL.map(|n| Check::found(HARMONICS, Some(n), 0.0, n.limit(), words)).to_vec();
    }
    if !sources.thorough {
        return estimated(computed);
    }
    let (all, points) = (computed.branch.points.len(), many(computed, few));
    let words = |lost: &str| match points.len() {
        n if n >= all => format!("with twice as many harmonics at the same energy, all {all} points{lost}"),
        n => format!(
            "with twice as many harmonics at the same energy, {n} of {all} points; others may change by more{lost}"
        ),
    };
    let number = |k: usize| 2 * computed.branch.points[k].coefficients.n_harmonics();
    let solve = |k: usize| computed.refined(k, number(k), &computed.structure);
    again((HARMONICS, "method.harmonics twice as large"), computed, &points, words, solve, (look, sources.watch))
}

/// The estimates of the frequency's error that an accuracy has been asked for with; else nothing.
fn estimated(computed: &ComputedBranch) -> Vec<Check> {
    let estimates = computed.branch.points.iter().filter_map(|p| p.error_estimate);
    let frequency = match estimates.reduce(f64::max) {
        Some(largest) => {
            let words = "largest estimate of what harmonics and modes left out do, of all points";
            Check::found(HARMONICS, Some(Number::Frequency), largest, Number::Frequency.limit(), words)
        }
        None => not_asked(Number::Frequency),
    };
    [frequency].into_iter().chain(Number::ALL.into_iter().skip(1).map(not_asked)).collect()
}

fn not_asked(number: Number) -> Check {
    Check::missing(HARMONICS, Some(number), number.limit(), "more harmonics were not tried", CERTIFY)
}

/// What modes left out do to the linear frequency of a mode with a contact closed.
pub(crate) fn open_modes(open: &OpenModes, mode: usize, contact: usize) -> Check {
    let limit = Number::Frequency.limit();
    let found = |error: f64, words: String| Check::found(MODES, Some(Number::Frequency), error, limit, words);
    if open.has_all_modes() {
        return found(0.0, format!("open modes: all {} are kept", open.n_modes()));
    }
    let mut closed = vec![false; open.n_contacts()];
    if let Some(closed) = closed.get_mut(contact) {
        *closed = true;
    }
    let error = mode.checked_sub(1).and_then(|mode| open.truncation_error(&closed, mode).ok());
    match error.filter(|error| error.is_finite()) {
        Some(error) => {
            let words = "open modes: estimate from half as many, linear frequency with the first contact closed";
            found(error, words.to_owned())
        }
        None => {
            let why = "open modes: half as many do not reach the mode that is computed";
            Check::missing(MODES, Some(Number::Frequency), limit, why, "reduction.modes twice as large")
        }
    }
}

/// What twice as many held modes change.
pub fn modes(computed: &ComputedBranch, points: &[usize], sources: Sources<'_>, look: Looking<'_>) -> Vec<Check> {
    let limit = Number::Frequency.limit();
    if let Some(open) = sources.open {
        return vec![open_modes(&open.modes, sources.scene.method.mode, computed.grazing.contact)];
    }
    let structure = &computed.structure;
    let (kept, all) = (structure.n_held_modes(), structure.model().linear_dofs().len());
    if kept >= all {
        return vec![Check::found(MODES, None, 0.0, limit, format!("all {all} held modes are kept"))];
    }
    if !sources.thorough {
        let most = computed.branch.points.iter().map(|p| p.coefficients.n_harmonics()).max().unwrap_or(0);
        let error = structure.held_modes_error(&computed.grazing, computed.grazing.omega, most);
        let words = format!("{kept} of {all} held modes: a guess of what the others do, at grazing");
        return vec![Check::found(MODES, Some(Number::Frequency), error, limit, words)];
    }
    let more = (2 * kept).min(all);
    let how = "method.held_modes twice as large";
    let finer = match CondensedStructure::new(structure.model().clone(), more) {
        Ok(finer) => finer,
        Err(error) => return vec![Check::missing(MODES, None, limit, error.to_string(), how)],
    };
    let at = listed(points, &computed.branch.points);
    let words = |lost: &str| format!("with {more} of {all} held modes for {kept} at the same energy, {at}{lost}");
    let number = |k: usize| computed.branch.points[k].coefficients.n_harmonics();
    again((MODES, how), computed, points, words, |k| computed.refined(k, number(k), &finer), (look, sources.watch))
}

/// Largest changes of the numbers where points are solved again.
fn again(
    (name, how): (&'static str, &'static str),
    computed: &ComputedBranch,
    points: &[usize],
    words: impl Fn(&str) -> String,
    solve: impl Fn(usize) -> Result<Option<ModalPoint>, BranchError>,
    (look, watch): (Looking<'_>, &Watch),
) -> Vec<Check> {
    let missing = |why: String, how| vec![Check::missing(name, None, Number::Frequency.limit(), why, how)];
    let (mut worst, mut lost) = (<[Worst; 4]>::default(), Vec::new());
    for (number, &k) in points.iter().enumerate() {
        if !look(name, k, [number + 1, points.len()]) {
            return missing(BROKEN_OFF.to_owned(), CERTIFY);
        }
        let solved = solve(k);
        if watch.asks_to_end() {
            return missing(BROKEN_OFF.to_owned(), CERTIFY);
        }
        match solved {
            Ok(Some(after)) => {
                let found = changes(computed, &computed.branch.points[k], &after);
                worst.iter_mut().zip(found).for_each(|(worst, found)| worst.take(k, found));
            }
            Ok(None) => lost.push(Place::of(k, &computed.branch.points[k])),
            Err(error) => return missing(error.to_string(), how),
        }
    }
    let said = match lost.as_slice() {
        [] => String::new(),
        lost => format!("; from {} Newton's method does not lead to one and back", named(lost)),
    };
    // A motion to which more harmonics, or modes, have nothing near is not one to trust, whatever the other points say.
    let words = words(&said);
    let of = |(number, worst): (Number, Worst)| {
        let silent = points.len() - lost.len() - worst.all.len();
        let words = match worst.all.is_empty() && lost.is_empty() {
            true => return Check::missing(name, Some(number), number.limit(), UNTOUCHED, TOUCHING),
            false if silent > 0 => format!("{words}; {silent} of them touch no stop and say nothing of this number"),
            false => words.clone(),
        };
        let value = if lost.len() == points.len() { f64::NAN } else { worst.value };
        Check::found(name, Some(number), value, number.limit(), words).at(&worst).without(&lost)
    };
    Number::ALL.into_iter().zip(worst).map(of).collect()
}

/// What is said where no point has a force.
pub(super) const UNTOUCHED: &str = "no point that was looked at touches a stop";
pub(super) const TOUCHING: &str = "a branch that goes on beyond the first touch";

/// Relative changes of the numbers, in their order; none of forces where no stop is touched.
fn changes(computed: &ComputedBranch, before: &ModalPoint, after: &ModalPoint) -> [Option<f64>; 4] {
    let [force, impulse] = floors(computed);
    let amplitude = computed.branch.points.iter().fold(f64::MIN_POSITIVE, |m, p| m.max(p.modal_amplitude));
    let each = before.contacts.iter().zip(&after.contacts);
    // Before a rigid stop the largest displacement is the gap, whatever the harmonics.
    let displacement = relative(before.modal_amplitude, after.modal_amplitude, FLOOR * amplitude);
    let touches = touches(before.peak_contact_force.max(after.peak_contact_force), force);
    [
        Some(relative(before.omega, after.omega, 0.0)),
        Some(relative(before.peak, after.peak, 0.0).max(displacement)),
        touches.then(|| each.map(|(b, a)| relative(b.impulse, a.impulse, impulse)).fold(0.0, f64::max)),
        touches.then(|| relative(before.peak_contact_force, after.peak_contact_force, force)),
    ]
}

/// Force and impulse below which these do not count by themselves.
pub fn floors(computed: &ComputedBranch) -> [f64; 2] {
    let points = &computed.branch.points;
    let force = points.iter().map(|p| p.peak_contact_force).fold(0.0, f64::max);
    let impulse = points.iter().flat_map(|p| &p.contacts).map(|c| c.impulse).fold(0.0, f64::max);
    [force, impulse].map(|largest| (FLOOR * largest).max(f64::MIN_POSITIVE))
}

/// Whether a largest force is more than rounding, by the one below which forces do not count by themselves.
pub fn touches(force: f64, floor: f64) -> bool {
    force > 1e-7 * floor
}

/// `|before − after|` over the latter, or over `floor` where that is larger.
pub fn relative(before: f64, after: f64, floor: f64) -> f64 {
    if before == after { 0.0 } else { (before - after).abs() / after.abs().max(floor) }
}
