//! Start, unit, quantity and names of a channel in the header of a Universal File are used.

use crate::support;

use nlmodes_experiment::extraction::{ExtractionSettings, RecordExtraction, extract};
use nlmodes_experiment::records::{
    Abscissa, ByteOrder, Channel, Dataset58, Precision, Quantity, Record, RecordError, Remark, Role, Storage, read_uff,
    write_uff58,
};
use support::{Motion, modes};

const RATE: f64 = 8000.0;
const STORAGES: [Storage; 3] = [Storage::Text, Storage::Binary(ByteOrder::Little), Storage::Binary(ByteOrder::Big)];

fn sound() -> Record {
    Motion::example(std::f64::consts::TAU * 41.3, 12).record(RATE, 900, 0.0, 1)
}

/// The channels of a record as datasets, each with the number of samples that are cut from its begin.
fn datasets(record: &Record, cut: impl Fn(usize) -> usize, uneven: bool) -> Vec<Dataset58> {
    let dataset = |(i, (channel, samples)): (usize, (&Channel, &Vec<f64>))| {
        let first = cut(i) as f64 / RATE;
        let values = samples[cut(i)..].to_vec();
        let abscissa = if uneven {
            Abscissa::Uneven { values: (0..values.len()).map(|j| first + j as f64 / RATE).collect(), rounding: 0.0 }
        } else {
            Abscissa::even(first, 1.0 / RATE)
        };
        let mut dataset = Dataset58::real(values, abscissa);
        dataset.identification[0].clone_from(&channel.name);
        dataset.abscissa_axis.unit = "s".into();
        dataset.ordinate_axis.unit = channel.quantity.si_unit().into();
        dataset
    };
    record.channels.iter().zip(&record.samples).enumerate().map(dataset).collect()
}

fn file(datasets: &[Dataset58], storage: Storage) -> Vec<u8> {
    let mut file = Vec::new();
    datasets.iter().for_each(|dataset| write_uff58(&mut file, dataset, storage, Precision::Double).unwrap());
    file
}

fn read(bytes: &[u8], channels: &[Channel]) -> Result<Record, RecordError> {
    read_uff(bytes).unwrap().into_record("made", channels, None)
}

fn extracted(record: &Record) -> RecordExtraction {
    extract(record, &ExtractionSettings { linear_modes: Some(modes()), ..ExtractionSettings::default() }).unwrap()
}

#[test]
fn channels_that_begin_later_are_put_beside_the_others_in_every_layout() {
    let record = sound();
    let known = extracted(&record);
    for storage in STORAGES {
        for uneven in [false, true] {
            for late in 0..record.channels.len() {
                let cut = |i: usize| if i == late { 40 } else { 0 };
                let found = read(&file(&datasets(&record, cut, uneven), storage), &record.channels).unwrap();
                let case = format!("{storage:?} {uneven} {late}");
                assert_eq!(found.n_samples(), 860, "{case}");
                assert!(matches!(&found.remarks[..], [Remark::StartsDiffer { samples: 860, .. }]), "{case}");
                let found = extracted(&found);
                let lag = |found: &RecordExtraction| found.excitation.as_ref().unwrap().lag.value.to_degrees();
                assert!((lag(&found) - lag(&known)).abs() < 1e-2, "{case}: {} {}", lag(&found), lag(&known));
                let damping = |found: &RecordExtraction| found.modal.as_ref().unwrap().damping.unwrap().value;
                assert!((damping(&found) / damping(&known) - 1.0).abs() < 1e-3, "{case}");
                assert_eq!(found.finding_names(), "starts-differ", "{case}");
            }
        }
    }
}

/// A multiplexer takes one channel after the other: 0.3 samples later each.
#[test]
fn starts_within_a_sample_become_delays() {
    let omega = std::f64::consts::TAU * 41.3;
    let mut record = sound();
    let motion = Motion::example(omega, 12);
    let sets = {
        // The tip, sampled 0.3 samples later.
        let turned: Vec<_> = motion
            .at(3)
            .iter()
            .enumerate()
            .map(|(n, q)| q * num_complex::Complex64::cis(n as f64 * omega * 0.3 / RATE))
            .collect();
        record.samples[5] = support::sampled(&turned, omega, 0, RATE, 900);
        let mut sets = datasets(&record, |_| 0, false);
        sets[5].abscissa = Abscissa::even(0.3 / RATE, 1.0 / RATE);
        sets
    };
    let found = read(&file(&sets, Storage::Text), &record.channels).unwrap();
    assert!((found.channels[5].delay * RATE + 0.3).abs() < 1e-5, "{}", found.channels[5].delay);
    assert!(found.remarks.is_empty() && extracted(&found).findings.is_empty());
}

