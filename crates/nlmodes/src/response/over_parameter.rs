//! A fold, a first touch, a phase resonance or a motion at a given energy, followed over a parameter of the structure
//! or its load.
//!
//! ```text
//! R(x, s; q) = 0 ,   g(x, s; q) = 0         unknowns x and the frequency s, parameter q; of a mode R(x; q) = 0 alone
//! fold:         [R_x b; cᵀ 0] [v; g] = [0; 1] ,   [R_xᵀ c; bᵀ 0] [w; g] = [0; 1] ,   dg = −wᵀ dR_x v
//! first touch:  g = smallest gap of a contact, which is set back and so closes nowhere
//! ```
//!
//! `R_x`, `R_s` and `R_q` are exact. Of `dg` at a fold, `wᵀ R_xz v` is the difference of `wᵀ R_z` on both sides along
//! `v`: it decides how fast Newton's method converges, not where to.

mod extended;
mod fold;

use std::f64::consts::TAU;

use extended::{Condition, Extended, Problem};
use fold::Border;
use nlmodes_contact::solver_by_name;
use nlmodes_continuation::{Bound, BranchPoint, Continuation, EventKind, StepSettings, StopReason};
use nlmodes_hbm::{HbmError, PeriodicMotion, Scales, StructureChange, Symmetry, Watched};
use nlmodes_linalg::max_norm;
use nlmodes_modal::{BranchEnd, Event, ModalPoint};

use crate::response::analyses::{WINDOW, scales};
use crate::response::curve::curve_end;
use crate::response::follow::amplitude;
use crate::response::{ResponseError, ResponseModel, ResponsePoint, ResponseSettings};

/// A structure with its load at a value of a parameter, and what the parameter does to it there.
#[derive(Debug, Clone)]
pub struct AtValue {
    /// The structure with its load.
    pub model: ResponseModel,
    /// Level of the load.
    pub level: f64,
    /// Derivative by the parameter.
    pub change: StructureChange,
    /// The displacement whose amplitude is reported; none for none.
    pub watched: Option<Watched>,
}

/// The structure over the parameter; why there is none at a value, in words.
pub type Family<'a> = dyn FnMut(f64) -> Result<AtValue, String> + 'a;

/// Where a curve over a parameter begins and how far it goes.
pub struct OverParameter<'a> {
    /// The structure over the parameter.
    pub family: &'a mut Family<'a>,
    /// The value at the start.
    pub value: f64,
    /// The values between which it is followed.
    pub window: [f64; 2],
    /// How the periodic motions are computed.
    pub settings: &'a ResponseSettings,
}

/// A point of a curve over a parameter.
#[derive(Debug, Clone)]
pub struct ParameterPoint {
    /// Value of the parameter.
    pub value: f64,
    /// Frequency of the load, or of the mode, rad/s.
    pub omega: f64,
    /// Its derivative along the curve, rad/s per unit of the parameter.
    pub by_value: f64,
    /// Amplitude of the watched displacement, m; zero without one.
    pub amplitude: f64,
    /// The motion.
    pub motion: PeriodicMotion,
    /// Largest scaled residual.
    pub residual: f64,
    /// Whether the curve turns here: the parameter goes no further.
    pub turns: bool,
}

/// A curve over a parameter.
#[derive(Debug, Clone)]
pub struct ParameterCurve {
    /// Its points, from the lower end of the parameter to the upper one, or as the curve goes where it turns.
    pub points: Vec<ParameterPoint>,
    /// Why it ends below and above the start.
    pub ends: [BranchEnd; 2],
}

