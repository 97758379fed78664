use std::cell::OnceCell;
use std::f64::consts::{PI, TAU};

use nlmodes_contact::{LcpMatrix, LcpSolver, LcpWorkspace, solver_by_name};
use nlmodes_linalg::Mat;
use nlmodes_modal::HarmonicBasis;
use num_complex::Complex64;

use crate::HbmError;
use crate::boundary::around_the_period;
use crate::closed_set::SetTable;
use crate::series::{RealSeries, Symmetry};
use crate::switching::Tracer;
use crate::trigonometric::inner;

/// How the instants of touching and leaving are treated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Switching {
    /// Instants found as roots, Fourier integrals in closed form between them: no sampling error.
    #[default]
    Exact,
    /// As in the paper: one contact problem a sample, discrete Fourier transform of the samples.
    Sampled {
        /// Samples a period.
        samples: usize,
    },
}

/// An interval of phase with one contact pattern: the closed contacts stay the same.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PatternInterval {
    /// Phase at which it begins, rad.
    pub from: f64,
    /// Phase at which it ends, rad.
    pub to: f64,
    /// The closed contacts, as an index into the sets of the operator.
    pub(crate) set: usize,
}

/// The contact operator: one period of the static contact problem, eqs. (11), (13), from gaps without contact forces to
/// forces.
///
/// ```text
/// 0 ≤ λ_i(τ) ⊥ [A λ(τ) + y(τ)]_i ≥ 0 ,   y_i(τ) = Re Σ_n y_i,n e^{inτ} ,   n = 0 … H
/// λ(τ) = Σ_S χ_S(τ) S y(τ)             S = dλ/dy while one set of contacts is closed, χ_S its share of the period
/// λ_n = 𝓕_n(λ) = Σ_S S 𝓕_n(χ_S y)      which is also dλ/dy: λ is continuous, so that the instants add nothing
/// ```
///
/// `A` (c × c, m/N) is the compliance of body and stops. It needs nothing else of a structure, so conservative and
/// forced motions, held and open modes share it. Coefficients are those of [`RealSeries`], `width` a contact, one
/// contact after the other.
pub struct ContactOperator {
    pub(crate) series: RealSeries,
    pub(crate) sets: SetTable,
    /// Intervals over `[0, π]` for even motions, else over `[0, 2π]`.
    pub(crate) intervals: Vec<PatternInterval>,
    /// The sets with a closed contact that occur.
    pub(crate) spectra: Vec<Spectrum>,
    /// `y` of each contact, complex coefficients.
    pub(crate) y: Vec<Vec<Complex64>>,
    /// Iterations of the contact solver so far, over all its problems.
    pub(crate) iterations: usize,
    switching: Switching,
    workspace: Box<dyn LcpWorkspace>,
    basis: HarmonicBasis,
    y_t: Vec<Vec<f64>>,
    dy_t: Vec<Vec<f64>>,
    closed_t: Vec<Vec<bool>>,
    set_t: Vec<usize>,
    lambda: Vec<f64>,
    at: Vec<f64>,
    /// Memory that the sets may take, bytes.
    pub(crate) most_bytes: usize,
}

/// The part of a period in which one set of contacts is closed.
pub(crate) struct Spectrum {
    pub set: usize,
    /// Averages `(1/2π) ∫ χ e^{−ikτ}`, k = 0 … 2H.
    pub averages: Vec<Complex64>,
    product: OnceCell<Vec<f64>>,
}

impl Spectrum {
    fn new(set: usize, averages: Vec<Complex64>) -> Self {
        Self { set, averages, product: OnceCell::new() }
    }

    /// Matrix of "multiply by `χ(τ)`, keep the harmonics up to H", [`RealSeries::multiplication`].
    pub fn product(&self, series: RealSeries) -> &[f64] {
        self.product.get_or_init(|| series.multiplication(&self.averages))
    }
}

/// Memory for the sets of closed contacts that were met: of a thousand contacts each takes some megabytes, and every
/// iterate meets others.
const MOST_BYTES: usize = 256 << 20;

