//! Planning of a test: drive point, levels, what the sensors will see, and which levels phase control holds.

mod of_structure;
mod places;
mod words;

use std::f64::consts::TAU;
use std::ops::ControlFlow;
use std::path::Path;

use nlmodes::experiment::extraction::ExtractionSettings;
use nlmodes::experiment::phase_loop::PhaseLockedLoop;
use nlmodes::experiment::records::Channel;
use nlmodes::report::write_summary;
use nlmodes::rig::{Exciter, HeldLevel, LockedMotion};
use nlmodes::virtual_test::{self, TestLevel};
use nlmodes_scene::SceneFile;
use nlmodes_scene::scene::TestScene;
use serde::Serialize;

use crate::virtual_test::{Rig, levels_ahead, prepared, warning};
use crate::{Event, Failure, Observer, RunError, chain, links, refusal};

pub use of_structure::{Assumed, of_structure};
pub use places::DrivePlace;
pub use words::in_words;

/// Name of the file.
pub const FILE: &str = "design.json";
/// What a sensor should carry over what it is expected to see.
const RESERVE: f64 = 1.5;

/// What a test is expected to need.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Design {
    /// What was assumed where the scene says nothing.
    pub assumed: Vec<String>,
    /// Position of the exciter, m.
    pub drive_m: f64,
    /// Places for it.
    pub drive_places: Vec<DrivePlace>,
    /// The loop.
    pub control: Control,
    /// Unit of the levels, "N" or "V".
    pub level_unit: &'static str,
    /// The levels, in the order of the schedule.
    pub levels: Vec<Level>,
    /// Ranges for the sensors.
    pub ranges: Vec<Range>,
    /// How `held` was found, and what was not looked at.
    pub held_by: &'static str,
    /// Why there are fewer levels than in the schedule, if there are.
    pub ended: Option<String>,
}

/// Settings of the loop.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Control {
    /// Frequency at which it begins, Hz.
    pub start_frequency_hz: f64,
    /// Cut-off of the detector, Hz.
    pub cut_off_hz: f64,
    /// Proportional gain, 1/s.
    pub proportional_1_s: Option<f64>,
    /// Integral gain, 1/s².
    pub integral_1_s2: Option<f64>,
    /// Phase margin below contact, of structure, exciter and sensor filters together, degrees.
    pub phase_margin_deg: Option<f64>,
    /// Frequency of unit loop gain, Hz.
    pub crossover_hz: Option<f64>,
    /// Sampling rate, Hz.
    pub sample_rate_hz: f64,
}

/// A level.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Level {
    /// Amplitude of the drive, in the unit of the levels.
    pub level: f64,
    /// Whether the loop holds it: lag, frequency, amplitude and periods settle.
    pub held: bool,
    /// What does not settle.
    pub findings: Vec<String>,
    /// Magnitude of the largest Floquet multiplier of rig and control together: below 1 the control holds the level.
    /// None where higher harmonics are controlled, and where no periodic motion was found.
    pub largest_multiplier: Option<f64>,
    /// Angle of that multiplier, in degrees: 0 a drift, 180 a motion of two periods.
    pub multiplier_angle_deg: Option<f64>,
    /// Time until it is settled by its multipliers, s; none if never.
    pub settling_by_multipliers_s: Option<f64>,
    /// Whether the level continues the motion of the one before; otherwise the motion jumps there.
    pub jumps: bool,
    /// The largest multiplier with the amplitude of the response under control, where phase control alone loses it.
    pub largest_multiplier_by_amplitude: Option<f64>,
    /// Why the multipliers say that it is not held.
    pub announced: Option<String>,
    /// Time until it is settled, s; the longest that is allowed where it is not.
    pub settling_s: f64,
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Modal amplitude, m √kg.
    pub modal_amplitude: Option<f64>,
    /// Amplitude of the force in its fundamental, N.
    pub force_n: f64,
    /// Largest contact force of the mean period, N; single periods are among the peaks.
    pub peak_contact_force_n: Option<f64>,
    /// Largest reading of each channel, in its SI unit.
    pub peaks: Vec<Peak>,
}

/// Largest reading of a channel.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Peak {
    /// Its name.
    pub channel: String,
    /// Largest size, in the unit.
    pub value: f64,
    /// SI unit.
    pub unit: &'static str,
}

/// Range of a sensor.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Range {
    /// Name of the channel.
    pub channel: String,
    /// Largest reading over all levels.
    pub largest: f64,
    /// Range that a sensor should have: half as much again, rounded up to 1, 2 or 5.
    pub range: f64,
    /// SI unit.
    pub unit: &'static str,
}

