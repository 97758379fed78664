//! Derivatives of periodic motions by everything of the structure and its load: the implicit function theorem on the
//! converged equations, one transposed solution with their Jacobian for each number that is differentiated.

use std::f64::consts::TAU;

use nlmodes_continuation::{Linearization, ParametricSystem};
use nlmodes_linalg::{DenseLu, Mat, max_norm};
use num_complex::Complex64;

use super::change::Changes;
use super::closing_equations::{Functional, Motion};
use super::law::{StopMotion, law_value};
use super::motion::largest_instant;
use super::operating_point::{OperatingPoint, Source};
use super::refine::Refined;
use super::rows::{add_weights, complex_harmonic};
use super::structure::ResponseRow;
use super::system::PeriodicSystem;
use super::weights::{Acted, LawSample, StructureWeights};
use crate::HbmError;
use crate::contact_statistics::Extreme;
use crate::trigonometric::{Trigonometric, inner};

/// The displacement whose amplitude is followed, and its harmonic.
#[derive(Debug, Clone, PartialEq)]
pub struct Watched {
    /// The displacement.
    pub row: ResponseRow,
    /// The harmonic of its amplitude.
    pub harmonic: usize,
}

/// Derivatives of a periodic motion by a parameter, per unit of that. What is held: of a free motion its energy, of a
/// response frequency and level of the load, at phase resonance its level. NaN where the motion has no such thing.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct MotionChange {
    /// Of the base frequency, rad/s; of a response over frequency at a constant amplitude of the watched displacement.
    pub omega: f64,
    /// Of the level; of a response over the level at a constant amplitude of the watched displacement, else NaN.
    pub level: f64,
    /// Of the damping ratio ξ/(2ω) of a damped mode.
    pub damping_ratio: f64,
    /// Of the amplitude of the watched displacement, m.
    pub amplitude: f64,
    /// Of the largest displacement of the first contact toward its stop, m.
    pub peak: f64,
    /// Of the largest contact force of all contacts, N.
    pub peak_force: f64,
    /// Of the impulse of all contacts over the period, N s.
    pub impulse: f64,
}

/// The derivatives of a periodic motion by everything of its structure and load, of which those by any number of
/// parameters are products: the numbers of a [`MotionChange`], none where the motion has no such thing.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MotionGradient {
    omega: Option<StructureWeights>,
    level: Option<StructureWeights>,
    damping_ratio: Option<StructureWeights>,
    amplitude: Option<StructureWeights>,
    peak: Option<StructureWeights>,
    peak_force: Option<StructureWeights>,
    impulse: Option<StructureWeights>,
}

impl MotionGradient {
    /// The derivatives by each of these parameters.
    ///
    /// # Panics
    /// If the changes are those of another structure.
    pub fn along(&self, changes: &Changes) -> Vec<MotionChange> {
        let Self { omega, level, damping_ratio, amplitude, peak, peak_force, impulse } = self;
        let all = [omega, level, damping_ratio, amplitude, peak, peak_force, impulse];
        let known: Vec<&StructureWeights> = all.iter().filter_map(|weights| weights.as_ref()).collect();
        let found = changes.times(&known);
        let of = |p: usize| {
            let mut row = (0..known.len()).map(|k| found[(p, k)]);
            let [omega, level, damping_ratio, amplitude, peak, peak_force, impulse] =
                all.map(|weights| weights.as_ref().and_then(|_| row.next()).unwrap_or(f64::NAN));
            MotionChange { omega, level, damping_ratio, amplitude, peak, peak_force, impulse }
        };
        (0..found.nrows()).map(of).collect()
    }
}

/// A number of a motion, by its derivatives.
struct Wanted {
    /// Through modal coordinates, contact forces and the scalars.
    of: Functional,
    /// Through the gaps without contact forces, c × width.
    gaps: Vec<f64>,
    /// By the structure itself.
    structure: StructureWeights,
}

/// What is known of a motion before it is differentiated.
struct Known {
    at: OperatingPoint,
    p: f64,
    /// Modal coordinates and contact forces, harmonic by harmonic.
    motion: Vec<(Vec<Complex64>, Vec<Complex64>)>,
    jacobian: Mat<f64>,
    /// The closing equations.
    closing: Vec<(Functional, StructureWeights)>,
    /// What ω, ξ and the level do to gaps and forces.
    moved: [Vec<f64>; 4],
    forces_by: [Vec<f64>; 3],
}

