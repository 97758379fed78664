//! Beams, frames and elastic stops compared with textbook results: mass properties, rules of redistribution, rigid
//! motions, and the spring tips.

use nlmodes_linalg::{SparseMatrix, Triplet, bilinear, multiply, sparse_from_triplets, triplets};
use nlmodes_model::{
    Conserve, Contact, ContactCoordinates, Dof, DofKind, Drop, MassProperties, MassRedistribution,
    MasslessContactModel, ModelError, Move, RigidMotion, Side, StructuralModel,
};

/// Units of length and mass.
const UNITS: [(f64, f64); 4] = [(1.0, 1.0), (1e-3, 1.0), (1.0, 1e-6), (40.0, 1e3)];

const ELEMENTS: usize = 16;

/// A beam from `from` on, free at both ends, with `EI = ρA = 1` in these units and elements of a tenth, with consistent
/// mass; deflection and rotation of each node.
fn beam(from: f64, (length, mass): (f64, f64), contacts: Vec<Contact>) -> StructuralModel {
    let l = 0.1 * length;
    let stiffness = [[12.0, 6.0, -12.0, 6.0], [6.0, 4.0, -6.0, 2.0], [-12.0, -6.0, 12.0, -6.0], [6.0, 2.0, -6.0, 4.0]];
    let inertia =
        [[156.0, 22.0, 54.0, -13.0], [22.0, 4.0, 13.0, -3.0], [54.0, 13.0, 156.0, -22.0], [-13.0, -3.0, -22.0, 4.0]];
    let n = 2 * ELEMENTS + 2;
    let matrix = |of: [[f64; 4]; 4], factor: f64| {
        let unit = |i: usize| if i % 2 == 1 { l } else { 1.0 };
        let entries = (0..ELEMENTS).flat_map(|e| {
            (0..16).map(move |ij| {
                let (i, j) = (ij / 4, ij % 4);
                (2 * e + i, 2 * e + j, factor * unit(i) * unit(j) * of[i][j])
            })
        });
        sparse_from_triplets(n, n, &entries.collect::<Vec<Triplet>>()).unwrap()
    };
    let kinds = [DofKind::Deflection, DofKind::Rotation];
    let dof = |i: usize| Dof { node: i / 2, position: from + l * (i / 2) as f64, kind: kinds[i % 2] };
    let mass = matrix(inertia, mass / length * l / 420.0);
    StructuralModel::new(mass, matrix(stiffness, l.powi(-3)), (0..n).map(dof).collect(), contacts).unwrap()
}

/// Masses in a row along the axis, half of one at the end.
fn row((length, mass): (f64, f64), contacts: Vec<Contact>) -> StructuralModel {
    let n = ELEMENTS;
    let m: Vec<Triplet> = (0..n).map(|i| (i, i, if i + 1 == n { 0.5 * mass } else { mass })).collect();
    let mut k = vec![(0, 0, 1.0)];
    (1..n).for_each(|i| k.extend([(i, i, 1.0), (i - 1, i - 1, 1.0), (i - 1, i, -1.0), (i, i - 1, -1.0)]));
    let dofs = (0..n).map(|i| Dof { node: i, position: 0.1 * length * (i + 1) as f64, kind: DofKind::Axial }).collect();
    let [m, k] = [m, k].map(|entries| sparse_from_triplets(n, n, &entries).unwrap());
    StructuralModel::new(m, k, dofs, contacts).unwrap()
}

#[test]
fn a_uniform_beam_has_the_mass_properties_of_the_textbook() {
    for (length, mass) in UNITS {
        for from in [0.0, -0.7 * length, 3.0 * length] {
            let model = beam(from, (length, mass), vec![]);
            let (rho, to) = (mass / length, from + 0.1 * length * ELEMENTS as f64);
            let found = MassProperties::of(model.mass(), model.dofs(), DofKind::Deflection);
            let near = |a: f64, b: f64, unit: f64| assert!((a - b).abs() < 1e-12 * unit, "{a}, not {b}");
            near(found.total, rho * (to - from), mass);
            near(found.first_moment, rho * (to * to - from * from) / 2.0, mass * length);
            near(found.moment_of_inertia, rho * (to.powi(3) - from.powi(3)) / 3.0, 10.0 * mass * length * length);
            near(found.centre(), 0.5 * (from + to), length);
        }
    }
}

