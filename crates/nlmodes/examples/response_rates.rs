//! Errors of forced responses over the number of harmonics, with exact switching, against exact shooting.
//!
//!     cargo run --release -p nlmodes --example response_rates

use std::error::Error;
use std::f64::consts::TAU;
use std::ops::ControlFlow;

use nlmodes::model::reduction::{ModeCount, OpenModes};
use nlmodes_contact::solver_by_name;
use nlmodes_continuation::{Bound, Continuation, ParametricSystem};
use nlmodes_fem::{Beam, Direction, MassMatrix, Material, Mesh, Rod, Section, Stop, Support};
use nlmodes_hbm::{Load, LoadTerm, ModalDamping, ModalStructure, PeriodicSettings, PeriodicSystem, Refined, Scales};
use nlmodes_linalg::Mat;
use nlmodes_model::{DofKind, Drop, MasslessContactModel, Side};
use nlmodes_timestep::ForcedStructure;
use num_complex::Complex64;

type Result<T> = std::result::Result<T, Box<dyn Error>>;

/// Harmonics from which the first solution comes, those from which exact shooting starts, and those from which errors
/// are taken, up to twice as many.
const FIRST: usize = 5;
const START: usize = 160;
const FROM: [usize; 3] = [5, 20, 80];

/// Largest residual of a solution, and how often Newton's method is restarted.
const SOLVED: f64 = 1e-8;
const ROUNDS: usize = 4;

/// A response at one level and frequency.
struct Case {
    name: &'static str,
    structure: ModalStructure,
    load: Load,
    omega: f64,
    length: f64,
}

/// Fundamental of the contact (m), share of the period in which it is closed, largest force (N).
type Quantities = [f64; 3];

fn main() -> Result<()> {
    println!(
        "| structure | harmonics from | fundamental | share of contact | largest force |\n| --- | --- | --- | --- | \
            --- |"
    );
    for case in [rod(2, 0.2, 0.42)?, rod(10, 0.2, 0.28)?, beam(8.0, 42.0)?] {
        let (solutions, state) = solutions(&case)?;
        let exact = shooting(&case, &state)?;
        let worst = |from: usize| -> Quantities {
            let within = solutions.iter().filter(|(n, _)| (from..2 * from).contains(n));
            let error = |(_, q): &(usize, Quantities)| [0, 1, 2].map(|k| (q[k] / exact[k] - 1.0).abs());
            within.map(error).fold([0.0; 3], |worst, e| [0, 1, 2].map(|k| e[k].max(worst[k])))
        };
        let errors = FROM.map(worst);
        for (from, e) in FROM.iter().zip(&errors) {
            println!("| {} | {from} | {:.1e} | {:.1e} | {:.1e} |", case.name, e[0], e[1], e[2]);
        }
        let order = [0, 1, 2].map(|k| (errors[1][k] / errors[2][k]).ln() / 4.0_f64.ln());
        println!("| {} | order | {:.1} | {:.1} | {:.1} |", case.name, order[0], order[1], order[2]);
        println!("| {} | exact | {:.11e} | {:.11} | {:.9e} |", case.name, exact[0], exact[1], exact[2]);
    }
    Ok(())
}

/// Numbers of harmonics with what they give, and the state of the last at the beginning of its period.
type Solutions = (Vec<(usize, Quantities)>, Vec<f64>);

/// The solution of largest amplitude with few harmonics, and from it those with more; and the state of the last at the
/// beginning of its period.
fn solutions(case: &Case) -> Result<Solutions> {
    let mut system = build(case, FIRST)?;
    let mut x = highest(&mut system)?;
    let (mut all, mut state) = (Vec::new(), Vec::new());
    for n in FIRST..=START {
        let mut finer = build(case, n)?;
        let guess = finer.resized(&x, system.series());
        let mut found = refined(&mut finer, &guess);
        if found.residual > SOLVED {
            let from_rest = highest(&mut finer)?;
            found = refined(&mut finer, &from_rest);
        }
        if found.residual > SOLVED {
            return Err(format!("{}: no solution with {n} harmonics ({:.1e})", case.name, found.residual).into());
        }
        let motion = finer.motion(&found.x, found.p)?;
        let contact = &motion.contacts[0];
        state = state_of(case, &motion.eta);
        all.push((n, [contact.free_fundamental.norm(), contact.closed_share, contact.peak_force]));
        (x, system) = (found.x, finer);
    }
    Ok((all, state))
}

/// The solution at level one near a guess, if the residual confirms it.
fn refined(system: &mut PeriodicSystem, guess: &[f64]) -> Refined {
    let held: Vec<f64> = (0..=guess.len()).map(|j| f64::from(u8::from(j == guess.len()))).collect();
    let mut found = system.refine(guess, 1.0, &held);
    for _ in 0..ROUNDS {
        if found.residual <= SOLVED {
            break;
        }
        found = system.refine(&found.x, 1.0, &held);
    }
    found
}

/// Modal coordinates and their rates at the beginning of the period.
fn state_of(case: &Case, eta: &[Vec<Complex64>]) -> Vec<f64> {
    let sum = |k: usize, order: i32| -> f64 {
        let nu = |n: usize| Complex64::new(0.0, n as f64 * case.omega);
        eta.iter().enumerate().map(|(n, eta)| (nu(n).powi(order) * eta[k]).re).sum()
    };
    let m = case.structure.n_modes();
    (0..m).map(|k| sum(k, 0)).chain((0..m).map(|k| sum(k, 1))).collect()
}

