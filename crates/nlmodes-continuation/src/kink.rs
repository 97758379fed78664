//! Kinks: points at which smooth pieces meet, and the half-branches that leave them.

use crate::boundaries;
use crate::corrector::{Correction, Corrector, Hyperplane, Surface};
use crate::half_branches::{HalfBranches, Sphere, outward, unit};
use crate::roots::bracketed_root;
use crate::signs::Signs;
use crate::step::{BasePoint, StepSettings, step};
use crate::vectors::{along, distance, dot};
use crate::{ParametricSystem, branching};

/// Shortest and first step towards a kink, over the shortest one elsewhere, and most of them.
const NEAREST: f64 = 1e-4;
const APPROACHING: f64 = 0.5;
const APPROACH: usize = 24;

/// Directions drawn by lot in which pieces are looked for where the system does not know their boundaries.
const DRAWN: usize = 32;

/// Root of the depth beyond a boundary, over that of the first point beyond a kink, to which the place where a
/// coordinate turns is located, and up to which it turns at the kink itself.
const LOCATED: f64 = 1e-10;
const AT_KINK: f64 = 1e-4;

/// Power of the depth with which a contact force grows: where points beyond a boundary are looked for.
const POWER: f64 = 1.5;

/// The half-branches that leave the kink at `center`, each along the tangent of a piece that it stays on; the branch
/// came from the direction `back`.
///
/// Jacobians are those of the pieces at the distance `radius`. Where the system knows the boundaries that pass through
/// the center, all pieces around it are looked at; else that ahead, those in the directions of tangents found so far,
/// and where these are not balanced, some drawn by lot. `None` where none leads on.
pub(crate) fn half_branches<S: ParametricSystem>(
    system: &mut S,
    corrector: &mut Corrector,
    radius: f64,
    center: &[f64],
    back: &[f64],
) -> Option<HalfBranches> {
    let known = boundaries::around(system, center, radius).and_then(|slopes| boundaries::sides(&slopes));
    let (is_known, mut probes) = (known.is_some(), known.unwrap_or_default());
    probes.push(outward(back, &vec![0.0; back.len()]));
    let mut sphere = Sphere::new(system, corrector, center, radius);
    sphere.is_flat = true;
    sphere.take(back);
    let (mut pieces, mut others) = (Vec::new(), Vec::new());
    let (mut signs, mut drawn) = (Signs::default(), 0);
    loop {
        let Some(probe) = probes.pop() else {
            drawn += 1;
            if is_known || sphere.is_balanced() || drawn > DRAWN {
                break;
            }
            probes.push(unit((0..center.len()).map(|_| signs.draw_between()).collect()));
            continue;
        };
        let Some((piece, tangent)) = piece_at(&mut sphere, &along(center, radius, &probe), &pieces) else { continue };
        pieces.push(piece);
        for direction in [1.0, -1.0].map(|sense| tangent.iter().map(|t| sense * t).collect::<Vec<f64>>()) {
            if pattern_at(&mut sphere, &along(center, radius, &direction)) == Some(piece) {
                sphere.take(&direction);
                continue;
            }
            if !is_known {
                probes.push(direction.clone());
            }
            others.push(direction);
        }
    }
    if sphere.found.len() < 2 {
        // Beside a stiff contact the tangent may lie within rounding of the boundary.
        others.iter().for_each(|direction| {
            sphere.take(direction);
        });
    }
    corrector.evaluations += sphere.corrector.evaluations;
    sphere.finish(back, 1, is_known).filter(|found| !found.onward.is_empty())
}

/// The piece on which a point lies, and the tangent by the Jacobian there; `None` for a piece that is known.
fn piece_at<S: ParametricSystem>(sphere: &mut Sphere<'_, S>, z: &[f64], known: &[u64]) -> Option<(u64, Vec<f64>)> {
    if sphere.system.pattern_at(z).is_some_and(|piece| known.contains(&piece)) {
        return None;
    }
    sphere.corrector.evaluate(sphere.system, z).ok()?;
    let piece = sphere.system.pattern();
    let is_new = !known.contains(&piece);
    is_new.then(|| Some((piece, sphere.corrector.singular_directions()?.tangent))).flatten()
}

fn pattern_at<S: ParametricSystem>(sphere: &mut Sphere<'_, S>, z: &[f64]) -> Option<u64> {
    sphere.system.pattern_at(z).or_else(|| {
        sphere.corrector.evaluate(sphere.system, z).ok()?;
        Some(sphere.system.pattern())
    })
}

