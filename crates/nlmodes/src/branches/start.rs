use std::f64::consts::TAU;
use std::ops::ControlFlow;

use nlmodes_continuation::{ParametricSystem, RunLog};
use nlmodes_hbm::{CondensedStructure, FEW_HARMONICS, Grazing, PeriodicSystem, harmonics_on_the_way};
use nlmodes_modal::ModalPoint;

use super::guide::{Guide, Guides};
use super::homotopy::{self, Effort};
use super::periodic::Periodic;
use super::prepare::{continuation, periodic, problem, within_window};
use super::touching::beginning;
use super::trace::Tracer;
use super::{BranchError, BranchMethod, BranchSettings, BranchStart};

/// Harmonics, at least, of a point from which an exact motion is sought.
const BEFORE_SHOOTING: usize = 20;

/// Points after which a branch has shown which way its frequency goes.
const HEADING: usize = 8;

/// Scaled unknowns, parameter and direction with which a branch begins.
#[derive(Debug, Clone)]
pub(super) struct Seed {
    pub x: Vec<f64>,
    pub p: f64,
    pub direction: Vec<f64>,
    /// Number of harmonics of `x`, or of the exact motion.
    pub harmonics: usize,
}

impl Seed {
    /// `z = (x, p)`.
    pub fn point(&self) -> Vec<f64> {
        self.x.iter().copied().chain([self.p]).collect()
    }
}

/// Places of frequency and parameter in `z = (x, p)`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    pub frequency: usize,
    pub dim: usize,
}

impl From<&PeriodicSystem> for Place {
    fn from(problem: &PeriodicSystem) -> Self {
        Self { frequency: problem.n_coefficients(), dim: problem.dim() }
    }
}

impl From<&Periodic<'_>> for Place {
    fn from(problem: &Periodic<'_>) -> Self {
        Self { frequency: problem.frequency_index(), dim: problem.dim() }
    }
}

/// Where on the backbone a branch begins.
#[derive(Debug, Clone, Copy)]
pub(super) enum Target {
    /// At a frequency, Hz.
    Frequency(f64),
    /// At an averaged kinetic energy over that at grazing.
    Energy(f64),
}

impl Target {
    /// The coordinate of `z = (x, p)` that it fixes, and its value.
    pub fn coordinate(self, place: Place, start: &Grazing) -> (usize, f64) {
        match self {
            Self::Frequency(hz) => (place.frequency, hz * TAU / start.omega),
            Self::Energy(ratio) => (place.dim, ratio.ln()),
        }
    }

    /// What it is to seek it, in words.
    fn sought(self, start: &Grazing) -> String {
        match self {
            Self::Frequency(hz) => format!("looking for the backbone at {hz:.4} Hz"),
            Self::Energy(ratio) => format!("looking for the backbone at {ratio} {} energies", start.word()),
        }
    }

    pub fn not_found(self, reason: String) -> BranchError {
        match self {
            Self::Frequency(hz) => BranchError::NoStart { hz, reason },
            Self::Energy(ratio) => BranchError::NoStartAtEnergy { ratio, reason },
        }
    }

    /// The coordinate at grazing.
    pub fn at_grazing(self) -> f64 {
        match self {
            Self::Frequency(_) => 1.0,
            Self::Energy(_) => 0.0,
        }
    }
}

/// The beginning that the settings ask for.
///
/// A point elsewhere is sought along the branch itself, and where an internal resonance leads that away, with fewer
/// harmonics.
pub(super) fn seed(
    structure: &CondensedStructure,
    settings: &BranchSettings,
    start: &Grazing,
    problem: &mut Periodic,
    log: &mut dyn RunLog,
) -> Result<Seed, BranchError> {
    let (target, upward) = match settings.start {
        BranchStart::Frequency { hz, upward } => (Target::Frequency(hz), upward),
        BranchStart::Energy { ratio, upward } => (Target::Energy(ratio), upward),
        BranchStart::Grazing => {
            settings.watch.begins("looking for the beginning of the branch")?;
            let seed = match problem.harmonics() {
                None if start.touches_at_rest() => exact_before_touching(structure, settings, start, log)?,
                _ => beginning(problem, settings, start, log)?,
            };
            if start.touches_at_rest() {
                within_window(settings, problem.omega(&seed.x) / TAU)?;
            }
            return Ok(seed);
        }
    };
    settings.watch.begins(target.sought(start))?;
    let mut other = periodic(structure, settings, start)?;
    let guide = Guide::trace(&mut other, settings, start, Some(target), log);
    match guide.and_then(|guide| guide.at(&mut other, settings, start, target, log)) {
        Ok((x, p)) => {
            let direction = along((&*problem).into(), start, target, upward);
            Ok(Seed { x, p, direction, harmonics: settings.harmonics })
        }
        Err(_) => {
            let guides = &mut Guides::to(target);
            refined(structure, settings, start, (target, upward), (guides, Effort::FULL), log)
        }
    }
}

