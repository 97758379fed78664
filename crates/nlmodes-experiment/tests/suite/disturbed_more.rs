//! Slips that one channel makes alone, stops that nobody described, sensors and modes that are known to a few per cent.

use nlmodes_experiment::extraction::{ExtractionSettings, Finding, RecordExtraction, extract};
use nlmodes_experiment::records::{Channel, Quantity, Record, Role};
use nlmodes_modal::LinearModes;

use crate::disturbed::{at, clean, extracted, names, noisy, settings};

fn amplitude(found: &RecordExtraction) -> f64 {
    found.modal.as_ref().unwrap().amplitude.value
}

fn lag(found: &RecordExtraction) -> f64 {
    found.excitation.as_ref().unwrap().lag.value.to_degrees()
}

/// Before, the force was called wrong, since it brings in by its fundamental what damping takes in all harmonics.
#[test]
fn a_stop_that_nobody_described_makes_no_force_wrong() {
    for number in [0, 1, 2] {
        let base = noisy(clean(number), 2e-4, 0.02, 5);
        let without = ExtractionSettings { stop: None, ..settings() };
        let mut blind = base.clone();
        let i = at(&blind, "f_contact_N");
        blind.channels.remove(i);
        blind.samples.remove(i);
        let mut reversed = base.clone();
        reversed.samples[i].iter_mut().for_each(|x| *x = -*x);
        for (case, record, settings) in [("blind", blind, without), ("reversed", reversed, settings())] {
            let found = extract(&record, &settings).unwrap();
            assert!(!names(&found).contains(&"wrong-scale"), "{number} {case}: {:?}", found.findings);
        }
        // A force of half the size is one still: damping takes more than it brings in.
        let mut half = base.clone();
        let force = at(&half, "force_N");
        half.samples[force].iter_mut().for_each(|x| *x *= 0.2);
        assert!(names(&extracted(&half)).contains(&"wrong-scale"), "{number}");
    }
}

#[test]
fn exchanged_channels_and_wrong_units_are_named_and_leave_the_fit() {
    for number in [0, 3] {
        let base = noisy(clean(number), 2e-4, 0.02, 6);
        let known = amplitude(&extracted(&base));
        let [a, b] = ["a1_mps2", "a2_mps2"].map(|name| at(&base, name));
        let mut exchanged = base.clone();
        exchanged.samples.swap(a, b);
        let mut in_g = base.clone();
        in_g.samples[b].iter_mut().for_each(|x| *x *= 9.806_65);
        for (record, name) in [(exchanged, "exchanged-channels"), (in_g, "wrong-scale")] {
            let found = extracted(&record);
            assert!(names(&found).contains(&name), "{number}: {:?}", found.findings);
            assert!((amplitude(&found) / known - 1.0).abs() < 2e-3, "{number} {name}: {}", amplitude(&found) / known);
        }
    }
}

/// Displacement and velocity at the drive point agree with the others as little with one reversed as with the other:
/// the power of the force tells which.
#[test]
fn the_reversed_one_of_two_channels_at_the_drive_point_is_told_by_the_power() {
    for number in [0, 2, 3] {
        let base = noisy(clean(number), 2e-4, 0.02, 7);
        let known = extracted(&base);
        for name in ["x_drive_m", "v_drive_mps"] {
            let mut record = base.clone();
            let i = at(&record, name);
            record.samples[i].iter_mut().for_each(|x| *x = -*x);
            let found = extracted(&record);
            let told = found
                .findings
                .iter()
                .any(|finding| matches!(finding, Finding::ReversedChannel { channel, .. } if channel == name));
            assert!(told, "{number} {name}: {:?}", found.findings);
            assert!((lag(&found) - lag(&known)).abs() < 0.05, "{number} {name}: {}", lag(&found));
            assert!((amplitude(&found) / amplitude(&known) - 1.0).abs() < 1e-3, "{number} {name}");
        }
    }
}

