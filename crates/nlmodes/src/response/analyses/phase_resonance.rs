use nlmodes_contact::{LcpSolver, solver_by_name};
use nlmodes_continuation::{Bound, ParametricSystem};
use nlmodes_hbm::{HbmError, PeriodicSystem, PhaseLag};
use num_complex::Complex64;

use super::forced::{APART, scales, touch};
use super::touching::as_gaps_close;
use crate::response::error::positive;
use crate::response::follow::{Curve, amplitude};
use crate::response::linear::{SAFE, SmallMotion, beside, unknowns_at_rest};
use crate::response::{ResponseCurve, ResponseError, ResponseModel, ResponseSettings};
use crate::touching::growing;

/// Motions whose drive point lags the load by `settings.lag`, from half the level that first touches to the largest
/// level `to`: what a phase-locked loop follows. The curve starts at the linear phase resonance next to mode
/// `settings.mode`, which residual flexibility shifts; before contacts that touch at rest without force at half the
/// least level of `settings.levels`.
///
/// # Errors
/// [`ResponseError`] where there is no start; a curve that ends early is none.
pub fn phase_resonance(
    model: &ResponseModel,
    to: f64,
    settings: &ResponseSettings,
) -> Result<ResponseCurve, ResponseError> {
    settings.check()?;
    positive("the largest level", to)?;
    let drive = model.drive(settings)?.ok_or(ResponseError::NoDrive)?;
    let solver = solver_by_name(&settings.contact_solver).map_err(HbmError::Compliance)?;
    let solver = solver.as_ref();
    let touching = model.touching_at_rest()?;
    let begun = match touching.is_empty() {
        true => begin(model, &drive, to, settings, solver)?,
        false => begin_touching(model, &touching, &drive, to, settings, solver)?,
    };
    let Begun { system, x, direction, from, base } = begun;
    let (omega, parameter) = (system.n_coefficients(), system.dim());
    let bounds =
        vec![Bound { coordinate: parameter, min: -1.0, max: (to / from).ln() }, settings.bound_from(omega, base)?];
    let (drive, budget) = (Some(drive), settings.budget());
    let mut curve = Curve { system, x, p: 0.0, direction, bounds, drive, settings, solver, budget };
    curve.follow((omega, base * settings.subharmonic as f64))
}

/// Where a curve of phase resonances begins.
struct Begun {
    system: PeriodicSystem,
    x: Vec<f64>,
    direction: Vec<f64>,
    /// Level.
    from: f64,
    /// Base frequency, rad/s.
    base: f64,
}

fn begin(
    model: &ResponseModel,
    drive: &PhaseLag,
    to: f64,
    settings: &ResponseSettings,
    solver: &dyn LcpSolver,
) -> Result<Begun, ResponseError> {
    let linear = Linear { model, settings, drive, solver };
    let (base, [rest, unit], touching) = linear.resonance()?;
    let (structure, load) = (model.structure(), model.load(settings)?);
    let from = (0.5 * touching).min(0.5 * to);
    let (periodic, scales) = (settings.periodic(), scales(structure, base));
    let system = PeriodicSystem::phase_resonance(structure, load, drive.clone(), from, periodic, scales, solver)?;
    let mut x = beside(&rest, &unit, from);
    let mut direction: Vec<f64> = unit.iter().map(|x| x * from).collect();
    x.push(1.0);
    direction.extend([0.0, 1.0]);
    Ok(Begun { system, x, direction, from, base })
}

/// Share of how far the load moves contacts that touch beyond which they are set back: there nothing touches, also by
/// rounding.
const CLEAR: f64 = 1.1;

/// Before contacts that touch at rest without force, which no level leaves alone: phase resonance at half the least
/// level that is asked for before contacts that are set back, to which these are then closed.
fn begin_touching(
    model: &ResponseModel,
    touching: &[usize],
    drive: &PhaseLag,
    to: f64,
    settings: &ResponseSettings,
    solver: &dyn LcpSolver,
) -> Result<Begun, ResponseError> {
    let apart = model.opened(touching, APART)?;
    let linear = Linear { model: &apart, settings, drive, solver };
    let (base, [rest, unit], others) = linear.resonance()?;
    let least = settings.levels.iter().copied().filter(|level| *level > 0.0).fold(to, f64::min);
    let from = (0.5 * others).min(0.5 * least);
    let Some(touch) = touch(model, (base, from), settings, solver)? else {
        return begin(model, drive, to, settings, solver);
    };
    let (structure, load, own) = (model.structure(), model.load(settings)?, touch.scales(base));
    let mut opening = vec![0.0; structure.n_contacts()];
    touching.iter().for_each(|&contact| opening[contact] = CLEAR * touch.length);
    let per_length = scales(apart.structure(), base).length / own.length;
    let mut x: Vec<f64> = beside(&rest, &unit, from).iter().map(|x| x * per_length).collect();
    x.push(1.0);
    let (drive, periodic) = (drive.clone(), settings.periodic());
    let system = PeriodicSystem::phase_resonance(structure, load, drive, from, periodic, own, solver)?;
    let rest = unknowns_at_rest(&system, model.pressed_rest()?.as_ref());
    let x = as_gaps_close(&system, &x, &opening, (settings, solver))?;
    // The distance from rest grows like the level.
    let direction = growing(&system, &x, &rest, 1.0);
    Ok(Begun { system, x, direction, from, base })
}