#[test]
fn starts_with_too_few_digits_or_nothing_in_common_are_refused() {
    let record = sound();
    let mut sets = datasets(&record, |_| 0, false);
    sets.iter_mut().for_each(|set| set.abscissa = Abscissa::even(1234.56, 1.0 / RATE));
    assert!(read(&file(&sets, Storage::Text), &record.channels).is_ok(), "all begin at once");
    sets[0].abscissa = Abscissa::even(1234.57, 1.0 / RATE);
    let error = read(&file(&sets, Storage::Text), &record.channels).unwrap_err();
    assert!(matches!(error, RecordError::StartsUncertain { .. }) && error.to_string().contains("1234.57"), "{error}");
    sets.iter_mut().for_each(|set| set.abscissa = Abscissa::even(0.0, 1.0 / RATE));
    sets[0].abscissa = Abscissa::even(2.0, 1.0 / RATE);
    let error = read(&file(&sets, Storage::Text), &record.channels).unwrap_err();
    assert!(matches!(error, RecordError::NoCommonTime { .. }), "{error}");
}

#[test]
fn units_and_quantities_of_the_header_are_held_against_the_scene() {
    let record = sound();
    let with = |change: &dyn Fn(&mut Dataset58, &mut Channel)| {
        let (mut sets, mut channels) = (datasets(&record, |_| 0, false), record.channels.clone());
        change(&mut sets[4], &mut channels[4]);
        read(&file(&sets, Storage::Binary(ByteOrder::Little)), &channels)
    };
    // An acceleration: its unit, the quantity, in whatever spelling.
    for unit in ["m/s^2", "m/s2", "M/S**2", "mps2", "m/s²", "NONE", "", "EU"] {
        let found = with(&|set, _| set.ordinate_axis.unit = unit.into());
        assert!(found.is_ok_and(|found| found.remarks.is_empty()), "{unit}");
    }
    for unit in ["g", "G", "mm/s^2", "in/s^2", "m/s", "mm", "N", "V"] {
        let error = with(&|set, _| set.ordinate_axis.unit = unit.into()).unwrap_err();
        assert!(matches!(error, RecordError::UnitDisagrees { .. }), "{unit}: {error}");
        let text = error.to_string();
        assert!(text.contains(unit) && text.contains("m/s^2") && text.contains(&record.channels[4].name), "{text}");
    }
    for kind in [8, 11, 13, 3] {
        let error = with(&|set, _| set.ordinate_axis.kind = kind).unwrap_err();
        assert!(matches!(error, RecordError::QuantityDisagrees { .. }), "{kind}: {error}");
    }
    assert!([0, 1, 12].iter().all(|kind| with(&|set, _| set.ordinate_axis.kind = *kind).is_ok()));
    // The same in the scene, or converted by a sensitivity.
    let in_g = with(&|set, channel| {
        set.ordinate_axis.unit = "G".into();
        channel.unit = "g".into();
    });
    assert!(in_g.unwrap().remarks.is_empty());
    let in_volts = with(&|set, channel| {
        set.ordinate_axis.unit = "V".into();
        channel.sensitivity = 0.01;
    });
    assert!(in_volts.unwrap().remarks.is_empty());
    let doubtful = with(&|set, channel| {
        set.ordinate_axis.unit = "g".into();
        channel.sensitivity = 0.01;
    });
    assert!(matches!(&doubtful.unwrap().remarks[..], [Remark::HeaderDisagrees { .. }]));
}

#[test]
fn an_abscissa_in_milliseconds_is_one() {
    let record = sound();
    let mut sets = datasets(&record, |_| 0, false);
    for set in &mut sets {
        set.abscissa = Abscissa::even(0.0, 1e3 / RATE);
        set.abscissa_axis.unit = "ms".into();
    }
    assert!((read(&file(&sets, Storage::Text), &record.channels).unwrap().sample_rate / RATE - 1.0).abs() < 1e-6);
    sets[2].abscissa_axis.unit = "furlong".into();
    assert!(read_uff(&file(&sets, Storage::Text)[..]).unwrap_err().to_string().contains("furlong"));
}