/// A point of a guide with few harmonics, corrected with more and more of them, the frequency or the energy kept; each
/// time with so much effort where Newton's method alone does not do.
pub(super) fn refined(
    structure: &CondensedStructure,
    settings: &BranchSettings,
    start: &Grazing,
    (target, upward): (Target, bool),
    (guides, effort): (&mut Guides, Effort),
    log: &mut dyn RunLog,
) -> Result<Seed, BranchError> {
    settings.watch.begins(target.sought(start))?;
    let mut failure = None;
    let harmonic = in_harmonics(settings);
    for first in FEW_HARMONICS.into_iter().filter(|few| *few == 1 || *few < harmonic.harmonics) {
        let found = refined_from(structure, &harmonic, start, (target, upward), first, (guides, effort), log);
        let found = found.and_then(|(seed, point)| match settings.method {
            BranchMethod::HarmonicBalance => Ok(seed),
            BranchMethod::Shooting => exact_seed(structure, settings, start, (target, upward), &point, log),
        });
        match found {
            Err(error @ (BranchError::NoStart { .. } | BranchError::NoStartAtEnergy { .. })) => {
                failure.get_or_insert(error);
            }
            outcome => return outcome,
        }
    }
    Err(failure.unwrap_or_else(|| target.not_found("no number of harmonics leads there".to_owned())))
}

/// The same branch in harmonics, of an exact one with enough to find its motions from.
fn in_harmonics(settings: &BranchSettings) -> BranchSettings {
    let harmonics = match settings.method {
        BranchMethod::HarmonicBalance => settings.harmonics,
        BranchMethod::Shooting => settings.harmonics.max(BEFORE_SHOOTING),
    };
    BranchSettings { method: BranchMethod::HarmonicBalance, harmonics, ..settings.clone() }
}

/// The exact motion before contacts that touch at rest at the energy of the start, by way of that in harmonics.
fn exact_before_touching(
    structure: &CondensedStructure,
    settings: &BranchSettings,
    start: &Grazing,
    log: &mut dyn RunLog,
) -> Result<Seed, BranchError> {
    let harmonic = in_harmonics(settings);
    let seed = beginning(&mut periodic(structure, &harmonic, start)?, &harmonic, start, log)?;
    let point = structure.modal_point(&mut problem(structure, &harmonic, start)?, &seed.x, 0.0)?;
    exact_seed(structure, settings, start, (Target::Energy(1.0), true), &point, log)
}

/// The exact motion beside a point in harmonics, with the same frequency or energy.
fn exact_seed(
    structure: &CondensedStructure,
    settings: &BranchSettings,
    start: &Grazing,
    (target, upward): (Target, bool),
    point: &ModalPoint,
    log: &mut dyn RunLog,
) -> Result<Seed, BranchError> {
    let mut problem = super::prepare::exact(structure.model(), settings, start)?;
    let (mut x, mut p) = problem.unknowns(&point.coefficients, point.omega)?;
    let mut problem = Periodic::exact(problem, settings);
    let (coordinate, value) = target.coordinate((&problem).into(), start);
    // What the reduction changes of the grazing changes what the target is.
    match target {
        Target::Frequency(_) => x[coordinate] = value,
        Target::Energy(_) => p = value,
    }
    let guess: Vec<f64> = x.into_iter().chain([p]).collect();
    let direction = along((&problem).into(), start, target, true);
    let (x, p) = one_point(settings, start, &mut problem, &guess, &direction, log)
        .or_else(|| homotopy::solve(&mut problem, &guess, coordinate, &settings.step, Effort::FULL, log))
        .ok_or_else(|| {
            target.not_found("Newton's method does not lead from harmonics to an exact motion".to_owned())
        })?;
    let direction = along((&problem).into(), start, target, upward);
    Ok(Seed { x, p, direction, harmonics: settings.harmonics })
}