impl PeriodicSystem {
    /// Derivatives of the solution `found` by these parameters.
    ///
    /// # Errors
    /// As [`gradient_of`](Self::gradient_of).
    pub fn sensitivities(
        &mut self,
        found: &Refined,
        watched: Option<&Watched>,
        changes: &Changes,
    ) -> Result<Vec<MotionChange>, HbmError> {
        Ok(self.gradient_of(found, watched)?.along(changes))
    }

    /// Derivatives of the solution `found` by everything of the structure and its load.
    ///
    /// ```text
    /// R(z; p) = 0 ,   bᵀ dz + db = 0 ,   Q(z; p)      b: what is held; z the unknowns and the parameter of the curve
    /// [J; bᵀ]ᵀ μ = ∂Q/∂z ,   dQ = ∂Q − μᵀ [∂R; db]    one factorisation, and a solution for each number Q
    /// ```
    ///
    /// In a harmonic a parameter acts on the modes as the load `−(dΩ² + iν dĈ) η + dYᵀ λ + dp`, and on the gaps as
    /// `dg₀ + dY η`; `dA` acts on the forces of closed contacts. Their instants add nothing, since forces are
    /// continuous there. So `dQ` is a sum over the entries of these, whose weights are made once.
    ///
    /// # Errors
    /// [`HbmError`] where the motion cannot be evaluated again. Where the Jacobian is singular, at a fold of what is
    /// held, there are no derivatives.
    pub fn gradient_of(&mut self, found: &Refined, watched: Option<&Watched>) -> Result<MotionGradient, HbmError> {
        self.response.take_any_phase();
        let (x, p, n) = (&found.x, found.p, self.dim());
        let mut lin = Linearization::new(n);
        self.linearize(x, p, &mut lin)?;
        let known = self.known_of(lin.jacobian, x, p)?;
        let amplitude = watched.and_then(|watched| self.with_motion(x, known.at, p, |m| self.amplitude(watched, m)));
        let across = amplitude.as_ref().and_then(|amplitude| self.across(amplitude, &known));
        let mut gradient = self.gradient_held(&known, amplitude)?;
        if let Some((omega, level)) = across {
            (gradient.omega, gradient.level) = (omega, level);
        }
        Ok(gradient)
    }

    /// Where what the equations hold stays.
    fn gradient_held(&mut self, known: &Known, amplitude: Option<Wanted>) -> Result<MotionGradient, HbmError> {
        let mut parameter_row = vec![0.0; self.dim() + 1];
        parameter_row[self.dim()] = 1.0;
        let Ok(held) = bordered(&known.jacobian, &parameter_row) else { return Ok(MotionGradient::default()) };
        let slopes = self.scalar_columns(known.p);
        let (omega, xi) = (known.at.omega, known.at.xi);
        let of_ratio = [-xi / (2.0 * omega * omega), 1.0 / (2.0 * omega), 0.0];
        let wanted = [
            slopes[0].map(|_| self.scalar([1.0, 0.0, 0.0])),
            slopes[1].map(|_| self.scalar(of_ratio)),
            amplitude,
            self.peak(known),
            Some(self.peak_force(known)),
            Some(self.impulse(known)),
        ];
        let [omega, damping_ratio, amplitude, peak, peak_force, impulse] = wanted.map(|wanted| {
            let wanted = wanted?;
            let mut mu = self.row_of(&wanted, known);
            held.solve_transposed_in_place(&mut mu);
            mu.iter().all(|mu| mu.is_finite()).then(|| self.through(known, &mu, (1.0, &wanted)))
        });
        Ok(MotionGradient { omega, level: None, damping_ratio, amplitude, peak, peak_force, impulse })
    }

