//! Each finding, produced and detected.

use crate::support;

use std::f64::consts::TAU;

use nlmodes_experiment::extraction::{ExtractionError, ExtractionSettings, Finding, Stop, extract};
use nlmodes_experiment::records::{Record, Role};
use support::{Motion, Normal, modes};

const RATE: f64 = 20_000.0;

fn omega() -> f64 {
    TAU * 40.0
}

fn settings() -> ExtractionSettings {
    ExtractionSettings { linear_modes: Some(modes()), ..ExtractionSettings::default() }
}

fn sound() -> Record {
    Motion::example(omega(), 12).record(RATE, 6_013, 1e-4, 3)
}

fn found(record: &Record, settings: &ExtractionSettings) -> Vec<Finding> {
    extract(record, settings).unwrap().findings
}

/// The only finding, which must have this name.
fn only(record: &Record, settings: &ExtractionSettings, name: &str) -> Finding {
    let findings = found(record, settings);
    let names: Vec<&str> = findings.iter().map(Finding::name).collect();
    assert_eq!(names, [name], "{findings:?}");
    findings.into_iter().next().unwrap()
}

fn channel(record: &Record, name: &str) -> usize {
    record.channels.iter().position(|channel| channel.name == name).unwrap()
}

#[test]
fn a_sound_record_has_no_findings() {
    assert_eq!(found(&sound(), &settings()), []);
}

#[test]
fn a_drifting_frequency_is_found_with_its_size() {
    let mut record = sound();
    let n = record.n_samples() as f64;
    // The clock of the recorder runs 1e-4 faster at the end than at the beginning.
    for samples in &mut record.samples {
        let old = samples.clone();
        for (j, x) in samples.iter_mut().enumerate() {
            let u = j as f64 - n / 2.0;
            let at = (j as f64 + 0.5e-4 * u * u / n - 0.5e-4 * n / 4.0).clamp(0.0, n - 2.0);
            let (k, part) = (at as usize, at.fract());
            *x = old[k] * (1.0 - part) + old[k + 1] * part;
        }
    }
    let finding = found(&record, &settings()).into_iter().find(|finding| finding.name() == "frequency-drift");
    let Some(Finding::FrequencyDrift { change_hz, relative }) = finding else { panic!("{finding:?}") };
    assert!((relative - 1e-4).abs() < 1e-5 && (change_hz - 4e-3).abs() < 4e-4, "{relative} {change_hz}");
}

#[test]
fn a_drifting_amplitude_is_found_with_its_size() {
    let mut record = sound();
    let n = record.n_samples() as f64;
    for samples in &mut record.samples {
        samples.iter_mut().enumerate().for_each(|(j, x)| *x *= 1.0 + 0.02 * (j as f64 / n - 0.5));
    }
    let Finding::AmplitudeDrift { relative } = only(&record, &settings(), "amplitude-drift") else { unreachable!() };
    assert!((relative - 0.02).abs() < 1e-3, "{relative}");
}

#[test]
fn an_aperiodic_part_is_found_with_size_and_frequency() {
    let mut record = sound();
    let force = channel(&record, "force");
    let hum = |j: usize| 0.5 * (TAU * 50.0 * j as f64 / RATE).sin();
    record.samples[force].iter_mut().enumerate().for_each(|(j, x)| *x += hum(j));
    let Finding::Aperiodic { channel, ratio, strongest_hz } = only(&record, &settings(), "aperiodic") else {
        unreachable!()
    };
    assert_eq!(channel, "force");
    assert!((ratio - 0.5 / 6.72).abs() < 0.01 && (strongest_hz - 50.0).abs() < 0.5, "{ratio} {strongest_hz}");
}

