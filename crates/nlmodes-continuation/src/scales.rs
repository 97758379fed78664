//! Sizes of unknowns and equations: beside them everything is judged.

use crate::corrector::Corrector;
use crate::crossing::Choice;
use crate::record::StepRecord;
use crate::vectors::dot;
use crate::{
    Boundary, BranchPoint, Correction, Crossing, LinearSolver, Linearization, ParametricSystem, Refusal, StopReason,
};

/// Least size of an unknown that follows from the tangent; anything below is rounding.
const LEAST: f64 = 1e-10;

/// Largest derivative of an equation, over its size: residuals of numbers near one have such.
const LARGEST: f64 = 4.0;

/// Sizes of unknowns between which numbers are near one, and lengths are as they are given.
const NEAR_ONE: f64 = 32.0;

/// What is large for each unknown and for each equation: steps, distances and tolerances are shares of these.
///
/// A continuation uses the nearest powers of two, so that nothing is rounded.
#[derive(Debug, Clone, PartialEq)]
pub struct Scaling {
    /// Of the unknowns and, last, of the parameter: n + 1.
    pub unknowns: Vec<f64>,
    /// Of the equations, n: what a residual of one means.
    pub equations: Vec<f64>,
}

impl Scaling {
    /// For a system of n equations all of whose numbers are near one.
    pub fn unit(n: usize) -> Self {
        Self { unknowns: vec![1.0; n + 1], equations: vec![1.0; n] }
    }

    /// From the starting point, the Jacobian `at` it, and the direction there, where `at_rest` gives the sizes of
    /// unknowns and parameter if all are zero; and whether the points that follow may be
    /// large beside these sizes, as they may wherever numbers are not near one, or zero without a tangent that tells
    /// what they are near to.
    ///
    /// All unknowns have one size, that of the largest. What is zero has the size by which it moves while the other one
    /// moves by its own, if the tangent tells that, else one; sizes near one are one. An equation has a size a little
    /// below that of its largest derivative.
    /// The parameter is no larger than `most`, between its bounds.
    pub(crate) fn found(
        at: &Linearization,
        solver: Box<dyn LinearSolver>,
        (x, p): (&[f64], f64),
        direction: &[f64],
        most: f64,
        at_rest: Option<[f64; 2]>,
    ) -> (Self, bool) {
        let (x_size, p_size) = (largest(x), p.abs());
        let ratio = tangent(at, solver, direction)
            .map(|t| largest(&t[..x.len()]) / t[x.len()].abs())
            .filter(|ratio| ratio.is_finite() && *ratio > 0.0);
        let credible = |size: f64| if size > LEAST { size } else { 1.0 };
        let is_told = at_rest.is_some()
            || x_size > 0.0
            || p_size > 0.0
            || ratio.is_some_and(|ratio| ratio.min(1.0 / ratio) > LEAST);
        let (x_size, p_size) = match (x_size > 0.0, p_size > 0.0, ratio) {
            (true, true, _) => (x_size, p_size),
            (false, true, Some(ratio)) => (credible(ratio * p_size), p_size),
            (true, false, Some(ratio)) => (x_size, credible(x_size / ratio)),
            (false, false, Some(ratio)) => (credible(ratio / ratio.max(1.0)), credible(1.0 / ratio.max(1.0))),
            (true, false, None) => (x_size, 1.0),
            (false, true, None) => (1.0, p_size),
            (false, false, None) => (1.0, 1.0),
        };
        let [x_size, p_size] = at_rest.unwrap_or([x_size, p_size]);
        let p_size = if most > 0.0 { p_size.min(most) } else { p_size };
        let is_near_one = |size: f64| (1.0 / NEAR_ONE..=NEAR_ONE).contains(&size) && at_rest.is_none();
        let size = |size: f64| if is_near_one(size) { 1.0 } else { size };
        let unknowns: Vec<f64> = x.iter().map(|_| size(x_size)).chain([size(p_size)]).collect();
        let mut rows = vec![0.0_f64; x.len()];
        at.each(|i, j, value| rows[i] = rows[i].max(value.abs() * unknowns[j]));
        let of_row = |size: f64| {
            if size > 0.0 && size.is_finite() { (size / LARGEST).log2().floor().exp2() } else { 1.0 }
        };
        let equations = rows.into_iter().map(of_row).collect();
        let goes_far = !is_told || unknowns.iter().any(|size| *size != 1.0);
        (Self { unknowns, equations }, goes_far)
    }