/// Quantities conserved by the rules in any unit, for contacts at the end, next to it and inside; the rows of the
/// contacts are empty.
#[test]
fn rules_keep_the_moments_that_they_promise_in_any_unit() {
    for unit in UNITS {
        for nodes in [&[ELEMENTS][..], &[ELEMENTS - 1], &[7], &[5, 11]] {
            let stops = |dof: &dyn Fn(usize) -> usize| -> Vec<Contact> {
                nodes.iter().map(|&node| Contact::rigid(dof(node), Side::Positive, 0.1)).collect()
            };
            let across = beam(0.3 * unit.0, unit, stops(&|node| 2 * node));
            let along = row(unit, stops(&|node| node - 1));
            for (model, kind) in [(across, DofKind::Deflection), (along, DofKind::Axial)] {
                let rules: [(&dyn MassRedistribution, bool); 2] = [(&Move, false), (&Conserve, true)];
                for (rule, keeps_inertia) in rules {
                    let mass = rule.redistribute(&model).unwrap();
                    let of = |mass: &SparseMatrix| MassProperties::of(mass, model.dofs(), kind);
                    let (before, after) = (of(model.mass()), of(&mass));
                    let what = format!("{} {kind:?} {unit:?} {nodes:?}", rule.name());
                    let near = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-12, "{what}: {a}, not {b}");
                    near(after.total, before.total);
                    near(after.first_moment, before.first_moment);
                    if keeps_inertia {
                        near(after.moment_of_inertia, before.moment_of_inertia);
                    }
                    for contact in model.contacts() {
                        let dof = contact.single_dof().unwrap().dof;
                        assert!(triplets(&mass).all(|(i, j, m)| m == 0.0 || (i != dof && j != dof)), "{what}");
                    }
                }
            }
        }
    }
}

/// At an end the nearest node takes more than the whole mass and the next one a negative mass, at distances of one and
/// two.
#[test]
fn a_mass_at_an_end_moves_to_the_two_nodes_before_it() {
    for unit in UNITS {
        let model = row(unit, vec![Contact::rigid(ELEMENTS - 1, Side::Positive, 0.1)]);
        let mass = Move.redistribute(&model).unwrap();
        for (i, expected) in [(ELEMENTS - 2, 2.0), (ELEMENTS - 3, 0.5), (ELEMENTS - 4, 1.0)] {
            assert!((mass[(i, i)] / unit.1 - expected).abs() < 1e-12, "{unit:?} {i}: {}", mass[(i, i)]);
        }
    }
}

#[test]
fn a_free_beam_translates_and_turns_about_the_node_that_is_held() {
    for unit in UNITS {
        for node in [0, 5, ELEMENTS] {
            let stop = Contact::rigid(2 * node, Side::Positive, 0.1);
            let model = MasslessContactModel::new(&beam(0.4 * unit.0, unit, vec![stop]), &Drop).unwrap();
            assert_eq!(model.rigid_motion(), Some(RigidMotion::Transverse));
            let Some(RigidMotion::Rotation { about }) = model.held_rigid_motion() else { panic!("{node}") };
            assert!((about / unit.0 - 0.4 - 0.1 * node as f64).abs() < 1e-12, "{node}: {about}");
        }
    }
}

/// Two nodes of a beam in space along X, 6 degrees of freedom each, with springs to the ground at all but one of the
/// first.
fn frame(length: f64, left_free: usize) -> MasslessContactModel {
    let (l, ea, gj, ei) = (length, 3.0, 0.7 * length * length, [1.1 * length * length, 1.9 * length * length]);
    let mut k: Vec<Triplet> = Vec::new();
    for (dof, stiffness) in [(0, ea / l), (3, gj / l)] {
        k.extend([(dof, dof, stiffness), (dof + 6, dof + 6, stiffness)]);
        k.extend([(dof, dof + 6, -stiffness), (dof + 6, dof, -stiffness)]);
    }
    // Bending in the plane XY turns about Z with the slope; in XZ about Y against it.
    for ([v, turn], ei, sign) in [([1, 5], ei[0], 1.0), ([2, 4], ei[1], -1.0)] {
        let at = [(v, 1.0), (turn, sign * l), (v + 6, 1.0), (turn + 6, sign * l)];
        let of = [[12.0, 6.0, -12.0, 6.0], [6.0, 4.0, -6.0, 2.0], [-12.0, -6.0, 12.0, -6.0], [6.0, 2.0, -6.0, 4.0]];
        for (i, (row, a)) in at.iter().enumerate() {
            k.extend(at.iter().enumerate().map(|(j, (column, b))| (*row, *column, ei / l.powi(3) * a * b * of[i][j])));
        }
    }
    let unit = |dof: usize| if dof % 6 < 3 { ea / l } else { ei[0] / l };
    k.extend((0..6).filter(|dof| *dof != left_free).map(|dof| (dof, dof, unit(dof))));
    let kinds = [DofKind::X, DofKind::Y, DofKind::Z, DofKind::RX, DofKind::RY, DofKind::RZ];
    let place = |i: usize| [0.3 * l + if i < 6 { 0.0 } else { l }, 0.2 * l, -0.5 * l];
    let dofs = (0..12).map(|i| Dof { node: i / 6, position: place(i)[0], kind: kinds[i % 6] }).collect();
    let m: Vec<Triplet> = (0..12).map(|i| (i, i, 1.0)).collect();
    let [m, k] = [m, k].map(|entries| sparse_from_triplets(12, 12, &entries).unwrap());
    let model = StructuralModel::new(m, k, dofs, vec![Contact::rigid(6, Side::Positive, 0.1)]).unwrap();
    MasslessContactModel::new(&model.with_places((0..12).map(place).collect()).unwrap(), &Drop).unwrap()
}

