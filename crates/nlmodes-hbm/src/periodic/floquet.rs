use std::f64::consts::TAU;

use nlmodes_linalg::{DenseLu, Mat, eigenvalues, matrix_exponential, max_norm};
use nlmodes_modal::Stability;
use num_complex::Complex64;

use super::block::dynamic_stiffness;
use super::law::{LawOperator, PlacedLaw, law_value, touch_spans};
use super::operating_point::OperatingPoint;
use super::system::PeriodicSystem;
use crate::closed_set::ClosedSet;
use crate::{ContactOperator, HbmError, RealSeries, Symmetry};

/// Floquet multipliers of a periodic response from its contact instants.
///
/// ```text
/// z̈ + Ĉ ż + (diag ω_k² − Yᵀ S_j Y) z = 0    while set j is closed, S_j = dλ/dy
/// M = Π_j e^{A_j Δt_j} ,   Π μ = e^{−tr Ĉ T}
/// ```
///
/// Laws beside the stops add `−Rᵀ (k r + c ṙ)` with their slopes at each instant, for which the intervals are divided
/// and the exponents are those of the fourth-order Magnus expansion at two points each. Contact forces start from
/// zero, so that nothing jumps at an instant. The instants are those of the motion with three times the harmonics,
/// whose additional ones follow from the contact forces; what each multiplier changes against those of the solution
/// itself makes the error band, also where another one may be the largest.
#[derive(Debug, Clone, PartialEq)]
pub struct Floquet {
    /// The 2m multipliers, by falling magnitude, without the +1 of rigid-body motions that no force reaches.
    pub multipliers: Vec<Complex64>,
    /// Estimated error of the largest one.
    pub error: f64,
}

impl Floquet {
    /// The largest multiplier, imaginary part not negative.
    pub fn largest(&self) -> Complex64 {
        self.multipliers.first().map_or(Complex64::default(), |m| Complex64::new(m.re, m.im.abs()))
    }

    /// Whether small disturbances die out, by the largest multiplier.
    pub fn stability(&self) -> Stability {
        let largest = self.largest();
        Stability::damped([largest.re, largest.im], self.error)
    }
}

/// Harmonics of the motion with better instants, over those of the solution.
const FINER: usize = 3;

/// Steps of a period for each harmonic in which the slopes of laws are followed.
const STEPS: usize = 4;

/// Steps of a touch of a stop with a law of force.
const STEPS_OF_TOUCH: usize = 32;

/// Displacements of the laws over a period.
pub(super) struct LawMotion {
    /// Complex amplitudes of each law, m.
    z: Vec<Vec<Complex64>>,
    /// Phases between 0 and 2π, in order, between which slopes of stops are smooth: steps in each touch, dense toward
    /// its ends, where a slope grows with a root of the time.
    breaks: Vec<f64>,
}

impl LawMotion {
    /// From coefficients, one law after the other, m, at an angular frequency, rad/s.
    pub fn new(series: RealSeries, real: &[f64], laws: &[PlacedLaw], omega: f64) -> Self {
        let of = |real: &[f64]| {
            let mut z = vec![Complex64::default(); series.n_harmonics + 1];
            series.to_complex(real, &mut z);
            z
        };
        let z: Vec<Vec<Complex64>> = real.chunks(series.width()).map(of).collect();
        let stops = laws.iter().zip(&z).filter(|(placed, _)| placed.law.stop_gap().is_some());
        let spans = stops.flat_map(|(placed, z)| touch_spans(placed.law.as_ref(), z, omega));
        let steps = spans.flat_map(|[from, to]| {
            let at = |s: f64| s.powi(3) * (10.0 + s * (6.0 * s - 15.0));
            let share = |j: usize| j as f64 / STEPS_OF_TOUCH as f64;
            (0..=STEPS_OF_TOUCH).map(move |j| (from + (to - from) * at(share(j))).rem_euclid(TAU))
        });
        let mut breaks: Vec<f64> = steps.collect();
        breaks.sort_by(f64::total_cmp);
        breaks.dedup();
        Self { z, breaks }
    }

