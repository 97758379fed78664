//! Stress of solid elements, compared with CalculiX: `data/stress.csv` has what CalculiX 2.20 writes for the deck
//! `data/elements.inp`, one distorted element of each type with given displacements of its nodes.

use nlmodes_fem::{Elastic, NodalStress, Solid, SolidShape};
use nlmodes_linalg::Mat;

/// Six digits of the file, and weights of the extrapolation of 27 points that CalculiX has with five.
const TOLERANCE: f64 = 3e-5;

#[test]
fn stress_at_the_nodes_of_every_type_of_element_is_that_of_calculix() {
    let lines = include_str!("data/stress.csv").lines().skip(1);
    let rows: Vec<(&str, Vec<f64>)> = lines
        .map(|line| {
            let (kind, numbers) = line.split_once(',').unwrap();
            (kind, numbers.split(',').map(|number| number.parse().unwrap()).collect())
        })
        .collect();
    let material = Elastic { youngs_modulus: 1000.0, poissons_ratio: 0.3 };
    for kind in ["C3D4", "C3D10", "C3D8", "C3D20", "C3D20R"] {
        let shape = SolidShape::from_type(kind).unwrap();
        let own: Vec<&[f64]> = rows.iter().filter(|row| row.0 == kind).map(|row| row.1.as_slice()).collect();
        assert_eq!(own.len(), shape.n_nodes(), "{kind}");
        let places: Vec<[f64; 3]> = own.iter().map(|row| [row[1], row[2], row[3]]).collect();
        let moved = Mat::from_fn(3 * own.len(), 1, |i, _| own[i / 3][4 + i % 3]);
        let solid = Solid { shape, nodes: (0..own.len()).collect(), material };
        let found = NodalStress::of(&places, &[solid], &moved).unwrap();
        let largest = own.iter().flat_map(|row| &row[7..]).fold(0.0_f64, |largest, s| largest.max(s.abs()));
        for (node, row) in own.iter().enumerate() {
            for (i, expected) in row[7..].iter().enumerate() {
                let value = found.line(node, i)[0];
                assert!((value - expected).abs() < TOLERANCE * largest, "{kind} {node} {i}: {value} {expected}");
            }
        }
    }
}
