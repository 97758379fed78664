//! Eqs. (6) to (16) in the unknowns of the paper's held structure against the same structure in its open modes.

use crate::support;

use nlmodes_continuation::{Linearization, ParametricSystem};
use nlmodes_hbm::{CondensedStructure, Coordinates, ModalStructure, PeriodicSystem, Switching, Symmetry};
use nlmodes_model::Side;
use support::modal::{settings, solver};
use support::{condense, condense_tips, follow, on_springs, problem, rod};

/// In the order of their nodes: a stop at the tip, stops at two places, stops that face each other, and a soft one
/// whose tip is massless while the structure keeps its mass.
fn structures() -> Vec<CondensedStructure> {
    let with = |stops: &[(usize, Side, f64)]| rod(9, 1.0, 1.0, 1.0, stops);
    let tip = with(&[(9, Side::Positive, 1.0)]);
    vec![
        condense(&tip),
        condense(&with(&[(4, Side::Negative, 0.7), (9, Side::Positive, 1.0)])),
        condense(&with(&[(9, Side::Positive, 1.0), (9, Side::Negative, 1.2)])),
        condense_tips(&on_springs(&tip, &[20.0]), None),
    ]
}

/// Unknowns of the held structure as those in open modes and back: gaps are seen from their first contact.
fn turned(structure: &CondensedStructure, width: usize, z: &[f64]) -> Vec<f64> {
    let (w, mut turned) = (structure.model().w(), z.to_vec());
    for (d, coordinate) in turned.chunks_mut(width).take(w.nrows()).enumerate() {
        let side = w.row(d).iter().find(|w| **w != 0.0).unwrap();
        coordinate.iter_mut().for_each(|b| *b *= side);
    }
    turned
}

fn relative(found: f64, expected: f64) -> f64 {
    (found - expected).abs() / expected.abs().max(f64::MIN_POSITIVE)
}

/// Frequencies, energies, gaps and forces along a branch. Forces are as exact as gaps: measured by what presses a
/// contact in by its amplitude.
#[test]
fn held_and_open_modes_have_the_same_motions() {
    for (number, structure) in structures().iter().enumerate() {
        let modal = ModalStructure::of_massless(structure.model()).unwrap();
        for harmonics in [3, 5, 60] {
            let (mut held, start) = problem(structure, 1, harmonics, Symmetry::Even, Switching::Exact);
            let branch = follow(&mut held, &start, 1.6);
            let settings = settings(harmonics, Coordinates::Contact);
            let mut open =
                PeriodicSystem::conservative_mode(&modal, Symmetry::Even, settings, start.scales(), solver().as_ref())
                    .unwrap();
            let width = held.series().width();
            let turn = |z: &[f64]| turned(structure, width, z);
            let (mut touching, mut at) = (0, Linearization::new(held.dim()));
            for point in branch.points.iter().step_by(branch.points.len().div_ceil(6)).chain(branch.points.last()) {
                let what = format!("structure {number}, {harmonics} harmonics, energy {}", point.p.exp());
                let refined = open.refine(&turn(&point.x), point.p, &turn(&point.tangent));
                let x = turn(&refined.x);
                // The corrector of the branch leaves this.
                let moved = x.iter().zip(&point.x).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                assert!(refined.residual < 1e-11 && moved < 1e-8, "{what}: {:e} {moved:e}", refined.residual);
                held.linearize(&x, refined.p, &mut at).unwrap();
                assert!(at.residual_norm() < 1e-10, "{what}: {:e}", at.residual_norm());
                let expected = held.modal_point(&x, 0.0).unwrap();
                let motion = open.motion(&refined.x, refined.p).unwrap();
                let largest = expected.peak_contact_force;
                let mut pairs = vec![
                    (motion.at.omega, expected.omega),
                    (motion.kinetic_energy, expected.kinetic_energy),
                    (motion.total_energy, expected.total_energy),
                    (motion.modal_amplitude(), expected.modal_amplitude),
                ];
                for (i, (found, expected)) in motion.contacts.iter().zip(&expected.contacts).enumerate() {
                    let unit = start.length / modal.compliance().a()[(i, i)];
                    pairs.push((unit + found.peak_force, unit + expected.peak_force));
                    pairs.push((unit + found.mean_force, unit + expected.mean_force));
                }
                for (k, (found, expected)) in pairs.into_iter().enumerate() {
                    let error = relative(found, expected);
                    assert!(error < 1e-10, "{what}: number {k} is off by {error:e}");
                }
                touching += usize::from(largest > 0.0);
            }
            assert!(touching > 3, "structure {number}, {harmonics} harmonics: contact in {touching} points");
        }
    }
}
