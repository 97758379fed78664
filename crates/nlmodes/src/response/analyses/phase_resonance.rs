use nlmodes_contact::{LcpSolver, solver_by_name};
use nlmodes_continuation::{Bound, ParametricSystem};
use nlmodes_hbm::{HbmError, PeriodicSystem, PhaseLag};
use nlmodes_model::reduction::RestState;
use num_complex::Complex64;

use super::forced::{APART, scales, touch};
use super::touching::as_gaps_close;
use crate::response::follow::Curve;
use crate::response::linear::{linear_motion, unknowns_at_rest};
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
    if !(to.is_finite() && to > 0.0) {
        return Err(ResponseError::Setting { what: "the largest level", value: to, expected: "a positive number" });
    }
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
    let linear = Linear { model, settings, drive, solver, pressed: model.pressed_rest()? };
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
    let linear = Linear { model: &apart, settings, drive, solver, pressed: apart.pressed_rest()? };
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
    /// The state at rest of a structure that its stops press.
    pressed: Option<RestState>,
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
        let mode_omega = match self.pressed {
            Some(_) => self.model.linear_start(mode)?.omega,
            None => structure.omega_squared()[mode - 1].sqrt(),
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

    /// The contacts that are closed at rest.
    fn closed(&self) -> Option<&[bool]> {
        self.pressed.as_ref().map(|rest| rest.closed.as_slice())
    }

    fn system(&self, omega: f64) -> Result<PeriodicSystem, ResponseError> {
        let structure = self.model.structure();
        let load = self.model.load(self.settings)?;
        let few = nlmodes_hbm::PeriodicSettings { harmonics: load.highest_harmonic(), ..self.settings.periodic() };
        let scales = scales(structure, omega);
        Ok(PeriodicSystem::force_response(structure, load, omega, 1.0, few, scales, self.solver)?)
    }

    /// What the phase at the drive point has beyond the lag that is wanted, −π to π: it falls through zero at phase
    /// resonance.
    fn phase(&self, omega: f64) -> Result<f64, ResponseError> {
        let mut system = self.system(omega)?;
        let rest = unknowns_at_rest(&system, self.pressed.as_ref());
        let x = linear_motion(&mut system, &rest)?;
        let small = small_level(&mut system, (&rest, &x), self.closed())?;
        let motion = system.motion(&beside(&rest, &x, small), small)?;
        let n = self.drive.harmonic;
        let own = system.load().terms().iter().zip(&self.drive.row.loads).filter(|(term, _)| term.harmonic == n);
        let moved: Complex64 = own.map(|(term, a)| a * small * omega.powi(term.omega_power)).sum();
        let q = motion.displacement(&self.drive.row)[n] + moved;
        Ok((q * Complex64::cis(self.settings.lag)).arg())
    }

    /// Unknowns with all harmonics at rest, what the level one adds to them, and the level at which a contact first
    /// changes its state.
    fn motion(&self, omega: f64) -> Result<([Vec<f64>; 2], f64), ResponseError> {
        let mut few = self.system(omega)?;
        let rest = unknowns_at_rest(&few, self.pressed.as_ref());
        let x = linear_motion(&mut few, &rest)?;
        let touching = small_level(&mut few, (&rest, &x), self.closed())? / SAFE;
        let structure = self.model.structure();
        let load = self.model.load(self.settings)?;
        let scales = scales(structure, omega);
        let full =
            PeriodicSystem::force_response(structure, load, omega, 1.0, self.settings.periodic(), scales, self.solver)?;
        Ok(([rest, x].map(|x| full.resized(&x, few.series())), touching))
    }
}

/// Share of the level that first touches at which the linear motion is evaluated.
const SAFE: f64 = 0.25;

/// The unknowns at rest with so many times those of the level one.
pub(super) fn beside(rest: &[f64], x: &[f64], level: f64) -> Vec<f64> {
    rest.iter().zip(x).map(|(rest, x)| rest + level * x).collect()
}

/// A level at which no contact changes its state: a quarter of that at which the first one does. Of a structure that
/// rests with its contacts open that level follows from the largest motion toward a stop; of one that its stops press,
/// with these contacts `closed`, it is searched.
pub(super) fn small_level(
    system: &mut PeriodicSystem,
    (rest, x): (&[f64], &[f64]),
    closed: Option<&[bool]>,
) -> Result<f64, ResponseError> {
    if let Some(closed) = closed {
        return searched_level(system, (rest, x), closed);
    }
    let mut level = 1.0;
    for _ in 0..200 {
        let motion = system.motion(&beside(rest, x, level), level)?;
        let gaps = system.structure().gaps();
        let share = |(c, gap): (&nlmodes_hbm::ContactMotion, &f64)| if c.touches > 0 { 2.0 } else { c.peak / gap };
        let of_contacts = motion.contacts.iter().zip(gaps).map(share).fold(0.0_f64, f64::max);
        let used = of_contacts.max(bent(system, x, level));
        if used > 1.0 {
            level *= 0.25;
        } else if used > 0.0 {
            return Ok(SAFE * level / used);
        } else {
            level *= 4.0;
        }
    }
    Ok(level)
}

/// Largest displacement of a law in the linear motion, over that at which laws matter.
fn bent(system: &PeriodicSystem, x: &[f64], level: f64) -> f64 {
    if system.structure().laws().is_empty() {
        return 0.0;
    }
    // Displacements are in units of that length, see `scales`.
    level * nlmodes_linalg::max_norm(x.iter().copied())
}

/// Halvings by which the level is found at which a contact changes its state.
const HALVINGS: usize = 30;

fn searched_level(
    system: &mut PeriodicSystem,
    (rest, x): (&[f64], &[f64]),
    closed: &[bool],
) -> Result<f64, ResponseError> {
    let mut keeps = |level: f64| -> Result<bool, ResponseError> {
        let motion = system.motion(&beside(rest, x, level), level)?;
        let is_kept = |(of, closed): (&nlmodes_hbm::ContactMotion, &bool)| match closed {
            true => of.closed_share >= 1.0,
            false => of.closed_share <= 0.0,
        };
        Ok(motion.contacts.iter().zip(closed).all(is_kept))
    };
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..200 {
        match keeps(high)? {
            true => (low, high) = (high, 4.0 * high),
            false if low == 0.0 && !keeps(0.25 * high)? => high *= 0.25,
            false => break,
        }
    }
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if keeps(middle)? { low = middle } else { high = middle }
    }
    Ok(SAFE * low)
}
