//! Every backend against the suite, with the cases that it declines.

use nlmodes_contact::{ActiveSet, Clarabel, ClosedForm, LcpSolver, Lemke, Proximal, conformance};

fn check(solver: &dyn LcpSolver, at_most: usize, declines: &[&str]) {
    match conformance::check(solver, at_most, declines) {
        Ok(summary) => println!("{}: {summary:?}", solver.name()),
        Err(failures) => panic!("{}: {failures:#?}", solver.name()),
    }
}

#[test]
fn active_set_solves_everything() {
    check(&ActiveSet::default(), 1000, &[]);
}

#[test]
fn active_set_without_newton_solves_everything() {
    check(&ActiveSet { patience: 0, ..ActiveSet::default() }, 200, &[]);
}

#[test]
fn active_set_without_sweeps_solves_everything() {
    check(&ActiveSet { sweeps: 0, ..ActiveSet::default() }, 200, &[]);
}

#[test]
fn lemke_solves_everything() {
    check(&Lemke::default(), 200, &[]);
}

#[test]
fn clarabel_solves_everything() {
    check(&Clarabel::default(), 50, &[]);
}

#[test]
fn proximal_solves_everything() {
    check(&Proximal::default(), 1000, &[]);
}

#[test]
fn closed_form_solves_one_contact() {
    check(&ClosedForm, 1, &[]);
}

/// Without the exact solution of the closed set these do not reach 1e-10, and report it.
#[test]
fn bare_proximal_declines_ill_conditioned_matrices() {
    let declines = ["condition 1e9, 2", "condition 1e12, 2", "condition 1e9, 10", "condition 1e12, 10", "hilbert, 8"];
    check(&Proximal { polished: false, max_iterations: 3000, ..Proximal::default() }, 10, &declines);
}

#[test]
fn bare_fixed_point_declines_more_of_them() {
    let declines = [
        "condition 1e6, 2",
        "condition 1e9, 2",
        "condition 1e12, 2",
        "condition 1e6, 10",
        "condition 1e9, 10",
        "condition 1e12, 10",
        "hilbert, 4",
        "hilbert, 8",
    ];
    let plain = Proximal { polished: false, accelerated: false, max_iterations: 3000, ..Proximal::default() };
    check(&plain, 10, &declines);
}

/// The error of an interior point is about the square root of its tolerance where gap and force both vanish.
#[test]
fn bare_clarabel_declines_degenerate_contacts() {
    let declines = [
        "two, b at 1e-12 of grazing",
        "two, b at 1e-12 above grazing",
        "two, both at grazing",
        "table on four legs, one short",
        "one rigid among others, closed",
        "row of stops, 2",
        "units far apart, 2",
        "row of stops, 10",
        "units far apart, 10",
        "condition 1e3, 2",
        "condition 1e9, 2",
        "condition 1e12, 2",
        "random, 2, seed 1",
        "condition 1e0, 10",
        "condition 1e3, 10",
        "condition 1e6, 10",
        "condition 1e9, 10",
        "condition 1e12, 10",
        "low rank, 10",
        "random, 10, seed 0",
        "random, 10, seed 1",
        "random, 10, seed 2",
        "random, 10, seed 3",
    ];
    check(&Clarabel { polished: false, ..Clarabel::default() }, 10, &declines);
}