    /// Displacement of a law and its derivative by the phase.
    fn at(&self, law: usize, tau: f64) -> (f64, f64) {
        law_value(&self.z[law], tau)
    }

    /// The steps in which an interval is divided, by their beginnings and widths.
    fn steps(&self, from: f64, width: f64) -> Vec<(f64, f64)> {
        let harmonics = self.z.first().map_or(0, Vec::len);
        let within = self.breaks.iter().copied().filter(|phase| *phase > from && *phase < from + width);
        let ends: Vec<f64> = [from].into_iter().chain(within).chain([from + width]).collect();
        let divided = |pair: &[f64]| {
            let (from, width) = (pair[0], pair[1] - pair[0]);
            let count = ((width / TAU * (STEPS * harmonics) as f64).ceil() as usize).max(1);
            (0..count).map(move |j| (from + width * j as f64 / count as f64, width / count as f64)).collect::<Vec<_>>()
        };
        ends.windows(2).flat_map(divided).collect()
    }
}

impl PeriodicSystem {
    /// Floquet multipliers of the response with the unknowns `x` at the parameter `p`. A free motion has the multiplier
    /// +1 by its phase.
    ///
    /// # Errors
    /// [`HbmError`] if the contact problem has no solution there, or a factorisation fails.
    pub fn floquet(&mut self, x: &[f64], p: f64, solver: &dyn nlmodes_contact::LcpSolver) -> Result<Floquet, HbmError> {
        let at = self.solve(x, p)?;
        let laws = self.law_motion(x, at.omega);
        let coarse = self.multipliers(&self.operator, &laws, at)?;
        let series = RealSeries { symmetry: Symmetry::None, n_harmonics: FINER * self.settings().harmonics };
        let mut finer = ContactOperator::new(self.structure.compliance(), series, crate::Switching::Exact, solver)?;
        let (y, laws) = self.finer_gaps(&mut finer, x, at)?;
        finer.solve(&y)?;
        let multipliers = self.multipliers(&finer, &laws, at)?;
        let error = band(&coarse, &multipliers);
        Ok(Floquet { multipliers, error: error.max(1e-9) })
    }

    /// Displacements of the laws in the motion with the unknowns `x` at an angular frequency, rad/s.
    pub(super) fn law_motion(&self, x: &[f64], omega: f64) -> LawMotion {
        LawMotion::new(self.series(), &self.law_displacements(x), self.structure.laws(), omega)
    }

    fn law_displacements(&self, x: &[f64]) -> Vec<f64> {
        let (first, unit) = (self.response.first_law() * self.series().width(), self.unit());
        x[first..self.n_coefficients()].iter().map(|x| x * unit).collect()
    }

    /// Gaps and displacements of laws with more harmonics, by the forces of those that there are:
    /// `y_n = Y D_n⁻¹ Yᵀ λ_n` beyond `N_h`, uncoupled damping.
    fn finer_gaps(
        &self,
        finer: &mut ContactOperator,
        x: &[f64],
        at: OperatingPoint,
    ) -> Result<(Vec<f64>, LawMotion), HbmError> {
        let (own, series) = (self.series(), finer.series());
        let (c, m, laws) = (self.structure.n_contacts(), self.structure.n_modes(), self.structure.laws());
        let with_more = |real: &[f64]| -> Vec<f64> {
            real.chunks(own.width()).flat_map(|y| as_unsymmetric(own, y).resized_to(series)).collect()
        };
        let (mut y, mut v) = (with_more(&self.y), with_more(&self.law_displacements(x)));
        finer.solve(&y)?;
        let forces = finer.apply(&y);
        let [reactions, _] = LawOperator::new(laws, series, self.structure.law_samples)?.solve(&v, at.omega);
        let rows = self.structure.rows();
        let row = |i: usize, k: usize| if i < c { rows[(i, k)] } else { laws[i - c].modes[k] };
        for n in own.n_harmonics + 1..=series.n_harmonics {
            let mut force: Vec<Complex64> = super::rows::complex_harmonic(series, &forces, n);
            force.resize(c, Complex64::default());
            force.extend(super::rows::complex_harmonic(series, &reactions, n));
            let mut moved = vec![Complex64::default(); force.len()];
            for k in 0..m {
                let (d, _) = dynamic_stiffness(&self.structure, n, k, at);
                let drive: Complex64 = force.iter().enumerate().map(|(i, f)| f * row(i, k)).sum();
                if drive.norm_sqr() > 0.0 && d.norm_sqr() > 0.0 {
                    moved.iter_mut().enumerate().for_each(|(i, g)| *g += drive / d * row(i, k));
                }
            }
            for (l, law) in laws.iter().enumerate() {
                for i in 0..c {
                    moved[i] += force[c + l] * law.contacts[i];
                    moved[c + l] += force[i] * law.contacts[i];
                }
                let among: Complex64 = law.laws.iter().zip(&force[c..]).map(|(h, f)| f * *h).sum();
                moved[c + l] += among;
            }
            for (i, moved) in moved.iter().enumerate() {
                let (real, i) = if i < c { (&mut y, i) } else { (&mut v, i - c) };
                series.put(*moved, n, &mut real[i * series.width()..(i + 1) * series.width()]);
            }
        }
        Ok((y, LawMotion::new(series, &v, laws, at.omega)))
    }

