//! Scenes of virtual tests: what must hold between their values.

use std::path::Path;

use nlmodes::experiment::extraction::ExtractionSettings;
use nlmodes::experiment::phase_loop::{LevelSchedule, MAX_LEVELS, SteadyCriteria};
use nlmodes::rig::{Exciter, Shaker};
use nlmodes::virtual_test::{BenchNoise, FORCE, channel_names};

use crate::raw::{RawExciter, RawExtraction, RawNoise, RawSchedule, RawTestScene, RawVirtualTest};
use crate::rule::number;
use crate::scene::{BackboneMethod, ExciterKind, KeptRecords, LevelOrder, TestScene};
use crate::{Diagnostic, Diagnostics};

const SAMPLE_RATE: f64 = 20e3;
/// Most samples of a record: a slip of a unit should not fill the memory.
const MAX_SAMPLES: f64 = 1e7;
/// Most samples of a whole test, some hours of computing.
const MAX_TEST_SAMPLES: f64 = 1e9;

/// The checked scene, or `None` if an error among the diagnostics prevents it. `stem` is the name of the file,
/// `base` its directory.
pub fn scene(raw: &RawTestScene, stem: &str, base: &Path, diagnostics: &mut Diagnostics<'_>) -> Option<TestScene> {
    let test = &raw.virtual_test;
    let stops: Vec<f64> = test.stop.iter().map(|stop| stop.position).collect();
    let structure = super::one_structure(&raw.structure, &stops, diagnostics);
    positions(test, raw.structure.length_m, diagnostics);
    let damping_ratios = damping_ratios(raw, diagnostics);
    let modes = modes(raw, damping_ratios.as_deref(), diagnostics);
    sensors(test, diagnostics);
    let exciter = exciter(test.exciter.as_ref(), diagnostics);
    let schedule = schedule(&test.schedule, exciter, diagnostics);
    let settings = settings(raw.extraction.as_ref(), modes, diagnostics);
    let records = test.records.clone();
    if let (Some(records), Some(schedule)) = (&records, &schedule) {
        kept_levels(records, schedule.count, diagnostics);
    }
    let sample_rate = test.sample_rate_hz.unwrap_or(SAMPLE_RATE);
    if let Some(schedule) = &schedule {
        record_length(schedule.record, sample_rate, diagnostics);
    }
    if test.backbone.is_some() && test.stop.is_none() {
        let diagnostic = Diagnostic::error("a backbone is to be computed, but there is no stop");
        diagnostics.put("virtual_test.backbone", diagnostic, "without a stop the backbone is a straight line");
    }
    test.backbone.iter().for_each(|backbone| each_once(&backbone.methods, diagnostics));
    let scene = TestScene {
        title: raw.title.clone().unwrap_or_else(|| stem.to_owned()),
        structure: structure?,
        damping_ratios: damping_ratios?,
        frequencies_hz: test.frequencies_hz.clone(),
        drive: test.drive_m,
        accelerometers: test.accelerometers_m.clone().unwrap_or_default(),
        stop: test.stop,
        exciter,
        noise: noise(test.noise.as_ref()),
        seed: u64::from(test.seed.unwrap_or(1)),
        sensors: test.sensor.clone().unwrap_or_default(),
        sample_rate,
        control: test.control.unwrap_or_default(),
        schedule: schedule?,
        records,
        backbone: test.backbone.clone(),
        settings: settings?,
        overlays: super::overlays(raw.overlay.as_deref(), base),
        output_directory: super::output_directory(
            raw.output.as_ref().and_then(|output| output.directory.as_ref()),
            stem,
        ),
        warnings: Vec::new(),
    };
    super::plausible::warn_of_test(&scene, diagnostics);
    duration(&scene, diagnostics);
    Some(scene)
}

