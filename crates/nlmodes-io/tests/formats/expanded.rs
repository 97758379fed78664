//! Nodes that CalculiX expands into several ones.

use std::fs;
use std::path::Path;

use nlmodes_io::{Component, FeFiles, FeModel, NodeChoice};

/// A shell of one element whose free nodes 3 and 4 are two nodes each, below and above; of node 2 one row is left.
const DECK: &str = "*BOUNDARY\n1, 1, 6\n2, 3\n*NODE\n1\n2, 1\n3, 1, 1\n4, 0, 1\n*ELEMENT, TYPE=S4, ELSET=E\n\
1, 1, 2, 3, 4\n*NSET, NSET=TIP\n2, 3\n";
const LABELS: [&str; 5] = ["2.3", "3.3", "3.3", "4.3", "4.3"];

/// Symmetric, positive definite, nothing else.
fn matrix(scale: f64) -> [[f64; 5]; 5] {
    let entry = |i: usize, j: usize| if i == j { 10.0 + i as f64 } else { 1.0 / (1.0 + (i + j) as f64) };
    std::array::from_fn(|i| std::array::from_fn(|j| scale * entry(i, j)))
}

fn model(directory: &Path, deck: Option<&str>, labels: &[&str]) -> nlmodes_io::Result<FeModel> {
    let file = |name: &str, text: &str| {
        let path = directory.join(name);
        fs::write(&path, text).unwrap();
        path.to_string_lossy().into_owned()
    };
    let text = |a: [[f64; 5]; 5]| -> String {
        let entries = (0..5).flat_map(|j| (0..=j).map(move |i| (i, j)));
        entries.map(|(i, j)| format!("{} {} {:.17e}\n", i + 1, j + 1, a[i][j])).collect()
    };
    let mut files = FeFiles::new(&file("x.sti", &text(matrix(1e3))), &file("x.mas", &text(matrix(0.5))));
    let table: String = labels.iter().map(|label| format!("{label}\n")).collect();
    files.dofs = Some(file("x.dof", &table).into());
    files.mesh = deck.map(|deck| file("x.inp", deck).into());
    FeModel::read(&files)
}

#[test]
fn a_node_moves_as_the_mean_of_those_that_come_of_it() {
    let directory = tempfile::tempdir().unwrap();
    let model = model(directory.path(), Some(DECK), &LABELS).unwrap();
    assert_eq!(model.n_dofs(), 5, "frequencies are those of all rows");
    let [three, four] = [3, 4].map(|node| model.row_of(node, Component::Z).unwrap());
    assert_eq!(model.row_of(2, Component::Z), None, "one row of two does not tell how the node moves");
    // Energies of any motion are the same: q of both nodes, then their mean and difference.
    let q = [0.3, 1.0, -0.4, 2.0, 1.5];
    let mut p = [q[0], 0.0, 0.0, 0.0, 0.0];
    (p[three], p[four]) = ((q[1] + q[2]) / 2.0, (q[3] + q[4]) / 2.0);
    let others: Vec<usize> = (1..5).filter(|row| *row != three && *row != four).collect();
    (p[others[0]], p[others[1]]) = (q[2] - q[1], q[4] - q[3]);
    for (found, of) in [(&model.stiffness, matrix(1e3)), (&model.mass, matrix(0.5))] {
        let energy: f64 = found.entries().map(|(i, j, v)| v * p[i] * p[j] * if i == j { 0.5 } else { 1.0 }).sum();
        let expected: f64 =
            (0..5).flat_map(|i| (0..5).map(move |j| (i, j))).map(|(i, j)| 0.5 * of[i][j] * q[i] * q[j]).sum();
        assert!((energy / expected - 1.0).abs() < 1e-14, "{energy} {expected}");
    }
    // All that a rigid displacement of the nodes moves: rows 2 to 5.
    let of = matrix(0.5);
    let expected: f64 = (1..5).flat_map(|i| (1..5).map(move |j| of[i][j])).sum();
    assert!((model.mass_along_axes()[2] / expected - 1.0).abs() < 1e-14);
    assert_eq!(model.nodes_without_place().len(), 3);
}

