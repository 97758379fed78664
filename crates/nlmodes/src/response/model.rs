use std::sync::Arc;

use nlmodes_contact::solver_by_name;
use nlmodes_hbm::{
    DampedStop, ForceLaw, Grazing, HbmError, LawAtRest, Load, LoadTerm, ModalStructure, ModeStart, PhaseLag, PlacedLaw,
    ResponseRow, UNIT_ENERGY, about_rest, about_rest_of_law, laws_at_rest, modal_grazing_opened, modal_start,
};
use nlmodes_model::reduction::{OpenModes, RestState};
use num_complex::Complex64;

use crate::response::error::{holds, positive};
use crate::response::{BaseMotion, BaseUnit, Damping, Dashpot, ResponseError, ResponseSettings};

/// A displacement as a sum of degrees of freedom with weights: a node in a direction, or a place between nodes.
pub type Weights = Vec<(usize, f64)>;

/// Gap at rest over the largest one up to which a contact touches.
const TOUCHES: f64 = 1e-12;

/// A force of a load.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ForceAt {
    pub weights: Weights,
    pub amplitude: f64,
    pub harmonic: usize,
    pub phase: f64,
}

/// A structure in open modes with damping, a load of level one, and a drive point.
#[derive(Debug, Clone)]
pub struct ResponseModel {
    open: OpenModes,
    structure: ModalStructure,
    terms: Vec<LoadTerm>,
    /// What each term moves statically, beyond the modes, n.
    residuals: Vec<Vec<Complex64>>,
    forces: Vec<ForceAt>,
    drive: Option<Weights>,
    laws: Vec<LawAt>,
    mode_start: ModeStart,
    damping: Damping,
    dashpots: Vec<Dashpot>,
}

/// A law at its place.
#[derive(Debug, Clone)]
struct LawAt {
    weights: Weights,
    placed: PlacedLaw,
    /// What a unit force at its place moves beyond the modes, n, m/N.
    residual: Vec<f64>,
}

/// What laws of force do to a structure that rests under static loads, beside what these do without laws.
#[derive(Debug, Clone, PartialEq)]
pub struct HeldByLaws {
    /// Displacement of each degree of freedom, n, m.
    pub displacement: Vec<f64>,
    /// The same in the modes, m·√kg.
    pub modal: Vec<f64>,
    /// By how much that opens the gaps, c, m.
    pub opening: Vec<f64>,
    /// Where the laws rest, in their order.
    pub laws: Vec<LawAtRest>,
    /// The structure there, its contacts closed that press.
    pub rest: RestState,
}

impl ResponseModel {
    /// A damped structure without a load.
    ///
    /// # Errors
    /// [`ResponseError::Problem`] where a rigid stop meets a contact without flexibility.
    pub fn new(open: OpenModes, damping: &Damping) -> Result<Self, ResponseError> {
        let structure = ModalStructure::of_open(&open, damping.modal(open.omega_squared()))?;
        Ok(Self {
            open,
            structure,
            terms: Vec::new(),
            residuals: Vec::new(),
            forces: Vec::new(),
            drive: None,
            laws: Vec::new(),
            mode_start: ModeStart::default(),
            damping: damping.clone(),
            dashpots: Vec::new(),
        })
    }

    /// Adds dashpots to the ground; the modes are then coupled.
    ///
    /// # Errors
    /// [`ResponseError::NoSuchDof`] or [`ResponseError::Setting`] for one that is negative.
    pub fn add_dashpots(&mut self, dashpots: &[Dashpot]) -> Result<(), ResponseError> {
        let mut rows = Vec::new();
        for dashpot in dashpots {
            self.check_weights(&dashpot.at)?;
            let value = dashpot.damping;
            holds("the constant of a dashpot (N s/m)", value, "a number that is not negative", |c| c >= 0.0)?;
            rows.push((self.shape_at(&dashpot.at), value));
        }
        let damping = self.structure.damping().clone().with_dashpots(&rows);
        self.structure = self.structure.with_damping(damping)?;
        self.dashpots.extend_from_slice(dashpots);
        Ok(())
    }