    /// What the motion does to a disturbance within an interval of the contact pattern: `e^{𝒜 Δt}`, `𝒜` that of
    /// [`flow`](Self::flow).
    pub(super) fn step(
        &self,
        operator: &ContactOperator,
        laws: &LawMotion,
        interval: &crate::PatternInterval,
        at: OperatingPoint,
    ) -> Result<Mat<f64>, HbmError> {
        let failed = |source| HbmError::Linalg { what: "matrix exponential between two contact instants", source };
        let (set, width) = (operator.sets.get(interval.set), (interval.to - interval.from).clamp(0.0, TAU));
        if laws.z.is_empty() {
            return matrix_exponential(&self.flow(set, laws, (interval.from, width), at)?).map_err(failed);
        }
        let states = self.n_states();
        let mut product = Mat::<f64>::identity(states, states);
        for (from, part) in laws.steps(interval.from, width) {
            let middle = from + 0.5 * part;
            let flow = |side: f64| self.flow(set, laws, (middle + side * 0.1 * 15_f64.sqrt() * part, part), at);
            let exponent = magnus([flow(-1.0)?, flow(0.0)?, flow(1.0)?]);
            product = matrix_exponential(&exponent).map_err(failed)? * product;
        }
        Ok(product)
    }

    /// Multipliers for the contact pattern of an operator, by falling magnitude.
    fn multipliers(
        &self,
        operator: &ContactOperator,
        laws: &LawMotion,
        at: OperatingPoint,
    ) -> Result<Vec<Complex64>, HbmError> {
        let (states, even) = (self.n_states(), operator.series().symmetry == Symmetry::Even);
        let mut monodromy = Mat::<f64>::identity(states, states);
        let mirrored = operator.intervals().iter().rev().filter(|_| even).map(|interval| crate::PatternInterval {
            from: TAU - interval.to,
            to: TAU - interval.from,
            ..*interval
        });
        for interval in operator.intervals().iter().copied().chain(mirrored) {
            let step = self.step(operator, laws, &interval, at)?;
            monodromy = step * monodromy;
        }
        let is_felt = |k: usize| self.structure.omega_squared()[k] > 0.0 || self.structure.moves_a_contact(k);
        let felt: Vec<usize> = (0..states).filter(|i| is_felt(i % self.structure.n_modes())).collect();
        let monodromy = Mat::from_fn(felt.len(), felt.len(), |i, j| monodromy[(felt[i], felt[j])]);
        let mut multipliers =
            eigenvalues(&monodromy).map_err(|source| HbmError::Linalg { what: "Floquet multipliers", source })?;
        multipliers.sort_by(|a, b| b.norm().total_cmp(&a.norm()));
        Ok(multipliers)
    }

    /// Length of a state `(z, ż/ω)`: stops that dissipate have no rate of their own.
    pub(super) fn n_states(&self) -> usize {
        self.structure.n_modes() + self.structure.n_moving()
    }

