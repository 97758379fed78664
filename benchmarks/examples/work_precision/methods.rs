//! What each method makes of the point, and what it costs.

use nlmodes::contact::{SOLVER_NAMES, solver_by_name};
use nlmodes::continuation::ParametricSystem;
use nlmodes::hbm::{CondensedStructure, Switching};
use nlmodes::model::{Contact, ContactLaw, Drop, MasslessContactModel, StructuralModel};
use nlmodes::timestep::{ContactDynamics, Shooting, ShootingScales};
use nlmodes_benchmarks::{Failure, smallest_time};

use crate::cases::Case;
use crate::newton::{FOUND, Solution, newton};
use crate::reference::{INSTANTS, Reference, problem};

/// By how much the unknowns are off where Newton's method starts; less where it does not come back from there.
const OFF: [f64; 4] = [1e-2, 1e-3, 1e-4, 1e-5];

/// A method with its settings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Method {
    Shooting,
    Exact,
    Sampled {
        samples: usize,
    },
    /// Contact stiffness over that of the contact node.
    HarmonicBalance {
        stiffness: f64,
    },
}

impl Method {
    pub fn name(self) -> String {
        match self {
            Self::Shooting => "shooting".to_owned(),
            Self::Exact => "MS-HBM".to_owned(),
            Self::Sampled { samples } => format!("MS-HBM, {samples} samples"),
            Self::HarmonicBalance { stiffness } => format!("HBM, k_c/k = 1e{:.0}", stiffness.log10()),
        }
    }
}

/// Errors and cost of one setting.
#[derive(Debug, Clone)]
pub struct Measurement {
    pub method: Method,
    pub harmonics: usize,
    pub solver: &'static str,
    /// At the frequency of the exact motion, relative, L2.
    pub displacement: f64,
    /// At its energy, relative.
    pub frequency: f64,
    /// At its energy, relative.
    pub mean_force: f64,
    /// Processor time of a point, s.
    pub time: f64,
    pub iterations: usize,
    pub residual: f64,
    /// How far from the point the measured Newton's method began, relative.
    pub off: f64,
}

impl Measurement {
    pub const HEAD: &'static str = "method,harmonics,contact_solver,displacement_error,frequency_error,mean_force_error,cpu_s,iterations,residual,start_off";

    /// Where no solution was found.
    fn nothing(method: Method, harmonics: usize, solver: &'static str, residual: f64) -> Self {
        let (displacement, frequency, mean_force, time) = (f64::NAN, f64::NAN, f64::NAN, f64::NAN);
        Self { method, harmonics, solver, displacement, frequency, mean_force, time, iterations: 0, residual, off: 0.0 }
    }

    pub fn row(&self) -> String {
        format!(
            "\"{}\",{},{},{:.3e},{:.3e},{:.3e},{:.4e},{},{:.1e},{:.0e}",
            self.method.name(),
            self.harmonics,
            self.solver,
            self.displacement,
            self.frequency,
            self.mean_force,
            self.time,
            self.iterations,
            self.residual,
            self.off
        )
    }

    /// Whether Newton's method found a solution of its equations.
    pub fn is_found(&self) -> bool {
        self.residual < FOUND
    }
}

/// Numbers of harmonics of the study.
pub fn harmonics(case: &Case) -> Vec<usize> {
    [1, 2, 3, 5, 7, 10, 14, 20, 28, 40, 56, 80, 112, 160, 256]
        .into_iter()
        .filter(|h| *h <= case.most_harmonics)
        .collect()
}

/// Numbers of harmonics where there is another setting to be varied.
fn fewer_harmonics(case: &Case) -> Vec<usize> {
    [1, 5, 20, 80].into_iter().filter(|h| *h <= case.most_harmonics).collect()
}