    /// The nearest powers of two.
    pub(crate) fn rounded(mut self) -> Self {
        let all = self.unknowns.iter_mut().chain(&mut self.equations);
        all.for_each(|size| *size = size.log2().round().clamp(-1000.0, 1000.0).exp2());
        self
    }

    pub(crate) fn to_scaled(&self, z: &mut [f64]) {
        z.iter_mut().zip(&self.unknowns).for_each(|(z, size)| *z /= size);
    }

    pub(crate) fn to_units(&self, z: &mut [f64]) {
        z.iter_mut().zip(&self.unknowns).for_each(|(z, size)| *z *= size);
    }

    fn parameter(&self) -> f64 {
        self.unknowns.last().copied().unwrap_or(1.0)
    }

    /// A point in the units of the system, with a tangent of unit length there.
    pub(crate) fn point_in_units(&self, q: BranchPoint) -> BranchPoint {
        let mut q = self.point_for_log(q);
        to_unit_length(&mut q.tangent);
        q
    }

    /// A point for a log: from its tangent, whose length is one only over the sizes, that can be had again bit for bit.
    fn point_for_log(&self, mut q: BranchPoint) -> BranchPoint {
        self.to_units(&mut q.x);
        self.to_units(&mut q.tangent);
        q.p *= self.parameter();
        q
    }

    pub(crate) fn correction_for_log(&self, mut c: Correction) -> Correction {
        self.to_units(&mut c.z);
        self.to_units(&mut c.tangent);
        c
    }

    fn choice_for_log(&self, mut choice: Choice) -> Choice {
        self.to_units(&mut choice.z);
        self.to_units(&mut choice.back);
        choice.arms = choice.arms.into_iter().map(|arm| self.correction_for_log(arm)).collect();
        choice
    }

    pub(crate) fn crossing_in_units(&self, mut crossing: Crossing) -> Crossing {
        self.to_units(&mut crossing.z);
        for arm in &mut crossing.arms {
            self.to_units(&mut arm.start.z);
            self.to_units(&mut arm.start.tangent);
            to_unit_length(&mut arm.start.tangent);
        }
        crossing
    }

    pub(crate) fn stop_in_units(&self, mut stop: StopReason) -> StopReason {
        if let StopReason::Bound { coordinate, value }
        | StopReason::StepTooSmall { refusal: Refusal::BoundNotLocated { coordinate, value }, .. } = &mut stop
        {
            *value *= self.unknowns.get(*coordinate).copied().unwrap_or(1.0);
        }
        stop
    }

    pub(crate) fn record_for_log(&self, mut record: StepRecord) -> StepRecord {
        record.points = record.points.into_iter().map(|q| self.point_for_log(q)).collect();
        record.crossing = record.crossing.map(|choice| self.choice_for_log(choice));
        record.stop = record.stop.map(|stop| self.stop_in_units(stop));
        record
    }

    pub(crate) fn record_in_scales(&self, record: StepRecord) -> StepRecord {
        self.inverse().record_for_log(record)
    }

    /// Sizes are powers of two: nothing is rounded.
    fn inverse(&self) -> Self {
        let inverse = |sizes: &[f64]| sizes.iter().map(|size| 1.0 / size).collect();
        Self { unknowns: inverse(&self.unknowns), equations: inverse(&self.equations) }
    }
}

