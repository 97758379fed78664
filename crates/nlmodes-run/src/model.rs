//! The structure of a scene in its free-interface modes, with damping, laws of force and load.

mod damping;
mod exact;
mod laws;
mod structure;

use std::f64::consts::TAU;
use std::sync::Arc;

use nlmodes::hbm::{HbmError, PowerDamper};
use nlmodes::linalg::triplets;
use nlmodes::modal::{BranchEnd, Coordinate, EndReason, ModalBranch};
use nlmodes::model::MassShift;
use nlmodes::model::reduction::{MatrixDirection, OpenModes};
use nlmodes::response::{Dashpot, ResponseError, ResponseModel, Weights};
use nlmodes_scene::assemble::{OpenStructure, StaticState, Structures};
use nlmodes_scene::scene::{Place, Response, ResponseKind, Scene, SceneState, Sensitivity, Side};
use nlmodes_scene::{SceneFile, short};

use damping::damping;
pub use exact::{push_laws, structure};
pub use structure::{Reduced, base_force};
use structure::{base_motion, reduced};

use crate::curve::stress::Stress;
use crate::gradients::{direction as direction_of, with_modes};
use crate::physical::of_dofs;
use crate::sliding::Tangents;
use crate::{RunError, chain, refusal};

/// The structure of a scene with its damping and the load of level one.
pub struct Model {
    response: ResponseModel,
    /// The drive point of each response.
    drives: Vec<Weights>,
    /// The places of the forces, each once.
    pub force_places: Vec<Weights>,
    /// The degrees of freedom whose motion is written.
    pub recorded: Vec<usize>,
    /// What they are.
    pub coordinates: Vec<Coordinate>,
    /// Displacement of each contact toward its stop.
    pub contacts: Vec<Weights>,
    /// Displacements of the springs with a law of force.
    pub springs: Vec<Weights>,
    /// Displacements within the planes of the contacts.
    pub tangents: Tangents,
    /// Of each contact, its sign along the coordinate of its node: one for a stop on the positive side.
    pub sides: Vec<f64>,
    /// Of each contact that is one degree of freedom, its place among those recorded.
    pub contact_coordinates: Vec<Option<usize>>,
    /// Clearance of each contact in the drawing, m.
    pub gaps: Vec<f64>,
    /// What static loads and stops that press do to the structure.
    pub state: Option<StaticState>,
    /// Displacements of the recorded degrees of freedom under the static loads, m; empty without these.
    pub moved: Vec<f64>,
    /// The reduction, where the scene or its structure asks for open modes.
    pub reduction: Option<OpenStructure>,
    /// Unit of the levels.
    pub unit: &'static str,
    /// What the mode of the scene loses with the mass of the contact nodes, where that is left out or moved.
    pub shift: Option<MassShift>,
    /// What dashpots move of what they hold at the frequency of the mode beyond the modes that are taken, the largest;
    /// none without dashpots.
    pub beyond_modes: Option<f64>,
    /// Contacts whose stops have a damper beside their spring, N s/m.
    pub stop_dampers: Vec<(usize, f64)>,
    /// What is to be known about what is left out.
    pub warnings: Vec<String>,
    /// The parameters of the scene, with the model at other values of each.
    pub parameters: Vec<Parameter>,
}

/// A parameter by which motions are differentiated.
pub struct Parameter {
    /// Its key, and its value in the unit of that.
    pub key: Arc<str>,
    pub value: f64,
    /// The model and its scene at other values, with their weights in the difference quotient.
    pub states: Vec<(Model, Scene, f64)>,
    /// What it does to the matrices, where it changes entries of these.
    pub direction: Option<MatrixDirection>,
}

impl Model {
    /// Of a checked scene.
    ///
    /// # Errors
    /// [`RunError`] at the key that it is about.
    pub fn new(file: &SceneFile) -> Result<Self, RunError> {
        Self::sharing(file, &Structures::default())
    }

