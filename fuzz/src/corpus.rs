//! Valid files of every format.

use std::io::{self, Cursor};

use nlmodes_experiment::records::{
    ByteOrder, Channel, Quantity, Record, RecordError, Role, Storage, write_csv, write_npy, write_uff, write_wav,
};

/// Words of a scene.
pub const TOML_WORDS: &[&str] = &[
    "[",
    "]",
    "[[",
    "]]",
    "[[contact]]",
    "[[method]]",
    "[method]",
    "[structure.material]",
    "{",
    "}",
    "=",
    "\"",
    "'''",
    "\"\"\"",
    ".",
    ",",
    "#",
    "\n",
    "\r\n",
    "\0",
    "\u{1b}[31m",
    "ä",
    "𝄞",
    "-",
    "1e999",
    "nan",
    "0x",
    "1979-05-27",
    "true",
    "\u{feff}",
    "structure",
    "\nmethod.kind = \"hbm\"\n",
    "[1, [2, [3]]]",
    "\"free\"",
    "\"clamped\"",
    "\"beam\"",
    "\"transverse\"",
    "\nheight_m = 1.0\n",
    "\nmethod.1.mode=2",
    "\nmethod.harmonics=[1,2]",
    "\ncontact.0.gap_m=1e308",
];
/// Words of tables and Universal Files.
pub const TEXT_WORDS: &[&str] = &[
    "\n",
    "\r",
    "\r\n",
    ",",
    ";",
    "\"",
    "    -1\n",
    "    58\n",
    "    58b     2     2",
    "time_s",
    "nan",
    "inf",
    "1,5",
    "\t",
    "-",
    "                      ",
    "\0",
    "ä",
    "1e999",
];
/// Words of a summary.
pub const JSON_WORDS: &[&str] = &[
    "{",
    "}",
    "[",
    "]",
    "\"",
    ":",
    ",",
    "null",
    "true",
    "\"scene\":",
    "\"branches\":[",
    "\"elements\":2000",
    "1e999",
    "PK\u{1}\u{2}",
    "\\u0000",
];
/// Words of steps, and of what says whose they are.
pub const STEP_WORDS: &[&str] = &[
    "\n",
    "{",
    "}",
    "[",
    "]",
    ",",
    ":",
    "[]",
    "{}",
    "null",
    "true",
    "0",
    "-",
    "1e999",
    "0.0,",
    ",1e300",
    "\n{\"run\":",
    "\n{\"step\":",
    "\"points\":[]",
    "\"stop\":\"Stopped\"",
    "\"stop\":\"Closed\"",
    "\"stop\":\"Joined\"",
    "{\"Bound\":{\"coordinate\":99,\"value\":1.0}}",
    "{\"UnknownFold\":{\"index\":99}}",
    "\"BranchPoint\"",
    "\"Kink\"",
    "\"ParameterFold\"",
    "\"crossing\":{\"z\":[],\"back\":[],\"arms\":[],\"own\":0}",
    "\"own\":9",
    "\"max_points\":1",
    "\"scenes\":",
    "\"version\":",
    "\\u0000",
];
/// Words of binary formats.
pub const BINARY_WORDS: &[&str] = &[
    "\u{0}\u{0}\u{0}\u{0}",
    "PK\u{3}\u{4}",
    "PK\u{1}\u{2}",
    "PK\u{5}\u{6}",
    "RIFF",
    "WAVEfmt ",
    "data",
    "\u{93}NUMPY",
    "(2, 2)",
    "(",
    ")",
    "'",
    "{",
    "}",
    "<f8",
    ">c16",
    "|O",
    "True",
    "fortran_order",
    "99999999999",
    ", ",
    "A.npy",
    "b.npy",
    "\n",
];

