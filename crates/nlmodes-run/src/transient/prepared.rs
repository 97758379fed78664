//! A structure with its loads, from a scene, ready to move.

use nlmodes::hbm::ResponseRow;
use nlmodes::response::Weights;
use nlmodes::timestep::{Blow, ForcedStructure, Signal};
use nlmodes_scene::SceneFile;
use nlmodes_scene::outline::place_in_words;
use nlmodes_scene::scene::{Course, LoadOn, Place, Transient};

use super::noise;
use crate::course::{Cosine, Lines, chirp, half_sine};
use crate::model::{Model, Reduced, base_force, push_laws, structure};
use crate::{RunError, refusal, two_columns};

/// A structure with its loads.
pub struct Prepared {
    /// It in free-interface modes, with its loads and what is observed.
    pub structure: ForcedStructure,
    /// Courses of the loads, in their order.
    pub signals: Vec<Box<dyn Signal>>,
    /// Blows.
    pub blows: Vec<Blow>,
    /// What is observed: places, and then each contact toward its stop.
    pub observed: Vec<Observed>,
    /// Highest frequency of the loads, and of the rows of a table, Hz.
    pub highest_hz: f64,
    pub table_hz: f64,
}

/// A displacement that is observed.
pub struct Observed {
    /// Its name.
    pub name: String,
    /// What static loads move there, m.
    pub moved: f64,
}

impl Prepared {
    /// Of a scene with a motion in time.
    ///
    /// # Errors
    /// [`RunError`] at the key that it is about.
    pub fn new(file: &SceneFile, transient: &Transient, model: &Model, parts: &Reduced) -> Result<Self, RunError> {
        let mut prepared = Self {
            structure: structure(file, model)?,
            signals: Vec::new(),
            blows: Vec::new(),
            observed: Vec::new(),
            highest_hz: 0.0,
            table_hz: 0.0,
        };
        let (mut residuals, mut driven) = (Vec::new(), Vec::new());
        for (i, load) in transient.loads.iter().enumerate() {
            let path = format!("transient.load.{i}");
            let force = match &load.on {
                LoadOn::Force(place) => {
                    let weights = parts.moving(file, &format!("{path}.at_m"), place)?;
                    let mut force = vec![0.0; model.open_modes().n_dofs()];
                    weights.iter().for_each(|&(dof, w)| force[dof] += w);
                    if !driven.iter().any(|(own, _)| own == place) {
                        driven.push((*place, weights));
                    }
                    force
                }
                LoadOn::Base(direction) => base_force(&file.scene, parts, model.reduction.as_ref(), *direction)
                    .map_err(|why| -> RunError { file.error_at(&path, &why, "here", &[]).into() })?,
            };
            let found = model.open_modes().load(&force).map_err(|error| refusal::here(file, &path, &error))?;
            if let Course::Impact { impulse } = load.course {
                let modal = found.modal.iter().map(|p| p * impulse).collect();
                prepared.blows.push(Blow { instant: load.start, modal });
                continue;
            }
            prepared
                .structure
                .push_input(&found.modal, &found.gaps)
                .map_err(|error| refusal::here(file, &path, &error))?;
            prepared.push_signal(file, &path, load, transient.duration)?;
            residuals.push(found.residual);
        }
        let moved = |place: &Weights, _: &ResponseRow| by_loads(&residuals, place);
        push_laws(file, model, &mut prepared.structure, &moved)?;
        prepared.observe(file, transient, (model, parts), (driven, &residuals))?;
        Ok(prepared)
    }