    /// The same, where what is known of files need not be read and reduced again.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn sharing(file: &SceneFile, structures: &Structures) -> Result<Self, RunError> {
        Ok(Self::with_parts(file, structures)?.0)
    }

    /// The same, with the structure from which it is made.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn with_parts(file: &SceneFile, structures: &Structures) -> Result<(Self, Reduced), RunError> {
        let scene = &file.scene;
        let mut parts = reduced(file, structures)?;
        refusal::unless_supported(file, &parts.open, parts.reduction.as_ref())?;
        let mut response = ResponseModel::new(parts.open.clone(), &damping(scene, &parts))
            .map_err(|error| refusal::here(file, "contact", &error))?;
        let at = |path: &str, place: &Place| parts.moving(file, path, place);
        let laws::Laws { springs, stops, rest } =
            laws::add(file, &mut response, &at, (structures, parts.state.as_ref()))?;
        let drawn = drawn_gaps(&parts);
        check_mode(file, &response, parts.reduction.as_ref())?;
        let omega = parts.open.omega_squared().get(scene.method.mode - 1).map_or(0.0, |w| w.max(0.0).sqrt());
        let mut beyond_modes = Vec::new();
        for (i, dashpot) in scene.damping.iter().flat_map(|d| &d.dashpots).enumerate() {
            let path = format!("damping.dashpot.{i}.at_m");
            let one = Dashpot { at: at(&path, &dashpot.place)?, damping: dashpot.damping };
            let share = response.beyond_modes(&one).map_err(|error| refusal::here(file, &path, &error))?;
            // Beside laws dashpots are laws too, with all of the flexibility at their place.
            if !scene.has_laws() {
                beyond_modes.push(omega * share);
                response.add_dashpots(&[one]).map_err(|error| refusal::here(file, &path, &error))?;
            } else {
                let law = PowerDamper { coefficient: one.damping, exponent: 1.0 };
                response
                    .add_law(&one.at, Arc::new(law), laws::SAMPLES)
                    .map_err(|error| refusal::here(file, &path, &error))?;
            }
        }
        let dampers = stop_dampers(scene, &parts);
        for &(contact, table, damper) in &dampers {
            let path = format!("contact.{table}.damping_n_s_m");
            response.add_stop_damper(contact, damper).map_err(|error| refusal::here(file, &path, &error))?;
        }
        let unit = scene.forces.first().map_or(1.0, |force| force.amplitude.abs());
        let mut force_places: Vec<Weights> = Vec::new();
        for (i, force) in scene.forces.iter().enumerate() {
            let path = format!("force.{i}.at_m");
            let weights = at(&path, &force.place)?;
            let (amplitude, phase) = (force.amplitude / unit, force.phase_deg.to_radians());
            response
                .push_force_at(&weights, amplitude, force.harmonic, phase)
                .map_err(|error| refusal::here(file, &path, &error))?;
            if !force_places.contains(&weights) {
                force_places.push(weights);
            }
        }
        if scene.base_motion.is_some() {
            let motion = base_motion(scene, &parts)
                .map_err(|title| -> RunError { file.error_at("base_motion", &title, "here", &[]).into() })?;
            response.push_base_motion(&motion).map_err(|error| refusal::here(file, "base_motion", &error))?;
        }
        let unit = match scene.base_motion {
            Some(base) if base.is_acceleration => "m/s²",
            Some(_) => "m",
            None => "N",
        };
        let (of_laws, law_gaps): (Vec<Weights>, Vec<f64>) = stops.into_iter().unzip();
        let contacts = [parts.toward_stops(), of_laws].concat();
        let default = force_places.first().or(contacts.first()).or(springs.first()).cloned().unwrap_or_default();
        let mut drives = Vec::new();
        for (i, response) in scene.responses.iter().enumerate() {
            drives.push(match &response.drive {
                Some(place) => at(&format!("response.{i}.drive_m"), place)?,
                None => default.clone(),
            });
        }
        if let Some(rest) = rest {
            parts = parts.resting(rest).map_err(|error| refusal::at(file, scene.static_loads.first_key(), &error))?;
        }
        let Reduced { recorded, coordinates, .. } = &parts;
        let contact_coordinates: Vec<Option<usize>> =
            contacts.iter().map(|weights| coordinate(weights, recorded)).collect();
        let model = Self {
            parameters: parameters(file, (parts.open.n_modes(), parts.reduction.as_ref()), structures)?,
            gaps: [drawn, law_gaps].concat(),
            moved: parts.state.as_ref().map(|state| of_dofs(state, &parts.recorded)).unwrap_or_default(),
            state: parts.state.clone(),
            response,
            drives,
            force_places,
            recorded: recorded.clone(),
            coordinates: coordinates.clone(),
            tangents: tangents(scene, &parts),
            sides: sides(scene, &contacts),
            contact_coordinates,
            contacts,
            springs,
            unit,
            shift: parts.shift,
            stop_dampers: dampers.into_iter().map(|(contact, _, damper)| (contact, damper)).collect(),
            warnings: parts
                .warning
                .take()
                .into_iter()
                .chain(give_way(&beyond_modes))
                .chain(taken_for_hertz(&windows(scene), parts.open.omega_squared()))
                .collect(),
            beyond_modes: beyond_modes.into_iter().reduce(f64::max),
            reduction: parts.reduction.take(),
        };
        Ok((model, parts))
    }

    /// The model with the drive point of a response: that of the scene, or the first force, or the first contact toward
    /// its stop.
    ///
    /// # Errors
    /// [`ResponseError`], not for a response of the scene.
    pub fn with_drive(&self, response: usize) -> Result<ResponseModel, ResponseError> {
        let mut model = self.response.clone();
        model.set_drive_at(self.drives.get(response).cloned().unwrap_or_default())?;
        Ok(model)
    }

    /// A curve without points, for this reason.
    pub fn no_branch(&self, name: &str, why: String) -> ModalBranch {
        ModalBranch {
            label: name.to_owned(),
            coordinates: self.coordinates.clone(),
            contact_coordinate: match self.contacts.is_empty() {
                true => self.springs.first().and_then(|weights| largest(weights, &self.recorded)),
                false => self.contact_coordinates.first().copied().flatten(),
            },
            stop: self.sides.first().zip(self.gaps.first()).map(|(side, gap)| side * gap),
            points: Vec::new(),
            end: BranchEnd::new(EndReason::NoStart, why, false),
        }
    }

    /// Why stress is not recovered, if only the size of the structure prevents it.
    pub fn stress_left_out(&self, scene: &Scene) -> Option<String> {
        Stress::left_out(scene, self.reduction.as_ref(), self.response.load_shapes().len())
    }

    /// The structure with its load, and no drive point.
    pub fn response(&self) -> &ResponseModel {
        &self.response
    }

    /// Angular frequency of a linear mode (from 1) about rest, rad/s: with the contacts open that are open there.
    pub fn mode_frequency(&self, mode: usize) -> Option<f64> {
        let structure = self.response.structure();
        if !structure.laws().is_empty() || structure.is_pressed() {
            return self.response.linear_start(mode).ok().map(|start| start.omega);
        }
        structure.omega_squared().get(mode.checked_sub(1)?).map(|w| w.max(0.0).sqrt())
    }

    /// The displacement whose amplitude points have: of the first contact toward its stop, without one of the first
    /// spring, without both of the first force.
    pub fn first_place(&self) -> Weights {
        let first = self.contacts.first().or(self.springs.first()).or(self.force_places.first());
        first.cloned().unwrap_or_default()
    }

    /// What static loads move the first contact toward its stop, m.
    pub fn toward_first(&self) -> f64 {
        self.state.as_ref().map_or(0.0, |state| state.toward(0))
    }

    /// The reduction.
    pub fn open_modes(&self) -> &OpenModes {
        self.response.open_modes()
    }
}

