//! Tight bends at boundaries of smooth pieces: where a contact sets in that is far stiffer than what moves it.

use crate::ParametricSystem;
use crate::corrector::{Correction, Corrector, Hyperplane, Surface};
use crate::expansion::{ABOVE_ROUNDING, CONFIRMED, DEPTH, POWERS, SHALLOW, free_beyond, gradient};
use crate::roots::bracketed_root;
use crate::step::{Foot, StepSettings};
use crate::vectors::{along, distance, dot};

/// What an expansion about a boundary tells of the branch beyond it.
///
/// ```text
/// R(z) = J (z − z₀) + F (d/d₀)^k ,   d the depth beyond the boundary g = 0
/// J t + m F = 0 ,   ∇g · t = 0 ,   m > 0        far beyond the bend the depth is small beside the distance
/// ```
///
/// So the tangent behind the bend is known, and the depth at the distance h: `(d/d₀)^k = h m`.
struct Expansion {
    /// `t`, a unit vector.
    tangent: Vec<f64>,
    /// Unit vector across the boundary.
    inward: Vec<f64>,
    /// `m`, positive.
    share: f64,
    power: f64,
}

/// Root of the depth, over that of the first point behind a bend, to which the place where a coordinate turns is
/// located.
const LOCATED: f64 = 1e-10;

/// A tight bend that has been passed.
pub(crate) struct Bend {
    /// The first point behind it.
    pub end: Correction,
    /// Unit vector across the boundary.
    inward: Vec<f64>,
    /// Tangent of the branch behind the bend, and the power of the depth with which the distance along it grows.
    tangent: Vec<f64>,
    power: f64,
}

impl Bend {
    /// The point within the bend at which the coordinate `i`, whose sense is another behind it, turns; `None` where it
    /// is not found.
    pub fn turn<S: ParametricSystem>(
        &self,
        system: &mut S,
        corrector: &mut Corrector,
        foot: &Foot,
        i: usize,
    ) -> Option<Correction> {
        let depth = dot(&self.inward, &along(&self.end.z, -1.0, &foot.z));
        let ahead = dot(&self.inward, &foot.tangent);
        let (from, to) = (foot.tangent[i], self.end.tangent[i]);
        if !(depth > 0.0 && ahead > 0.0 && from * to < 0.0) {
            return None;
        }
        let length = dot(&self.tangent, &along(&self.end.z, -1.0, &foot.z));
        let mut nearest: Option<Correction> = None;
        // Tangents change with the root of the depth.
        let component = |root: f64| {
            let d = root * root;
            let straight = along(&foot.z, d / ahead, &foot.tangent);
            let on_plane = along(&foot.z, d, &self.inward);
            let guess = along(&straight, length * (d / depth).powf(self.power), &self.tangent);
            let surface = Surface::Plane(Hyperplane::through(&on_plane, &self.inward));
            let found = corrector.correct(system, &guess, &surface).ok();
            let value = found.as_ref().map_or(0.0, |found| found.tangent[i]);
            let nearer = |known: &Correction| value.abs() < known.tangent[i].abs();
            if nearest.as_ref().is_none_or(nearer) {
                nearest = found;
            }
            value
        };
        bracketed_root(component, (0.0, from), (depth.sqrt(), to), LOCATED * depth.sqrt());
        nearest
    }
}

