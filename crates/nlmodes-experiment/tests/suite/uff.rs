//! Universal Files: every layout of dataset 58 there and back, and files that others write.

use nlmodes_experiment::records::{
    Abscissa, Axis, ByteOrder, Channel, Dataset58, Node, Ordinates, Precision, Quantity, Record, Role, Storage,
    UffError, read_uff, read_uff58, write_uff, write_uff58,
};
use num_complex::Complex64;

const STORAGES: [Storage; 3] = [Storage::Text, Storage::Binary(ByteOrder::Little), Storage::Binary(ByteOrder::Big)];

fn values(n: usize) -> Vec<f64> {
    (0..n).map(|j| (j as f64 - 3.3) * 1.234_567_890_123e-3 * 10f64.powi(j as i32 % 7 - 3)).collect()
}

fn dataset(complex: bool, uneven: bool, n: usize) -> Dataset58 {
    let abscissa = if uneven {
        Abscissa::Uneven { values: (0..n).map(|j| 0.25 * j as f64).collect(), rounding: 0.0 }
    } else {
        Abscissa::even(1.5, 0.25)
    };
    let mut dataset = Dataset58::real(values(n), abscissa);
    if complex {
        let parts = values(2 * n);
        dataset.ordinates = Ordinates::Complex(parts.chunks(2).map(|p| Complex64::new(p[0], p[1])).collect());
    }
    dataset.identification = ["a name", "", "third", "4", "NONE"].map(str::to_owned);
    (dataset.function_type, dataset.function, dataset.version, dataset.load_case) = (4, 17, 2, -3);
    dataset.response = Node { entity: "response".into(), node: 123, direction: -3 };
    dataset.reference = Node { entity: "shaker".into(), node: 7, direction: 2 };
    dataset.z = -2.5;
    dataset.abscissa_axis = Axis { kind: 17, exponents: [0, 0, 1], label: "Time".into(), unit: "s".into() };
    dataset.ordinate_axis = Axis { kind: 12, exponents: [1, -2, 0], label: "acc".into(), unit: "m/s^2".into() };
    dataset
}

fn close(a: f64, b: f64, relative: f64) -> bool {
    (a - b).abs() <= relative * b.abs()
}

#[test]
fn every_layout_comes_back() {
    assert!(Ordinates::Real(vec![]).is_empty() && Ordinates::Complex(vec![]).is_empty());
    for storage in STORAGES {
        for precision in [Precision::Single, Precision::Double] {
            for (complex, uneven) in [(false, false), (false, true), (true, false), (true, true)] {
                for n in [1, 2, 3, 4, 5, 6, 7, 23] {
                    let written = dataset(complex, uneven, n);
                    let mut file = Vec::new();
                    write_uff58(&mut file, &written, storage, precision).unwrap();
                    let back = read_uff58(&file).unwrap().remove(0);
                    assert_eq!((back.ordinates.len(), back.ordinates.is_empty()), (n, false));
                    check(&written, &back, storage, precision);
                }
            }
        }
    }
}

fn check(written: &Dataset58, back: &Dataset58, storage: Storage, precision: Precision) {
    // E13.5 has six digits, E20.12 thirteen, a 4-byte number 24 bits.
    let relative = match (storage, precision) {
        (Storage::Text, Precision::Single) => 5e-6,
        (Storage::Text, Precision::Double) => 5e-13,
        (_, Precision::Single) => 6e-8,
        (_, Precision::Double) => 0.0,
    };
    match (&written.ordinates, &back.ordinates) {
        (Ordinates::Real(a), Ordinates::Real(b)) => {
            assert_eq!(a.len(), b.len());
            assert!(a.iter().zip(b).all(|(a, b)| close(*b, *a, relative)), "{a:?} {b:?}");
        }
        (Ordinates::Complex(a), Ordinates::Complex(b)) => {
            assert_eq!(a.len(), b.len());
            assert!(a.iter().zip(b).all(|(a, b)| close(b.re, a.re, relative) && close(b.im, a.im, relative)));
        }
        other => panic!("{other:?}"),
    }
    match (&written.abscissa, &back.abscissa) {
        (Abscissa::Uneven { values: a, .. }, Abscissa::Uneven { values: b, rounding }) => {
            assert_eq!(a, b);
            let largest = a.iter().copied().fold(0.0, f64::max);
            // The sixth digit of text may be the last one, whatever its format has room for.
            let digits = match (storage, precision) {
                (Storage::Text, _) => 5e-6,
                (_, Precision::Single) => 2f64.powi(-23),
                (_, Precision::Double) => 0.0,
            };
            assert!((rounding - digits * largest).abs() <= 1e-15 * largest, "{rounding:e}");
        }
        (Abscissa::Even { first, step, .. }, Abscissa::Even { first: f, step: s, rounding, .. }) => {
            assert_eq!((first, step), (f, s));
            assert!((rounding - 5e-7).abs() < 1e-20, "{rounding}");
        }
        other => panic!("{other:?}"),
    }
    let plain = |dataset: &Dataset58| Dataset58 {
        abscissa: Abscissa::even(0.0, 0.0),
        ordinates: Ordinates::Real(vec![]),
        ..dataset.clone()
    };
    assert_eq!(plain(written), plain(back));
}