/// The longest that the test can take, over all levels.
fn duration(scene: &TestScene, diagnostics: &mut Diagnostics<'_>) {
    let schedule = &scene.schedule;
    let level = schedule.ramp + schedule.settling.longest + schedule.record;
    let samples = level * schedule.count as f64 * scene.sample_rate;
    // Also what is not finite.
    let sound = samples <= MAX_TEST_SAMPLES;
    if !sound {
        let diagnostic = Diagnostic::error(format!("the test may take {} samples", number(samples))).help(
            "lower `longest_hold_s`, `ramp_s`, `record_s`, the number of levels or `virtual_test.sample_rate_hz`",
        );
        let label = format!("expected at most {} samples over all levels", number(MAX_TEST_SAMPLES));
        diagnostics.put("virtual_test.schedule", diagnostic, label);
    }
}

/// Each sensor is a channel of the rig, and described once.
fn sensors(test: &RawVirtualTest, diagnostics: &mut Diagnostics<'_>) {
    let channels = channel_names(test.accelerometers_m.as_ref().map_or(0, Vec::len), test.stop.is_some());
    let sensors = test.sensor.as_deref().unwrap_or_default();
    for (i, sensor) in sensors.iter().enumerate() {
        let path = format!("virtual_test.sensor.{i}.channel");
        if !channels.contains(&sensor.channel) {
            let diagnostic = Diagnostic::error(format!("the rig has no channel \"{}\"", sensor.channel));
            diagnostics.put(&path, diagnostic, format!("expected one of {}", channels.join(", ")));
        } else if sensors[..i].iter().any(|other| other.channel == sensor.channel) {
            let diagnostic = Diagnostic::error(format!("channel \"{}\" is described twice", sensor.channel));
            diagnostics.put(&path, diagnostic, "expected each once");
        } else if sensor.mass_kg > 0.0 && sensor.channel != channels[FORCE] {
            let path = format!("virtual_test.sensor.{i}.mass_kg");
            let diagnostic = Diagnostic::error(format!("the sensor of \"{}\" has no moving mass", sensor.channel));
            diagnostics.put(&path, diagnostic, format!("only the force cell, \"{}\", has one", channels[FORCE]));
        }
    }
}

/// Whatever is on the bench beside the structure.
fn positions(test: &RawVirtualTest, length: f64, diagnostics: &mut Diagnostics<'_>) {
    let accelerometers = test.accelerometers_m.iter().flatten().enumerate();
    let accelerometers = accelerometers.map(|(i, x)| (format!("virtual_test.accelerometers_m.{i}"), Some(*x)));
    let stop = test.stop.map(|stop| stop.position);
    let single = [("virtual_test.drive_m", Some(test.drive_m)), ("virtual_test.stop.position_m", stop)];
    for (path, x) in single.map(|(path, x)| (path.to_owned(), x)).into_iter().chain(accelerometers) {
        if x.is_some_and(|x| x > length) {
            let diagnostic =
                Diagnostic::error(format!("`{path}` is beyond the structure, which ends at {} m", number(length)));
            let diagnostic = super::contact::perhaps_millimetres(diagnostic, x.unwrap_or(0.0), length);
            let label =
                format!("found {}, expected a number from 0 to {}, in m", diagnostics.written(&path), number(length));
            diagnostics.put(&path, diagnostic, label);
        }
    }
}

/// Each method once.
fn each_once(methods: &[BackboneMethod], diagnostics: &mut Diagnostics<'_>) {
    if let Some(k) = (1..methods.len()).find(|&k| methods[..k].contains(&methods[k])) {
        let path = "virtual_test.backbone.methods";
        let diagnostic = Diagnostic::error(format!("`{path}` names \"{}\" twice", methods[k].name()));
        diagnostics.put(path, diagnostic, "expected each once");
    }
}

/// Those of the test, or of the structure's imposed modes.
fn damping_ratios(raw: &RawTestScene, diagnostics: &mut Diagnostics<'_>) -> Option<Vec<f64>> {
    const PATH: &str = "virtual_test.damping_ratios";
    let own = raw.virtual_test.damping_ratios.clone();
    let imposed = raw.structure.modes.as_ref();
    let found = own.or_else(|| imposed.and_then(|modes| modes.damping_ratios.clone()));
    if found.is_none() {
        let diagnostic = Diagnostic::error(format!("`{PATH}` is missing"));
        let diagnostic =
            diagnostic.help("so many modes are taken; damping ratios may be given below [structure.modes] too");
        diagnostics.put(PATH, diagnostic, "expected `damping_ratios` in this table: one number from 0 to 0.999 a mode");
    }
    found
}

