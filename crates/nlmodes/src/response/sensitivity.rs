//! Derivatives of motions by parameters of the structure and its load.

use std::sync::Arc;

use nlmodes_contact::solver_by_name;
use nlmodes_hbm::{
    Changes, HbmError, MotionChange, PeriodicSettings, PeriodicSystem, Scales, StructureChange, StructureState,
    Symmetry, Watched,
};
use nlmodes_linalg::{Mat, symmetric_eigen};
use nlmodes_modal::ModalPoint;
use nlmodes_model::reduction::{OpenModes, ReductionError};
use num_complex::Complex64;

use crate::response::follow::CONVERGED;
use crate::response::model::Weights;
use crate::response::{ResponseError, ResponseModel, ResponseSettings};

/// The parameters by which the points of a curve are differentiated.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Gradients {
    /// The displacement whose amplitude is followed.
    pub watched: Option<Watched>,
    /// What each parameter does to the structure and its load.
    pub changes: Changes,
}

/// A structure with its load at one value of a parameter.
#[derive(Debug, Clone)]
pub struct ParameterState {
    /// The structure with its load and its drive point.
    pub model: ResponseModel,
    /// Level of the load there.
    pub level: f64,
    /// The displacement whose amplitude is followed; none for none.
    pub watched: Option<Weights>,
    /// Weight of this state in the difference quotient, per unit of the parameter.
    pub weight: f64,
}

/// Least cosine between the spaces of the retained modes within the step of a difference quotient.
const ALIKE: f64 = 0.7;

impl ResponseModel {
    /// The displacement with these weights, whose amplitude at the frequency of the load is followed.
    ///
    /// # Errors
    /// As [`rows`](Self::rows).
    pub fn watched(&self, weights: &Weights, settings: &ResponseSettings) -> Result<Option<Watched>, ResponseError> {
        let row = self.rows(std::slice::from_ref(weights))?.pop();
        let s = settings.subharmonic;
        Ok(row.map(|mut row| {
            row.loads.iter_mut().zip(self.terms()).for_each(|(load, term)| *load *= (s as f64).powi(term.omega_power));
            Watched { row, harmonic: s }
        }))
    }

    /// Derivative of this structure and its load by a parameter, from states at several values of it.
    ///
    /// # Errors
    /// [`ResponseError::OtherModes`], [`ResponseError::ModesOfGradient`] or [`ResponseError::MeshOfGradient`] where
    /// the retained modes are not those of this structure.
    pub fn change(
        &self,
        states: &[ParameterState],
        settings: &ResponseSettings,
    ) -> Result<StructureChange, ResponseError> {
        let loads = states.iter().map(|state| state.model.load_if_any(settings)).collect::<Result<Vec<_>, _>>()?;
        let mut all = Vec::new();
        for (state, load) in states.iter().zip(&loads) {
            let watched = state.watched.as_ref().map(|weights| state.model.watched(weights, settings)).transpose()?;
            let of = StructureState {
                structure: state.model.structure(),
                turn: turn(self.open_modes(), state.model.open_modes())?,
                load,
                level: state.level,
                drive: state.model.drive(settings)?.map(|drive| drive.row),
                watched: watched.flatten().map(|watched| watched.row),
            };
            all.push((of, state.weight));
        }
        Ok(StructureChange::of_differences(self.structure(), &all)?)
    }
}

/// The modes of `other` among those of `base`: the orthogonal matrix next to `Φ₀ᵀ M₀ Φ`.
fn turn(base: &OpenModes, other: &OpenModes) -> Result<Mat<f64>, ResponseError> {
    let (expected, found) = (base.n_modes(), other.n_modes());
    if expected != found {
        return Err(ResponseError::ModesOfGradient { expected, found });
    }
    if base.n_dofs() != other.n_dofs() {
        return Err(ResponseError::MeshOfGradient);
    }
    let identity = || Mat::from_fn(expected, expected, |i, j| f64::from(u8::from(i == j)));
    let is_same = (0..expected).all(|k| base.shapes().col(k).iter().eq(other.shapes().col(k).iter()));
    if is_same {
        return Ok(identity());
    }
    // Of a structure that was reduced elsewhere the modes do not depend on any parameter.
    let Some(shared) = base.modal_coordinates(other.shapes()) else { return Ok(identity()) };
    let square = shared.transpose() * &shared;
    let symmetric = Mat::from_fn(expected, expected, |i, j| 0.5 * (square[(i, j)] + square[(j, i)]));
    let (values, vectors) =
        symmetric_eigen(&symmetric).map_err(|source| ReductionError::Linalg { what: "modes of a gradient", source })?;
    let share = values.iter().fold(f64::INFINITY, |least, value| least.min(*value)).max(0.0).sqrt();
    if share < ALIKE {
        return Err(ResponseError::OtherModes { share });
    }
    let scaled = Mat::from_fn(expected, expected, |i, j| vectors[(i, j)] / values[j].sqrt());
    Ok(shared * scaled * vectors.transpose())
}

/// Derivatives of the points of a conservative nonlinear mode by parameters of its structure, at constant energy. The
/// coefficients of a point begin with the modal coordinates of `model`. None where a point is not found again.
///
/// # Errors
/// [`ResponseError`] where the equations cannot be set up.
pub fn mode_gradients(
    model: &ResponseModel,
    settings: &ResponseSettings,
    symmetry: Symmetry,
    points: &[ModalPoint],
) -> Result<Vec<Option<Vec<MotionChange>>>, ResponseError> {
    let solver = solver_by_name(&settings.contact_solver).map_err(HbmError::Compliance)?;
    let Gradients { watched, changes } = &*settings.gradients;
    let mut all = Vec::new();
    for point in points {
        if settings.watch.asks_to_end() {
            all.push(None);
            continue;
        }
        let periodic = PeriodicSettings { harmonics: point.coefficients.n_harmonics(), ..settings.periodic() };
        let scales = Scales::new(point.peak.abs(), point.omega, point.kinetic_energy);
        let structure = model.structure();
        let mut system = PeriodicSystem::conservative_mode(structure, symmetry, periodic, scales, solver.as_ref())?;
        let modes = model.open_modes().n_modes();
        let of = |n: usize| (0..modes).map(|k| point.coefficients.of(k)[n]).collect::<Vec<Complex64>>();
        let eta: Vec<Vec<Complex64>> = (0..=periodic.harmonics).map(of).collect();
        let mut x = system.coefficients_of(&eta);
        // The frequency in its own unit, and what unfolds the phase.
        x.push(1.0);
        x.resize(nlmodes_continuation::ParametricSystem::dim(&system), 0.0);
        system.hold_phase(&x);
        let mut held = vec![0.0; x.len() + 1];
        held[x.len()] = 1.0;
        let found = system.refine(&x, 0.0, &held);
        all.push(match found.residual < CONVERGED {
            true => Some(system.sensitivities(&found, watched.as_ref(), changes)?),
            false => None,
        });
    }
    Ok(all)
}

impl ResponseSettings {
    /// These, with points differentiated by parameters.
    #[must_use]
    pub fn with_gradients(self, gradients: Gradients) -> Self {
        Self { gradients: Arc::new(gradients), ..self }
    }
}
