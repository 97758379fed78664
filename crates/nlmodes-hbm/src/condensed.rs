use nlmodes_contact::{LcpMatrix, LcpSolver, solver_by_name};
use nlmodes_linalg::{DenseLu, Mat, max_norm, multiply};
use nlmodes_modal::{HarmonicCoefficients, ModalPoint};
use nlmodes_model::reduction::{GalerkinReduction, OpenModes, ResponseRows, RestState};
use nlmodes_model::{ContactCoordinates, MasslessContactModel};
use num_complex::Complex64;

use crate::closed_set::ClosedSet;
use crate::error::agrees;
use crate::periodic::{
    Coordinates, ModalDamping, ModalStructure, OperatingPoint, PeriodicSettings, PeriodicSystem, Scales,
};
use crate::{Grazing, HbmError, Symmetry};

/// Most degrees of freedom of which modal points hold all coefficients.
///
/// A structure with more is recorded at evenly spaced nodes, half of that number, and at its contacts: a hundred
/// thousand degrees of freedom with five harmonics would else need 10 MB a point.
pub const MAX_RECORDED: usize = 4000;

/// Largest stiffness of a contact spring over the static stiffness of the structure behind it. The force is `k_c` times
/// a small difference of displacements, which has lost as many digits as this ratio has: with 1e9 Newton's method does
/// not settle to seven any more.
const STIFFEST: f64 = 5e8;

/// Contact force at rest, over the largest one, up to which a contact touches without force.
const ROUNDING: f64 = 1e-11;

/// A structure with massless contacts, reduced once to what the periodic problem needs: all its modes with open
/// contacts, [`OpenModes::all_of_massless`].
///
/// Of a structure with many degrees of freedom, fixed-interface modes and the residual of the static shapes are taken
/// first, [`GalerkinReduction`]: modes beyond the computed ones answer as springs with the mass of their static shape,
/// and what is left out falls with `ν⁴/λ³`.
///
/// A stop's own compliance is in series with `A`, on its diagonal alone. Where the massless coordinates are
/// the tips of contact springs ([`ContactCoordinates::SpringTips`]), the same equations are conventional harmonic
/// balance: the contact node moves in harmonics with its mass, and `A = diag(1/k_c)`.
#[derive(Debug, Clone)]
pub struct CondensedStructure {
    pub(crate) model: MasslessContactModel,
    /// Of the structure, or of its reduction.
    pub(crate) open: OpenModes,
    pub(crate) modal: ModalStructure,
    /// The same with what has no mass following at each instant, where it is not the same.
    static_part: Option<ModalStructure>,
    /// The degrees of freedom that modal points show, and their displacements.
    recorded: Vec<usize>,
    pub(crate) rows: ResponseRows,
    /// `K_NN⁻¹ W`, n_N × c.
    pub(crate) pressed: Mat<f64>,
    /// Those of the contact coordinates in the modes, n_N × m: `b = F η`.
    pub(crate) follow: Mat<f64>,
    reduction: Option<GalerkinReduction>,
}

impl CondensedStructure {
    /// Reduces `model` with its lowest `n_modes` fixed-interface modes, all of them where there are fewer.
    ///
    /// # Errors
    /// [`HbmError::ContactTooStiff`]; [`HbmError`] if the structure with its contacts held still has a rigid-body mode
    /// or the contact compliance is not usable.
    pub fn new(model: MasslessContactModel, n_modes: usize) -> Result<Self, HbmError> {
        let keeps_all = n_modes >= model.linear_dofs().len();
        let reduction = match keeps_all {
            true => model.factor_k_ll().map(|_| None)?,
            false => Some(GalerkinReduction::with_modes_at_rest(model.clone(), n_modes)?),
        };
        let open = OpenModes::all_of_massless(reduction.as_ref().map_or(&model, GalerkinReduction::model))?;
        refuse_stiff_springs(&model, &open)?;
        let modal = modal_structure(&open, reduction.as_ref().map_or(&model, GalerkinReduction::model))?;
        let (modal, static_part) = match (model.contact_coordinates(), &reduction) {
            (ContactCoordinates::Nodes, _) => (modal, None),
            // A contact node moves in harmonics, also one that has no mass.
            (ContactCoordinates::SpringTips, None) => (modal.clone().with_flexibility_in_harmonics()?, Some(modal)),
            // The reduction has the tips as nodes of its own: what they yield is the springs alone.
            (ContactCoordinates::SpringTips, Some(_)) => {
                let springs = (0..model.k_nn().nrows()).map(|i| 1.0 / model.k_nn()[(i, i)]);
                (modal.with_stop_compliance(springs.collect()), None)
            }
        };
        let failed = |source| HbmError::Linalg { what: "stiffness K_NN of the contact degrees of freedom", source };
        let mut pressed = DenseLu::factor(model.k_nn()).map_err(failed)?.solve_columns(model.w());
        // The structure moves by less than nodes with a part of their stops in them.
        for (i, contact) in model.contacts().iter().enumerate().filter(|(_, contact)| contact.lent > 0.0) {
            let own = (0..pressed.nrows()).filter(|d| model.contact_dofs()[*d] == contact.dof);
            own.for_each(|d| pressed[(d, i)] -= contact.direction() * contact.lent);
        }
        let rows = |dofs: &[usize]| match &reduction {
            Some(reduction) => reduction.rows_of_dofs(&open, dofs),
            None => open.rows_of_dofs(dofs),
        };
        let recorded = recorded(&model);
        let (rows, follow) = (rows(&recorded)?, rows(model.contact_dofs())?.modes);
        Ok(Self { model, open, modal, static_part, recorded, rows, pressed, follow, reduction })
    }

