use std::f64::consts::TAU;
use std::sync::Arc;

use nlmodes_modal::HarmonicBasis;
use num_complex::Complex64;

use super::touches::{Rules, touch_spans, value};
use super::{ForceLaw, LawForce, PlacedLaw};
use crate::periodic::weights::LawSample;
use crate::series::RealSeries;
use crate::{HbmError, Symmetry};

/// The laws over a period, by alternating between frequency and time: coefficients of the displacements to samples,
/// their forces, and back. Exact for polynomials, and of stops to rounding: these are evaluated in their touches alone,
/// whose ends are found.
pub(crate) struct LawOperator {
    series: RealSeries,
    laws: Vec<Sampled>,
}

/// Instants at which a law is evaluated.
enum Instants {
    /// The same distance from each other.
    Even(HarmonicBasis),
    /// Of a stop, within its touches: spans of the phase, and phases and weights in them.
    Touches { rules: Rules, spans: Vec<[f64; 2]>, nodes: Vec<[f64; 2]> },
}

/// One law with its samples.
struct Sampled {
    law: Arc<dyn ForceLaw>,
    instants: Instants,
    /// Complex amplitudes of the displacement, m.
    z: Vec<Complex64>,
    /// Displacement and its derivative by the phase.
    v: Vec<f64>,
    dv: Vec<f64>,
    force: Vec<f64>,
    stiffness: Vec<f64>,
    damping: Vec<f64>,
    /// Frequency at which it was solved last, rad/s.
    omega: f64,
}

/// What a stop with a law of force does over a period.
pub(crate) struct StopMotion {
    /// Share of the period in which it is touched, and how often.
    pub closed_share: f64,
    pub touches: usize,
    /// Largest force, where it is, and mean force, N.
    pub peak_force: f64,
    pub peak_phase: f64,
    pub mean_force: f64,
    /// Fastest approach with which it is touched, m/s.
    pub approach: f64,
    /// Complex amplitudes of the displacement toward it, m.
    pub displacement: Vec<Complex64>,
}

/// Sections by which the largest force of a touch is found.
const SECTIONS: usize = 60;

impl LawOperator {
    /// Of laws that are no polynomials `samples` a period are taken, at least as many as the derivatives need.
    pub fn new(laws: &[PlacedLaw], series: RealSeries, samples: usize) -> Result<Self, HbmError> {
        let h = series.n_harmonics;
        let of = |placed: &PlacedLaw| {
            // Products of so many factors leave the kept harmonics without aliases.
            let count = placed.law.degree().map_or(samples.max(4 * h + 1), |degree| (degree.max(1) + 1) * h + 1);
            let instants = match placed.law.stop_gap() {
                None => Instants::Even(HarmonicBasis::new(h, count)?),
                Some(_) => Instants::Touches { rules: Rules::default(), spans: Vec::new(), nodes: Vec::new() },
            };
            let [v, dv, force, stiffness, damping] = [(); 5].map(|()| vec![0.0; count]);
            let z = vec![Complex64::default(); h + 1];
            Ok(Sampled { law: placed.law.clone(), instants, z, v, dv, force, stiffness, damping, omega: 0.0 })
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
        sampled.averages(&stiffness, &mut averages);
        let mut matrix = series.multiplication(&averages);
        if sampled.law.dissipates() && series.symmetry == Symmetry::None {
            let damping: Vec<f64> = sampled.damping.iter().map(|c| -c * sampled.omega).collect();
            sampled.averages(&damping, &mut averages);
            let by_rate = series.multiplication(&averages);
            // The rate has at coefficient m that of the displacement at another one, with a factor.
            for m in 0..width {
                let Some((other, factor)) = series.turned(m) else { continue };
                (0..width).for_each(|i| matrix[i * width + other] += factor * by_rate[i * width + m]);
            }
        }
        matrix
    }

    /// Coefficients of the reaction that a change of the force of a law adds where its motion stays; `force` is that
    /// change at a displacement (m) and a velocity (m/s), N.
    pub fn changed(&mut self, l: usize, force: impl Fn(f64, f64) -> f64) -> Vec<f64> {
        let (series, sampled) = (self.series, &mut self.laws[l]);
        let mut reaction = vec![0.0; series.width()];
        sampled.analyze(series, |s, j| -force(s.v[j], s.omega * s.dv[j]), &mut reaction);
        reaction
    }

    /// What a change of the force of a law at its samples counts, of weights of the coefficients of its reaction:
    /// [`changed`](Self::changed) transposed.
    pub fn sample_weights(&self, l: usize, weights: &[f64]) -> Vec<LawSample> {
        let sampled = &self.laws[l];
        let mut z = vec![Complex64::default(); self.series.n_harmonics + 1];
        self.series.to_complex(weights, &mut z);
        z[1..].iter_mut().for_each(|z| *z *= 2.0);
        let count = sampled.v.len();
        let at = |j: usize| match &sampled.instants {
            Instants::Even(_) => [TAU * j as f64 / count as f64, 1.0 / count as f64],
            Instants::Touches { nodes, .. } => nodes[j],
        };
        let one = |j: usize| {
            let [tau, share] = at(j);
            LawSample { v: sampled.v[j], rate: sampled.omega * sampled.dv[j], weight: -share * value(&z, tau).0 }
        };
        (0..count).map(one).collect()
    }

    /// Mean energy that the laws store, J.
    pub fn mean_potential(&self) -> f64 {
        self.laws.iter().map(|s| s.mean(|j| s.law.potential(s.v[j]))).sum()
    }

    /// Mean power that the laws take out, W.
    pub fn dissipated_power(&self) -> f64 {
        let of = |s: &Sampled| s.mean(|j| s.force[j] * s.dv[j] * s.omega);
        self.laws.iter().filter(|s| s.law.dissipates()).map(of).sum()
    }

    /// What a law does that is a stop; `None` of any other law.
    pub fn stop_motion(&self, l: usize) -> Option<StopMotion> {
        let sampled = &self.laws[l];
        let Instants::Touches { spans, .. } = &sampled.instants else { return None };
        let approach = spans.iter().map(|[from, _]| sampled.omega * value(&sampled.z, *from).1);
        let hardest = spans.iter().map(|span| sampled.peak_force(*span)).max_by(|a, b| a[1].total_cmp(&b[1]));
        let [peak_phase, peak_force] = hardest.unwrap_or_default();
        Some(StopMotion {
            closed_share: spans.iter().fold(0.0, |sum, [from, to]| sum + to - from) / TAU,
            touches: spans.len(),
            peak_force,
            peak_phase,
            mean_force: sampled.mean(|j| sampled.force[j]),
            approach: approach.fold(0.0, f64::max),
            displacement: sampled.z.clone(),
        })
    }
}

impl Sampled {
    fn solve(&mut self, series: RealSeries, x: &[f64], omega: f64) {
        series.to_complex(x, &mut self.z);
        self.omega = omega;
        match &mut self.instants {
            Instants::Even(basis) => basis.synthesize_with_slope(&self.z, &mut self.v, &mut self.dv),
            Instants::Touches { rules, spans, nodes } => {
                *spans = touch_spans(self.law.as_ref(), &self.z, omega);
                *nodes = rules.instants(spans, series.n_harmonics);
                (self.v, self.dv) = nodes.iter().map(|[tau, _]| value(&self.z, *tau)).unzip();
            }
        }
        let at = |(v, dv): (&f64, &f64)| self.law.at(*v, omega * dv);
        let forces: Vec<LawForce> = self.v.iter().zip(&self.dv).map(at).collect();
        self.force = forces.iter().map(|at| at.force).collect();
        self.stiffness = forces.iter().map(|at| at.stiffness).collect();
        self.damping = forces.iter().map(|at| at.damping).collect();
    }

