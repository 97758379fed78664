//! Arms on a small sphere, found along curves on which all equations but one hold.

use crate::corner::{Passage, pass, way_back};
use crate::corrector::{Correction, Corrector, Hyperplane, ROUNDING, Surface};
use crate::events::Search;
use crate::predictor::Behind;
use crate::step::{Foot, step};
use crate::vectors::{along, distance, dot};
use crate::{Boundary, LinearSolver, Linearization, ParametricSystem, StepSettings};

/// Distance over the radius, and Newton step, to which points of such a curve are known at best.
const RESOLUTION: f64 = 1e-7;

/// Shortest step over the resolution.
const SHORTEST: f64 = 10.0;

/// Longest step, rad.
const LONGEST: f64 = 0.15;

/// Step down to which it is looked whether μ has two zeros within, rad.
const CLOSEST: f64 = 2e-3;

/// Most steps, refused ones included, and length of a curve, rad.
const MOST: (usize, f64) = (400, 40.0);

/// Depth of spheres around corners of curves on spheres.
const NESTED: usize = 1;

/// A small sphere, and how well points near its center are known.
#[derive(Debug, Clone)]
pub(crate) struct Sphere<'a> {
    pub center: &'a [f64],
    pub radius: f64,
    /// Residual, largest entry, at which a point counts as found.
    pub tolerance: f64,
    /// Newton step below which a point counts as settled.
    pub resolution: f64,
    /// Rounding of each entry of the residual.
    pub rounding: &'a [f64],
    /// Number of spheres around corners of whose curves this one is.
    pub nesting: usize,
}

/// `R(c + r ζ)/r + μ u = 0`, `|ζ| = 1`: n + 1 equations for the n + 1 entries of ζ, with the parameter μ.
///
/// Its solutions are curves on the sphere, whatever the number of directions is in which `R` leaves the center nearly
/// free to move; where μ vanishes, they meet an arm.
struct Relaxed<'a, E> {
    system: &'a mut (dyn ParametricSystem<Error = E> + 'a),
    inner: Linearization,
    sphere: &'a Sphere<'a>,
    /// `u`, a unit vector.
    left: &'a [f64],
}

impl<E> Relaxed<'_, E> {
    /// `[J, u; ζᵀ, 0]`.
    fn write_jacobian(&self, zeta: &[f64], out: &mut Linearization) {
        let n = self.left.len();
        if out.jacobian.nrows() == 0 {
            out.entries.extend_from_slice(&self.inner.entries);
            out.entries.extend(self.left.iter().enumerate().map(|(i, u)| (i, n + 1, *u)));
            out.entries.extend(zeta.iter().enumerate().map(|(j, zeta)| (n, j, *zeta)));
            return;
        }
        for i in 0..n {
            (0..=n).for_each(|j| out.jacobian[(i, j)] = self.inner.jacobian[(i, j)]);
            out.jacobian[(i, n + 1)] = self.left[i];
        }
        (0..=n).for_each(|j| out.jacobian[(n, j)] = zeta[j]);
        out.jacobian[(n, n + 1)] = 0.0;
    }
}

impl<E: std::error::Error + 'static> ParametricSystem for Relaxed<'_, E> {
    type Error = E;

    fn dim(&self) -> usize {
        self.left.len() + 1
    }

    fn linearize(&mut self, zeta: &[f64], mu: f64, out: &mut Linearization) -> Result<(), E> {
        let n = self.left.len();
        let z = self.sphere.point(zeta);
        self.inner.entries.clear();
        self.system.linearize(&z[..n], z[n], &mut self.inner)?;
        for i in 0..n {
            out.residual[i] = self.inner.residual[i] / self.sphere.radius + mu * self.left[i];
            out.sizes[i] = self.inner.sizes[i];
        }
        out.residual[n] = 0.5 * (dot(zeta, zeta) - 1.0);
        self.write_jacobian(zeta, out);
        Ok(())
    }

    fn solver(&self) -> Box<dyn LinearSolver> {
        self.system.solver()
    }

    fn pattern(&self) -> u64 {
        self.system.pattern()
    }

    fn boundary(&mut self, from: &[f64], to: &[f64]) -> Option<Boundary> {
        let boundary = self.system.boundary(&self.sphere.point(from), &self.sphere.point(to))?;
        let (center, radius) = (self.sphere.center.to_vec(), self.sphere.radius);
        Some(Boundary::new(move |zeta| boundary.value(&along(&center, radius, zeta)) / radius))
    }
}

/// What a curve on the sphere passed.
#[derive(Debug, Default)]
pub(crate) struct Track {
    /// Points near its arms, without the one from which it started.
    pub arms: Vec<Vec<f64>>,
    /// Whether it came back to where it began.
    pub closed: bool,
    /// Evaluations spent.
    pub evaluations: usize,
}

