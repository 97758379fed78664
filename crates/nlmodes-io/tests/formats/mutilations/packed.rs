//! Binary files.

use std::fs;

use crate::agreement::{fixture, read};
use crate::sample::{N, stiffness};

#[test]
fn archives_and_matlab() {
    let cases = [
        ("skew.npz", None, "entry (2, 5) is"),
        ("half.npz", None, "expected a symmetric matrix, both triangles stored"),
        ("complex.npz", None, "`data`: found numbers of type '<c16'; expected real numbers"),
        ("wide.npz", None, "`shape`: found [24, 20]; expected as many rows as columns"),
        ("dia.npz", None, "`format`: found `dia`; expected csc, csr or coo"),
        ("twice.npz", None, "number of rows: found 2, expected 24"),
        ("nan.npz", None, "entry 3 of `data`: the value `NaN` is not a finite number"),
        ("outside.npz", None, "entry 4 of `indices`: found 24; expected a row from 0 to 23"),
        ("skew.mat", Some("K"), "entry (2, 5) is"),
        ("skew.mat", Some("C"), "`C`: found complex numbers; expected real numbers"),
        ("skew.mat", Some("X"), "there is no matrix `X`; expected one of `K`, `C`"),
        (
            "skew.mat",
            None,
            "found several matrices: `K`, `C`; expected the name of one behind the file's, as in `skew.mat#K`",
        ),
        ("wide.mat", None, "`K`: columns of a symmetric matrix: found 20, expected 24"),
        ("skew73.mat", Some("K"), "entry (2, 5) is"),
        ("skew73.mat", Some("X"), "there is no matrix `X`; expected one of `K`"),
        ("hdf5.mat", None, "found several matrices: `K`, `M`"),
    ];
    for (file, name, says) in cases {
        let message = read(&fixture(file), name, Some(N)).unwrap_err().to_string();
        assert!(
            message.contains(file)
                && message.contains(says)
                && message.contains("expected") | message.contains("found"),
            "{message}"
        );
    }
    let twice = read(&fixture("twice.npz"), None, None).unwrap_err().to_string();
    assert!(twice.contains("entry (1, 1) is there a second time"), "{twice}");
}

#[test]
fn binary_files_that_are_cut_or_changed_anywhere_are_refused_or_read_right() {
    let directory = tempfile::tempdir().unwrap();
    let good = stiffness();
    for (file, name) in [
        ("K_csc.npz", None),
        ("K_csr.npz", None),
        ("packed.mat", Some("K")),
        ("plain.mat", Some("K")),
        ("hdf5.mat", Some("K")),
    ] {
        let bytes = fs::read(fixture(file)).unwrap();
        let path = directory.path().join(file);
        for k in 0..10 {
            fs::write(&path, &bytes[..bytes.len() * k / 10]).unwrap();
            let message = read(&path, name, Some(N));
            let cut_behind =
                file.ends_with(".mat") && message.as_ref().is_ok_and(|m| m.lower.entries().eq(good.iter().copied()));
            assert!(message.is_err() || cut_behind, "{file} cut to {k} tenths");
        }
        for k in 0..200 {
            let mut changed = bytes.clone();
            changed[(k * 7919) % bytes.len()] ^= 0x41;
            fs::write(&path, &changed).unwrap();
            // For any result: no panic, and no entry that is not finite.
            if let Ok(matrix) = read(&path, name, Some(N)) {
                assert!(matrix.lower.entries().all(|e| e.2.is_finite() && e.0 < N && e.1 <= e.0));
            }
        }
    }
}

/// One byte makes the list of chunks extend beyond its end, or four make a chunk longer than the file: of 16 kB, 4 GiB
/// would be read.
#[test]
fn chunks_that_the_file_cannot_hold_are_refused_before_memory_is_taken() {
    let good = fs::read(fixture("hdf5.mat")).unwrap();
    let tree = 7504;
    assert_eq!(good[tree..tree + 8], *b"TREE\x01\0\x01\0", "the list of the chunks of `ir`");
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("long.mat");
    for (from, bytes, says) in
        [(tree + 6, &[228][..], "`K/ir`: found"), (tree + 24, &[0xff; 4], "`K/ir`: last byte of a chunk: found")]
    {
        let mut changed = good.clone();
        changed[from..from + bytes.len()].copy_from_slice(bytes);
        fs::write(&path, &changed).unwrap();
        let message = read(&path, Some("K"), Some(N)).unwrap_err().to_string();
        assert!(message.contains(says), "{message}");
    }
}
