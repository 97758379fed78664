use std::sync::Arc;

use nlmodes_contact::LcpSolver;

use super::block::LinearResponse;
use super::closing_equations::{AtZero, ClosingEquation, EnergyGiven, PhaseCondition, PhaseLag};
use super::contact_response::ContactResponse;
use super::directions::Directions;
use super::load::Load;
use super::modal_response::ModalResponse;
use super::operating_point::{Closing, Source};
use super::structure::ModalStructure;
use super::system::{PeriodicSettings, PeriodicSystem};
use crate::error::agrees;
use crate::{HbmError, Scales, Symmetry};

/// The unknowns that represent the linear structure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Coordinates {
    /// Motions of the contacts where these are fewer than the modes, no modes are coupled and no two of them can be
    /// resonant at once; else modes.
    #[default]
    Automatic,
    /// Motions of the contacts: c × (2 N_h + 1) unknowns. Where damping couples modes, these are taken nevertheless.
    Contact,
    /// Modal coordinates: m × (2 N_h + 1) unknowns.
    Modal,
}

/// Relative distance of squared frequencies below which two modes can be resonant at once.
const REPEATED: f64 = 1e-5;

/// Up to so many directions the motions of the contacts of a conservative mode are its unknowns, not its modes.
const FEW_DIRECTIONS: usize = 8;

impl Coordinates {
    /// Motions of the contacts where these have few directions, else modes: what takes less time of conservative modes.
    pub(crate) fn of_few_contacts(structure: &ModalStructure) -> Self {
        let is_few = Directions::of(structure).first.len() <= FEW_DIRECTIONS && is_small_and_plain(structure);
        if is_few { Self::Contact } else { Self::Modal }
    }

    pub(crate) fn response(self, structure: &Arc<ModalStructure>, even: bool) -> Box<dyn LinearResponse + Send> {
        // Displacements of laws are coordinates beside those of contacts.
        let contact = !structure.laws().is_empty()
            || structure.damping().is_diagonal()
                && match self {
                    Self::Automatic => is_small_and_plain(structure),
                    Self::Contact => true,
                    Self::Modal => false,
                };
        if contact {
            Box::new(ContactResponse::new(structure.clone(), even))
        } else {
            Box::new(ModalResponse::new(structure.clone()))
        }
    }
}

/// Whether contact coordinates are fewer, free of each other, and no two modes can be resonant at once.
fn is_small_and_plain(structure: &ModalStructure) -> bool {
    let directions = Directions::of(structure);
    let few = directions.first.len() <= structure.n_modes();
    few && directions.are_independent(structure) && !has_repeated(structure)
}

/// Whether two modes that move contacts have the same frequency, or are both rigid-body motions.
fn has_repeated(structure: &ModalStructure) -> bool {
    // Stops that dissipate have no resonance.
    let moving = (0..structure.n_moving()).filter(|&k| structure.moves_a_contact(k));
    let mut squares: Vec<f64> = moving.map(|k| structure.omega_squared()[k]).collect();
    squares.sort_by(f64::total_cmp);
    let largest = squares.last().copied().unwrap_or(0.0);
    squares.windows(2).any(|w| w[1] - w[0] <= REPEATED * w[1].abs().max(REPEATED * REPEATED * largest))
}

impl PeriodicSystem {
    /// The conservative nonlinear mode of the structure without its damping: parameter `p = ln(E_av/E_ref)`, unknown ω,
    /// and with [`Symmetry::None`] also ξ, which unfolds the free phase and vanishes on solutions.
    ///
    /// # Errors
    /// [`HbmError::Harmonics`], [`HbmError::Samples`], or what the contact solver has against the compliance.
    pub fn conservative_mode(
        structure: &ModalStructure,
        symmetry: Symmetry,
        settings: PeriodicSettings,
        scales: Scales,
        solver: &dyn LcpSolver,
    ) -> Result<Self, HbmError> {
        let undamped = Arc::new(structure.conservative()?);
        let closing = conservative(symmetry, scales);
        let load = Load::none(&undamped);
        Self::assemble(undamped, load, closing, (settings, symmetry), scales, solver)
    }

    /// The damped nonlinear mode (extended periodic motion concept, Krack 2015): `M q̈ + (C − ξ M) q̇ + K q = W λ`,
    /// parameter `p = ln(E_av/E_ref)`, unknowns ω and ξ. The damping ratio is `D = ξ/(2ω)`, and `ξ = P_diss/(2 E_av)`.
    ///
    /// # Errors
    /// As [`conservative_mode`](Self::conservative_mode).
    pub fn damped_mode(
        structure: &ModalStructure,
        settings: PeriodicSettings,
        scales: Scales,
        solver: &dyn LcpSolver,
    ) -> Result<Self, HbmError> {
        let closing = free_motion(scales, vec![Box::new(energy(scales)), Box::<PhaseCondition>::default()]);
        let parts = (Arc::new(structure.clone()), Load::none(structure));
        Self::assemble(parts.0, parts.1, closing, (settings, Symmetry::None), scales, solver)
    }

    /// The response to a load of the given level over the base frequency: the parameter is ω in units of `unit`
    /// (rad/s).
    ///
    /// # Errors
    /// As [`conservative_mode`](Self::conservative_mode), and [`HbmError::LoadBeyond`].
    pub fn frequency_response(
        structure: &ModalStructure,
        load: Load,
        level: f64,
        unit: f64,
        settings: PeriodicSettings,
        scales: Scales,
        solver: &dyn LcpSolver,
    ) -> Result<Self, HbmError> {
        let closing = Closing {
            omega: Source::Parameter { scale: unit },
            xi: Source::Fixed(0.0),
            level: Source::Fixed(level),
            equations: Vec::new(),
        };
        let structure = Arc::new(structure.clone());
        Self::assemble(structure, load, closing, (settings, Symmetry::None), scales, solver)
    }