/// The number of modes, if frequencies and damping ratios agree on it.
fn modes(raw: &RawTestScene, damping_ratios: Option<&[f64]>, diagnostics: &mut Diagnostics<'_>) -> Option<usize> {
    let (modes, test) = (damping_ratios?.len(), &raw.virtual_test);
    let Some(frequencies) = &test.frequencies_hz else { return Some(modes) };
    let path = "virtual_test.frequencies_hz";
    if raw.structure.modes.is_some() {
        let diagnostic = Diagnostic::error("the frequencies of the modes are given twice");
        let diagnostic =
            diagnostic.help("those below [structure.modes] hold for the test and for what is computed beside it");
        diagnostics.put(path, diagnostic, "found beside [structure.modes]");
        return None;
    }
    if frequencies.len() != modes {
        let diagnostic = Diagnostic::error("`virtual_test` needs one damping ratio for each frequency");
        diagnostics.put(
            path,
            diagnostic,
            format!("found {}, expected {modes}, one a damping ratio", frequencies.len()),
        );
        return None;
    }
    super::modes::ascends(frequencies, path, diagnostics).then_some(modes)
}

fn exciter(raw: Option<&RawExciter>, diagnostics: &mut Diagnostics<'_>) -> Exciter {
    let (typical, none) = (Shaker::default(), RawExciter::default());
    let raw = raw.unwrap_or(&none);
    if raw.kind == Some(ExciterKind::Force) {
        let keys = [
            "resistance_ohm",
            "inductance_h",
            "force_constant_n_a",
            "armature_mass_kg",
            "suspension_stiffness_n_m",
            "suspension_damping_n_s_m",
            "stinger_stiffness_n_m",
            "stinger_damping_n_s_m",
        ];
        for path in keys.map(|key| format!("virtual_test.exciter.{key}")) {
            if diagnostics.has(&path) {
                let diagnostic = Diagnostic::warning(format!("`{path}` has no effect"));
                diagnostics.put(&path, diagnostic, "only kind = \"shaker\" uses it");
            }
        }
        return Exciter::IdealForce;
    }
    Exciter::Shaker(Shaker {
        resistance: raw.resistance_ohm.unwrap_or(typical.resistance),
        inductance: raw.inductance_h.unwrap_or(typical.inductance),
        force_constant: raw.force_constant_n_a.unwrap_or(typical.force_constant),
        armature_mass: raw.armature_mass_kg.unwrap_or(typical.armature_mass),
        suspension_stiffness: raw.suspension_stiffness_n_m.unwrap_or(typical.suspension_stiffness),
        suspension_damping: raw.suspension_damping_n_s_m.unwrap_or(typical.suspension_damping),
        stinger_stiffness: raw.stinger_stiffness_n_m.unwrap_or(typical.stinger_stiffness),
        stinger_damping: raw.stinger_damping_n_s_m.unwrap_or(typical.stinger_damping),
    })
}

