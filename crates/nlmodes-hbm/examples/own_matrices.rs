//! Matrices of one's own: a mass on two springs, the second of which meets a stop, against the exact motion.
//!
//! ```text
//! wall ──k₁── m ──k₂── •   ‖ stop       the contact node • has no mass; open it follows the mass, closed it holds k₂
//! ```
//!
//! So the mass sees `k₁` up to the gap `g₀` and `k₁ + k₂` beyond: its period is known in closed form.
//!
//! `cargo run -p nlmodes-hbm --example own_matrices`

use std::error::Error;
use std::f64::consts::{FRAC_PI_2, PI};
use std::ops::ControlFlow;

use nlmodes_contact::solver_by_name;
use nlmodes_continuation::{Bound, Continuation, ParametricSystem};
use nlmodes_hbm::{CondensedStructure, PeriodicSettings, Symmetry, grazing};
use nlmodes_linalg::sparse_from_triplets;
use nlmodes_modal::ModalPoint;
use nlmodes_model::{Contact, Dof, DofKind, Drop, MasslessContactModel, Side, StructuralModel};

const MASS: f64 = 0.1; // kg
const STIFFNESS: [f64; 2] = [1e4, 2e4]; // N/m
const GAP: f64 = 1e-3; // m

fn structure() -> Result<CondensedStructure, Box<dyn Error>> {
    let [k1, k2] = STIFFNESS;
    let stiffness = sparse_from_triplets(2, 2, &[(0, 0, k1 + k2), (0, 1, -k2), (1, 0, -k2), (1, 1, k2)])?;
    let mass = sparse_from_triplets(2, 2, &[(0, 0, MASS)])?;
    let dof = |node| Dof { node, position: node as f64, kind: DofKind::Axial };
    let stop = Contact::rigid(1, Side::Positive, GAP);
    let model = StructuralModel::new(mass, stiffness, vec![dof(1), dof(2)], vec![stop])?;
    Ok(CondensedStructure::new(MasslessContactModel::new(&model, &Drop)?, 1)?)
}

/// The branch from grazing to ten times its energy.
fn branch(harmonics: usize) -> Result<Vec<ModalPoint>, Box<dyn Error>> {
    let structure = structure()?;
    let start = grazing(&structure, 1)?;
    let settings = (PeriodicSettings { harmonics, ..PeriodicSettings::default() }, Symmetry::Even);
    let solver = solver_by_name("active-set")?;
    let mut problem = structure.conservative_mode(settings, start.scales(), solver.as_ref())?;
    let n = problem.dim();
    let energy = Bound { coordinate: n, min: -1.0, max: 10_f64.ln() };
    let method = Continuation { bounds: vec![energy], ..Continuation::default() };
    let (x, direction) = problem.start(&start);
    let branch = method.run(&mut problem, &x, 0.0, &direction, |_| ControlFlow::Continue(()))?;
    let points = branch.points.iter().map(|point| structure.modal_point(&mut problem, &point.x, point.residual));
    Ok(points.collect::<Result<_, _>>()?)
}

/// Angular frequency of the exact motion of a total energy, rad/s.
fn exact_frequency(energy: f64) -> f64 {
    let [k1, k2] = STIFFNESS;
    let (open, closed) = ((k1 / MASS).sqrt(), ((k1 + k2) / MASS).sqrt());
    let amplitude = (2.0 * energy / k1).sqrt();
    let quarter = (FRAC_PI_2 + (GAP / amplitude).min(1.0).asin()) / open;
    // Beyond the gap: about the point of rest x_c with both springs.
    let speed = open * (amplitude * amplitude - GAP * GAP).max(0.0).sqrt();
    let depth = GAP - k2 * GAP / (k1 + k2);
    PI / (quarter + (speed / closed).atan2(depth) / closed)
}

fn main() -> Result<(), Box<dyn Error>> {
    println!("total energy, J   frequency, rad/s   error with 20 harmonics");
    for point in branch(20)? {
        let error = point.omega / exact_frequency(point.total_energy) - 1.0;
        println!("{:>15.6}   {:>16.6}   {error:>+12.2e}", point.total_energy, point.omega);
    }
    Ok(())
}

#[test]
fn the_branch_is_the_exact_one_but_for_the_harmonics_left_out() -> Result<(), Box<dyn Error>> {
    let worst = |harmonics| -> Result<f64, Box<dyn Error>> {
        let error = |point: &ModalPoint| (point.omega / exact_frequency(point.total_energy) - 1.0).abs();
        Ok(branch(harmonics)?.iter().map(error).fold(0.0, f64::max))
    };
    let (coarse, fine) = (worst(10)?, worst(40)?);
    assert!(fine < 1e-7 && coarse < 1e-4 && fine < coarse / 64.0, "{coarse:e} {fine:e}"); // third order at least
    Ok(())
}
