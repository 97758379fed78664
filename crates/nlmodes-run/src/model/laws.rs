//! Springs, dampers and stops of a scene with a law of force.

use std::path::Path;
use std::sync::Arc;

use nlmodes::hbm::{
    Bilinear, Exponential, ForceLaw, HertzStop, ModeStart, Polynomial, PowerDamper, PowerSpring, TableLaw,
};
use nlmodes::response::{ResponseModel, Weights};
use nlmodes_io::NodeContact;
use nlmodes_scene::SceneFile;
use nlmodes_scene::assemble::{StaticState, Structures, law_contacts};
use nlmodes_scene::scene::{Contact, Hertz, LawContact, Place, RowContact, SceneStructure, Side, SpringLaw};

use crate::{RunError, chain, refusal, two_columns};

/// Instants of a period at which laws are evaluated that are no polynomials: with slopes that are continuous, forces
/// are then right to 1e-7 and better.
pub const SAMPLES: usize = 1024;

/// Force in a table at rest, over its largest, up to which it is rounding.
const AT_REST: f64 = 1e-12;

/// The laws of a scene.
pub struct Laws {
    /// The displacements that its springs resist.
    pub springs: Vec<Weights>,
    /// The displacements toward its stops with a law of force, and their gaps, m.
    pub stops: Vec<(Weights, f64)>,
    /// Where the structure rests on them under static loads, where anything moves it.
    pub rest: Option<StaticState>,
}

/// Adds the springs and stops of a scene with a law of force, where static loads without them have the `state`. `at`
/// gives the weights of a place.
///
/// # Errors
/// [`RunError`] at the key that it is about.
pub fn add(
    file: &SceneFile,
    response: &mut ResponseModel,
    at: &dyn Fn(&str, &Place) -> Result<Weights, RunError>,
    (structures, state): (&Structures, Option<&StaticState>),
) -> Result<Laws, RunError> {
    let scene = &file.scene;
    let mut springs = Vec::new();
    for (i, spring) in scene.springs.iter().enumerate() {
        let mut weights = at(&format!("spring.{i}.at_m"), &spring.at)?;
        if let Some(other) = &spring.against {
            weights.extend(at(&format!("spring.{i}.against.at_m"), other)?.into_iter().map(|(dof, w)| (dof, -w)));
        }
        let law = law(file, i, &spring.law)?;
        response
            .add_law(&weights, law, SAMPLES)
            .map_err(|error| refusal::here(file, &format!("spring.{i}"), &error))?;
        springs.push(weights);
    }
    let stops = stops(file, response, at, structures)?;
    let rest = rest(file, response, (springs.len(), &stops), state)?;
    let of = &scene.continuation;
    let amplitude = of.start_amplitude_m.map(ModeStart::Amplitude);
    response.set_mode_start(amplitude.or(of.start_energy_j.map(ModeStart::Energy)).unwrap_or_default());
    Ok(Laws { springs, stops, rest })
}

/// Where a structure rests on its laws and static loads; `None` where nothing moves it. `springs` laws are no stops.
fn rest(
    file: &SceneFile,
    response: &mut ResponseModel,
    (springs, stops): (usize, &[(Weights, f64)]),
    state: Option<&StaticState>,
) -> Result<Option<StaticState>, RunError> {
    if response.structure().laws().is_empty() {
        return Ok(None);
    }
    let scene = &file.scene;
    if state.is_some_and(StaticState::is_carried) {
        let title =
            "a structure that floats, carried by its contacts alone, beside springs or stops with a law of force";
        let help = ["where both come to rest is not computed; a weak `[[structure.spring]]` holds the structure"];
        let key = scene.static_loads.first_key();
        return Err(file.error_at(key, title, "expected a structure that its supports hold", &help).into());
    }
    Ok(if state.is_some() || stops.iter().any(|(_, gap)| *gap < 0.0) {
        let state = state.cloned().unwrap_or_else(|| StaticState::still(response.open_modes()));
        let moved = |weights: &Weights| weights.iter().map(|&(dof, w)| w * state.displacement[dof]).sum::<f64>();
        let laws = 0..response.structure().laws().len();
        let moved: Vec<f64> = laws.map(|l| response.law_weights(l).map_or(0.0, moved)).collect();
        let key = if scene.static_loads.is_empty() { "contact" } else { scene.static_loads.first_key() };
        let held = response.rest_on_laws(&moved, SAMPLES).map_err(|error| refusal::here(file, key, &error))?;
        let stops: Vec<_> = stops.iter().map(|(_, gap)| *gap).zip(held.laws[springs..].iter().copied()).collect();
        Some(state.held(&held, &stops))
    } else {
        None
    })
}