    /// Of ω and the level at a constant amplitude of the watched displacement: curves over frequency or level have
    /// another derivative of these, that of what is folded.
    fn across(
        &mut self,
        amplitude: &Wanted,
        known: &Known,
    ) -> Option<(Option<StructureWeights>, Option<StructureWeights>)> {
        let is_over = matches!(self.closing.omega, Source::Parameter { .. })
            || matches!(self.closing.level, Source::Parameter { .. });
        if !is_over {
            return None;
        }
        let (n, row) = (self.dim(), self.row_of(amplitude, known));
        let size = max_norm(row.iter().copied());
        let lu = bordered(&known.jacobian, &row.iter().map(|r| r / size).collect::<Vec<_>>());
        let slopes = self.scalar_columns(known.p);
        let mut of = |slope: Option<(usize, f64)>| {
            let (lu, (column, slope)) = (lu.as_ref().ok()?, slope?);
            let mut mu = vec![0.0; n + 1];
            mu[column] = slope;
            lu.solve_transposed_in_place(&mut mu);
            let held = -mu[n] / size;
            mu.iter().all(|mu| mu.is_finite()).then(|| self.through(known, &mu, (held, amplitude)))
        };
        Some((of(slopes[0]), of(slopes[2])))
    }

    fn known_of(&mut self, jacobian: Mat<f64>, x: &[f64], p: f64) -> Result<Known, HbmError> {
        let (at, harmonics) = (self.operating_point(x, p), self.blocks.len());
        let motion = (0..harmonics).map(|n| (self.modal_coordinates(n, at), self.forces_of_harmonic(n))).collect();
        let own = |motion: &Motion| -> Result<Vec<(Functional, StructureWeights)>, HbmError> {
            let mut all = Vec::new();
            for equation in &self.closing.equations {
                let mut weights = StructureWeights::none(&self.structure, &self.load);
                equation.weigh_structure(motion, 1.0, &mut weights);
                all.push((equation.evaluate(motion)?, weights));
            }
            Ok(all)
        };
        let closing = self.with_motion(x, at, p, own)?;
        let moved = self.load_gaps(at);
        let forces_by = [0, 1, 2].map(|t| self.operator.apply(&moved[t]));
        Ok(Known { at, p, motion, jacobian, closing, moved, forces_by })
    }

    /// `∂Q/∂z`, n + 1.
    fn row_of(&mut self, wanted: &Wanted, known: &Known) -> Vec<f64> {
        let (mut by_x, mut by) = self.gradient(&wanted.of, known.at, &known.forces_by);
        by_x.iter_mut().zip(self.generalised(&wanted.gaps)).for_each(|(to, from)| *to += from);
        by.iter_mut().zip(&known.moved).for_each(|(by, moved)| *by += inner(&wanted.gaps, moved));
        let mut row: Vec<f64> = by_x.iter().map(|by| by * self.unit()).collect();
        row.iter_mut().zip(&wanted.of.x).for_each(|(to, from)| *to += from);
        row.resize(self.dim() + 1, 0.0);
        for (by, slope) in by.iter().zip(self.scalar_columns(known.p)) {
            slope.iter().for_each(|(column, slope)| row[*column] += by * slope);
        }
        row
    }