impl ContactOperator {
    /// For contacts with the compliance `matrix` and gaps with the coefficients of `series`; contact problems are
    /// solved by `solver`.
    ///
    /// # Errors
    /// [`HbmError::Samples`], or what the solver has against the compliance.
    pub fn new(
        matrix: &LcpMatrix,
        series: RealSeries,
        switching: Switching,
        solver: &dyn LcpSolver,
    ) -> Result<Self, HbmError> {
        let (c, h) = (matrix.n_contacts(), series.n_harmonics);
        let samples = match switching {
            // Where nothing can happen between two samples is proven cell by cell: their number decides the cost, not
            // the result.
            Switching::Exact => (3 * (h + 1)).next_power_of_two().max(32),
            Switching::Sampled { samples } => samples,
        };
        let needed = 2 * h + 1;
        if samples < needed {
            return Err(HbmError::Samples { harmonics: h, samples, needed });
        }
        let (zero, sampled) = (Complex64::default(), vec![vec![0.0; samples]; c]);
        Ok(Self {
            series,
            sets: SetTable::new(matrix)?,
            intervals: Vec::new(),
            spectra: Vec::new(),
            y: vec![vec![zero; h + 1]; c],
            iterations: 0,
            switching,
            workspace: solver.workspace(matrix).map_err(HbmError::Compliance)?,
            basis: HarmonicBasis::new(h, samples)?,
            y_t: sampled.clone(),
            dy_t: sampled,
            closed_t: vec![vec![false; c]; samples + 1],
            set_t: vec![SetTable::OPEN; samples + 1],
            lambda: vec![0.0; c],
            at: Vec::new(),
            most_bytes: MOST_BYTES,
        })
    }

    /// The contacts whose gaps without contact forces have these harmonics, up to this one, solved.
    ///
    /// # Errors
    /// [`HbmError::Contact`] where a contact problem has no solution.
    pub fn of_harmonics(matrix: &LcpMatrix, y: Vec<Vec<Complex64>>, n_harmonics: usize) -> Result<Self, HbmError> {
        let series = RealSeries { symmetry: Symmetry::None, n_harmonics };
        let solver = solver_by_name("active-set").map_err(HbmError::Compliance)?;
        let mut solved = Self { y, ..Self::new(matrix, series, Switching::Exact, solver.as_ref())? };
        solved.run()?;
        Ok(solved)
    }

    /// Layout of the coefficients of one contact.
    pub fn series(&self) -> RealSeries {
        self.series
    }

    pub(crate) fn is_sampled(&self) -> bool {
        matches!(self.switching, Switching::Sampled { .. })
    }

    /// Number of contacts c.
    pub fn n_contacts(&self) -> usize {
        self.y.len()
    }

    /// Iterations of the contact solver so far, over all contact problems, in the unit of that solver.
    pub fn iterations(&self) -> usize {
        self.iterations
    }

    /// Solves the contact problem over a period for the coefficients `y` (c × width, m) of the gaps without contact
    /// forces.
    ///
    /// # Errors
    /// [`HbmError::Contact`] if it has no solution at some instant.
    pub fn solve(&mut self, y: &[f64]) -> Result<(), HbmError> {
        let width = self.series.width();
        self.y.iter_mut().zip(y.chunks(width)).for_each(|(z, real)| self.series.to_complex(real, z));
        self.run()
    }

    /// Derivative `(dλ/dy) dy` (N, c × width) for the contact pattern of the last solution; with its own `y`, the
    /// forces, and of nothing nothing.
    pub fn apply(&self, dy: &[f64]) -> Vec<f64> {
        let width = self.series.width();
        let mut forces = vec![0.0; dy.len()];
        for spectrum in self.spectra.iter().filter(|_| !dy.is_empty()) {
            let (set, product) = (self.sets.get(spectrum.set), spectrum.product(self.series));
            let part = |j: &usize| product.chunks(width).map(|row| inner(row, &dy[j * width..][..width])).collect();
            let parts: Vec<Vec<f64>> = set.active.iter().map(part).collect();
            for &i in &set.active {
                let force = &mut forces[i * width..(i + 1) * width];
                for ((_, s), part) in set.force_row(i).zip(&parts) {
                    force.iter_mut().zip(part).for_each(|(force, part)| *force += s * part);
                }
            }
        }
        forces
    }

