use std::sync::Arc;

use nlmodes_linalg::{Mat, column_mut};

use crate::oscillation::{cosine_and_sine, fall_integral};
use crate::phase::{Coordinates, Phase};

/// Displacements and velocities in modal coordinates of the open structure: `q = Φ z` where it is open, with `Φᵀ M Φ =
/// I`; units m·√kg and m·√kg/s.
#[derive(Debug, Clone, PartialEq)]
pub struct ModalState {
    /// Coordinates, m.
    pub z: Vec<f64>,
    /// Their rates, m.
    pub v: Vec<f64>,
}

/// A motion as a sequence of segments with constant sets of closed contacts.
#[derive(Debug, Clone)]
pub struct Trajectory {
    pub(crate) segments: Vec<Segment>,
    /// The state at its end.
    pub end: ModalState,
}

#[derive(Debug, Clone)]
pub(crate) struct Segment {
    pub from: f64,
    pub to: f64,
    pub phase: Arc<Phase>,
    pub start: Coordinates,
}

/// A time interval in which a contact is closed.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ClosedInterval {
    /// The contact.
    pub contact: usize,
    /// Instant of closing, s; 0 if it is closed from the beginning.
    pub from: f64,
    /// Instant of opening, s; the end of the trajectory if it remains closed.
    pub to: f64,
}

/// Motion of the structure at one instant.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Snapshot {
    /// Displacements of all degrees of freedom.
    pub displacement: Vec<f64>,
    /// Velocities of all degrees of freedom.
    pub velocity: Vec<f64>,
    /// Contact forces, N.
    pub forces: Vec<f64>,
}

impl Trajectory {
    /// Its length, s.
    pub fn duration(&self) -> f64 {
        self.segments.last().map_or(0.0, |s| s.to)
    }

    /// The structure at the instant `t`, clamped to the trajectory.
    pub fn at(&self, t: f64) -> Snapshot {
        let i = self.segments.partition_point(|s| s.to < t).min(self.segments.len() - 1);
        let segment = &self.segments[i];
        let at = segment.phase.after(&segment.start, (t.min(segment.to) - segment.from).max(0.0));
        Snapshot {
            displacement: segment.phase.displacement(&at),
            velocity: segment.phase.velocity(&at),
            forces: (0..segment.phase.closed.len()).map(|i| segment.phase.force(i, &at)).collect(),
        }
    }

    /// Energy at the beginning of each segment and at the end of the last, J.
    pub fn energies(&self) -> Vec<f64> {
        let starts = self.segments.iter().map(|s| s.phase.energy(&s.start));
        let end = self.segments.last().map(|s| s.phase.energy(&s.phase.after(&s.start, s.to - s.from)));
        starts.chain(end).collect()
    }

    /// Intervals in which contacts are closed, in order of their beginning.
    pub fn closed_intervals(&self) -> Vec<ClosedInterval> {
        let mut found: Vec<ClosedInterval> = Vec::new();
        for segment in &self.segments {
            for contact in (0..segment.phase.closed.len()).filter(|&i| segment.phase.closed[i]) {
                match found.iter_mut().rev().find(|i| i.contact == contact && i.to == segment.from) {
                    Some(interval) => interval.to = segment.to,
                    None => found.push(ClosedInterval { contact, from: segment.from, to: segment.to }),
                }
            }
        }
        found
    }

    /// `∫ ½ żᵀż dt`, J·s.
    pub fn kinetic_integral(&self) -> f64 {
        self.segments.iter().map(Segment::kinetic_integral).sum()
    }

    /// Accelerations at its end, in modal coordinates of the open structure.
    pub(crate) fn final_acceleration(&self) -> Vec<f64> {
        self.segments.last().map_or_else(Vec::new, |s| s.phase.acceleration(&s.phase.after(&s.start, s.to - s.from)))
    }

    /// The derivative of the end state with respect to the first one times `z` and `v` (m × any each): a product of
    /// exponentials, since nothing jumps at contact instants. `each` is called with the derivative at the beginning of
    /// each segment, in the coordinates of its phase.
    pub(crate) fn transition(
        &self,
        z: Mat<f64>,
        v: Mat<f64>,
        mut each: impl FnMut(&Segment, &Mat<f64>, &Mat<f64>),
    ) -> (Mat<f64>, Mat<f64>) {
        let (mut z, mut v) = (z, v);
        for segment in &self.segments {
            let phase = &segment.phase;
            let (mut u, mut w) = (&phase.turn * &z, &phase.turn * &v);
            each(segment, &u, &w);
            let turns: Vec<(f64, f64)> =
                phase.omega.iter().map(|omega| cosine_and_sine(*omega, segment.to - segment.from)).collect();
            for j in 0..u.ncols() {
                let states = column_mut(&mut u, j).iter_mut().zip(column_mut(&mut w, j));
                for (((u, w), (cos, sin)), lambda) in states.zip(&turns).zip(&phase.lambda) {
                    (*u, *w) = (*u * cos + *w * sin, *w * cos - lambda * sin * *u);
                }
            }
            (z, v) = (phase.turn.transpose() * &u, phase.turn.transpose() * &w);
        }
        (z, v)
    }
}

impl Segment {
    /// `∫ ½ v² dt` of each mode is a quadratic form in its state at the beginning: the factors of `u²`, `uv` and `v²`.
    fn kinetic_form(&self, k: usize) -> [f64; 3] {
        let (λ, length) = (self.phase.lambda[k], self.to - self.from);
        let (cos, sin) = cosine_and_sine(self.phase.omega[k], length);
        let squared_cosine = 0.5 * (length + cos * sin);
        [0.5 * λ * (length - squared_cosine), -0.5 * λ * sin * sin, 0.5 * squared_cosine]
    }

    /// What a steady force adds to that, with the speed `p sin(ωt)/ω`: the factors of `u` and `v`, and what is alone.
    fn kinetic_push(&self, k: usize) -> [f64; 3] {
        let (λ, length) = (self.phase.lambda[k], self.to - self.from);
        let push = self.phase.push.get(k).copied().filter(|push| *push != 0.0);
        let Some(push) = push else { return [0.0; 3] };
        let (omega, squared_sine) = (self.phase.omega[k], 2.0 * fall_integral(2.0 * self.phase.omega[k], length));
        let sin = cosine_and_sine(omega, length).1;
        [-push * λ * squared_sine, 0.5 * push * sin * sin, 0.5 * push * push * squared_sine]
    }

    fn kinetic_integral(&self) -> f64 {
        let of = |k: usize| {
            let ([uu, uv, vv], u, v) = (self.kinetic_form(k), self.start.u[k], self.start.v[k]);
            let [of_u, of_v, own] = self.kinetic_push(k);
            uu * u * u + uv * u * v + vv * v * v + of_u * u + of_v * v + own
        };
        (0..self.start.u.len()).map(of).sum()
    }

    /// Derivatives of the integral with respect to coordinate and rate of mode `k` at the beginning.
    pub fn kinetic_gradient(&self, k: usize) -> [f64; 2] {
        let ([uu, uv, vv], u, v) = (self.kinetic_form(k), self.start.u[k], self.start.v[k]);
        let [of_u, of_v, _] = self.kinetic_push(k);
        [2.0 * uu * u + uv * v + of_u, uv * u + 2.0 * vv * v + of_v]
    }
}