/// The same motion by exact shooting.
fn shooting(case: &Case, state: &[f64]) -> Result<Quantities> {
    let (of, m) = (&case.structure, case.structure.n_modes());
    let damping = Mat::from_fn(m, m, |i, j| of.damping().entry(i, j));
    let mut exact = ForcedStructure::new(of.omega_squared(), &damping, of.rows(), of.compliance().a(), of.gaps())?;
    case.load.terms().iter().try_for_each(|term| exact.push_load(term.harmonic, &term.modal, &term.gaps))?;
    let motion = exact.periodic(1.0, case.omega, 1, state)?;
    Ok([motion.free_gap_harmonic(0, 1).norm(), motion.closed_share(0), motion.peak_force(0)])
}

fn build(case: &Case, harmonics: usize) -> Result<PeriodicSystem> {
    let settings = PeriodicSettings { harmonics, ..PeriodicSettings::default() };
    let (scales, solver) = (Scales::new(case.length, case.omega, 1.0), solver_by_name("active-set")?);
    let (structure, load) = (&case.structure, case.load.clone());
    Ok(PeriodicSystem::force_response(structure, load, case.omega, 1.0, settings, scales, solver.as_ref())?)
}

/// Unknowns of the largest response at the level one on the curve from rest.
fn highest(system: &mut PeriodicSystem) -> Result<Vec<f64>> {
    let n = system.dim();
    let direction: Vec<f64> = (0..=n).map(|j| f64::from(u8::from(j == n))).collect();
    let bounds = vec![Bound { coordinate: n, min: -1e-9, max: 100.0 }];
    let method = Continuation { bounds, ..Continuation::default() };
    let branch = method.run(system, &vec![0.0; n], 0.0, &direction, |_| ControlFlow::Continue(()))?;
    let size = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>();
    let crossings = branch.points.windows(2).filter(|w| (w[0].p - 1.0) * (w[1].p - 1.0) <= 0.0);
    let between = crossings.map(|w| {
        let share = if w[0].p == w[1].p { 0.0 } else { (1.0 - w[0].p) / (w[1].p - w[0].p) };
        w[0].x.iter().zip(&w[1].x).map(|(a, b)| a + share * (b - a)).collect::<Vec<f64>>()
    });
    let found = between.max_by(|a, b| size(a).total_cmp(&size(b))).ok_or("the level is not reached")?;
    Ok(system.refine(&found, 1.0, &direction).x)
}

fn case(
    name: &'static str,
    (open, damping): (OpenModes, f64),
    (dof, force): (usize, f64),
    (hertz, length): (f64, f64),
) -> Result<Case> {
    let mut distribution = vec![0.0; open.n_dofs()];
    distribution[dof] = force;
    let answer = open.load(&distribution)?;
    let complex = |v: &[f64]| v.iter().map(|v| Complex64::from(*v)).collect::<Vec<_>>();
    let structure = ModalStructure::new(
        open.omega_squared().to_vec(),
        open.contact_rows().clone(),
        open.flexibility(),
        open.gaps().to_vec(),
        open.stop_compliance(),
        ModalDamping::ratios(open.omega_squared(), &[damping]),
    )?;
    let (modal, gaps) = (complex(&answer.modal), complex(&answer.gaps));
    let load = Load::new(&structure, vec![LoadTerm { harmonic: 1, omega_power: 0, modal, gaps }])?;
    Ok(Case { name, structure, load, omega: TAU * hertz, length })
}

/// A rod with `EA = ρA = L = g₀ = 1`, the mass of its tip left out, 1 %, a force in its middle.
fn rod(elements: usize, force: f64, hertz: f64) -> Result<Case> {
    let rod = Rod {
        material: Material::new(1.0, 1.0)?,
        area: 1.0,
        mesh: Mesh::uniform(1.0, elements)?,
        mass_matrix: MassMatrix::Consistent,
        start: Support::Clamped,
        end: Support::Free,
    };
    let model = rod.assemble(&[Stop::rigid(1.0, Direction::Axial, Side::Positive, 1.0)])?;
    let massless = MasslessContactModel::new(&model, &Drop)?;
    let open = OpenModes::of_massless(&massless, ModeCount::Lowest(elements - 1))?;
    let name = if elements == 2 { "rod of 2 elements, rigid stop" } else { "rod of 10 elements, rigid stop" };
    case(name, (open, 0.01), (elements / 2 - 1, force), (hertz, 1.0))
}

/// The beam of the paper in its lowest modes before a stop that yields, 0.19 %, a force near its clamped end; N, Hz.
fn beam(force: f64, hertz: f64) -> Result<Case> {
    let (length, gap) = (0.62975520, 1.03e-3);
    let beam = Beam {
        material: Material::new(181.36e9, 7730.0)?,
        section: Section::rectangle(0.012, 0.020)?,
        mesh: Mesh::graded(length, 21, 9.1958536)?,
        mass_matrix: MassMatrix::Consistent,
        start: Support::Clamped,
        end: Support::Free,
    };
    let stop = Stop::rigid(length, Direction::Transverse, Side::Positive, gap).on_spring(2.3e6);
    let model = beam.assemble(&[stop])?;
    let place = |i: &usize| (model.dofs()[*i].position - 0.0733).abs();
    let transverse = (0..model.dofs().len()).filter(|&i| model.dofs()[i].kind == DofKind::Deflection);
    let dof = transverse.min_by(|i, j| place(i).total_cmp(&place(j))).ok_or("a beam has deflections")?;
    let open = OpenModes::of_massless(&MasslessContactModel::new(&model, &Drop)?, ModeCount::Lowest(6))?;
    case("beam in 6 modes, stop of 2.3e6 N/m", (open, 0.0019), (dof, force), (hertz, gap))
}