impl OverParameter<'_> {
    /// The folds of a response over the frequency at `at`, one of its folds: where it jumps.
    ///
    /// # Errors
    /// [`ResponseError`] where it is not found again, or the structure changes with the parameter as it cannot be
    /// followed.
    pub fn fold(&mut self, at: &ResponsePoint) -> Result<ParameterCurve, ResponseError> {
        self.of_response(at, Condition::Fold(Border::default()))
    }

    /// Where a contact that is open is first touched, beginning at a point of a response at which one is. None where it
    /// is not one.
    ///
    /// # Errors
    /// As [`fold`](Self::fold).
    pub fn touch(&mut self, at: &ResponsePoint) -> Result<Option<ParameterCurve>, ResponseError> {
        let own = self.own()?;
        let Some(contact) = self.touching(at, &own)? else { return Ok(None) };
        self.of_response(at, Condition::Touch { contact }).map(Some)
    }

    /// The mode at an averaged kinetic energy (J), beginning near `at`, whose coefficients begin with modal
    /// coordinates.
    ///
    /// # Errors
    /// As [`fold`](Self::fold).
    pub fn mode(&mut self, at: &ModalPoint, energy: f64, symmetry: Symmetry) -> Result<ParameterCurve, ResponseError> {
        let scales = Scales::new(at.peak.abs(), at.omega, energy);
        let problem = Problem::Mode { scales, symmetry };
        let solver = solver_by_name(&self.settings.contact_solver).map_err(HbmError::Compliance)?;
        let own = self.own()?;
        let mut system = problem.system(&own, self.settings, solver.as_ref(), &Condition::None)?;
        let modes = own.model.open_modes().n_modes();
        let harmonics = self.settings.harmonics;
        let grown = (energy / at.kinetic_energy).sqrt();
        let of = |n: usize| (0..modes).map(move |k| at.coefficients.of(k).get(n).copied().unwrap_or_default() * grown);
        let eta: Vec<Vec<_>> = (0..=harmonics).map(|n| of(n).collect()).collect();
        let mut x = system.coefficients_of(&eta);
        x.push(1.0);
        x.resize(nlmodes_continuation::ParametricSystem::dim(&system), 0.0);
        system.hold_phase(&x);
        let found = crate::response::follow::newton(&mut system, &x, 0.0).ok_or_else(|| ResponseError::AtValue {
            value: self.value,
            why: format!("the mode at {energy:.6e} J is not found from that at {:.6e} J", at.kinetic_energy),
        })?;
        self.both_ways(problem, Condition::None, (found, 0.0))
    }

    /// The phase resonance at the level of the structure, beginning near `at`.
    ///
    /// # Errors
    /// As [`fold`](Self::fold).
    pub fn resonance(&mut self, at: &ResponsePoint) -> Result<ParameterCurve, ResponseError> {
        let own = self.own()?;
        let problem = Problem::Resonance { scales: scales(own.model.structure(), at.motion.at.omega) };
        let solver = solver_by_name(&self.settings.contact_solver).map_err(HbmError::Compliance)?;
        let mut system = problem.system(&own, self.settings, solver.as_ref(), &Condition::None)?;
        let mut x = at.coefficients_for(&system);
        // The frequency in its own unit.
        x.push(1.0);
        let found = crate::response::follow::newton(&mut system, &x, 0.0).ok_or_else(|| ResponseError::AtValue {
            value: self.value,
            why: "the phase resonance is not found again".to_owned(),
        })?;
        self.both_ways(problem, Condition::None, (found, 0.0))
    }

    fn own(&mut self) -> Result<AtValue, ResponseError> {
        (self.family)(self.value).map_err(|why| ResponseError::AtValue { value: self.value, why })
    }

    fn of_response(&mut self, at: &ResponsePoint, condition: Condition) -> Result<ParameterCurve, ResponseError> {
        let own = self.own()?;
        let window = self.settings.base_window();
        let unit = (window[1] - window[0]) / WINDOW;
        let scales = scales(own.model.structure(), window[0]);
        let (_, of_point) = at.solved.coefficients();
        let solver = solver_by_name(&self.settings.contact_solver).map_err(HbmError::Compliance)?;
        let problem = Problem::Response { scales, unit };
        let system = problem.system(&own, self.settings, solver.as_ref(), &condition)?;
        let x = at.solved.x.iter().map(|x| x * of_point / system.unit()).collect();
        let s = at.motion.at.omega / unit;
        self.both_ways(problem, condition, (x, s))
    }

    /// The contact that a motion touches from outside; none where it touches none so.
    fn touching(&mut self, at: &ResponsePoint, own: &AtValue) -> Result<Option<usize>, ResponseError> {
        let window = self.settings.base_window();
        let unit = (window[1] - window[0]) / WINDOW;
        let problem = Problem::Response { scales: scales(own.model.structure(), window[0]), unit };
        let solver = solver_by_name(&self.settings.contact_solver).map_err(HbmError::Compliance)?;
        let mut nearest: Option<(usize, f64)> = None;
        for contact in 0..own.model.structure().n_contacts() {
            let condition = Condition::Touch { contact };
            let mut system = problem.system(own, self.settings, solver.as_ref(), &condition)?;
            let (_, of_point) = at.solved.coefficients();
            let x: Vec<f64> = at.solved.x.iter().map(|x| x * of_point / system.unit()).collect();
            let s = at.motion.at.omega / unit;
            let Some(opening) = system.opening(contact, (&x, s), &own.change)? else { continue };
            let off = (opening.value - problem.apart()).abs() / problem.length();
            if off < TOUCHES && nearest.is_none_or(|(_, known)| off < known) {
                nearest = Some((contact, off));
            }
        }
        Ok(nearest.map(|(contact, _)| contact))
    }

    /// The curve below and above the start.
    fn both_ways(
        &mut self,
        problem: Problem,
        condition: Condition,
        (x, s): (Vec<f64>, f64),
    ) -> Result<ParameterCurve, ResponseError> {
        let [low, high] = self.window;
        let value_unit = (high - low) / VALUE_STEPS;
        let mut halves = Vec::new();
        for sign in [-1.0, 1.0] {
            let room = if sign < 0.0 { self.value - low } else { high - self.value };
            if room <= 0.0 {
                let end = BranchEnd::new(nlmodes_modal::EndReason::Limit, "it begins at this end".to_owned(), true);
                halves.push((Vec::new(), end));
                continue;
            }
            let scale = (self.value, value_unit);
            let mut extended = Extended::new(self.family, self.settings, problem, condition.clone(), scale, (&x, s))?;
            let start = extended.start(&x, s)?;
            let n = start.len();
            let mut direction = vec![0.0; n + 1];
            direction[n] = sign;
            let bound =
                Bound { coordinate: n, min: (low - self.value) / value_unit, max: (high - self.value) / value_unit };
            let step = StepSettings { search: SEARCH, max_iterations: ITERATIONS, ..StepSettings::default() };
            let (bounds, max_points) = (vec![bound], self.settings.max_points);
            let method = Continuation { step, bounds, max_points, ..Continuation::default() };
            let watch = |_: &BranchPoint| self.settings.watch.lets_go_on();
            let branch = method
                .run(&mut extended, &start, 0.0, &direction, watch)
                .map_err(|error| ResponseError::OverParameter { why: extended.why(&error) })?;
            let end = ended(&branch.stop, self.settings.max_points, extended.failed.take());
            let mut points = Vec::new();
            for point in &branch.points {
                points.push(extended.point(point)?);
            }
            halves.push((points, end));
        }
        let (above, below) = (halves.pop(), halves.pop());
        let (Some((above, last)), Some((mut below, first))) = (above, below) else {
            return Err(ResponseError::Stopped);
        };
        below.reverse();
        // The start is the first point of both.
        if !above.is_empty() {
            below.pop();
        }
        below.extend(above);
        Ok(ParameterCurve { points: below, ends: [first, last] })
    }
}

