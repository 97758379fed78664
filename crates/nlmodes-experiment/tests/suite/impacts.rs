//! A structure in phase resonance against a stop: contact stiffness, gap and modal figures from its record.

use crate::support;

use std::sync::LazyLock;

use nlmodes_experiment::extraction::{ExtractionSettings, Finding, RecordExtraction, Stop, extract};
use nlmodes_experiment::records::Record;
use support::autoresonance::Rig;
use support::{POSITIONS, modes};

fn rig(force: f64, noise: f64) -> Rig {
    Rig {
        modes: modes(),
        drive: 0,
        tip: 3,
        gap: 1e-3,
        stiffness: 4e5,
        exponent: 1.0,
        force,
        sample_rate: 20_000.0,
        noise,
    }
}

/// A record with contact and noise.
static PRESSED: LazyLock<Record> = LazyLock::new(|| recorded(&rig(6.0, 3e-4)));

fn recorded(rig: &Rig) -> Record {
    rig.record("rig", 4.0, 8000, 7)
}

fn extracted(record: &Record) -> RecordExtraction {
    let settings = ExtractionSettings {
        linear_modes: Some(modes()),
        stop: Some(Stop { position: POSITIONS[3], gap: 1e-3, positive: true }),
        ..ExtractionSettings::default()
    };
    extract(record, &settings).unwrap()
}

/// A force that comes three samples late is the same force once that is known.
#[test]
fn the_delay_of_the_force_at_the_stop_is_taken_out() {
    let mut late = PRESSED.clone();
    let force = late.channels.iter().position(|channel| channel.name == "f_contact_N").unwrap();
    late.samples[force].rotate_right(3);
    late.channels[force].delay = 3.0 / late.sample_rate;
    let [before, after] = [extracted(&PRESSED), extracted(&late)].map(|found| found.contact.unwrap().history.unwrap());
    let n = before.force.len();
    // The last three samples are gone.
    assert!(before.force.iter().zip(&after.force).take(n - 3).all(|(a, b)| (a - b).abs() < 1e-9));
}

/// A gap in another unit than the displacements: the stop that the forces tell is elsewhere.
#[test]
fn a_gap_that_is_not_where_the_contact_closes_is_said_with_its_factor() {
    let said = |gap: f64, positive: bool| {
        let settings = ExtractionSettings {
            linear_modes: Some(modes()),
            stop: Some(Stop { position: POSITIONS[3], gap, positive }),
            ..ExtractionSettings::default()
        };
        let found = extract(&PRESSED, &settings).unwrap();
        found.findings.into_iter().find_map(|finding| match finding {
            Finding::WrongScale { channel, factor, against, likely, .. } if against.contains("gap") => {
                Some((channel, factor, against, likely))
            }
            _ => None,
        })
    };
    // A displacement in mm that is called one in m is a thousand times too large; one that is half as much again is in
    // no unit.
    for (gap, unit) in [(1e-6, Some("mm")), (1.25e-6, Some("mm")), (6.7e-7, None), (1.0, None)] {
        let (channel, factor, against, likely) = said(gap, true).unwrap();
        assert_eq!((channel.as_str(), against, likely), ("x_tip_m", format!("the gap of the stop, {gap} m"), unit));
        assert!((factor / (1e-3 / gap) - 1.0).abs() < 1e-3, "{factor}");
    }
    assert!(said(1e-3, true).is_none() && said(1.1e-3, true).is_none());
}

/// Without a displacement at the stop it is the integral of the velocity, which goes with the period: 1 % in the
/// sampling rate is 1 %/√3 in the stiffness.
#[test]
fn a_stiffness_from_velocities_has_the_error_of_the_sampling_rate() {
    let mut record = PRESSED.clone();
    let tip = record.channels.iter().position(|channel| channel.name == "x_tip_m").unwrap();
    record.channels.remove(tip);
    record.samples.remove(tip);
    let settings = ExtractionSettings {
        stop: Some(Stop { position: POSITIONS[3], gap: 1e-3, positive: true }),
        ..ExtractionSettings::default()
    };
    let stiffness = |record: &_| extract(record, &settings).unwrap().contact.unwrap().stiffness.unwrap();
    let sure = stiffness(&record);
    record.rate_error = 0.01;
    let found = stiffness(&record);
    assert_eq!(found.stiffness, sure.stiffness);
    let own = (found.stiffness_error.powi(2) - sure.stiffness_error.powi(2)).sqrt() / found.stiffness;
    let expected = 1.0 - 1.0 / (1.0 + 0.01 / 3f64.sqrt());
    assert!((own / expected - 1.0).abs() < 1e-6, "{own} {expected}");
}

#[test]
fn without_contact_the_modal_figures_are_those_of_the_linear_mode() {
    let found = extracted(&recorded(&rig(2.0, 1e-4)));
    let modal = found.modal.unwrap();
    // The force follows the velocity of the mode itself, so its frequency is the undamped one.
    assert!((found.omega.value / modes().omegas()[0] - 1.0).abs() < 1e-5, "{:?}", found.omega);
    assert!((modal.damping.unwrap().value / 0.0019 - 1.0).abs() < 2e-3, "{:?}", modal.damping);
    assert!(modal.participation.factors[1].abs() < 5e-3, "{:?}", modal.participation);
    let contact = found.contact.unwrap();
    assert!(contact.restitution.is_none() && contact.stiffness.is_none());
    assert!(contact.peak_force.value == 0.0 && contact.closed_fraction == 0.0);
}

#[test]
fn with_contact_stiffness_and_stop_are_recovered_under_noise() {
    let found = extracted(&PRESSED);
    let contact = found.contact.unwrap();
    let stiffness = contact.stiffness.unwrap();
    assert!((stiffness.stiffness / 4e5 - 1.0).abs() < 0.01, "{stiffness:?}");
    assert!((stiffness.stop - 1e-3).abs() < 1e-6, "{stiffness:?}");
    assert!(stiffness.stiffness_error < 4e3 && stiffness.n_intervals >= 10, "{stiffness:?}");
    assert!(found.omega.value > 1.002 * modes().omegas()[0], "the frequency rises: {:?}", found.omega);
    assert!(contact.closed_fraction > 0.02 && contact.closed_fraction < 0.3, "{}", contact.closed_fraction);
    assert!((contact.intervals_per_period - 1.0).abs() < 0.11, "{}", contact.intervals_per_period);
    let excitation = found.excitation.unwrap();
    assert!(excitation.pbmif.value < 0.99 && excitation.pbmif.value > 0.1, "{:?}", excitation.pbmif);
    let restitution = contact.restitution.unwrap();
    assert!(restitution.statistics().mean > 0.0 && restitution.statistics().n_impacts >= 10);
}
