use std::sync::Arc;
use std::time::Duration;

use nlmodes_continuation::{ParametricSystem, StopReason};
use nlmodes_hbm::{CondensedStructure, Grazing, PeriodicSystem, Switching};
use nlmodes_modal::{BranchEnd, Coordinate, EndReason, ModalBranch, ModalPoint, TimeHistory, Tongue, tongues};
use nlmodes_model::ContactCoordinates;
use nlmodes_timestep::ModeShooting;

use super::beyond::{BeyondAccuracy, beyond};
use super::prepare::{exact, periodic, problem};
use super::trace::Tracer;
use super::{AccuracyReached, BranchError, BranchMethod, BranchSettings};
use crate::response::{curve_end, energy_bound, frequency_bound};

/// A branch with what is needed to look closer at its points.
#[derive(Debug)]
pub struct ComputedBranch {
    /// The points and why they end.
    pub branch: ModalBranch,
    /// The condensed structure.
    pub structure: Arc<CondensedStructure>,
    /// Where the nonlinear mode begins.
    pub grazing: Grazing,
    /// Where it leaves another branch of a [`super::ComputedTree`].
    pub origin: Option<BranchOrigin>,
    /// Scaled unknowns of each point.
    pub unknowns: Vec<Vec<f64>>,
    /// Largest unfolding parameter |δ| met; zero but for rounding, and `None` for motions that are even in time.
    pub largest_unfolding: Option<f64>,
    /// Evaluations of residual and Jacobian.
    pub evaluations: usize,
    /// Wall time for the stability of its points, once they had been found.
    pub stability_time: Duration,
    /// Iterations of the contact solver along the branches of the computation, over all contact problems, in the unit
    /// of that solver.
    pub contact_iterations: usize,
    /// Steps that were tried and refused.
    pub refused_steps: usize,
    /// What became of the accuracy that was asked for, if one was.
    pub accuracy: Option<AccuracyReached>,
    pub(super) settings: BranchSettings,
}

/// A point of another branch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub struct BranchOrigin {
    /// Number of that branch.
    pub branch: usize,
    /// Index of its point.
    pub point: usize,
}

/// What a computation tells while it goes on.
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub enum BranchProgress<'a> {
    /// A point was found.
    Found {
        /// Number of its branch; the first is 0.
        branch: usize,
        /// The point.
        point: &'a ModalPoint,
    },
    /// The last points of a branch lie on an internal-resonance branch that is skipped.
    Withdrawn {
        /// Number of the branch.
        branch: usize,
        /// Points that stay.
        kept: usize,
    },
}

impl<'a> BranchProgress<'a> {
    pub(super) fn of_first(point: &'a ModalPoint) -> Self {
        Self::Found { branch: 0, point }
    }
}

impl ComputedBranch {
    /// Whether branches of internal resonances were to be left out.
    pub fn skips_internal_resonances(&self) -> bool {
        self.settings.skips_internal_resonances()
    }

    /// Motion and force of contact `contact` over one period of point `point`.
    ///
    /// # Errors
    /// [`BranchError`] if the point cannot be evaluated again.
    ///
    /// # Panics
    /// If there is no such point or contact.
    pub fn time_history(
        &self,
        point: usize,
        contact: usize,
        samples: usize,
        label: &str,
    ) -> Result<TimeHistory, BranchError> {
        let mut problem = periodic(&self.structure, &self.settings_at(point), &self.grazing)?;
        Ok(problem.equidistant_histories(&self.unknowns[point], samples, label)?.swap_remove(contact))
    }

    /// This branch with `other`, which starts at the same point and goes the other way, before it: its points in
    /// reverse order, the common one once.
    pub fn preceded_by(mut self, other: ComputedBranch) -> Self {
        let mut points: Vec<ModalPoint> = other.branch.points.into_iter().skip(1).rev().collect();
        let mut unknowns: Vec<Vec<f64>> = other.unknowns.into_iter().skip(1).rev().collect();
        points.append(&mut self.branch.points);
        unknowns.append(&mut self.unknowns);
        (self.branch.points, self.unknowns) = (points, unknowns);
        let (first, last) = (other.branch.end, &self.branch.end);
        self.branch.end = BranchEnd {
            reasons: [first.reasons.as_slice(), &last.reasons].concat(),
            message: format!("one way, {}; the other way, {}", first.message, last.message),
            complete: first.complete && last.complete,
        };
        self.largest_unfolding = self.largest_unfolding.into_iter().chain(other.largest_unfolding).reduce(f64::max);
        self.evaluations += other.evaluations;
        self.stability_time += other.stability_time;
        self.contact_iterations += other.contact_iterations;
        self.refused_steps += other.refused_steps;
        if let (Some(own), Some(other)) = (&mut self.accuracy, other.accuracy) {
            own.changes += other.changes;
            own.largest_held_modes_estimate = own.largest_held_modes_estimate.max(other.largest_held_modes_estimate);
        }
        self.review_accuracy();
        self
    }

    /// The segments on which the accuracy that was asked for is not reached; none where none was asked for.
    pub fn beyond_accuracy(&self) -> Vec<BeyondAccuracy> {
        self.settings.accuracy.map_or_else(Vec::new, |wanted| beyond(&self.branch.points, wanted.error))
    }

    /// The internal-resonance branches that the branch follows.
    pub fn tongues(&self) -> Vec<Tongue> {
        tongues(&self.branch.points)
    }

    /// `ln E/E_g` of a point, the parameter of its equations.
    pub(super) fn energy_of(&self, point: usize) -> f64 {
        (self.branch.points[point].kinetic_energy / self.grazing.energy).ln()
    }