fn largest(v: &[f64]) -> f64 {
    v.iter().fold(0.0_f64, |m, v| m.max(v.abs()))
}

/// Change of the equations' terms at which a length is measured, and the most evaluations for that.
const CHANGED: f64 = 0.15;
const TRIED: usize = 16;

/// Sizes of unknowns and parameter of a system all of whose numbers are zero at the start: those by which they move
/// while the Jacobian changes by its own size. So they are the same motion in any units; `None` where nothing changes.
///
/// ```text
/// q(h) = max_i |Σ_j (J(h t) − J(0))_ij t_j| / Σ_j |J(0)_ij t_j| ,   sizes h |t_j| / q
/// ```
pub(crate) fn sizes_at_rest<S: ParametricSystem>(
    system: &mut S,
    corrector: &mut Corrector,
    direction: &[f64],
) -> Option<[f64; 2]> {
    let at = corrector.linearization().clone();
    let t = tangent(&at, system.solver(), direction)?;
    let (p, x) = t.split_last()?;
    let mut terms = vec![0.0; x.len()];
    at.each(|i, j, value| terms[i] += (value * t[j]).abs());
    let start = at.times(&t);
    let (mut h, mut before) = (1.0 / largest(&t), None::<[f64; 2]>);
    for _ in 0..TRIED {
        let z: Vec<f64> = t.iter().map(|t| h * t).collect();
        let changed = corrector.evaluate(system, &z).map_or(f64::INFINITY, |_| {
            let now = corrector.linearization().times(&t);
            let shares = now.iter().zip(&start).zip(&terms).filter(|(_, terms)| **terms > 0.0);
            shares.map(|((now, start), terms)| (now - start).abs() / terms).fold(0.0, f64::max)
        });
        if (changed / CHANGED - 1.0).abs() < 0.01 {
            return Some([largest(x), p.abs()].map(|t| h * t / changed)).filter(|[x, p]| *x > 0.0 && *p > 0.0);
        }
        // The power of h with which it grows.
        let power = before.map_or(1.0, |[h0, q0]| ((changed / q0).ln() / (h / h0).ln()).clamp(0.5, 3.0));
        before = Some([h, changed]).filter(|_| changed.is_finite() && changed > 0.0);
        h *= if power.is_nan() { 1e-3 } else { (CHANGED / changed).powf(1.0 / power).clamp(1e-3, 1e3) };
    }
    None
}

/// Leaves vectors alone that have it but for rounding.
fn to_unit_length(v: &mut [f64]) {
    let length = dot(v, v).sqrt();
    if (length - 1.0).abs() > 1e-12 {
        v.iter_mut().for_each(|v| *v /= length);
    }
}

/// The vector that the Jacobian takes to zero, along `direction`.
fn tangent(at: &Linearization, mut solver: Box<dyn LinearSolver>, direction: &[f64]) -> Option<Vec<f64>> {
    solver.factor(at, direction).ok()?;
    let mut tangent = vec![0.0; direction.len()];
    *tangent.last_mut()? = 1.0;
    solver.solve_in_place(&mut tangent);
    Some(tangent)
}

/// A system in shares of its sizes.
///
/// The type of the system ends here: what follows branches is compiled once, not for each system.
pub(crate) struct Scaled<'a, E> {
    system: &'a mut (dyn ParametricSystem<Error = E> + 'a),
    pub scales: Scaling,
    /// Whether all sizes are one.
    unit: bool,
    z: Vec<f64>,
}

impl<'a, E: std::error::Error + 'static> Scaled<'a, E> {
    pub fn new(system: &'a mut (dyn ParametricSystem<Error = E> + 'a), scales: Scaling) -> Self {
        let unit = scales.unknowns.iter().chain(&scales.equations).all(|size| *size == 1.0);
        Self { z: vec![0.0; scales.unknowns.len()], system, scales, unit }
    }

    fn set(&mut self, x: &[f64], p: f64) {
        let all = x.iter().copied().chain([p]);
        self.z.iter_mut().zip(all.zip(&self.scales.unknowns)).for_each(|(z, (scaled, size))| *z = scaled * size);
    }
}