/// The models at other values of the parameters of a scene, with as many modes.
fn parameters(
    file: &SceneFile,
    (modes, open): (usize, Option<&OpenStructure>),
    structures: &Structures,
) -> Result<Vec<Parameter>, RunError> {
    let state = |number: usize, state: &SceneState| {
        let scene = with_modes(&state.scene, modes);
        let model = Model::sharing(&SceneFile::without_text(scene, ""), structures)
            .map_err(|error| refusal::here(file, &format!("sensitivity.{number}.key"), &error))?;
        Ok((model, state.scene.clone(), state.weight))
    };
    let of = |(number, sensitivity): (usize, &Sensitivity)| {
        let states = sensitivity.states.iter().map(|one| state(number, one)).collect::<Result<_, RunError>>()?;
        let direction = open.filter(|_| !sensitivity.entries.is_empty());
        let direction = direction.map(|open| direction_of(&file.scene, open, sensitivity)).transpose();
        let direction = direction.map_err(|why| file.error_at("sensitivity", &why, "here", &[]))?;
        Ok(Parameter { key: sensitivity.key.as_str().into(), value: sensitivity.value, states, direction })
    };
    file.scene.sensitivities.iter().enumerate().map(of).collect()
}

/// Displacements within the planes of the contacts.
fn tangents(scene: &Scene, parts: &Reduced) -> Tangents {
    let directions: Vec<(usize, usize, f64)> = triplets(parts.open.directions()).collect();
    let nodes = parts.reduction.as_ref().and_then(|reduction| reduction.files.as_ref());
    Tangents::of(scene, parts.dofs(), &directions, nodes)
}

