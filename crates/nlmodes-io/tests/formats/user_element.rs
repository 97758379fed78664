//! Substructures of Abaqus.

use std::fmt::Write as _;
use std::fs;

use nlmodes_io::{Component, DofLabel, FeFiles, FeModel, NodeChoice};

use crate::agreement::read;
use crate::sample::{Entry, N, label, mass, stiffness};

/// A triangle, from the top of each column to the diagonal, four values a line.
fn packed(name: &str, lower: &[Entry]) -> String {
    let mut text = format!("*MATRIX,TYPE={name}\n");
    for column in 0..N {
        let value = |row: usize| lower.iter().find(|e| (e.0, e.1) == (column, row)).map_or(0.0, |e| e.2);
        let values: Vec<String> = (0..=column).map(|row| format!("{:22.15e}", value(row))).collect();
        let lines: Vec<String> = values.chunks(4).map(|line| line.join(",")).collect();
        _ = writeln!(text, "{}", lines.join(",\n"));
    }
    text
}

/// As Abaqus writes it: nodes in comments; with `element`, as in a deck that uses it.
fn head(element: bool) -> String {
    let nodes: Vec<String> = (0..N / 3).map(|k| label(3 * k).0.to_string()).collect();
    let (first, rest) = nodes.split_at(5);
    let (first, rest) = (first.join(", "), rest.join(", "));
    let head = format!("**\n** SUBSTRUCTURE GENERATION STEP\n**\n*USER ELEMENT, NODES=  {}, LINEAR\n", N / 3);
    match element {
        true => format!("{head}1, 2, 3\n*ELEMENT, TYPE=U1, ELSET=S\n1, {first},\n{rest}\n"),
        false => format!("{head}** ELEMENT NODES\n**  {first},\n**  {rest}\n      1,      2,     3\n"),
    }
}

#[test]
fn both_triangles_of_a_substructure_are_read_from_one_file_or_from_two() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("sub.mtx");
    for element in [false, true] {
        let both = head(element) + &packed("STIFFNESS", &stiffness()) + "**\n" + &packed("MASS", &mass());
        fs::write(&path, both).unwrap();
        for (name, expected) in [("STIFFNESS", stiffness()), ("mass", mass())] {
            let found = read(&path, Some(name), None).unwrap();
            let labels: Vec<DofLabel> = (0..N)
                .map(|row| DofLabel { node: label(row).0 as u64, component: Component::DIRECTED[label(row).1 - 1] })
                .collect();
            assert_eq!(found.labels.as_deref(), Some(&labels[..]));
            let entries: Vec<Entry> = found.lower.entries().collect();
            assert_eq!(entries.len(), expected.len());
            for (a, b) in entries.iter().zip(&expected) {
                assert!((a.0, a.1) == (b.0, b.1) && (a.2 - b.2).abs() <= 1e-15 * b.2.abs(), "{a:?} {b:?}");
            }
        }
        let several = read(&path, None, None).unwrap_err().to_string();
        assert!(several.contains("`STIFFNESS`, `MASS`") && several.contains("sub.mtx#STIFFNESS"), "{several}");
        let missing = read(&path, Some("DAMPING"), None).unwrap_err().to_string();
        assert!(missing.contains("no matrix of type `DAMPING`; expected one of `STIFFNESS`, `MASS`"), "{missing}");
    }
    fs::write(&path, head(false) + &packed("MASS", &mass())).unwrap();
    assert_eq!(read(&path, None, None).unwrap().lower.n_entries(), mass().len());
    let address = path.to_string_lossy();
    fs::write(&path, head(true) + &packed("STIFFNESS", &stiffness()) + &packed("MASS", &mass())).unwrap();
    let mut files = FeFiles::new(&format!("{address}#STIFFNESS"), &format!("{address}#MASS"));
    files.fixed = vec![NodeChoice::Node(10)];
    assert_eq!(FeModel::read(&files).unwrap().n_dofs(), N - 3);
}