fn refined_from(
    structure: &CondensedStructure,
    settings: &BranchSettings,
    start: &Grazing,
    (target, upward): (Target, bool),
    first: usize,
    (guides, effort): (&mut Guides, Effort),
    log: &mut dyn RunLog,
) -> Result<(Seed, ModalPoint), BranchError> {
    let coarse = BranchSettings { harmonics: first, ..settings.clone() };
    let coarse_problem = problem(structure, &coarse, start)?;
    let mut series = coarse_problem.series();
    let mut coarse_problem = Periodic::in_harmonics(structure, coarse_problem, &coarse);
    let guide = guides.of(&mut coarse_problem, &coarse, start, log)?;
    let (mut x, mut p) = guide.at(&mut coarse_problem, &coarse, start, target, log)?;
    for harmonics in harmonics_on_the_way(first, settings.harmonics) {
        let step = BranchSettings { harmonics, ..settings.clone() };
        let problem = self::problem(structure, &step, start)?;
        let finer = problem.series();
        let guess = problem.resized(&x, series);
        let direction = along((&problem).into(), start, target, true);
        let guess: Vec<f64> = guess.into_iter().chain([p]).collect();
        let (coordinate, _) = target.coordinate((&problem).into(), start);
        let mut problem = Periodic::in_harmonics(structure, problem, &step);
        let corrected = one_point(&step, start, &mut problem, &guess, &direction, log)
            .or_else(|| homotopy::solve(&mut problem, &guess, coordinate, &step.step, effort, log))
            .ok_or_else(|| target.not_found(format!("Newton's method fails with {harmonics} harmonics")))?;
        series = finer;
        (x, p) = corrected;
    }
    let mut problem = self::problem(structure, settings, start)?;
    let point = structure.modal_point(&mut problem, &x, 0.0)?;
    let direction = along((&problem).into(), start, target, upward);
    Ok((Seed { x, p, direction, harmonics: settings.harmonics }, point))
}

/// Whether the backbone from `seed` leads to higher frequencies: as asked for, else as with one harmonic.
pub(super) fn heading(tracer: &mut Tracer, seed: &Seed) -> Result<bool, BranchError> {
    if let BranchStart::Frequency { upward, .. } = tracer.settings.start {
        return Ok(upward);
    }
    let coarse = BranchSettings { harmonics: 1, start: BranchStart::Grazing, ..tracer.settings.clone() };
    let coarse = BranchSettings { method: BranchMethod::HarmonicBalance, ..coarse };
    let mut problem = periodic(tracer.structure, &coarse, tracer.grazing)?;
    let mut method = continuation(&coarse, tracer.grazing, problem.frequency_index(), problem.dim());
    method.max_points = HEADING;
    let log = &mut *tracer.log;
    let Seed { x, p, direction, .. } = beginning(&mut problem, &coarse, tracer.grazing, log)?;
    let branch = method.run_with_log(&mut problem, &x, p, &direction, log, |_| ControlFlow::Continue(()))?;
    let rises = branch.points.last().is_none_or(|last| last.x[problem.frequency_index()] >= 1.0);
    let towards_more_energy = seed.direction.last().is_none_or(|d| *d >= 0.0);
    Ok(rises == towards_more_energy)
}

/// Unit vector along the coordinate that the target fixes.
pub(super) fn along(place: Place, start: &Grazing, target: Target, upward: bool) -> Vec<f64> {
    let mut direction = vec![0.0; place.dim + 1];
    direction[target.coordinate(place, start).0] = if upward { 1.0 } else { -1.0 };
    direction
}

/// Corrects a guess across `direction`.
pub(super) fn one_point(
    settings: &BranchSettings,
    start: &Grazing,
    problem: &mut Periodic,
    z: &[f64],
    direction: &[f64],
    log: &mut dyn RunLog,
) -> Option<(Vec<f64>, f64)> {
    let mut method = continuation(settings, start, problem.frequency_index(), problem.dim());
    // Where branches end does not concern a single point.
    method.bounds.clear();
    method.first_point(problem, z, direction, log).ok()?.map(|point| (point.x, point.p))
}