    /// What a dashpot moves at its place beyond the modes: `c wᵀ(K⁻¹ − Φ Ω⁻² Φᵀ)w` (s), times a frequency the share of
    /// its own displacement that the equations leave out, in which dashpots act on modes alone. At a contact node
    /// without mass it stays, however many modes are taken.
    ///
    /// # Errors
    /// [`ResponseError::NoSuchDof`], or what the reduction reports.
    pub fn beyond_modes(&self, dashpot: &Dashpot) -> Result<f64, ResponseError> {
        self.check_weights(&dashpot.at)?;
        let mut unit = vec![0.0; self.open.n_dofs()];
        dashpot.at.iter().for_each(|&(dof, w)| unit[dof] += w);
        let residual = self.open.load(&unit)?.residual;
        Ok(dashpot.damping * dashpot.at.iter().map(|&(dof, w)| w * residual[dof]).sum::<f64>())
    }

    /// Adds a spring or damper with a law of force between the place of these weights and the ground, or, with weights
    /// of two places, between them. Laws that are no polynomials are evaluated at `samples` instants of a period.
    ///
    /// # Errors
    /// [`ResponseError::NoSuchDof`], or what the reduction reports.
    pub fn add_law(&mut self, weights: &Weights, law: Arc<dyn ForceLaw>, samples: usize) -> Result<(), ResponseError> {
        self.check_weights(weights)?;
        let mut unit = vec![0.0; self.open.n_dofs()];
        weights.iter().for_each(|&(dof, w)| unit[dof] += w);
        let load = self.open.load(&unit)?;
        let placed = PlacedLaw { law, modes: self.padded(load.modal), contacts: load.gaps, laws: Vec::new() };
        self.laws.push(LawAt { weights: weights.clone(), placed, residual: load.residual });
        self.place_laws(samples)
    }

    fn place_laws(&mut self, samples: usize) -> Result<(), ResponseError> {
        let placed = |of: &LawAt| {
            let among = self.laws.iter().map(|other| moved(&of.weights, &other.residual)).collect();
            PlacedLaw { laws: among, ..of.placed.clone() }
        };
        self.structure = self.structure.with_laws(self.laws.iter().map(placed).collect(), samples)?;
        Ok(())
    }

    /// Counts motions from where the structure would be with its contacts open under static loads, which move the
    /// places of its laws by `moved` (m) without these, and the forces that its laws have at rest: laws are then what
    /// they have beyond these, and gaps what is left of them. What the laws do at rest. Laws are evaluated as by
    /// [`add_law`](Self::add_law).
    ///
    /// # Errors
    /// As [`laws_at_rest`], or what the reduction reports of the structure at rest.
    pub fn rest_on_laws(&mut self, moved: &[f64], samples: usize) -> Result<HeldByLaws, ResponseError> {
        let laws = laws_at_rest(&self.structure, moved)?;
        let (m, squares) = (self.open.n_modes(), self.open.omega_squared());
        let push = |r: usize| -> f64 {
            self.laws.iter().zip(&laws).map(|(law, at)| -law.placed.modes[r] * at.force).sum::<f64>()
        };
        let modal: Vec<f64> = (0..m).map(push).zip(squares).map(|(p, w)| if p == 0.0 { 0.0 } else { p / w }).collect();
        let by_modes = |of: &dyn Fn(usize) -> f64| modal.iter().enumerate().map(|(r, eta)| of(r) * eta).sum::<f64>();
        let beyond = |of: &dyn Fn(&LawAt) -> f64| -> f64 {
            self.laws.iter().zip(&laws).map(|(law, at)| -of(law) * at.force).sum()
        };
        let displacement = (0..self.open.n_dofs())
            .map(|dof| by_modes(&|r| self.open.shapes()[(dof, r)]) + beyond(&|law| law.residual[dof]))
            .collect();
        let rows = self.structure.rows();
        let opening: Vec<f64> = (0..self.structure.n_contacts())
            .map(|i| by_modes(&|r| rows[(i, r)]) + beyond(&|law| law.placed.contacts[i]))
            .collect();
        let gaps: Vec<f64> = self.structure.gaps().iter().zip(&opening).map(|(gap, by)| gap + by).collect();
        self.structure = self.structure.with_gaps(gaps.clone())?;
        self.open = self.open.with_stops(gaps, self.open.stop_compliance().to_vec())?;
        let mut behind = Vec::new();
        for (own, at) in self.laws.iter_mut().zip(&laws) {
            let mut acting = about_rest_of_law(&own.placed.law, *at).into_iter();
            let placed = acting.next().map(|law| PlacedLaw { law, ..own.placed.clone() });
            own.placed = placed.unwrap_or_else(|| own.placed.clone());
            behind.extend(acting.map(|law| LawAt { placed: PlacedLaw { law, ..own.placed.clone() }, ..own.clone() }));
        }
        self.laws.extend(behind);
        self.place_laws(samples)?;
        let still = || RestState::still(m, self.structure.gaps());
        let rest = self.pressed_rest()?.unwrap_or_else(still);
        Ok(HeldByLaws { displacement, modal, opening, laws, rest })
    }

