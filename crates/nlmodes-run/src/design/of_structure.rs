//! A test on a structure whose scene describes none: an ideal force, levels about that of grazing.

use std::f64::consts::TAU;

use nlmodes::experiment::extraction::ExtractionSettings;
use nlmodes::experiment::phase_loop::LevelSchedule;
use nlmodes::rig::Exciter;
use nlmodes_scene::scene::{ModeDamping, Place, SceneStructure, TestLoop, TestScene, TestStop};
use nlmodes_scene::{SceneError, SceneFile, number};

use super::places::drive_places;
use crate::virtual_test::Rig;
use crate::{RunError, refusal};

/// Most modes of the rig.
const MODES: usize = 6;
/// Levels over the force of grazing.
const LEVELS: [f64; 6] = [0.5, 0.9, 1.1, 1.5, 2.0, 3.0];
/// Sampling rate, Hz, at least.
const SAMPLE_RATE: f64 = 20e3;
/// Samples of a period of the highest mode.
const SAMPLES: f64 = 5.0;

/// A test, and what was assumed of it.
pub struct Assumed {
    /// The test.
    pub file: SceneFile<TestScene>,
    /// What the scene does not say, in words.
    pub assumed: Vec<String>,
}

/// The test on a rod or beam with one stop and damping ratios: an ideal force at the first `[[force]]`, or where it
/// excites other modes least.
///
/// # Errors
/// [`RunError`] for other structures, none or several stops, and without damping ratios.
pub fn of_structure(file: &SceneFile) -> Result<Assumed, RunError> {
    let scene = &file.scene;
    let SceneStructure::Straight(structure) = &scene.structure else {
        let help = "the virtual rig has rods and beams; for others give the modes of a test to [linear_modes]";
        return Err(refused(file, "structure", "a test is designed on one rod or beam", help));
    };
    let [contact] = &scene.contacts[..] else {
        let title = format!("a test is designed before one stop; the scene has {}", scene.contacts.len());
        return Err(refused(file, "contact", &title, "leave the others out, or describe the test in [virtual_test]"));
    };
    let ratios = match scene.damping.as_ref().map(|damping| &damping.modes) {
        Some(ModeDamping::Ratios(ratios)) if !ratios.is_empty() => ratios.clone(),
        _ => {
            let help = "give `[damping] ratio = 0.01`, or `ratios`: levels and forces follow from them";
            return Err(refused(file, "damping", "a test is designed from damping ratios of the modes", help));
        }
    };
    let last = ratios.last().copied().unwrap_or(0.0);
    let damping_ratios: Vec<f64> = (0..MODES).map(|k| ratios.get(k).copied().unwrap_or(last)).collect();
    let at_force = scene.forces.iter().find_map(|force| match force.place {
        Place::Along { at, .. } => Some(at),
        _ => None,
    });
    let stop = TestStop { position: contact.at, gap: contact.gap, side: contact.side, stiffness: contact.stiffness };
    let mut test = TestScene {
        title: scene.title.clone(),
        structure: structure.clone(),
        damping_ratios,
        frequencies_hz: None,
        drive: at_force.unwrap_or(contact.at),
        accelerometers: Vec::new(),
        stop: Some(stop),
        exciter: Exciter::IdealForce,
        noise: Default::default(),
        seed: 1,
        sensors: Vec::new(),
        sample_rate: SAMPLE_RATE,
        control: TestLoop::default(),
        schedule: levels(file, &[1.0])?,
        records: None,
        backbone: None,
        settings: ExtractionSettings { mode: scene.method.mode, ..ExtractionSettings::default() },
        overlays: Vec::new(),
        output_directory: scene.output_directory.clone(),
        warnings: Vec::new(),
    };
    let rig = Rig::new(&test).map_err(|error| refusal::at(file, "structure", error.source.as_ref()))?;
    let highest = rig.bench.omega.iter().copied().fold(0.0, f64::max) / TAU;
    test.sample_rate = SAMPLE_RATE.max((SAMPLES * highest / 1e3).ceil() * 1e3);
    let places = drive_places(&test, &rig).map_err(|error| refusal::at(file, "structure", error.as_ref()))?;
    let mut assumed = vec![format!("an ideal force, {} modes, {} Hz sampling", MODES, number(test.sample_rate))];
    if at_force.is_none() {
        let best = places.iter().min_by(|a, b| a.other_modes.total_cmp(&b.other_modes));
        test.drive = best.map_or(test.drive, |best| best.position_m);
        assumed.push(format!("the drive point at {} m, where other modes are excited least", number(test.drive)));
    }
    let rig = Rig::new(&test).map_err(|error| refusal::at(file, "structure", error.source.as_ref()))?;
    let grazing = grazing(&rig, &test);
    test.schedule = levels(file, &LEVELS.map(|level| level * grazing))?;
    assumed.push(format!(
        "levels from {} to {} times the force of grazing, {} N",
        LEVELS[0],
        LEVELS[5],
        number(grazing)
    ));
    let file = SceneFile { document: file.document.clone(), ..SceneFile::without_text(test, "") };
    Ok(Assumed { file, assumed })
}

/// Force at phase resonance with which the stop is just reached, N; of a stop that touches or presses at rest one
/// newton.
fn grazing(rig: &Rig, test: &TestScene) -> f64 {
    let mode = test.settings.mode - 1;
    let shape = |weights: &[(usize, f64)]| rig.reduction.shape(weights)[mode].abs();
    let (omega, zeta) = (rig.bench.omega[mode], rig.bench.damping_ratios[mode]);
    let amplitude = rig.bench.stop.as_ref().map_or(0.0, |stop| stop.gap / shape(&stop.at.weights));
    let force = 2.0 * zeta * omega * omega * amplitude / shape(&rig.bench.drive.weights);
    if force > 0.0 && force.is_finite() { force } else { 1.0 }
}

/// Levels in their order, with the default times.
fn levels(file: &SceneFile, levels: &[f64]) -> Result<LevelSchedule, RunError> {
    LevelSchedule::new(levels).map_err(|error| refusal::at(file, "structure", &error))
}

fn refused(file: &SceneFile, key: &str, title: &str, help: &str) -> RunError {
    let error: SceneError = file.error_at(key, title, "", &[help]);
    error.into()
}
