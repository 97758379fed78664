//! From a checked scene to the rig.

use std::f64::consts::TAU;

use nlmodes::experiment::phase_loop::{Gains, LoopSettings, Order, PhaseDetector, Resonance};
use nlmodes::modal::LinearModes;
use nlmodes::model::{ContactLaw, Side, StructuralModel};
use nlmodes::rig::{ControlChannels, ControlledHarmonics, ModalReduction, PhaseMargin, PhasePlant};
use nlmodes::virtual_test::{Bench, BenchPoint, BenchStop, DRIVE_DISPLACEMENT, FORCE};

use crate::Failure;
use nlmodes_scene::assemble::{Elements, imposed, moving_kind};
use nlmodes_scene::number;
use nlmodes_scene::scene::{self, LoopDetector, TestScene};

/// Start of the loop below the frequency of the mode, relative.
const BELOW: f64 = 0.0025;
/// Number of positions along the structure at which the largest motion of a mode is sought.
const PLACES: usize = 50;
/// Share of that motion below which the mode has a node: rounding of the shapes.
const NODE: f64 = 1e-9;

/// The rig of a scene.
#[derive(Debug)]
pub struct Rig {
    /// Exciter, stop and sensors.
    pub bench: Bench,
    /// The modes of the structure that are taken, and the flexibility of the others.
    pub reduction: ModalReduction,
    /// Angular eigenfrequencies that the elements give these modes, rad/s.
    pub of_elements: Vec<f64>,
    /// The modes at the sensors.
    pub modes: LinearModes,
    /// The loop.
    pub control: LoopSettings,
}

/// Why there is no rig, and the key of the scene that it is about.
#[derive(Debug)]
pub struct RigRefused {
    pub path: &'static str,
    pub source: Failure,
}

fn at<E: Into<Failure>>(path: &'static str) -> impl Fn(E) -> RigRefused {
    move |error| RigRefused { path, source: error.into() }
}

impl Rig {
    /// The rig.
    ///
    /// # Errors
    /// What the structure or its modes have against it.
    pub fn new(scene: &TestScene) -> Result<Self, RigRefused> {
        let elements = Elements::new(&scene.structure).map_err(at("structure"))?;
        let model = elements.assemble(&[]).map_err(at("structure"))?;
        let imposed = imposed(&scene.structure, &model, None).map_err(at("structure.modes.frequencies_hz"))?;
        let own = imposed.as_ref().map_or_else(Vec::new, |imposed| imposed.own.clone());
        let model = imposed.map_or(model, |imposed| imposed.model);
        let kind = moving_kind(scene.structure.kind());
        let count = scene.damping_ratios.len();
        let reduction = ModalReduction::new(model.mass(), model.stiffness(), model.dofs(), kind, count)
            .map_err(at("virtual_test.damping_ratios"))?;
        let point = |position: f64, path| -> Result<BenchPoint, RigRefused> {
            let weights = elements.displacement_at(&model, position).map_err(at(path))?;
            Ok(BenchPoint { position, weights })
        };
        let accelerometers = scene.accelerometers.iter().map(|x| point(*x, "virtual_test.accelerometers_m"));
        let stop = scene.stop.map(|s| Ok(stop(&s, point(s.position, "virtual_test.stop.position_m")?))).transpose()?;
        let omega = match &scene.frequencies_hz {
            Some(frequencies) => frequencies.iter().map(|hz| TAU * hz).collect(),
            None => reduction.omega().to_vec(),
        };
        let beyond = reduction.omega().iter().skip(own.len());
        let of_elements = own.iter().take(count).chain(beyond).copied().collect();
        let bench = Bench {
            omega,
            damping_ratios: scene.damping_ratios.clone(),
            drive: point(scene.drive, "virtual_test.drive_m")?,
            stop,
            accelerometers: accelerometers.collect::<Result<_, _>>()?,
            exciter: scene.exciter,
            interval: 1.0 / scene.sample_rate,
            noise: scene.noise,
            seed: scene.seed,
            chains: scene.sensors.iter().map(|sensor| (sensor.channel.clone(), sensor.chain())).collect(),
        };
        moves(scene, (&elements, &model, &reduction), &bench.drive)?;
        let modes = bench.linear_modes(&reduction).map_err(at("virtual_test"))?;
        let control = control(scene, &bench, &reduction);
        Ok(Self { bench, reduction, of_elements, modes, control })
    }
}

