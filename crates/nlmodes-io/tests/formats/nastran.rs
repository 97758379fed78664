//! Punches and decks of Nastran as it writes them, and as people do.

use std::fs;
use std::path::{Path, PathBuf};

use nlmodes_io::{Component, ElementKind, FeFiles, FeModel, Mesh};

use crate::agreement::read;
use crate::sample::{Entry, N, label, stiffness};
use crate::writers;

fn written(directory: &Path, name: &str, text: &str) -> PathBuf {
    let path = directory.join(name);
    fs::write(&path, text).unwrap();
    path
}

/// The sample in comma-separated form, one card per column, with continuation marks.
fn free(name: &str, lower: &[Entry], long: bool) -> String {
    let star = if long { "*" } else { "" };
    let mut text = format!("DMIG,{name},0,6,2,0,,,{N}\n");
    for j in 0..N {
        let (node, direction) = label(j);
        text += &format!("DMIG{star},{name},{node},{direction},\n");
        for (i, _, v) in lower.iter().filter(|e| e.1 == j) {
            let (node, direction) = label(*i);
            text += &format!("{star},{node},{direction},{v:.17e}\n");
        }
    }
    text
}

const AROUND: &str = "$TITLE   = BEAM\nASSIGN OUTPUT2='x.op2'\nSOL 103\nCEND\nK2GG=KAAX\nBEGIN BULK\nPARAM,POST,-1\n\
                      DTI,TUG1,0,1,2,3,4,5,6,+\n+,7,ENDREC\nPLOTEL  1       10      20\n\
                      QSET1   0       900     THRU    950\n\
                      SPOINT  901     THRU    920\nGRID          10              0.      0.     0.5\n\
                      GRID*                 20                              1.              0.\n*                    \
                      0.5\n\
                      MAT1*                  1     2.1000E+11                            0.3*\n\
                      *                   7850.\nRBE2    5       10      123456  20\n";

#[test]
fn any_card_may_stand_around_matrices_in_any_form() {
    let directory = tempfile::tempdir().unwrap();
    let short = writers::dmig_short("KAAX", &stiffness());
    let forms = [
        (writers::dmig("KAAX", &stiffness()), 1e-9),
        (short, 5e-3),
        (free("KAAX", &stiffness(), true), 0.0),
        (free("KAAX", &stiffness(), false), 0.0),
        (writers::dmig("KAAX", &stiffness()).replace("\n*  ", "\n$ a remark\n*  "), 1e-9),
    ];
    let results = "$TITLE   = MODES\n$EIGENVALUE\n         1       G      0.000000E+00      1.0E+00\n\
    -CONT-                  0.0E+00\n";
    for (matrix, tolerance) in forms {
        for text in [
            format!("{AROUND}{matrix}"),
            format!("{matrix}{AROUND}ENDDATA\n"),
            format!("{matrix}{results}"),
            format!("{}{matrix}{AROUND}", writers::dmig("MAAX", &stiffness())),
        ] {
            let path = written(directory.path(), "x.pch", &text);
            let found = read(&path, Some("KAAX"), None).unwrap_or_else(|error| panic!("{error}\n{text}"));
            let entries: Vec<Entry> = found.lower.entries().collect();
            assert_eq!(entries.len(), stiffness().len());
            for (a, b) in entries.iter().zip(stiffness()) {
                assert!((a.0, a.1) == (b.0, b.1) && (a.2 - b.2).abs() <= tolerance * b.2.abs(), "{a:?} {b:?}");
            }
            if text.contains("GRID") {
                assert_eq!(found.positions.get(&20), Some(&[1.0, 0.0, 0.5]));
                let address = path.to_string_lossy();
                let model = FeModel::read(&FeFiles::new(&format!("{address}#KAAX"), &format!("{address}#KAAX")));
                assert_eq!(model.unwrap().place_of(10), Some([0.0, 0.0, 0.5]));
            }
        }
    }
}

#[test]
fn a_punch_without_matrices_says_where_they_are() {
    let directory = tempfile::tempdir().unwrap();
    let path = written(directory.path(), "x.pch", AROUND);
    let message = read(&path, None, None).unwrap_err().to_string();
    assert!(
        message.contains("found none; expected a DMIG header: Nastran punches matrices with EXTSEOUT("),
        "{message}"
    );
    assert!(message.contains("MATOP4"), "{message}");
    let path = written(directory.path(), "x.bdf", "BEGIN BULK\nINCLUDE 'model.pch'\nENDDATA\n");
    let message = read(&path, Some("KAAX"), None).unwrap_err().to_string();
    assert!(message.contains("the file includes `model.pch`"), "{message}");
}