    fn analyze(&mut self, series: RealSeries, value: impl Fn(&Self, usize) -> f64, to: &mut [f64]) {
        let samples: Vec<f64> = (0..self.v.len()).map(|j| value(self, j)).collect();
        let mut z = vec![Complex64::default(); series.n_harmonics + 1];
        match &mut self.instants {
            Instants::Even(basis) => basis.analyze(&samples, &mut z),
            Instants::Touches { nodes, .. } => {
                averages(nodes, &samples, &mut z);
                z[1..].iter_mut().for_each(|z| *z *= 2.0);
            }
        }
        z.iter().enumerate().for_each(|(n, z)| series.put(*z, n, to));
    }

    /// Averages of the samples times `e^{−ikτ}` over a period.
    fn averages(&mut self, samples: &[f64], to: &mut [Complex64]) {
        match &mut self.instants {
            Instants::Even(basis) => basis.averages(samples, to),
            Instants::Touches { nodes, .. } => averages(nodes, samples, to),
        }
    }

    /// Mean over a period of what vanishes where a stop is not touched.
    fn mean(&self, value: impl Fn(usize) -> f64) -> f64 {
        match &self.instants {
            Instants::Even(_) => (0..self.v.len()).map(value).sum::<f64>() / self.v.len() as f64,
            Instants::Touches { nodes, .. } => {
                nodes.iter().enumerate().fold(0.0, |sum, (j, [_, weight])| sum + weight * value(j))
            }
        }
    }

    /// Largest force within a touch, N, behind its phase, by golden sections about the instant of the largest one.
    fn peak_force(&self, [from, to]: [f64; 2]) -> [f64; 2] {
        let Instants::Touches { nodes, .. } = &self.instants else { return [from, 0.0] };
        let force = |tau: f64| {
            let (v, slope) = value(&self.z, tau);
            self.law.at(v, self.omega * slope).force
        };
        let within: Vec<usize> = (0..nodes.len()).filter(|&j| nodes[j][0] >= from && nodes[j][0] <= to).collect();
        let Some(k) = (0..within.len()).max_by(|a, b| self.force[within[*a]].total_cmp(&self.force[within[*b]])) else {
            return [from, 0.0];
        };
        let phase = |k: usize| within.get(k).map(|&j| nodes[j][0]);
        let mut low = k.checked_sub(1).and_then(phase).unwrap_or(from);
        let mut high = phase(k + 1).unwrap_or(to);
        let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
        for _ in 0..SECTIONS {
            let [a, b] = [high - golden * (high - low), low + golden * (high - low)];
            if force(a) < force(b) { low = a } else { high = b }
        }
        let middle = 0.5 * (low + high);
        [middle, force(middle).max(self.force[within[k]])]
    }
}

/// Averages over a period of samples at these phases, with their weights, times `e^{−ikτ}`.
fn averages(nodes: &[[f64; 2]], samples: &[f64], to: &mut [Complex64]) {
    to.fill(Complex64::default());
    for ([tau, weight], sample) in nodes.iter().zip(samples) {
        let (turn, mut turned) = (Complex64::cis(-tau), Complex64::from(weight * sample));
        for to in to.iter_mut() {
            *to += turned;
            turned *= turn;
        }
    }
}