/// All half-branches that leave `base`, beyond which no step exists, and the one that continues the branch.
///
/// Where they are not balanced at the least distance, several boundaries lie close together: then further away.
pub(crate) fn way_on<S: ParametricSystem>(
    system: &mut S,
    corrector: &mut Corrector,
    settings: &StepSettings,
    base: &BasePoint,
    way_back: impl Fn(f64) -> Vec<f64>,
) -> Option<(HalfBranches, usize)> {
    let (center, least) = (&base.z, 10.0 * settings.min);
    let radii = std::iter::successors(Some(least), |r| Some(10.0 * r));
    let mut nearest = None;
    for radius in radii.take_while(|r| *r <= 1.01 * settings.arm.max(least)) {
        let found = half_branches(system, corrector, radius, center, &outward(center, &way_back(radius)));
        match found {
            Some(found) if found.balanced => return found.partner(center).map(|own| (found, own)),
            found => nearest = nearest.or(found),
        }
    }
    let found = branching::half_branches(system, corrector, settings, center, way_back);
    let found = found.or(nearest)?;
    let own = found.partner(center)?;
    Some((found, own))
}

/// Moves the base point towards the kink ahead of it, by steps below the shortest, as far as they can be shown to stay
/// on the branch and lead to points that are `permitted`.
pub(crate) fn approach<S: ParametricSystem>(
    system: &mut S,
    corrector: &mut Corrector,
    settings: &StepSettings,
    base: &mut BasePoint,
    permitted: impl Fn(&[f64]) -> bool,
) {
    let mut h = APPROACHING * settings.min;
    for _ in 0..APPROACH {
        if h < NEAREST * settings.min {
            break;
        }
        match step(system, corrector, settings, base, h) {
            Ok(end) if end.orientation * base.orientation > 0.0 && end.pattern == base.pattern && permitted(&end.z) => {
                *base = BasePoint::from(&end)
            }
            _ => h *= 0.4,
        }
    }
}

/// The point of a branch about `radius` behind its base point, from its points and tangents, the latest first.
pub(crate) fn way_back<'p>(
    points: impl Iterator<Item = (Vec<f64>, &'p [f64])>,
    base: &'p BasePoint,
    radius: f64,
) -> Vec<f64> {
    let mut points = points.peekable();
    let (mut z, mut tangent) = (base.z.clone(), base.tangent.clone());
    while let Some((inside, along_it)) = points.next_if(|(q, _)| distance(q, &base.z) < 0.9 * radius) {
        (z, tangent) = (inside, along_it.to_vec());
    }
    // Beside a singular point tangents are less certain than points close by.
    if let Some((outside, _)) = points.next().filter(|(q, _)| distance(q, &base.z) < 10.0 * radius) {
        tangent = outward(&outside, &z);
    }
    // z − s t lies on the sphere: s² − 2 s t·d + d·d − r² = 0 with d = z − base.
    let d = along(&z, -1.0, &base.z);
    let on = dot(&tangent, &d);
    let s = on + (on * on - dot(&d, &d) + radius * radius).max(0.0).sqrt();
    along(&z, -s, &tangent)
}

/// The point between a base point on a boundary and `next` beyond it at which the coordinate `i` turns, where a contact
/// sets in so stiffly that no step tells; `None` where it turns at the boundary itself.
pub(crate) fn turn<S: ParametricSystem>(
    system: &mut S,
    corrector: &mut Corrector,
    base: &BasePoint,
    next: &Correction,
    i: usize,
) -> Option<Correction> {
    let [before, beyond] = [along(&base.z, -distance(&next.z, &base.z), &base.tangent), next.z.clone()];
    let slope = boundaries::gradient(&system.boundary(&before, &beyond)?, &base.z)?;
    let inward = outward(&slope, &vec![0.0; slope.len()]);
    let chord = along(&next.z, -1.0, &base.z);
    let (depth, ahead) = (dot(&inward, &chord), dot(&inward, &base.tangent));
    let (from, to) = (base.tangent[i], next.tangent[i]);
    if !(depth > 0.0 && ahead > 0.0 && from * to < 0.0) {
        return None;
    }
    let length = dot(&next.tangent, &chord);
    let mut nearest: Option<Correction> = None;
    // Tangents change with the root of the depth.
    let mut component = |root: f64| {
        let d = root * root;
        let straight = along(&base.z, d / ahead, &base.tangent);
        let on_plane = along(&base.z, d, &inward);
        let guess = along(&straight, length * (d / depth).powf(POWER), &next.tangent);
        let surface = Surface::Plane(Hyperplane::through(&on_plane, &inward));
        let found = corrector.correct(system, &guess, &surface).ok();
        let value = found.as_ref().map_or(0.0, |found| found.tangent[i]);
        if nearest.as_ref().is_none_or(|known| value.abs() < known.tangent[i].abs()) {
            nearest = found;
        }
        value
    };
    if component(AT_KINK * depth.sqrt()) * from <= 0.0 {
        return None;
    }
    bracketed_root(component, (0.0, from), (depth.sqrt(), to), LOCATED * depth.sqrt());
    nearest
}