    fn push_signal(
        &mut self,
        file: &SceneFile,
        path: &str,
        load: &nlmodes_scene::scene::TransientLoad,
        duration: f64,
    ) -> Result<(), RunError> {
        let (start, rest) = (load.start, duration - load.start);
        let (signal, hz): (Box<dyn Signal>, f64) = match &load.course {
            &Course::Sine { amplitude, frequency_hz, phase_deg } => {
                let (phase, omega) = (phase_deg.to_radians(), std::f64::consts::TAU * frequency_hz);
                let end = f64::INFINITY;
                (Box::new(Cosine { amplitude, phase, omega, rate: 0.0, start, end }), frequency_hz)
            }
            &Course::Chirp { amplitude, from_hz, to_hz, back, length } => {
                (Box::new(chirp(amplitude, [from_hz, to_hz], back, [start, length])), from_hz.max(to_hz))
            }
            &Course::HalfSine { peak, width } => (Box::new(half_sine(peak, width, start)), 0.5 / width),
            &Course::Noise { rms, band_hz, seed } => {
                let made = noise::noise(rms, band_hz, seed, [start, rest]).map_err(|why| -> RunError {
                    let expected = "expected a band with lines, and few enough instants";
                    file.error_at(&format!("{path}.noise.band_hz"), &why, expected, &[]).into()
                })?;
                (Box::new(made), band_hz[1])
            }
            Course::Table(table) => {
                let value = if matches!(load.on, LoadOn::Base(_)) { "acceleration_m_s2" } else { "force_n" };
                let [times, values] = two_columns::read(table, ["time_s", value]).map_err(|why| -> RunError {
                    let expected = format!("expected rows time_s,{value}");
                    file.error_at(&format!("{path}.table"), &why, &expected, &[]).into()
                })?;
                let span = times[times.len() - 1] - times[0];
                self.table_hz = self.table_hz.max((times.len() - 1) as f64 / span);
                (Box::new(Lines { times: times.iter().map(|t| t + start).collect(), values }), 0.0)
            }
            Course::Impact { .. } => return Ok(()),
        };
        self.signals.push(signal);
        self.highest_hz = self.highest_hz.max(hz);
        Ok(())
    }

    /// Adds the places, and the contacts.
    fn observe(
        &mut self,
        file: &SceneFile,
        transient: &Transient,
        (model, parts): (&Model, &Reduced),
        (driven, residuals): (Vec<(Place, Weights)>, &[Vec<f64>]),
    ) -> Result<(), RunError> {
        let several = file.scene.structure.bodies().len() > 1;
        let mut all: Vec<(String, Weights)> = Vec::new();
        if transient.places.is_empty() {
            all.extend(driven.into_iter().map(|(place, weights)| (place_in_words(&place, several), weights)));
        }
        for (i, place) in transient.places.iter().enumerate() {
            let weights = parts.moving(file, &format!("transient.place.{i}.at_m"), place)?;
            all.push((place_in_words(place, several), weights));
        }
        let contacts = model.contacts.iter().enumerate();
        all.extend(contacts.map(|(i, weights)| (format!("contact {i} toward its stop"), weights.clone())));
        let functionals: Vec<Weights> = all.iter().map(|(_, weights)| weights.clone()).collect();
        let rows = model.response().rows(&functionals).map_err(|error| refusal::here(file, "transient", &error))?;
        let (m, c) = (self.structure.n_modes(), self.structure.n_contacts());
        for ((name, weights), row) in all.into_iter().zip(rows) {
            let at = |of: &[f64]| weights.iter().map(|&(dof, w)| of[dof] * w).sum::<f64>();
            let mut inputs = by_loads(residuals, &weights);
            inputs.extend(&row.contacts[c..]);
            self.structure
                .push_observed(&row.modes[..m], &row.contacts[..c], &inputs)
                .map_err(|error| refusal::here(file, "transient", &error))?;
            let moved = model.state.as_ref().map_or(0.0, |state| at(&state.displacement));
            self.observed.push(Observed { name, moved });
        }
        Ok(())
    }
}

/// What a unit of each load moves a place beyond the modes, m.
fn by_loads(residuals: &[Vec<f64>], place: &Weights) -> Vec<f64> {
    residuals.iter().map(|residual| place.iter().map(|&(dof, w)| residual[dof] * w).sum()).collect()
}
