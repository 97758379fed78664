use std::f64::consts::TAU;
use std::ops::ControlFlow;

use nlmodes_contact::solver_by_name;
use nlmodes_continuation::{Bound, BranchPoint, Continuation, ParametricSystem, StopReason};
use nlmodes_hbm::{CondensedStructure, Grazing, MixedShooting, MixedShootingSettings, Switching, grazing};
use nlmodes_modal::{BranchEnd, Coordinate, ModalBranch, ModalPoint, TimeHistory};
use nlmodes_model::{ContactCoordinates, MasslessContactModel};

use super::events::event_name;
use super::start::{Seed, seed};
use super::{BranchSettings, BranchStart, StudyError};

/// Lowest energy, over that at grazing, down to which a branch is followed: a linear mode that fades out.
const MIN_ENERGY_RATIO: f64 = 1e-6;

/// Up to this size all modes of the held structure are used.
const ALL_HELD_MODES: usize = 400;

/// A branch with what is needed to look closer at its points.
#[derive(Debug)]
pub struct ComputedBranch {
    /// The points and why they end.
    pub branch: ModalBranch,
    /// The condensed structure.
    pub structure: CondensedStructure,
    /// Where the branch begins.
    pub grazing: Grazing,
    /// Scaled unknowns of each point.
    pub unknowns: Vec<Vec<f64>>,
    /// Largest unfolding parameter |δ| met; zero but for rounding, and `None` for motions that are even in time.
    pub largest_unfolding: Option<f64>,
    /// Evaluations of residual and Jacobian.
    pub evaluations: usize,
    /// Iterations of the contact solver along the branch, over all contact problems, in the unit of that solver.
    pub contact_iterations: usize,
    /// Steps that were tried and refused.
    pub refused_steps: usize,
    settings: BranchSettings,
}

/// Computes the nonlinear mode of `model` from grazing on: by MS-HBM where its contact nodes are massless, by conventional HBM where it
/// was made with spring tips. Each point is shown to `observe` when it is found.
///
/// # Errors
/// [`StudyError`] if there is no branch at all; one that ends early comes back with its points and the reason.
pub fn compute_branch(
    model: MasslessContactModel,
    settings: &BranchSettings,
    mut observe: impl FnMut(&ModalPoint) -> ControlFlow<()>,
) -> Result<ComputedBranch, StudyError> {
    let structure = condense(model, settings)?;
    let start = grazing(&structure, settings.mode)?;
    check_window(settings, &start)?;
    let mut problem = problem(&structure, settings, &start)?;
    let mut viewer = self::problem(&structure, settings, &start)?;
    let dim = problem.dim();
    let Seed { x, p, direction } = seed(&structure, settings, &start, &problem)?;
    let mut found = Found::new(settings.start);
    let branch = continuation(settings, &start, &problem, dim).run(&mut problem, &x, p, &direction, |point| {
        let Some(modal) = found.keep(&mut viewer, point) else { return ControlFlow::Continue(()) };
        observe(modal)?;
        if found.points.len() < settings.max_points { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    })?;
    let frequency = problem.frequency_index();
    let end = branch_end(&branch.stop, frequency, dim, &start, settings, found.points.len());
    let model = structure.model();
    let first = model.contacts()[0];
    let coordinates = model.dofs().iter().map(|d| Coordinate { position: d.position, kind: d.kind.name().to_owned() });
    let modal = ModalBranch {
        label: label(settings, model.contact_coordinates()),
        coordinates: coordinates.collect(),
        contact_coordinate: Some(first.dof),
        stop: Some(first.side.sign() * first.gap),
        points: found.points,
        end,
    };
    let unfoldings = found.unknowns.iter().filter_map(|x| problem.unfolding(x));
    let largest_unfolding = unfoldings.map(f64::abs).reduce(f64::max);
    let contact_iterations = problem.contact_iterations();
    drop(viewer);
    drop(problem);
    Ok(ComputedBranch {
        branch: modal,
        structure,
        grazing: start,
        unknowns: found.unknowns,
        largest_unfolding,
        evaluations: branch.evaluations,
        contact_iterations,
        refused_steps: branch.refused_steps,
        settings: settings.clone(),
    })
}

impl ComputedBranch {
    /// Motion and force of contact `contact` over one period of point `point`.
    ///
    /// # Errors
    /// [`StudyError`] if the point cannot be evaluated again.
    ///
    /// # Panics
    /// If there is no such point or contact.
    pub fn time_history(
        &self,
        point: usize,
        contact: usize,
        samples: usize,
        label: &str,
    ) -> Result<TimeHistory, StudyError> {
        let mut problem = self.problem()?;
        Ok(problem.time_history(&self.unknowns[point], contact, samples, label)?)
    }

    /// This branch with `other`, which starts at the same point and goes the other way, before it: its points in reverse order,
    /// the common one once.
    pub fn preceded_by(mut self, other: ComputedBranch) -> Self {
        let mut points: Vec<ModalPoint> = other.branch.points.into_iter().skip(1).rev().collect();
        let mut unknowns: Vec<Vec<f64>> = other.unknowns.into_iter().skip(1).rev().collect();
        points.append(&mut self.branch.points);
        unknowns.append(&mut self.unknowns);
        (self.branch.points, self.unknowns) = (points, unknowns);
        let (first, last) = (other.branch.end, &self.branch.end);
        self.branch.end = BranchEnd {
            reason: format!("{} {}", first.reason, last.reason),
            message: format!("one way, {}; the other way, {}", first.message, last.message),
            complete: first.complete && last.complete,
        };
        self.largest_unfolding = self.largest_unfolding.into_iter().chain(other.largest_unfolding).reduce(f64::max);
        self.evaluations += other.evaluations;
        self.contact_iterations += other.contact_iterations;
        self.refused_steps += other.refused_steps;
        self
    }

    /// The periodic problem, to evaluate points of the branch again.
    ///
    /// # Errors
    /// [`StudyError`], as [`compute_branch`].
    pub fn problem(&self) -> Result<MixedShooting<'_>, StudyError> {
        problem(&self.structure, &self.settings, &self.grazing)
    }
}

