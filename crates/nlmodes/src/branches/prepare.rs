//! What a branch is computed with: the condensed structure, the periodic problem, the continuation.

use std::f64::consts::TAU;

use nlmodes_contact::solver_by_name;
use nlmodes_continuation::{AtBranchPoint, Bound, Continuation, StepSettings};
use nlmodes_hbm::{
    CondensedStructure, Grazing, PeriodicSettings, PeriodicSystem, Symmetry, TruncationEstimator, grazing_opened,
};
use nlmodes_model::MasslessContactModel;
use nlmodes_timestep::{GalerkinReduction, MAX_SHOOTING_MODES, ModeShooting, ShootingScales, TimestepError};

use super::periodic::Periodic;
use super::{BranchError, BranchMethod, BranchPointRule, BranchSettings, BranchStart};

/// Lowest energy, over that at grazing, down to which a branch is followed: a linear mode that fades out.
const MIN_ENERGY_RATIO: f64 = 1e-3;

/// Largest unknown, over the length of the contact's amplitude at grazing, beyond which steps grow with the motion.
const FAR: f64 = 10.0;

/// What is done before a branch begins.
const LINEAR_MODES: &str = "computing linear modes";

/// The structure with the held modes that the settings ask for, where an accuracy chooses them with `at_least` so many.
pub(super) fn condense(
    model: MasslessContactModel,
    settings: &BranchSettings,
    at_least: usize,
) -> Result<CondensedStructure, BranchError> {
    settings.watch.begins(LINEAR_MODES)?;
    let size = model.linear_dofs().len();
    if let Some(accuracy) = settings.accuracy {
        return super::accuracy::condense(model, settings, accuracy, at_least);
    }
    if let Some(count) = settings.held_modes {
        return Ok(CondensedStructure::new(model, count)?);
    }
    if size <= settings.held.all_up_to {
        return Ok(CondensedStructure::new(model, size)?);
    }
    // Stiffness and mass of what is left out are kept, which leaves an error of about (ν/ω_last)⁴ of the modes beyond.
    let mut count = (32 + 8 * settings.harmonics).min(settings.held.most_at_first);
    loop {
        settings.watch.begins(LINEAR_MODES)?;
        let structure = CondensedStructure::new(model.clone(), count.min(size))?;
        let top = settings.frequency_hz.map(|w| w[1] * TAU);
        let top = top.map_or_else(|| Ok(2.0 * linear_start(&structure, settings)?.omega), Ok::<f64, BranchError>)?;
        let highest = structure.highest_frequency();
        let least = 20.0 * settings.harmonics as f64 * top;
        if count >= size || highest > least {
            return Ok(structure);
        }
        // Frequencies of slender structures rise at least in proportion to the number of the mode; of others it takes
        // another round.
        count = (count as f64 * (1.02 * least / highest).clamp(1.2, 8.0)).ceil() as usize;
    }
}

/// Where the nonlinear mode begins, or from where that is sought if contacts touch at rest.
pub(super) fn linear_start(structure: &CondensedStructure, settings: &BranchSettings) -> Result<Grazing, BranchError> {
    Ok(grazing_opened(structure, settings.mode, settings.reference_energy)?)
}

pub(super) fn check_window(settings: &BranchSettings, start: &Grazing) -> Result<(), BranchError> {
    let start_hz = match settings.start {
        // Before contacts that touch at rest the frequency is not known yet.
        BranchStart::Grazing if start.touches_at_rest() => return Ok(()),
        BranchStart::Grazing => start.omega / TAU,
        BranchStart::Frequency { hz, .. } => hz,
        BranchStart::Energy { .. } => return Ok(()),
    };
    within_window(settings, start_hz)
}

pub(super) fn within_window(settings: &BranchSettings, start_hz: f64) -> Result<(), BranchError> {
    match settings.frequency_hz {
        Some([low_hz, high_hz]) if !(low_hz..=high_hz).contains(&start_hz) => {
            Err(BranchError::StartOutsideWindow { start_hz, low_hz, high_hz })
        }
        _ => Ok(()),
    }
}

