//! Structures of which modal points hold some degrees of freedom only.

use crate::support;

use std::f64::consts::FRAC_PI_2;
use std::ops::ControlFlow;

use nlmodes::branches::{BranchSettings, compute_branch};
use nlmodes::fem::{Direction, Stop};
use nlmodes::hbm::MAX_RECORDED;
use nlmodes::model::Side;
use support::unit_rod;

const ELEMENTS: usize = 6000;

#[test]
fn a_long_rod_is_recorded_at_some_nodes_and_its_modal_quantities_count_all() {
    // Not at the end, so that the contact is no node that would be recorded anyway.
    let at = 4999.0 / ELEMENTS as f64;
    let stop = Stop::rigid(at, Direction::Axial, Side::Positive, 0.5);
    let model = unit_rod(ELEMENTS, &[stop]);
    let settings = BranchSettings { harmonics: 3, max_points: 3, ..BranchSettings::default() };
    let computed = compute_branch(model, &settings, |_| ControlFlow::Continue(())).unwrap();
    let (branch, structure) = (&computed.branch, &computed.structure);
    assert!(branch.coordinates.len() < MAX_RECORDED && branch.coordinates.len() > MAX_RECORDED / 4);
    let contact = branch.contact_coordinate.unwrap();
    assert!((branch.coordinates[contact].position - at).abs() < 1e-12);
    assert_eq!(structure.recorded_dofs()[contact], structure.model().contacts()[0].dof);

    // At grazing the motion is the first linear mode, a quarter of a sine wave with ω = π/2, but for the mass of the
    // contact node left out.
    let first = &branch.points[0];
    // Its rows in the mass matrix sum up to 4/3 of an element's mass, which raises ω by half of that and the square of
    // the shape there.
    let shift = 4.0 / 3.0 / ELEMENTS as f64 * (FRAC_PI_2 * at).sin().powi(2);
    assert!((first.omega / FRAC_PI_2 - 1.0 - shift).abs() < 1e-6, "{} rad/s", first.omega);
    assert_eq!(first.coefficients.n_coordinates(), branch.coordinates.len());
    let amplitude = 0.5 / (FRAC_PI_2 * at).sin();
    for (d, coordinate) in branch.coordinates.iter().enumerate() {
        let expected = amplitude * (FRAC_PI_2 * coordinate.position).sin();
        assert!((first.coefficients.of(d)[1].re - expected).abs() < 1e-3 * amplitude, "at {}", coordinate.position);
    }
    // ∫ ½ ρA q̇² of that shape, averaged over the period, to the same accuracy; q̃² = ∫ ρA q².
    assert!((first.kinetic_energy / (0.125 * (first.omega * amplitude).powi(2)) - 1.0).abs() < 1e-3);
    assert!((first.modal_amplitude / (amplitude / 2.0_f64.sqrt()) - 1.0).abs() < 1e-3);

    // The linear modes are orthogonal over all degrees of freedom; over the recorded ones they are not.
    let participation = computed.participation(3).unwrap();
    assert_eq!(participation.len(), branch.points.len());
    // 68 held modes are used, 112 before their number followed their frequencies; what is left out of the others'
    // motion under a force at a point falls with the third power of 1/135, the ratio of frequencies: 4e-7.
    assert!((participation[0].factors[0] - 1.0).abs() < 4e-7, "{:?}", participation[0]);
    assert!(participation[0].factors[1..].iter().all(|v| v.abs() < 2e-7), "{:?}", participation[0]);
}
