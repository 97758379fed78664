use nlmodes_continuation::StepSettings;
use nlmodes_hbm::{Switching, Symmetry};

use super::{Accuracy, Watch};

/// Where a branch begins, and which way it goes.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum BranchStart {
    /// At the linear mode that just touches a stop, toward higher energy.
    #[default]
    Grazing,
    /// On the backbone at a frequency.
    Frequency {
        /// The frequency, Hz.
        hz: f64,
        /// Toward higher frequencies; else toward lower ones.
        upward: bool,
    },
    /// On the backbone at an energy.
    Energy {
        /// Averaged kinetic energy over that at grazing, more than one.
        ratio: f64,
        /// Toward higher energies; else toward lower ones.
        upward: bool,
    },
}

/// Which half-branch is followed at a branch point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum BranchPointRule {
    /// The branch's own, through the point.
    #[default]
    Stay,
    /// Another: that along which the energy grows most.
    Switch,
    /// All of them, each as a branch of its own, in [`super::compute_tree`].
    All,
}

/// What is done where an internal resonance leads a branch away from the backbone.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ResonanceRule {
    /// [`Self::Skip`] for a branch in harmonics that stays on its own half-branch at branch points, else
    /// [`Self::Follow`].
    #[default]
    Auto,
    /// The branch follows an internal resonance to wherever it leads.
    Follow,
    /// The branch is the backbone: it leaves out the branch of an internal resonance and goes on behind it. Where no
    /// backbone is found behind one, that one is followed. Not together with [`BranchPointRule::All`].
    Skip,
}

/// How the periodic motions are computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum BranchMethod {
    /// In harmonics: MS-HBM, or conventional HBM for a model with spring tips.
    #[default]
    HarmonicBalance,
    /// Exactly, by shooting; motions that are even in time only.
    Shooting,
}

/// For which points Floquet multipliers are computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum StabilityRule {
    /// For all points of shooting, and for those in harmonics of structures of up to 16 modes.
    #[default]
    Auto,
    /// For all points; of structures with more than 200 modes by the lowest ones.
    Always,
    /// For none.
    Never,
}

/// What is computed, and how far.
#[derive(Debug, Clone, PartialEq)]
pub struct BranchSettings {
    /// Name of the branch in legends; made from the method where empty.
    pub label: String,
    /// How the periodic motions are computed. Default harmonic balance.
    pub method: BranchMethod,
    /// Number of the linear mode, from 1. Default 1.
    pub mode: usize,
    /// Highest harmonic `N_h`; with shooting, up to which the coefficients of the exact motion are given. Default 5.
    pub harmonics: usize,
    /// Accuracy by which harmonics are chosen along the branch, with `harmonics` of them at least, and held modes; for
    /// harmonic balance with exact switching, and not together with [`BranchPointRule::All`], whose branches keep the
    /// harmonics with which they begin. Default none: `harmonics` holds.
    pub accuracy: Option<Accuracy>,
    /// Which motions are admitted. Default even in time.
    pub symmetry: Symmetry,
    /// How the instants of contact are treated. Default exact.
    pub switching: Switching,
    /// Name of the contact solver. Default `active-set`.
    pub contact_solver: String,
    /// Number of modes of the held structure; chosen from the size and the highest harmonic where `None`.
    pub held_modes: Option<usize>,
    /// Averaged kinetic energy over that at grazing at which the branch ends. Default none.
    pub max_energy_ratio: Option<f64>,
    /// Averaged kinetic energy, J, that takes the place of that at grazing where nothing else gives one: the first
    /// contacts touch at rest, and there are no others. Default 1 J.
    pub reference_energy: f64,
    /// Frequency window, Hz, outside of which the branch ends. Default none.
    pub frequency_hz: Option<[f64; 2]>,
    /// Where it begins. Default grazing.
    pub start: BranchStart,
    /// Which half-branch is followed at a branch point. Default its own.
    pub at_branch_point: BranchPointRule,
    /// Most branches of a tree. Default 20.
    pub max_branches: usize,
    /// Whether the branches of internal resonances are followed. Default [`ResonanceRule::Auto`].
    pub internal_resonance: ResonanceRule,
    /// For which points Floquet multipliers are computed. Default where that is cheap.
    pub stability: StabilityRule,
    /// Modes of a structure up to which [`StabilityRule::Auto`] finds the multipliers of motions in harmonics: with
    /// these they cost no more than the motions themselves. Default 16.
    pub stability_modes: usize,
    /// Wall time for the stability of points in harmonics, s: of what comes after it none is computed, which the end of
    /// the branch tells. Default three times that of the branch, and ten seconds at least.
    pub stability_budget_s: Option<f64>,
    /// Most points, of all branches together. Default 5000.
    pub max_points: usize,
    /// Steps of the continuation.
    pub step: StepSettings,
    /// Who looks on and may end the computation. Default nobody.
    pub watch: Watch,
}

impl Default for BranchSettings {
    fn default() -> Self {
        Self {
            label: String::new(),
            method: BranchMethod::HarmonicBalance,
            mode: 1,
            harmonics: 5,
            accuracy: None,
            symmetry: Symmetry::Even,
            switching: Switching::Exact,
            contact_solver: "active-set".to_owned(),
            held_modes: None,
            max_energy_ratio: None,
            reference_energy: 1.0,
            frequency_hz: None,
            start: BranchStart::Grazing,
            at_branch_point: BranchPointRule::Stay,
            max_branches: 20,
            internal_resonance: ResonanceRule::Auto,
            stability: StabilityRule::Auto,
            stability_modes: 16,
            stability_budget_s: None,
            max_points: 5000,
            step: StepSettings::default(),
            watch: Watch::default(),
        }
    }
}

impl BranchSettings {
    /// Whether the branches of internal resonances are left out.
    pub(super) fn skips_internal_resonances(&self) -> bool {
        match self.internal_resonance {
            ResonanceRule::Auto => {
                self.method == BranchMethod::HarmonicBalance && self.at_branch_point == BranchPointRule::Stay
            }
            ResonanceRule::Follow => false,
            ResonanceRule::Skip => self.at_branch_point != BranchPointRule::All,
        }
    }
}
