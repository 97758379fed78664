//! Derivatives of periodic motions by parameters of the structure and its load: the implicit function theorem on the
//! converged equations, one solution with their Jacobian for each parameter.

use std::f64::consts::TAU;

use nlmodes_continuation::{Linearization, ParametricSystem};
use nlmodes_linalg::{DenseLu, Mat, max_norm};
use num_complex::Complex64;

use super::change::StructureChange;
use super::closing_equations::{ClosingEquation, Functional, Motion};
use super::operating_point::{OperatingPoint, Source};
use super::refine::Refined;
use super::rows::complex_harmonic;
use super::structure::ResponseRow;
use super::system::PeriodicSystem;
use crate::HbmError;
use crate::contact_statistics::Extreme;
use crate::trigonometric::Trigonometric;
use crate::trigonometric::inner;

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

/// What is known of a motion before it is differentiated.
struct Known {
    at: OperatingPoint,
    /// Modal coordinates and contact forces, harmonic by harmonic.
    motion: Vec<(Vec<Complex64>, Vec<Complex64>)>,
    jacobian: Mat<f64>,
    /// The amplitude of the watched displacement, with its derivatives by all unknowns and the parameter.
    amplitude: Option<(Complex64, Vec<f64>)>,
}

/// A parameter at a motion: `∂R/∂p` and that of the watched amplitude, and what it does to gaps and forces by itself.
struct Parameter {
    column: Vec<f64>,
    amplitude: f64,
    /// Changes of gaps and forces where the unknowns stay, c × width.
    gaps: Vec<f64>,
    forces: Vec<f64>,
}

impl PeriodicSystem {
    /// Derivatives of the solution `found` by these parameters.
    ///
    /// ```text
    /// R(z; p) = 0 ,   bᵀ dz + db = 0          b: what is held; z the unknowns and the parameter of the curve
    /// [J; bᵀ] dz/dp = −[∂R/∂p; db/dp]         one factorisation for all parameters
    /// ```
    ///
    /// In a harmonic a parameter acts on the modes as the load `−(dΩ² + iν dĈ) η + dYᵀ λ + dp`, and on the gaps as
    /// `dg₀ + dY η`; `dA` acts on the forces of closed contacts. Their instants add nothing, since forces are
    /// continuous there.
    ///
    /// # Errors
    /// [`HbmError`] where the motion cannot be evaluated again. Where the Jacobian is singular, at a fold of what is
    /// held, derivatives are NaN.
    pub fn sensitivities(
        &mut self,
        found: &Refined,
        watched: Option<&Watched>,
        changes: &[StructureChange],
    ) -> Result<Vec<MotionChange>, HbmError> {
        self.response.take_any_phase();
        self.keep_below(found);
        let all = self.all_sensitivities(&found.x, found.p, watched, changes);
        self.keep_nothing_below();
        all
    }

    fn all_sensitivities(
        &mut self,
        x: &[f64],
        p: f64,
        watched: Option<&Watched>,
        changes: &[StructureChange],
    ) -> Result<Vec<MotionChange>, HbmError> {
        let n = self.dim();
        let known = self.known(x, p, watched)?;
        let mut parameter_row = vec![0.0; n + 1];
        parameter_row[n] = 1.0;
        let held = bordered(&known.jacobian, &parameter_row);
        // Curves over frequency or level have another derivative of these, that of what is folded.
        let is_over = matches!(self.closing.omega, Source::Parameter { .. })
            || matches!(self.closing.level, Source::Parameter { .. });
        let across = known.amplitude.as_ref().filter(|_| is_over).map(|(_, row)| {
            let size = max_norm(row.iter().copied());
            (bordered(&known.jacobian, &row.iter().map(|r| r / size).collect::<Vec<_>>()), size)
        });
        let mut all = Vec::new();
        for change in changes {
            let parameter = self.parameter(x, p, (&known, watched), change)?;
            let solve = |lu: &Result<DenseLu, HbmError>, last: f64| -> Option<Vec<f64>> {
                let mut dz: Vec<f64> = parameter.column.iter().map(|r| -r).chain([last]).collect();
                lu.as_ref().ok()?.solve_in_place(&mut dz);
                dz.iter().all(|v| v.is_finite()).then_some(dz)
            };
            let mut found = match solve(&held, 0.0) {
                Some(dz) => self.motion_change(&dz, p, (&known, &parameter), change),
                None => MotionChange::unknown(),
            };
            if let Some((lu, size)) = &across {
                let slopes = self.scalar_columns(p);
                let dz = solve(lu, -parameter.amplitude / size);
                let of = |slope: Option<(usize, f64)>| match (&dz, slope) {
                    (Some(dz), Some((column, slope))) => slope * dz[column],
                    _ => f64::NAN,
                };
                (found.omega, found.level) = (of(slopes[0]), of(slopes[2]));
            }
            all.push(found);
        }
        Ok(all)
    }

