//! A few points against motions of the full structure: does it return, and how far is the exact motion of the same energy?

use nlmodes::modal::ModalPoint;
use nlmodes::study::ComputedBranch;

use super::finer::relative;
use super::{CERTIFY, Check, Number, Sources, listed};
use crate::verify::{Found, Point, verify_up_to};

const RETURN: &str = "return after a period";
const EXACT: &str = "exact motion";
/// Largest share of the root of the energy that may be missing.
const LIMIT: f64 = 5e-2;
/// Largest structure that is integrated, degrees of freedom, and up to which the exact motion is sought.
const LARGEST: [usize; 2] = [400, 120];
/// Numbers that are compared with those of the exact motion.
const COMPARED: [Number; 3] = [Number::Frequency, Number::Impulse, Number::PeakForce];
/// Impulses and forces below this share of the largest do not count by themselves.
const FLOOR: f64 = 1e-2;

/// By how much the full structure fails to return, and the numbers of the exact motion.
pub fn checks(computed: &ComputedBranch, points: &[usize], sources: Sources<'_>) -> Vec<Check> {
    let n = computed.structure.model().dofs().len();
    if !sources.thorough {
        return missing("the full structure was not started from a point", CERTIFY);
    }
    if n > LARGEST[0] || computed.structure.recorded_dofs().len() < n {
        let why = format!("{n} degrees of freedom, more than {}", LARGEST[0]);
        return missing(&why, "`verify`, or fewer degrees of freedom: `[reduction]`");
    }
    let (mut returned, mut worst, mut lost) = (0.0_f64, [0.0_f64; 3], Vec::new());
    for &k in points {
        let point = match Point::of_branch(sources.scene, computed, k) {
            Ok(point) => point,
            Err(error) => return missing(&format!("point {k}: {error}"), "`verify`"),
        };
        let found = match verify_up_to(&point, LARGEST[1]) {
            Ok(found) => found,
            Err(error) => return missing(&format!("point {k}: {error}"), "`verify`"),
        };
        returned = returned.max(found.verification.energy_norm);
        match beside(&found, &computed.branch.points[k]) {
            Some(errors) => worst.iter_mut().zip(errors).for_each(|(w, e)| *w = w.max(e)),
            None => lost.push(k),
        }
    }
    let words = format!("what is missing to the first state in the energy norm, {}", listed(points));
    let mut checks = vec![Check::found(RETURN, Some(Number::Displacement), returned, LIMIT, words)];
    if lost.len() == points.len() {
        let why = match n > LARGEST[1] {
            true => format!("{n} degrees of freedom, more than {}", LARGEST[1]),
            false => format!("no exact motion of that energy was found next to {}", listed(points)),
        };
        let missing =
            Check::missing(EXACT, None, Number::Frequency.limit(), why, "more harmonics; method.kind = \"shooting\"");
        checks.push(missing);
        return checks;
    }
    let said = if lost.is_empty() { String::new() } else { format!("; none was found next to {}", listed(&lost)) };
    let words = format!("beside the exact motion of the same energy, {}{said}", listed(points));
    let of = |(number, value): (Number, f64)| Check::found(EXACT, Some(number), value, number.limit(), words.clone());
    checks.extend(COMPARED.into_iter().zip(worst).map(of));
    checks
}

/// Relative differences to the numbers of the exact motion, in the order in which they are compared.
fn beside(found: &Found, point: &ModalPoint) -> Option<[f64; 3]> {
    let motion = &found.exact.as_ref()?.as_ref().ok()?.motion;
    let exact = motion.trajectory.contact_periods(point.contacts.len());
    let largest = |of: fn(&nlmodes::modal::ContactPeriod) -> f64| exact.iter().map(of).fold(0.0, f64::max);
    let floor = FLOOR * largest(|c| c.impulse).max(f64::MIN_POSITIVE);
    let impulses = point.contacts.iter().zip(&exact).map(|(own, exact)| relative(own.impulse, exact.impulse, floor));
    let force = largest(|c| c.peak_force);
    Some([
        relative(point.omega, motion.omega, 0.0),
        impulses.fold(0.0, f64::max),
        relative(point.peak_contact_force, force, f64::MIN_POSITIVE),
    ])
}

fn missing(why: &str, how: &'static str) -> Vec<Check> {
    vec![
        Check::missing(RETURN, Some(Number::Displacement), LIMIT, why, how),
        Check::missing(EXACT, None, Number::Frequency.limit(), why, how),
    ]
}
