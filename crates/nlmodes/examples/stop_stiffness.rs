//! How an elastic stop runs into a rigid one as its stiffness grows, by MS-HBM and by conventional HBM on the same
//! masses.
//!
//! `cargo run --release --example stop_stiffness -- FOLDER` prints the table of
//! `benchmarks/results/stops.md` and writes its figure.

use std::error::Error;
use std::f64::consts::TAU;
use std::path::PathBuf;

use nlmodes::contact::solver_by_name;
use nlmodes::continuation::{Linearization, ParametricSystem};
use nlmodes::fem::{Direction, MassMatrix, Material, Mesh, Rod, Stop, Support};
use nlmodes::hbm::{CondensedStructure, PeriodicSettings, Symmetry, grazing};
use nlmodes::linalg::DenseLu;
use nlmodes::model::{Drop, MasslessContactModel, Side};
use nlmodes::report::ConvergenceFigure;

/// Frequency, Hz, and averaged kinetic energy over that at grazing, of the motion with amplitude 2 before the rigid
/// stop, in closed form (benchmarks/results/convergence.md).
const RIGID_HZ: f64 = 0.417_852_834_045_572_5;
const ENERGY_RATIO: f64 = 2.0 * 2.076_372_313_358_422;

/// Stiffness of the rod's last element, that of the massless tip.
const NODE_STIFFNESS: f64 = 2.0;
/// Steps a decade of the contact stiffness, each the start of the next.
const STEPS: usize = 20;
const DECADES: usize = 7;

#[derive(Clone, Copy, PartialEq)]
enum Method {
    MixedShooting,
    HarmonicBalance,
}

/// Two elements, `EA = ρA = L = g₀ = 1`, the mass of the tip dropped.
fn structure(method: Method, stiffness: f64) -> Result<CondensedStructure, Box<dyn Error>> {
    let rod = Rod {
        material: Material::new(1.0, 1.0)?,
        area: 1.0,
        mesh: Mesh::uniform(1.0, 2)?,
        mass_matrix: MassMatrix::Consistent,
        start: Support::Clamped,
        end: Support::Free,
    };
    let model = rod.assemble(&[Stop::rigid(1.0, Direction::Axial, Side::Positive, 1.0).on_spring(stiffness)])?;
    let model = match method {
        Method::MixedShooting => MasslessContactModel::new(&model, &Drop)?,
        Method::HarmonicBalance => MasslessContactModel::with_spring_tips(&model, Some(&Drop))?,
    };
    Ok(CondensedStructure::new(model, 2)?)
}

/// Newton's method at the energy of the closed form; the frequency, Hz.
fn frequency(structure: &CondensedStructure, harmonics: usize, x: &mut [f64]) -> Result<f64, Box<dyn Error>> {
    let settings = (PeriodicSettings { harmonics, ..PeriodicSettings::default() }, Symmetry::Even);
    let scales = grazing(structure, 1)?.scales();
    let mut problem = structure.conservative_mode(settings, scales, solver_by_name("active-set")?.as_ref())?;
    let n = problem.dim();
    let mut at = Linearization::new(n);
    for _ in 0..40 {
        problem.linearize(x, ENERGY_RATIO.ln(), &mut at)?;
        if at.residual_norm() < 1e-12 {
            return Ok(problem.omega(x) / TAU);
        }
        DenseLu::factor(&at.jacobian.subcols(0, n).to_owned())?.solve_in_place(&mut at.residual);
        x.iter_mut().zip(&at.residual).for_each(|(x, step)| *x -= step);
    }
    Err(format!("{harmonics} harmonics: Newton's method ends at a residual of {:e}", at.residual_norm()).into())
}

/// Relative difference of the frequency to the rigid stop in closed form, decade by decade of the contact stiffness.
fn differences(method: Method, harmonics: usize) -> Result<Vec<(f64, f64)>, Box<dyn Error>> {
    let mut x = vec![0.0; harmonics + 2];
    // Roughly the motion with amplitude 2.
    x[..3].copy_from_slice(&[-0.3, 1.65, 0.2]);
    x[harmonics + 1] = TAU * RIGID_HZ / 6.0_f64.sqrt();
    let mut found = Vec::new();
    for step in 0..=STEPS * DECADES {
        let stiffness = NODE_STIFFNESS * 10_f64.powf(step as f64 / STEPS as f64);
        let hz = frequency(&structure(method, stiffness)?, harmonics, &mut x)?;
        if step % STEPS == 0 {
            found.push((stiffness / NODE_STIFFNESS, hz / RIGID_HZ - 1.0));
        }
    }
    Ok(found)
}

fn main() -> Result<(), Box<dyn Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).ok_or("which folder?")?);
    std::fs::create_dir_all(&folder)?;
    let columns = [
        ("MS-HBM, 20 harmonics", Method::MixedShooting, 20),
        ("HBM, 5 harmonics", Method::HarmonicBalance, 5),
        ("HBM, 20 harmonics", Method::HarmonicBalance, 20),
        ("HBM, 80 harmonics", Method::HarmonicBalance, 80),
    ];
    let mut curves = Vec::new();
    for (name, method, harmonics) in columns {
        curves.push((name, differences(method, harmonics)?));
    }
    println!("k_c/K_NN | {}", curves.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(" | "));
    for k in 0..=DECADES {
        let row = curves.iter().map(|(_, curve)| format!("{:+.2e}", curve[k].1)).collect::<Vec<_>>();
        println!("1e{k} | {}", row.join(" | "));
    }
    let absolute: Vec<(&str, Vec<(f64, f64)>)> = curves
        .into_iter()
        .map(|(name, curve)| (name, curve.into_iter().map(|(x, y)| (x, y.abs())).collect()))
        .collect();
    let slope: Vec<(f64, f64)> = [10.0, 1e7].map(|x| (x, 0.02 / x)).to_vec();
    let mut figure = ConvergenceFigure::new("contact stiffness over that of the contact node", "|f/f_rigid − 1|")
        .title("An elastic stop runs into a rigid one");
    for (name, curve) in &absolute {
        figure = figure.series(name, curve);
    }
    figure.reference("slope −1", &slope).render()?.write(folder.join("stop_stiffness.svg"))?;
    Ok(())
}