/// Modal points as they are found.
struct Found {
    start: &'static str,
    points: Vec<ModalPoint>,
    unknowns: Vec<Vec<f64>>,
}

impl Found {
    fn new(start: BranchStart) -> Self {
        let start = if start == BranchStart::Grazing { "grazing" } else { "start" };
        Self { start, points: Vec::new(), unknowns: Vec::new() }
    }

    fn keep(&mut self, viewer: &mut MixedShooting, point: &BranchPoint) -> Option<&ModalPoint> {
        let mut events: Vec<String> = point.events.iter().map(|e| event_name(*e).to_owned()).collect();
        if self.points.is_empty() {
            events.insert(0, self.start.to_owned());
        } else if !point.events.is_empty() && self.is_start(point) {
            // What the continuation meets at the start is the grazing itself.
            return None;
        }
        let mut modal = viewer.modal_point(&point.x, point.residual).ok()?;
        modal.events = events;
        self.points.push(modal);
        self.unknowns.push(point.x.clone());
        self.points.last()
    }

    fn is_start(&self, point: &BranchPoint) -> bool {
        self.unknowns[0].iter().zip(&point.x).all(|(a, b)| (a - b).abs() < 1e-6)
    }
}

fn condense(model: MasslessContactModel, settings: &BranchSettings) -> Result<CondensedStructure, StudyError> {
    let size = model.linear_dofs().len();
    if let Some(count) = settings.held_modes {
        return Ok(CondensedStructure::new(model, count)?);
    }
    if size <= ALL_HELD_MODES {
        return Ok(CondensedStructure::new(model, size)?);
    }
    // Stiffness and mass of what is left out are kept, which leaves an error of about (ν/ω_last)⁴ of the modes beyond.
    let mut count = 32 + 8 * settings.harmonics;
    loop {
        let structure = CondensedStructure::new(model.clone(), count.min(size))?;
        let top = settings.frequency_hz.map(|w| w[1] * TAU);
        let top = top.map_or_else(|| grazing(&structure, settings.mode).map(|g| 2.0 * g.omega), Ok)?;
        let highest = structure.modes().last().map_or(0.0, |m| m.lambda.sqrt());
        if count >= size || highest > 20.0 * settings.harmonics as f64 * top {
            return Ok(structure);
        }
        count *= 2;
    }
}