#[test]
fn too_short_a_record_is_refused_or_said() {
    let record = |periods: f64| Motion::example(omega(), 12).record(RATE, (periods * 500.0) as usize, 1e-4, 3);
    let error = extract(&record(1.5), &ExtractionSettings { omega: Some(omega()), ..settings() }).unwrap_err();
    let ExtractionError::Refused { finding, .. } = error else { panic!("{error}") };
    let Finding::TooShort { periods, wanted: 2 } = *finding else { panic!("{finding}") };
    assert!((periods - 1.5).abs() < 0.01);
    let wanted = ExtractionSettings { periods: Some(20), ..settings() };
    let Finding::TooShort { periods, wanted } = only(&record(7.5), &wanted, "too-short") else { unreachable!() };
    assert!((periods - 7.5).abs() < 0.01 && wanted == 20);
}

#[test]
fn clipping_is_found_with_and_without_a_known_range() {
    let mut record = sound();
    let tip = channel(&record, "x_tip");
    let limit = 0.97 * record.samples[tip].iter().copied().fold(0.0, f64::max);
    record.samples[tip].iter_mut().for_each(|x| *x = x.min(limit));
    let is_clipped = |record: &Record| {
        let is_tip = |channel: &str, samples: usize| channel == "x_tip" && samples > 100;
        let clipped = |f: &Finding| matches!(f, Finding::Clipped { channel, samples, .. } if is_tip(channel, *samples));
        found(record, &settings()).iter().any(clipped)
    };
    assert!(is_clipped(&record));
    record.channels[tip].range = Some([-2.0 * limit, limit]);
    assert!(is_clipped(&record));
    record.channels[tip].range = Some([-2.0 * limit, 2.0 * limit]);
    assert!(!is_clipped(&record));
}

#[test]
fn missing_channels_are_named_and_the_rest_is_extracted() {
    let mut record = sound();
    record.missing.push("a_9".into());
    let Finding::ChannelMissing { channel, .. } = only(&record, &settings(), "channel-missing") else { unreachable!() };
    assert_eq!(channel, "a_9");
    let mut without_force = sound();
    without_force.channels[0].role = Role::Contact;
    let extraction = extract(&without_force, &settings()).unwrap();
    assert_eq!(extraction.finding_names(), "channel-missing");
    assert!(extraction.excitation.is_none() && extraction.modal.unwrap().damping.is_none());
    let mut without_drive = sound();
    without_drive.channels[0].position = None;
    without_drive.channels.iter_mut().filter(|c| c.role == Role::DrivePoint).for_each(|c| c.role = Role::Response);
    let stop = Some(Stop { position: 0.63, gap: 1e-3, positive: true });
    let extraction = extract(&without_drive, &ExtractionSettings { stop, ..settings() }).unwrap();
    let missing: Vec<String> = extraction.findings.iter().map(ToString::to_string).collect();
    assert!(missing[0].contains("drive-point") && missing[1].contains("contact"), "{missing:?}");
    assert!(extraction.modal.is_some() && extraction.excitation.is_none());
    let empty = Record::new("empty", RATE);
    assert!(matches!(extract(&empty, &settings()), Err(ExtractionError::Refused { .. })));
}

#[test]
fn numbers_that_are_none_are_counted_and_their_channel_left_out() {
    let mut record = sound();
    let a = channel(&record, "a_1");
    record.samples[a][77] = f64::NAN;
    record.samples[a][4000] = f64::INFINITY;
    let extraction = extract(&record, &settings()).unwrap();
    assert_eq!(extraction.findings[0], Finding::NotANumber { channel: "a_1".into(), samples: 2, first: 77 });
    assert_eq!(extraction.positions.len(), 3);
    assert!(extraction.modal.is_some());
}

/// A channel that is one sample late.
fn late(record: &mut Record, name: &str) {
    let late = channel(record, name);
    let samples = &mut record.samples[late];
    samples.rotate_right(1);
    samples[0] = samples[1];
}

#[test]
fn a_sample_of_skew_is_found_beside_its_neighbour() {
    let mut record = sound();
    late(&mut record, "v_drive");
    let Finding::Skew { channel, delay, samples, degrees, against, .. } = only(&record, &settings(), "skew") else {
        unreachable!()
    };
    assert_eq!((channel.as_str(), against.as_str()), ("v_drive", "x_drive"));
    // One sample of 50 µs is 0.72 degrees at 40 Hz.
    assert!((samples - 1.0).abs() < 0.05 && (delay - 5e-5).abs() < 3e-6 && (degrees - 0.72).abs() < 0.04);
}

