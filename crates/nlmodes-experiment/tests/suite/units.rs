//! Results do not depend on the size of a motion, nor on how fast it is.

use crate::support;

use nlmodes_experiment::extraction::{ExtractionSettings, Finding, RecordExtraction, Stop, extract};
use nlmodes_experiment::records::{Quantity, Record};
use nlmodes_modal::LinearModes;
use support::autoresonance::Rig;
use support::{POSITIONS, modes};

const GAP: f64 = 1e-3;

/// The same with displacements `size` times as large and everything `fast` times as fast: the masses stay, so that
/// forces go with both.
fn scaled(record: &Record, size: f64, fast: f64) -> Record {
    let mut record = record.clone();
    record.sample_rate *= fast;
    for (channel, samples) in record.channels.iter().zip(&mut record.samples) {
        let order = match channel.quantity {
            Quantity::Displacement => 0,
            Quantity::Velocity => 1,
            Quantity::Acceleration | Quantity::Force => 2,
            other => panic!("{other:?}"),
        };
        samples.iter_mut().for_each(|x| *x *= size * fast.powi(order));
    }
    record
}

fn extracted(record: &Record, size: f64, fast: f64) -> RecordExtraction {
    let modes = modes();
    let omegas: Vec<f64> = modes.omegas().iter().map(|omega| fast * omega).collect();
    let shape = |d: usize| (0..modes.n_modes()).map(|k| modes.shape(d, k)).collect::<Vec<f64>>();
    let shapes: Vec<Vec<f64>> = (0..POSITIONS.len()).map(shape).collect();
    let settings = ExtractionSettings {
        linear_modes: Some(LinearModes::new(&POSITIONS, &omegas, modes.damping_ratios(), &shapes).unwrap()),
        stop: Some(Stop { position: POSITIONS[3], gap: GAP * size, positive: true }),
        ..ExtractionSettings::default()
    };
    extract(&scaled(record, size, fast), &settings).unwrap()
}

/// Numbers of a result, each over its powers of size and speed.
fn numbers(found: &RecordExtraction, size: f64, fast: f64) -> Vec<(&'static str, f64)> {
    let over = |a: i32, b: i32, value: f64| value / size.powi(a) / fast.powi(b);
    let mut all = vec![("frequency", over(0, 1, found.omega.value))];
    let modal = found.modal.as_ref().unwrap();
    all.extend([
        ("modal amplitude", over(1, 0, modal.amplitude.value)),
        ("its error", over(1, 0, modal.amplitude.uncertainty)),
        ("damping", modal.damping.unwrap().value),
        ("dissipation", over(2, 3, modal.dissipation.total())),
        ("kinetic energy", over(2, 2, modal.kinetic_energy.value)),
    ]);
    let excitation = found.excitation.as_ref().unwrap();
    all.extend([
        ("power", over(2, 3, excitation.fundamental_power.value)),
        ("indicator", excitation.pbmif.value),
        ("force", over(1, 2, excitation.force.value)),
        ("lag", excitation.lag.value),
    ]);
    let contact = found.contact.as_ref().unwrap();
    all.extend([
        ("largest contact force", over(1, 2, contact.peak_force.value)),
        ("share of contact", contact.closed_fraction),
        ("touches", contact.intervals_per_period),
    ]);
    all.extend(contact.stiffness.iter().flat_map(|line| {
        [
            ("stiffness", over(0, 2, line.stiffness)),
            ("its error", over(0, 2, line.stiffness_error)),
            ("stop", over(1, 0, line.stop)),
        ]
    }));
    let largest = |series: &[f64]| series.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    all.extend(contact.history.iter().flat_map(|history| {
        [
            ("displacement at the stop", over(1, 0, largest(&history.displacement))),
            ("velocity there", over(1, 1, largest(&history.velocity))),
            ("acceleration there", over(1, 2, largest(&history.acceleration))),
        ]
    }));
    let restitution = contact.restitution.iter().map(|restitution| restitution.statistics());
    all.extend(restitution.flat_map(|r| [("restitution", r.mean), ("approach", over(1, 1, r.approach))]));
    all
}

#[test]
fn sizes_and_speeds_of_a_motion_only_scale_what_is_found() {
    let rig = Rig {
        modes: modes(),
        drive: 0,
        tip: 3,
        gap: GAP,
        stiffness: 2e5,
        exponent: 1.0,
        force: 8.0,
        sample_rate: 10_000.0,
        noise: 5e-4,
    };
    let against = rig.record("rig", 1.0, 2500, 11);
    let below = Rig { force: 2.5, ..rig }.record("rig", 1.0, 2500, 11);
    // An accelerometer in another unit, a force that is reversed, a channel that is late.
    let place = |quantity: Quantity| against.channels.iter().position(|channel| channel.quantity == quantity).unwrap();
    let [mut slipped, mut reversed, mut late] = [&against, &below, &against].map(Record::clone);
    slipped.samples[place(Quantity::Acceleration)].iter_mut().for_each(|x| *x *= 9.81);
    reversed.samples[place(Quantity::Force)].iter_mut().for_each(|x| *x = -*x);
    late.samples[place(Quantity::Velocity)].rotate_right(3);
    let mut told = 0;
    for (number, record) in [against, below, slipped, reversed, late].iter().enumerate() {
        let usual = extracted(record, 1.0, 1.0);
        told += usual.findings.len();
        let expected = numbers(&usual, 1.0, 1.0);
        for (size, fast) in [(1e-6, 1.0), (1.0, 1e-8), (1e4, 1e3)] {
            let found = extracted(record, size, fast);
            let names = |found: &RecordExtraction| found.findings.iter().map(Finding::name).collect::<Vec<_>>();
            assert_eq!(names(&found), names(&usual), "{number}, {size:e}, {fast:e}: {:?}", found.findings);
            for (a, b) in found.findings.iter().zip(&usual.findings) {
                if let (Finding::WrongScale { factor: a, channel, .. }, Finding::WrongScale { factor: b, .. }) = (a, b)
                {
                    assert!((a / b - 1.0).abs() < 1e-5, "{number} {channel}: {a} {b}");
                }
            }
            for ((what, a), (_, b)) in numbers(&found, size, fast).into_iter().zip(&expected) {
                assert!((a - b).abs() <= 1e-5 * b.abs(), "{number}, {size:e}, {fast:e}, {what}: {a:e} {b:e}");
            }
        }
    }
    assert!(told >= 3, "{told}");
}
