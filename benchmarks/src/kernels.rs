//! The kernels whose cost is watched, each ready to run: by criterion for time, under callgrind for instructions.

use std::hint::black_box;
use std::ops::ControlFlow;

use nlmodes::branches::{BranchSettings, ResonanceRule, StabilityRule, compute_branch};
use nlmodes::contact::{LcpMatrix, Mat, SeriesSolution, Start, solver_by_name};
use nlmodes::continuation::{Linearization, ParametricSystem};
use nlmodes::fem::MassMatrix;
use nlmodes::hbm::{CondensedStructure, PeriodicSettings, PeriodicSystem, Switching, Symmetry, grazing};
use nlmodes::linalg::{DenseLu, lowest_modes};
use nlmodes::model::MasslessContactModel;

use crate::{Failure, beam, rig, rod, rod_before_a_spring};

/// Samples of a period of contact problems.
pub const SAMPLES: usize = 1024;

/// Something to run again and again.
pub type Kernel = Box<dyn FnMut()>;

/// What makes a kernel ready.
pub type Prepare = fn() -> Result<Kernel, Failure>;

/// All kernels by name.
pub const KERNELS: [(&str, Prepare); 11] = [
    ("residual and Jacobian, rod of 100 elements, 20 harmonics", || residual(99, 20)),
    ("residual and Jacobian, beam, 5 harmonics", || residual_of(beam()?, 5)),
    ("corrector step, rod of 100 elements, 20 harmonics", || corrector_step(99, 20)),
    ("modal point, rod of 100 elements, 20 harmonics", modal_point),
    ("LCP series, 10 contacts, 1024 samples", || lcp_series(10)),
    ("LCP series, 100 contacts, 1024 samples", || lcp_series(100)),
    ("branch, rod, 3 harmonics, the whole loop", || branch(rod(100, MassMatrix::Consistent)?, loop_of_the_rod())),
    ("branch, beam, 5 harmonics, to 6 grazing energies", || branch(beam()?, backbone_of_the_beam())),
    ("branch with its modes, rod before a spring, 2 harmonics", branch_with_its_modes),
    ("linear modes, rod of 20 000 elements, 20 modes", linear_modes),
    ("virtual test, one second", virtual_test),
];

/// The loop of Fig. 3 b.
pub fn loop_of_the_rod() -> BranchSettings {
    let frequency_hz = Some([50.0, 66.5]);
    let internal_resonance = ResonanceRule::Follow; // the loop is the branch of one
    BranchSettings {
        harmonics: 3,
        max_energy_ratio: Some(20.0),
        frequency_hz,
        internal_resonance,
        ..BranchSettings::default()
    }
}

/// The backbone of the rod by conventional harmonic balance, which other programs compute too: 256 samples a period, to
/// 15 grazing energies.
pub fn backbone_of_the_rod(harmonics: usize) -> BranchSettings {
    BranchSettings {
        harmonics,
        switching: Switching::Sampled { samples: 256 },
        max_energy_ratio: Some(15.0),
        frequency_hz: Some([50.0, 90.0]),
        stability: StabilityRule::Never,
        ..BranchSettings::default()
    }
}

/// The backbone of Fig. 8.
pub fn backbone_of_the_beam() -> BranchSettings {
    BranchSettings { harmonics: 5, max_energy_ratio: Some(6.0), ..BranchSettings::default() }
}

/// A rod of `modes + 1` elements with all its held modes, at a motion with contact.
///
/// # Errors
/// None, with positive numbers.
pub fn residual(modes: usize, harmonics: usize) -> Result<Kernel, Failure> {
    residual_of(rod(modes + 1, MassMatrix::Consistent)?, harmonics)
}

fn residual_of(model: MasslessContactModel, harmonics: usize) -> Result<Kernel, Failure> {
    let (_, mut problem, x) = problem(model, harmonics)?;
    let mut out = Linearization::new(problem.dim());
    Ok(Box::new(move || problem.linearize(black_box(&x), 0.5, &mut out).unwrap_or_else(|e| panic!("{e}"))))
}

/// The reduced model, its periodic problem, and unknowns with contact.
fn problem(
    model: MasslessContactModel,
    harmonics: usize,
) -> Result<(CondensedStructure, PeriodicSystem, Vec<f64>), Failure> {
    let structure = CondensedStructure::new(model, usize::MAX)?;
    let start = grazing(&structure, 1)?;
    let settings = (PeriodicSettings { harmonics, ..PeriodicSettings::default() }, Symmetry::Even);
    let problem = structure.conservative_mode(settings, start.scales(), solver_by_name("active-set")?.as_ref())?;
    let (mut x, _) = problem.start(&start);
    // The gap of the stop opens in the mean, and closes once a period.
    x[0] += 0.2;
    x[1] -= 0.4;
    Ok((structure, problem, x))
}