/// Scenes of structures.
pub fn scenes() -> Vec<Vec<u8>> {
    let several = include_str!("../../configs/beam_methods.toml");
    let texts = [
        include_str!("../../configs/rod.toml"),
        include_str!("../../configs/beam.toml"),
        include_str!("../../configs/beam_hbm.toml"),
        several,
        include_str!("../../configs/beam_two_stops.toml"),
        include_str!("../../configs/beam_ten_stops.toml"),
        include_str!("../../configs/beam_updated.toml"),
        include_str!("../../configs/rod_two_stops.toml"),
    ];
    // The last line is tried as `--set` too.
    texts.iter().map(|text| format!("{text}\n#\nstructure.elements=20").into_bytes()).chain(of(&texts)).collect()
}

/// Scenes of records.
pub fn record_scenes() -> Vec<Vec<u8>> {
    of(&[include_str!("../../configs/measured_record.toml")])
}

/// Scenes of virtual tests.
pub fn test_scenes() -> Vec<Vec<u8>> {
    of(&[include_str!("../../configs/virtual_test.toml")])
}

fn of(texts: &[&str]) -> Vec<Vec<u8>> {
    texts.iter().map(|text| text.as_bytes().to_vec()).collect()
}

fn record(samples: u32) -> Record {
    let channel = |name: &str, quantity| Channel::new(name, quantity, Role::Response, Some(0.1));
    let wave = |k: f64| (0..samples).map(|j| (k * f64::from(j)).sin()).collect::<Vec<f64>>();
    Record::new("made", 2000.0)
        .with(channel("x", Quantity::Displacement), wave(0.3))
        .with(channel("f", Quantity::Force), wave(0.2))
}

fn written(write: impl Fn(&mut Cursor<Vec<u8>>, &Record) -> Result<(), RecordError>) -> io::Result<Vec<Vec<u8>>> {
    let file = |samples| {
        let mut file = Cursor::new(Vec::new());
        write(&mut file, &record(samples)).map_err(io::Error::other)?;
        Ok(file.into_inner())
    };
    [3, 16].into_iter().map(file).collect()
}

/// Tables.
///
/// # Errors
/// If they cannot be made.
pub fn csv() -> io::Result<Vec<Vec<u8>>> {
    let mut all = written(|file, record| write_csv(file, record, None))?;
    all.extend(of(&["time_s;x;f\r\n0,0;1,5;2\r\n0,001;2;3\r\n", "x,f\n1,2\n3,4\n"]));
    Ok(all)
}

/// Universal Files 58 and 58b, big and little endian.
///
/// # Errors
/// If they cannot be made.
pub fn uff() -> io::Result<Vec<Vec<u8>>> {
    let storages = [Storage::Text, Storage::Binary(ByteOrder::Big), Storage::Binary(ByteOrder::Little)];
    let all = storages.into_iter().map(|storage| written(|file, record| write_uff(file, record, storage)));
    Ok(all.collect::<io::Result<Vec<_>>>()?.concat())
}

/// Sound files.
///
/// # Errors
/// If they cannot be made.
pub fn wav() -> io::Result<Vec<Vec<u8>>> {
    written(|file, record| write_wav(file, record))
}

/// Arrays of NumPy.
///
/// # Errors
/// If they cannot be made.
pub fn npy() -> io::Result<Vec<Vec<u8>>> {
    written(|file, record| write_npy(file, record))
}

/// Contact problems, made by NumPy: stored, compressed, in columns, and in single precision.
pub fn contact_problems() -> Vec<Vec<u8>> {
    [
        &include_bytes!("../corpus/problem.npz")[..],
        include_bytes!("../corpus/problem_compressed.npz"),
        include_bytes!("../corpus/problem_fortran.npz"),
        include_bytes!("../corpus/problem_integers.npz"),
    ]
    .map(<[u8]>::to_vec)
    .to_vec()
}

/// Results of a rod of two elements.
pub fn results() -> Vec<Vec<u8>> {
    let summary = include_bytes!("../corpus/summary.json");
    let harmonics = include_bytes!("../corpus/harmonics.npz");
    let length = u32::try_from(summary.len()).unwrap_or(0).to_le_bytes();
    vec![[&length[..], summary, harmonics].concat()]
}
