//! Contacts of nodes with walls and with each other.

use std::fs;
use std::path::Path;

use nlmodes_io::{
    ContactChoice, ContactNodes, FeFiles, FeModel, GapChoice, NodeContact, NormalChoice, Partner, find_contacts,
};

use crate::bracket;

/// Two faces of two nodes that face each other along x, in mm; node 9 is fixed along x.
const LABELS: &str = "1,1,ux\n2,1,uy\n3,1,uz\n4,2,ux\n5,2,uy\n6,2,uz\n7,5,ux\n8,5,uy\n9,6,ux\n10,9,uy\n11,9,uz\n";
const DECK: &str = "*NODE\n1,0,0,0\n2,0,1,0\n5,3,0,0.001\n6,3,1,0\n9,9,9,9\n*NSET,NSET=A\n1,2\n*NSET,NSET=B\n5,6\n";

fn model(directory: &Path) -> (FeModel, FeFiles) {
    let diagonal: String = (1..=11).map(|k| format!("{k} {k} 2\n")).collect();
    let file = |name: &str, text: &str| {
        let path = directory.join(name);
        fs::write(&path, text).unwrap();
        path.to_string_lossy().into_owned()
    };
    let matrix = format!("%%MatrixMarket matrix coordinate real symmetric\n11 11 11\n{diagonal}");
    let (k, m) = (file("k.mtx", &matrix), file("m.mtx", &matrix));
    file("pairs.csv", "node_a,node_b,nx,ny,nz,gap_m\n1,5,0,2,0,1e-3\n");
    file("plain.csv", "2,5\n");
    file("bad.csv", "1,5\n2,6,1\n");
    let files = FeFiles {
        dofs: Some(file("d.csv", LABELS).into()),
        mesh: Some(file("x.inp", DECK).into()),
        units: "mm-t-s".parse().unwrap(),
        ..FeFiles::new(&k, &m)
    };
    (FeModel::read(&files).unwrap(), files)
}

fn set(name: &str) -> ContactNodes {
    ContactNodes::Set(name.into())
}

fn wall(nodes: &[u64], normal: [f64; 3], gap: f64) -> ContactChoice {
    ContactChoice {
        nodes: ContactNodes::Numbers(nodes.to_vec()),
        partner: Partner::Wall,
        normal: Some(NormalChoice::Vector(normal)),
        gap: Some(GapChoice::Same(gap)),
        stiffness: None,
        damping: None,
        friction_estimate: None,
    }
}

#[test]
fn directions_point_to_the_wall_and_between_partners() {
    let directory = tempfile::tempdir().unwrap();
    let (model, files) = model(directory.path());
    let pair = ContactChoice {
        nodes: set("A"),
        partner: Partner::Nearest(set("B"), Some(1e-5)),
        ..wall(&[], [2.0, 0.0, 0.0], 2e-4)
    };
    let table = ContactChoice {
        nodes: ContactNodes::OfPairs,
        partner: Partner::Table(directory.path().join("pairs.csv")),
        normal: None,
        gap: None,
        stiffness: Some(1e6),
        damping: Some(30.0),
        friction_estimate: None,
    };
    let plane =
        ContactChoice { gap: Some(GapChoice::WallPoint([-5e-3, 7.0, 7.0])), ..wall(&[2], [-1.0, 0.0, 0.0], 0.0) };
    let choices = [wall(&[1], [0.0, 3.0, 4.0], 1e-3), pair, table, plane];
    let contacts = find_contacts(&model, &files, &choices).unwrap();
    let w = model.contact_directions(&contacts).unwrap();
    let column = |k: usize| (0..11).map(|row| w.get(row, k).copied().unwrap_or(0.0)).collect::<Vec<_>>();
    assert_eq!(column(0), [0.0, -0.6, -0.8, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], "−n at a node before a wall");
    assert_eq!(column(1), [-1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0], "−n at 1, n at 5");
    assert_eq!(column(2), [0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0], "−n at 2, n at 6");
    assert_eq!(column(3), [0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0], "the table's normal along y");
    let gaps: Vec<f64> = contacts.iter().map(|contact: &NodeContact| contact.gap).collect();
    let expected = [1e-3, 2e-4, 2e-4, 1e-3, 5e-3];
    assert!(gaps.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-15), "{gaps:?}");
    assert_eq!((contacts[3].stiffness, contacts[4].origin), (Some(1e6), 3));
}

