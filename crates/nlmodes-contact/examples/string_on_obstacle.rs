//! A string under a uniform load, above a flat obstacle: where is it in contact, and with what force?
//!
//! Tension `T`, length `L`, load `p`, obstacle `d` below the straight string. In closed form the free ends are
//! parabolas that touch the obstacle with a horizontal tangent, `ℓ = √(2 d T / p)` from the supports, and the obstacle
//! carries `p (L − 2ℓ)`.
//!
//! `cargo run -p nlmodes-contact --example string_on_obstacle`

use nlmodes_contact::{LcpError, LcpMatrix, Mat, solver_by_name};

const TENSION: f64 = 100.0; // N
const LENGTH: f64 = 2.0; // m
const LOAD: f64 = 60.0; // N/m
const DEPTH: f64 = 0.1; // m
const NODES: usize = 199;

struct Lying {
    /// First and last node that press on the obstacle, m.
    edges: [f64; 2],
    /// Sum of all contact forces, N.
    force: f64,
    violation: f64,
}

fn position(i: usize) -> f64 {
    LENGTH * (i + 1) as f64 / (NODES + 1) as f64
}

/// Deflection at `x` due to a unit force at `s`: the compliance of the string.
fn compliance(x: f64, s: f64) -> f64 {
    x.min(s) * (LENGTH - x.max(s)) / (TENSION * LENGTH)
}

fn lie_on_obstacle(solver: &str) -> Result<Lying, LcpError> {
    let a = LcpMatrix::new(&Mat::from_fn(NODES, NODES, |i, j| compliance(position(i), position(j))))?;
    // Gaps without contact forces: the obstacle's depth less the free deflection.
    let b: Vec<f64> = (0..NODES).map(position).map(|x| DEPTH - LOAD * x * (LENGTH - x) / (2.0 * TENSION)).collect();
    let (mut closed, mut lambda) = (vec![false; NODES], vec![0.0; NODES]);
    let statistics = solver_by_name(solver)?.workspace(&a)?.solve(&b, &mut closed, &mut lambda)?;
    let pressed = || (0..NODES).filter(|&i| closed[i]).map(position);
    Ok(Lying {
        edges: [pressed().fold(LENGTH, f64::min), pressed().fold(0.0, f64::max)],
        force: lambda.iter().sum(),
        violation: statistics.violation,
    })
}

fn main() -> Result<(), LcpError> {
    let free = (2.0 * DEPTH * TENSION / LOAD).sqrt();
    println!("closed form   from {free:.4} m to {:.4} m, {:.3} N", LENGTH - free, LOAD * (LENGTH - 2.0 * free));
    for solver in ["active-set", "lemke", "clarabel"] {
        let Lying { edges: [from, to], force, violation } = lie_on_obstacle(solver)?;
        println!("{solver:<12}  from {from:.4} m to {to:.4} m, {force:.3} N, violation {violation:.1e}");
    }
    Ok(())
}

#[test]
fn it_lies_where_the_closed_form_says() -> Result<(), LcpError> {
    let (free, spacing) = ((2.0 * DEPTH * TENSION / LOAD).sqrt(), LENGTH / (NODES + 1) as f64);
    for solver in ["active-set", "lemke"] {
        let lying = lie_on_obstacle(solver)?;
        assert!((lying.edges[0] - free).abs() <= spacing && (lying.edges[1] + free - LENGTH).abs() <= spacing);
        assert!((lying.force - LOAD * (LENGTH - 2.0 * free)).abs() <= LOAD * spacing);
        assert!(lying.violation < 1e-10);
    }
    Ok(())
}