    /// `∂Q − μᵀ ∂R` by everything of the structure and its load, of `own` Q times a factor.
    fn through(&mut self, known: &Known, mu: &[f64], own: (f64, &Wanted)) -> StructureWeights {
        let (at, series, size) = (known.at, self.series(), self.n_coefficients());
        let (width, d, m) = (series.width(), self.response.n_coordinates(), self.structure.n_modes());
        let (c, first) = (self.structure.n_contacts(), self.response.first_law() * width);
        let mut sum = StructureWeights::none(&self.structure, &self.load);
        let mut eta = vec![vec![Complex64::default(); m]; self.blocks.len()];
        let (mut by_force, mut gaps) = (vec![0.0; self.y.len()], vec![0.0; self.y.len()]);
        let mut by_generalised = vec![0.0; d * width];
        let closing = known.closing.iter().enumerate().map(|(k, (of, structure))| (-mu[size + k], of, structure));
        for (factor, of, structure) in closing.chain([(own.0, &own.1.of, &own.1.structure)]) {
            sum.add(factor, structure);
            for (n, weights) in &of.eta {
                eta[*n].iter_mut().zip(weights).for_each(|(to, w)| *to += w * factor);
            }
            for (n, weights) in &of.forces {
                let (of_contacts, of_laws) = weights.split_at(c.min(weights.len()));
                add_weights(series, *n, of_contacts, factor, &mut by_force);
                add_weights(series, *n, of_laws, factor, &mut by_generalised[first..]);
            }
            if of.by_energy != 0.0 {
                for (n, (eta, (own, _))) in eta.iter_mut().zip(&known.motion).enumerate() {
                    let half = 0.5 * (n as f64 * at.omega).powi(2) * of.by_energy * factor;
                    let masses = self.structure.inertia().iter().zip(own);
                    eta.iter_mut().zip(masses).for_each(|(to, (mass, own))| *to += own.conj() * (half * mass));
                }
            }
        }
        add_scaled(own.0, &own.1.gaps, &mut gaps);
        let (mut modal, mut places) = (Vec::new(), Vec::new());
        let rows: Vec<f64> = mu[..size].iter().map(|mu| -mu / self.unit()).collect();
        for (n, block) in self.blocks.iter().enumerate() {
            let residual: Vec<Complex64> = complex_harmonic(series, &rows, n).iter().map(Complex64::conj).collect();
            let through_g = |j: usize| -(0..d).map(|i| residual[i] * block.g[i * d + j]).sum::<Complex64>();
            let (_, of_eta) = self.response.pull(n, at, block, &eta[n]);
            add_weights(series, n, &of_eta, 1.0, &mut by_generalised);
            add_weights(series, n, &(0..d).map(through_g).collect::<Vec<_>>(), 1.0, &mut by_generalised);
            let (of_modes, of_laws) = self.response.pull_load(n, at, block, &residual, &eta[n]);
            modal.push(of_modes);
            places.push(of_laws);
        }
        for (l, weights) in by_generalised[first..].chunks(width).enumerate().take(self.laws.len()) {
            sum.laws[l].extend(self.laws.sample_weights(l, weights));
        }
        for (i, by_force) in by_force.chunks_mut(width).enumerate() {
            let generalised = by_generalised.chunks(width).enumerate();
            generalised.for_each(|(j, from)| add_scaled(self.gap_map[i * d + j], from, by_force));
        }
        add_scaled(1.0, &self.operator.apply_transposed(&by_force), &mut gaps);
        sum.of.compliance += self.operator.compliance_weights(&by_force, &self.y);
        let of_gaps = |(n, of_laws): (usize, Vec<Complex64>)| {
            complex_harmonic(series, &gaps, n).iter().map(Complex64::conj).chain(of_laws).collect()
        };
        let gaps: Vec<Vec<Complex64>> = places.into_iter().enumerate().map(of_gaps).collect();
        sum.add_load((&self.structure, &self.load), at, &known.motion, &Acted { modal: &modal, gaps: &gaps });
        sum.fold();
        sum
    }
}

/// What is differentiated.
impl PeriodicSystem {
    fn nothing(&self) -> Wanted {
        Wanted {
            of: Functional::default(),
            gaps: vec![0.0; self.y.len()],
            structure: StructureWeights::none(&self.structure, &self.load),
        }
    }

    /// A number with these derivatives by ω, ξ and the level.
    fn scalar(&self, by: [f64; 3]) -> Wanted {
        Wanted { of: Functional { by, ..Functional::default() }, ..self.nothing() }
    }

    /// The amplitude of the watched displacement; none at rest.
    fn amplitude(&self, watched: &Watched, motion: &Motion) -> Option<Wanted> {
        let (n, row) = (watched.harmonic, &watched.row);
        let of = |row: &[f64], z: &[Complex64]| row.iter().zip(z).map(|(r, z)| z * *r).sum::<Complex64>();
        let own = motion.load.row(n, &row.loads, motion.at);
        let q = of(&row.modes, &(motion.eta)(n)) + of(&row.contacts, &(motion.forces)(n)) + own.value;
        if !(q.norm() > 0.0 && q.is_finite()) {
            return None;
        }
        let factor = q.conj() / q.norm();
        let weights = |row: &[f64]| vec![(n, row.iter().map(|r| factor * *r).collect())];
        let mut wanted = self.nothing();
        wanted.structure.add_watched(factor, row, n, motion);
        wanted.of = Functional {
            eta: weights(&row.modes),
            forces: weights(&row.contacts),
            by: own.by.map(|by| (factor * by).re),
            ..Functional::default()
        };
        Some(wanted)
    }

