//! A few points against motions of the full structure: does it return, and how far is the exact motion of the same
//! energy?

use nlmodes::branches::ComputedBranch;
use nlmodes::modal::ModalPoint;
use nlmodes::timestep::TimestepError;

use super::finer::{TOUCHING, UNTOUCHED, floors, of_harmonics, relative, touches};
use super::{BROKEN_OFF, CERTIFY, Check, Looking, Number, Place, Sources, Worst, listed, named};
use crate::verify::{Found, Point, verify_up_to};

const RETURN: &str = "return after a period";
const EXACT: &str = "exact motion";
/// Largest structure that is integrated, degrees of freedom, and up to which the exact motion is sought.
const LARGEST: [usize; 2] = [400, 120];
/// Numbers that are compared with those of the exact motion.
const COMPARED: [Number; 3] = [Number::Frequency, Number::Impulse, Number::PeakForce];

/// By how much the full structure fails to return, and the numbers of the exact motion.
pub fn checks(computed: &ComputedBranch, points: &[usize], sources: Sources<'_>, look: Looking<'_>) -> Vec<Check> {
    let n = computed.structure.model().dofs().len();
    if !sources.thorough {
        return missing("the full structure was not started from a point", CERTIFY);
    }
    if n > LARGEST[0] || computed.structure.recorded_dofs().len() < n {
        let why = format!("{n} degrees of freedom, more than {}", LARGEST[0]);
        return missing(&why, "`verify`, or fewer degrees of freedom: `[reduction]`");
    }
    let (mut returned, mut worst, mut lost) = (Worst::default(), <[Worst; 3]>::default(), Vec::new());
    for (number, &k) in points.iter().enumerate() {
        if !look(RETURN, k, [number + 1, points.len()]) {
            return missing(BROKEN_OFF, CERTIFY);
        }
        let point = match Point::of_branch(sources.scene, computed, k) {
            Ok(point) => point,
            Err(error) => return missing(&format!("point {k}: {error}"), "`verify`"),
        };
        let found = match verify_up_to(&point, LARGEST[1], sources.watch) {
            Ok(found) => found,
            Err(TimestepError::Ended) => return missing(BROKEN_OFF, CERTIFY),
            Err(error) => return missing(&format!("point {k}: {error}"), "`verify`"),
        };
        returned.take(k, found.verification.energy_norm);
        match beside(&found, &computed.branch.points[k], floors(&computed.branch.points)) {
            Some(errors) => worst.iter_mut().zip(errors).for_each(|(worst, error)| worst.take(k, error)),
            None => lost.push(Place::of(k, &computed.branch.points[k])),
        }
    }
    let at = listed(points, &computed.branch.points);
    let words = format!("what is missing to the first state in the energy norm, {at}");
    let mut checks = vec![Check::measured(RETURN, returned.value, words).at(&returned)];
    if lost.len() == points.len() {
        let why = match n > LARGEST[1] {
            true => format!("{n} degrees of freedom, more than {}", LARGEST[1]),
            false => format!("no exact motion of that energy was found next to {at}"),
        };
        checks.push(Check::missing(EXACT, None, why, "more harmonics; method.kind = \"shooting\""));
        return checks;
    }
    let said = if lost.is_empty() { String::new() } else { format!("; none was found next to {}", named(&lost)) };
    let words = format!("beside the exact motion of the same energy, {at}{said}");
    let of = |(number, worst): (Number, Worst)| {
        if worst.all.is_empty() {
            return Check::missing(EXACT, Some(number), UNTOUCHED, TOUCHING);
        }
        Check::estimate(EXACT, (number, of_harmonics(computed)), worst.value, words.clone()).at(&worst)
    };
    checks.extend(COMPARED.into_iter().zip(worst).map(of));
    checks
}

/// Relative differences to the numbers of the exact motion, in the order in which they are compared; none for forces
/// without contact.
fn beside(found: &Found, point: &ModalPoint, [small_force, small_impulse]: [f64; 2]) -> Option<[Option<f64>; 3]> {
    let motion = &found.exact.as_ref()?.as_ref().ok()?.motion;
    let exact = motion.trajectory.contact_periods(point.contacts.len());
    let pairs = point.contacts.iter().zip(&exact);
    let impulses = pairs.map(|(own, exact)| relative(own.impulse, exact.impulse, small_impulse));
    let force = exact.iter().map(|c| c.peak_force).fold(0.0, f64::max);
    let touches = touches(point.peak_contact_force.max(force), small_force);
    Some([
        Some(relative(point.omega, motion.omega, 0.0)),
        touches.then(|| impulses.fold(0.0, f64::max)),
        touches.then(|| relative(point.peak_contact_force, force, small_force)),
    ])
}

fn missing(why: &str, how: &'static str) -> Vec<Check> {
    vec![Check::missing(RETURN, None, why, how), Check::missing(EXACT, None, why, how)]
}