    /// How the forces (N, c × width) change with the compliance by `change` (c × c) where the gaps stay: while a set
    /// `S` is closed `dλ = S dA λ`, eq. (13) differentiated; the instants add nothing, since λ is continuous.
    pub(crate) fn forces_by_compliance(&self, change: &Mat<f64>, y: &[f64]) -> Vec<f64> {
        let width = self.series.width();
        let mut forces = vec![0.0; y.len()];
        for spectrum in &self.spectra {
            let (set, product) = (self.sets.get(spectrum.set), spectrum.product(self.series));
            let part = |j: &usize| product.chunks(width).map(|row| inner(row, &y[j * width..][..width])).collect();
            let parts: Vec<Vec<f64>> = set.active.iter().map(part).collect();
            let pressed = |parts: &[Vec<f64>], i: usize| {
                let mut sum = vec![0.0; width];
                for ((_, s), part) in set.force_row(i).zip(parts) {
                    sum.iter_mut().zip(part).for_each(|(sum, part)| *sum += s * part);
                }
                sum
            };
            let own: Vec<Vec<f64>> = set.active.iter().map(|&i| pressed(&parts, i)).collect();
            let yielded = |i: &usize| {
                let mut sum = vec![0.0; width];
                for (j, force) in set.active.iter().zip(&own) {
                    sum.iter_mut().zip(force).for_each(|(sum, force)| *sum += change[(*i, *j)] * force);
                }
                sum
            };
            let yielded: Vec<Vec<f64>> = set.active.iter().map(yielded).collect();
            for &i in &set.active {
                let more = pressed(&yielded, i);
                forces[i * width..(i + 1) * width].iter_mut().zip(more).for_each(|(force, more)| *force += more);
            }
        }
        forces
    }

    /// `(dλ/dy)ᵀ df`: what weights `df` (c × width) of the forces are as weights of the gaps.
    pub(crate) fn apply_transposed(&self, df: &[f64]) -> Vec<f64> {
        let width = self.series.width();
        let mut gaps = vec![0.0; df.len()];
        for spectrum in &self.spectra {
            let (set, product) = (self.sets.get(spectrum.set), spectrum.product(self.series));
            for &i in &set.active {
                let mut part = vec![0.0; width];
                for (row, f) in product.chunks(width).zip(&df[i * width..]) {
                    part.iter_mut().zip(row).for_each(|(p, r)| *p += f * r);
                }
                for (j, s) in set.force_row(i) {
                    gaps[j * width..].iter_mut().zip(&part).for_each(|(gap, part)| *gap += s * part);
                }
            }
        }
        gaps
    }

    /// Weights of the compliance (c × c) that go with weights `df` (c × width) of the forces where the gaps stay:
    /// [`forces_by_compliance`](Self::forces_by_compliance) transposed.
    pub(crate) fn compliance_weights(&self, df: &[f64], y: &[f64]) -> Mat<f64> {
        let (width, c) = (self.series.width(), self.n_contacts());
        let mut weights = Mat::zeros(c, c);
        for spectrum in &self.spectra {
            let (set, product) = (self.sets.get(spectrum.set), spectrum.product(self.series));
            let part = |j: &usize| product.chunks(width).map(|row| inner(row, &y[j * width..][..width])).collect();
            let parts: Vec<Vec<f64>> = set.active.iter().map(part).collect();
            let pressed = |of: &dyn Fn(usize, usize) -> f64| -> Vec<Vec<f64>> {
                let row = |&i: &usize| {
                    let mut sum = vec![0.0; width];
                    for (at, (j, s)) in set.force_row(i).enumerate() {
                        sum.iter_mut().enumerate().for_each(|(m, sum)| *sum += s * of(at, j * width + m));
                    }
                    sum
                };
                set.active.iter().map(row).collect()
            };
            // `S` is symmetric.
            let forces = pressed(&|at, m| parts[at][m % width]);
            let weighted = pressed(&|_, m| df[m]);
            for (i, weighted) in set.active.iter().zip(&weighted) {
                set.active.iter().zip(&forces).for_each(|(j, force)| weights[(*i, *j)] += inner(weighted, force));
            }
        }
        weights
    }