    /// The structure that was reduced.
    pub fn model(&self) -> &MasslessContactModel {
        &self.model
    }

    /// Its modes with open contacts, on which all motions are built; of a reduced structure those of the reduction.
    pub fn open_modes(&self) -> &OpenModes {
        &self.open
    }

    /// Fixed-interface modes computed, with those that leave the contacts at rest.
    pub fn n_held_modes(&self) -> usize {
        self.reduction.as_ref().map_or(self.model.linear_dofs().len(), GalerkinReduction::n_held_modes)
    }

    /// Those of them that move the contacts.
    pub fn n_coupled_modes(&self) -> usize {
        let own = || (0..self.modal.n_modes()).filter(|&k| self.modal.moves_a_contact(k)).count();
        self.reduction.as_ref().map_or_else(own, GalerkinReduction::n_coupled_modes)
    }

    /// Whether no mode was left out.
    pub fn has_all_modes(&self) -> bool {
        self.reduction.is_none()
    }

    /// Highest angular frequency of a mode that moves a contact, rad/s.
    pub fn highest_frequency(&self) -> f64 {
        let moving = (0..self.modal.n_modes()).filter(|&k| self.modal.moves_a_contact(k));
        let own = || moving.map(|k| self.modal.omega_squared()[k]).fold(0.0, f64::max);
        self.reduction.as_ref().map_or_else(own, GalerkinReduction::highest).sqrt()
    }

    /// Angular frequencies of the modes with open contacts, rad/s, ascending.
    pub fn open_frequencies(&self) -> Vec<f64> {
        self.modal.omega_squared().iter().map(|square| square.sqrt()).collect()
    }

    /// Degrees of freedom whose coefficients modal points hold, ascending: all of them up to
    /// [`MAX_RECORDED`], else some evenly spaced ones and those of the contacts.
    pub fn recorded_dofs(&self) -> &[usize] {
        &self.recorded
    }

    /// Place of degree of freedom `dof` among the recorded ones, if it is one of them.
    pub fn recorded_index(&self, dof: usize) -> Option<usize> {
        self.recorded.binary_search(&dof).ok()
    }

    /// Contact compliance `A = Wᵀ K_NN⁻¹ W + C`, eqs. (11), (13), with that of the stops in series; c × c, m/N.
    pub fn compliance(&self) -> &LcpMatrix {
        self.modal.compliance()
    }

    /// Number of contact degrees of freedom n_N.
    pub fn n_contact_dofs(&self) -> usize {
        self.pressed.nrows()
    }

    /// Number of contacts c.
    pub fn n_contacts(&self) -> usize {
        self.modal.n_contacts()
    }