    /// Where nonlinear modes of a structure with laws begin.
    pub fn set_mode_start(&mut self, start: ModeStart) {
        self.mode_start = start;
    }

    /// Adds a force `level · amplitude · cos(harmonic Ωt + phase)` (N a unit of the level, rad) at a degree of freedom.
    ///
    /// # Errors
    /// [`ResponseError::NoSuchDof`], [`ResponseError::Setting`], or what the reduction reports.
    pub fn push_force(&mut self, dof: usize, amplitude: f64, harmonic: usize, phase: f64) -> Result<(), ResponseError> {
        self.push_force_at(&vec![(dof, 1.0)], amplitude, harmonic, phase)
    }

    /// As [`push_force`](Self::push_force), on several degrees of freedom with weights: in a direction, or between
    /// nodes.
    ///
    /// # Errors
    /// As [`push_force`](Self::push_force).
    pub fn push_force_at(
        &mut self,
        weights: &Weights,
        amplitude: f64,
        harmonic: usize,
        phase: f64,
    ) -> Result<(), ResponseError> {
        self.check_weights(weights)?;
        let mut force = vec![0.0; self.open.n_dofs()];
        weights.iter().for_each(|&(dof, w)| force[dof] += w * amplitude);
        self.push_distributed(&force, harmonic, phase)?;
        self.forces.push(ForceAt { weights: weights.clone(), amplitude, harmonic, phase });
        Ok(())
    }

    /// Adds a force with this distribution (n, N a unit of the level), `cos(harmonic Ωt + phase)` in time.
    ///
    /// # Errors
    /// [`ResponseError::Setting`] for the harmonic zero, or what the reduction reports.
    pub fn push_distributed(&mut self, force: &[f64], harmonic: usize, phase: f64) -> Result<(), ResponseError> {
        self.push_term(force, harmonic, Complex64::cis(phase), 0)
    }

    fn push_term(
        &mut self,
        force: &[f64],
        harmonic: usize,
        turn: Complex64,
        omega_power: i32,
    ) -> Result<(), ResponseError> {
        holds("the harmonic of a load", harmonic as f64, "1 or more", |n| n > 0.0 && turn.is_finite())?;
        let load = self.open.load(force)?;
        let turned = |values: &[f64]| values.iter().map(|v| turn * *v).collect::<Vec<_>>();
        self.terms.push(LoadTerm { harmonic, omega_power, modal: turned(&load.modal), gaps: turned(&load.gaps) });
        self.residuals.push(turned(&load.residual));
        Ok(())
    }