#[test]
fn distances_of_the_mesh_are_gaps_where_none_are_said() {
    let directory = tempfile::tempdir().unwrap();
    let (model, files) = model(directory.path());
    let drawn = |normal| ContactChoice {
        nodes: set("A"),
        partner: Partner::Nearest(set("B"), Some(1e-3)),
        gap: None,
        ..wall(&[], normal, 0.0)
    };
    let gaps = |choice: ContactChoice| -> Vec<f64> {
        let found = find_contacts(&model, &files, &[choice]).unwrap();
        found.iter().inspect(|c| assert_eq!(c.distance_in(&model), Some(c.gap))).map(|c| c.gap).collect()
    };
    assert_eq!(gaps(drawn([1.0, 0.0, 0.0])), [3e-3, 3e-3], "across x");
    // Along a tilted normal the distance is what the normal sees: 3 mm · 0.8 and 3 mm · 0.8.
    let tilted = ContactChoice { partner: Partner::Nearest(set("B"), Some(2e-3)), ..drawn([0.8, 0.0, 0.6]) };
    assert!(gaps(tilted).iter().all(|gap| (gap - 2.4e-3).abs() < 1e-6), "0.001 mm along z");
}

/// `(cos π, sin π)` is not the opposite of `(1, 0)` to the last digit, and another direction to move in if it is taken
/// at its word.
#[test]
fn stops_that_face_each_other_up_to_rounding_share_a_direction() {
    let directory = tempfile::tempdir().unwrap();
    let (model, files) = model(directory.path());
    for angle in [std::f64::consts::PI, std::f64::consts::PI + 1e-9, std::f64::consts::PI - 1e-6] {
        let across = wall(&[1], [0.0, angle.cos(), angle.sin()], 1e-3);
        let contacts = find_contacts(&model, &files, &[wall(&[1], [0.0, 1.0, 0.0], 1e-3), across]).unwrap();
        assert_eq!(contacts[1].normal, [0.0, -1.0, 0.0], "{angle}");
    }
    let oblique = wall(&[1], [0.0, -1.0, 1e-3], 1e-3);
    let contacts = find_contacts(&model, &files, &[wall(&[1], [0.0, 1.0, 0.0], 1e-3), oblique]).unwrap();
    assert!(contacts[1].normal[2] > 9e-4);
}