impl Sphere<'_> {
    fn point(&self, zeta: &[f64]) -> Vec<f64> {
        self.center.iter().zip(zeta).map(|(c, d)| c + self.radius * d).collect()
    }

    /// Follows the curve that leaves the arm `from` while the equation in the direction `left` is given up: all around,
    /// or where that does not succeed, both ways as far as it goes.
    pub fn arms_along<S: ParametricSystem>(&self, system: &mut S, from: &[f64], left: &[f64]) -> Track {
        let n = left.len();
        let solver = system.solver();
        let inner = Linearization::for_solver(&*solver, n);
        let mut relaxed = Relaxed { system, inner, sphere: self, left };
        let resolution = (self.resolution / self.radius).max(RESOLUTION);
        let min = SHORTEST * resolution;
        let settings = StepSettings {
            initial: min,
            min,
            arm: 1e-2,
            max: LONGEST,
            checked_turn: 0.3,
            tolerance: self.tolerance / self.radius,
            ..StepSettings::default()
        };
        let mut corrector = Corrector::with_solver(solver, n + 1, settings.tolerance, 2 * settings.max_iterations);
        (corrector.resolution, corrector.blur) = (resolution, resolution);
        let all = self.rounding.iter().copied().chain([ROUNDING]);
        corrector.rounding = all.map(|rounding| rounding / self.radius).collect();
        let mut track = Track::default();
        if let Some(start) = self.start(&mut relaxed, &mut corrector, from) {
            let mut walk = Walk { system: &mut relaxed, corrector: &mut corrector, settings, nesting: self.nesting };
            track.closed = walk.follow(&start, 1.0, &mut track.arms);
            if !track.closed {
                walk.follow(&start, -1.0, &mut track.arms);
            }
        }
        track.arms.iter_mut().for_each(|zeta| *zeta = self.point(&zeta[..=n]));
        track.evaluations = corrector.evaluations;
        track
    }

    /// The arm as a point of the curve, with the tangent of that.
    fn start<S: ParametricSystem>(
        &self,
        system: &mut S,
        corrector: &mut Corrector,
        from: &[f64],
    ) -> Option<Correction> {
        let zeta = from.iter().zip(self.center).map(|(z, c)| (z - c) / self.radius);
        let start: Vec<f64> = zeta.chain([0.0]).collect();
        let on_arm = Surface::Plane(Hyperplane::fixing(start.len() - 1, 0.0, start.len()));
        corrector.correct(system, &start, &on_arm).ok().filter(|c| distance(&c.z, &start) < 0.1)
    }
}

/// A curve on a sphere being followed.
struct Walk<'w, S> {
    system: &'w mut S,
    corrector: &'w mut Corrector,
    settings: StepSettings,
    nesting: usize,
}

impl<S: ParametricSystem> Walk<'_, S> {
    /// Whether the curve came back to its start.
    fn follow(&mut self, start: &Correction, sense: f64, arms: &mut Vec<Vec<f64>>) -> bool {
        let mut foot = Foot::from(start);
        turn(&mut foot, sense);
        let first = foot.clone();
        let mut passed = vec![foot.clone()];
        let (mut h, mut length) = (self.settings.initial, 0.0);
        for _ in 0..MOST.0 {
            let end = match step(self.system, self.corrector, &self.settings, &foot, h) {
                Ok(end) if h > CLOSEST && may_dip(&foot, &end) => {
                    h = (0.3 * h).max(CLOSEST);
                    continue;
                }
                Ok(end) => end,
                Err(_) if h > self.settings.min => {
                    h = (0.3 * h).max(self.settings.min);
                    continue;
                }
                Err(_) => {
                    let Some(end) = self.around_corner(&foot, &passed) else { return false };
                    end
                }
            };
            if length > 0.0 {
                arms.extend(self.arm_between(&foot, &end));
            }
            let taken = distance(&foot.z, &end.z);
            length += taken;
            if closes(&first, &foot, &end, taken) {
                return true;
            }
            if length > MOST.1 {
                return false;
            }
            let next = if taken < h { taken } else { h * if end.iterations <= 3 { 2.0 } else { 1.0 } };
            h = next.clamp(self.settings.min, self.settings.max);
            let behind = Behind { z: foot.z, tangent: foot.tangent };
            foot = Foot { behind: Some(behind), ..Foot::from(&end) };
            passed.push(foot.clone());
        }
        false
    }

    /// The point between two at which μ vanishes, if it changes its sign.
    fn arm_between(&mut self, foot: &Foot, end: &Correction) -> Option<Vec<f64>> {
        let last = foot.z.len() - 1;
        let (from, to) = (foot.z[last], end.z[last]);
        if from * to > 0.0 || from == 0.0 {
            return None;
        }
        let h = dot(&end.z, &foot.tangent) - dot(&foot.z, &foot.tangent);
        let mut search = Search { system: &mut *self.system, corrector: &mut *self.corrector, foot, end, h };
        let root = if h > 0.0 { search.certain_root(|c| from.signum() * c.z[last]) } else { None };
        let share = from / (from - to);
        Some(root.map_or_else(|| along_chord(&foot.z, &end.z, share), |root| root.point.z))
    }

    /// The first point beyond a corner of the curve.
    fn around_corner(&mut self, foot: &Foot, passed: &[Foot]) -> Option<Correction> {
        if self.nesting >= NESTED {
            return None;
        }
        let points = || passed.iter().rev().map(|q| (q.z.clone(), q.tangent.as_slice()));
        let back = |radius| way_back(points(), foot, radius);
        match pass(self.system, self.corrector, &self.settings, self.nesting + 1, foot, back)? {
            Passage::Corner(end) => Some(end),
            Passage::Crossing(choice) => choice.arms.get(choice.own).cloned(),
        }
    }
}