    /// The unknowns of a point with the parameter of its equations.
    pub(super) fn solution(&self, point: usize) -> Vec<f64> {
        self.unknowns[point].iter().copied().chain([self.energy_of(point)]).collect()
    }

    /// The settings with the harmonics of a point, which an accuracy has chosen.
    pub(super) fn settings_at(&self, point: usize) -> BranchSettings {
        self.settings_of(self.branch.points[point].coefficients.n_harmonics())
    }

    /// The settings with so many harmonics, where an accuracy has chosen them.
    pub(super) fn settings_of(&self, harmonics: usize) -> BranchSettings {
        let mut settings = self.settings.clone();
        if settings.accuracy.is_some() {
            settings.harmonics = harmonics;
        }
        settings
    }

    /// Counts the points of the branch, and names it by their harmonics, where an accuracy was asked for.
    pub(super) fn review_accuracy(&mut self) {
        let (Some(reached), Some(wanted)) = (&mut self.accuracy, self.settings.accuracy) else { return };
        let points = &self.branch.points;
        let estimates = || points.iter().filter_map(|p| p.error_estimate);
        reached.largest_estimate = estimates().fold(0.0, f64::max);
        reached.points_beyond = estimates().filter(|e| *e > wanted.error).count();
        let harmonics = || points.iter().map(|p| p.coefficients.n_harmonics());
        reached.harmonics = [harmonics().min().unwrap_or(0), harmonics().max().unwrap_or(0)];
        if self.origin.is_none() && self.settings.label.is_empty() {
            let [few, most] = reached.harmonics;
            let plain = plural(self.settings.harmonics);
            let range = if few == most { plural(few) } else { format!("{few} to {most} harmonics") };
            self.branch.label = self.branch.label.replacen(&plain, &range, 1);
        }
    }

    /// The periodic problem in harmonics with those of a point, to evaluate it again.
    ///
    /// # Errors
    /// [`BranchError::NotHarmonic`] for a branch by shooting; else as [`super::compute_branch`].
    ///
    /// # Panics
    /// If there is no such point.
    pub fn problem(&self, point: usize) -> Result<PeriodicSystem, BranchError> {
        match self.settings.method {
            BranchMethod::HarmonicBalance => problem(&self.structure, &self.settings_at(point), &self.grazing),
            BranchMethod::Shooting => Err(BranchError::NotHarmonic),
        }
    }

    /// Whether its motions are exact, by shooting.
    pub fn is_exact(&self) -> bool {
        self.settings.method == BranchMethod::Shooting
    }

    /// The exact problem, to evaluate points of a branch by shooting again; `None` for a branch in harmonics.
    ///
    /// # Errors
    /// [`BranchError`], as [`super::compute_branch`].
    pub fn exact(&self) -> Result<Option<ModeShooting>, BranchError> {
        match self.settings.method {
            BranchMethod::HarmonicBalance => Ok(None),
            BranchMethod::Shooting => exact(self.structure.model(), &self.settings, &self.grazing).map(Some),
        }
    }
}

/// The modal branch of these points.
pub(super) fn modal_branch(tracer: &Tracer, label: String, points: Vec<ModalPoint>, end: BranchEnd) -> ModalBranch {
    let model = tracer.structure.model();
    let first = model.contacts()[0];
    let recorded = tracer.structure.recorded_dofs().iter().map(|&dof| &model.dofs()[dof]);
    let coordinates = recorded.map(|d| Coordinate { position: d.position, kind: d.kind.name().to_owned() });
    ModalBranch {
        label,
        coordinates: coordinates.collect(),
        contact_coordinate: tracer.structure.recorded_index(first.dof),
        stop: Some(first.side.sign() * first.gap),
        points,
        end,
    }
}

/// Name of a branch in legends; `modes` are those of its structure that move a contact.
pub(super) fn label(settings: &BranchSettings, coordinates: ContactCoordinates, modes: usize) -> String {
    if !settings.label.is_empty() {
        return settings.label.clone();
    }
    if settings.method == BranchMethod::Shooting {
        return format!("shooting, {modes} mode{}", if modes == 1 { "" } else { "s" });
    }
    let sampled = match settings.switching {
        Switching::Exact => String::new(),
        Switching::Sampled { samples } => format!(", {samples} samples"),
    };
    let method = match coordinates {
        ContactCoordinates::Nodes => "MS-HBM",
        ContactCoordinates::SpringTips => "HBM",
    };
    format!("{method}, {}{sampled}", plural(settings.harmonics))
}

/// `1 harmonic`, `2 harmonics`, …
fn plural(harmonics: usize) -> String {
    format!("{harmonics} harmonic{}", if harmonics == 1 { "" } else { "s" })
}

/// Why a branch of so many points ended, in words.
pub(super) fn branch_end(stop: &StopReason, tracer: &Tracer, n_points: usize) -> BranchEnd {
    let (frequency, dim) = (tracer.problem.frequency_index(), tracer.problem.dim());
    let (start, settings) = (tracer.grazing, &tracer.settings);
    let reference = match start.touches_at_rest() {
        true => "the start",
        false if start.lifts_off => "lift-off",
        false => "grazing",
    };
    let stop = match stop {
        StopReason::Stopped if n_points >= settings.max_points => &StopReason::MaxPoints,
        stop => stop,
    };
    curve_end(stop, settings.max_points, |coordinate, value| {
        if coordinate == dim {
            energy_bound(value, reference)
        } else if coordinate == frequency {
            frequency_bound(value * start.omega)
        } else {
            (EndReason::Bound, format!("unknown {coordinate} reached {value}"))
        }
    })
}