fn schedule(raw: &RawSchedule, exciter: Exciter, diagnostics: &mut Diagnostics<'_>) -> Option<LevelSchedule> {
    let ((key, levels), (other, wrong), kind) = match exciter {
        Exciter::Shaker(_) => (("levels_v", &raw.levels_v), ("levels_n", &raw.levels_n), "a shaker"),
        Exciter::IdealForce => (("levels_n", &raw.levels_n), ("levels_v", &raw.levels_v), "an ideal force"),
    };
    if wrong.is_some() {
        let path = format!("virtual_test.schedule.{other}");
        let diagnostic = Diagnostic::error(format!("`{path}` is not for {kind}"));
        let diagnostic =
            diagnostic.help("`virtual_test.exciter.kind` says what the exciter is: \"shaker\" or \"force\"");
        diagnostics.put(&path, diagnostic, format!("expected `{key}`: levels of {kind}"));
        return None;
    }
    let path = format!("virtual_test.schedule.{key}");
    if levels.is_none() {
        let diagnostic = Diagnostic::error(format!("`{path}` is missing"));
        diagnostics.put(&path, diagnostic, format!("expected `{key}` in this table: levels of {kind}"));
    }
    let mut levels = levels.clone()?;
    if raw.order == Some(LevelOrder::ThereAndBack) {
        levels.extend_from_within(..levels.len().saturating_sub(1));
        let back = levels.len().div_ceil(2);
        levels[back..].reverse();
    }
    let Ok(schedule) = LevelSchedule::new(&levels) else {
        let diagnostic = Diagnostic::error(format!("the schedule has {} levels", levels.len()));
        let label = format!("expected at most {MAX_LEVELS}, those of the way back included");
        diagnostics.put(&path, diagnostic, label);
        return None;
    };
    let settling = SteadyCriteria::default();
    Some(LevelSchedule {
        ramp: raw.ramp_s.unwrap_or(schedule.ramp),
        record: raw.record_s.unwrap_or(schedule.record),
        settling: SteadyCriteria {
            lag: raw.lag_tolerance_deg.map_or(settling.lag, f64::to_radians),
            frequency_drift: raw.frequency_drift_1_s.unwrap_or(settling.frequency_drift),
            amplitude_drift: raw.amplitude_drift_1_s.unwrap_or(settling.amplitude_drift),
            spread: raw.period_spread.unwrap_or(settling.spread),
            longest: raw.longest_hold_s.unwrap_or(settling.longest),
            ..settling
        },
        ..schedule
    })
}

fn kept_levels(records: &KeptRecords, levels: usize, diagnostics: &mut Diagnostics<'_>) {
    for (i, number) in records.levels.iter().flatten().enumerate() {
        if *number > levels {
            let path = format!("virtual_test.records.levels.{i}");
            let diagnostic = Diagnostic::error(format!("there is no level {number}: the schedule has {levels}"));
            diagnostics.put(&path, diagnostic, format!("expected a whole number from 1 to {levels}"));
        }
    }
}

fn record_length(record: f64, sample_rate: f64, diagnostics: &mut Diagnostics<'_>) {
    let samples = record * sample_rate;
    if samples > MAX_SAMPLES {
        let diagnostic = Diagnostic::error("a record has more samples than can be kept");
        let label = format!("{} samples a channel, expected at most {}", number(samples), number(MAX_SAMPLES));
        let path = ["virtual_test.schedule.record_s", "virtual_test.sample_rate_hz"];
        diagnostics.put(path.into_iter().find(|path| diagnostics.has(path)).unwrap_or(path[0]), diagnostic, label);
    }
}

fn settings(
    raw: Option<&RawExtraction>,
    modes: Option<usize>,
    diagnostics: &mut Diagnostics<'_>,
) -> Option<ExtractionSettings> {
    let default = RawExtraction::default();
    let settings = super::records::extraction(raw.unwrap_or(&default));
    if let Some(n) = modes.filter(|n| settings.mode > *n) {
        let diagnostic = Diagnostic::error(format!("there is no mode {}: `virtual_test` has {n}", settings.mode));
        diagnostics.put("extraction.mode", diagnostic, format!("expected a whole number from 1 to {n}"));
        return None;
    }
    Some(settings)
}

fn noise(raw: Option<&RawNoise>) -> BenchNoise {
    raw.map_or_else(BenchNoise::default, |raw| BenchNoise {
        force: raw.force_n.unwrap_or(0.0),
        displacement: raw.displacement_m.unwrap_or(0.0),
        velocity: raw.velocity_m_s.unwrap_or(0.0),
        acceleration: raw.acceleration_m_s2.unwrap_or(0.0),
        contact_force: raw.contact_force_n.unwrap_or(0.0),
    })
}
