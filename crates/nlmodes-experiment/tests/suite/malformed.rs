//! Damaged files: every one is an error or a record, none a panic or an endless loop.

use std::io::Cursor;

use nlmodes_experiment::records::{
    ByteOrder, Channel, Quantity, Record, RecordError, RecordTable, Role, Storage, read_csv, read_npy, read_uff,
    read_wav, write_csv, write_npy, write_uff, write_wav,
};
use proptest::prelude::*;

fn record() -> Record {
    let channel = |name: &str, quantity| Channel::new(name, quantity, Role::Response, Some(0.1));
    let wave = |k: f64| (0..64).map(|j| (k * f64::from(j)).sin()).collect::<Vec<f64>>();
    Record::new("made", 2000.0)
        .with(channel("x", Quantity::Displacement), wave(0.3))
        .with(channel("f", Quantity::Force), wave(0.2))
}

#[derive(Debug, Clone, Copy)]
enum Format {
    Csv,
    UffText,
    UffBinary,
    Wav,
    Npy,
}

const FORMATS: [Format; 5] = [Format::Csv, Format::UffText, Format::UffBinary, Format::Wav, Format::Npy];

fn written(format: Format) -> Vec<u8> {
    let mut file = Cursor::new(Vec::new());
    match format {
        Format::Csv => write_csv(&mut file, &record(), None),
        Format::UffText => write_uff(&mut file, &record(), Storage::Text),
        Format::UffBinary => write_uff(&mut file, &record(), Storage::Binary(ByteOrder::Big)),
        Format::Wav => write_wav(&mut file, &record()),
        Format::Npy => write_npy(&mut file, &record()),
    }
    .unwrap();
    file.into_inner()
}

fn read(format: Format, bytes: &[u8]) -> Result<RecordTable, RecordError> {
    match format {
        Format::Csv => read_csv(bytes, Some("time_s")),
        Format::UffText | Format::UffBinary => read_uff(bytes),
        Format::Wav => read_wav(bytes),
        Format::Npy => read_npy(bytes),
    }
}

/// Reads as a user would, and checks the text of the error.
fn survives(format: Format, bytes: &[u8]) {
    let outcome = read(format, bytes).and_then(|table| table.into_record("", &record().channels, Some(2000.0)));
    match outcome {
        Ok(record) => assert!(record.samples.iter().all(|samples| samples.len() == record.n_samples())),
        Err(error) => assert!(error.to_string().len() > 10, "{error:?}"),
    }
}

/// What happens to files.
#[derive(Debug, Clone)]
enum Damage {
    CutOff(usize),
    Replace(usize, u8),
    Remove(usize, usize),
    Insert(usize, Vec<u8>),
    Repeat(usize, usize),
}

fn damages() -> impl Strategy<Value = Vec<Damage>> {
    let at = 0..4000_usize;
    let words = prop::sample::select(vec![
        "-1",
        "\n",
        "\r\n",
        "    -1\n",
        ",",
        ";",
        "9999999999",
        "-7",
        "1e999",
        "nan",
        "58b",
        "b",
        "\0",
        "\u{FEFF}",
        "\"",
        "(",
        "[",
        "{",
        "0,5",
        "99999999999999999999",
    ]);
    let damage = prop_oneof![
        at.clone().prop_map(Damage::CutOff),
        (at.clone(), any::<u8>()).prop_map(|(at, byte)| Damage::Replace(at, byte)),
        (at.clone(), 1..300_usize).prop_map(|(at, n)| Damage::Remove(at, n)),
        (at.clone(), words).prop_map(|(at, word)| Damage::Insert(at, word.as_bytes().to_vec())),
        (at.clone(), prop::collection::vec(any::<u8>(), 1..20)).prop_map(|(at, bytes)| Damage::Insert(at, bytes)),
        (at, 1..500_usize).prop_map(|(at, n)| Damage::Repeat(at, n)),
    ];
    prop::collection::vec(damage, 1..6)
}

fn apply(damage: &Damage, bytes: &mut Vec<u8>) {
    // Headers are hit as often as numbers.
    let place =
        |at: usize, n: usize| if at.is_multiple_of(2) { (at / 2) % n.clamp(1, 700) } else { (at / 2) % n.max(1) };
    let n = bytes.len();
    match damage {
        Damage::CutOff(at) => bytes.truncate(place(*at, n)),
        Damage::Replace(at, byte) if n > 0 => bytes[place(*at, n)] = *byte,
        Damage::Replace(..) => {}
        Damage::Remove(at, count) => drop(bytes.drain(place(*at, n).min(n)..(place(*at, n) + count).min(n))),
        Damage::Insert(at, new) => drop(bytes.splice(place(*at, n).min(n)..place(*at, n).min(n), new.iter().copied())),
        Damage::Repeat(at, count) => {
            let from = place(*at, n).min(n);
            let piece = bytes[from..(from + count).min(n)].to_vec();
            drop(bytes.splice(from..from, piece));
        }
    }
}

/// 600, or the value of the environment variable.
fn cases() -> u32 {
    std::env::var("PROPTEST_CASES").ok().and_then(|n| n.parse().ok()).unwrap_or(600)
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(cases()) })]

    #[test]
    fn damaged_files_are_errors_or_records(damages in damages(), which in 0..FORMATS.len()) {
        let format = FORMATS[which];
        let mut bytes = written(format);
        damages.iter().for_each(|damage| apply(damage, &mut bytes));
        survives(format, &bytes);
    }

    #[test]
    fn garbage_is_an_error(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        FORMATS.iter().for_each(|format| survives(*format, &bytes));
    }

    #[test]
    fn a_header_with_garbage_behind_it_is_no_trouble(
        bytes in prop::collection::vec(any::<u8>(), 0..400),
        keep in 0.0..1.0f64,
    ) {
        for format in FORMATS {
            let mut file = written(format);
            file.truncate((keep * file.len() as f64) as usize);
            file.extend(&bytes);
            survives(format, &file);
        }
    }
}

#[test]
fn every_shortened_file_is_an_error_or_a_shorter_record() {
    for format in FORMATS {
        let bytes = written(format);
        (0..bytes.len()).for_each(|n| survives(format, &bytes[..n]));
    }
}

#[test]
fn huge_counts_in_headers_take_no_memory() {
    let mut npy = written(Format::Npy);
    let at = npy.windows(3).position(|w| w == b"(64").unwrap();
    npy.splice(at..at + 3, *b"(9999999999");
    assert!(read_npy(&npy[..]).is_err());
    let mut wav = written(Format::Wav);
    let at = wav.windows(4).position(|w| w == b"data").unwrap();
    wav[at + 4..at + 8].copy_from_slice(&0xFFFF_FFF0_u32.to_le_bytes());
    assert!(read_wav(&wav[..]).is_err());
    let uff = String::from_utf8(written(Format::UffText)).unwrap().replacen("        64", "2147483647", 1);
    assert!(read_uff(uff.as_bytes()).unwrap_err().to_string().contains("2147483647"));
}
