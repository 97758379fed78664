//! Units, signs and places that were described wrong: each is found and named, with its factor.

use crate::support;

use std::f64::consts::TAU;
use std::sync::OnceLock;

use nlmodes_experiment::extraction::{ExtractionSettings, Finding, Stop, extract};
use nlmodes_experiment::records::{Channel, Quantity, Record, Role};
use nlmodes_modal::LinearModes;
use num_complex::Complex64;
use support::autoresonance::Rig;
use support::{Motion, POSITIONS, modes, sampled};

const RATE: f64 = 10_000.0;

/// Below a stop of 2e5 N/m with 2.5 N, or against it with 8 N.
fn rig(force: f64) -> Record {
    static RECORDS: OnceLock<[Record; 2]> = OnceLock::new();
    let made = |force: f64| {
        let rig = Rig {
            modes: modes(),
            drive: 0,
            tip: 3,
            gap: 1e-3,
            stiffness: 2e5,
            exponent: 1.0,
            force,
            sample_rate: RATE,
            noise: 5e-4,
        };
        rig.record("rig", 6.0, 3000, 11)
    };
    RECORDS.get_or_init(|| [made(2.5), made(8.0)])[usize::from(force > 5.0)].clone()
}

fn settings() -> ExtractionSettings {
    ExtractionSettings {
        linear_modes: Some(modes()),
        stop: Some(Stop { position: POSITIONS[3], gap: 1e-3, positive: true }),
        ..ExtractionSettings::default()
    }
}

fn findings(record: &Record, settings: &ExtractionSettings) -> Vec<Finding> {
    extract(record, settings).unwrap().findings
}

/// Units that are declared, and others in which the numbers may have come.
fn units(quantity: Quantity) -> (&'static [&'static str], &'static [&'static str]) {
    match quantity {
        Quantity::Acceleration => (&["m/s^2", "g", "mm/s^2"], &["g", "m/s^2"]),
        Quantity::Velocity => (&["m/s", "mm/s"], &["mm/s", "m/s"]),
        Quantity::Displacement => (&["m", "mm"], &["mm", "m"]),
        _ => (&["N", "kN"], &["kN", "N"]),
    }
}

/// The record with the numbers of a channel taken in another unit than theirs.
fn slipped(record: &Record, channel: usize, declared: &str, true_unit: &str) -> (Record, f64) {
    let mut record = record.clone();
    let quantity = record.channels[channel].quantity;
    let factor = quantity.factor(declared).unwrap() / quantity.factor(true_unit).unwrap();
    record.channels[channel].unit = declared.into();
    record.samples[channel].iter_mut().for_each(|x| *x *= factor);
    (record, factor)
}

#[test]
fn a_unit_slip_of_any_channel_is_named_with_its_factor_and_unit() {
    for force in [2.5, 8.0] {
        let good = rig(force);
        assert_eq!(findings(&good, &settings()), [], "{force} N");
        for (i, channel) in good.channels.iter().enumerate() {
            if channel.name == "f_contact_N" && force < 5.0 {
                continue;
            }
            let (declared, others) = units(channel.quantity);
            for (declared, other) in declared.iter().flat_map(|d| others.iter().map(move |o| (d, o))) {
                let (record, made) = slipped(&good, i, declared, other);
                if (made - 1.0).abs() < 1e-9 {
                    continue;
                }
                let case = format!("{} in {other} declared in {declared}, {force} N", channel.name);
                let found = findings(&record, &settings());
                let named = found.iter().find_map(|finding| match finding {
                    Finding::WrongScale { channel, factor, likely, .. } => Some((channel, *factor, *likely)),
                    _ => None,
                });
                let Some((name, factor, likely)) = named else { panic!("{case}: {found:?}") };
                assert_eq!(name, &channel.name, "{case}: {found:?}");
                assert!((factor / made).ln().abs() < 0.5, "{case}: {factor} {made}");
                let of = |unit: &str| channel.quantity.factor(unit);
                assert_eq!(likely.and_then(of), of(other), "{case}: {found:?}");
            }
        }
    }
}

#[test]
fn records_in_other_units_are_sound_if_they_are_declared() {
    for force in [2.5, 8.0] {
        let mut record = rig(force);
        for channel in &mut record.channels {
            channel.unit = units(channel.quantity).0[1].into();
        }
        assert_eq!(findings(&record, &settings()), []);
    }
}