/// Values of the parameter from one end of its window to the other, in the unit in which a step is at most 0.1.
const VALUE_STEPS: f64 = 4.0;

/// Evaluations of a search for other directions where no step goes on: a fold that meets a first touch ends there, and
/// each evaluation reduces the structure five times.
const SEARCH: usize = 100;

/// Newton iterations of a step: the derivative of a fold is a difference, and the last ones converge by its error.
const ITERATIONS: usize = 10;

/// Distance from a stop, over the unit of lengths, within which a motion touches it.
const TOUCHES: f64 = 1e-6;

/// Why a curve goes no further.
fn ended(stop: &StopReason, max_points: usize, failed: Option<String>) -> BranchEnd {
    let mut end = curve_end(stop, max_points, |_, _| {
        (nlmodes_modal::EndReason::Limit, "the end of the window was reached".to_owned())
    });
    if let (false, Some(why)) = (end.complete, failed) {
        end.message += &format!(": {why}");
    }
    end
}

impl Extended<'_, '_> {
    /// What there is at a point.
    fn point(&mut self, at: &BranchPoint) -> Result<ParameterPoint, ResponseError> {
        let value = self.value(at.p);
        let subharmonic = self.settings.subharmonic as f64;
        let (x, s) = self.split(&at.x);
        let (x, held) = (x.to_vec(), s);
        let by_value = self.frequency_slope(at) * subharmonic;
        let watched = self.watched(value)?;
        let system = self.at(value)?;
        let motion = system.motion(&x, held)?;
        let amplitude =
            watched.map_or(0.0, |watched| amplitude(system, &motion, &watched.row, watched.harmonic).norm());
        let turns = at.events.contains(&EventKind::ParameterFold);
        let omega = motion.at.omega * subharmonic;
        Ok(ParameterPoint { value, omega, by_value, amplitude, motion, residual: at.residual, turns })
    }
}

impl ParameterPoint {
    /// Frequency, Hz.
    pub fn hertz(&self) -> f64 {
        self.omega / TAU
    }

    /// Largest contact force of all contacts, N.
    pub fn peak_force(&self) -> f64 {
        max_norm(self.motion.contacts.iter().map(|contact| contact.peak_force))
    }

    /// As an event in tables: the curve turns.
    pub fn event(&self) -> Option<Event> {
        self.turns.then_some(Event::Fold)
    }
}