fn check_window(settings: &BranchSettings, start: &Grazing) -> Result<(), StudyError> {
    let start_hz = match settings.start {
        BranchStart::Grazing => start.omega / TAU,
        BranchStart::Frequency { hz, .. } => hz,
    };
    match settings.frequency_hz {
        Some([low_hz, high_hz]) if !(low_hz..=high_hz).contains(&start_hz) => {
            Err(StudyError::StartOutsideWindow { start_hz, low_hz, high_hz })
        }
        _ => Ok(()),
    }
}

pub(super) fn problem<'s>(
    structure: &'s CondensedStructure,
    settings: &BranchSettings,
    start: &Grazing,
) -> Result<MixedShooting<'s>, StudyError> {
    let solver = solver_by_name(&settings.contact_solver)?;
    let own = MixedShootingSettings {
        harmonics: settings.harmonics,
        symmetry: settings.symmetry,
        switching: settings.switching,
    };
    Ok(MixedShooting::new(structure, own, start.scales(), solver.as_ref())?)
}

pub(super) fn continuation(
    settings: &BranchSettings,
    start: &Grazing,
    problem: &MixedShooting,
    dim: usize,
) -> Continuation {
    let frequency = problem.frequency_index();
    let max = settings.max_energy_ratio.map_or(f64::INFINITY, f64::ln);
    let mut bounds = vec![Bound { coordinate: dim, min: MIN_ENERGY_RATIO.ln(), max }];
    if let Some([low, high]) = settings.frequency_hz {
        let scaled = |hz: f64| hz * TAU / start.omega;
        bounds.push(Bound { coordinate: frequency, min: scaled(low), max: scaled(high) });
    }
    Continuation { step: settings.step.clone(), bounds, watched: vec![frequency], max_points: usize::MAX }
}

fn label(settings: &BranchSettings, coordinates: ContactCoordinates) -> String {
    if !settings.label.is_empty() {
        return settings.label.clone();
    }
    let plural = if settings.harmonics == 1 { "" } else { "s" };
    let sampled = match settings.switching {
        Switching::Exact => String::new(),
        Switching::Sampled { samples } => format!(", {samples} samples"),
    };
    let method = match coordinates {
        ContactCoordinates::Nodes => "MS-HBM",
        ContactCoordinates::SpringTips => "HBM",
    };
    format!("{method}, {} harmonic{plural}{sampled}", settings.harmonics)
}

fn branch_end(
    stop: &StopReason,
    frequency: usize,
    dim: usize,
    start: &Grazing,
    settings: &BranchSettings,
    n_points: usize,
) -> BranchEnd {
    let (reason, message, complete) = match stop {
        StopReason::Bound { coordinate, value } if *coordinate == dim && *value > 0.0 => {
            ("max-energy", format!("the energy reached {:.6} times that at grazing", value.exp()), true)
        }
        StopReason::Bound { coordinate, value } if *coordinate == dim => {
            ("min-energy", format!("the energy fell to {:.1e} of that at grazing", value.exp()), true)
        }
        StopReason::Bound { coordinate, value } if *coordinate == frequency => {
            ("frequency-window", format!("the frequency reached {:.6} Hz", value * start.omega / TAU), true)
        }
        StopReason::Bound { coordinate, value } => ("bound", format!("unknown {coordinate} reached {value}"), true),
        StopReason::Closed => ("closed", "the branch came back to where it began".to_owned(), true),
        StopReason::Stopped if n_points < settings.max_points => ("stopped", "it was asked to stop".to_owned(), false),
        StopReason::Stopped | StopReason::MaxPoints => {
            ("max-points", format!("the limit of {} points was reached", settings.max_points), false)
        }
        StopReason::StepTooSmall { step, refusal } => {
            ("no-step", format!("no step, down to {step:.1e}, could be shown to stay on the branch: {refusal}"), false)
        }
        _ => ("unknown", format!("{stop:?}"), false),
    };
    BranchEnd { reason: reason.to_owned(), message, complete }
}
