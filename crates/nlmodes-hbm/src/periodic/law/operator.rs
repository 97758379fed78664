use nlmodes_modal::HarmonicBasis;
use num_complex::Complex64;

use super::{ForceLaw, PlacedLaw};
use crate::series::RealSeries;
use crate::{HbmError, Symmetry};
use std::sync::Arc;

/// The laws over a period, by alternating between frequency and time: coefficients of the displacements to samples,
/// their forces, and back. Exact for polynomials.
pub(crate) struct LawOperator {
    series: RealSeries,
    laws: Vec<Sampled>,
}

/// One law with its samples.
struct Sampled {
    law: Arc<dyn ForceLaw>,
    basis: HarmonicBasis,
    /// Displacement and its derivative by the phase.
    v: Vec<f64>,
    dv: Vec<f64>,
    force: Vec<f64>,
    stiffness: Vec<f64>,
    damping: Vec<f64>,
    /// Frequency at which it was solved last, rad/s.
    omega: f64,
}

impl LawOperator {
    /// Of laws that are no polynomials `samples` a period are taken, at least as many as the derivatives need.
    pub fn new(laws: &[PlacedLaw], series: RealSeries, samples: usize) -> Result<Self, HbmError> {
        let h = series.n_harmonics;
        let of = |placed: &PlacedLaw| {
            // Products of so many factors leave the kept harmonics without aliases.
            let count = placed.law.degree().map_or(samples.max(4 * h + 1), |degree| (degree.max(1) + 1) * h + 1);
            let zero = vec![0.0; count];
            Ok(Sampled {
                law: placed.law.clone(),
                basis: HarmonicBasis::new(h, count)?,
                v: zero.clone(),
                dv: zero.clone(),
                force: zero.clone(),
                stiffness: zero.clone(),
                damping: zero,
                omega: 0.0,
            })
        };
        Ok(Self { series, laws: laws.iter().map(of).collect::<Result<_, HbmError>>()? })
    }

    /// Number of laws.
    pub fn len(&self) -> usize {
        self.laws.len()
    }

    /// Forces of the laws on the structure, their reactions (one law after the other), for the displacements with the
    /// coefficients `x`, m, and their derivatives with respect to ω.
    pub fn solve(&mut self, x: &[f64], omega: f64) -> [Vec<f64>; 2] {
        let (width, series) = (self.series.width(), self.series);
        let (mut forces, mut by_omega) = (vec![0.0; x.len()], vec![0.0; x.len()]);
        for (l, sampled) in self.laws.iter_mut().enumerate() {
            let at = l * width..(l + 1) * width;
            sampled.solve(series, &x[at.clone()], omega);
            sampled.analyze(series, |s, j| -s.force[j], &mut forces[at.clone()]);
            if sampled.law.dissipates() {
                sampled.analyze(series, |s, j| -s.damping[j] * s.dv[j], &mut by_omega[at]);
            }
        }
        [forces, by_omega]
    }

    /// Derivative of the coefficients of the reaction of a law with respect to those of its displacement, of the
    /// solution solved last: width × width, row-major, N/m.
    pub fn derivative(&mut self, l: usize) -> Vec<f64> {
        let (series, width) = (self.series, self.series.width());
        let sampled = &mut self.laws[l];
        let mut averages = vec![Complex64::default(); 2 * series.n_harmonics + 1];
        let stiffness: Vec<f64> = sampled.stiffness.iter().map(|k| -k).collect();
        sampled.basis.averages(&stiffness, &mut averages);
        let mut matrix = series.multiplication(&averages);
        if sampled.law.dissipates() && series.symmetry == Symmetry::None {
            let damping: Vec<f64> = sampled.damping.iter().map(|c| -c * sampled.omega).collect();
            sampled.basis.averages(&damping, &mut averages);
            let by_rate = series.multiplication(&averages);
            // The rate has at coefficient m that of the displacement at another one, with a factor.
            for m in 0..width {
                let Some((other, factor)) = series.turned(m) else { continue };
                (0..width).for_each(|i| matrix[i * width + other] += factor * by_rate[i * width + m]);
            }
        }
        matrix
    }

    /// Mean energy that the laws store, J.
    pub fn mean_potential(&self) -> f64 {
        let of = |s: &Sampled| s.v.iter().map(|v| s.law.potential(*v)).sum::<f64>() / s.v.len() as f64;
        self.laws.iter().map(of).sum()
    }

    /// Mean power that the laws take out, W.
    pub fn dissipated_power(&self) -> f64 {
        let of = |s: &Sampled| {
            let power = s.force.iter().zip(&s.dv).map(|(force, dv)| force * dv * s.omega);
            power.sum::<f64>() / s.v.len() as f64
        };
        self.laws.iter().filter(|s| s.law.dissipates()).map(of).sum()
    }
}

impl Sampled {
    fn solve(&mut self, series: RealSeries, x: &[f64], omega: f64) {
        let mut z = vec![Complex64::default(); series.n_harmonics + 1];
        series.to_complex(x, &mut z);
        self.basis.synthesize_with_slope(&z, &mut self.v, &mut self.dv);
        self.omega = omega;
        for j in 0..self.v.len() {
            let at = self.law.at(self.v[j], omega * self.dv[j]);
            (self.force[j], self.stiffness[j], self.damping[j]) = (at.force, at.stiffness, at.damping);
        }
    }

    fn analyze(&mut self, series: RealSeries, value: impl Fn(&Self, usize) -> f64, to: &mut [f64]) {
        let samples: Vec<f64> = (0..self.v.len()).map(|j| value(self, j)).collect();
        let mut z = vec![Complex64::default(); series.n_harmonics + 1];
        self.basis.analyze(&samples, &mut z);
        z.iter().enumerate().for_each(|(n, z)| series.put(*z, n, to));
    }
}
