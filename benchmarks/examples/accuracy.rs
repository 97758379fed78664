//! The estimated error of points against the true one, by exact shooting, as tables.
//!
//! `cargo run --release -p nlmodes-benchmarks --example accuracy [harmonics|modes]`; without an argument both.

use std::ops::ControlFlow;

use nlmodes::contact::solver_by_name;
use nlmodes::continuation::{Continuation, ParametricSystem};
use nlmodes::fem::MassMatrix;
use nlmodes::hbm::{
    CondensedStructure, MixedShooting, MixedShootingSettings, RealSeries, Switching, Symmetry, TruncationEstimator,
    grazing,
};
use nlmodes::model::MasslessContactModel;
use nlmodes::study::{BranchSettings, BranchStart, compute_branch};
use nlmodes::timestep::{ContactDynamics, Shooting, ShootingScales};
use nlmodes_benchmarks::{Failure, beam, rod};

/// Harmonics of the solution from which the exact motion is sought.
const FINE: usize = 60;

fn main() -> Result<(), Failure> {
    let wanted = std::env::args().nth(1);
    let has = |name: &str| wanted.as_ref().is_none_or(|w| w == name);
    let numbers = [2, 3, 4, 5, 6, 8, 10, 14, 20, 28];
    if has("harmonics") {
        println!("| structure | energy | N_h | frequency | estimate | ratio | motion |\n|{}", " ---: |".repeat(7));
        for elements in [2, 10, 100] {
            for ratio in [1.5, 3.0, 8.0] {
                let name = format!("rod, {elements} elements");
                row_each(&name, &rod(elements, MassMatrix::Consistent)?, ratio, &numbers, None)?;
            }
        }
        for ratio in [1.5, 3.0] {
            row_each("beam", &beam()?, ratio, &numbers, None)?;
        }
    }
    if has("modes") {
        println!("\n| structure | energy | modes | frequency | estimate | ratio | motion |\n|{}", " ---: |".repeat(7));
        for ratio in [1.5, 3.0, 8.0] {
            let modes = [4, 6, 8, 12, 16, 24, 32, 48];
            row_each("rod, 100 elements", &rod(100, MassMatrix::Consistent)?, ratio, &[], Some(&modes))?;
        }
    }
    Ok(())
}

/// A solution at a fixed parameter, with its tangent.
struct Solution {
    series: RealSeries,
    x: Vec<f64>,
    p: f64,
    tangent: Vec<f64>,
    omega: f64,
}

fn settings(harmonics: usize) -> MixedShootingSettings {
    MixedShootingSettings { harmonics, symmetry: Symmetry::Even, switching: Switching::Exact }
}

/// Newton's method with the parameter kept.
fn settle(structure: &CondensedStructure, harmonics: usize, from: &Solution) -> Option<Solution> {
    let start = grazing(structure, 1).ok()?;
    let solver = solver_by_name("active-set").ok()?;
    let mut problem = MixedShooting::new(structure, settings(harmonics), start.scales(), solver.as_ref()).ok()?;
    let x = problem.resized(&from.x, from.series);
    let mut across = vec![0.0; problem.dim() + 1];
    across[problem.dim()] = 1.0;
    let method = Continuation { max_points: 1, ..Continuation::default() };
    let branch = method.run(&mut problem, &x, from.p, &across, |_| ControlFlow::Continue(())).ok()?;
    let point = branch.points.into_iter().next()?;
    let omega = problem.omega(&point.x);
    Some(Solution { series: problem.series(), x: point.x, p: point.p, tangent: point.tangent, omega })
}

fn row_each(
    name: &str,
    model: &MasslessContactModel,
    ratio: f64,
    harmonics: &[usize],
    modes: Option<&[usize]>,
) -> Result<(), Failure> {
    let start = BranchStart::Energy { ratio, upward: true };
    let wanted = BranchSettings { harmonics: FINE, start, max_points: 1, ..BranchSettings::default() };
    let fine = match compute_branch(model.clone(), &wanted, |_| ControlFlow::Continue(())) {
        Ok(fine) => fine,
        Err(error) => {
            println!("| {name} | {ratio} | {error} |");
            return Ok(());
        }
    };
    let (point, x) = (&fine.branch.points[0], &fine.unknowns[0]);
    let dynamics = ContactDynamics::new(model.clone())?;
    let state = dynamics.state_of_harmonics(&point.coefficients, point.omega, 0.0)?;
    let scales = ShootingScales { omega: point.omega, energy: point.kinetic_energy };
    let mut shooting = Shooting::new(dynamics, scales)?;
    let guess = shooting.unknowns(&state, point.omega);
    let exact = match shooting.motion_near(&guess, 0.0) {
        Ok(exact) => exact.omega,
        Err(error) => {
            println!("| {name} | {ratio} | {error} |");
            return Ok(());
        }
    };
    let series = RealSeries { symmetry: Symmetry::Even, n_harmonics: FINE };
    let p = ratio.ln();
    let mut from = Solution { series, x: x.clone(), p, tangent: Vec::new(), omega: point.omega };
    println!("| {name} | {ratio} | {FINE} | {:.1e} | | | |", (point.omega / exact - 1.0).abs());
    let tell = |structure: &CondensedStructure, number: usize, own: &Solution| -> Result<(), Failure> {
        let start = grazing(structure, 1)?;
        let solver = solver_by_name("active-set")?;
        let wanted = settings(own.series.n_harmonics);
        let mut estimator = TruncationEstimator::new(structure, wanted, start.scales(), solver.as_ref())?;
        let estimate = estimator.estimate(&own.x, own.p, &own.tangent);
        let error = (own.omega / exact - 1.0).abs();
        let (found, motion) = (estimate.frequency, estimate.motion);
        println!("| {name} | {ratio} | {number} | {error:.1e} | {found:.1e} | {:.2} | {motion:.1e} |", found / error);
        Ok(())
    };
    for &n in harmonics.iter().rev() {
        let Some(own) = settle(&fine.structure, n, &from) else {
            println!("| {name} | {ratio} | {n} | no solution near |");
            continue;
        };
        tell(&fine.structure, n, &own)?;
        from = own;
    }
    for &m in modes.into_iter().flatten() {
        let structure = CondensedStructure::new(model.clone(), m)?;
        // As many harmonics as do not disturb, within the modes that there are.
        let own = settle(&structure, FINE.min(m), &from);
        let Some(own) = own else {
            println!("| {name} | {ratio} | {m} | no solution near |");
            continue;
        };
        tell(&structure, m, &own)?;
    }
    Ok(())
}