/// The linear response, whose phase is evaluated near a mode.
struct Linear<'a> {
    model: &'a ResponseModel,
    settings: &'a ResponseSettings,
    drive: &'a PhaseLag,
    solver: &'a dyn LcpSolver,
}

/// Number of frequencies in the search, and its range relative to the mode's frequency on both sides.
const GRID: (usize, f64) = (600, 0.25);

impl Linear<'_> {
    /// Base frequency of the linear phase resonance, unknowns for the level one, and the level that first touches.
    fn resonance(&self) -> Result<(f64, [Vec<f64>; 2], f64), ResponseError> {
        let structure = self.model.structure();
        let (mode, available) = (self.settings.mode, structure.n_modes());
        if mode == 0 || mode > available {
            return Err(HbmError::NoSuchMode { mode, available }.into());
        }
        let mode_omega = match structure.is_pressed() {
            true => self.model.linear_start(mode)?.omega,
            false => structure.omega_squared()[mode - 1].sqrt(),
        };
        let near = mode_omega / self.settings.subharmonic as f64;
        let missed = || ResponseError::NoPhaseResonance { lag_deg: self.settings.lag.to_degrees(), omega: mode_omega };
        // Dense where the phase turns: cubes of a uniform grid about the frequency of the mode.
        let at = |j: usize| {
            let s = 2.0 * j as f64 / GRID.0 as f64 - 1.0;
            near * (1.0 + GRID.1 * s * s * s)
        };
        let mut crossing: Option<(f64, f64)> = None;
        let mut before: Option<(f64, f64)> = None;
        for j in 0..=GRID.0 {
            let omega = at(j);
            let phase = self.phase(omega)?;
            if let Some((last, value)) = before.filter(|b| b.1 * phase <= 0.0 && (b.1 - phase).abs() < 2.0) {
                let middle = |c: (f64, f64)| (0.5 * (c.0 + c.1) - near).abs();
                if value >= phase && crossing.is_none_or(|c| middle((last, omega)) < middle(c)) {
                    crossing = Some((last, omega));
                }
            }
            before = Some((omega, phase));
        }
        let (mut low, mut high) = crossing.ok_or_else(missed)?;
        for _ in 0..100 {
            let middle = 0.5 * (low + high);
            if self.phase(middle)? >= 0.0 { low = middle } else { high = middle }
        }
        let omega = 0.5 * (low + high);
        let (x, touching) = self.motion(omega)?;
        Ok((omega, x, touching))
    }

    /// What the phase at the drive point has beyond the lag that is wanted, −π to π: it falls through zero at phase
    /// resonance.
    fn phase(&self, omega: f64) -> Result<f64, ResponseError> {
        let mut small = SmallMotion::new(self.model, omega, self.settings, self.solver)?;
        let motion = small.motion()?;
        let q = amplitude(&small.system, &motion, &self.drive.row, self.drive.harmonic);
        Ok((q * Complex64::cis(self.settings.lag)).arg())
    }

    /// Unknowns with all harmonics at rest, what the level one adds to them, and the level at which a contact first
    /// changes its state.
    fn motion(&self, omega: f64) -> Result<([Vec<f64>; 2], f64), ResponseError> {
        let small = SmallMotion::new(self.model, omega, self.settings, self.solver)?;
        let structure = self.model.structure();
        let load = self.model.load(self.settings)?;
        let scales = scales(structure, omega);
        let full =
            PeriodicSystem::force_response(structure, load, omega, 1.0, self.settings.periodic(), scales, self.solver)?;
        let few = small.system.series();
        Ok(([small.rest, small.x].map(|x| full.resized(&x, few)), small.level / SAFE))
    }
}
