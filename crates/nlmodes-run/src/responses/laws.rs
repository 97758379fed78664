//! Springs, dampers and stops of a scene with a law of force.

use std::path::Path;
use std::sync::Arc;

use nlmodes::hbm::{
    Bilinear, Exponential, ForceLaw, HertzStop, ModeStart, Polynomial, PowerDamper, PowerSpring, TableLaw,
};
use nlmodes::response::{ResponseModel, Weights};
use nlmodes_scene::SceneFile;
use nlmodes_scene::scene::{Hertz, Place, Side, SpringLaw};

use crate::{RunError, chain, two_columns};

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
}

/// Adds the springs and stops of a scene with a law of force. `at` gives the weights of a place.
///
/// # Errors
/// [`RunError`] at the key that it is about.
pub fn add(
    file: &SceneFile,
    response: &mut ResponseModel,
    at: &dyn Fn(&str, &Place) -> Result<Weights, RunError>,
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
            .map_err(|error| file.error_at(&format!("spring.{i}"), &chain(&error), "here", &[]))?;
        springs.push(weights);
    }
    if scene.has_laws() && response.structure().is_pressed() {
        let title = "a stop that presses at rest beside springs or stops with a law of force";
        let help =
            ["where both come to rest is not computed: give the law about that place, and gaps that are open there"];
        return Err(file.error_at("contact", title, "expected gaps that are not negative", &help).into());
    }
    let stops = stops(file, response, at)?;
    let of = &scene.continuation;
    let amplitude = of.start_amplitude_m.map(ModeStart::Amplitude);
    response.set_mode_start(amplitude.or(of.start_energy_j.map(ModeStart::Energy)).unwrap_or_default());
    Ok(Laws { springs, stops })
}

/// Adds the stops with a law of force, and says where they are.
fn stops(
    file: &SceneFile,
    response: &mut ResponseModel,
    at: &dyn Fn(&str, &Place) -> Result<Weights, RunError>,
) -> Result<Vec<(Weights, f64)>, RunError> {
    let mut stops = Vec::new();
    for (i, contact) in file.scene.contacts.iter().enumerate() {
        let Some(Hertz { stiffness, exponent, dissipation }) = contact.hertz else { continue };
        let path = format!("contact.{i}.at_m");
        let place = |structure, at| Place::Along { at, direction: contact.direction, structure };
        let toward = if contact.side == Side::Positive { 1.0 } else { -1.0 };
        let own = at(&path, &place(contact.structure, contact.at))?.into_iter().map(|(dof, w)| (dof, toward * w));
        let mut weights: Weights = own.collect();
        if let Some(other) = contact.against {
            let other = at(&path, &place(other.structure, other.at))?;
            weights.extend(other.into_iter().map(|(dof, w)| (dof, -toward * w)));
        }
        let law = HertzStop { stiffness, exponent, gap: contact.gap, dissipation };
        response
            .add_law(&weights, Arc::new(law), SAMPLES)
            .map_err(|error| file.error_at(&format!("contact.{i}"), &chain(&error), "here", &[]))?;
        stops.push((weights, contact.gap));
    }
    Ok(stops)
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
