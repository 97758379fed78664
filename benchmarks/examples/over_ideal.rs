//! What following a branch takes beside what its points alone would: three evaluations of residual and Jacobian, with
//! the solution of the bordered system, for each of them.
//!
//! ```text
//! ratio = processor time of the computation / (points · 3 · (residual + Jacobian + factors + Newton step))
//! ```
//!
//! Writes a Markdown table: `cargo run --release -p nlmodes-benchmarks --example over_ideal [PART OF A NAME]`.
//!
//! The computation has all between model and branch: linear and held modes, start, steps, events, and the modal points
//! that are shown. The evaluation is timed at points of the branch itself, at eleven of them that are evenly apart,
//! each at its own motion and with contacts warm; their mean counts. Both are processor times of this one thread, the
//! least of some runs.

use std::ops::ControlFlow;

use nlmodes::branches::{BranchSettings, ComputedBranch, compute_branch};
use nlmodes::continuation::{DenseSolver, LinearSolver, Linearization, ParametricSystem};
use nlmodes::fem::{Beam, Direction, MassMatrix, Material, Mesh, Section, Stop, Support};
use nlmodes::hbm::Symmetry;
use nlmodes::model::{Drop, MasslessContactModel, Side};
use nlmodes_benchmarks::kernels::{backbone_of_the_beam, loop_of_the_rod};
use nlmodes_benchmarks::{Failure, beam, beam_with_ten_stops, rod, smallest_time, thread_time};

/// Evaluations with which a point of a branch would be had at best: prediction, and two Newton steps.
const IDEAL: f64 = 3.0;

/// Points of a branch at which evaluations are timed.
const TIMED: usize = 11;

/// Time up to which a computation is repeated, s, and how often.
const REPEATED: (f64, usize) = (1.0, 5);

type Scene = (&'static str, fn() -> Result<MasslessContactModel, Failure>, BranchSettings);

fn scenes() -> [Scene; 6] {
    let rod_100 = || rod(100, MassMatrix::Consistent);
    let ten_stops = || Ok(MasslessContactModel::new(&beam_with_ten_stops()?, &Drop)?);
    let stops = BranchSettings { harmonics: 3, max_energy_ratio: Some(3.0), ..BranchSettings::default() };
    let to_6 = BranchSettings { frequency_hz: Some([39.0, 55.0]), ..backbone_of_the_beam() };
    [
        ("rod.toml", rod_100, loop_of_the_rod()),
        ("beam.toml", beam, to_6),
        ("beam_ten_stops.toml", ten_stops, stops.clone()),
        ("20 stops on 200 elements, 3 harmonics", || row_of_stops(20, 200), stops),
        ("rod, 64 harmonics", rod_100, BranchSettings { harmonics: 64, ..loop_of_the_rod() }),
        ("rod.toml, not even in time", rod_100, BranchSettings { symmetry: Symmetry::None, ..loop_of_the_rod() }),
    ]
}

fn main() -> Result<(), Failure> {
    let wanted = std::env::args().nth(1).unwrap_or_default();
    println!(
        "| scene | points | evaluations a point | computation, ms | one evaluation, ms | computation over ideal |"
    );
    println!("| --- | ---: | ---: | ---: | ---: | ---: |");
    for (name, model, settings) in scenes().into_iter().filter(|(name, ..)| name.contains(&wanted)) {
        println!("{}", row(name, model, &settings)?);
    }
    Ok(())
}

fn row(
    name: &str,
    model: fn() -> Result<MasslessContactModel, Failure>,
    settings: &BranchSettings,
) -> Result<String, Failure> {
    let timed = || -> Result<(f64, ComputedBranch), Failure> {
        // A model and its clones keep their modes, which are to be computed too.
        let fresh = model()?;
        let before = thread_time();
        let branch = compute_branch(fresh, settings, |_| ControlFlow::Continue(()))?;
        Ok((thread_time().saturating_sub(before).as_secs_f64(), branch))
    };
    let (mut computation, branch) = timed()?;
    let repeats = if computation < REPEATED.0 { REPEATED.1 } else { 1 };
    for _ in 1..repeats {
        computation = computation.min(timed()?.0);
    }
    let points = branch.unknowns.len();
    let evaluation = mean_evaluation(&branch)?;
    Ok(format!(
        "| {name} | {points} | {:.1} | {:.1} | {:.4} | {:.1} |",
        branch.evaluations as f64 / points as f64,
        1e3 * computation,
        1e3 * evaluation,
        computation / (points as f64 * IDEAL * evaluation)
    ))
}

/// Processor time of residual, Jacobian, factors and Newton step, s, in the mean over some points of a branch.
fn mean_evaluation(branch: &ComputedBranch) -> Result<f64, Failure> {
    let last = branch.unknowns.len() - 1;
    let chosen = (0..TIMED).map(|k| k * last / (TIMED - 1));
    let times: Result<Vec<f64>, Failure> = chosen.map(|point| evaluation(branch, point)).collect();
    Ok(times?.iter().sum::<f64>() / TIMED as f64)
}

fn evaluation(branch: &ComputedBranch, point: usize) -> Result<f64, Failure> {
    let (mut problem, x) = (branch.problem(point)?, &branch.unknowns[point]);
    let p = (branch.branch.points[point].kinetic_energy / branch.grazing.energy).ln();
    let mut out = Linearization::new(problem.dim());
    let (mut solver, mut step) = (DenseSolver::default(), vec![0.0; problem.dim() + 1]);
    // The row of a surface across the branch.
    let row = vec![1.0; problem.dim() + 1];
    let mut evaluate = || -> Result<(), Failure> {
        problem.linearize(std::hint::black_box(x), p, &mut out)?;
        solver.factor(&out, &row)?;
        step[..x.len()].copy_from_slice(&out.residual);
        solver.solve_in_place(&mut step);
        Ok(())
    };
    evaluate()?;
    Ok(smallest_time(3, || evaluate().is_ok()))
}

/// A cantilever over a row of stops whose gaps follow its first mode, the tip's being touched first: that of
/// `benchmarks/times.py`.
fn row_of_stops(stops: usize, elements: usize) -> Result<MasslessContactModel, Failure> {
    const LENGTH: f64 = 0.6;
    let beam = Beam {
        material: Material::new(210e9, 7800.0)?.with_poissons_ratio(0.3)?,
        section: Section::rectangle(0.012, 0.020)?.with_shear_factor(5.0 / 6.0)?,
        mesh: Mesh::uniform(LENGTH, elements)?,
        mass_matrix: MassMatrix::Consistent,
        start: Support::Clamped,
        end: Support::Free,
    };
    let stop = |k: usize| {
        let x = k as f64 / stops as f64;
        let gap = 1e-3 * deflection(x) / deflection(1.0) * (1.0 + 0.2 * (1.0 - x));
        // As many digits as the scene has.
        let gap = format!("{gap:.5e}").parse().unwrap_or(gap);
        Stop::rigid(LENGTH * x, Direction::Transverse, Side::Positive, gap)
    };
    let stops: Vec<Stop> = (1..=stops).rev().map(stop).collect();
    Ok(MasslessContactModel::new(&beam.assemble(&stops)?, &Drop)?)
}

/// First mode of a cantilever of length one.
fn deflection(x: f64) -> f64 {
    let (a, b) = (1.875_104_068_7, 0.734_095_513_8);
    (a * x).cosh() - (a * x).cos() - b * ((a * x).sinh() - (a * x).sin())
}