    /// Adds the motion of the base, with which the stops move, or past which they are fixed. Displacements are then
    /// relative to the base.
    ///
    /// # Errors
    /// [`ResponseError::Setting`] for sizes that do not agree, or what the reduction reports.
    pub fn push_base_motion(&mut self, base: &BaseMotion) -> Result<(), ResponseError> {
        let n = self.open.n_dofs();
        for found in [base.inertia.len(), base.rigid.len()] {
            let is_fine = |_| found == n;
            holds("entries of the base motion", found as f64, "one for each degree of freedom", is_fine)?;
        }
        // ü = −ν² u; the level multiplies the amplitude of one or the other, and u is a cosine with both.
        let (acceleration, displacement) = match base.unit {
            BaseUnit::Acceleration => ((-1.0, 0), (1.0, -2)),
            BaseUnit::Displacement => ((-1.0, 2), (1.0, 0)),
        };
        let force: Vec<f64> = base.inertia.iter().map(|m| -m * acceleration.0).collect();
        self.push_term(&force, 1, Complex64::ONE, acceleration.1)?;
        if base.stop_is_fixed {
            let columns = nlmodes_linalg::triplets(self.open.directions());
            let mut gaps = vec![Complex64::default(); self.open.n_contacts()];
            columns.for_each(|(dof, contact, w)| gaps[contact] += w * base.rigid[dof] * displacement.0);
            let modal = vec![Complex64::default(); self.open.n_modes()];
            self.terms.push(LoadTerm { harmonic: 1, omega_power: displacement.1, modal, gaps });
            self.residuals.push(vec![Complex64::default(); n]);
        }
        Ok(())
    }

    /// The degree of freedom whose displacement is reported, and has a lag at phase resonance.
    ///
    /// # Errors
    /// [`ResponseError::NoSuchDof`].
    pub fn set_drive(&mut self, dof: usize) -> Result<(), ResponseError> {
        self.set_drive_at(vec![(dof, 1.0)])
    }

    /// As [`set_drive`](Self::set_drive), a sum of degrees of freedom with weights.
    ///
    /// # Errors
    /// [`ResponseError::NoSuchDof`].
    pub fn set_drive_at(&mut self, weights: Weights) -> Result<(), ResponseError> {
        self.check_weights(&weights)?;
        self.drive = Some(weights);
        Ok(())
    }

    /// The same damped structure without its load.
    pub fn without_load(&self) -> Self {
        Self { terms: Vec::new(), residuals: Vec::new(), forces: Vec::new(), ..self.clone() }
    }

    /// The structure in open modes with its damping.
    pub fn structure(&self) -> &ModalStructure {
        &self.structure
    }

    /// The reduction.
    pub fn open_modes(&self) -> &OpenModes {
        &self.open
    }

    /// Puts a damper (N s/m) beside the spring of an elastic stop: `λ = k p + d ṗ ≥ 0` while it is touched by p, and it
    /// is left where that force vanishes. Until the next touch the stop comes back to its place by its own spring and
    /// damper. Conservative modes leave the damper out.
    ///
    /// # Errors
    /// [`ResponseError::Setting`] for a damper that is not a positive number or beside a rigid stop,
    /// [`ResponseError::Problem`] where the contact does not exist, has a damper already, or has no flexibility of its
    /// own: then it has mass, and a damper would make its force jump.
    pub fn add_stop_damper(&mut self, contact: usize, damper: f64) -> Result<(), ResponseError> {
        positive("the damper of a stop (N s/m)", damper)?;
        let compliance = self.structure.stop_compliance().get(contact).copied().unwrap_or(1.0);
        if compliance == 0.0 && self.structure.damped_stop(contact).is_none() {
            let (what, expected) =
                ("the compliance of a stop with a damper (m/N)", "an elastic stop: give its stiffness");
            return Err(ResponseError::Setting { what, value: compliance, expected });
        }
        let stop = DampedStop { contact, stiffness: 1.0 / compliance, damper };
        self.structure = self.structure.with_damped_stops(&[stop])?;
        Ok(())
    }