    fn known(&mut self, x: &[f64], p: f64, watched: Option<&Watched>) -> Result<Known, HbmError> {
        let mut lin = Linearization::new(self.dim());
        self.linearize(x, p, &mut lin)?;
        Ok(self.known_of(lin.jacobian, x, p, watched))
    }

    /// The same of a motion that was evaluated last, with this Jacobian.
    fn known_of(&mut self, jacobian: Mat<f64>, x: &[f64], p: f64, watched: Option<&Watched>) -> Known {
        let (at, harmonics) = (self.operating_point(x, p), self.blocks.len());
        let motion = (0..harmonics).map(|n| (self.modal_coordinates(n, at), self.forces_of_harmonic(n))).collect();
        let moved = self.load_gaps(at);
        let forces_by = [0, 1, 2].map(|t| self.operator.apply(&moved[t]));
        let amplitude = watched.and_then(|watched| {
            let (q, functional) = self.with_motion(x, at, p, |motion| of_amplitude(watched, motion))?;
            let (by_x, by) = self.gradient(&functional, at, &forces_by);
            let mut row = vec![0.0; self.dim() + 1];
            row.iter_mut().zip(by_x).for_each(|(to, from)| *to = from * self.unit());
            for (by, slope) in by.iter().zip(self.scalar_columns(p)) {
                slope.iter().for_each(|(column, slope)| row[*column] += by * slope);
            }
            Some((q, row))
        });
        Known { at, motion, jacobian, amplitude }
    }

    /// `∂R/∂p`: the derivative by the level of the same equations under a load that represents the parameter.
    fn parameter(
        &mut self,
        x: &[f64],
        p: f64,
        (known, watched): (&Known, Option<&Watched>),
        change: &StructureChange,
    ) -> Result<Parameter, HbmError> {
        let plain = self.load.clone();
        let harmonics = change.as_load((&self.structure, &plain), known.at, &known.motion);
        self.load = plain.varied_by(harmonics);
        let found = self.parameter_under_load(x, p, watched, change);
        self.load = plain;
        found
    }

    fn parameter_under_load(
        &mut self,
        x: &[f64],
        p: f64,
        watched: Option<&Watched>,
        change: &StructureChange,
    ) -> Result<Parameter, HbmError> {
        let at = self.solve(x, p)?;
        let (size, unit, series) = (self.n_coefficients(), self.unit(), self.series());
        let [by_omega, by_xi, gaps, _] = self.load_gaps(at);
        let yielded = self.operator.forces_by_compliance(change.compliance(), &self.y);
        let forces: Vec<f64> = self.operator.apply(&gaps).iter().zip(&yielded).map(|(a, b)| a + b).collect();
        let forces_by = [self.operator.apply(&by_omega), self.operator.apply(&by_xi), forces];
        let generalised = self.generalised(&forces_by[2]);
        let mut columns = Mat::zeros(self.dim(), 1);
        for n in 0..self.blocks.len() {
            let force = complex_harmonic(series, &generalised, n);
            self.assembly.scalar_column(n, &self.blocks[n], 2, &force, 1.0 / unit, 0, &mut columns);
        }
        let mut column: Vec<f64> = columns.col(0).iter().copied().collect();
        let own = |motion: &Motion| -> Result<Vec<Functional>, HbmError> {
            let one = |equation: &dyn ClosingEquation| {
                let functional = equation.evaluate(motion)?;
                let by = [0.0, 0.0, equation.by_parameter_of_structure(motion, change)];
                Ok(Functional { by, ..functional })
            };
            self.closing.equations.iter().map(|equation| one(equation.as_ref())).collect()
        };
        for (k, functional) in self.with_motion(x, at, p, own)?.iter().enumerate() {
            column[size + k] = self.gradient(functional, at, &forces_by).1[2];
        }
        let amplitude = watched.and_then(|watched| {
            self.with_motion(x, at, p, |motion| {
                let (q, functional) = of_amplitude(watched, motion)?;
                let own = change.of_row(&watched.row, &change.watched, watched.harmonic, motion);
                let own = (q.conj() / q.norm() * own).re;
                Some(Functional { by: [0.0, 0.0, own], ..functional })
            })
        });
        let amplitude = amplitude.map_or(0.0, |functional| self.gradient(&functional, at, &forces_by).1[2]);
        let [_, _, forces] = forces_by;
        Ok(Parameter { column, amplitude, gaps, forces })
    }