/// Runs the test of the scene on its virtual rig, level by level, and tells what it needs; writes nothing.
///
/// # Errors
/// [`RunError`] if the rig cannot be made.
pub fn design(file: &SceneFile<TestScene>, observer: &mut dyn Observer) -> Result<Design, RunError> {
    let scene = &file.scene;
    let (rig, test) = prepared(file)?;
    let drive_places =
        places::drive_places(scene, &rig).map_err(|error| refusal::at(file, "structure", error.as_ref()))?;
    let settings = ExtractionSettings {
        linear_modes: Some(rig.modes.clone()),
        stop: rig.bench.extraction_stop(),
        ..scene.settings.clone()
    };
    let ahead = levels_ahead(&test, &observer.watch())
        .map_err(|error| RunError::NotRecorded { directory: scene.output_directory.clone(), reason: chain(&error) })?;
    let (mut count, mut levels) = (0, Vec::new());
    let run = virtual_test::run_while(&test, &settings, &observer.watch(), |level| {
        count += 1;
        observer.event(Event::Level { scene, number: count, level });
        levels.push(of_level(level, ahead.get(count - 1).map(|ahead| (ahead, warning(scene, count, ahead)))));
        if observer.is_cancelled() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    let ended = run.failure.map(|error| chain(&error));
    Ok(Design {
        assumed: Vec::new(),
        drive_m: scene.drive,
        drive_places,
        control: control(&rig, scene),
        level_unit: match scene.exciter {
            Exciter::Shaker(_) => "V",
            Exciter::IdealForce => "N",
        },
        ranges: ranges(&levels),
        levels,
        held_by: "time integration of structure, stop, exciter, detector and controller at each level: a level counts \
                  as held if lag, frequency, amplitude and single periods settle within virtual_test.schedule. |μ| \
                  is the largest Floquet multiplier of all of them together, for a motion that is followed from \
                  level to level: below 1 it is held, the smaller the faster. Other motions at the same level are \
                  not looked for",
        ended,
    })
}

/// Writes the design.
///
/// # Errors
/// If the file cannot be written.
pub fn write(design: &Design, directory: &Path) -> Result<(), Failure> {
    links::refuse(directory)?;
    std::fs::create_dir_all(directory)?;
    Ok(write_summary(directory.join(FILE), &serde_json::to_value(design)?)?)
}

fn control(rig: &Rig, scene: &TestScene) -> Control {
    let settings = &rig.control;
    let gains = PhaseLockedLoop::new(settings.clone()).ok().map(|control| control.gains());
    let margin = gains.and_then(|gains| rig.phase_margin(gains));
    Control {
        phase_margin_deg: margin.map(|margin| margin.degrees),
        crossover_hz: margin.map(|margin| margin.crossover / TAU),
        start_frequency_hz: settings.start / TAU,
        cut_off_hz: settings.cut_off / TAU,
        proportional_1_s: gains.map(|gains| gains.proportional),
        integral_1_s2: gains.map(|gains| gains.integral),
        sample_rate_hz: scene.sample_rate,
    }
}

fn of_level(level: &TestLevel, ahead: Option<(&HeldLevel, Option<String>)>) -> Level {
    let motion = ahead.as_ref().and_then(|(ahead, _)| ahead.motion.as_ref());
    let by_amplitude = ahead.as_ref().and_then(|(ahead, _)| ahead.by_amplitude.as_ref());
    let (outcome, found) = (&level.outcome, level.extraction.as_ref().ok());
    let record = &outcome.record;
    let peaks = record.channels.iter().zip(&record.samples).filter(|(channel, _)| channel.quantity.si_unit() != "rad");
    let peak = |(channel, samples): (&Channel, &Vec<f64>)| Peak {
        channel: channel.name.clone(),
        value: samples.iter().fold(0.0, |m: f64, x| m.max(x.abs())),
        unit: channel.quantity.si_unit(),
    };
    Level {
        level: outcome.level,
        held: outcome.findings.is_empty(),
        findings: outcome.findings.iter().map(|finding| finding.name().to_owned()).collect(),
        largest_multiplier: motion.map(LockedMotion::largest),
        multiplier_angle_deg: motion.and_then(|motion| Some(motion.multipliers.first()?.arg().to_degrees().abs())),
        settling_by_multipliers_s: ahead.as_ref().map(|(ahead, _)| ahead.settling).filter(|time| time.is_finite()),
        jumps: ahead.as_ref().is_some_and(|(ahead, _)| ahead.jumped),
        largest_multiplier_by_amplitude: by_amplitude.map(LockedMotion::largest),
        settling_s: outcome.settling,
        frequency_hz: outcome.steady.omega / TAU,
        modal_amplitude: found.and_then(|found| Some(found.modal.as_ref()?.amplitude.value)),
        force_n: outcome.steady.force,
        peak_contact_force_n: found.and_then(|found| Some(found.contact.as_ref()?.peak_force.value)),
        peaks: peaks.map(peak).collect(),
        announced: ahead.and_then(|(_, warning)| warning),
    }
}

fn ranges(levels: &[Level]) -> Vec<Range> {
    let Some(first) = levels.first() else { return Vec::new() };
    let range = |(k, peak): (usize, &Peak)| {
        let largest = levels.iter().filter_map(|level| level.peaks.get(k)).fold(0.0, |m: f64, peak| m.max(peak.value));
        Range { channel: peak.channel.clone(), largest, range: round_up(RESERVE * largest), unit: peak.unit }
    };
    first.peaks.iter().enumerate().map(range).collect()
}

/// The next of 1, 2, 5, 10 … with its decade.
fn round_up(x: f64) -> f64 {
    if x <= 0.0 || !x.is_finite() {
        return x;
    }
    let decade = 10f64.powf(x.log10().floor());
    let step = [1.0, 2.0, 5.0].into_iter().find(|step| x <= step * decade * (1.0 + 1e-12));
    step.unwrap_or(10.0) * decade
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_those_that_sensors_have() {
        for (x, range) in [(0.9, 1.0), (1.0, 1.0), (1.3, 2.0), (4.1e-3, 5e-3), (62.0, 100.0), (2e-9, 2e-9)] {
            assert!((round_up(x) / range - 1.0).abs() < 1e-9, "{x}: {}", round_up(x));
        }
        assert_eq!(round_up(0.0), 0.0);
    }
}
