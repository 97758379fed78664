use std::f64::consts::TAU;

use nlmodes_linalg::{Mat, eigenvalues, matrix_exponential, max_norm};
use nlmodes_modal::Stability;
use num_complex::Complex64;

use super::block::dynamic_stiffness;
use super::operating_point::OperatingPoint;
use super::system::PeriodicSystem;
use crate::{ContactOperator, HbmError, RealSeries, Symmetry};

/// Floquet multipliers of a periodic response from its contact instants.
///
/// ```text
/// z̈ + Ĉ ż + (diag ω_k² − Yᵀ S_j Y) z = 0    while set j is closed, S_j = dλ/dy ;    M = Π_j e^{A_j Δt_j} ,   Π μ = e^{−tr Ĉ T}
/// ```
///
/// Contact forces start from zero, so that nothing jumps at an instant. The instants are those of the motion with three
/// times the harmonics, whose additional ones follow from the contact forces; what each multiplier changes against
/// those of the solution itself makes the error band, also where another one may be the largest.
#[derive(Debug, Clone, PartialEq)]
pub struct Floquet {
    /// The 2m multipliers, by falling magnitude.
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

impl PeriodicSystem {
    /// Floquet multipliers of the response with the unknowns `x` at the parameter `p`. A free motion has the multiplier
    /// +1 by its phase.
    ///
    /// # Errors
    /// [`HbmError`] if the contact problem has no solution there, or a factorisation fails.
    pub fn floquet(&mut self, x: &[f64], p: f64, solver: &dyn nlmodes_contact::LcpSolver) -> Result<Floquet, HbmError> {
        let at = self.solve(x, p)?;
        let coarse = self.multipliers(&self.operator, at.omega, at.xi)?;
        let series = RealSeries { symmetry: Symmetry::None, n_harmonics: FINER * self.settings().harmonics };
        let mut finer = ContactOperator::new(self.structure.compliance(), series, crate::Switching::Exact, solver)?;
        let y = self.finer_gaps(&mut finer, at)?;
        finer.solve(&y)?;
        let multipliers = self.multipliers(&finer, at.omega, at.xi)?;
        let error = band(&coarse, &multipliers);
        Ok(Floquet { multipliers, error: error.max(1e-9) })
    }

    /// Gaps with more harmonics, by the forces of the gaps that there are: `y_n = Y D_n⁻¹ Yᵀ λ_n` beyond `N_h`,
    /// uncoupled damping.
    fn finer_gaps(&self, finer: &mut ContactOperator, at: OperatingPoint) -> Result<Vec<f64>, HbmError> {
        let (own, series) = (self.series(), finer.series());
        let (c, m) = (self.structure.n_contacts(), self.structure.n_modes());
        let mut y: Vec<f64> =
            self.y.chunks(own.width()).flat_map(|y| as_unsymmetric(own, y).resized_to(series)).collect();
        finer.solve(&y)?;
        let forces = finer.apply(&y);
        let rows = self.structure.rows();
        for n in own.n_harmonics + 1..=series.n_harmonics {
            let force: Vec<Complex64> = super::rows::complex_harmonic(series, &forces, n);
            let mut gap = vec![Complex64::default(); c];
            for k in 0..m {
                let (d, _) = dynamic_stiffness(&self.structure, n, k, at);
                let drive: Complex64 = (0..c).map(|i| force[i] * rows[(i, k)]).sum();
                if drive.norm_sqr() > 0.0 && d.norm_sqr() > 0.0 {
                    gap.iter_mut().enumerate().for_each(|(i, g)| *g += drive / d * rows[(i, k)]);
                }
            }
            for (i, gap) in gap.iter().enumerate() {
                series.put(*gap, n, &mut y[i * series.width()..(i + 1) * series.width()]);
            }
        }
        Ok(y)
    }

    /// What the motion does to a disturbance within an interval of the contact pattern: `e^{𝒜 Δt}`, `𝒜` that of
    /// [`flow`](Self::flow).
    pub(super) fn step(
        &self,
        operator: &ContactOperator,
        interval: &crate::PatternInterval,
        omega: f64,
        xi: f64,
    ) -> Result<Mat<f64>, HbmError> {
        matrix_exponential(&self.flow(operator, interval, omega, xi))
            .map_err(|source| HbmError::Linalg { what: "matrix exponential between two contact instants", source })
    }

    /// Multipliers for the contact pattern of an operator, by falling magnitude.
    fn multipliers(&self, operator: &ContactOperator, omega: f64, xi: f64) -> Result<Vec<Complex64>, HbmError> {
        let (states, even) = (self.n_states(), operator.series().symmetry == Symmetry::Even);
        let mut monodromy = Mat::<f64>::identity(states, states);
        let mirrored = operator.intervals().iter().rev().filter(|_| even);
        for interval in operator.intervals().iter().chain(mirrored) {
            let step = self.step(operator, interval, omega, xi)?;
            monodromy = step * monodromy;
        }
        let mut multipliers =
            eigenvalues(&monodromy).map_err(|source| HbmError::Linalg { what: "Floquet multipliers", source })?;
        multipliers.sort_by(|a, b| b.norm().total_cmp(&a.norm()));
        Ok(multipliers)
    }

    /// Length of a state `(z, ż/ω)`: stops that dissipate have no rate of their own.
    pub(super) fn n_states(&self) -> usize {
        self.structure.n_modes() + self.structure.n_moving()
    }

    /// `A_j Δτ/ω` for the state `(z, ż/ω)`; of a stop that dissipates `d ṡ = λ − k s`.
    pub(super) fn flow(
        &self,
        operator: &ContactOperator,
        interval: &crate::PatternInterval,
        omega: f64,
        xi: f64,
    ) -> Mat<f64> {
        let m = self.structure.n_modes();
        let (rows, set) = (self.structure.rows(), operator.sets.get(interval.set));
        let width = (interval.to - interval.from).clamp(0.0, TAU);
        let contact = |k: usize, l: usize| -> f64 {
            let pressed = |i: usize| set.force_row(i).map(|(j, s)| s * rows[(j, l)]).sum::<f64>();
            set.active.iter().map(|&i| rows[(i, k)] * pressed(i)).sum()
        };
        let (moving, states) = (self.structure.n_moving(), self.n_states());
        Mat::from_fn(states, states, |i, j| {
            let (k, l) = (i % m, j % m);
            let own = f64::from(u8::from(k == l));
            let pressed = || contact(k, l) - own * self.structure.omega_squared()[k];
            width
                * match (i < m, j < m) {
                    (true, true) if i < moving => 0.0,
                    (true, true) => pressed() / (self.structure.damping().entry(k, k) * omega),
                    (true, false) if i >= moving => 0.0,
                    (true, false) => own,
                    (false, true) => pressed() / (omega * omega),
                    (false, false) => -(self.structure.damping().entry(k, l) - own * xi) / omega,
                }
        })
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