/// Residual, Jacobian, factors of the bordered matrix, and the Newton step.
///
/// # Errors
/// None, with positive numbers.
pub fn corrector_step(modes: usize, harmonics: usize) -> Result<Kernel, Failure> {
    let (_, mut problem, x) = problem(rod(modes + 1, MassMatrix::Consistent)?, harmonics)?;
    let n = problem.dim();
    let mut out = Linearization::new(n);
    let (mut bordered, mut lu, mut step) = (Mat::<f64>::zeros(n + 1, n + 1), DenseLu::default(), vec![0.0; n + 1]);
    (0..=n).for_each(|j| bordered[(n, j)] = 1.0);
    Ok(Box::new(move || {
        problem.linearize(black_box(&x), 0.5, &mut out).unwrap_or_else(|e| panic!("{e}"));
        for j in 0..=n {
            bordered.col_mut(j).iter_mut().zip(out.jacobian.col(j).iter()).for_each(|(to, from)| *to = *from);
        }
        lu.refactor(&bordered).unwrap_or_else(|e| panic!("{e}"));
        step[..n].copy_from_slice(&out.residual);
        lu.solve_in_place(&mut step);
        black_box(&step);
    }))
}

fn modal_point() -> Result<Kernel, Failure> {
    let (structure, mut problem, x) = problem(rod(100, MassMatrix::Consistent)?, 20)?;
    Ok(Box::new(move || {
        black_box(structure.modal_point(&mut problem, black_box(&x), 0.0).unwrap_or_else(|e| panic!("{e}")));
    }))
}

fn branch(model: MasslessContactModel, settings: BranchSettings) -> Result<Kernel, Failure> {
    Ok(Box::new(move || {
        let found = compute_branch(model.clone(), &settings, |_| ControlFlow::Continue(()));
        black_box(found.unwrap_or_else(|e| panic!("{e}")).branch);
    }))
}

/// From the numbers of the rod on: a model and its clones keep their modes.
fn branch_with_its_modes() -> Result<Kernel, Failure> {
    let settings = backbone_of_the_rod(2);
    Ok(Box::new(move || {
        let model = rod_before_a_spring(100, 1e11).unwrap_or_else(|e| panic!("{e}"));
        let found = compute_branch(model, &settings, |_| ControlFlow::Continue(()));
        black_box(found.unwrap_or_else(|e| panic!("{e}")).branch);
    }))
}

fn linear_modes() -> Result<Kernel, Failure> {
    let model = rod(20_000, MassMatrix::Consistent)?;
    Ok(Box::new(move || {
        black_box(lowest_modes(model.stiffness(), model.mass(), 20).unwrap_or_else(|e| panic!("{e}")));
    }))
}

fn virtual_test() -> Result<Kernel, Failure> {
    let mut session = rig()?;
    Ok(Box::new(move || session.run(1.0).unwrap_or_else(|e| panic!("{e}"))))
}

/// Compliance of a string on springs, m/N.
///
/// # Panics
/// Never: the exponential kernel is positive definite.
pub fn compliance(c: usize) -> LcpMatrix {
    let reach = (c as f64 / 20.0).max(2.0);
    let entry = |i: usize, j: usize| 1e-6 * ((-(i.abs_diff(j) as f64) / reach).exp() + if i == j { 0.05 } else { 0.0 });
    LcpMatrix::new(&Mat::from_fn(c, c, entry)).expect("the exponential kernel is positive definite")
}

/// Gaps of a period of two standing waves and one that travels, before contact: up to half of the contacts are closed.
pub fn string_motion(c: usize, amplitude: f64) -> Vec<f64> {
    let gap = |k: usize, i: usize| {
        let (t, x) = (std::f64::consts::TAU * k as f64 / SAMPLES as f64, (i as f64 + 0.5) / c as f64);
        let standing = t.cos() * (std::f64::consts::PI * x).sin() + 0.3 * (2.0 * t).cos() * (7.0 * x).sin();
        1e-3 * (0.4 - amplitude * (standing + 0.1 * (t - 9.0 * x).cos()))
    };
    (0..SAMPLES).flat_map(|k| (0..c).map(move |i| gap(k, i))).collect()
}

/// A series whose amplitude changes a little from one run to the next, as between iterates.
fn lcp_series(c: usize) -> Result<Kernel, Failure> {
    let solver = solver_by_name("active-set")?;
    let matrix: &'static LcpMatrix = Box::leak(Box::new(compliance(c)));
    let mut series = nlmodes::contact::Series::new(matrix, solver.as_ref())?;
    let motions = [1.0, 1.001, 1.002, 1.001].map(|amplitude| string_motion(c, amplitude));
    let (mut solution, mut turn) = (SeriesSolution::default(), 0);
    Ok(Box::new(move || {
        let b = &motions[turn % motions.len()];
        turn += 1;
        series.solve(b, Start::SameSample, &mut solution).unwrap_or_else(|e| panic!("{e}"));
    }))
}