    /// Number of the smooth piece: a hash of the sequence of closed contacts. A whole period may begin at any of them.
    pub fn pattern(&self) -> u64 {
        if self.series.symmetry == Symmetry::Even {
            return self.hash(self.intervals.iter());
        }
        let all = around_the_period(&self.intervals);
        let turned = (0..all.len()).map(|k| self.hash(all[k..].iter().chain(&all[..k])));
        turned.min().unwrap_or_default()
    }

    /// FNV-1a.
    fn hash<'i>(&self, intervals: impl Iterator<Item = &'i PatternInterval>) -> u64 {
        let bits = intervals.flat_map(|i| self.closed(i).iter().map(|c| u64::from(*c)).chain([2]));
        bits.fold(0xcbf2_9ce4_8422_2325, |hash, bit| (hash ^ bit).wrapping_mul(0x0100_0000_01b3))
    }

    /// Intervals with one contact pattern each, in order from 0 to [`end`](Self::end).
    pub fn intervals(&self) -> &[PatternInterval] {
        &self.intervals
    }

    /// Last phase of the intervals: π for even motions, else 2π.
    pub fn end(&self) -> f64 {
        if self.series.symmetry == Symmetry::Even { PI } else { TAU }
    }

    /// Forgets the sets met so far if they, with `beside` bytes that others keep of them, take too much memory; whether
    /// it did. The closed contacts of each sample stay, from which the solver starts.
    pub(crate) fn forget_sets(&mut self, beside: usize) -> bool {
        let is_full = self.sets.bytes() + beside > self.most_bytes;
        if is_full {
            self.sets.clear();
            self.set_t.fill(SetTable::OPEN);
            self.spectra.clear();
            self.intervals.clear();
        }
        is_full
    }

    /// The contact pattern over a period for the complex coefficients `self.y`.
    pub(crate) fn run(&mut self) -> Result<(), HbmError> {
        let samples = self.basis.n_samples();
        for i in 0..self.y.len() {
            self.basis.synthesize_with_slope(&self.y[i], &mut self.y_t[i], &mut self.dy_t[i]);
        }
        match self.series.symmetry {
            Symmetry::None => {
                (0..samples).try_for_each(|j| self.solve_sample(j))?;
                self.set_t[samples] = self.set_t[0];
            }
            Symmetry::Even => {
                (0..=samples / 2).try_for_each(|j| self.solve_sample(j))?;
            }
        }
        match self.switching {
            Switching::Exact => self.trace(),
            Switching::Sampled { .. } => {
                if self.series.symmetry == Symmetry::Even {
                    (samples / 2 + 1..=samples).for_each(|j| self.set_t[j] = self.set_t[samples - j]);
                }
                self.collect_samples();
                Ok(())
            }
        }
    }

    /// Closed contacts at sample `j`. Those of the same sample of the iterate before are taken where their gaps and
    /// forces are still positive, which makes them the solution; else the solver starts from them.
    fn solve_sample(&mut self, j: usize) -> Result<(), HbmError> {
        self.at.clear();
        self.at.extend(self.y_t.iter().map(|y| y[j]));
        if self.set_t[j] == SetTable::OPEN && self.at.iter().all(|y| *y >= 0.0) {
            return Ok(());
        }
        if self.set_t[j] != SetTable::OPEN && self.sets.get(self.set_t[j]).is_solution(&self.at) {
            return Ok(());
        }
        self.set_t[j] = if self.at.iter().all(|y| *y >= 0.0) {
            self.closed_t[j].fill(false);
            SetTable::OPEN
        } else {
            let tau = TAU * j as f64 / self.basis.n_samples() as f64;
            let statistics = self
                .workspace
                .solve(&self.at, &mut self.closed_t[j], &mut self.lambda)
                .map_err(|source| HbmError::Contact { tau, source })?;
            self.iterations += statistics.iterations;
            self.sets.find(&self.closed_t[j])?
        };
        Ok(())
    }

    fn trace(&mut self) -> Result<(), HbmError> {
        let samples = self.basis.n_samples();
        let cells = if self.series.symmetry == Symmetry::Even { samples / 2 } else { samples };
        let mut tracer = Tracer::new(&self.y);
        let mut current = self.set_t[0];
        for j in 0..cells {
            let ends = [j, j + 1].map(|k| TAU * k as f64 / samples as f64);
            let wrapped = (j + 1) % samples;
            let slopes = |k: usize| (&self.y_t, &self.dy_t, k);
            if tracer.is_quiet(&self.sets, current, self.set_t[j + 1], slopes(j), slopes(wrapped), ends[1] - ends[0]) {
                tracer.extend(current, ends[0], ends[1]);
                continue;
            }
            let (from, to) = (current, self.set_t[j + 1]);
            let (workspace, lambda, iterations) = (&mut self.workspace, &mut self.lambda, &mut self.iterations);
            let mut solve = |tau: f64, y: &[f64], closed: &mut [bool]| {
                let solved = workspace.solve(y, closed, lambda);
                solved.map(|s| *iterations += s.iterations).map_err(|source| HbmError::Contact { tau, source })
            };
            current = tracer.cell(&mut self.sets, &mut solve, ends, [from, to])?;
        }
        self.intervals = tracer.intervals;
        self.integrate();
        Ok(())
    }

    /// Fourier integrals of the indicators of the intervals, in closed form.
    fn integrate(&mut self) {
        self.spectra.clear();
        let even = self.series.symmetry == Symmetry::Even;
        for interval in &self.intervals {
            if self.sets.get(interval.set).is_open() {
                continue;
            }
            let found = self.spectra.iter().position(|spectrum| spectrum.set == interval.set);
            let at = found.unwrap_or_else(|| {
                let averages = vec![Complex64::default(); 2 * self.series.n_harmonics + 1];
                self.spectra.push(Spectrum::new(interval.set, averages));
                self.spectra.len() - 1
            });
            add_indicator(interval.from, interval.to, even, &mut self.spectra[at].averages);
        }
    }

    fn collect_samples(&mut self) {
        let samples = self.basis.n_samples();
        let step = TAU / samples as f64;
        let even = self.series.symmetry == Symmetry::Even;
        self.spectra.clear();
        for set in 1..self.sets.len() {
            let indicator: Vec<f64> = self.set_t[..samples].iter().map(|s| if *s == set { 1.0 } else { 0.0 }).collect();
            if indicator.contains(&1.0) {
                let mut spectrum = vec![Complex64::default(); 2 * self.series.n_harmonics + 1];
                self.basis.averages(&indicator, &mut spectrum);
                if even {
                    spectrum.iter_mut().for_each(|z| z.im = 0.0);
                }
                self.spectra.push(Spectrum::new(set, spectrum));
            }
        }
        // A sample represents the interval around it.
        let end = self.end();
        self.intervals.clear();
        for j in 0..=samples {
            let (from, to) = ((j as f64 - 0.5) * step, (j as f64 + 0.5) * step);
            let (from, to) = (from.max(0.0), to.min(end));
            if from >= end {
                break;
            }
            let set = self.set_t[j % samples];
            match self.intervals.last_mut() {
                Some(last) if last.set == set => last.to = to,
                _ => self.intervals.push(PatternInterval { from, to, set }),
            }
        }
    }

    /// The closed contacts during an interval.
    ///
    /// # Panics
    /// If the interval is one of another operator.
    pub fn closed(&self, interval: &PatternInterval) -> &[bool] {
        &self.sets.get(interval.set).closed
    }
}

/// Adds `(1/2π) ∫_{from}^{to} e^{−ikτ} dτ`; for even motions the mirror interval too.
///
/// From middle and half width, `sin(k w)/(π k) e^{−ikm}`: as the difference of its ends, the integral over a short
/// interval would be known to no more digits than one over the whole period.
fn add_indicator(from: f64, to: f64, even: bool, averages: &mut [Complex64]) {
    let (middle, half) = (Complex64::cis(-0.5 * (from + to)), Complex64::cis(0.5 * (to - from)));
    let (mut at_middle, mut at_half) = (middle, half);
    averages[0].re += if even { 2.0 } else { 1.0 } * (to - from) / TAU;
    for (k, average) in averages.iter_mut().enumerate().skip(1) {
        let integral = at_middle * (at_half.im / (PI * k as f64));
        *average += if even { Complex64::new(2.0 * integral.re, 0.0) } else { integral };
        at_middle *= middle;
        at_half *= half;
    }
}

#[cfg(test)]
mod tests;