    /// What the motion does as a whole, from the derivative `dz` of the unknowns and of the parameter of the curve.
    fn motion_change(
        &mut self,
        dz: &[f64],
        p: f64,
        (known, parameter): (&Known, &Parameter),
        change: &StructureChange,
    ) -> MotionChange {
        let (at, slopes) = (known.at, self.scalar_columns(p));
        let [d_omega, d_xi, d_level] = slopes.map(|slope| slope.map_or(0.0, |(column, slope)| slope * dz[column]));
        let amplitude = known.amplitude.as_ref().map_or(f64::NAN, |(_, row)| inner(row, dz) + parameter.amplitude);
        // Gaps and forces over the period: through the unknowns, through ω, ξ and level, and by the parameter itself.
        let moved = self.load_gaps(at);
        let mut gaps = vec![0.0; self.y.len()];
        self.add_displacements(&dz[..self.n_coefficients()], &mut gaps);
        for (by, d) in moved[..3].iter().zip([d_omega, d_xi, d_level]) {
            gaps.iter_mut().zip(by).for_each(|(gap, by)| *gap += by * d);
        }
        let through_gaps = self.operator.apply(&gaps);
        let forces: Vec<f64> = through_gaps.iter().zip(&parameter.forces).map(|(a, b)| a + b).collect();
        gaps.iter_mut().zip(&parameter.gaps).for_each(|(gap, own)| *gap += own);
        let (width, period) = (self.series().width(), TAU / at.omega);
        let mean: f64 = self.operator.mean_forces().iter().sum();
        let d_mean: f64 = forces.chunks(width).map(|force| force[0]).sum();
        MotionChange {
            omega: if slopes[0].is_some() { d_omega } else { f64::NAN },
            level: f64::NAN,
            damping_ratio: match slopes[1] {
                Some(_) => (d_xi - at.xi / at.omega * d_omega) / (2.0 * at.omega),
                None => f64::NAN,
            },
            amplitude,
            peak: self.peak_change(&gaps, &forces, (known, d_omega), change),
            peak_force: self.peak_force_change(&gaps, change),
            impulse: period * (d_mean - mean / at.omega * d_omega),
        }
    }

    /// Values at an instant of a series for each contact, c.
    fn at_instant(&self, series: &[f64], phase: f64) -> Vec<f64> {
        let layout = self.series();
        let value = |real: &[f64]| {
            let mut z = vec![Complex64::default(); layout.n_harmonics + 1];
            layout.to_complex(real, &mut z);
            Trigonometric { z }.evaluate(phase)[0]
        };
        series.chunks(layout.width()).map(value).collect()
    }

    /// How the forces change at an instant, c, with the forces there.
    fn forces_at(&self, gaps: &[f64], (set, phase): (usize, f64), change: &StructureChange) -> (Vec<f64>, Vec<f64>) {
        let set = self.operator.sets.get(set);
        let (y, mut dy) = (self.at_instant(&self.y, phase), self.at_instant(gaps, phase));
        let c = y.len();
        let forces: Vec<f64> = (0..c).map(|i| set.force(i, &y)).collect();
        for (i, dy) in dy.iter_mut().enumerate() {
            *dy += set.active.iter().map(|&j| change.compliance()[(i, j)] * forces[j]).sum::<f64>();
        }
        ((0..c).map(|i| set.force(i, &dy)).collect(), forces)
    }

