//! TDMS files: `contiguous.tdms` was written by nptdms 1.13 in two segments, the others by hand, with the numbers that
//! nptdms reads from them.

use std::f64::consts::TAU;
use std::io::Cursor;

use nlmodes_experiment::records::{Channel, Quantity, RecordError, RecordTable, Role, read_tdms};

const CONTIGUOUS: &[u8] = include_bytes!("tdms/contiguous.tdms");
const DAQMX: &[u8] = include_bytes!("tdms/daqmx.tdms");
const INTERLEAVED: [&[u8]; 2] =
    [include_bytes!("tdms/interleaved_le.tdms"), include_bytes!("tdms/interleaved_be.tdms")];

fn read(bytes: &[u8]) -> Result<RecordTable, RecordError> {
    read_tdms(Cursor::new(bytes))
}

#[test]
fn channels_of_a_file_of_another_program_have_rate_start_unit_and_scale() {
    let table = read(CONTIGUOUS).unwrap();
    assert_eq!(table.names(), "Vib/force, Vib/x, Vib/it's 32");
    let [force, x, single] = &table.columns[..] else { panic!("{}", table.names()) };
    for (j, (f, x)) in force.values.iter().zip(&x.values).enumerate() {
        let phase = TAU * 40.0 * j as f64 / 5120.0;
        assert!((f - 3.0 * phase.cos()).abs() < 1e-13);
        // Sixteen bits over a scale.
        assert!((x - (phase.sin() * 30_000.0).round_ties_even() / 30_000.0).abs() < 1e-15);
        assert_eq!(single.values[j], f64::from(*f as f32));
    }
    assert_eq!((force.values.len(), single.aliases[0].as_str(), x.declared.unit.as_str()), (300, "it's 32", "mm"));
    assert!((x.rate.unwrap().hz / 5120.0 - 1.0).abs() < 1e-15 && x.start.unwrap().at == 0.25);
    // Under a name of its own, in SI, at the time of the file.
    let mut channel = Channel::new("x", Quantity::Displacement, Role::DrivePoint, None);
    channel.unit = "mm".into();
    let record = table.clone().into_record("r", &[channel.clone()], None).unwrap();
    assert!((record.samples[0][1] / 4.906_666_666e-5 - 1.0).abs() < 1e-8 && record.start == 0.25);
    channel.unit = "m".into();
    assert!(matches!(table.into_record("r", &[channel], None), Err(RecordError::UnitDisagrees { .. })));
}

#[test]
fn interleaved_numbers_of_both_byte_orders_in_chunks_and_segments_are_read() {
    for bytes in INTERLEAVED {
        let table = read(bytes).unwrap();
        let [a, b] = &table.columns[..] else { panic!("{}", table.names()) };
        assert_eq!(a.values, (0..12).map(|k| 1.5 * f64::from(k)).collect::<Vec<_>>());
        assert_eq!(b.values, (0..12).map(|k| -f64::from(k)).collect::<Vec<_>>());
        // Of a file that was cut off within its last rows the whole ones are there.
        let mut unfinished = bytes.to_vec();
        let last = bytes.len() - 28 - 40;
        unfinished[last + 12..last + 20].fill(0xFF);
        unfinished.truncate(bytes.len() - 5);
        let table = read(&unfinished).unwrap();
        assert_eq!([table.columns[0].values.len(), table.columns[1].values.len()], [11, 11]);
    }
}

#[test]
fn numbers_of_a_device_have_its_scales() {
    let table = read(DAQMX).unwrap();
    let of = |values: &dyn Fn(f64, f64) -> f64| -> Vec<f64> {
        (0..10).map(|j| values(f64::from(j % 5), f64::from(j / 5))).collect()
    };
    let scaled = |x: f64| 0.5 + x * (2e-3 + x * 1e-7);
    let expected =
        [of(&|k, c| scaled(100.0 * k - 200.0 + c)), of(&|k, c| scaled(-1000.0 * k + c)), of(&|k, c| 11.0 * k + c)];
    for (column, expected) in table.columns.iter().zip(&expected) {
        let far = column.values.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(far < 1e-13 && column.values.len() == 10, "{}: {:?}", column.name, column.values);
    }
    assert!((table.columns[0].rate.unwrap().hz / 51_200.0 - 1.0).abs() < 1e-15);
}

#[test]
fn malformed_files_are_refused_with_their_byte() {
    let said = |bytes: &[u8]| read(bytes).unwrap_err().to_string();
    assert!(said(b"RIFF and something else that is long enough").contains("does not begin with TDSm"));
    assert!(said(&CONTIGUOUS[..20]).contains("byte 0: the file ends"));
    assert!(said(&CONTIGUOUS[..2000]).contains("it was cut off"));
    let mut other = CONTIGUOUS.to_vec();
    // In both segments, as text of six bytes.
    let kinds: Vec<usize> = (0..other.len() - 10).filter(|at| other[*at..].starts_with(b"\x06\0\0\0Linear")).collect();
    assert_eq!(kinds.len(), 2);
    kinds.iter().for_each(|at| other[at + 4..at + 10].copy_from_slice(b"Thermo"));
    assert!(said(&other).contains("a scale of the kind \"Thermo\""), "{}", said(&other));
    // Any byte may be wrong without more than an error.
    for bytes in [CONTIGUOUS, DAQMX, INTERLEAVED[0]] {
        for at in 0..bytes.len().min(1500) {
            for value in [0, 1, 0x7F, 0xFF] {
                let mut broken = bytes.to_vec();
                broken[at] = value;
                drop(read(&broken));
            }
        }
    }
    assert!(matches!(read(b""), Err(RecordError::Empty { samples: 0 })));
}