/// The periodic problem of the method.
pub(super) fn periodic<'s>(
    structure: &'s CondensedStructure,
    settings: &BranchSettings,
    start: &Grazing,
) -> Result<Periodic<'s>, BranchError> {
    Ok(match settings.method {
        BranchMethod::HarmonicBalance => {
            Periodic::in_harmonics(structure, problem(structure, settings, start)?, settings)
        }
        BranchMethod::Shooting => Periodic::exact(exact(structure.model(), settings, start)?, settings),
    })
}

/// The exact problem on the held modes that are to be kept.
pub(super) fn exact(
    model: &MasslessContactModel,
    settings: &BranchSettings,
    start: &Grazing,
) -> Result<ModeShooting, BranchError> {
    if settings.symmetry == Symmetry::None {
        return Err(BranchError::NotEven);
    }
    let reduced =
        GalerkinReduction::new(model.clone(), shooting_modes(model, settings)?).map_err(TimestepError::from)?;
    let near = ShootingScales { omega: start.omega, energy: start.energy };
    Ok(ModeShooting::new(reduced, near, settings.harmonics)?)
}

/// The held modes to be computed: those asked for, or all.
pub(super) fn shooting_modes(model: &MasslessContactModel, settings: &BranchSettings) -> Result<usize, BranchError> {
    let count = settings.held_modes.unwrap_or_else(|| model.linear_dofs().len());
    if count > settings.held.hidden * MAX_SHOOTING_MODES {
        return Err(TimestepError::TooManyModes { found: count, most: MAX_SHOOTING_MODES }.into());
    }
    Ok(count)
}

pub(super) fn problem(
    structure: &CondensedStructure,
    settings: &BranchSettings,
    start: &Grazing,
) -> Result<PeriodicSystem, BranchError> {
    let solver = solver_by_name(&settings.contact_solver)?;
    Ok(structure.conservative_mode(harmonic_settings(settings), start.scales(), solver.as_ref())?)
}

pub(super) fn estimator<'s>(
    structure: &'s CondensedStructure,
    settings: &BranchSettings,
    start: &Grazing,
) -> Result<TruncationEstimator<'s>, BranchError> {
    let solver = solver_by_name(&settings.contact_solver)?;
    Ok(TruncationEstimator::new(structure, harmonic_settings(settings), start.scales(), solver.as_ref())?)
}

fn harmonic_settings(settings: &BranchSettings) -> (PeriodicSettings, Symmetry) {
    let &BranchSettings { harmonics, switching, symmetry, .. } = settings;
    (PeriodicSettings { harmonics, switching, ..PeriodicSettings::default() }, symmetry)
}

pub(super) fn continuation(settings: &BranchSettings, start: &Grazing, frequency: usize, dim: usize) -> Continuation {
    let max = settings.max_energy_ratio.map_or(f64::INFINITY, f64::ln);
    let mut bounds = vec![Bound { coordinate: dim, min: MIN_ENERGY_RATIO.ln(), max }];
    if let Some([low, high]) = settings.frequency_hz {
        let scaled = |hz: f64| hz * TAU / start.omega;
        bounds.push(Bound { coordinate: frequency, min: scaled(low), max: scaled(high) });
    }
    let at_branch_point = match settings.at_branch_point {
        BranchPointRule::Switch => AtBranchPoint::Switch,
        BranchPointRule::Stay | BranchPointRule::All => AtBranchPoint::Stay,
    };
    Continuation {
        // Far from grazing, motions grow while the gap stays what it is: what happens to them does so over a share of
        // their size.
        step: StepSettings { far: FAR.min(settings.step.far), ..settings.step.clone() },
        bounds,
        watched: vec![frequency],
        at_branch_point,
        max_points: usize::MAX,
    }
}