    fn peak_force_change(&self, gaps: &[f64], change: &StructureChange) -> f64 {
        let hardest = (0..self.structure.n_contacts()).filter_map(|i| Some((i, self.operator.hardest(i)?)));
        let hardest = hardest.max_by(|a, b| a.1.value.total_cmp(&b.1.value));
        hardest.map_or(0.0, |(i, extreme)| self.hardest_change(i, &extreme, gaps, change))
    }

    /// Of the force of a contact where it is largest.
    fn hardest_change(&self, contact: usize, extreme: &Extreme, gaps: &[f64], change: &StructureChange) -> f64 {
        extreme.change(|set| self.forces_at(gaps, (set, extreme.phase), change).0[contact])
    }

    /// Of the largest displacement of the first contact toward its stop: the gap and what the stop yields where it
    /// touches, else the gap less the smallest opening.
    fn peak_change(
        &self,
        gaps: &[f64],
        forces: &[f64],
        (known, d_omega): (&Known, f64),
        change: &StructureChange,
    ) -> f64 {
        if self.structure.n_contacts() == 0 {
            return f64::NAN;
        }
        let d_gap = change.of_gap(0);
        if let Some(extreme) = self.operator.hardest(0) {
            if let Some(k) = self.structure.damped_stop(0) {
                return d_gap + self.yielded_change(k, forces, (known, d_omega), change);
            }
            let own = self.structure.stop_compliance()[0];
            let d_force = self.hardest_change(0, &extreme, gaps, change);
            return d_gap + change.of_stop(0) * extreme.value + own * d_force;
        }
        let Some(closest) = self.operator.closest(0) else { return f64::NAN };
        let (a, own) = (self.structure.compliance().a(), self.at_instant(gaps, closest.phase)[0]);
        let opened = |set: usize| {
            let (d_forces, all) = self.forces_at(gaps, (set, closest.phase), change);
            let pressed = |j: usize| a[(0, j)] * d_forces[j] + change.compliance()[(0, j)] * all[j];
            -(own + (0..all.len()).map(pressed).sum::<f64>())
        };
        d_gap + closest.change(opened)
    }

    /// Of the largest displacement of a stop that dissipates, coordinate k: `(k + iν d) s_n = λ_n`.
    fn yielded_change(
        &self,
        k: usize,
        forces: &[f64],
        (known, d_omega): (&Known, f64),
        change: &StructureChange,
    ) -> f64 {
        let (spring, damper) = (self.structure.omega_squared()[k], self.structure.damping().entry(k, k));
        let [d_spring, d_damper] = change.of_damped_stop(k);
        let stop: Vec<Complex64> = known.motion.iter().map(|(eta, _)| eta[k]).collect();
        let series = self.series();
        let of = |(n, s): (usize, &Complex64)| {
            let nu = n as f64 * known.at.omega;
            let d_held = Complex64::new(d_spring, nu * d_damper + n as f64 * d_omega * damper);
            let d_force = complex_harmonic(series, &forces[..series.width()], n)[0];
            (d_force - d_held * s) / Complex64::new(spring, nu * damper)
        };
        let d_stop = Trigonometric { z: stop.iter().enumerate().map(of).collect() };
        let (phase, _) = crate::contact_statistics::largest(&Trigonometric { z: stop }, 0.0, TAU);
        d_stop.evaluate(phase)[0]
    }
}

impl PeriodicSystem {
    /// Residual and Jacobian at `(x, p)`, as [`linearize`](ParametricSystem::linearize), and `∂R/∂q` (n) by a parameter
    /// q of the structure or its load.
    ///
    /// # Errors
    /// [`HbmError`] where the contact problem has no solution.
    pub fn linearize_over(
        &mut self,
        x: &[f64],
        p: f64,
        change: &StructureChange,
        out: &mut Linearization,
    ) -> Result<Vec<f64>, HbmError> {
        self.response.take_any_phase();
        self.linearize(x, p, out)?;
        let known = self.known_of(out.jacobian.clone(), x, p, None);
        Ok(self.parameter(x, p, (&known, None), change)?.column)
    }