    /// The linear mode `mode` (from 1) at the amplitude at which its nonlinear modes begin: where it first touches a
    /// stop, or, about a rest at which stops press, where the first contact changes its state; beside laws where these
    /// hardly matter yet, or at the energy that was set. Contacts that touch at rest without force
    /// [are set back](Grazing::opening).
    ///
    /// # Errors
    /// As [`modal_grazing_opened`], [`about_rest`] and [`modal_start`], or what the reduction reports of the
    /// structure at rest.
    pub fn linear_start(&self, mode: usize) -> Result<Grazing, ResponseError> {
        let rest = self.pressed_rest()?;
        Ok(match &rest {
            _ if !self.laws.is_empty() => modal_start(&self.structure, rest.as_ref(), mode, self.mode_start)?,
            Some(rest) => about_rest(&self.open, &self.structure, rest, mode, UNIT_ENERGY)?,
            None => modal_grazing_opened(&self.structure, mode, UNIT_ENERGY)?,
        })
    }

    /// The contacts that touch at rest without force.
    ///
    /// # Errors
    /// What the reduction reports of the structure at rest.
    pub fn touching_at_rest(&self) -> Result<Vec<usize>, ResponseError> {
        let gaps = self.structure.gaps();
        let Some(rest) = self.pressed_rest()? else {
            return Ok((0..gaps.len()).filter(|i| gaps[*i] == 0.0).collect());
        };
        let largest = rest.gaps.iter().chain(gaps).fold(0.0_f64, |largest, gap| largest.max(gap.abs()));
        let touches = |i: &usize| !rest.closed[*i] && rest.gaps[*i].abs() <= TOUCHES * largest;
        Ok((0..gaps.len()).filter(touches).collect())
    }

    /// The same structure with these contacts standing back by so much, m.
    ///
    /// # Errors
    /// [`ResponseError::Problem`] for a length that is not finite, or what the reduction reports.
    pub(crate) fn opened(&self, contacts: &[usize], by: f64) -> Result<Self, ResponseError> {
        let mut gaps = self.structure.gaps().to_vec();
        contacts.iter().for_each(|&contact| gaps[contact] += by);
        let structure = self.structure.with_gaps(gaps.clone())?;
        let open = self.open.with_stops(gaps, self.open.stop_compliance().to_vec())?;
        Ok(Self { open, structure, ..self.clone() })
    }

    /// The state at rest of a structure that its stops press, or that a steady force presses onto them; `None` of one
    /// with open contacts.
    ///
    /// # Errors
    /// What the reduction reports of it.
    pub(crate) fn pressed_rest(&self) -> Result<Option<RestState>, ResponseError> {
        if !self.structure.is_pressed() {
            return Ok(None);
        }
        let solver = solver_by_name("active-set").map_err(HbmError::Compliance)?;
        Ok(Some(self.open.rest(&[], solver.as_ref())?))
    }

    /// Values of the modes, with zeros for the stops that dissipate behind them.
    pub(crate) fn padded<T: Default + Clone>(&self, mut modes: Vec<T>) -> Vec<T> {
        modes.resize(self.structure.n_modes(), T::default());
        modes
    }

    /// Displacement of a degree of freedom, with what the load moves statically.
    ///
    /// # Errors
    /// [`ResponseError::NoSuchDof`], or what the reduction reports.
    pub fn row(&self, dof: usize) -> Result<ResponseRow, ResponseError> {
        let mut rows = self.rows_of_dofs(&[dof])?;
        rows.pop().ok_or(ResponseError::NoSuchDof { found: dof, available: 0 })
    }

    /// Damping of the modes, and the dashpots beside it.
    pub(crate) fn damping(&self) -> (&Damping, &[Dashpot]) {
        (&self.damping, &self.dashpots)
    }

    pub(crate) fn drive_weights(&self) -> Option<&Weights> {
        self.drive.as_ref()
    }