    /// Coordinates `Φᵀ M q_n` in the lowest `modes` modes of a motion of all degrees of freedom, modes × (H + 1),
    /// m·√kg.
    ///
    /// # Errors
    /// [`HbmError::Size`] for a motion of some of them only.
    pub fn modal_coordinates(
        &self,
        motion: &HarmonicCoefficients,
        modes: usize,
    ) -> Result<HarmonicCoefficients, HbmError> {
        agrees("degrees of freedom of a motion", self.model.dofs().len(), motion.n_coordinates())?;
        let mut modal = HarmonicCoefficients::zeros(modes.min(self.open.n_modes()), motion.n_harmonics());
        for n in 0..=motion.n_harmonics() {
            for (unit, part) in [(Complex64::ONE, 0), (Complex64::I, 1)] {
                let q: Vec<f64> =
                    (0..motion.n_coordinates()).map(|d| [motion.of(d)[n].re, motion.of(d)[n].im][part]).collect();
                let reduced =
                    self.reduction.as_ref().map(|reduction| Ok::<_, HbmError>((reduction, reduction.project(&q)?)));
                let inertia = match reduced.transpose()? {
                    Some((reduction, y)) => multiply(reduction.model().mass(), &y),
                    None => multiply(self.model.mass(), &q),
                };
                for k in 0..modal.n_coordinates() {
                    let along = self.open.shapes().col(k).iter().zip(&inertia).map(|(shape, m)| shape * m).sum::<f64>();
                    modal.of_mut(k)[n] += unit * along;
                }
            }
        }
        Ok(modal)
    }

    /// Where the contact coordinates are without contact forces, `b = F η`, n_N.
    pub(crate) fn contact_positions(&self, eta: &[f64]) -> Vec<f64> {
        let along = |d: usize| eta.iter().zip(self.follow.row(d).iter()).map(|(eta, row)| row * eta).sum();
        (0..self.n_contact_dofs()).map(along).collect()
    }

    /// A guess, before any solution is known, for the share of the fixed-interface modes left out in the relative error
    /// of the frequency `omega` (rad/s) with these harmonics.
    ///
    /// At the amplitude of grazing, `q_N` is taken to have harmonics `n⁻²`, as a motion whose velocity jumps. Then by
    /// Rayleigh's principle
    ///
    /// ```text
    /// |δω/ω| = Σ_n ν⁴/4 q_nᵀ S q_n / (2 E_av) = N_h ω⁴ q_1ᵀ S q_1/(8 E_av)
    /// ```
    ///
    /// over `1 − ν²/λ_m` for the terms that follow, with what the reduction [leaves out](GalerkinReduction::left_out).
    /// Infinite where the modes end below the highest harmonic.
    pub fn held_modes_error(&self, start: &Grazing, omega: f64, harmonics: usize) -> f64 {
        if self.has_all_modes() {
            return 0.0;
        }
        let q: Vec<Complex64> = start.contact_amplitudes(self).into_iter().map(Complex64::from).collect();
        let remainder = self.remainder(harmonics as f64 * omega);
        let form = q.iter().zip(self.left_out(&q)).map(|(q, f)| (q.conj() * f).re).sum::<f64>();
        let error = harmonics as f64 * omega.powi(4) * form.abs() / (8.0 * start.energy) / remainder;
        if remainder > 0.0 { error } else { f64::INFINITY }
    }

    /// `S q` with what the reduction leaves out, n_N, N s⁴.
    pub(crate) fn left_out(&self, q: &[Complex64]) -> Vec<Complex64> {
        let s = self.reduction.as_ref().map(GalerkinReduction::left_out);
        let row = |i: usize| s.map_or(Complex64::default(), |s| q.iter().enumerate().map(|(j, q)| q * s[(i, j)]).sum());
        (0..q.len()).map(row).collect()
    }

    /// `1 − ν²/λ_m` with the highest fixed-interface mode kept.
    pub(crate) fn remainder(&self, nu: f64) -> f64 {
        1.0 - (nu / self.highest_frequency()).powi(2)
    }

    /// Energy at rest of a structure that a steady force presses onto its contacts, J, in which the total energy of its
    /// motions is counted; zero of others.
    ///
    /// # Errors
    /// [`HbmError`] where it does not rest.
    pub fn energy_at_rest(&self) -> Result<f64, HbmError> {
        if self.model.steady_force().is_none() {
            return Ok(0.0);
        }
        let rest = self.rest()?;
        let half = |a: &[f64], b: f64, i: usize| 0.5 * a[i] * b;
        let modal = self.modal.omega_squared().iter().enumerate();
        let strain: f64 = modal.map(|(k, square)| half(&rest.eta, square * rest.eta[k], k)).sum();
        let a = self.statically().compliance().a();
        let yields = |i: usize| (0..rest.forces.len()).map(|j| a[(i, j)] * rest.forces[j]).sum::<f64>();
        let contact: f64 = (0..rest.forces.len()).map(|i| half(&rest.forces, yields(i), i)).sum();
        let work: f64 = self.modal.steady_force().iter().zip(&rest.eta).map(|(p, eta)| p * eta).sum();
        Ok(strain + contact - work)
    }