/// Everything derived from a node is fixed with it, and none of it moves with a base.
#[test]
fn a_node_is_held_with_all_that_comes_of_it() {
    let directory = tempfile::tempdir().unwrap();
    let free = model(directory.path(), Some(DECK), &LABELS).unwrap();
    let mut files = FeFiles::new(
        &directory.path().join("x.sti").to_string_lossy(),
        &directory.path().join("x.mas").to_string_lossy(),
    );
    files.dofs = Some(directory.path().join("x.dof"));
    files.mesh = Some(directory.path().join("x.inp"));
    files.fixed = vec![NodeChoice::Set("TIP".into())];
    let held = FeModel::read(&files).unwrap();
    assert_eq!(held.n_dofs(), 2, "nodes 2 and 3, with one row and two, are held");
    let four = held.row_of(4, Component::Z).unwrap();
    let [of_three, of_four] = [3, 4].map(|node| free.row_of(node, Component::Z).unwrap());
    assert_eq!(held.stiffness.get(four, four), free.stiffness.get(of_four, of_four));
    let inertia = held.inertia_along([0.0, 0.0, 1.0])[four];
    let expected = free.mass.get(of_four, of_four) + free.mass.get(of_four, of_three);
    assert!((inertia / expected - 1.0).abs() < 1e-14, "{inertia} {expected}");
}

/// In the plane one row is the motion of the node; along z the nodes that come of it breathe.
#[test]
fn plane_elements_keep_their_rows_in_the_plane() {
    let directory = tempfile::tempdir().unwrap();
    for kind in ["CPS4", "CPE4R", "CAX4"] {
        let deck = DECK.replace("S4", kind);
        let model = model(directory.path(), Some(&deck), &["3.3", "3.1", "3.2", "3.3", "2.3"]).unwrap();
        let rows = [Component::X, Component::Y, Component::Z].map(|component| model.row_of(3, component));
        assert_eq!(rows, [Some(1), Some(2), None], "{kind}");
        assert_eq!(model.is_held(3, Component::Z), Some(true), "{kind}: nothing leaves the plane");
        assert!((model.stiffness.get(1, 2) - 1e3 / 4.0).abs() < 1e-12);
    }
}

#[test]
fn quadratic_shells_and_beams_have_as_many_nodes_as_calculix_makes_of_them() {
    let directory = tempfile::tempdir().unwrap();
    let nodes = "*NODE\n1\n2, 1\n3, 2\n4, 0, 1\n5, 1, 1\n6, 2, 1\n";
    let cases = [
        ("S6", "1, 1, 3, 4, 2, 5, 6\n", "1.3", 3),
        ("S6", "1, 1, 3, 4, 2, 5, 6\n", "5.3", 2),
        ("B32R", "1, 1, 2, 3\n", "2.1", 4),
        ("B31", "1, 1, 2\n", "2.1", 4),
        ("T3D2", "1, 1, 2\n", "1.1", 4),
        ("M3D3", "1, 1, 2, 4\n", "1.1", 2),
        ("M3D3", "1, 1, 2, 4\n2, 2, 4, 5\n", "2.1", 3),
        ("M3D6", "1, 1, 3, 4, 2, 5, 6\n", "1.1", 3),
    ];
    for (kind, element, label, copies) in cases {
        let deck = format!("{nodes}*ELEMENT, TYPE={kind}, ELSET=E\n{element}");
        for count in 2..=5 {
            let others = ["90.1", "91.1", "92.1"];
            let labels: Vec<&str> = (0..count).map(|_| label).chain(others).take(5).collect();
            let model = model(directory.path(), Some(&deck), &labels).unwrap();
            let (node, direction) = label.split_once('.').unwrap();
            let component = Component::from_name(direction).unwrap();
            let moves = model.row_of(node.parse().unwrap(), component).is_some();
            // Of the nodes around a hinge some may depend on others, the hinge itself comes first.
            let hinge = kind.starts_with(['T', 'M']);
            assert_eq!(moves, count == copies || (hinge && count < copies), "{kind}, {count} rows of {label}");
        }
    }
}