/// The gaps before static loads.
fn drawn_gaps(parts: &Reduced) -> Vec<f64> {
    let toward = |contact| parts.state.as_ref().map_or(0.0, |state| state.toward(contact));
    parts.open.gaps().iter().enumerate().map(|(contact, gap)| gap + toward(contact)).collect()
}

/// Contacts with dampers: number, table of the scene, damper in N s/m. A table of nodes from files is many contacts.
fn stop_dampers(scene: &Scene, parts: &Reduced) -> Vec<(usize, usize, f64)> {
    let nodes = parts.reduction.iter().filter_map(|open| open.files.as_ref()).flat_map(|(_, contacts)| contacts);
    let of_nodes = nodes.enumerate().filter_map(|(i, contact)| Some((i, contact.origin, contact.damping?)));
    let of_elements = scene.contacts.iter().map(|contact| contact.damping);
    let of_rows = scene.structure.reduced().into_iter().flat_map(|model| &model.row_contacts);
    let of_tables = of_elements.chain(of_rows.map(|contact| contact.damping)).enumerate();
    of_nodes.chain(of_tables.filter_map(|(i, damping)| Some((i, i, damping?)))).collect()
}

/// The mode from which nonlinear modes and phase resonance begin must meet a stop.
fn check_mode(file: &SceneFile, response: &ResponseModel, open: Option<&OpenStructure>) -> Result<(), RunError> {
    let is_over = |r: &Response| matches!(r.kind, ResponseKind::Frequency | ResponseKind::Force);
    // Curves over frequency and level need no linear mode that meets a stop.
    if file.scene.responses.iter().all(is_over) {
        return Ok(());
    }
    open.map_or(Ok(()), |open| refusal::unless_held_by_weight(file, open))?;
    let error = match response.linear_start(file.scene.method.mode) {
        Ok(_) => return Ok(()),
        Err(ResponseError::Problem(error)) => error,
        Err(error) => return Err(refusal::here(file, "contact", &error)),
    };
    let expected = match &error {
        HbmError::NoSuchMode { available, .. } => format!("expected a whole number from 1 to {available}"),
        _ => "expected a stop that the linear mode meets at some amplitude".to_owned(),
    };
    Err(file.error_at("method.mode", &chain(&error), &expected, &[]).into())
}