    /// `A_j Δτ/ω` for the state `(z, ż/ω)` at the phase `tau` for the width `Δτ`; of a stop that dissipates
    /// `d ṡ = λ − k s`.
    fn flow(
        &self,
        set: &ClosedSet,
        laws: &LawMotion,
        (tau, width): (f64, f64),
        OperatingPoint { omega, xi, .. }: OperatingPoint,
    ) -> Result<Mat<f64>, HbmError> {
        let m = self.structure.n_modes();
        let slopes = self.slopes(set, laws, tau, omega)?;
        let (moving, states) = (self.structure.n_moving(), self.n_states());
        Ok(Mat::from_fn(states, states, |i, j| {
            let (k, l) = (i % m, j % m);
            let own = f64::from(u8::from(k == l));
            let pressed = || slopes.sum(&slopes.by_place, k, l) - own * self.structure.omega_squared()[k];
            let damped = || self.structure.damping().entry(k, l) - slopes.sum(&slopes.by_rate, k, l) - own * xi;
            width
                * match (i < m, j < m) {
                    (true, true) if i < moving => 0.0,
                    (true, true) => pressed() / (self.structure.damping().entry(k, k) * omega),
                    (true, false) if i >= moving => 0.0,
                    (true, false) => own,
                    (false, true) => pressed() / (omega * omega),
                    (false, false) => -damped() / omega,
                }
        }))
    }

    /// How the forces of closed contacts and laws follow a disturbance at a phase.
    ///
    /// With `δλ = S (Y z + H_uf δf)` of the closed contacts and `δf = −k (R z + H_fu δλ + H_ff δf) − c R ż`, both are
    /// eliminated; residual flexibility under a damper is left out.
    fn slopes(&self, set: &ClosedSet, motion: &LawMotion, tau: f64, omega: f64) -> Result<Slopes, HbmError> {
        let (m, rows, laws) = (self.structure.n_modes(), self.structure.rows(), self.structure.laws());
        let closed = &set.active;
        let (a, size) = (closed.len(), closed.len() + laws.len());
        let places = Mat::from_fn(size, m, |i, k| match i.checked_sub(a) {
            None => rows[(closed[i], k)],
            Some(l) => laws[l].modes[k],
        });
        let pressed = |i: usize, z: &dyn Fn(usize) -> f64| set.force_row(closed[i]).map(|(j, s)| s * z(j)).sum::<f64>();
        if laws.is_empty() {
            let by_place = Mat::from_fn(a, m, |i, k| pressed(i, &|j| rows[(j, k)]));
            return Ok(Slopes { by_rate: Mat::zeros(0, m), by_place, places });
        }
        let slope = |l: usize| {
            let (v, dv) = motion.at(l, tau);
            laws[l].law.at(v, omega * dv)
        };
        let slopes: Vec<_> = (0..laws.len()).map(slope).collect();
        let coupled = Mat::from_fn(size, size, |i, j| {
            let own = f64::from(u8::from(i == j));
            own + match (i.checked_sub(a), j.checked_sub(a)) {
                (None, None) => 0.0,
                (None, Some(l)) => -pressed(i, &|j| laws[l].contacts[j]),
                (Some(l), None) => slopes[l].stiffness * laws[l].contacts[closed[j]],
                (Some(l), Some(other)) => slopes[l].stiffness * laws[l].laws[other],
            }
        });
        let lu = DenseLu::factor(&coupled)
            .map_err(|source| HbmError::Linalg { what: "forces of contacts and laws together", source })?;
        let by_place = Mat::from_fn(size, m, |i, k| match i.checked_sub(a) {
            None => pressed(i, &|j| rows[(j, k)]),
            Some(l) => -slopes[l].stiffness * laws[l].modes[k],
        });
        let by_rate = Mat::from_fn(size, m, |i, k| match i.checked_sub(a) {
            None => 0.0,
            Some(l) => -slopes[l].damping * laws[l].modes[k],
        });
        Ok(Slopes { by_place: lu.solve_columns(&by_place), by_rate: lu.solve_columns(&by_rate), places })
    }
}

