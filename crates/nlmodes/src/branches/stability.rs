//! Floquet multipliers of the points of a branch.

use std::ops::ControlFlow;

use nlmodes_continuation::{Budget, Continuation, Watched};
use nlmodes_hbm::Grazing;
use nlmodes_modal::{ModalPoint, Stability};
use nlmodes_model::MasslessContactModel;
use nlmodes_timestep::{GalerkinReduction, MAX_SHOOTING_MODES, ModeShooting};

use super::periodic::Periodic;
use super::{BranchMethod, BranchSettings, StabilityRule, Watch};

/// Contacts up to which multipliers are found unasked.
const FEW: usize = 16;

/// Distance in scaled unknowns, over their length, up to which an exact motion counts as that of a point in harmonics,
/// and that of the fundamentals of the first contact, over that of the point.
const NEAR: f64 = 0.1;
const SAME: f64 = 1e-2;

/// Finds the stability of points.
pub(super) enum Probe {
    /// Not asked for, or too expensive.
    Silent,
    /// The points are exact motions.
    Exact,
    /// The points are motions in harmonics, beside which an exact one is sought first.
    Beside(Box<Beside>),
}

/// The exact motions of a structure whose points are known in harmonics.
pub(super) struct Beside {
    shooting: ModeShooting,
    watch: Watch,
    budget: Budget,
    /// Guess at the last point of the branch, unknowns and parameter.
    last: Option<Vec<f64>>,
}

impl Probe {
    pub fn new(model: &MasslessContactModel, settings: &BranchSettings, grazing: &Grazing) -> Self {
        let most = match (settings.method, settings.stability) {
            (_, StabilityRule::Never) => return Self::Silent,
            (BranchMethod::Shooting, _) => return Self::Exact,
            (BranchMethod::HarmonicBalance, StabilityRule::Auto) => settings.stability_modes,
            (BranchMethod::HarmonicBalance, StabilityRule::Always) => MAX_SHOOTING_MODES,
        };
        let size = model.linear_dofs().len();
        let is_large = size > 4 * settings.stability_modes || model.contact_dofs().len() > FEW;
        if settings.stability == StabilityRule::Auto && is_large {
            return Self::Silent;
        }
        let reduced = GalerkinReduction::new(model.clone(), size.min(most)).ok();
        // A structure of more modes than are cheap is not to be judged by some of them unasked.
        let reduced = reduced.filter(|r| settings.stability == StabilityRule::Always || r.n_held_modes() == size);
        let shooting = reduced.and_then(|r| ModeShooting::new(r, grazing.omega, settings.harmonics).ok());
        shooting.map_or(Self::Silent, |shooting| {
            let (watch, budget) = (settings.watch.clone(), Budget::new(settings.stability_budget_s));
            Self::Beside(Box::new(Beside { shooting, watch, budget, last: None }))
        })
    }

    /// Stability of the point with the unknowns `x`; `None` where it is not asked for or could not be found.
    pub fn of(&mut self, viewer: &mut Periodic, x: &[f64], point: &ModalPoint) -> Option<Stability> {
        match self {
            Self::Exact => viewer.shooting()?.floquet(x).ok().map(|found| found.stability()),
            Self::Beside(beside) => beside.of(point),
            Self::Silent => None,
        }
    }

    /// Points whose stability was left out since the budget was used up.
    pub fn left_out(&self) -> usize {
        if let Self::Beside(beside) = self { beside.budget.left_out() } else { 0 }
    }

    /// The branch goes on from this point.
    pub fn accepted(&mut self, point: &ModalPoint) {
        if let Self::Beside(beside) = self {
            beside.last = beside.guess(point);
        }
    }
}

impl Beside {
    fn guess(&mut self, point: &ModalPoint) -> Option<Vec<f64>> {
        let (x, p) = self.shooting.unknowns(&point.coefficients, point.omega).ok()?;
        Some(x.into_iter().chain([p]).collect())
    }

    /// The multipliers of a motion that does not quite return mean nothing by themselves: those of the exact motion
    /// beside it are given, which is sought across the direction of the branch, so that folds do not matter.
    fn of(&mut self, point: &ModalPoint) -> Option<Stability> {
        let guess = self.guess(point)?;
        let (_, upward) = self.shooting.start();
        let along = self.last.as_ref().map(|last| guess.iter().zip(last).map(|(a, b)| a - b).collect::<Vec<f64>>());
        let along = along.filter(|d| length(d) > 1e-9 * length(&guess)).unwrap_or(upward);
        let (p, x) = guess.split_last()?;
        let method = Continuation { max_points: 1, ..Continuation::default() };
        let shooting = &mut self.shooting;
        self.budget.spend(&self.watch, |watch| {
            let mut watched = Watched { system: &mut *shooting, watch };
            let found = method.run(&mut watched, x, *p, &along, |_| ControlFlow::Continue(())).ok()?;
            let exact = found.points.into_iter().next()?;
            let gap: Vec<f64> = exact.z().iter().zip(&guess).map(|(a, b)| a - b).collect();
            if length(&gap) > NEAR * length(x) {
                return None;
            }
            let fundamental = shooting.fundamental(&exact.x).ok()?;
            if (fundamental - point.fundamental).abs() > SAME * point.fundamental.abs() {
                return None;
            }
            shooting.floquet(&exact.x).ok().map(|found| found.stability())
        })
    }
}

pub(super) fn length(z: &[f64]) -> f64 {
    z.iter().map(|z| z * z).sum::<f64>().sqrt()
}