    /// The impulse of all contacts over the period, and of the laws behind them that are stops.
    fn impulse(&self, known: &Known) -> Wanted {
        let (omega, c) = (known.at.omega, self.structure.n_contacts());
        let period = TAU / omega;
        // The reaction of a stop is its force on the structure, away from it.
        let laws = self.structure.laws().iter().map(|placed| if placed.law.stop_gap().is_some() { -1.0 } else { 0.0 });
        let signs: Vec<f64> = std::iter::repeat_n(1.0, c).chain(laws).collect();
        let mean = known.motion[0].1.iter().zip(&signs).map(|(force, sign)| sign * force.re).sum::<f64>();
        let forces = vec![(0, signs.iter().map(|sign| Complex64::from(period * sign)).collect())];
        let of = Functional { forces, by: [-period * mean / omega, 0.0, 0.0], ..Functional::default() };
        Wanted { of, ..self.nothing() }
    }

    /// The laws that are stops, with what they do.
    fn law_stops(&self) -> impl Iterator<Item = (usize, StopMotion)> {
        (0..self.laws.len()).filter_map(|l| Some((l, self.laws.stop_motion(l)?)))
    }

    /// The largest force of all contacts.
    fn peak_force(&self, known: &Known) -> Wanted {
        let mut wanted = self.nothing();
        let hardest = (0..self.structure.n_contacts()).filter_map(|i| Some((i, self.operator.hardest(i)?)));
        let contact = hardest.max_by(|a, b| a.1.value.total_cmp(&b.1.value));
        let law = self.law_stops().max_by(|a, b| a.1.peak_force.total_cmp(&b.1.peak_force));
        let least = contact.as_ref().map_or(0.0, |(_, extreme)| extreme.value);
        match (contact, law.filter(|(_, stop)| stop.peak_force > least)) {
            (_, Some((l, stop))) => self.add_law(l, &stop, known, &mut wanted),
            (Some((contact, extreme)), None) => self.add_hardest(contact, &extreme, 1.0, &mut wanted),
            (None, None) => {}
        }
        wanted
    }

    /// The largest force of a law that is a stop.
    fn add_law(&self, l: usize, stop: &StopMotion, known: &Known, wanted: &mut Wanted) {
        let (omega, law) = (known.at.omega, &self.structure.laws()[l].law);
        let (v, slope) = law_value(&stop.displacement, stop.peak_phase);
        let at = law.at(v, omega * slope);
        self.add_place(l, stop.peak_phase, [at.stiffness, omega * at.damping], wanted);
        wanted.of.by[0] += at.damping * slope;
        wanted.structure.laws[l].push(LawSample { v, rate: omega * slope, weight: 1.0 });
    }

    /// Displacement of a law and its derivative by the phase at an instant, with these weights.
    fn add_place(&self, l: usize, phase: f64, [value, slope]: [f64; 2], wanted: &mut Wanted) {
        let from = (self.response.first_law() + l) * self.series().width();
        let [of_value, of_slope] = [0, 1].map(|order| self.basis(order, phase));
        wanted.of.x.resize(self.n_coefficients(), 0.0);
        for (to, (of_value, of_slope)) in wanted.of.x[from..].iter_mut().zip(of_value.iter().zip(&of_slope)) {
            *to += (value * of_value + slope * of_slope) * self.unit();
        }
    }

    /// The largest displacement of the first contact toward its stop: the gap and what the stop yields where it
    /// touches, else the gap less the smallest opening; of a law that is a stop the displacement of its place.
    fn peak(&self, known: &Known) -> Option<Wanted> {
        let mut wanted = self.nothing();
        let Some(gap) = wanted.structure.of.gaps.first_mut() else {
            let (l, stop) = self.law_stops().next()?;
            let [phase, _] = largest_instant(&stop.displacement);
            self.add_place(l, phase, [1.0, 0.0], &mut wanted);
            return Some(wanted);
        };
        *gap = 1.0;
        if let Some(extreme) = self.operator.hardest(0) {
            if let Some(k) = self.structure.damped_stop(0) {
                self.add_yielded(k, known, &mut wanted);
                return Some(wanted);
            }
            wanted.structure.of.stop_compliance[0] = extreme.value;
            self.add_hardest(0, &extreme, self.structure.stop_compliance()[0], &mut wanted);
            return Some(wanted);
        }
        let closest = self.operator.closest(0)?;
        let (a, basis) = (self.structure.compliance().a(), self.basis(0, closest.phase));
        for (set, share) in closest.shares() {
            let width = basis.len();
            wanted.gaps[..width].iter_mut().zip(&basis).for_each(|(to, basis)| *to -= share * basis);
            for (j, force) in self.forces_at(set, closest.phase).into_iter().enumerate() {
                self.add_force(j, (set, closest.phase), -share * a[(0, j)], &mut wanted);
                wanted.structure.of.compliance[(0, j)] -= share * force;
            }
        }
        Some(wanted)
    }