fn along_chord(from: &[f64], to: &[f64], share: f64) -> Vec<f64> {
    from.iter().zip(to).map(|(f, t)| f + share * (t - f)).collect()
}

fn turn(foot: &mut Foot, sense: f64) {
    foot.tangent.iter_mut().for_each(|t| *t *= sense);
    foot.orientation *= sense;
}

/// Whether μ, which has the same sign at both ends, may vanish twice in between: its two tangents meet on the other
/// side of zero.
fn may_dip(foot: &Foot, end: &Correction) -> bool {
    let last = foot.z.len() - 1;
    let (a, b) = (foot.z[last], end.z[last]);
    let h = distance(&foot.z, &end.z);
    let (down, up) = (foot.tangent[last] * a.signum(), end.tangent[last] * a.signum());
    if a * b <= 0.0 || down >= 0.0 || up <= 0.0 {
        return false;
    }
    // |a| + down s = |b| − up (h − s)
    let s = ((b.abs() - up * h - a.abs()) / (down - up)).clamp(0.0, h);
    a.abs() + down * s <= 0.0
}

/// Whether a step of this length passes the start in the direction in which that was left.
fn closes(first: &Foot, foot: &Foot, end: &Correction, length: f64) -> bool {
    let ahead = |z: &[f64]| dot(z, &first.tangent) - dot(&first.z, &first.tangent);
    ahead(&foot.z) < 0.0
        && ahead(&end.z) >= 0.0
        && distance(&end.z, &first.z) < 2.0 * length
        && dot(&end.tangent, &first.tangent) > 0.5
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A point of the curve `(s, ½ s, μ(s))` with its tangent.
    fn at(s: f64, mu: [f64; 2]) -> Correction {
        let length = (1.25 + mu[1] * mu[1]).sqrt();
        Correction {
            z: vec![s, 0.5 * s, mu[0]],
            tangent: [1.0, 0.5, mu[1]].map(|t| t / length).to_vec(),
            orientation: 1.0,
            residual: 0.0,
            iterations: 1,
            pattern: 0,
            regularity: 1.0,
        }
    }

    /// Flat parabolas `±ε (c + (s − ½)²)`, whose tangents at the ends of the step meet at `±ε (c − ¼)`.
    #[test]
    fn a_parabola_may_dip_below_zero_where_its_tangents_meet_there() {
        for (c, expected) in [(-0.1, true), (0.05, true), (0.2, true), (0.3, false), (2.0, false)] {
            for sign in [1e-3, -1e-3] {
                let on = |s: f64| at(s, [sign * (c + (s - 0.5) * (s - 0.5)), sign * (2.0 * s - 1.0)]);
                let (foot, end) = (Foot::from(&on(0.0)), on(1.0));
                assert_eq!(may_dip(&foot, &end), expected, "{c} {sign}");
                // Away from zero all the way.
                let away = at(1.0, [sign * (c + 1.25), sign * 3.0]);
                assert!(!may_dip(&Foot::from(&end), &away));
            }
        }
        let through = at(1.0, [-0.25, 1.0]);
        assert!(!may_dip(&Foot::from(&at(0.0, [0.25, -1.0])), &through), "of different signs it is no dip");
    }

    #[test]
    fn a_curve_closes_where_it_passes_its_start_in_the_same_sense() {
        let circle = |degrees: f64, sense: f64| {
            let (sin, cos) = degrees.to_radians().sin_cos();
            Correction { z: vec![cos, sin, 0.0], tangent: vec![-sense * sin, sense * cos, 0.0], ..at(0.0, [0.0; 2]) }
        };
        let (first, step) = (Foot::from(&circle(0.0, 1.0)), 0.2);
        let closes_from =
            |from: f64, to: f64, sense: f64| closes(&first, &Foot::from(&circle(from, 1.0)), &circle(to, sense), step);
        assert!(closes_from(-5.0, 5.0, 1.0) && closes_from(-10.0, 0.1, 1.0));
        assert!(!closes_from(-15.0, -5.0, 1.0), "not yet");
        assert!(!closes_from(5.0, 15.0, 1.0), "it has left");
        assert!(!closes_from(-5.0, 5.0, -1.0), "against the sense");
        assert!(!closes_from(175.0, 185.0, 1.0) && !closes_from(-60.0, 40.0, 1.0), "far from the start");
        assert_eq!(along_chord(&[1.0, -2.0], &[2.0, 2.0], 0.25), [1.25, -1.0]);
    }
}
