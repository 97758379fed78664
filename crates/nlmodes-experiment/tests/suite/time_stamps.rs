//! Sampling rates given with few digits: effect on results, uncertainty, and a finding.

use crate::support;

use std::f64::consts::TAU;
use std::fmt::Write as _;

use nlmodes_experiment::extraction::{ExtractionSettings, RecordExtraction, extract};
use nlmodes_experiment::records::{Record, Storage, read_csv, read_uff, write_uff};
use support::{Motion, modes};

const RATE: f64 = 5000.0;

fn made(n: usize) -> Record {
    Motion::example(TAU * 40.0, 12).record(RATE, n, 0.0, 1)
}

/// The record as a table whose time stamps have this many decimals.
fn through_csv(record: &Record, decimals: usize, rate: Option<f64>) -> Record {
    let mut text = String::from("t");
    record.channels.iter().for_each(|channel| write!(text, ",{}", channel.name).unwrap());
    for j in 0..record.n_samples() {
        write!(text, "\n{:.decimals$}", j as f64 / RATE).unwrap();
        record.samples.iter().for_each(|samples| write!(text, ",{}", samples[j]).unwrap());
    }
    read_csv(text.as_bytes(), Some("t")).unwrap().into_record("r", &record.channels, rate).unwrap()
}

fn extracted(record: &Record) -> RecordExtraction {
    extract(record, &ExtractionSettings { linear_modes: Some(modes()), ..ExtractionSettings::default() }).unwrap()
}

#[test]
fn coarse_stamps_are_in_frequency_and_uncertainty_and_are_said() {
    for n in [5000, 10_000, 10_003] {
        let found = extracted(&through_csv(&made(n), 3, None));
        let hz = found.omega.times(1.0 / TAU);
        assert!((hz.value - 40.0).abs() < 1e-4, "{n}: {hz:?}");
        // As accurate as the stamps permit: a millisecond over the length of the record, or less.
        let bound = 40.0 * 1e-3 * RATE / n as f64;
        assert!((hz.value - 40.0).abs() < 2.0 * hz.uncertainty && hz.uncertainty < bound, "{n}: {hz:?}");
        assert!(hz.uncertainty > 0.05 * bound, "{n}: {hz:?}");
        assert_eq!(found.finding_names(), "sampling-rate-uncertain");
    }
}

#[test]
fn a_declared_rate_or_fine_stamps_need_no_word() {
    for (decimals, rate) in [(3, Some(RATE)), (6, None), (9, None)] {
        let found = extracted(&through_csv(&made(5000), decimals, rate));
        assert_eq!(found.finding_names(), "");
        assert!((found.omega.value / TAU - 40.0).abs() < 1e-6, "{:?}", found.omega);
    }
}

#[test]
fn damping_amplitude_and_power_carry_the_error_of_the_rate() {
    let record = made(5000);
    let known = extracted(&record);
    let mut blurred = record.clone();
    blurred.rate_error = 1e-3 * 3f64.sqrt();
    let found = extracted(&blurred);
    let relative = |x: nlmodes_experiment::extraction::Measured| x.uncertainty / x.value;
    assert!((relative(found.omega) / 1e-3 - 1.0).abs() < 1e-3);
    // The difference with another rate must be within the stated error: the same samples 0.1 % faster.
    let mut faster = record.clone();
    faster.sample_rate *= 1.001;
    let faster = extracted(&faster);
    let (found, faster, known) = (found.modal.unwrap(), faster.modal.unwrap(), known.modal.unwrap());
    for (found, faster, known) in [
        (found.amplitude, faster.amplitude, known.amplitude),
        (found.damping.unwrap(), faster.damping.unwrap(), known.damping.unwrap()),
        (found.kinetic_energy, faster.kinetic_energy, known.kinetic_energy),
    ] {
        let change = (faster.value - known.value).abs();
        assert!((found.uncertainty - change).abs() < 0.02 * change + known.uncertainty, "{found:?} {change:e}");
        assert!(change > 1e-5 * known.value);
    }
}

#[test]
fn the_header_of_a_universal_file_has_six_digits() {
    let mut record = made(5000);
    record.sample_rate = 5120.7;
    let mut bytes = Vec::new();
    write_uff(&mut bytes, &record, Storage::Text).unwrap();
    let back = read_uff(&bytes[..]).unwrap().into_record("r", &record.channels, None).unwrap();
    let miss = (back.sample_rate / 5120.7 - 1.0).abs();
    assert!(miss > 1e-8 && miss <= back.rate_error && back.rate_error < 5e-6, "{miss:e} {:e}", back.rate_error);
    let found = extracted(&back);
    assert!(found.omega.uncertainty > 0.3 * back.rate_error * found.omega.value);
    let declared = read_uff(&bytes[..]).unwrap().into_record("r", &record.channels, Some(5120.7)).unwrap();
    assert_eq!(declared.rate_error, 0.0);
}