/// The first point behind a tight bend at the boundary on which `foot` lies; `None` where there is no such bend or more
/// than one way may lead on from there: where a second direction is nearly free.
pub(crate) fn around_bend<S: ParametricSystem>(
    system: &mut S,
    corrector: &mut Corrector,
    settings: &StepSettings,
    foot: &Foot,
) -> Option<Bend> {
    let nearest = 10.0 * settings.min;
    // By rounding the foot may lie on either side.
    let [before, beyond] = [-nearest, nearest].map(|s| along(&foot.z, s, &foot.tangent));
    let boundary = system.boundary(&before, &beyond)?;
    corrector.evaluate(system, &before).ok()?;
    let outside = system.pattern();
    let slope = gradient(&boundary, &foot.z)?;
    let size = dot(&slope, &slope).sqrt();
    if boundary.value(&foot.z).abs() > settings.min * size {
        return None;
    }
    let expansion = Expansion::at(system, corrector, foot, &slope, nearest)?;
    let lengths = [settings.initial.min(settings.max), settings.arm, nearest];
    let end = lengths.into_iter().find_map(|h| {
        let end = expansion.reach(system, corrector, foot, h).filter(|end| end.pattern != outside)?;
        let half = expansion.reach(system, corrector, foot, 0.5 * h)?;
        // What else sets in within the bend would not be named.
        let alone = half.pattern == end.pattern && system.boundary(&before, &end.z).is_some();
        alone.then_some(end)
    })?;
    let Expansion { tangent, inward, power, .. } = expansion;
    Some(Bend { end, inward, tangent, power })
}

impl Expansion {
    fn at<S: ParametricSystem>(
        system: &mut S,
        corrector: &mut Corrector,
        foot: &Foot,
        slope: &[f64],
        least: f64,
    ) -> Option<Self> {
        let size = dot(slope, slope).sqrt();
        let inward: Vec<f64> = slope.iter().map(|s| -s / size).collect();
        corrector.evaluate(system, &foot.z).ok()?;
        let at = corrector.linearization().clone();
        if corrector.singular_directions()?.value < least {
            return None;
        }
        let linear = at.times(&inward);
        let mut set_in = |depth: f64| {
            corrector.evaluate(system, &along(&foot.z, depth, &inward)).ok()?;
            let beyond = &corrector.linearization().residual;
            let rest = |i: usize| beyond[i] - at.residual[i] - depth * linear[i];
            Some((0..beyond.len()).map(rest).collect::<Vec<f64>>())
        };
        let (force, twice) = (set_in(DEPTH)?, set_in(2.0 * DEPTH)?);
        // Each row over the size of its equation.
        let over_size = |v: &[f64]| v.iter().zip(&at.sizes).map(|(v, size)| (v / size).powi(2)).sum::<f64>().sqrt();
        let (length, doubled) = (over_size(&force), over_size(&twice));
        let rounding = corrector.rounding.iter().fold(0.0_f64, |m, r| m.max(*r));
        let power = (doubled / length).log2();
        if !(length > ABOVE_ROUNDING * rounding && POWERS.contains(&power)) {
            return None;
        }
        let force: Vec<f64> = force.iter().map(|force| force / length).collect();
        // Another direction that is nearly free may belong to another branch.
        let outward: Vec<f64> = slope.iter().map(|s| s / size).collect();
        let (vector, free) = free_beyond(&at, &[&force], &[&outward], corrector)?;
        let (share, tangent) = vector.split_last()?;
        let tangent: Vec<f64> = tangent.iter().map(|t| t * share.signum()).collect();
        let size = dot(&tangent, &tangent).sqrt();
        if free < least || *share == 0.0 || size.is_nan() || size <= least {
            return None;
        }
        let tangent = tangent.iter().map(|t| t / size).collect();
        Some(Self { tangent, inward, share: share.abs() / size / length, power })
    }

    /// The point at the distance `h`, where it is as the expansion says.
    fn reach<S: ParametricSystem>(
        &self,
        system: &mut S,
        corrector: &mut Corrector,
        foot: &Foot,
        h: f64,
    ) -> Option<Correction> {
        let depth = DEPTH * (h * self.share).powf(1.0 / self.power);
        if depth > SHALLOW * h {
            return None;
        }
        let on_tangent = along(&foot.z, h, &self.tangent);
        let guess = along(&on_tangent, depth, &self.inward);
        let surface = Surface::Plane(Hyperplane::through(&on_tangent, &self.tangent));
        let end = corrector.correct(system, &guess, &surface).ok()?;
        let as_expected = distance(&end.z, &guess) <= CONFIRMED.0 * h
            && dot(&end.tangent, &self.tangent) >= CONFIRMED.1
            && end.orientation * foot.orientation > 0.0;
        as_expected.then_some(end)
    }
}
