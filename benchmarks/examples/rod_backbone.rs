//! What the backbone of the rod by conventional harmonic balance costs as a library: processor time of whole
//! computations, and of a further point.
//!
//! The equations are those of `peers/rod_backbone.py`: 100 elements, the mass of the tip kept, a spring of 1e11 N/m in
//! the place of the rigid stop, 256 samples a period, to 15 grazing energies. Writes a Markdown table:
//! `cargo run --release -p nlmodes-benchmarks --example rod_backbone`.
//!
//! A computation has all between the numbers of the rod and the points that are shown: assembly, linear and held modes,
//! start, steps, events, modal points.

use std::ops::ControlFlow;

use nlmodes::branches::{BranchSettings, compute_branch};
use nlmodes_benchmarks::kernels::backbone_of_the_rod;
use nlmodes_benchmarks::{Failure, rod_before_a_spring, smallest_time};

/// Points of a branch that is all start.
const FIRST: usize = 3;

fn main() -> Result<(), Failure> {
    println!("| harmonics | points | evaluations a point | computation, ms | a further point, ms |");
    println!("| ---: | ---: | ---: | ---: | ---: |");
    for harmonics in 1..=3 {
        let settings = backbone_of_the_rod(harmonics);
        let (points, evaluations) = computed(&settings)?;
        let whole = smallest_time(5, || computed(&settings).is_ok());
        let first = BranchSettings { max_points: FIRST, ..settings };
        let start = smallest_time(5, || computed(&first).is_ok());
        let further = (whole - start) / (points - FIRST) as f64;
        println!(
            "| {harmonics} | {points} | {:.1} | {:.2} | {:.3} |",
            evaluations as f64 / points as f64,
            1e3 * whole,
            1e3 * further
        );
    }
    Ok(())
}

/// Points and evaluations of a branch that is computed from the numbers of the rod on.
fn computed(settings: &BranchSettings) -> Result<(usize, usize), Failure> {
    let branch = compute_branch(rod_before_a_spring(100, 1e11)?, settings, |_| ControlFlow::Continue(()))?;
    Ok((branch.branch.points.len(), branch.evaluations))
}