/// Of each contact, the side on which the other one is.
fn sides(scene: &Scene, contacts: &[Weights]) -> Vec<f64> {
    let of = |(i, weights): (usize, &Weights)| match scene.contacts.get(i).map(|contact| contact.side) {
        Some(Side::Positive) => 1.0,
        Some(Side::Negative) => -1.0,
        // A node of files, in the direction of its first degree of freedom.
        None => weights.first().map_or(1.0, |(_, w)| w.signum()),
    };
    contacts.iter().enumerate().map(of).collect()
}

/// Of the recorded degrees of freedom the one with the largest weight.
fn largest(weights: &Weights, recorded: &[usize]) -> Option<usize> {
    let (dof, _) = weights.iter().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
    recorded.iter().position(|own| own == dof)
}

fn coordinate(weights: &Weights, recorded: &[usize]) -> Option<usize> {
    let [(dof, _)] = weights[..] else { return None };
    recorded.iter().position(|own| *own == dof)
}

/// Share of what a dashpot holds that it may move beyond the modes without a word.
pub const SMALL: f64 = 1e-3;

/// Says which dashpots hold more than the modes that are taken know of.
fn give_way(beyond_modes: &[f64]) -> impl Iterator<Item = String> {
    let large = beyond_modes.iter().enumerate().filter(|(_, share)| **share > SMALL);
    large.map(|(i, share)| {
        format!(
            "dashpot {i}: its force bends the structure beyond the modes that are taken, by {:.1} % of its own \
                displacement at the frequency of the mode (ω c a, a the flexibility \
             that these modes leave over), which is left out; more reduction.modes, or a place beside the contact node",
            100.0 * share
        )
    })
}

/// The frequency windows of the responses over the frequency, Hz, with their numbers.
fn windows(scene: &Scene) -> Vec<(usize, [f64; 2])> {
    let all = scene.responses.iter().enumerate().filter(|(_, own)| own.kind == ResponseKind::Frequency);
    all.filter_map(|(i, own)| Some((i, [*own.frequency_hz.first()?, *own.frequency_hz.last()?]))).collect()
}

/// Says which windows have no linear mode, but one if their numbers are rad/s.
fn taken_for_hertz(windows: &[(usize, [f64; 2])], omega_squared: &[f64]) -> Vec<String> {
    let omega: Vec<f64> = omega_squared.iter().map(|square| square.max(0.0).sqrt()).collect();
    let warning = |(i, [low, high]): &(usize, [f64; 2])| {
        let within = |value: f64| (*low..=*high).contains(&value);
        let mode = omega.iter().position(|omega| within(*omega))?;
        (!omega.iter().any(|omega| within(omega / TAU))).then(|| {
            format!(
                "`response.{i}.frequency_hz`: no linear mode is between {} and {} Hz, but mode {} of {} Hz is between \
                 as many rad/s: `frequency_rad_s` takes these",
                short(*low),
                short(*high),
                mode + 1,
                short(omega[mode] / TAU)
            )
        })
    };
    windows.iter().filter_map(warning).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn windows_in_radians_a_second_are_told_from_those_between_modes() {
        let squares = [17.3, 75.0, 198.0].map(|hz: f64| (TAU * hz).powi(2));
        let found = taken_for_hertz(&[(0, [14.0, 26.0]), (1, [100.0, 119.0]), (2, [30.0, 50.0])], &squares);
        let [only] = &found[..] else { panic!("{found:?}") };
        let expected = "`response.1.frequency_hz`: no linear mode is between 100 and 119 Hz, but mode 1 of 17.3 Hz is";
        assert!(only.starts_with(expected), "{only}");
    }
}
