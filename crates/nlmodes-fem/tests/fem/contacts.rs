//! Stops: where they act, and where they cannot.

use nlmodes_fem::{Beam, Direction, FemError, MassMatrix, Stop, Support};
use nlmodes_model::{DofKind, Drop, MasslessContactModel, ModelError, RigidMotion, Side};

use crate::common::{cantilever, rod, square_beam, stop};

#[test]
fn stops_act_on_the_displacement_of_their_direction_at_their_node() {
    let beam = square_beam(0.1, 4, Support::Pinned, Support::Free);
    let back = Stop { side: Side::Negative, gap: -0.2, ..stop(0.5, Direction::Transverse) };
    let model = beam.assemble(&[stop(1.0, Direction::Axial), back, stop(0.5, Direction::Transverse)]).unwrap();
    // The pinned node has only its rotation.
    assert_eq!(model.dofs().len(), 13);
    let stops: Vec<_> = model.contacts().iter().map(|c| c.single_dof().unwrap()).collect();
    let at = |i: usize| model.dofs()[stops[i].dof];
    assert_eq!((at(0).kind, at(0).node, at(0).position), (DofKind::Axial, 4, 1.0));
    assert_eq!((at(1).kind, at(1).node, at(1).position), (DofKind::Deflection, 2, 0.5));
    assert_eq!(stops[1].dof, stops[2].dof);
    assert_eq!((stops[1].gap, stops[1].direction()), (-0.2, 1.0));
}

#[test]
fn stops_off_the_nodes_are_refused_with_the_nearest_one() {
    let error = rod(100, MassMatrix::Consistent).assemble(&[stop(10.07, Direction::Axial)]).unwrap_err();
    match error {
        FemError::NotANode { asked: 10.07, nearest, node: 50 } => assert!((nearest - 10.0).abs() < 1e-12),
        other => panic!("{other}"),
    }
    assert!(error.to_string().contains("10.07 m") && error.to_string().contains("node 50"), "{error}");
}

#[test]
fn stops_that_can_never_be_touched_are_refused() {
    let error = cantilever(2e11).assemble(&[stop(0.0, Direction::Transverse)]).unwrap_err();
    let (direction, support) = (Direction::Transverse, Support::Clamped);
    assert_eq!(error, FemError::HeldDof { position: 0.0, direction, support });
    let sliding = Beam { end: Support::Sliding, ..cantilever(2e11) };
    assert!(sliding.assemble(&[stop(0.62975520, Direction::Transverse)]).is_ok());
    let error = sliding.assemble(&[stop(0.62975520, Direction::Axial)]).unwrap_err();
    assert!(matches!(error, FemError::HeldDof { support: Support::Sliding, .. }));
    let error = rod(5, MassMatrix::Consistent).assemble(&[stop(20.0, Direction::Transverse)]).unwrap_err();
    assert_eq!(error, FemError::NoSuchDirection { position: 20.0, direction });
}

#[test]
fn gaps_have_to_be_finite() {
    let wide = Stop { gap: f64::INFINITY, ..stop(20.0, Direction::Axial) };
    let error = rod(5, MassMatrix::Consistent).assemble(&[wide]).unwrap_err();
    assert!(matches!(error, FemError::Model(ModelError::NotFinite { what: "gap of contact", index: 0, .. })));
}

#[test]
fn floating_structures_are_told_by_what_the_contacts_do_not_hold() {
    let (along, across) = (Direction::Axial, Direction::Transverse);
    let motion = |start, end, stops: &[Stop]| {
        let model = square_beam(1e-3, 300, start, end).assemble(stops).unwrap();
        let model = MasslessContactModel::new(&model, &Drop).unwrap();
        match model.factor_k_ll() {
            Ok(_) => None,
            Err(ModelError::HeldRigidBody { motion }) => Some(motion),
            Err(other) => panic!("{other}"),
        }
    };
    use Support::{Clamped, Free, Pinned, Sliding};
    assert_eq!(motion(Free, Free, &[stop(1.0, across)]), Some(RigidMotion::Axial));
    assert_eq!(motion(Free, Free, &[stop(1.0, along)]), Some(RigidMotion::Transverse));
    let both = [stop(0.0, along), stop(1.0, across)];
    assert_eq!(motion(Free, Free, &both), Some(RigidMotion::Rotation { about: 1.0 }));
    assert_eq!(motion(Free, Free, &[both[0], both[1], stop(0.5, across)]), None);
    match motion(Free, Pinned, &[stop(0.0, along)]) {
        Some(RigidMotion::Rotation { about }) => assert!((about - 1.0).abs() < 1e-9),
        other => panic!("{other:?}"),
    }
    assert_eq!(motion(Pinned, Free, &[stop(1.0, across)]), None);
    assert_eq!(motion(Sliding, Free, &[stop(1.0, along)]), Some(RigidMotion::Transverse));
    assert_eq!(motion(Sliding, Free, &[stop(1.0, across)]), None);
    assert_eq!(motion(Clamped, Free, &[stop(1.0, across)]), None);
}
