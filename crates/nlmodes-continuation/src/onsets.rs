//! Arms that leave a point at which stiff pieces set in beyond several boundaries.

mod boundaries;
mod complementary;
mod onset;
mod reduced;

use self::onset::{Onset, dual};
use self::reduced::{RADIUS, Reduced};
use crate::ParametricSystem;
use crate::arms::{Arms, outward, searching};
use crate::corrector::{Correction, Corrector, Surface};
use crate::expansion::CONFIRMED;
use crate::step::{Foot, StepSettings};
use crate::vectors::{along, distance, dot};

/// Distance from all boundaries, over that of the arms, at which the Jacobian is taken where nothing has set in: well
/// above that by which the point may be beyond them.
const OFF: f64 = 10.0 * boundaries::THROUGH;

/// Distance below which two arms are one, over that from the point.
const DISTINCT: f64 = 1e-3;

/// Unit vectors across the boundaries through `foot`; none where they are not known.
pub(crate) fn boundaries_at<S: ParametricSystem>(
    system: &mut S,
    settings: &StepSettings,
    foot: &Foot,
) -> Vec<Vec<f64>> {
    boundaries::around(system, &foot.z, 10.0 * settings.min).unwrap_or_default()
}

/// All arms that leave `foot`, at the distance of ten of the shortest steps; `None` where the boundaries through it,
/// with these unit vectors across them, do not tell them, or are not several: one alone is a bend or a corner, which a
/// look across it tells.
///
/// Beyond each boundary `g_j = 0` something sets in, so that nearby
///
/// ```text
/// R(z) = J (z − z₀) + Σ_j F_j (d_j/d₀)^k_j ,   d_j = (−∇g_j · (z − z₀))₊
/// ```
///
/// which a few evaluations tell. The arms of these equations, reduced to as many as there are boundaries, are looked
/// for on a sphere without evaluating the system; and each is confirmed by Newton's method.
pub(crate) fn arms<S: ParametricSystem>(
    system: &mut S,
    corrector: &mut Corrector,
    settings: &StepSettings,
    foot: &Foot,
    slopes: &[Vec<f64>],
    way_back: &[f64],
) -> Option<Arms> {
    let radius = 10.0 * settings.min;
    let across = if slopes.len() > 1 { dual(slopes) } else { None }?;
    let pairs = slopes.iter().zip(&across);
    let onsets: Option<Vec<Onset>> =
        pairs.map(|(slope, across)| Onset::measured(system, corrector, &foot.z, slope, across)).collect();
    let onsets = onsets?;
    let off = onsets.iter().fold(foot.z.clone(), |z, onset| along(&z, -OFF * radius, &onset.inward));
    corrector.evaluate(system, &off).ok()?;
    let at = corrector.linearization().clone();
    let mut reduced = Reduced::new(&at, &foot.tangent, &onsets, radius, corrector)?;
    let ways = ways(&mut reduced, &outward(&foot.z, way_back), settings.tolerance)?;
    let mut own = searching(system, corrector, foot.z.len() - 1);
    let confirm = |way: &Vec<f64>| confirmed(system, &mut own, &foot.z, radius, way);
    let arms: Option<Vec<Correction>> = ways.iter().map(confirm).collect();
    corrector.evaluations += own.evaluations;
    let mut arms = arms?;
    let apart = |i: usize, j: usize| distance(&arms[i].z, &arms[j].z) > DISTINCT * radius;
    if arms.len() % 2 == 1 || !(0..arms.len()).all(|i| (0..i).all(|j| apart(i, j))) {
        return None;
    }
    let back = outward(&foot.z, &arms.remove(0).z);
    Some(Arms { back, onward: arms, unsearched: 0 })
}

/// The directions of the arms of the reduced equations, the way back first; `None` where some may be missing.
fn ways(reduced: &mut Reduced, back: &[f64], tolerance: f64) -> Option<Vec<Vec<f64>>> {
    let back = reduced.coordinates(back);
    let arms = match reduced.stiff_arms() {
        Some(mut arms) => {
            let first = (0..arms.len()).max_by(|i, j| dot(&arms[*i], &back).total_cmp(&dot(&arms[*j], &back)))?;
            arms.swap(0, first);
            (dot(&arms[0], &back) > CONFIRMED.1 * dot(&back, &back).sqrt()).then_some(arms)
        }
        None => on_small_sphere(reduced, &back, tolerance),
    };
    Some(arms?.iter().map(|y| reduced.direction(y)).collect())
}

/// The coordinates of the arms of the reduced equations at the distance one, from curves on a sphere.
fn on_small_sphere(reduced: &mut Reduced, back: &[f64], tolerance: f64) -> Option<Vec<Vec<f64>>> {
    let n = reduced.dim();
    let mut corrector = Corrector::new(n, tolerance, 0);
    let back: Vec<f64> = back.iter().map(|c| RADIUS * c).collect();
    let arms = Arms::around(reduced, &mut corrector, &vec![0.0; n + 1], RADIUS, 0, &back)?;
    let onward = arms.onward.iter().map(|arm| arm.z.iter().map(|y| y / RADIUS).collect());
    (arms.unsearched == 0).then(|| std::iter::once(arms.back.clone()).chain(onward).collect())
}

/// The arm in this direction at the distance `radius`, where it is as the reduced equations say.
fn confirmed<S: ParametricSystem>(
    system: &mut S,
    own: &mut Corrector,
    center: &[f64],
    radius: f64,
    way: &[f64],
) -> Option<Correction> {
    let guess = along(center, radius, way);
    let surface = Surface::Sphere { center: center.to_vec(), radius };
    own.correct(system, &guess, &surface).ok().filter(|arm| distance(&arm.z, &guess) <= CONFIRMED.0 * radius)
}