#[test]
fn contacts_that_cannot_be_are_refused() {
    let directory = tempfile::tempdir().unwrap();
    let (model, files) = model(directory.path());
    let x = [1.0, 0.0, 0.0];
    let nearest = |nodes: ContactNodes, against: ContactNodes, tolerance| ContactChoice {
        nodes,
        partner: Partner::Nearest(against, tolerance),
        ..wall(&[], x, 0.0)
    };
    let table = |name: &str| ContactChoice {
        nodes: ContactNodes::OfPairs,
        partner: Partner::Table(directory.path().join(name)),
        normal: None,
        gap: None,
        stiffness: None,
        damping: None,
        friction_estimate: None,
    };
    let surface = ContactChoice { normal: Some(NormalChoice::Surface), ..wall(&[1], x, 0.0) };
    let cases = [
        (vec![wall(&[7], x, 0.0)], "node 7 has no displacement in the matrices"),
        (
            vec![wall(&[9], x, 0.0)],
            "node 9 cannot move along its normal [1, 0, 0]: it is fixed there, or dependent on other nodes (*EQUATION, \
                *MPC, *TIE, *COUPLING, *RIGID BODY)",
        ),
        (
            vec![wall(&[1], x, 0.0), wall(&[2, 1], [2.0, 0.0, 0.0], 0.0)],
            "node 1 has this contact already, from contact 0",
        ),
        (vec![wall(&[1, 1], x, 0.0)], "node 1 has this contact already"),
        (
            vec![wall(&[1], x, -1e-3), wall(&[1], [-1.0, 0.0, 0.0], 0.5e-3)],
            "node 1 has no room: this gap and that of contact 0, on the other side, sum up to -5.000e-4 m",
        ),
        (vec![wall(&[1], [0.0; 3], 0.0)], "the normal of node 1 has no direction"),
        (vec![surface], "node 1 is not on the surface of the mesh"),
        (
            vec![nearest(set("A"), ContactNodes::Numbers(vec![5]), Some(1e-5))],
            "node 2 has no partner: node 5 is the nearest along the normal, 1.000e-3 m beside it; expected at most \
                1.000e-5 m: nodes face each other within \
             `pair_tolerance_m`",
        ),
        (vec![nearest(set("A"), set("C"), None)], "there is no node set `C`; expected one of `A`, `B`"),
        (
            vec![nearest(ContactNodes::Numbers(vec![1]), ContactNodes::Numbers(vec![1]), None)],
            "node 1 has nothing to touch but itself",
        ),
        (
            vec![ContactChoice {
                normal: Some(NormalChoice::Vector([-1.0, 0.0, 0.0])),
                ..nearest(set("A"), set("B"), None)
            }],
            "node 5 lies 3.000e-3 m behind node 1, which touches what its normal [-1, 0, 0] points to: turn the normal \
                round, or take a node ahead",
        ),
        (
            // A clearance as large as the distance in the mesh does not make up for the wrong side.
            vec![ContactChoice {
                normal: Some(NormalChoice::Vector([-1.0, 0.0, 0.0])),
                gap: Some(GapChoice::Same(3e-3)),
                ..nearest(set("A"), set("B"), None)
            }],
            "node 5 lies 3.000e-3 m behind node 1",
        ),
        (
            vec![ContactChoice {
                normal: Some(NormalChoice::Vector([-1.0, 0.0, 0.0])),
                gap: None,
                ..nearest(set("A"), set("B"), None)
            }],
            "node 5 lies 3.000e-3 m behind node 1",
        ),
        (vec![table("plain.csv")], "or `normal` beside `pairs` for all such lines"),
        (
            vec![ContactChoice { normal: Some(NormalChoice::Vector(x)), ..table("plain.csv") }],
            "node 2 has no gap: its line in the table of pairs says none; expected it there, as \
                node_a,node_b,nx,ny,nz,gap_m, or `gap_m` beside `pairs`",
        ),
        (vec![table("bad.csv")], "bad.csv:2: found `2,6,1`; expected node_a,node_b or node_a,node_b,nx,ny,nz,gap_m"),
    ];
    for (choices, says) in cases {
        let error = find_contacts(&model, &files, &choices).unwrap_err();
        assert_eq!(error.contact, choices.len() - 1);
        assert!(error.to_string().contains(says), "{error}\n{says}");
    }
}

#[test]
fn normals_of_the_surface_are_those_of_the_faces() {
    let files = bracket::files();
    let model = FeModel::read(&files).unwrap();
    let mesh = model.mesh.as_ref().unwrap();
    let choice = ContactChoice {
        nodes: set("PAD"),
        normal: Some(NormalChoice::Surface),
        gap: Some(GapChoice::WallPoint([5e-3, 0.0, 0.0])),
        ..wall(&[], [1.0, 0.0, 0.0], 0.0)
    };
    let contacts = find_contacts(&model, &files, &[choice]).unwrap();
    let mut inside = 0;
    for contact in &contacts {
        let [_, y, z] = mesh.place_of(contact.node).unwrap();
        // Away from its edges, the pad is the plane x = 4 mm.
        if y > 1e-3 && y < 19e-3 && z > 5e-3 && z < 39e-3 {
            inside += 1;
            let close = |a: f64, b: f64| (a - b).abs() < 1e-9;
            assert!(close(contact.normal[0], 1.0) && close(contact.gap, 1e-3), "{contact:?}");
        }
    }
    assert!(inside > 10, "{inside} of {}", contacts.len());
}