/// Newton's method from a start that is off, timed.
fn timed<S: ParametricSystem>(system: &mut S, z: &[f64], unknowns: usize, fixed: usize) -> (f64, Solution, f64) {
    let mut last = (f64::NAN, newton(system, z, fixed), 0.0);
    if last.1.residual >= FOUND {
        return last;
    }
    for off in OFF {
        let start: Vec<f64> =
            z.iter().enumerate().map(|(i, z)| if i < unknowns { z * (1.0 + off) } else { *z }).collect();
        let found = newton(system, &start, fixed);
        let same = found.z.iter().zip(z).all(|(a, b)| (a - b).abs() < 1e-5);
        if found.residual < FOUND && same {
            let rounds = if found.z.len() > 100 { 1 } else { 3 };
            let time = smallest_time(rounds, || newton(system, &start, fixed).residual);
            return (time, found, off);
        }
        last.1 = found;
    }
    last
}

/// The exact motion once more, from 1 % off.
pub fn shooting(reference: &Reference) -> Result<Option<Measurement>, Failure> {
    let Some(exact) = &reference.motion else { return Ok(None) };
    let (energy, omega) = reference.grazing;
    let mut shooting = Shooting::new(ContactDynamics::new(reference.model.clone())?, ShootingScales { omega, energy })?;
    let mut z = shooting.unknowns(&exact.state, exact.omega);
    z.push(reference.parameter());
    let n = z.len() - 1;
    let (time, found, off) = timed(&mut shooting, &z, n - 1, n - 1);
    let motion = shooting.motion(&found.z[..n])?;
    let dof = reference.model.contacts()[0].dof;
    let at =
        |j: usize| motion.trajectory.at(motion.trajectory.duration() * j as f64 / INSTANTS as f64).displacement[dof];
    let at_energy = newton(&mut shooting, &z, n);
    Ok(Some(Measurement {
        method: Method::Shooting,
        harmonics: 0,
        solver: "",
        displacement: reference.displacement_error(at),
        frequency: (shooting.omega(&at_energy.z) / reference.omega - 1.0).abs(),
        mean_force: 0.0,
        time,
        iterations: found.iterations,
        residual: found.residual,
        off,
    }))
}

pub fn exact(case: &Case, reference: &Reference) -> Result<Vec<Measurement>, Failure> {
    let structure = CondensedStructure::new(reference.model.clone(), usize::MAX)?;
    harmonics(case)
        .into_iter()
        .map(|h| measure(&structure, reference, Method::Exact, h, Switching::Exact, "active-set", None).map(|m| m.0))
        .collect()
}

pub fn sampled(case: &Case, reference: &Reference) -> Result<Vec<Measurement>, Failure> {
    let structure = CondensedStructure::new(reference.model.clone(), usize::MAX)?;
    let mut all = Vec::new();
    for samples in [64, 256, 1024, 4096, 16384] {
        let most = (samples >= 1024).then_some(256.min(case.most_harmonics)).filter(|h| *h > 80);
        for h in fewer_harmonics(case).into_iter().chain(most).filter(|h| 2 * h < samples) {
            let (method, switching) = (Method::Sampled { samples }, Switching::Sampled { samples });
            all.push(measure(&structure, reference, method, h, switching, "active-set", None)?.0);
        }
    }
    Ok(all)
}

/// Each contact solver, exact and sampled, with 20 harmonics.
pub fn contact_solvers(case: &Case, reference: &Reference) -> Result<Vec<Measurement>, Failure> {
    let structure = CondensedStructure::new(reference.model.clone(), usize::MAX)?;
    let mut all = Vec::new();
    let h = 20.min(case.most_harmonics);
    for &solver in SOLVER_NAMES.iter() {
        if solver_by_name(solver)?.workspace(structure.compliance()).is_err() {
            continue;
        }
        let samples = 1024;
        let sampled = (Method::Sampled { samples }, Switching::Sampled { samples });
        for (method, switching) in [(Method::Exact, Switching::Exact), sampled] {
            all.push(measure(&structure, reference, method, h, switching, solver, None)?.0);
        }
    }
    Ok(all)
}