/// Directions of the second list count from their place in the list of nodes on: a plane element with a rotation.
#[test]
fn directions_may_change_along_the_nodes() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("sub.mtx");
    let text = "*USER ELEMENT, NODES=3, LINEAR\n** ELEMENT NODES\n** 7, 5, 9\n1\n2, 2, 6\n3, 3\n\
    *MATRIX, TYPE=STIFFNESS\n\
                2.0\n-1.0, 3.0\n0.0, 0.0, 4.0\n0.0, 0.0, 0.0,\n5.0\n";
    fs::write(&path, text).unwrap();
    let found = read(&path, None, None).unwrap();
    let names: Vec<String> = found.labels.unwrap().iter().map(ToString::to_string).collect();
    assert_eq!(names, ["uy of node 5", "rotz of node 5", "ux of node 7", "uz of node 9"]);
    let entries: Vec<Entry> = found.lower.entries().collect();
    assert_eq!(entries, [(0, 0, 3.0), (2, 0, -1.0), (1, 1, 4.0), (2, 2, 2.0), (3, 3, 5.0)]);
}

#[test]
fn damaged_substructures_are_refused() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("sub.mtx");
    let good = head(false) + &packed("STIFFNESS", &stiffness());
    let cases = [
        (good.replace("NODES=  8", "NODES=  9"), "nodes of the user element, below `** ELEMENT NODES`"),
        (good.replace("      1,      2,     3\n", "      1,      2\n"), "triangle of a matrix of 16 rows: found 300"),
        (good.replace("      1,      2,     3\n", "      1,      2,     11\n"), "found direction 11 of node 10"),
        (good.replace(", LINEAR", ", LINEAR, UNSYMM"), "a user element with UNSYMM"),
        (good.replace("NODES=  8, ", ""), "expected NODES=… with *USER ELEMENT"),
        (format!("{good}1.0\n"), "number of values in the triangle of a matrix of 24 rows: found 301, expected 300"),
        (format!("{good}*USER ELEMENT, NODES=2\n"), "expected one *USER ELEMENT in a file"),
        (good.replace("**  10,", "**  0,"), "found direction 1 of node 0"),
        (good.replace("**  10, 20", "**  10, 10"), "is there a second time"),
        (good.replace("3.333333333333333e5", "3.333333333333333x5"), "expected a number, the value"),
        (head(false), "expected *MATRIX, TYPE=STIFFNESS or TYPE=MASS"),
    ];
    for (text, says) in cases {
        assert_ne!(text, good, "{says}");
        fs::write(&path, text).unwrap();
        let message = read(&path, None, None).map(|_| ()).unwrap_err().to_string();
        assert!(message.contains(says) && message.contains("sub.mtx"), "{message}\n{says}");
    }
}

/// `node,dof, node,dof, value` with each entry and its mirror image.
#[test]
fn both_triangles_of_one_matrix_are_one_matrix() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("full.mtx");
    let line = |i: usize, j: usize, value: f64| {
        let (a, b) = (label(i), label(j));
        format!("{},{}, {},{}, {value:.17e}\n", a.0, a.1, b.0, b.1)
    };
    let all = stiffness().into_iter().flat_map(|(i, j, v)| {
        let mirrored = (i != j).then(|| line(j, i, v));
        [Some(line(i, j, v)), mirrored].into_iter().flatten()
    });
    let full: String = all.collect();
    fs::write(&path, &full).unwrap();
    assert!(read(&path, None, None).unwrap().lower.entries().eq(stiffness()));
    // Mirror images that do not agree, and an entry twice.
    let (i, j, value) = stiffness()[1];
    let skew = full.replace(&line(j, i, value), &line(j, i, 2.0 * value));
    fs::write(&path, skew).unwrap();
    let message = read(&path, None, None).map(|_| ()).unwrap_err().to_string();
    assert!(message.contains("expected a symmetric matrix"), "{message}");
    fs::write(&path, format!("{full}{}", line(0, 0, 1.0))).unwrap();
    let message = read(&path, None, None).map(|_| ()).unwrap_err().to_string();
    assert!(message.contains("is there a second time"), "{message}");
}