/// The units of the whole file: of displacements, velocities and accelerations, and of forces.
#[test]
fn a_dataset_164_is_held_against_the_scene() {
    let head = |length: f64, force: f64| {
        format!(
            "{:>6}\n{:>6}\n{:>10}{:<20}{:>10}\n{length:25.17e}{force:25.17e}{:25.17e}\n{:25.17e}\n{:>6}\n",
            -1, 164, 10, "a system", 2, 1.0, 273.15, -1
        )
        .replace('e', "D")
    };
    let record = sound();
    let mut sets = datasets(&record, |_| 0, false);
    sets.iter_mut().for_each(|set| set.ordinate_axis.unit = "NONE".into());
    let with = |sets: &[Dataset58], length: f64, force: f64, channels: &[Channel]| {
        let mut bytes = head(length, force).replace("a systDm", "a system").into_bytes();
        bytes.extend(file(sets, Storage::Text));
        read(&bytes, channels)
    };
    assert!(with(&sets, 1.0, 1.0, &record.channels).is_ok());
    for (length, force, said) in [(1e3, 1.0, "x_drive"), (1.0, 1e-3, "force"), (1.0 / 0.0254, 0.2248, "force")] {
        let error = with(&sets, length, force, &record.channels).unwrap_err();
        assert!(matches!(error, RecordError::UnitDisagrees { .. }) && error.to_string().contains(said), "{error}");
    }
    let mut channels = record.channels.clone();
    for channel in &mut channels {
        channel.unit = match channel.quantity {
            Quantity::Force => "kN",
            Quantity::Displacement => "mm",
            Quantity::Velocity => "mm/s",
            _ => "mm/s^2",
        }
        .into();
    }
    assert!(with(&sets, 1e3, 1e-3, &channels).unwrap().remarks.is_empty());
    // A unit given with the channel has priority over that of the file; disagreement is reported.
    for (set, channel) in sets.iter_mut().zip(&record.channels) {
        set.ordinate_axis.unit = channel.quantity.si_unit().into();
    }
    let found = with(&sets, 1e3, 1.0, &record.channels).unwrap();
    assert_eq!(found.remarks.len(), 5, "{:?}", found.remarks);
}

#[test]
fn all_identification_lines_name_a_channel_and_names_that_are_there_are_said() {
    let record = sound();
    let mut sets = datasets(&record, |_| 0, false);
    for (set, line) in sets.iter_mut().zip([4, 1, 2, 3, 4, 4]) {
        let name = std::mem::replace(&mut set.identification[0], "v2;1234".into());
        set.identification[line] = name;
    }
    let bytes = file(&sets, Storage::Text);
    assert_eq!(read(&bytes, &record.channels).unwrap().samples.len(), 6);
    let channel = |name: &str| Channel::new(name, Quantity::Force, Role::Excitation, None);
    let text = read(&bytes, &[channel("fores"), channel("y")]).unwrap_err().to_string();
    assert!(["fores, y", "v2;1234 = force = 0:0", "a_1"].iter().all(|name| text.contains(name)), "{text}");
    assert!(!text.contains("rate"), "{text}");
    let error = read(&bytes, &[channel("v2;1234")]).unwrap_err();
    assert!(matches!(error, RecordError::Ambiguous { count: 6, .. }), "{error}");
    // Some exist: undescribed ones are listed together with missing ones.
    let found = read(&bytes, &[record.channels[0].clone(), record.channels[1].clone(), channel("y")]).unwrap();
    assert!(extracted(&found).findings.iter().any(|finding| finding.to_string().contains("a_2")), "{found:?}");
    sets[0].identification[2] = "also".into();
    let error = read(&file(&sets, Storage::Text), &[record.channels[0].clone(), channel("also")]).unwrap_err();
    assert!(matches!(error, RecordError::SameColumn { .. }), "{error}");
}

/// An entity of more than ten letters shifts node and direction.
#[test]
fn a_long_entity_does_not_hide_the_channel() {
    let record = sound();
    let bytes = file(&datasets(&record, |_| 0, false), Storage::Text);
    let text = String::from_utf8(bytes).unwrap();
    let short = format!("{:<10}{:>10}{:>4} {:<10}{:>10}{:>4}", "NONE", 0, 0, "NONE", 0, 0);
    let long = format!("{:<10}{:>10}{:>4} {:<10}{:>10}{:>4}", "a_long_entity", 7, 3, "NONE", 0, 0);
    assert!(text.contains(&short));
    let found = read(text.replace(&short, &long).as_bytes(), &record.channels).unwrap();
    assert_eq!(found.samples.len(), 6);
    let aliases = &read_uff(text.replace(&short, &long).as_bytes()).unwrap().columns[0].aliases;
    assert!(aliases.contains(&"7:3".to_owned()) && aliases.contains(&"a_long_entity".to_owned()), "{aliases:?}");
}