/// A mass of four equal rows that do not know of each other: rounding of the differences is no mass between them.
#[test]
fn terms_that_cancel_leave_nothing() {
    let directory = tempfile::tempdir().unwrap();
    let deck = "*NODE\n1\n2, 1\n*ELEMENT, TYPE=B31, ELSET=E\n1, 1, 2\n";
    let text = |value: f64| -> String {
        (0..5).flat_map(|j| (0..=j).map(move |i| (i, j))).fold(String::new(), |text, (i, j)| {
            text + &format!("{} {} {:.17e}\n", i + 1, j + 1, if i == j { value } else { 0.0 })
        })
    };
    let file = |name: &str, text: &str| {
        let path = directory.path().join(name);
        fs::write(&path, text).unwrap();
        path.to_string_lossy().into_owned()
    };
    let mut files = FeFiles::new(&file("x.sti", &text(1.0 / 3.0)), &file("x.mas", &text(0.1)));
    files.dofs = Some(file("x.dof", "2.1\n2.1\n2.1\n2.1\n1.1\n").into());
    files.mesh = Some(file("x.inp", deck).into());
    let model = FeModel::read(&files).unwrap();
    let mean = model.row_of(2, Component::X).unwrap();
    let beside: Vec<f64> = (0..4).filter(|row| *row != mean).map(|row| model.mass.get(mean, row)).collect();
    assert_eq!(beside, [0.0; 3]);
    assert!((model.mass.get(mean, mean) - 0.4).abs() < 1e-15);
}

/// Where beams have an offset, those that come of a node depend on it: rows of the nodes themselves come first, one for
/// each direction. What is left of a node that is held looks the same.
#[test]
fn a_knot_has_rows_of_its_own() {
    let directory = tempfile::tempdir().unwrap();
    let knots = ["2.1", "2.3", "3.1", "3.3", "56.1"];
    let deck = DECK.replace("S4", "S4R");
    let model = model(directory.path(), Some(&deck), &knots).unwrap();
    let moves = |node, component| model.row_of(node, component);
    assert_eq!((moves(2, Component::X), moves(3, Component::Z)), (Some(0), Some(3)));
    assert_eq!(moves(2, Component::Z), None, "the deck holds it: that row is of one of the nodes that came of it");
}

/// Of a hinge the first row is its own, and the others are how the ends of elements move against it.
#[test]
fn a_hinge_moves_by_itself() {
    let directory = tempfile::tempdir().unwrap();
    let deck = "*NODE\n1\n2, 1\n3, 2\n*ELEMENT, TYPE=T3D2, ELSET=E\n1, 1, 2\n";
    let model = model(directory.path(), Some(deck), &["2.1", "2.1", "2.1", "2.1", "3.1"]).unwrap();
    assert_eq!((model.row_of(2, Component::X), model.row_of(3, Component::X)), (Some(0), Some(4)));
    let of = matrix(1e3);
    let sum: f64 = (0..4).flat_map(|i| (0..4).map(move |j| of[i][j])).sum();
    assert!((model.stiffness.get(0, 0) / sum - 1.0).abs() < 1e-14, "all move where it moves alone");
    assert!((model.stiffness.get(1, 1) / of[1][1] - 1.0).abs() < 1e-14);
}

#[test]
fn repeated_labels_that_no_shell_explains_are_refused() {
    let directory = tempfile::tempdir().unwrap();
    let without = model(directory.path(), None, &LABELS).unwrap_err().to_string();
    let says = "x.dof:3: found uz of node 3 a second time, after line 2; expected each node and direction once";
    assert!(without.contains(says) && without.contains("give the deck as `mesh`"), "{without}");
    let solid = "*NODE\n1\n2, 1\n3, 1, 1\n4, 0, 1\n*ELEMENT, TYPE=C3D4, ELSET=E\n1, 1, 2, 3, 4\n";
    let message = model(directory.path(), Some(solid), &LABELS).unwrap_err().to_string();
    assert!(message.contains(says) && message.contains("are deck and table of one run?"), "{message}");
    let elsewhere = DECK.replace("S4, ELSET=E\n1, 1, 2, 3, 4", "S3, ELSET=E\n1, 1, 2, 3");
    let message = model(directory.path(), Some(&elsewhere), &LABELS).unwrap_err().to_string();
    assert!(message.contains(says), "node 4 belongs to no shell: {message}");
}