    /// The terms of the load of level one.
    pub fn terms(&self) -> &[LoadTerm] {
        &self.terms
    }

    pub(crate) fn forces(&self) -> &[ForceAt] {
        &self.forces
    }

    /// What each term of the load moves statically, beyond the modes.
    pub(crate) fn residuals(&self) -> impl Iterator<Item = &[Complex64]> {
        self.residuals.iter().map(Vec::as_slice)
    }

    /// The load of level one, its harmonics counted in the base frequency of the motion.
    pub(crate) fn load(&self, settings: &ResponseSettings) -> Result<Load, ResponseError> {
        let still = |term: &LoadTerm| term.modal.iter().chain(&term.gaps).all(|v| *v == Complex64::default());
        if self.terms.iter().all(still) {
            return Err(ResponseError::NoLoad);
        }
        let s = settings.subharmonic;
        let in_base = |(term, residual): (&LoadTerm, &Vec<Complex64>)| {
            // A power of Ω as one of the base frequency ω = Ω/s.
            let factor = (s as f64).powi(term.omega_power);
            let scaled = |values: &[Complex64]| values.iter().map(|v| v * factor).collect();
            let of_law = |law: &LawAt| law.weights.iter().map(|&(dof, w)| residual[dof] * w).sum::<Complex64>();
            let places: Vec<Complex64> = term.gaps.iter().copied().chain(self.laws.iter().map(of_law)).collect();
            LoadTerm {
                harmonic: s * term.harmonic,
                omega_power: term.omega_power,
                modal: self.padded(scaled(&term.modal)),
                gaps: scaled(&places),
            }
        };
        Ok(Load::new(&self.structure, self.terms.iter().zip(&self.residuals).map(in_base).collect())?)
    }

    /// The same, without terms where nothing drives the structure.
    pub(crate) fn load_if_any(&self, settings: &ResponseSettings) -> Result<Load, ResponseError> {
        match self.terms.is_empty() {
            true => Ok(Load::new(&self.structure, Vec::new())?),
            false => self.load(settings),
        }
    }

    /// The drive point in its harmonic.
    pub(crate) fn drive(&self, settings: &ResponseSettings) -> Result<Option<PhaseLag>, ResponseError> {
        let Some(weights) = &self.drive else { return Ok(None) };
        let Some(mut row) = self.rows(std::slice::from_ref(weights))?.pop() else { return Ok(None) };
        let s = settings.subharmonic as f64;
        row.loads.iter_mut().zip(&self.terms).for_each(|(load, term)| *load *= s.powi(term.omega_power));
        Ok(Some(PhaseLag { row, harmonic: settings.subharmonic, lag: settings.lag }))
    }

    /// Residual flexibility between the laws and a place, m/N.
    pub(crate) fn moved_by_laws(&self, weights: &Weights) -> impl Iterator<Item = f64> {
        self.laws.iter().map(|law| moved(weights, &law.residual))
    }

    /// The weights of the place of a law; `None` if there is no such law.
    pub fn law_weights(&self, law: usize) -> Option<&Weights> {
        self.laws.get(law).map(|law| &law.weights)
    }

    pub(crate) fn shape_at(&self, weights: &Weights) -> Vec<f64> {
        let at = |k: usize| weights.iter().map(|&(dof, w)| w * self.open.shapes()[(dof, k)]).sum();
        self.padded((0..self.open.n_modes()).map(at).collect())
    }

    pub(crate) fn check_weights(&self, weights: &Weights) -> Result<(), ResponseError> {
        let available = self.open.n_dofs();
        match weights.iter().find(|(dof, _)| *dof >= available) {
            Some(&(found, _)) => Err(ResponseError::NoSuchDof { found, available }),
            None => Ok(()),
        }
    }
}

/// Displacement at a place.
fn moved(weights: &Weights, displacement: &[f64]) -> f64 {
    weights.iter().map(|&(dof, w)| w * displacement[dof]).sum()
}