impl Rig {
    /// Phase margin of the loop below contact, with its exciter.
    pub fn phase_margin(&self, gains: Gains) -> Option<PhaseMargin> {
        let settings = &self.control;
        let low_pass = settings.detector.low_pass(settings.cut_off);
        plant(&self.bench, &self.reduction, settings.resonance.omega).margin(gains, low_pass)
    }

    /// The harmonics of the force up to this one, with the sensors and modes that the extraction has; none beyond the
    /// first.
    pub fn controlled_harmonics(&self, harmonics: usize) -> Option<ControlledHarmonics> {
        (harmonics > 1).then(|| self.bench.controlled_harmonics(harmonics, self.modes.clone()))
    }
}

/// An exciter where the mode does not move excites nothing, and its motion sensors read nothing.
fn moves(
    scene: &TestScene,
    (elements, model, reduction): (&Elements, &StructuralModel, &ModalReduction),
    drive: &BenchPoint,
) -> Result<(), RigRefused> {
    let mode = scene.settings.mode;
    let shape = |weights: &[(usize, f64)]| reduction.shape(weights).get(mode - 1).map_or(0.0, |shape| shape.abs());
    let step = scene.structure.length / PLACES as f64;
    let places = (0..=PLACES).filter_map(|k| elements.displacement_at(model, k as f64 * step).ok());
    let largest = places.map(|weights| shape(&weights)).fold(0.0, f64::max);
    if shape(&drive.weights) > NODE * largest {
        return Ok(());
    }
    let said = format!("the exciter is where mode {mode} does not move, at {} m", number(scene.drive));
    Err(RigRefused { path: "virtual_test.drive_m", source: said.into() })
}

fn stop(stop: &scene::TestStop, at: BenchPoint) -> BenchStop {
    let side = match stop.side {
        scene::Side::Positive => Side::Positive,
        scene::Side::Negative => Side::Negative,
    };
    let law = stop.stiffness.map_or(ContactLaw::Rigid, |stiffness| ContactLaw::Elastic { stiffness });
    BenchStop { at, side, gap: stop.gap, law }
}

/// The plant that the loop of a bench controls, at the frequency of a mode (rad/s).
fn plant(bench: &Bench, reduction: &ModalReduction, omega: f64) -> PhasePlant {
    PhasePlant::new(&bench.setup(reduction), &ControlChannels::new(FORCE, DRIVE_DISPLACEMENT), omega)
}

fn control(scene: &TestScene, bench: &Bench, reduction: &ModalReduction) -> LoopSettings {
    // A checked scene has no mode beyond those of the bench.
    let mode = (scene.settings.mode - 1).min(bench.omega.len() - 1);
    let resonance = Resonance { omega: bench.omega[mode], damping_ratio: bench.damping_ratios[mode] };
    let wanted = &scene.control;
    let start = wanted.start_hz.map_or((1.0 - BELOW) * resonance.omega, |hz| TAU * hz);
    let settings = LoopSettings::new(resonance, start, bench.interval);
    let settings = LoopSettings {
        displacement_lag: wanted.lag_deg.to_radians(),
        detector: match wanted.detector {
            LoopDetector::Adaptive => PhaseDetector::default(),
            LoopDetector::Demodulation => PhaseDetector::Demodulation { order: Order::default() },
        },
        cut_off: wanted.cut_off_hz.map_or(settings.cut_off, |hz| TAU * hz),
        ..settings
    };
    // Gains of an ideal force are those of no shaker; where none are sound for this one, the loop's own are left to
    // the multipliers to judge.
    let low_pass = settings.detector.low_pass(settings.cut_off);
    let gains = plant(bench, reduction, resonance.omega).design(low_pass);
    LoopSettings { gains: gains.filter(|gains| gains.check(resonance, low_pass).is_ok()), ..settings }
}