impl<E: std::error::Error + 'static> ParametricSystem for Scaled<'_, E> {
    type Error = E;

    fn dim(&self) -> usize {
        self.scales.equations.len()
    }

    fn linearize(&mut self, x: &[f64], p: f64, out: &mut Linearization) -> Result<(), E> {
        if self.unit {
            return self.system.linearize(x, p, out);
        }
        self.set(x, p);
        let n = x.len();
        out.sizes.fill(1.0);
        self.system.linearize(&self.z[..n], self.z[n], out)?;
        let Scaling { unknowns, equations } = &self.scales;
        out.scale_entries(|i, j| unknowns[j] / equations[i]);
        for (i, unit) in equations.iter().enumerate() {
            out.residual[i] /= unit;
            // A system that writes none has ones.
            if out.sizes[i] != 1.0 {
                out.sizes[i] /= unit;
            }
        }
        Ok(())
    }

    fn solver(&self) -> Box<dyn LinearSolver> {
        self.system.solver()
    }

    fn pattern(&self) -> u64 {
        self.system.pattern()
    }

    fn pattern_at(&mut self, z: &[f64]) -> Option<u64> {
        let in_units: Vec<f64> = z.iter().zip(&self.scales.unknowns).map(|(z, size)| z * size).collect();
        self.system.pattern_at(&in_units)
    }

    fn boundary(&mut self, from: &[f64], to: &[f64]) -> Option<Boundary> {
        if self.unit {
            return self.system.boundary(from, to);
        }
        let sizes = self.scales.unknowns.clone();
        let in_units = move |z: &[f64]| z.iter().zip(&sizes).map(|(z, size)| z * size).collect::<Vec<f64>>();
        let boundary = self.system.boundary(&in_units(from), &in_units(to))?;
        Some(Boundary::new(move |z| boundary.value(&in_units(z))))
    }

    fn accepted(&mut self, x: &[f64], p: f64) {
        if self.unit {
            return self.system.accepted(x, p);
        }
        self.set(x, p);
        let n = x.len();
        self.system.accepted(&self.z[..n], self.z[n]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounded_sizes_are_the_nearest_powers_of_two_whose_inverse_is_a_number() {
        let sizes = vec![1.0, 3.0, 2.8, 0.3, 5e-324, f64::MAX];
        let rounded = Scaling { unknowns: sizes, equations: vec![1e300, 1e-300] }.rounded();
        assert_eq!(rounded.unknowns, [1.0, 4.0, 2.0, 0.25, 2f64.powi(-1000), 2f64.powi(1000)]);
        assert_eq!(rounded.equations, [2f64.powi(997), 2f64.powi(-997)]);
        let back = rounded.inverse();
        let all = rounded.unknowns.iter().chain(&rounded.equations).zip(back.unknowns.iter().chain(&back.equations));
        assert!(all.clone().count() == 8 && all.into_iter().all(|(size, inverse)| size * inverse == 1.0));
    }

    #[test]
    fn bounds_and_parameters_come_back_in_their_own_units() {
        let scales = Scaling { unknowns: vec![8.0, 0.5], equations: vec![2.0] };
        for (coordinate, value) in [(0, 24.0), (1, 1.5)] {
            let stop = scales.stop_in_units(StopReason::Bound { coordinate, value: 3.0 });
            assert_eq!(stop, StopReason::Bound { coordinate, value });
        }
        assert_eq!(scales.stop_in_units(StopReason::MaxPoints), StopReason::MaxPoints);
        let mut z = [3.0, 5.0];
        scales.to_units(&mut z);
        assert_eq!(z, [24.0, 2.5]);
        scales.to_scaled(&mut z);
        assert_eq!((z, scales.parameter()), ([3.0, 5.0], 0.5));
    }
}