    /// The structure as it rests and moves in its linear modes, where what has no mass follows at each instant and in
    /// harmonics alike.
    pub(crate) fn statically(&self) -> &ModalStructure {
        self.static_part.as_ref().unwrap_or(&self.modal)
    }

    /// A linear mode about this rest with the motion of what has no mass and is a coordinate of its own.
    pub(crate) fn with_static_motion(&self, mut start: Grazing, rest: Option<&RestState>) -> Result<Grazing, HbmError> {
        let (m, all) = (start.mean.len(), self.modal.n_modes());
        let row = |i: usize, k: usize| self.modal.rows()[(i, k)];
        let along = |forces: &[f64], k: usize| forces.iter().enumerate().map(|(i, f)| row(i, k) * f).sum::<f64>();
        if let Some(rest) = rest.filter(|_| all > m) {
            let set = ClosedSet::new(self.statically().compliance(), &rest.closed)?;
            let moved: Vec<f64> =
                (0..self.n_contacts()).map(|i| (0..m).map(|k| row(i, k) * start.shape[k]).sum()).collect();
            let swing: Vec<f64> = (0..moved.len()).map(|i| set.force(i, &moved)).collect();
            start.mean.extend((m..all).map(|k| along(&rest.forces, k)));
            start.shape.extend((m..all).map(|k| along(&swing, k)));
        }
        start.mean.resize(all, 0.0);
        start.shape.resize(all, 0.0);
        Ok(start)
    }

    /// Where the structure rests against its stops; contacts that touch without force are open.
    pub(crate) fn rest(&self) -> Result<RestState, HbmError> {
        let solver = solver_by_name("active-set").map_err(HbmError::Compliance)?;
        // What a steady force strains beside the rigid-body motions that it drives.
        let model = self.reduction.as_ref().map_or(&self.model, GalerkinReduction::model);
        let mut strains = model.steady_force().map(|steady| self.open.load(&steady.force)).transpose()?;
        strains.iter_mut().for_each(|load| load.modal[..self.open.n_rigid()].fill(0.0));
        let mut rest = self.open.rest(&strains.iter().collect::<Vec<_>>(), solver.as_ref())?;
        let largest = max_norm(rest.forces.iter().copied());
        rest.closed.iter_mut().zip(&rest.forces).for_each(|(closed, force)| *closed &= *force > ROUNDING * largest);
        Ok(rest)
    }

    /// Mixed shooting-harmonic balance with massless contacts, eqs. (6)-(16): the equations of a conservative mode.
    ///
    /// Unknowns are the coefficients of `b(t)`, the position that the massless contact nodes would have without stops,
    /// seen along the contacts, or of the modal coordinates where these are fewer, and the frequency; the parameter is
    /// `p = ln(E_av/E_ref)`. For given `b` the static contact problem (11), (13) gives `λ(t)` at each instant, and the
    /// equations are
    ///
    /// ```text
    /// b_n = Y (Ω² − n²ω²)⁻¹ Yᵀ 𝓕_n(λ(t)) ,  n = 0 … N_h    connectivity (14) through eq. (8), in a form without poles
    /// ln(E_av(ω, b)/E_ref) − p = 0                        energy condition of (16)
    /// ```
    ///
    /// The paper iterates on `q_N,n` instead, eq. (15); the solutions are the same, with `q_N = b + K_NN⁻¹ W λ`. But
    /// `q_N,n` vanishes where `nω` meets an eigenfrequency of the structure with its contacts held, and cannot tell
    /// solutions apart there; `b_n` does, for `q_N(t)` is a function of `b(t)`, not the other way round.
    ///
    /// With [`Symmetry::Even`] this is square. With [`Symmetry::None`] the phase is free: the phase of the last
    /// accepted point is held, [`PhaseCondition`](crate::PhaseCondition), and with it comes a negative damping `ξ` as
    /// an unknown; on a solution of a conservative system it vanishes.
    ///
    /// Unknown vector: `b/length` (one direction of the contacts after the other, [`RealSeries`](crate::RealSeries)),
    /// `ω/omega`, and `ξ/omega`. Which coordinates are the unknowns is chosen, whatever the settings say.
    ///
    /// # Errors
    /// [`HbmError::Harmonics`], [`HbmError::Samples`], or what the contact solver has against the compliance.
    pub fn conservative_mode(
        &self,
        (settings, symmetry): (PeriodicSettings, Symmetry),
        scales: Scales,
        solver: &dyn LcpSolver,
    ) -> Result<PeriodicSystem, HbmError> {
        let settings = PeriodicSettings { coordinates: Coordinates::of_few_contacts(&self.modal), ..settings };
        PeriodicSystem::conservative_mode(&self.modal, symmetry, settings, scales, solver)
    }