/// The exponent of a step of order six, from `𝒜 Δt` at the three points of Gauss (Blanes, Casas, Ros 2000).
fn magnus([before, middle, after]: [Mat<f64>; 3]) -> Mat<f64> {
    let combined = |a: f64, b: f64, c: f64| {
        Mat::from_fn(middle.nrows(), middle.ncols(), |i, j| a * before[(i, j)] + b * middle[(i, j)] + c * after[(i, j)])
    };
    let twisted = |a: &Mat<f64>, b: &Mat<f64>| a * b - b * a;
    let slope = combined(-(15_f64.sqrt()) / 3.0, 0.0, 15_f64.sqrt() / 3.0);
    let bend = combined(10.0 / 3.0, -20.0 / 3.0, 10.0 / 3.0);
    let first = twisted(&middle, &slope);
    let second = twisted(&middle, &(&bend + &bend + &first));
    let sum =
        |a: &Mat<f64>, b: &Mat<f64>, by: f64| Mat::from_fn(a.nrows(), a.ncols(), |i, j| a[(i, j)] + by * b[(i, j)]);
    let last = twisted(&sum(&(&first - &bend), &middle, -20.0), &sum(&slope, &second, -1.0 / 60.0));
    sum(&sum(&middle, &bend, 1.0 / 12.0), &last, 1.0 / 240.0)
}

/// How forces follow modal displacements and velocities, and how they act on the modes.
struct Slopes {
    /// Forces by modal displacements, and by modal velocities, a row each; none of the latter without laws.
    by_place: Mat<f64>,
    by_rate: Mat<f64>,
    /// The modes at their places.
    places: Mat<f64>,
}

impl Slopes {
    /// What forces do to mode `k` by mode `l`.
    fn sum(&self, forces: &Mat<f64>, k: usize, l: usize) -> f64 {
        (0..forces.nrows()).map(|i| self.places[(i, k)] * forces[(i, l)]).sum()
    }
}

/// How far the largest multiplier may lie from that of `after`, both by falling magnitude: each multiplier by its
/// distance from the nearest one of `before`, for another one may be the largest in truth. Beside a fold a small one
/// moves far.
fn band(before: &[Complex64], after: &[Complex64]) -> f64 {
    let (Some(old), Some(new)) = (before.first(), after.first()) else { return 0.0 };
    let off = |m: &Complex64| before.iter().map(|b| (b - m).norm()).fold(f64::INFINITY, f64::min);
    let largest = max_norm(after.iter().map(|m| m.norm() + off(m)));
    (largest - new.norm()).max((new.norm() - old.norm()).abs())
}

/// Coefficients of a series without symmetry.
struct Unsymmetric {
    series: RealSeries,
    coefficients: Vec<f64>,
}

fn as_unsymmetric(series: RealSeries, y: &[f64]) -> Unsymmetric {
    let mut coefficients = y.to_vec();
    if series.symmetry == Symmetry::Even {
        coefficients.resize(2 * series.n_harmonics + 1, 0.0);
    }
    Unsymmetric { series: RealSeries { symmetry: Symmetry::None, ..series }, coefficients }
}

impl Unsymmetric {
    fn resized_to(&self, to: RealSeries) -> Vec<f64> {
        self.series.resized(&self.coefficients, to)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_band_holds_the_multiplier_that_is_the_largest_in_truth() {
        let pair = |size: f64| [Complex64::from_polar(size, 2.28), Complex64::from_polar(size, -2.28)];
        let real = |x: f64| Complex64::new(x, 0.0);
        // A response beside a fold: the real multiplier, which is +1 there, moves most, and is the largest in truth,
        // 0.9062.
        let before = [pair(0.9047).as_slice(), &[real(0.88)]].concat();
        let after = [pair(0.9011).as_slice(), &[real(0.896)]].concat();
        let error = band(&before, &after);
        assert!(0.9011 + error > 0.9062 && error < 0.02, "{error}");
        // Alone it is as uncertain as it changed.
        assert!((band(&pair(0.9), &pair(0.91)) - 0.01).abs() < 1e-12);
        assert_eq!(band(&pair(0.9), &pair(0.9)), 0.0);
    }
}