#[test]
fn all_accelerometers_in_another_unit_are_named_together() {
    let mut record = rig(8.0);
    let accelerometers: Vec<usize> =
        (0..record.channels.len()).filter(|i| record.channels[*i].quantity == Quantity::Acceleration).collect();
    for i in &accelerometers {
        record = slipped(&record, *i, "m/s^2", "g").0;
    }
    let named: Vec<String> = findings(&record, &settings())
        .into_iter()
        .filter_map(|finding| match finding {
            Finding::WrongScale { channel, likely: Some("g"), .. } => Some(channel),
            _ => None,
        })
        .collect();
    assert_eq!(named, ["a1_mps2", "a2_mps2"]);
}

#[test]
fn without_modes_sensors_at_one_place_are_compared() {
    let settings = ExtractionSettings { linear_modes: None, stop: None, ..settings() };
    let (record, _) = slipped(&rig(2.5), 1, "m", "mm");
    assert_eq!(findings(&rig(2.5), &settings), []);
    let found = findings(&record, &settings);
    let [Finding::WrongScale { channel, factor, alternatives, .. }] = &found[..] else { panic!("{found:?}") };
    // One of two is off: either.
    assert!(channel == "x_drive_m" || alternatives.iter().any(|other| other.contains("x_drive_m")), "{found:?}");
    assert!((factor.abs().ln().abs() - 1e3f64.ln()).abs() < 0.1);
}

#[test]
fn a_reversed_response_is_named() {
    for force in [2.5, 8.0] {
        let good = rig(force);
        for i in 1..7 {
            let mut record = good.clone();
            record.samples[i].iter_mut().for_each(|x| *x = -*x);
            let found = findings(&record, &settings());
            let own = &good.channels[i].name;
            let reversed = |f: &Finding| matches!(f, Finding::ReversedChannel { channel, .. } if channel == own);
            assert!(found.iter().any(reversed), "{}: {found:?}", good.channels[i].name);
        }
    }
}

#[test]
fn a_force_at_the_stop_that_pulls_is_reversed() {
    let mut record = rig(8.0);
    record.samples[7].iter_mut().for_each(|x| *x = -*x);
    let found = findings(&record, &settings());
    assert!(
        found.iter().any(|f| matches!(f, Finding::ReversedChannel { channel, .. } if channel == "f_contact_N")),
        "{found:?}"
    );
}

/// With its offset: what it pulls counts from where it rests.
#[test]
fn a_force_that_pulls_from_an_offset_is_reversed_and_offset() {
    let mut record = rig(8.0);
    let peak = record.samples[7].iter().copied().fold(0.0, f64::max);
    record.samples[7].iter_mut().for_each(|x| *x = 0.5 * peak - *x);
    let found = findings(&record, &settings());
    let offset = found.iter().find_map(|f| if let Finding::Offset { offset, .. } = f { Some(*offset) } else { None });
    assert!(offset.is_some_and(|offset| (offset / peak - 0.5).abs() < 0.01), "{found:?}");
    assert!(
        found.iter().any(|f| matches!(f, Finding::ReversedChannel { channel, .. } if channel == "f_contact_N")),
        "{found:?}"
    );
}

/// One of two at a place is off: the other one explains it as well, by the inverse factor or reversed itself.
#[test]
fn what_explains_a_slip_as_well_is_told_with_its_factor() {
    let settings = ExtractionSettings { linear_modes: None, stop: None, ..settings() };
    let mut reversed = rig(2.5);
    reversed.samples[1].iter_mut().for_each(|x| *x = -*x);
    let mut doubled = rig(2.5);
    doubled.samples[1].iter_mut().for_each(|x| *x *= 2.0);
    let names = ["x_drive_m", "v_drive_mps"];
    let other = |channel: &str| names[usize::from(channel == names[0])];
    // Which of them is reversed, the power of the force tells; without one, neither.
    let found = findings(&reversed, &settings);
    let told = |f: &Finding| match f {
        Finding::ReversedChannel { channel, alternatives, .. } => channel == names[0] && alternatives.is_empty(),
        _ => false,
    };
    assert!(found.iter().any(told), "{found:?}");
    reversed.channels.remove(0);
    reversed.samples.remove(0);
    let found = findings(&reversed, &settings);
    let blind = found.iter().find_map(|f| match f {
        Finding::ReversedChannel { channel, alternatives, .. } => Some((channel, alternatives)),
        _ => None,
    });
    let Some((channel, alternatives)) = blind else { panic!("{found:?}") };
    assert_eq!(alternatives[..], [format!("\"{}\", reversed", other(channel))]);
    let found = findings(&doubled, &settings);
    let [Finding::WrongScale { channel, factor, alternatives, .. }] = &found[..] else { panic!("{found:?}") };
    assert!((factor.ln().abs() - 2f64.ln()).abs() < 1e-2, "{factor}");
    let said = alternatives[0].strip_prefix(&format!("\"{}\", by a factor of ", other(channel))).unwrap();
    assert!((said.parse::<f64>().unwrap() * factor - 1.0).abs() < 1e-3, "{said} {factor}");
}