    /// The point with the unknowns `x` of such a mode, with its modal quantities.
    ///
    /// # Errors
    /// [`HbmError`] if the contact problem has no solution there.
    pub fn modal_point(&self, mode: &mut PeriodicSystem, x: &[f64], residual: f64) -> Result<ModalPoint, HbmError> {
        let first = self.model.contacts().first().and_then(|first| self.recorded_index(first.dof));
        mode.modal_point(x, &self.rows, first.unwrap_or(0), residual)
    }

    /// Displacements `q_N,n = b_n + K_NN⁻¹ W λ_n` of the contact coordinates in harmonic `n` of the motion that such a
    /// mode solved last.
    pub(crate) fn contact_coordinates(&self, mode: &PeriodicSystem, n: usize, at: OperatingPoint) -> Vec<Complex64> {
        let (eta, forces) = (mode.modal_coordinates(n, at), mode.forces_of_harmonic(n));
        let along = |row: &Mat<f64>, d: usize, z: &[Complex64]| {
            z.iter().enumerate().map(|(k, z)| z * row[(d, k)]).sum::<Complex64>()
        };
        let of = |d: usize| along(&self.follow, d, &eta) + along(&self.pressed, d, &forces);
        (0..self.n_contact_dofs()).map(of).collect()
    }
}

/// The structure in its open modes, with what a steady force does on all of them.
fn modal_structure(open: &OpenModes, model: &MasslessContactModel) -> Result<ModalStructure, HbmError> {
    let modal = ModalStructure::of_open(open, ModalDamping::none(open.n_modes()))?;
    let Some(steady) = model.steady_force() else { return Ok(modal) };
    let mut on_modes = open.load(&steady.force)?.modal;
    on_modes.iter_mut().zip(open.steady_force()).take(open.n_rigid()).for_each(|(p, rigid)| *p = *rigid);
    modal.with_steady_force(on_modes)
}

/// Contact springs beside which the stiffness of the structure is lost in rounding: equations of harmonic balance in
/// which any motion would pass for a solution.
fn refuse_stiff_springs(model: &MasslessContactModel, open: &OpenModes) -> Result<(), HbmError> {
    if model.contact_coordinates() == ContactCoordinates::Nodes || open.floats() {
        return Ok(());
    }
    // The spring in series with the structure, over the spring.
    let ratio = |i: usize| {
        let modes = open.omega_squared().iter().enumerate();
        let modal: f64 = modes.map(|(k, square)| open.contact_rows()[(i, k)].powi(2) / square).sum();
        model.k_nn()[(i, i)] * (modal + open.flexibility()[(i, i)] + open.stop_compliance()[i])
    };
    match (0..open.n_contacts()).find(|&i| ratio(i) > STIFFEST) {
        Some(contact) => Err(HbmError::ContactTooStiff { contact, ratio: ratio(contact), most: STIFFEST }),
        None => Ok(()),
    }
}

/// All degrees of freedom, or those of every m-th node, of the last one and of the contacts.
fn recorded(model: &MasslessContactModel) -> Vec<usize> {
    let all = model.dofs();
    if all.len() <= MAX_RECORDED {
        return (0..all.len()).collect();
    }
    let stride = all.len().div_ceil(MAX_RECORDED / 2);
    let last = all.iter().map(|d| d.node).max().unwrap_or(0);
    let is_contact = |i: usize| model.contacts().iter().any(|c| c.dof == i);
    (0..all.len()).filter(|&i| all[i].node.is_multiple_of(stride) || all[i].node == last || is_contact(i)).collect()
}
