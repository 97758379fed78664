//! Records through files of every format, by the ending of their names.

use nlmodes_experiment::records::{
    Channel, Quantity, Record, RecordError, Recording, Role, TIME_COLUMN, read_npy, write_npy, write_record,
};

fn record() -> Record {
    let wave = |j: i32, phase: f64| 0.7 * (0.3 * f64::from(j) + phase).sin();
    let samples = |phase: f64| (0..40).map(|j| wave(j, phase)).collect::<Vec<f64>>();
    Record::new("r", 1000.0)
        .with(Channel::new("f", Quantity::Force, Role::Excitation, None), samples(0.0))
        .with(Channel::new("x", Quantity::Displacement, Role::Response, Some(0.5)), samples(1.1))
}

#[test]
fn a_record_comes_back_from_a_file_of_every_format() {
    let (folder, record) = (tempfile::tempdir().unwrap(), record());
    for ending in ["csv", "CSV", "uff", "unv", "wav", "npy"] {
        let path = folder.path().join(format!("r.{ending}"));
        write_record(&path, &record).unwrap();
        let recording = Recording {
            channels: record.channels.clone(),
            sample_rate: Some(1000.0),
            time_column: (ending.to_lowercase() == "csv").then(|| TIME_COLUMN.to_owned()),
        };
        Recording::find(&path).unwrap();
        let back = recording.read(&path).unwrap();
        assert_eq!((back.sample_rate, &back.name, back.channels.len()), (1000.0, &format!("r.{ending}"), 2));
        // Samples of WAV files have four bytes.
        let tolerance = if ending == "wav" { 1e-7 } else { 0.0 };
        for (a, b) in back.samples.iter().flatten().zip(record.samples.iter().flatten()) {
            assert!((a - b).abs() <= tolerance, "{ending}: {a} {b}");
        }
        assert_eq!(back.samples[1].len(), 40, "{ending}");
    }
}

/// What has no names goes by its number, as people count.
#[test]
fn columns_of_an_array_are_called_by_their_numbers_from_one() {
    let mut file = Vec::new();
    write_npy(&mut file, &record()).unwrap();
    let table = read_npy(&file[..]).unwrap();
    assert_eq!(table.columns.iter().map(|column| column.name.as_str()).collect::<Vec<_>>(), ["1", "2"]);
}

#[test]
fn other_endings_and_folders_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("r.txt");
    assert!(matches!(write_record(&path, &record()), Err(RecordError::Extension { extension }) if extension == "txt"));
    assert!(!path.exists());
    let folder_of_samples = folder.path().join("r.csv");
    std::fs::create_dir(&folder_of_samples).unwrap();
    assert!(matches!(Recording::find(&folder_of_samples), Err(RecordError::Io { .. })));
    assert!(matches!(Recording::find(&folder.path().join("none.wav")), Err(RecordError::Io { .. })));
    assert!(matches!(write_record(&folder_of_samples, &record()), Err(RecordError::Io { .. })));
}
