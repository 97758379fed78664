//! The estimated error of points against the true one, by exact shooting, as tables.
//!
//! `cargo run --release -p nlmodes-benchmarks --example accuracy [harmonics|beam|modes]`; without an argument all.

use std::ops::ControlFlow;

use nlmodes::branches::{BranchError, BranchSettings, BranchStart, StabilityRule, compute_branch};
use nlmodes::contact::solver_by_name;
use nlmodes::continuation::{Continuation, ParametricSystem};
use nlmodes::fem::MassMatrix;
use nlmodes::hbm::{CondensedStructure, PeriodicSettings, RealSeries, Symmetry, TruncationEstimator, grazing};
use nlmodes::modal::ModalPoint;
use nlmodes::model::MasslessContactModel;
use nlmodes::timestep::{ContactDynamics, GalerkinReduction, Shooting, ShootingScales};
use nlmodes_benchmarks::{Failure, beam, rod};

/// Harmonics of the solution from which the exact motion is sought.
const FINE: usize = 60;

fn main() -> Result<(), Failure> {
    let wanted = std::env::args().nth(1);
    let has = |name: &str| wanted.as_ref().is_none_or(|w| w == name);
    if has("harmonics") {
        header("N_h");
        let numbers = [2, 3, 4, 6, 8, 10, 14, 20, 28];
        for elements in [2, 10, 100] {
            let (name, model) = (format!("rod, {elements} elements"), rod(elements, MassMatrix::Consistent)?);
            for ratio in [1.5, 3.0, 8.0] {
                row_each(&name, &model, ratio, &numbers, &[])?;
            }
        }
    }
    if has("beam") {
        header("N_h");
        // The whole beam has too many tongues for an exact motion to be near. With few modes and what they leave over
        // of the static shape it is a structure of its own, the same for both methods.
        for modes in [3, 5, 6, 8] {
            let reduced = GalerkinReduction::new(beam()?, modes)?;
            let name = format!("beam, {} modes", reduced.n_kept_modes());
            for ratio in [1.02, 1.05, 1.1, 1.2, 1.5, 2.0, 4.0] {
                rows_of_own(&name, reduced.model(), ratio, &[5, 8, 12, 20, 30, 40])?;
            }
        }
    }
    if has("modes") {
        header("held modes");
        for ratio in [1.5, 3.0, 8.0] {
            row_each("rod, 100 elements", &rod(100, MassMatrix::Consistent)?, ratio, &[], &[6, 8, 12, 16, 24, 32, 48])?;
        }
    }
    Ok(())
}

fn header(number: &str) {
    println!(
        "\n| structure | energy | `{number}` | true error | estimate | estimate over error | without reach |\n| ---{}",
        " | ---:".repeat(6) + " |"
    );
}

/// A solution at a fixed parameter, with its tangent.
struct Solution {
    series: RealSeries,
    x: Vec<f64>,
    p: f64,
    tangent: Vec<f64>,
}

fn settings(harmonics: usize) -> (PeriodicSettings, Symmetry) {
    (PeriodicSettings { harmonics, ..PeriodicSettings::default() }, Symmetry::Even)
}

/// Newton's method with the parameter kept.
fn settle(structure: &CondensedStructure, harmonics: usize, from: &Solution) -> Option<(Solution, ModalPoint)> {
    let start = grazing(structure, 1).ok()?;
    let solver = solver_by_name("active-set").ok()?;
    let mut problem = structure.conservative_mode(settings(harmonics), start.scales(), solver.as_ref()).ok()?;
    let x = problem.resized(&from.x, from.series);
    let mut across = vec![0.0; problem.dim() + 1];
    across[problem.dim()] = 1.0;
    let method = Continuation { max_points: 1, ..Continuation::default() };
    let branch = method.run(&mut problem, &x, from.p, &across, |_| ControlFlow::Continue(())).ok()?;
    let point = branch.points.into_iter().next()?;
    let modal = structure.modal_point(&mut problem, &point.x, point.residual).ok()?;
    Some((Solution { series: problem.series(), x: point.x, p: point.p, tangent: point.tangent }, modal))
}

