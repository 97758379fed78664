//! Matrices in MATLAB's structures and cells.

use std::fs;

use crate::agreement::{fixture, read};
use crate::sample::{Entry, N, mass, stiffness};

#[test]
fn matrices_in_structures_and_cells_are_found_by_their_paths() {
    let paths = [
        ("FEM.model.K", stiffness()),
        ("FEM/model/M", mass()),
        ("FEM.both{1}", stiffness()),
        ("FEM.both{1,2}", mass()),
        ("KM{1}", stiffness()),
        ("KM(2)", mass()),
        ("part(1).K", mass()),
        ("part(2).K", stiffness()),
        ("/part(1,2)/K", stiffness()),
    ];
    for file in ["nested.mat", "nested_plain.mat", "nested73.mat"] {
        for (path, expected) in &paths {
            let found = read(&fixture(file), Some(path), Some(N)).unwrap_or_else(|error| panic!("{path}: {error}"));
            let found: Vec<Entry> = found.lower.entries().collect();
            assert_eq!(found, *expected, "{file}#{path}");
        }
    }
}

#[test]
fn a_path_that_is_not_there_is_answered_by_those_that_are() {
    for file in ["nested.mat", "nested73.mat"] {
        for name in [Some("K"), Some("FEM.K"), Some("KM{3}"), Some("FEM"), None] {
            let message = read(&fixture(file), name, Some(N)).unwrap_err().to_string();
            for path in ["`FEM.model.K`", "`FEM.model.M`", "`FEM.both{1}`", "`KM{2}`", "`part(2).K`"] {
                assert!(message.contains(path), "{file}, {name:?}: {message}");
            }
            assert!(!message.contains("FEM.n`"), "a number is no matrix: {message}");
        }
    }
}

#[test]
fn files_of_version_4_and_of_octave_are_named() {
    let four = read(&fixture("version4.mat"), Some("K"), None).unwrap_err().to_string();
    assert!(four.contains("found a file of version 4") && four.contains("`save -v7 model.mat K M`"), "{four}");
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("octave.mat");
    fs::write(&path, "# Created by Octave 8.4.0\n# name: K\n# type: matrix\n").unwrap();
    let octave = read(&path, None, None).unwrap_err().to_string();
    assert!(octave.contains("Octave's own text format"), "{octave}");
}

#[test]
fn structures_that_are_cut_or_changed_anywhere_are_refused_or_read_right() {
    let directory = tempfile::tempdir().unwrap();
    for (file, path) in [("nested.mat", "part(2).K"), ("nested_plain.mat", "FEM.both{1}"), ("nested73.mat", "KM{1}")] {
        let bytes = fs::read(fixture(file)).unwrap();
        let target = directory.path().join(file);
        for k in 0..10 {
            fs::write(&target, &bytes[..bytes.len() * k / 10]).unwrap();
            if let Ok(matrix) = read(&target, Some(path), Some(N)) {
                assert!(matrix.lower.entries().eq(stiffness()), "{file} cut to {k} tenths");
            }
        }
        for k in 0..300 {
            let mut changed = bytes.clone();
            changed[(k * 7919) % bytes.len()] ^= 0x41;
            fs::write(&target, &changed).unwrap();
            if let Ok(matrix) = read(&target, Some(path), Some(N)) {
                assert!(matrix.lower.entries().all(|e| e.2.is_finite() && e.0 < N && e.1 <= e.0));
            }
        }
    }
}