    /// The response at the base frequency `omega` (rad/s) over the level of the load: the parameter is the level in
    /// units of `unit`. At the level zero the structure rests, all unknowns zero where its gaps are open.
    ///
    /// # Errors
    /// As [`frequency_response`](Self::frequency_response).
    pub fn force_response(
        structure: &ModalStructure,
        load: Load,
        omega: f64,
        unit: f64,
        settings: PeriodicSettings,
        scales: Scales,
        solver: &dyn LcpSolver,
    ) -> Result<Self, HbmError> {
        let closing = Closing {
            omega: Source::Fixed(omega),
            xi: Source::Fixed(0.0),
            level: Source::Parameter { scale: unit },
            equations: Vec::new(),
        };
        let structure = Arc::new(structure.clone());
        Self::assemble(structure, load, closing, (settings, Symmetry::None), scales, solver)
    }

    /// Motions whose drive point lags the load by a given angle, what a phase-locked loop holds: the parameter is
    /// `ln(level/reference)`, the unknown ω.
    ///
    /// # Errors
    /// As [`frequency_response`](Self::frequency_response), and [`HbmError::Size`] for a drive point of another
    /// structure.
    pub fn phase_resonance(
        structure: &ModalStructure,
        load: Load,
        drive: PhaseLag,
        reference: f64,
        settings: PeriodicSettings,
        scales: Scales,
        solver: &dyn LcpSolver,
    ) -> Result<Self, HbmError> {
        agrees("modes of the drive point", structure.n_modes(), drive.row.modes.len())?;
        agrees("contacts and laws of the drive point", structure.n_places(), drive.row.contacts.len())?;
        if drive.harmonic == 0 || drive.harmonic > settings.harmonics {
            return Err(HbmError::LoadBeyond { load: drive.harmonic, harmonics: settings.harmonics });
        }
        let closing = Closing {
            omega: Source::Unknown { index: 0, scale: scales.omega },
            xi: Source::Fixed(0.0),
            level: Source::LogParameter { reference },
            equations: vec![Box::new(drive)],
        };
        let structure = Arc::new(structure.clone());
        Self::assemble(structure, load, closing, (settings, Symmetry::None), scales, solver)
    }

    /// A response over the level, beside its own damping with `c` (1/s) times the mass.
    pub fn damped_more(mut self, c: f64) -> Self {
        self.closing.xi = Source::Fixed(-c);
        self
    }

    /// A response over the level at this level, the new parameter being damping beside its own, of `c` (1/s) times the
    /// mass: with much of it there is one motion alone, and the way from there to none ends at the level in a motion
    /// with its own damping, however many others the structure has.
    pub fn over_damping(self, level: f64, c: f64) -> Self {
        let mut held = self.at_level(level);
        held.closing.xi = Source::Parameter { scale: -c };
        held
    }

    /// A response over the level at this level; a parameter is still to be given.
    pub fn at_level(mut self, level: f64) -> Self {
        self.closing.level = Source::Fixed(level);
        self
    }

    /// These equations at their own parameter zero with gaps that are opened by `opening` (m, c) times the square of
    /// the new parameter: the way to motions before contacts that touch at rest, from those before contacts that are
    /// set back.
    ///
    /// ```text
    /// R(x; g₀ + s² o) = 0 ,   E_av = E_ref ,   s from 1 to 0
    /// ```
    ///
    /// At a given energy a gap, made smaller, is an energy that grows at a given gap, without end: the solution with
    /// the gap zero is where the backbone of any gap leads. The square keeps stops that face each other apart where a
    /// step passes zero. At `s = 1` the unknowns of the linear mode ([`Grazing::unknowns`](crate::Grazing::unknowns))
    /// are a solution of a conservative mode; at `s = 0` a solution is one of the problem itself.
    ///
    /// # Errors
    /// [`HbmError::Size`] or [`HbmError::NotFinite`].
    pub fn beside_opening(mut self, opening: &[f64]) -> Result<Self, HbmError> {
        agrees("openings", self.structure.n_contacts(), opening.len())?;
        let level = self.closing.level.at(&[], 0.0);
        self.load = self.load.beside_opening(level, opening.to_vec())?;
        self.closing.level = Source::Square;
        let equations = self.closing.equations.into_iter();
        self.closing.equations = equations.map(|own| Box::new(AtZero(own)) as Box<dyn ClosingEquation>).collect();
        Ok(self)
    }
}

/// Frequency, and where the phase is free ξ, beside a condition for the energy.
fn conservative(symmetry: Symmetry, scales: Scales) -> Closing {
    let energy = Box::new(energy(scales));
    match symmetry {
        Symmetry::Even => Closing { xi: Source::Fixed(0.0), ..free_motion(scales, vec![energy]) },
        Symmetry::None => free_motion(scales, vec![energy, Box::<PhaseCondition>::default()]),
    }
}

fn energy(scales: Scales) -> EnergyGiven {
    EnergyGiven { reference: scales.energy }
}

fn free_motion(scales: Scales, equations: Vec<Box<dyn ClosingEquation>>) -> Closing {
    Closing {
        omega: Source::Unknown { index: 0, scale: scales.omega },
        xi: Source::Unknown { index: 1, scale: scales.omega },
        level: Source::Fixed(0.0),
        equations,
    }
}