/// A node with directions along a cylinder: its stiffness along the global axes is the rotated one, and the mass of
/// three equal rows is unchanged.
#[test]
fn directions_of_grid_points_are_turned_into_the_global_ones() {
    let directory = tempfile::tempdir().unwrap();
    let matrix = |name: &str, values: &[f64]| {
        let mut text = format!("DMIG,{name},0,6,2,0\n");
        for (k, value) in values.iter().enumerate() {
            text += &format!("DMIG,{name},5,{0},,5,{0},{value}\n", k + 1);
        }
        text
    };
    // At 60° around z: radial, tangential, axial stiffness.
    let (k, m) = ([4e3, 1e3, 7e3], [2.0, 2.0, 2.0]);
    let system = "CORD2C,3,,1.,0.,0.,1.,0.,1.\n,2.,0.,0.\n";
    let grid = "GRID,5,3,2.,60.,0.5,3\n";
    let text = format!("{}{}{system}{grid}", matrix("KAAX", &k), matrix("MAAX", &m));
    let path = written(directory.path(), "x.pch", &text).to_string_lossy().into_owned();
    let model = FeModel::read(&FeFiles::new(&format!("{path}#KAAX"), &format!("{path}#MAAX"))).unwrap();
    let (s, c) = 60_f64.to_radians().sin_cos();
    let row = |component| model.row_of(5, component).unwrap();
    let [x, y, z] = [Component::X, Component::Y, Component::Z].map(row);
    for (i, j, expected) in [
        (x, x, 4e3 * c * c + 1e3 * s * s),
        (y, y, 4e3 * s * s + 1e3 * c * c),
        (x, y, 3e3 * s * c),
        (z, z, 7e3),
        (x, z, 0.0),
    ] {
        assert!((model.stiffness.get(i, j) - expected).abs() < 1e-9, "{i} {j}: {}", model.stiffness.get(i, j));
    }
    assert!(model.mass_along_axes().iter().all(|mass| (mass - 2.0).abs() < 1e-14));
    let place = model.place_of(5).unwrap();
    assert!((place[0] - (1.0 + 2.0 * c)).abs() < 1e-14 && (place[1] - 2.0 * s).abs() < 1e-14);
    // Without the system, or with a direction that the reduction left out, it is unknown.
    for (text, says) in [
        (
            format!("{}{}{grid}", matrix("KAAX", &k), matrix("MAAX", &m)).replace("GRID,5,3", "GRID,5,0"),
            "not in the file",
        ),
        (format!("{}{}{system}{grid}", matrix("KAAX", &k[..2]), matrix("MAAX", &m[..2])), "with all three of them"),
    ] {
        let path = written(directory.path(), "y.pch", &text).to_string_lossy().into_owned();
        let refused = FeModel::read(&FeFiles::new(&format!("{path}#KAAX"), &format!("{path}#MAAX"))).unwrap_err();
        assert!(refused.to_string().contains(says), "{refused}");
    }
}

#[test]
fn decks_of_nastran_are_meshes() {
    let directory = tempfile::tempdir().unwrap();
    let nodes: String = (1..=21).map(|k| format!("GRID,{k},,{}.,{}.,{}.\n", k % 3, k / 3 % 3, k / 9)).collect();
    written(directory.path(), "nodes.bdf", &nodes);
    let deck = "SOL 103\nCEND\nSPC = 1\nBEGIN BULK\nINCLUDE 'nodes.bdf'\n\
    CHEXA   7       1       1       2       3       4       5       6       +A\n\
                +A      7       8       9       10      11      12      13      14      +B\n\
                +B      15      16      17      18      19      20\n\
                CTETRA,8,1,1,2,4,5\nCQUAD4,9,1,1,2,5,4,0.0\nCBAR,10,1,1,2,0.,0.,1.\nCONM2,11,3,,2.5\nPSOLID,1,1\n\
                SET1,4,1,THRU,3,9\nSPC1,1,123456,1,THRU,3\nSPC,1,5,2,,6,13\nENDDATA\nnot read\n";
    let mesh = Mesh::read(&written(directory.path(), "x.bdf", deck)).unwrap();
    assert_eq!(mesh.numbers.len(), 21);
    assert_eq!(mesh.node_set("4").unwrap(), [1, 2, 3, 9]);
    assert_eq!(mesh.passed_over.get("CONM2"), Some(&1));
    let supports: Vec<_> = mesh.supports.iter().flatten().map(|(node, held)| (*node, *held)).collect();
    let expected =
        [(1, [true; 3]), (2, [true; 3]), (3, [true; 3]), (5, [false, true, false]), (6, [true, false, true])];
    assert_eq!(supports, expected);
    let kinds: Vec<ElementKind> = mesh.elements.iter().map(|element| element.kind).collect();
    assert_eq!(kinds, [ElementKind::Hexahedron, ElementKind::Tetrahedron, ElementKind::Quadrangle, ElementKind::Line]);
    // Nastran counts upright edges before those of the top.
    let numbers: Vec<u64> = mesh.elements[0].nodes.iter().map(|k| mesh.numbers[*k as usize]).collect();
    assert_eq!(numbers[8..], [9, 10, 11, 12, 17, 18, 19, 20, 13, 14, 15, 16]);
    let cases = [
        ("GRID,1,7,0.,0.,0.\n", "node 1 in system 7, which is not there"),
        ("GRID,1,,0.,x,0.\n", "expected a coordinate in field 5 of GRID"),
        ("GRID,x,,0.,0.,0.\n", "expected a number from 1 on in field 2 of GRID"),
        ("GRID,1,,0.,0.,0.\nGRID,1,,1.,0.,0.\n", "expected node 1 at [0.0, 0.0, 0.0], as in line 1"),
        ("GRID,1,,0.,0.,0.\nCBAR,1,1,1,2\n", "node 2, which is not there"),
        ("GRID,1,,0.,0.,0.\nCTRIA3,1,1,1,1\n", "expected a node in field 6 of CTRIA3"),
        ("GRID,1,,0.,0.,0.\nSET1,1,9,THRU,3\n", "expected a range that ascends from 9"),
        ("GRID,1,,0.,0.,0.\n=,*1,=,*1.,==\n", "found `=,*1,=,*1.,==`; expected cards with all of their fields"),
        ("PARAM,POST,-1\n", "expected grid points (GRID)"),
        ("GRID,1,2,0.,0.,0.\nCORD2R,2,,0.,0.,0.,0.,0.,1.\n,0.,0.,2.\n", "that do not lie on one line"),
        ("INCLUDE 'none.bdf'\n", "expected a deck that can be read"),
    ];
    for (text, says) in cases {
        let message = Mesh::read(&written(directory.path(), "y.bdf", text)).unwrap_err().to_string();
        assert!(message.contains("y.bdf") && message.contains(says), "{message}\n{says}");
    }
}