    /// The largest displacement of a stop that dissipates, coordinate k: `(k + iν d) s_n = λ_n`.
    fn add_yielded(&self, k: usize, known: &Known, wanted: &mut Wanted) {
        let (spring, damper) = (self.structure.omega_squared()[k], self.structure.damping().entry(k, k));
        let stop: Vec<Complex64> = known.motion.iter().map(|(eta, _)| eta[k]).collect();
        let [phase, _] = largest_instant(&stop);
        let c = self.structure.n_contacts();
        for (n, s) in stop.into_iter().enumerate() {
            let (n_of, nu) = (n as f64, n as f64 * known.at.omega);
            let factor = Complex64::cis(n_of * phase) / Complex64::new(spring, nu * damper);
            let mut forces = vec![Complex64::default(); c];
            forces[0] = factor;
            wanted.of.forces.push((n, forces));
            let held = -factor * s;
            wanted.of.by[0] += (held * Complex64::new(0.0, n_of * damper)).re;
            wanted.structure.of.stiffness[(k, k)] += held.re;
            wanted.structure.of.damping[(k, k)] += (held * Complex64::new(0.0, nu)).re;
        }
    }

    /// The force of a contact where it is largest.
    fn add_hardest(&self, contact: usize, extreme: &Extreme, factor: f64, wanted: &mut Wanted) {
        for (set, share) in extreme.shares() {
            self.add_force(contact, (set, extreme.phase), factor * share, wanted);
        }
    }

    /// The force of a contact at an instant: through the gaps, and by the compliance of the closed contacts.
    fn add_force(&self, contact: usize, (set, phase): (usize, f64), factor: f64, wanted: &mut Wanted) {
        if factor == 0.0 {
            return;
        }
        let (basis, forces, set) = (self.basis(0, phase), self.forces_at(set, phase), self.operator.sets.get(set));
        for (j, s) in set.force_row(contact) {
            let to = &mut wanted.gaps[j * basis.len()..(j + 1) * basis.len()];
            to.iter_mut().zip(&basis).for_each(|(to, basis)| *to += factor * s * basis);
            for &l in &set.active {
                wanted.structure.of.compliance[(j, l)] += factor * s * forces[l];
            }
        }
    }

    /// Forces of all contacts at an instant, c.
    pub(super) fn forces_at(&self, set: usize, phase: f64) -> Vec<f64> {
        let (set, y) = (self.operator.sets.get(set), self.at_instant(&self.y, phase));
        (0..y.len()).map(|i| set.force(i, &y)).collect()
    }

    /// The value at an instant of each coefficient of a series, width, or its derivative of this order by the phase.
    pub(super) fn basis(&self, order: usize, phase: f64) -> Vec<f64> {
        let width = self.series().width();
        let one = |m: usize| (0..width).map(|k| f64::from(u8::from(k == m))).collect::<Vec<f64>>();
        (0..width).map(|m| self.derivative_at(&one(m), order, phase)).collect()
    }

    /// Values at an instant of a series for each contact, c.
    pub(super) fn at_instant(&self, series: &[f64], phase: f64) -> Vec<f64> {
        series.chunks(self.series().width()).map(|real| self.derivative_at(real, 0, phase)).collect()
    }

    fn derivative_at(&self, real: &[f64], order: usize, phase: f64) -> f64 {
        let layout = self.series();
        let mut z = vec![Complex64::default(); layout.n_harmonics + 1];
        layout.to_complex(real, &mut z);
        Trigonometric { z }.evaluate(phase)[order]
    }
}

/// The Jacobian with a row below it, factorised.
fn bordered(jacobian: &Mat<f64>, row: &[f64]) -> Result<DenseLu, HbmError> {
    let n = jacobian.nrows();
    let square = Mat::from_fn(n + 1, n + 1, |i, j| if i < n { jacobian[(i, j)] } else { row[j] });
    DenseLu::factor(&square).map_err(|source| HbmError::Linalg { what: "Jacobian of a motion", source })
}

fn add_scaled(factor: f64, from: &[f64], to: &mut [f64]) {
    to.iter_mut().zip(from).for_each(|(to, from)| *to += factor * from);
}
