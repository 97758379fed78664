//! A model that Gmsh meshed and CalculiX computed: `configs/structures/make.py`.

use std::f64::consts::PI;
use std::fs;
use std::path::{Path, PathBuf};

use nlmodes_io::{ElementKind, FeFiles, FeModel, Mesh, Skin};
use nlmodes_linalg::lowest_modes;

fn structures(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../configs/structures").join(name)
}

pub fn files() -> FeFiles {
    let text = |name: &str| structures(name).to_string_lossy().into_owned();
    FeFiles {
        dofs: Some(structures("bracket.dof")),
        mesh: Some(structures("bracket.inp")),
        units: "mm-t-s".parse().unwrap(),
        ..FeFiles::new(&text("bracket.sti.gz"), &text("bracket.mas.gz"))
    }
}

#[test]
fn frequencies_are_those_that_calculix_says_to_its_seven_digits() {
    let model = FeModel::read(&files()).unwrap();
    let (k, m) = (model.stiffness.symmetric().unwrap(), model.mass.symmetric().unwrap());
    let text = fs::read_to_string(structures("bracket.hz")).unwrap();
    let expected: Vec<f64> = text.lines().map(|line| line.parse().unwrap()).collect();
    let modes = lowest_modes(&k, &m, expected.len()).unwrap();
    for (square, hertz) in modes.eigenvalues.iter().zip(&expected) {
        let found = square.sqrt() / (2.0 * PI);
        assert!((found / hertz - 1.0).abs() < 1e-6, "{found} {hertz}"); // 0.2419153E+04 has seven digits
    }
}

#[test]
fn what_the_bracket_weighs_does_not_depend_on_the_direction() {
    let model = FeModel::read(&files()).unwrap();
    let [x, y, z] = model.mass_along_axes();
    let whole = (30.0 * 20.0 * 4.0 + 4.0 * 20.0 * 36.0) * 7.85e-9 * 1e3; // mm³, t/mm³, kg
    assert!((x / y - 1.0).abs() < 1e-9 && (x / z - 1.0).abs() < 1e-9, "{x} {y} {z}");
    assert!(x < whole && x > 0.6 * whole, "{x} of {whole}: the clamped foot holds some");
    assert!(model.nodes_without_place().is_empty());
    assert_eq!(model.n_dofs(), 1221);
    let foot = model.mesh.as_ref().unwrap().node_set("foot").unwrap();
    assert!(foot.iter().all(|node| model.translations_of(*node) == [None; 3]), "the foot is clamped");
}

#[test]
fn the_deck_and_the_mesh_of_gmsh_are_one_mesh() {
    let deck = Mesh::read(&structures("bracket.inp")).unwrap();
    let gmsh = Mesh::read(&structures("bracket.msh")).unwrap();
    assert_eq!(deck.numbers.len(), gmsh.numbers.len());
    for number in &deck.numbers {
        let (a, b) = (deck.place_of(*number).unwrap(), gmsh.place_of(*number).unwrap());
        assert!((0..3).all(|k| (a[k] - b[k]).abs() < 1e-9), "node {number}: {a:?} {b:?}");
    }
    for set in ["FOOT", "PAD", "EDGE", "BRACKET"] {
        assert_eq!(deck.node_set(set), gmsh.node_set(set), "{set}");
    }
    assert!(deck.elements.iter().all(|e| e.kind == ElementKind::Tetrahedron && e.nodes.len() == 10));
    let area = |mesh: &Mesh| {
        let normals = Skin::of(mesh).normals(mesh);
        normals.iter().map(|n| n.iter().map(|x| x * x).sum::<f64>().sqrt()).sum::<f64>()
    };
    assert!((area(&deck) / area(&gmsh) - 1.0).abs() < 1e-9);
}

#[test]
fn the_skin_encloses_the_volume() {
    for name in ["bracket.inp", "bracket.msh"] {
        let mesh = Mesh::read(&structures(name)).unwrap();
        let skin = Skin::of(&mesh);
        // Divergence theorem over flat triangles: a third of centre times normal.
        let mut volume = 0.0;
        for cell in skin.cells.iter().filter(|cell| cell.kind == ElementKind::Triangle) {
            let [a, b, c] = [0, 1, 2].map(|k| mesh.places[cell.nodes[k] as usize]);
            let u: [f64; 3] = std::array::from_fn(|k| b[k] - a[k]);
            let v: [f64; 3] = std::array::from_fn(|k| c[k] - a[k]);
            let n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
            volume += (0..3).map(|k| a[k] * n[k]).sum::<f64>() / 6.0;
            // Midside nodes are at the midpoints: the order of the nodes is correct.
            for edge in 0..3 {
                let (p, q) = (mesh.places[cell.nodes[edge] as usize], mesh.places[cell.nodes[(edge + 1) % 3] as usize]);
                let middle = mesh.places[cell.nodes[3 + edge] as usize];
                assert!((0..3).all(|k| (p[k] / 2.0 + q[k] / 2.0 - middle[k]).abs() < 1e-6), "{name}");
            }
        }
        assert!((volume / 5280.0 - 1.0).abs() < 1e-9, "{name}: {volume}");
        let of_solids = Skin::of_solids(&mesh).volume(&mesh);
        assert!((of_solids / 5280.0 - 1.0).abs() < 1e-9, "{name}: {of_solids}");
        let sum = skin.normals(&mesh).iter().fold([0.0; 3], |s: [f64; 3], n| std::array::from_fn(|k| s[k] + n[k]));
        assert!(sum.iter().all(|x| x.abs() < 1e-9), "a closed skin has no net normal, {sum:?}");
    }
}

#[test]
fn elements_have_positive_volume_and_their_middles_in_the_middle() {
    for name in ["bracket.inp", "bracket.msh"] {
        let mesh = Mesh::read(&structures(name)).unwrap();
        for element in mesh.elements.iter().filter(|e| e.kind == ElementKind::Tetrahedron) {
            for (edge, [a, b]) in element.kind.edges().iter().enumerate() {
                let at = |k: usize| mesh.places[element.nodes[k] as usize];
                let (p, q, middle) = (at(*a), at(*b), at(4 + edge));
                assert!(
                    (0..3).all(|k| (p[k] / 2.0 + q[k] / 2.0 - middle[k]).abs() < 1e-6),
                    "{name}, {}",
                    element.number
                );
            }
        }
    }
}