#[test]
fn numbers_that_are_left_blank_are_zero() {
    let mut file = Vec::new();
    write_uff58(&mut file, &dataset(false, false, 5), Storage::Text, Precision::Double).unwrap();
    let text = String::from_utf8(file).unwrap();
    for (number, blank) in [(" 1.50000e+00", 0.0), ("-2.50000e+00", 1.5)] {
        assert_eq!(text.matches(number).count(), 1, "{text}");
        let back = read_uff58(text.replace(number, &" ".repeat(number.len())).as_bytes()).unwrap().remove(0);
        let Abscissa::Even { first, .. } = back.abscissa else { panic!("{:?}", back.abscissa) };
        assert_eq!((first, back.z), (blank, if blank == 0.0 { -2.5 } else { 0.0 }));
    }
}

#[test]
fn channels_of_a_record_come_back_under_their_names() {
    let channel = |name: &str, quantity| Channel::new(name, quantity, Role::Response, None);
    let channels = [channel("x_tip_m", Quantity::Displacement), channel("a_long_name_1", Quantity::Acceleration)];
    let record = Record::new("run 1", 20_000.0)
        .with(channels[0].clone(), values(30))
        .with(channels[1].clone(), values(30).into_iter().rev().collect());
    for storage in STORAGES {
        let mut file = Vec::new();
        write_uff(&mut file, &record, storage).unwrap();
        let back = read_uff(&file[..]).unwrap().into_record("run 1", &channels, Some(20_000.0)).unwrap();
        for (a, b) in back.samples.iter().flatten().zip(record.samples.iter().flatten()) {
            assert!(close(*a, *b, 5e-13));
        }
        assert!(read_uff(&file[..]).unwrap().into_record("run 1", &channels, Some(20_001.0)).is_err());
    }
}

/// A file as other programs write it: CR LF, another dataset in front, touching numbers, D exponents.
const FOREIGN: &[&str] = &[
    "    -1",
    "   164",
    "         1  SI: Meter (newton)         2",
    "    -1",
    "    -1",
    "    58",
    "id line one",
    "",
    "21-NOV-26 10:00:00",
    "NONE",
    "NONE",
    "    1         0    0         0       NONE         5   3       NONE         0   0",
    "         2         7         1  0.00000E+00  1.00000E-03  0.00000E+00",
    "        17    0    0    0                 Time                    s",
    "        12    0    0    0         Acceleration                m/s^2",
    "         0    0    0    0                 NONE                 NONE",
    "         0    0    0    0                 NONE                 NONE",
    " -1.00000E+00-2.00000E+00 -3.00000E-01  4.00000D+00  0.00000E+00 -6.50000E+02",
    "  7.00000E+00",
    "    -1",
    "",
];

#[test]
fn a_file_of_another_program_is_read() {
    let foreign = FOREIGN.join("\r\n");
    let functions = read_uff58(foreign.as_bytes()).unwrap();
    assert_eq!(functions.len(), 1);
    assert_eq!(functions[0].ordinates, Ordinates::Real(vec![-1.0, -2.0, -0.3, 4.0, 0.0, -650.0, 7.0]));
    assert_eq!(functions[0].names(), ["id line one", "Acceleration", "5:3"]);
    let channel = Channel::new("5:3", Quantity::Acceleration, Role::Response, None);
    let record = read_uff(foreign.as_bytes()).unwrap().into_record("", &[channel], None).unwrap();
    assert!((record.sample_rate - 1000.0).abs() < 1e-9);
}