#[test]
fn a_sample_of_skew_is_found_by_the_linear_modes() {
    // Two modes at four positions: enough to see which one is late.
    let two = modes().restricted(&[0, 1, 2, 3], 2).unwrap();
    let mut motion = Motion::example(omega(), 12);
    motion.eta[2].fill(0.0.into());
    let motion = motion.in_phase_resonance(6.7);
    for name in ["a_1", "a_2", "x_tip"] {
        let mut record = motion.record(RATE, 6_013, 1e-4, 3);
        let settings = ExtractionSettings { linear_modes: Some(two.clone()), ..settings() };
        assert_eq!(found(&record, &settings), []);
        late(&mut record, name);
        let Finding::Skew { channel, samples, .. } = only(&record, &settings, "skew") else { unreachable!() };
        assert_eq!(channel, name);
        assert!((samples - 1.0).abs() < 0.1, "{name}: {samples}");
    }
}

#[test]
fn fewer_sensors_than_modes_are_counted() {
    let mut record = sound();
    for _ in 0..2 {
        let a = record.channels.iter().position(|channel| channel.name.starts_with("a_")).unwrap();
        record.channels.remove(a);
        record.samples.remove(a);
    }
    let finding = only(&record, &settings(), "fewer-sensors-than-modes");
    assert_eq!(finding, Finding::FewerSensorsThanModes { sensors: 2, modes: 3 });
}

#[test]
fn harmonics_beyond_half_the_sampling_rate_are_counted() {
    let record = Motion::example(omega(), 4).record(1000.0, 1000, 1e-4, 3);
    let settings = ExtractionSettings { harmonics: 20, pbmif_harmonics: Some(4), ..settings() };
    // 12 · 40 Hz lies below 500 Hz.
    assert_eq!(only(&record, &settings, "above-nyquist"), Finding::AboveNyquist { wanted: 20, used: 12 });
}

#[test]
fn a_lag_off_phase_resonance_is_said() {
    let mut motion = Motion::example(omega(), 12);
    motion.force[1] *= num_complex::Complex64::cis(-0.1);
    let Finding::NotLocked { lag_deg, target_deg } =
        only(&motion.record(RATE, 6_013, 1e-4, 3), &settings(), "not-locked")
    else {
        unreachable!()
    };
    assert_eq!(target_deg, 90.0);
    let exact = (motion.force[1] / motion.at(0)[1]).arg().to_degrees();
    assert!((lag_deg - exact).abs() < 0.01, "{lag_deg} {exact}");
}

