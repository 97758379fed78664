//! What the modes that a reduced structure leaves out change, beside what harmonics leave out.

use std::f64::consts::TAU;

use nlmodes::hbm::{CondensedStructure, Switching};
use nlmodes::model::{Drop, MasslessContactModel};
use nlmodes::timestep::{ContactDynamics, Shooting, ShootingScales, Verification};
use nlmodes_benchmarks::Failure;
use nlmodes_benchmarks::free_modes::FreeModes;

use crate::cases::{Case, Whole};
use crate::methods::{Method, Setting, errors};
use crate::newton::{FOUND, search};
use crate::reference::{Reference, stretches};
use crate::tables::figure;

/// Relative change of the frequency from which on more modes lead to another motion.
const ANOTHER: f64 = 0.1;

/// Unknowns with all modes: beyond, a search takes minutes.
const MOST_UNKNOWNS: usize = 200;

/// Prints how far the whole structure and those with more modes are from the exact motion of the reduced one.
pub fn print(case: &Case, reference: &Reference) -> Result<(), Failure> {
    let Some(whole) = &case.whole else { return Ok(()) };
    let mut dynamics = ContactDynamics::new(whole.model.clone())?;
    let displacement = whole.reduction.expand(&reference.displacements[0]);
    let state = dynamics.state(&displacement, &vec![0.0; displacement.len()])?;
    let missing = Verification::new(&mut dynamics, &state, TAU / reference.omega)?;
    println!(
        "\nThe whole structure, all modes, started from there, misses after a period {:.1e} in the energy norm, \
         {:.1e} of the largest displacement, \
         {:.1e} of the largest velocity",
        missing.energy_norm, missing.displacement, missing.velocity
    );
    println!(
        "\n| exact motion, modes | frequency at the same energy, relative change | stretches of contact |\n| ---: | \
         ---: | ---: |"
    );
    let all = whole.reduction.n_modes_of_the_whole();
    for modes in [2, 3, 4, 5, 6, 8, 10, 15, 20, all].into_iter().filter(|m| *m > whole.reduction.n_modes() && *m <= all)
    {
        match with_modes(whole, reference, &displacement, modes)? {
            Some((change, stretches)) => println!("| {modes} | {change:.1e} | {stretches} |"),
            None => println!("| {modes} | none beside it | |"),
        }
    }
    harmonics_with_all_modes(whole, reference)
}

/// The exact motion of more modes with the same energy: change of the frequency, and stretches of contact.
fn with_modes(
    whole: &Whole,
    reference: &Reference,
    displacement: &[f64],
    modes: usize,
) -> Result<Option<(f64, usize)>, Failure> {
    let reduction = FreeModes::new(&whole.model, modes)?;
    let dynamics = ContactDynamics::new(MasslessContactModel::new(&reduction.model, &Drop)?)?;
    let start = reduction.project(&whole.model, displacement);
    let state = dynamics.state(&start, &vec![0.0; start.len()])?;
    let (energy, omega) = reference.grazing;
    let mut shooting = Shooting::new(dynamics, ShootingScales { omega, energy })?;
    let mut guess = shooting.unknowns(&state, reference.omega);
    guess.push(reference.parameter());
    let n = guess.len() - 1;
    let found = search(&mut shooting, &guess, n);
    let change = shooting.omega(&found.z[..n]) / reference.omega - 1.0;
    if found.residual > FOUND || change.abs() > ANOTHER {
        return Ok(None);
    }
    let motion = shooting.motion(&found.z[..n])?;
    Ok(Some((change, stretches(&motion.trajectory.closed_intervals(), TAU / motion.omega))))
}

/// MS-HBM of the whole structure against the exact motion of the reduced one.
fn harmonics_with_all_modes(whole: &Whole, reference: &Reference) -> Result<(), Failure> {
    let structure = CondensedStructure::new(whole.model.clone(), usize::MAX)?;
    let expanded = reference.of_the_whole(whole);
    println!(
        "\n| `N_h`, all modes | displacement, from the exact motion in fewer | frequency |\n| ---: | ---: | ---: |"
    );
    let most = MOST_UNKNOWNS / structure.n_contact_dofs();
    for harmonics in [3, 5, 10, 20, 40, 80].into_iter().filter(|h| *h <= most) {
        let setting = Setting { method: Method::Exact, harmonics, switching: Switching::Exact, solver: "active-set" };
        let start = expanded.unknowns(&structure, harmonics)?;
        let (m, _) = errors(&structure, &expanded, &setting, &[start])?;
        println!("| {harmonics} | {} | {} |", figure(m.displacement), figure(m.frequency));
    }
    Ok(())
}