#[test]
fn each_malformed_file_has_its_own_error() {
    let foreign = FOREIGN.join("\r\n");
    let said = |from: &str, to: &str| {
        assert!(foreign.contains(from), "{from}");
        read_uff58(foreign.replacen(from, to, 1).as_bytes()).unwrap_err().to_string()
    };
    assert!(said("         7         1", "2000000000         1").contains("announces 2000000000 numbers, 7 follow"));
    assert!(said("         7         1", "        -7         1").contains("\"-7\" is not a number of values"));
    assert!(said("         7         1", "         3         1").contains("announces 3 numbers, more follow"));
    assert!(said("  4.00000D", "  4,00000D").contains("write a decimal point"));
    assert!(said("  4.00000D", "  4.0x000D").contains("is not a number"));
    assert!(said("         2         7", "         9         7").contains("a type of ordinates"));
    // The type of a dataset follows its mark: in the sixth line of this file.
    assert!(
        said("    58\r", "    58b     3     2          11\r").contains("line 6"),
        "{}",
        said("    58\r", "    58b     3     2          11\r")
    );
    assert!(said("    58\r", "    15\r").contains("no dataset 58 in the file (2 datasets"));
    assert!(said("  7.00000E+00\r\n    -1\r\n", "  7.00000E+00").contains("cut off"));
    let cut = read_uff58(&foreign.as_bytes()[..300]).unwrap_err();
    assert!(matches!(cut, UffError::HeaderCutOff { .. } | UffError::CutOff { .. }), "{cut}");
    assert!(matches!(read_uff58(b""), Err(UffError::NoFunction { datasets: 0 })));
}

#[test]
fn the_wrong_byte_order_is_recognised() {
    for precision in [Precision::Single, Precision::Double] {
        let mut file = Vec::new();
        let mut function = dataset(false, false, 200);
        function.ordinates = Ordinates::Real((0..200).map(|j| (0.1 * f64::from(j)).sin()).collect());
        write_uff58(&mut file, &function, Storage::Binary(ByteOrder::Little), precision).unwrap();
        let at = file.iter().position(|byte| *byte == b'b').unwrap();
        file[at..at + 7].copy_from_slice(b"b     2");
        assert!(matches!(read_uff58(&file), Err(UffError::ByteOrder { declared: "big-endian", .. })));
        file[at..at + 7].copy_from_slice(b"b     3");
        // The byte order is in the field of columns 8 to 13.
        assert!(matches!(read_uff58(&file), Err(UffError::Field { line: 2, first: 8, last: 13, .. })));
    }
}

#[test]
fn a_binary_file_with_a_wrong_count_is_refused() {
    let mut file = Vec::new();
    write_uff58(&mut file, &dataset(false, false, 200), Storage::Binary(ByteOrder::Big), Precision::Double).unwrap();
    let with = |count: &str| {
        let at = file.windows(20).position(|w| w == b"         4       200").unwrap();
        let mut file = file.clone();
        file[at + 10..at + 20].copy_from_slice(count.as_bytes());
        read_uff58(&file).unwrap_err()
    };
    assert!(matches!(with("       199"), UffError::NoEnd { bytes: 1592, .. }));
    assert!(matches!(with("      2000"), UffError::CutOff { announced: 2000, found: 200, .. }));
    assert!(matches!(with("9999999999"), UffError::CutOff { announced: 9_999_999_999, .. }));
}

/// Fields 3 to 5 of the line before the axes; the format requires zeros if the abscissa is given value by value.
#[test]
fn an_uneven_abscissa_has_neither_begin_nor_step_in_the_header() {
    for (uneven, expected) in
        [(false, ["1", "1.50000e+00", "2.50000e-01"]), (true, ["0", "0.00000e+00", "0.00000e+00"])]
    {
        let mut file = Vec::new();
        write_uff58(&mut file, &dataset(false, uneven, 5), Storage::Text, Precision::Double).unwrap();
        let text = String::from_utf8(file).unwrap();
        let line: Vec<&str> = text.lines().nth(8).unwrap().split_whitespace().collect();
        assert_eq!(line[2..5], expected, "{line:?}");
        assert_eq!(line[5], "-2.50000e+00");
    }
}
