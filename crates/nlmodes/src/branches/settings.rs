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

/// How the number of harmonics grows along a branch that is to reach an [`Accuracy`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GrowthSettings {
    /// Share of the permitted error that the harmonics may cause; the rest is for the held modes. Default 0.7: held
    /// modes are chosen once, harmonics time and again.
    pub share: f64,
    /// Share of the permitted error at which a new number of harmonics aims. Default 0.25, so that the next change is
    /// some points away.
    pub aim: f64,
    /// Order of convergence by which a new number is chosen. Default 5, as measured
    /// (`benchmarks/results/accuracy.md`).
    pub order: f64,
    /// A number of harmonics and its relative error, from which the first number is extrapolated. Default 5 and 5.6e-6,
    /// of the two-element rod.
    pub known: (f64, f64),
    /// Largest growth of the number at once. Default 1.6: the estimates of few harmonics say little about many.
    pub most: f64,
    /// Points for which the number stays where more did not lead on. Default 8, about the side of an
    /// internal-resonance branch.
    pub stay: usize,
    /// Points that are gone back where no solution with more harmonics is found. Default 1, 3, 6 and 10: next to an
    /// internal resonance branches with different numbers of harmonics lie further apart than some points before it.
    /// Without going back, the rod of 100 elements with an accuracy of 1e-3 has 21 points of 198 beyond that, and 1 of
    /// 199 with it.
    pub back: [usize; 4],
    /// Smallest cosine between the tangents with the old and the new number. Default 0.9, 26°.
    pub same_way: f64,
    /// Largest change of the unknowns with the number, over the estimated one: a solution further away is another one.
    /// Default 2.
    pub off: f64,
}

impl Default for GrowthSettings {
    fn default() -> Self {
        Self {
            share: 0.7,
            aim: 0.25,
            order: 5.0,
            known: (5.0, 5.6e-6),
            most: 1.6,
            stay: 8,
            back: [1, 3, 6, 10],
            same_way: 0.9,
            off: 2.0,
        }
    }
}

/// How the backbone is sought behind an internal-resonance branch that is skipped.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SkipSettings {
    /// Share of the kinetic energy in the resonant harmonic at the base point, where the branch beside it has less than
    /// half of that. Default 0.05.
    pub base_share: f64,
    /// First relative distance in frequency behind the base point at which the backbone is sought. Default 2e-4, less
    /// than narrow resonances are apart.
    pub first: f64,
    /// Factor by which the distance grows. Default 1.6.
    pub growth: f64,
    /// Largest growth of the distance at once: an absolute one, or a share of the distance where that is more. Default
    /// 2e-3 and 0.1, so that no backbone between two resonances is passed over.
    pub further: (f64, f64),
    /// Largest such distance. Default 0.2.
    pub furthest: f64,
    /// Relative difference in frequency and energy below which two base points are one. Default 1e-6.
    pub same: f64,
}

impl Default for SkipSettings {
    fn default() -> Self {
        Self { base_share: 0.05, first: 2e-4, growth: 1.6, further: (2e-3, 0.1), furthest: 0.2, same: 1e-6 }
    }
}

/// How the stability of points in harmonics is found, by the exact motions beside them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BesideSettings {
    /// Contacts up to which [`StabilityRule::Auto`] seeks it. Default 16, beside which exact motions are cheap.
    pub most_contacts: usize,
    /// Distance in scaled unknowns, over their length, up to which an exact motion counts as that of a point. Default
    /// 0.1.
    pub near: f64,
    /// The same of the fundamentals of the first contact, over that of the point. Default 1e-2.
    pub same_fundamental: f64,
    /// Length of the step, in scaled unknowns, within which a change of stability is located. Default 1e-7.
    pub located: f64,
    /// Halvings of the step that this may take. Default 40.
    pub halvings: usize,
}

impl Default for BesideSettings {
    fn default() -> Self {
        Self { most_contacts: 16, near: 0.1, same_fundamental: 1e-2, located: 1e-7, halvings: 40 }
    }
}

/// How many held modes are used where neither [`BranchSettings::held_modes`] nor an accuracy tells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct HeldModesSettings {
    /// Degrees of freedom without contact up to which all modes are used. Default 400, which take less than a second.
    pub all_up_to: usize,
    /// Most modes that are computed at first where not all are: how far they reach tells how many it takes. Default 64.
    pub most_at_first: usize,
    /// Of so many modes of a beam at least one moves a contact: the others are held apart by its direction. Default 3.
    pub hidden: usize,
}

impl Default for HeldModesSettings {
    fn default() -> Self {
        Self { all_up_to: 400, most_at_first: 64, hidden: 3 }
    }
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
    /// How the number of harmonics grows for that accuracy.
    pub growth: GrowthSettings,
    /// Which motions are admitted. Default even in time.
    pub symmetry: Symmetry,
    /// How the instants of contact are treated. Default exact.
    pub switching: Switching,
    /// Name of the contact solver. Default `active-set`.
    pub contact_solver: String,
    /// Number of modes of the held structure; chosen from the size and the highest harmonic where `None`.
    pub held_modes: Option<usize>,
    /// How many these are then.
    pub held: HeldModesSettings,
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
    /// How the backbone is sought behind those that are not.
    pub skip: SkipSettings,
    /// For which points Floquet multipliers are computed. Default where that is cheap.
    pub stability: StabilityRule,
    /// Modes of a structure up to which [`StabilityRule::Auto`] finds the multipliers of motions in harmonics: with
    /// these they cost no more than the motions themselves. Default 16.
    pub stability_modes: usize,
    /// How those of motions in harmonics are found.
    pub beside: BesideSettings,
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
            growth: GrowthSettings::default(),
            symmetry: Symmetry::Even,
            switching: Switching::Exact,
            contact_solver: "active-set".to_owned(),
            held_modes: None,
            held: HeldModesSettings::default(),
            max_energy_ratio: None,
            reference_energy: 1.0,
            frequency_hz: None,
            start: BranchStart::Grazing,
            at_branch_point: BranchPointRule::Stay,
            max_branches: 20,
            internal_resonance: ResonanceRule::Auto,
            skip: SkipSettings::default(),
            stability: StabilityRule::Auto,
            stability_modes: 16,
            beside: BesideSettings::default(),
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