/// Contact stiffnesses over that of the contact node, each solution the start of the next.
pub fn harmonic_balance(case: &Case, reference: &Reference) -> Result<Vec<Measurement>, Failure> {
    const STEPS: i32 = 3;
    let mut all = Vec::new();
    for h in fewer_harmonics(case) {
        let mut before: Option<Vec<f64>> = None;
        for k in 0..=6 * STEPS {
            let stiffness = 10_f64.powf(f64::from(k) / f64::from(STEPS));
            let structure = CondensedStructure::new(with_springs(case, reference, stiffness)?, usize::MAX)?;
            if k % STEPS > 0 {
                // A step of the way only.
                let mut problem = problem(&structure, h, Switching::Exact, "active-set")?;
                let z = match before.take() {
                    Some(z) => z,
                    None => reference.unknowns(&structure, h)?,
                };
                let fixed = z.len() - 1;
                before = Some(newton(&mut problem, &z, fixed).z);
                continue;
            }
            let method = Method::HarmonicBalance { stiffness };
            let (m, z) = measure(&structure, reference, method, h, Switching::Exact, "active-set", before.take())?;
            all.push(m);
            before = Some(z);
        }
    }
    Ok(all)
}

/// The structure with each stop on a spring of `stiffness` times the stiffness of its contact node, the same masses as the reference.
fn with_springs(case: &Case, reference: &Reference, stiffness: f64) -> Result<MasslessContactModel, Failure> {
    let k_nn = reference.model.k_nn();
    let place = |dof: usize| reference.model.contact_dofs().iter().position(|d| *d == dof).unwrap_or(0);
    let on_spring = |c: &Contact| {
        let node = place(c.dof);
        Contact { law: ContactLaw::Elastic { stiffness: stiffness * k_nn[(node, node)] }, ..*c }
    };
    let contacts = case.model.contacts().iter().map(on_spring).collect();
    let model = StructuralModel::new(
        case.model.mass().clone(),
        case.model.stiffness().clone(),
        case.model.dofs().to_vec(),
        contacts,
    )?;
    Ok(MasslessContactModel::with_spring_tips(&model, Some(&Drop))?)
}

/// Errors at the frequency and at the energy of the reference, and the time of a point; with the unknowns found at the energy.
fn measure(
    structure: &CondensedStructure,
    reference: &Reference,
    method: Method,
    harmonics: usize,
    switching: Switching,
    solver: &'static str,
    start: Option<Vec<f64>>,
) -> Result<(Measurement, Vec<f64>), Failure> {
    let mut problem = problem(structure, harmonics, switching, solver)?;
    let z = match start {
        Some(z) => z,
        None => reference.unknowns(structure, harmonics)?,
    };
    let (n, frequency) = (problem.dim(), problem.frequency_index());
    let at_energy = newton(&mut problem, &z, n);
    let omega = problem.omega(&at_energy.z[..n]);
    if at_energy.residual >= FOUND || problem.modal_point(&at_energy.z[..n], 0.0).is_err() {
        return Ok((Measurement::nothing(method, harmonics, solver, at_energy.residual), z));
    }
    let mean_force: f64 = problem.mean_forces().iter().sum();
    // At the frequency of the reference, from there.
    let mut guess = at_energy.z.clone();
    guess[frequency] *= reference.omega / omega;
    let there = newton(&mut problem, &guess, frequency);
    let displacement = displacement_error(&mut problem, &there.z[..n], method, reference)?;
    let (time, timed, off) = timed(&mut problem, &there.z, frequency, frequency);
    let measurement = Measurement {
        method,
        harmonics,
        solver,
        displacement,
        frequency: (omega / reference.omega - 1.0).abs(),
        mean_force: (mean_force / reference.mean_force - 1.0).abs(),
        time,
        iterations: timed.iterations,
        residual: there.residual.max(at_energy.residual),
        off,
    };
    Ok((measurement, at_energy.z))
}

fn displacement_error(
    problem: &mut nlmodes::hbm::MixedShooting,
    x: &[f64],
    method: Method,
    reference: &Reference,
) -> Result<f64, Failure> {
    if let Method::HarmonicBalance { .. } = method {
        // The contact node itself, not the tip of the spring.
        let point = problem.modal_point(x, 0.0)?;
        let dof = reference.model.contacts()[0].dof;
        let phase = |j: usize| std::f64::consts::TAU * j as f64 / INSTANTS as f64;
        return Ok(reference.displacement_error(|j| point.coefficients.value(dof, phase(j))));
    }
    let history = problem.time_history(x, 0, INSTANTS, "")?;
    Ok(reference.displacement_error(|j| history.displacement[j]))
}