/// A tenth below the reporting threshold, and a tenth above it.
#[test]
fn what_is_worth_telling_begins_where_its_documentation_says() {
    let told = |record: &Record, name: &str| found(record, &settings()).iter().any(|finding| finding.name() == name);
    for (share, is_told) in [(0.9, false), (1.1, true)] {
        // A lag of a degree.
        let motion = Motion::example(omega(), 12);
        let mut lagging = motion.clone();
        lagging.force[1] *= num_complex::Complex64::cis(-share * 1f64.to_radians());
        assert_eq!(told(&lagging.record(RATE, 6_013, 0.0, 3), "not-locked"), is_told, "lag, {share}");
        // Half a sample between two sensors at one place.
        let late = |n: usize, q: &num_complex::Complex64| {
            q * num_complex::Complex64::cis(-(n as f64) * omega() * share * 0.5 / RATE)
        };
        let turned: Vec<_> = motion.at(0).iter().enumerate().map(|(n, q)| late(n, q)).collect();
        let mut skewed = motion.record(RATE, 6_013, 0.0, 3);
        let v = channel(&skewed, "v_drive");
        skewed.samples[v] = support::sampled(&turned, omega(), 1, RATE, 6_013);
        assert_eq!(told(&skewed, "skew"), is_told, "skew, {share}");
        // A power factor of −0.5.
        let mut reversed = motion.clone();
        reversed.force[1] *= num_complex::Complex64::cis((-0.5 * share).acos());
        assert_eq!(told(&reversed.record(RATE, 6_013, 0.0, 3), "reversed-force"), is_told, "reversed, {share}");
        // A hum of two hundredths of the force's effective value, at no harmonic.
        let mut humming = motion.record(RATE, 6_013, 0.0, 3);
        let force = channel(&humming, "force");
        let mean = humming.samples[force].iter().sum::<f64>() / 6_013.0;
        let square = humming.samples[force].iter().map(|x| (x - mean).powi(2)).sum::<f64>() / 6_013.0;
        let size = share * 0.02 * (2.0 * square).sqrt();
        humming.samples[force]
            .iter_mut()
            .enumerate()
            .for_each(|(j, x)| *x += size * (TAU * 55.0 * j as f64 / RATE).sin());
        assert_eq!(told(&humming, "aperiodic"), is_told, "aperiodic, {share}");
        // A swelling by two thousandths.
        let mut swelling = motion.record(RATE, 6_013, 0.0, 3);
        for samples in &mut swelling.samples {
            samples.iter_mut().enumerate().for_each(|(j, x)| *x *= 1.0 + share * 2e-3 * (j as f64 / 6_013.0 - 0.5));
        }
        assert_eq!(told(&swelling, "amplitude-drift"), is_told, "amplitude, {share}");
        // A sampling rate that is known to 2e-5.
        let mut coarse = motion.record(RATE, 6_013, 0.0, 3);
        coarse.rate_error = share * 2e-5;
        assert_eq!(told(&coarse, "sampling-rate-uncertain"), is_told, "sampling rate, {share}");
    }
}

#[test]
fn a_sensor_without_a_row_of_the_modes_is_named() {
    let mut record = sound();
    let a = channel(&record, "a_2");
    record.channels[a].position = Some(0.5);
    let findings = found(&record, &settings());
    assert!(findings.contains(&Finding::PositionWithoutShape { channel: "a_2".into(), position: 0.5 }), "{findings:?}");
}

#[test]
fn noise_alone_is_no_mode() {
    let mut normal = Normal::new(5);
    let mut record = sound();
    record.samples.iter_mut().flatten().for_each(|x| *x = normal.draw());
    match extract(&record, &settings()) {
        Ok(extraction) => assert!(extraction.finding_names().contains("aperiodic"), "{:?}", extraction.findings),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}

#[test]
fn settings_that_make_no_sense_are_refused() {
    for settings in [
        ExtractionSettings { harmonics: 0, ..settings() },
        ExtractionSettings { pbmif_harmonics: Some(0), ..settings() },
        ExtractionSettings { mode: 0, ..settings() },
        ExtractionSettings { mode: 4, ..settings() },
        ExtractionSettings { omega: Some(f64::NAN), ..settings() },
    ] {
        assert!(matches!(extract(&sound(), &settings), Err(ExtractionError::Setting { .. })), "{settings:?}");
    }
}

#[test]
fn degenerate_records_are_errors_or_results_but_no_panics() {
    let shapes: [fn(usize) -> f64; 7] = [
        |_| 0.0,
        |_| 1.0,
        |j| j as f64,
        |j| if j % 2 == 0 { 1.0 } else { -1.0 },
        |j| if j == 3 { 1e300 } else { 0.0 },
        |j| (0.3 * j as f64).sin() * 1e-200,
        |_| f64::NAN,
    ];
    for n in [0, 1, 2, 3, 7, 20, 50, 120] {
        for shape in shapes {
            for omega in [None, Some(1e-3), Some(2000.0), Some(1e9)] {
                let mut record = sound();
                record.samples.iter_mut().for_each(|samples| *samples = (0..n).map(shape).collect());
                let settings = ExtractionSettings { omega, harmonics: 3, ..settings() };
                if let Err(error) = extract(&record, &settings) {
                    assert!(error.to_string().len() > 10, "{error:?}");
                }
            }
        }
    }
}
