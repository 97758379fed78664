//! The sample in every format is the same matrix.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use nlmodes_io::{Address, Component, DofLabel, Format, LabelTable, MatrixData, read_matrix};

use crate::sample::{Entry, N, label, mass, stiffness};
use crate::writers;

pub fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures").join(name)
}

/// Reads a file in the format given by its name.
pub fn read(path: &Path, name: Option<&str>, order: Option<usize>) -> nlmodes_io::Result<MatrixData> {
    let address = Address { path: path.to_owned(), name: name.map(str::to_owned) };
    read_matrix(&address, Format::of(&address)?, order)
}

#[track_caller]
fn same(found: &MatrixData, expected: &[Entry], tolerance: f64) {
    let found: Vec<Entry> = found.lower.entries().collect();
    assert_eq!(found.len(), expected.len());
    for (a, b) in found.iter().zip(expected) {
        assert_eq!((a.0, a.1), (b.0, b.1));
        assert!((a.2 - b.2).abs() <= tolerance * b.2.abs(), "{a:?} {b:?}");
    }
}

#[test]
fn files_of_scipy_and_hdf5_are_the_sample_to_the_last_bit() {
    let endings = ["csc.npz", "csr.npz", "coo.npz", "symmetric.mtx", "general.mtx", "array.mtx"];
    for (name, expected) in [("K", stiffness()), ("M", mass())] {
        for ending in endings {
            let path = fixture(&format!("{name}_{ending}"));
            same(&read(&path, None, Some(N)).unwrap(), &expected, 0.0);
        }
        for file in ["packed.mat", "plain.mat", "hdf5.mat"] {
            same(&read(&fixture(file), Some(name), Some(N)).unwrap(), &expected, 0.0);
        }
    }
    // Without a known order, too.
    same(&read(&fixture("K_coo.npz"), None, None).unwrap(), &stiffness(), 0.0);
}

#[test]
fn text_formats_are_the_sample_as_far_as_their_digits_go() {
    let directory = tempfile::tempdir().unwrap();
    for (name, lower) in [("K", stiffness()), ("M", mass())] {
        let cases = [
            ("x.sti", writers::calculix(&lower), 1e-13),
            ("x.mtx", writers::matrix_market(&lower), 0.0),
            ("y.mtx", writers::abaqus(&lower, false), 0.0),
            ("x.hb", writers::harwell_boeing(&lower), 0.0),
            ("x.pch", writers::dmig(&format!("{name}AAX"), &lower), 1e-9),
            ("y.pch", writers::dmig_short(&format!("{name}AAX"), &lower), 5e-3),
        ];
        for (file, text, tolerance) in cases {
            // A matrix that names its rows knows nothing of a row without entries.
            let path = directory.path().join(file);
            fs::write(&path, &text).unwrap();
            let names_rows = file.starts_with('y') || file.ends_with(".pch");
            let order = (!names_rows).then_some(N);
            let plain = read(&path, None, order).unwrap();
            same(&plain, &lower, tolerance);
            if let Some(labels) = &plain.labels {
                let rows = if name == "K" || file.ends_with("pch") { N } else { N - 1 };
                let rows = rows.min(labels.len());
                assert!((0..rows).all(|row| labels[row] == expected_label(row)), "{file}");
            }
            let packed = directory.path().join(format!("{file}.gz"));
            let mut encoder =
                flate2::write::GzEncoder::new(fs::File::create(&packed).unwrap(), flate2::Compression::fast());
            encoder.write_all(text.as_bytes()).unwrap();
            encoder.finish().unwrap();
            assert_eq!(read(&packed, None, order).unwrap(), plain, "{file}.gz");
        }
    }
}

fn expected_label(row: usize) -> DofLabel {
    let (node, component) = label(row);
    DofLabel { node: node as u64, component: Component::DIRECTED[component - 1] }
}

#[test]
fn degrees_of_freedom_that_abaqus_holds_are_left_out() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("held.mtx");
    fs::write(&path, writers::abaqus(&stiffness(), true)).unwrap();
    let read = read(&path, None, None).unwrap();
    assert_eq!(read.fixed, [DofLabel { node: 5, component: Component::X }]);
    same(&read, &stiffness(), 0.0);
}

/// Both triangles, of which one has an entry more: rounding where the other has a zero is taken, and what is lost is
/// named as that.
#[test]
fn both_triangles_of_abaqus_may_differ_by_rounding_and_not_by_more() {
    let directory = tempfile::tempdir().unwrap();
    let upper: Vec<_> = stiffness().into_iter().filter(|e| e.0 != e.1).map(|(i, j, v)| (j, i, v)).collect();
    let file = |name: &str, upper: &[Entry], more: &str| {
        let path = directory.path().join(name);
        fs::write(&path, writers::abaqus(&stiffness(), false) + &writers::abaqus(upper, false) + more).unwrap();
        read(&path, None, None)
    };
    let [(node, direction), (of, along)] = [label(N - 1), label(0)];
    let rounding = format!("{node},{direction}, {of},{along}, 1e-13\n");
    let both = file("both.mtx", &upper, &rounding).unwrap();
    let mut entries: Vec<Entry> = stiffness().into_iter().chain([(N - 1, 0, 1e-13)]).collect();
    entries.sort_by_key(|entry| (entry.1, entry.0));
    same(&both, &entries, 0.0);
    let refused = file("lost.mtx", &upper[1..], "").unwrap_err().to_string();
    assert!(refused.contains("expected a symmetric matrix, both triangles stored"), "{refused}");
}

#[test]
fn all_tables_of_labels_name_the_same_rows() {
    let directory = tempfile::tempdir().unwrap();
    let cases = [("x.dof", writers::dof()), ("x.mapping", writers::mapping()), ("x.csv", writers::table())];
    for (file, text) in cases {
        let path = directory.path().join(file);
        fs::write(&path, text).unwrap();
        let table = LabelTable::read(&path).unwrap();
        assert_eq!(table.labels, (0..N).map(expected_label).collect::<Vec<_>>(), "{file}");
        assert_eq!(table.positions.get(&40).copied(), (file == "x.csv").then_some([10.0, 0.5, -2.0]));
    }
}

#[test]
fn components_of_a_table_have_names_and_numbers_and_rows_count_from_either() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("names.csv");
    fs::write(&path, "1,7,UX\n3,7,rotz\n2,7,5\n").unwrap();
    let labels = LabelTable::read(&path).unwrap().labels;
    let components: Vec<_> = labels.iter().map(|label| label.component).collect();
    assert_eq!(components, [Component::X, Component::RY, Component::RZ]);
    // 10.1 and 10.10 are not one number: the second has no such direction.
    let path = directory.path().join("x.dof");
    fs::write(&path, "10.1\n10.10\n").unwrap();
    let refused = LabelTable::read(&path).unwrap_err().to_string();
    assert!(
        refused.ends_with("x.dof:2: found `10.10`; expected `node.direction` with a direction from 1 to 6"),
        "{refused}"
    );
}