    /// The smallest gap of a contact that is open over the whole period, with its derivatives; none where it closes.
    ///
    /// # Errors
    /// [`HbmError`] where the contact problem has no solution.
    pub fn opening(
        &mut self,
        contact: usize,
        (x, p): (&[f64], f64),
        change: &StructureChange,
    ) -> Result<Option<Opening>, HbmError> {
        self.response.take_any_phase();
        let known = self.known(x, p, None)?;
        let parameter = self.parameter(x, p, (&known, None), change)?;
        let Some(closest) = self.operator.closest(contact) else { return Ok(None) };
        let guard = |set: usize, dy: &dyn Fn(usize) -> f64| -> f64 {
            self.operator.sets.get(set).guard_row(contact).map(|(j, g)| g * dy(j)).sum()
        };
        let (series, unit, d) = (self.series(), self.unit(), self.response.n_coordinates());
        let (width, c) = (series.width(), self.structure.n_contacts());
        let one = |m: usize| {
            let mut real = vec![0.0; width];
            real[m] = 1.0;
            self.at_instant(&real, closest.phase)[0]
        };
        let basis: Vec<f64> = (0..width).map(one).collect();
        let mut by = vec![0.0; self.dim() + 1];
        for (k, by) in by[..d * width].iter_mut().enumerate() {
            let moved = |contact: usize| self.gap_map[contact * d + k / width] * unit * basis[k % width];
            *by = closest.change(|set| guard(set, &moved));
        }
        let moved = self.load_gaps(known.at);
        for (by_scalar, slope) in moved[..3].iter().zip(self.scalar_columns(p)) {
            let Some((column, slope)) = slope.filter(|_| !by_scalar.is_empty()) else { continue };
            let there = self.at_instant(by_scalar, closest.phase);
            by[column] += slope * closest.change(|set| guard(set, &|j| there[j]));
        }
        let own = self.at_instant(&parameter.gaps, closest.phase);
        let a = self.structure.compliance().a();
        let opened = |set: usize| {
            let (d_forces, all) = self.forces_at(&parameter.gaps, (set, closest.phase), change);
            let pressed = |j: usize| a[(contact, j)] * d_forces[j] + change.compliance()[(contact, j)] * all[j];
            own.get(contact).copied().unwrap_or_default() + (0..c).map(pressed).sum::<f64>()
        };
        Ok(Some(Opening { value: -closest.value, by, by_parameter: closest.change(opened) }))
    }
}

/// The smallest gap of a contact over a period.
#[derive(Debug, Clone, PartialEq)]
pub struct Opening {
    /// Its value, m; negative where it would close.
    pub value: f64,
    /// Its derivatives by the unknowns and the parameter of the curve, n + 1.
    pub by: Vec<f64>,
    /// That by a parameter of the structure or its load.
    pub by_parameter: f64,
}

impl MotionChange {
    /// Nothing is known.
    fn unknown() -> Self {
        let none = f64::NAN;
        Self {
            omega: none,
            level: none,
            damping_ratio: none,
            amplitude: none,
            peak: none,
            peak_force: none,
            impulse: none,
        }
    }
}

/// The Jacobian with a row below it, factorised.
fn bordered(jacobian: &Mat<f64>, row: &[f64]) -> Result<DenseLu, HbmError> {
    let n = jacobian.nrows();
    let square = Mat::from_fn(n + 1, n + 1, |i, j| if i < n { jacobian[(i, j)] } else { row[j] });
    DenseLu::factor(&square).map_err(|source| HbmError::Linalg { what: "Jacobian of a motion", source })
}

/// The complex amplitude of the watched displacement, and its magnitude as a functional of the motion; none at rest.
fn of_amplitude(watched: &Watched, motion: &Motion) -> Option<(Complex64, Functional)> {
    let (n, row) = (watched.harmonic, &watched.row);
    let of = |row: &[f64], z: &[Complex64]| row.iter().zip(z).map(|(r, z)| z * *r).sum::<Complex64>();
    let own = motion.load.row(n, &row.loads, motion.at);
    let q = of(&row.modes, &(motion.eta)(n)) + of(&row.contacts, &(motion.forces)(n)) + own.value;
    if !(q.norm() > 0.0 && q.is_finite()) {
        return None;
    }
    let factor = q.conj() / q.norm();
    let weights = |row: &[f64]| vec![(n, row.iter().map(|r| factor * *r).collect())];
    let functional = Functional {
        value: q.norm(),
        eta: weights(&row.modes),
        forces: weights(&row.contacts),
        by: own.by.map(|by| (factor * by).re),
        ..Functional::default()
    };
    Some((q, functional))
}