/// The motion left by one missing support is a translation along its axis or a rotation about it through the node.
#[test]
fn a_frame_moves_as_the_support_that_is_missing_lets_it() {
    for length in [1.0, 1e-3, 1e3, 1e-7, 1e7] {
        assert_eq!(frame(length, usize::MAX).rigid_motion(), None);
        for free in 0..6 {
            let Some(RigidMotion::Spatial { translation, rotation }) = frame(length, free).rigid_motion() else {
                panic!("{length} {free}")
            };
            let place = [0.3, 0.2, -0.5].map(|x| x * length);
            // For the node with all but one direction fixed: t + r × x.
            let r = rotation;
            let turned = [
                r[1] * place[2] - r[2] * place[1],
                r[2] * place[0] - r[0] * place[2],
                r[0] * place[1] - r[1] * place[0],
            ];
            let moves: Vec<f64> = (0..3).map(|a| translation[a] + turned[a]).chain(r.map(|r| r * length)).collect();
            for (dof, value) in moves.iter().enumerate() {
                let rest = dof != free;
                assert!(value.abs() < 1e-8 || !rest, "{length} {free}: {moves:?}");
                assert!(value.abs() > 0.1 || rest, "{length} {free}: {moves:?}");
            }
        }
    }
}

/// Spring tips: springs connect the nodes of the structure with the tips, and an unloaded tip follows its node.
#[test]
fn spring_tips_are_springs_between_the_nodes_and_the_stops() {
    let (n, springs) = (5, [3.0, 0.4, 7.0]);
    let stop = |dof, side, k| Contact::elastic(dof, side, 0.1, k);
    // Two stops face each other at the last node.
    let contacts = vec![
        stop(4, Side::Positive, springs[0]),
        stop(1, Side::Negative, springs[1]),
        stop(4, Side::Negative, springs[2]),
    ];
    let mut k = vec![(0, 0, 1.0)];
    (1..n).for_each(|i| k.extend([(i, i, 1.0), (i - 1, i - 1, 1.0), (i - 1, i, -1.0), (i, i - 1, -1.0)]));
    let m: Vec<Triplet> = (0..n).map(|i| (i, i, 1.0 + i as f64)).collect();
    let [m, k] = [m, k].map(|entries| sparse_from_triplets(n, n, &entries).unwrap());
    let dofs: Vec<Dof> = (0..n).map(|i| Dof { node: i, position: i as f64, kind: DofKind::Axial }).collect();
    let model = StructuralModel::new(m, k, dofs.clone(), contacts).unwrap();
    let tips = MasslessContactModel::with_spring_tips(&model, None).unwrap();
    assert_eq!(tips.contact_coordinates(), ContactCoordinates::SpringTips);
    assert_eq!((tips.linear_dofs(), tips.contact_dofs()), (&[0, 1, 2, 3, 4][..], &[4, 1, 4][..]));
    assert_eq!(tips.stop_compliance(), [0.0; 3], "the springs are in the stiffness");
    let q: Vec<f64> = (0..n).map(|i| (1.3 * i as f64 + 0.4).sin()).collect();
    // Strain energy: that of the structure, and ½ k (q − tip)² of each spring.
    for tip in [[0.0; 3], [q[4], q[1], q[4]], [0.3, -0.2, 0.7]] {
        let of_springs: f64 =
            tips.contacts().iter().zip(tip).zip(springs).map(|((c, t), k)| 0.5 * k * (q[c.dof] - t).powi(2)).sum();
        let expected = 0.5 * bilinear(&q, model.stiffness(), &q) + of_springs;
        let mixed: f64 = (0..n).map(|i| (0..3).map(|j| q[i] * tips.k_ln()[(i, j)] * tip[j]).sum::<f64>()).sum();
        let own: f64 = (0..3).map(|i| (0..3).map(|j| tip[i] * tips.k_nn()[(i, j)] * tip[j]).sum::<f64>()).sum();
        let found = 0.5 * bilinear(&q, tips.k_ll(), &q) + mixed + 0.5 * own;
        assert!((found - expected).abs() < 1e-14, "{found}, not {expected}");
    }
    // A force of one at each stop alone, away from it.
    for (i, j) in (0..3).flat_map(|i| (0..3).map(move |j| (i, j))) {
        let own = if i == j { [-1.0, 1.0, 1.0][i] } else { 0.0 };
        assert_eq!(tips.w()[(i, j)], own, "({i}, {j})");
    }
    assert_eq!(multiply(tips.mass(), &q), multiply(model.mass(), &q), "the nodes keep their mass");
    let dropped = MasslessContactModel::with_spring_tips(&model, Some(&Drop)).unwrap();
    assert_eq!([1, 4].map(|i| dropped.mass().get(i, i).copied().unwrap_or(0.0)), [0.0; 2]);
    let none = model.clone().with_contacts(vec![]).unwrap();
    assert_eq!(MasslessContactModel::with_spring_tips(&none, None).unwrap_err(), ModelError::NoContact);
    let rigid = model.with_contacts(vec![Contact::rigid(4, Side::Positive, 0.1)]).unwrap();
    assert_eq!(MasslessContactModel::with_spring_tips(&rigid, None).unwrap_err(), ModelError::RigidStop { contact: 0 });
}