#[test]
fn exchanged_responses_are_named() {
    let good = rig(8.0);
    for (i, j) in [(3, 4), (1, 5), (2, 6)] {
        let mut record = good.clone();
        record.samples.swap(i, j);
        let found = findings(&record, &settings());
        let names = [i, j].map(|i| good.channels[i].name.clone());
        assert!(found.contains(&Finding::ExchangedChannels { channels: names.clone() }), "{names:?}: {found:?}");
    }
}

/// Two modes 1 % apart, the drive point in phase resonance.
#[test]
fn two_modes_at_once_are_in_quadrature_and_it_is_said() {
    let omegas = [TAU * 40.0, TAU * 40.4];
    let shapes = [vec![1.0, 0.9], vec![0.8, -1.0]];
    let close = LinearModes::new(&[0.1, 0.5], &omegas, &[0.005, 0.005], &shapes).unwrap();
    let omega = TAU * 40.2;
    let response = |d: usize| -> Complex64 {
        let of = |k: usize| {
            let w = omegas[k];
            shapes[0][k] * shapes[d][k] / Complex64::new(w * w - omega * omega, 2.0 * 0.005 * w * omega)
        };
        of(0) + of(1)
    };
    let zero = Complex64::default();
    let force = Complex64::from_polar(1.0, response(0).arg() + std::f64::consts::FRAC_PI_2);
    let motion = |q: Complex64, order| sampled(&[zero, q], omega, order, 5000.0, 4321);
    let channel = |name: &str, quantity, role, position| Channel::new(name, quantity, role, Some(position));
    let record = Record::new("close", 5000.0)
        .with(channel("f", Quantity::Force, Role::Excitation, 0.1), motion(force, 0))
        .with(channel("x", Quantity::Displacement, Role::DrivePoint, 0.1), motion(response(0), 0))
        .with(channel("a", Quantity::Acceleration, Role::Response, 0.5), motion(response(1), 2));
    let off = (response(1) / response(0)).arg().to_degrees();
    assert!(off.abs() > 60.0 && off.abs() < 120.0, "{off}");
    for linear_modes in [None, Some(close)] {
        let settings =
            ExtractionSettings { linear_modes, harmonics: 3, pbmif_harmonics: Some(3), ..Default::default() };
        let found = extract(&record, &settings).unwrap();
        assert!(found.excitation.unwrap().pbmif.value > 0.999);
        let said = found.findings.iter().find_map(|finding| match finding {
            Finding::Quadrature { channel, degrees, share } => Some((channel.clone(), *degrees, *share)),
            _ => None,
        });
        let Some((name, degrees, share)) = said else { panic!("{:?}", found.findings) };
        let near = (off - degrees).rem_euclid(180.0);
        assert!(name == "a" && near.min(180.0 - near) < 0.1 && share > 0.5, "{name} {degrees} {off} {share}");
    }
}

/// A decaying vibration of the first mode.
fn decay(zeta: f64, force_noise: f64) -> Record {
    let mut normal = support::Normal::new(4);
    let mut record =
        Motion { force: vec![Complex64::default(); 2], ..Motion::example(TAU * 40.1, 1) }.record(RATE, 6013, 0.0, 1);
    for (channel, samples) in record.channels.iter().zip(&mut record.samples) {
        let fades = channel.quantity != Quantity::Force;
        for (j, x) in samples.iter_mut().enumerate() {
            *x = if fades { *x * (-zeta * TAU * 40.1 * j as f64 / RATE).exp() } else { force_noise * normal.draw() };
        }
    }
    record
}