/// Of the force, of the reference and of another response, early and late in the record; and many of all channels.
#[test]
fn samples_that_one_channel_lost_are_named_with_it_and_set_right() {
    for number in [0, 3] {
        let base = noisy(clean(number), 2e-4, 0.02, 8);
        let known = extracted(&base);
        for (name, place, lost) in [
            ("force_N", 1300, 5),
            ("force_N", 4400, 3),
            ("x_tip_m", 1300, 1),
            ("v_tip_mps", 4400, 1),
            ("a2_mps2", 1300, 9),
        ] {
            let mut record = base.clone();
            let i = at(&record, name);
            for (k, samples) in record.samples.iter_mut().enumerate() {
                if k == i {
                    samples.drain(place..place + lost);
                } else {
                    samples.truncate(samples.len() - lost);
                }
            }
            let found = extracted(&record);
            let told = found.findings.iter().find_map(|finding| match finding {
                Finding::LostSamples { channel: Some(channel), samples, .. } => Some((channel.as_str(), *samples)),
                _ => None,
            });
            assert_eq!(told, Some((name, lost as f64)), "{number}: {:?}", found.findings);
            assert!((lag(&found) - lag(&known)).abs() < 0.03, "{number} {name}: {}", lag(&found) - lag(&known));
            assert!((amplitude(&found) / amplitude(&known) - 1.0).abs() < 2e-4, "{number} {name}");
        }
        let mut record = base.clone();
        record.samples.iter_mut().for_each(|samples| drop(samples.drain(2000..2040)));
        let found = extracted(&record);
        let all = found
            .findings
            .iter()
            .any(|finding| matches!(finding, Finding::LostSamples { channel: None, samples, .. } if *samples == 40.0));
        assert!(all, "{number}: {:?}", found.findings);
        let error = found.omega.uncertainty.hypot(known.omega.uncertainty);
        assert!((found.omega.value - known.omega.value).abs() < 5.0 * error, "{number}: {:?}", found.omega);
    }
}

/// A Hertz contact on a cell that saturates softly looks like a spring: the balance of the modes knows its peak.
#[test]
fn a_cell_that_makes_a_spring_of_a_hertz_contact_is_told_by_the_balance() {
    let mut record = noisy(clean(2), 2e-4, 0.02, 9);
    let i = at(&record, "f_contact_N");
    let peak = record.samples[i].iter().copied().fold(0.0, f64::max);
    record.samples[i].iter_mut().for_each(|x| *x = peak * (*x / peak).tanh());
    let found = extracted(&record);
    let told = found.findings.iter().find_map(|finding| match finding {
        Finding::CellDisagrees { balance, .. } => Some(*balance),
        _ => None,
    });
    assert!(told.is_some_and(|told| (told / peak - 1.0).abs() < 0.05), "{peak}: {:?}", found.findings);
}

/// Two sensors of five modes: the force by the displacements that it makes there. Before, modes without a sensor were
/// left out, and the peak was half again as large.
#[test]
fn two_sensors_have_the_contact_force_of_five_modes() {
    for number in [0, 1, 2] {
        let mut record = noisy(clean(number), 1e-4, 0.02, 10);
        let kept = ["force_N", "x_drive_m", "v_drive_mps", "x_tip_m", "v_tip_mps", "f_contact_N"];
        let taken: Vec<bool> = record.channels.iter().map(|channel| kept.contains(&channel.name.as_str())).collect();
        let mut flags = taken.iter();
        record.channels.retain(|_| *flags.next().unwrap());
        let mut flags = taken.iter();
        record.samples.retain(|_| *flags.next().unwrap());
        let peak = clean(number).samples[at(clean(number), "f_contact_N")].iter().copied().fold(0.0, f64::max);
        let found = extracted(&record);
        let own = found.balance.as_ref().unwrap().peak_force;
        assert!((own.value - peak).abs() < 3.0 * own.uncertainty, "{number}: {own:?} {peak}");
        assert!(own.uncertainty < 0.1 * peak, "{number}: {own:?}");
        // What the other modes add to the motion is known by the forces: before, it was taken for the first two.
        let all = extracted(&noisy(clean(number), 1e-4, 0.02, 10));
        let [ours, theirs] = [&found, &all].map(|found| {
            let modal = found.modal.as_ref().unwrap();
            [modal.amplitude, modal.damping.unwrap()]
        });
        for (a, b) in ours.into_iter().zip(theirs) {
            let off = (a.value - b.value).abs();
            assert!(off < 1e-4 * b.value && off < 4.0 * a.uncertainty.hypot(b.uncertainty), "{number}: {a:?} {b:?}");
        }
    }
}

#[test]
fn what_does_not_reach_the_stop_or_has_a_wrong_force_has_no_force_by_balance() {
    let mut record = noisy(clean(3), 2e-4, 0.02, 11);
    assert_eq!(extracted(&record).balance, None);
    let force = at(&record, "force_N");
    record.samples[force].iter_mut().for_each(|x| *x *= 4.448);
    assert_eq!(extracted(&record).balance, None);
}