/// The solutions of one energy with these harmonics, or with these held modes.
fn row_each(
    name: &str,
    model: &MasslessContactModel,
    ratio: f64,
    harmonics: &[usize],
    modes: &[usize],
) -> Result<(), Failure> {
    let start = BranchStart::Energy { ratio, upward: true };
    let wanted = BranchSettings {
        harmonics: FINE,
        start,
        max_points: 1,
        stability: StabilityRule::Never,
        ..BranchSettings::default()
    };
    let fine = match compute_branch(model.clone(), &wanted, |_| ControlFlow::Continue(())) {
        Ok(fine) => fine,
        Err(error @ (BranchError::NoStartAtEnergy { .. } | BranchError::NoStart { .. })) => {
            println!("| {name} | {ratio} | {FINE} | {error} | | | |");
            return Ok(());
        }
        Err(error) => return Err(error.into()),
    };
    let series = RealSeries { symmetry: Symmetry::Even, n_harmonics: FINE };
    let mut from = Solution { series, x: fine.unknowns[0].clone(), p: ratio.ln(), tangent: Vec::new() };
    for &n in harmonics.iter().rev() {
        match settle(&fine.structure, n, &from) {
            Some((own, point)) => {
                tell(name, ratio, n, model, &fine.structure, &own, &point)?;
                from = own;
            }
            None => println!("| {name} | {ratio} | {n} | no solution near | | | |"),
        }
    }
    for &m in modes {
        let structure = CondensedStructure::new(model.clone(), m)?;
        if let Some((own, point)) = settle(&structure, (m / 2).min(FINE), &from) {
            tell(name, ratio, m, model, &structure, &own, &point)?;
        }
    }
    Ok(())
}

/// The solutions of one energy with these harmonics, each on its own branch: where tongues are dense, these are not
/// near each other.
fn rows_of_own(name: &str, model: &MasslessContactModel, ratio: f64, harmonics: &[usize]) -> Result<(), Failure> {
    for &n in harmonics {
        let wanted = BranchSettings {
            harmonics: n,
            start: BranchStart::Energy { ratio, upward: true },
            max_points: 1,
            stability: StabilityRule::Never,
            ..BranchSettings::default()
        };
        let found = match compute_branch(model.clone(), &wanted, |_| ControlFlow::Continue(())) {
            Ok(found) => found,
            Err(BranchError::NoStartAtEnergy { .. } | BranchError::NoStart { .. }) => {
                println!("| {name} | {ratio} | {n} | no solution of this energy | | | |");
                continue;
            }
            Err(error) => return Err(error.into()),
        };
        let series = RealSeries { symmetry: Symmetry::Even, n_harmonics: n };
        let from = Solution { series, x: found.unknowns[0].clone(), p: ratio.ln(), tangent: Vec::new() };
        if let Some((own, point)) = settle(&found.structure, n, &from) {
            tell(name, ratio, n, model, &found.structure, &own, &point)?;
        }
    }
    Ok(())
}

/// A row: the error against the exact motion of the same energy to which shooting leads from the solution, and its
/// estimate.
fn tell(
    name: &str,
    ratio: f64,
    number: usize,
    model: &MasslessContactModel,
    structure: &CondensedStructure,
    own: &Solution,
    point: &ModalPoint,
) -> Result<(), Failure> {
    let dynamics = ContactDynamics::new(model.clone())?;
    let state = dynamics.state_of_harmonics(&point.coefficients, point.omega, 0.0)?;
    let scales = ShootingScales { omega: point.omega, energy: point.kinetic_energy };
    let mut shooting = Shooting::new(dynamics, scales)?;
    let guess = shooting.unknowns(&state, point.omega);
    let Ok(exact) = shooting.motion_near(&guess, 0.0) else {
        println!("| {name} | {ratio} | {number} | no exact motion near | | | |");
        return Ok(());
    };
    let solver = solver_by_name("active-set")?;
    let start = grazing(structure, 1)?;
    let wanted = settings(own.series.n_harmonics);
    // Without the reach to the highest mode, and with it.
    let mut near = TruncationEstimator::reaching(structure, wanted, 0, start.scales(), solver.as_ref())?;
    let near = near.estimate(&own.x, own.p, &own.tangent).frequency;
    let mut estimator = TruncationEstimator::new(structure, wanted, start.scales(), solver.as_ref())?;
    let found = estimator.estimate(&own.x, own.p, &own.tangent).frequency;
    let error = (point.omega / exact.omega - 1.0).abs();
    println!(
        "| {name} | {ratio} | {number} | {error:.1e} | {found:.1e} | {:.2} | {:.2} |",
        found / error,
        near / error
    );
    Ok(())
}