/// Adds the stops with a law of force, and says where they are.
fn stops(
    file: &SceneFile,
    response: &mut ResponseModel,
    at: &dyn Fn(&str, &Place) -> Result<Weights, RunError>,
    structures: &Structures,
) -> Result<Vec<(Weights, f64)>, RunError> {
    let mut stops = Vec::new();
    for Stop { table, toward, away, gap, law } in placed(file, structures)? {
        let path =
            format!("contact.{table}.{}", if matches!(toward, (Place::Along { .. }, _)) { "at_m" } else { "gap_m" });
        let mut weights = Weights::new();
        for (place, sign) in [Some(toward), away].into_iter().flatten() {
            weights.extend(at(&path, &place)?.into_iter().map(|(dof, w)| (dof, sign * w)));
        }
        let Hertz { stiffness, exponent, dissipation } = law;
        let law = HertzStop { stiffness, exponent, gap, dissipation };
        response
            .add_law(&weights, Arc::new(law), SAMPLES)
            .map_err(|error| refusal::here(file, &format!("contact.{table}"), &error))?;
        stops.push((weights, gap));
    }
    Ok(stops)
}

/// A stop with a law of force: its table, what moves toward it and what it touches with their signs, its clearance.
struct Stop {
    table: usize,
    toward: (Place, f64),
    away: Option<(Place, f64)>,
    gap: f64,
    law: Hertz,
}

/// The stops of a scene with a law of force, in the order of their tables.
fn placed(file: &SceneFile, structures: &Structures) -> Result<Vec<Stop>, RunError> {
    let sign = |side| if side == Side::Positive { 1.0 } else { -1.0 };
    let along = |(table, contact): (usize, &Contact)| {
        let place = |structure, at| Place::Along { at, direction: contact.direction, structure };
        let toward = sign(contact.side);
        Some(Stop {
            table,
            toward: (place(contact.structure, contact.at), toward),
            away: contact.against.map(|other| (place(other.structure, other.at), -toward)),
            gap: contact.gap,
            law: contact.hertz?,
        })
    };
    let scene = &file.scene;
    Ok(match &scene.structure {
        SceneStructure::Straight(_) | SceneStructure::Several(_) => {
            scene.contacts.iter().enumerate().filter_map(along).collect()
        }
        SceneStructure::Reduced(model) => {
            let first = model.row_contacts.len();
            let of_row = |(i, of): (usize, &LawContact<RowContact>)| Stop {
                table: first + i,
                toward: (Place::Row { row: of.contact.row }, sign(of.contact.side)),
                away: None,
                gap: of.contact.gap,
                law: of.hertz,
            };
            model.law_contacts.iter().enumerate().map(of_row).collect()
        }
        SceneStructure::Matrices(matrices) => {
            let first = matrices.contacts.len();
            let found = law_contacts(scene, structures).map_err(|error| refusal::at(file, &error.path(), &error))?;
            let of_node = |(contact, law): (NodeContact, Hertz)| {
                let at = |node| Place::Node { node, direction: contact.normal };
                Stop {
                    table: first + contact.origin,
                    toward: (at(contact.node), 1.0),
                    away: contact.against.map(|node| (at(node), -1.0)),
                    gap: contact.gap,
                    law,
                }
            };
            found.into_iter().map(of_node).collect()
        }
    })
}

fn law(file: &SceneFile, i: usize, law: &SpringLaw) -> Result<Arc<dyn ForceLaw>, RunError> {
    let table = |path: &Path, key: &str, of_velocity: bool| -> Result<Arc<dyn ForceLaw>, RunError> {
        let key = format!("spring.{i}.law.{key}");
        let names = [if of_velocity { "velocity_m_s" } else { "displacement_m" }, "force_n"];
        let failed = |title: &str| -> RunError {
            let expected = format!("expected lines {}, the first ones growing, through the origin", names.join(","));
            file.error_at(&key, title, &expected, &[]).into()
        };
        let [places, forces] = two_columns::read(path, names).map_err(|why| failed(&why))?;
        let largest = forces.iter().fold(0.0_f64, |most, force| most.max(force.abs()));
        let law = TableLaw::new(places, forces, of_velocity)
            .map_err(|error| failed(&format!("{}: {}", path.display(), chain(&error))))?;
        let at_rest = law.at(0.0, 0.0).force;
        if at_rest.abs() > AT_REST * largest {
            let title =
                format!("{}: {} N at rest, where a law has no force", path.display(), nlmodes_scene::short(at_rest));
            return Err(failed(&title));
        }
        Ok(Arc::new(law))
    };
    Ok(match law {
        SpringLaw::Polynomial(coefficients) => Arc::new(Polynomial { coefficients: coefficients.clone() }),
        SpringLaw::Table(path) => table(path, "table", false)?,
        SpringLaw::DamperTable(path) => table(path, "damper_table", true)?,
        SpringLaw::Function(name) => file.functions.get(name).cloned().ok_or_else(|| {
            let title = format!("the law `{name}` of a program is not there");
            let help =
                ["nlmodes.run of Python takes nlmodes.Law(force, slope) here; a file has \"polynomial\", \"table\", …"];
            file.error_at(&format!("spring.{i}.law.function"), &title, "expected a law that is given", &help)
        })?,
        &SpringLaw::Power { stiffness, exponent, one_sided } => {
            Arc::new(PowerSpring { stiffness, exponent, one_sided })
        }
        &SpringLaw::Exponential { force, length } => Arc::new(Exponential { force, length }),
        &SpringLaw::Bilinear { inner, outer, knee } => Arc::new(Bilinear { inner, outer, knee }),
        &SpringLaw::Damper { coefficient, exponent } => Arc::new(PowerDamper { coefficient, exponent }),
    })
}