#[test]
fn a_free_decay_has_its_damping_ratio_and_none_from_a_force() {
    for zeta in [2e-4, 1.9e-3, 8e-3] {
        for noise in [0.0, 1e-3] {
            let found = extract(&decay(zeta, noise), &settings()).unwrap();
            assert!(found.modal.as_ref().is_some_and(|modal| modal.damping.is_none()), "{:?}", found.modal);
            assert!(found.excitation.is_none());
            assert!(found.finding_names().contains("no-signal"), "{}", found.finding_names());
            let told = found.findings.iter().find_map(|finding| match finding {
                Finding::Transient { damping, from_force: None, .. } => Some(*damping),
                _ => None,
            });
            let Some(damping) = told else { panic!("{:?}", found.findings) };
            assert!((damping / zeta - 1.0).abs() < 0.02, "{zeta}: {damping}");
        }
    }
}

#[test]
fn channels_that_are_not_used_are_named() {
    let unused = |record: &Record| -> Vec<String> {
        let of = |finding| match finding {
            Finding::ChannelUnused { channel, .. } => Some(channel),
            _ => None,
        };
        findings(record, &settings()).into_iter().filter_map(of).collect()
    };
    let good = rig(2.5);
    let mut tip = good.clone();
    tip.channels[5].role = Role::DrivePoint;
    assert_eq!(unused(&tip), ["x_tip_m"]);
    // The figures are those of the drive point proper, not of a mean with the tip.
    let [found, known] =
        [&tip, &good].map(|record| extract(record, &settings()).unwrap().modal.unwrap().damping.unwrap());
    assert!((found.value / known.value - 1.0).abs() < 1e-12, "{found:?} {known:?}");
    let mut elsewhere = good.clone();
    (1..3).for_each(|i| elsewhere.channels[i].role = Role::Response);
    elsewhere.channels[5].role = Role::DrivePoint;
    assert_eq!(unused(&elsewhere), ["x_tip_m"]);
    let mut second = rig(8.0);
    second.channels[7].role = Role::Excitation;
    assert_eq!(unused(&second), ["f_contact_N"]);
    let mut nowhere = good;
    nowhere.channels[5].position = None;
    assert_eq!(unused(&nowhere), ["x_tip_m"]);
}

#[test]
fn a_time_axis_in_milliseconds_is_far_from_all_modes() {
    let good = rig(2.5);
    let mut record = Record::new("ms", RATE / 1e3);
    for i in [0, 1, 5] {
        record = record.with(good.channels[i].clone(), good.samples[i].clone());
    }
    let found = findings(&record, &settings());
    let is_own = |hz: f64| (hz / 0.0401 - 1.0).abs() < 1e-3;
    let far = |f: &Finding| matches!(f, Finding::FarFromModes { frequency_hz, .. } if is_own(*frequency_hz));
    assert!(found.iter().any(far), "{found:?}");
}

#[test]
fn a_force_at_the_stop_that_does_not_rest_at_zero_is_said() {
    for force in [2.5, 8.0] {
        let mut record = rig(force);
        record.samples[7].iter_mut().for_each(|x| *x += 3.0);
        let found = findings(&record, &settings());
        let told = found.iter().any(|f| matches!(f, Finding::Offset { offset, .. } if (offset - 3.0).abs() < 0.1));
        assert!(told, "{force}: {found:?}");
    }
}

#[test]
fn a_dead_sensor_is_left_out_and_named() {
    let mut record = rig(2.5);
    record.samples[3].fill(1.5);
    let found = extract(&record, &settings()).unwrap();
    assert_eq!(found.findings[0], Finding::NoSignal { channel: "a1_mps2".into() });
    assert_eq!(found.positions.len(), 3);
}

#[test]
fn without_a_usable_response_there_is_no_point() {
    let mut record = rig(2.5);
    (1..7).for_each(|i| record.samples[i].fill(f64::NAN));
    let error = extract(&record, &settings()).unwrap_err().to_string();
    assert!(error.contains("channel-missing") && error.contains("response"), "{error}");
}
