use nlmodes_hbm::{Load, LoadTerm, ModalStructure, PhaseLag, ResponseRow};
use nlmodes_reduction::OpenModes;
use num_complex::Complex64;

use crate::{BaseMotion, BaseUnit, Damping, Dashpot, ResponseError, ResponseSettings};

/// A structure in open modes with damping, a load of level one, and a drive point.
#[derive(Debug, Clone)]
pub struct ResponseModel {
    open: OpenModes,
    structure: ModalStructure,
    terms: Vec<LoadTerm>,
    /// What each term moves statically, beyond the modes, n.
    residuals: Vec<Vec<Complex64>>,
    drive: Option<usize>,
}

impl ResponseModel {
    /// A damped structure without a load.
    ///
    /// # Errors
    /// [`ResponseError::Problem`] where a rigid stop meets a contact without flexibility.
    pub fn new(open: OpenModes, damping: &Damping) -> Result<Self, ResponseError> {
        let structure = ModalStructure::new(
            open.omega_squared().iter().map(|w| w.max(0.0)).collect(),
            open.contact_rows().clone(),
            open.flexibility(),
            open.gaps().to_vec(),
            open.stop_compliance(),
            damping.modal(open.omega_squared()),
        )?;
        Ok(Self { open, structure, terms: Vec::new(), residuals: Vec::new(), drive: None })
    }

    /// Adds dashpots to the ground; the modes are then coupled.
    ///
    /// # Errors
    /// [`ResponseError::NoSuchDof`] or [`ResponseError::Setting`] for one that is negative.
    pub fn add_dashpots(&mut self, dashpots: &[Dashpot]) -> Result<(), ResponseError> {
        let mut rows = Vec::new();
        for dashpot in dashpots {
            self.check_dof(dashpot.dof)?;
            let value = dashpot.damping;
            if !(value.is_finite() && value >= 0.0) {
                let (what, expected) = ("the constant of a dashpot (N s/m)", "a number that is not negative");
                return Err(ResponseError::Setting { what, value, expected });
            }
            rows.push((self.shape_at(dashpot.dof), value));
        }
        let damping = self.structure.damping().clone().with_dashpots(&rows);
        self.structure = self.structure.with_damping(damping)?;
        Ok(())
    }

    /// Adds a force `level · amplitude · cos(harmonic Ωt + phase)` (N a unit of the level, rad) at a degree of freedom.
    ///
    /// # Errors
    /// [`ResponseError::NoSuchDof`], [`ResponseError::Setting`], or what the reduction reports.
    pub fn push_force(&mut self, dof: usize, amplitude: f64, harmonic: usize, phase: f64) -> Result<(), ResponseError> {
        self.check_dof(dof)?;
        let mut force = vec![0.0; self.open.n_dofs()];
        force[dof] = amplitude;
        self.push_distributed(&force, harmonic, phase)
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
        if harmonic == 0 || !turn.is_finite() {
            let (what, expected) = ("the harmonic of a load", "1 or more");
            return Err(ResponseError::Setting { what, value: harmonic as f64, expected });
        }
        let load = self.open.load(force)?;
        let turned = |values: &[f64]| values.iter().map(|v| turn * *v).collect::<Vec<_>>();
        self.terms.push(LoadTerm { harmonic, omega_power, modal: turned(&load.modal), gaps: turned(&load.gaps) });
        self.residuals.push(turned(&load.residual));
        Ok(())
    }

    /// Adds the motion of the base, with which or past which the stops stand. Displacements are then relative to the base.
    ///
    /// # Errors
    /// [`ResponseError::Setting`] for sizes that do not agree, or what the reduction reports.
    pub fn push_base_motion(&mut self, base: &BaseMotion) -> Result<(), ResponseError> {
        let (n, found) = (self.open.n_dofs(), base.inertia.len().min(base.rigid.len()));
        if found != n || base.inertia.len() != base.rigid.len() {
            let (what, expected) = ("entries of the base motion", "one for each degree of freedom");
            return Err(ResponseError::Setting { what, value: found as f64, expected });
        }
        // ü = −ν² u; the level multiplies the amplitude of one or the other.
        let (acceleration, displacement) = match base.unit {
            BaseUnit::Acceleration => ((1.0, 0), (-1.0, -2)),
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
        self.check_dof(dof)?;
        self.drive = Some(dof);
        Ok(())
    }

    /// The structure in open modes with its damping.
    pub fn structure(&self) -> &ModalStructure {
        &self.structure
    }

    /// The reduction.
    pub fn open_modes(&self) -> &OpenModes {
        &self.open
    }

    /// Displacement of a degree of freedom, with what the load moves statically.
    ///
    /// # Errors
    /// [`ResponseError::NoSuchDof`], or what the reduction reports.
    pub fn row(&self, dof: usize) -> Result<ResponseRow, ResponseError> {
        self.check_dof(dof)?;
        let rows = self.open.rows_of_dofs(&[dof])?;
        Ok(ResponseRow {
            modes: (0..self.open.n_modes()).map(|k| rows.modes[(0, k)]).collect(),
            contacts: (0..self.open.n_contacts()).map(|i| rows.forces[(0, i)]).collect(),
            loads: self.residuals.iter().map(|r| r[dof]).collect(),
        })
    }

    /// The load of level one, its harmonics counted in the base frequency of the motion.
    pub(crate) fn load(&self, settings: &ResponseSettings) -> Result<Load, ResponseError> {
        let still = |term: &LoadTerm| term.modal.iter().chain(&term.gaps).all(|v| *v == Complex64::default());
        if self.terms.iter().all(still) {
            return Err(ResponseError::NoLoad);
        }
        let s = settings.subharmonic;
        let in_base = |term: &LoadTerm| {
            // A power of Ω as one of the base frequency ω = Ω/s.
            let factor = (s as f64).powi(term.omega_power);
            let scaled = |values: &[Complex64]| values.iter().map(|v| v * factor).collect();
            LoadTerm {
                harmonic: s * term.harmonic,
                omega_power: term.omega_power,
                modal: scaled(&term.modal),
                gaps: scaled(&term.gaps),
            }
        };
        Ok(Load::new(&self.structure, self.terms.iter().map(in_base).collect())?)
    }

    /// The drive point in its harmonic.
    pub(crate) fn drive(&self, settings: &ResponseSettings) -> Result<Option<PhaseLag>, ResponseError> {
        let Some(dof) = self.drive else { return Ok(None) };
        let mut row = self.row(dof)?;
        let s = settings.subharmonic as f64;
        row.loads.iter_mut().zip(&self.terms).for_each(|(load, term)| *load *= s.powi(term.omega_power));
        Ok(Some(PhaseLag { row, harmonic: settings.subharmonic, lag: settings.lag }))
    }

    fn shape_at(&self, dof: usize) -> Vec<f64> {
        (0..self.open.n_modes()).map(|k| self.open.shapes()[(dof, k)]).collect()
    }

    fn check_dof(&self, dof: usize) -> Result<(), ResponseError> {
        let available = self.open.n_dofs();
        if dof < available { Ok(()) } else { Err(ResponseError::NoSuchDof { found: dof, available }) }
    }
}