/// One mode, one sensor: amplitude goes with the sensor over the shape, damping with force over displacement times the
/// square of the shape.
#[test]
fn stated_errors_of_sensors_and_shapes_are_part_of_those_of_the_results() {
    let (rate, n, omega) = (4000.0, 4000, 251.3);
    let wave =
        |size: f64, phase: f64| (0..n).map(|j| size * (omega * j as f64 / rate + phase).cos()).collect::<Vec<_>>();
    let modes = LinearModes::new(&[0.1], &[250.0], &[0.01], &[vec![2.0]]).unwrap();
    let (of_force, of_sensor, of_shape) = (0.03, 0.02, 0.01);
    let found = |stated: bool| {
        let error = |value: f64| stated.then_some(value);
        let channel = |name: &str, quantity, role, own: f64| Channel {
            uncertainty: error(own),
            ..Channel::new(name, quantity, role, Some(0.1))
        };
        let record = Record::new("made", rate)
            .with(channel("f", Quantity::Force, Role::Excitation, of_force), wave(3.0, 0.0))
            .with(channel("x", Quantity::Displacement, Role::DrivePoint, of_sensor), wave(1e-4, -1.57));
        let settings = ExtractionSettings {
            linear_modes: Some(modes.clone()),
            shape_error: if stated { of_shape } else { 0.0 },
            harmonics: 3,
            pbmif_harmonics: Some(3),
            ..ExtractionSettings::default()
        };
        let found = extract(&record, &settings).unwrap();
        let (modal, excitation) = (found.modal.unwrap(), found.excitation.unwrap());
        let relative = |measured: nlmodes_experiment::extraction::Measured| measured.uncertainty / measured.value;
        [relative(modal.amplitude), relative(modal.damping.unwrap()), relative(excitation.force)]
    };
    let expected = [of_sensor.hypot(of_shape), of_sensor.hypot(of_force).hypot(2.0 * of_shape), of_force];
    for ((stated, silent), expected) in found(true).into_iter().zip(found(false)).zip(expected) {
        // To the second order of such errors.
        assert!((stated / expected - 1.0).abs() < 0.03 && silent < 1e-3 * expected, "{stated} {expected} {silent}");
    }
}

/// The indicator of a resonance is one, whatever the noise adds to the apparent power.
#[test]
fn noise_does_not_lower_the_mode_indicator() {
    for share in [1e-3, 3e-3, 1e-2] {
        let off = |seed: u64| {
            let found = extracted(&noisy(clean(3), share, 0.02, seed));
            let clean = extracted(&noisy(clean(3), 1e-7, 1e-6, seed));
            let pbmif = |found: &RecordExtraction| found.excitation.as_ref().unwrap().pbmif;
            (pbmif(&found).value - pbmif(&clean).value) / pbmif(&found).uncertainty
        };
        let mean = (0..8).map(off).sum::<f64>() / 8.0;
        assert!(mean.abs() < 0.6, "{share}: {mean}");
    }
}

/// The lag of the mode's coordinate is free of what other modes add at a drive point near the clamp; the indicator of
/// all sensors is that of the definition.
#[test]
fn all_sensors_tell_the_phase_of_the_mode() {
    let found = extracted(&noisy(clean(3), 1e-6, 1e-3, 12));
    let excitation = found.excitation.as_ref().unwrap();
    // The force follows the velocity of the mode: a quarter of a turn, whatever the drive point does.
    let modal = excitation.modal_lag.unwrap();
    assert!((modal.value.to_degrees() - 90.0).abs() < 0.02, "{modal:?}");
    let drive = excitation.lag.value;
    assert!((drive.to_degrees() - 90.0).abs() > 0.2, "{}", drive.to_degrees());
    let indicator = excitation.phase_indicator.unwrap();
    let at_drive = found.motion.of(0)[1];
    let phase = at_drive.arg() + drive;
    let of = |weight: &dyn Fn(f64, f64) -> f64| -> f64 {
        (0..found.positions.len())
            .map(|d| {
                let x = found.motion.of(d)[1];
                weight(x.norm() * (x.arg() - phase).cos(), x.norm())
            })
            .sum()
    };
    let expected = 1.0 - of(&|re, size| re.abs() * size) / of(&|_, size| size * size);
    assert!((indicator.value - expected).abs() < 1e-12 && indicator.value < 1.0, "{indicator:?} {expected}");
}

/// Eq. (26): the damping of the harmonics is what they dissipate over the same as that of the fundamental.
#[test]
fn each_harmonic_has_its_damping_and_its_share_of_the_power() {
    let found = extracted(&noisy(clean(1), 1e-6, 1e-3, 13));
    let modal = found.modal.as_ref().unwrap();
    let q = modal.amplitude.value;
    let sum: f64 = (1..)
        .zip(&modal.harmonic_damping)
        .map(|(n, damping)| f64::from(n).powi(2) * q * q * found.omega.value.powi(3) * damping.value)
        .sum();
    assert!((sum / modal.dissipation.total() - 1.0).abs() < 1e-9, "{sum}");
    assert!(modal.harmonic_damping.len() == 20 && modal.harmonic_damping[1].uncertainty > 0.0);
}
