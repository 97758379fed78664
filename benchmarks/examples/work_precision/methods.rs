//! What each method makes of the point, and what it costs.

use std::collections::BTreeMap;

use nlmodes::contact::{SOLVER_NAMES, solver_by_name};
use nlmodes::continuation::ParametricSystem;
use nlmodes::hbm::{CondensedStructure, HbmError, Switching};
use nlmodes::model::{Contact, Drop, MasslessContactModel, StructuralModel};
use nlmodes::timestep::{ContactDynamics, Shooting, ShootingScales};
use nlmodes_benchmarks::{Failure, smallest_time};

use crate::cases::Case;
use crate::newton::{FOUND, Solution, newton, search};
use crate::reference::{INSTANTS, Reference, problem, resized};

/// By how much the unknowns are off where Newton's method starts; less where it does not come back from there.
const OFF: [f64; 4] = [1e-2, 1e-3, 1e-4, 1e-5];

/// Errors of displacement and frequency from which on a solution is another motion.
const ANOTHER: (f64, f64) = (0.3, 0.1);

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
    /// At the frequency of the exact motion, relative, L2. Not a number, as what follows, where no such motion was
    /// found.
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

    /// Whether the motion was found, at the frequency or at the energy.
    pub fn is_found(&self) -> bool {
        self.displacement.is_finite() || self.frequency.is_finite()
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
pub fn shooting(reference: &Reference) -> Result<Measurement, Failure> {
    let exact = &reference.motion;
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
    Ok(Measurement {
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
    })
}

/// Solutions with exact switching, by their harmonics: where others are sought if not from the exact motion itself.
pub type Neighbours = BTreeMap<usize, Vec<Vec<f64>>>;

/// From the most harmonics to the fewest: a motion that is not found from the exact one is sought from that with the
/// next more.
pub fn exact(case: &Case, reference: &Reference) -> Result<(Vec<Measurement>, Neighbours), Failure> {
    let structure = CondensedStructure::new(reference.model.clone(), usize::MAX)?;
    let (mut all, mut neighbours) = (Vec::new(), Neighbours::new());
    for (h, wanted) in descent(case) {
        let setting =
            Setting { method: Method::Exact, harmonics: h, switching: Switching::Exact, solver: "active-set" };
        let starts = starts(&structure, reference, &neighbours, h)?;
        let (m, found) = match wanted {
            true => measure(&structure, reference, &setting, &starts)?,
            false => errors(&structure, reference, &setting, &starts)?,
        };
        if wanted {
            all.insert(0, m);
        }
        neighbours.insert(h, found);
    }
    Ok((all, neighbours))
}

/// Numbers of harmonics from the most to the fewest, and whether the study wants them: the smaller ones one by one.
pub fn descent(case: &Case) -> Vec<(usize, bool)> {
    const ONE_BY_ONE: usize = 28;
    let wanted = harmonics(case);
    (1..=case.most_harmonics)
        .rev()
        .filter(|h| *h < ONE_BY_ONE || wanted.contains(h))
        .map(|h| (h, wanted.contains(&h)))
        .collect()
}

/// The exact motion in these harmonics, then what is known with as many or with the next more.
pub fn starts(
    structure: &CondensedStructure,
    reference: &Reference,
    neighbours: &Neighbours,
    harmonics: usize,
) -> Result<Vec<Vec<f64>>, Failure> {
    let mut all = vec![reference.unknowns(structure, harmonics)?];
    let known = neighbours.range(harmonics..).find(|(_, found)| !found.is_empty());
    if let Some((&width, found)) = known {
        all.extend(found.iter().map(|z| resized(z, width, harmonics, structure.n_contact_dofs())));
    }
    Ok(all)
}

pub fn sampled(case: &Case, reference: &Reference, known: &Neighbours) -> Result<Vec<Measurement>, Failure> {
    let structure = CondensedStructure::new(reference.model.clone(), usize::MAX)?;
    let mut all = Vec::new();
    for samples in [64, 256, 1024, 4096, 16384] {
        let most = (samples >= 1024).then_some(256.min(case.most_harmonics)).filter(|h| *h > 80);
        for h in fewer_harmonics(case).into_iter().chain(most).filter(|h| 2 * h < samples) {
            let (method, switching) = (Method::Sampled { samples }, Switching::Sampled { samples });
            let setting = Setting { method, harmonics: h, switching, solver: "active-set" };
            all.push(measure(&structure, reference, &setting, &starts(&structure, reference, known, h)?)?.0);
        }
    }
    Ok(all)
}

/// Each contact solver, exact and sampled, with 20 harmonics.
pub fn contact_solvers(case: &Case, reference: &Reference, known: &Neighbours) -> Result<Vec<Measurement>, Failure> {
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
            let setting = Setting { method, harmonics: h, switching, solver };
            all.push(measure(&structure, reference, &setting, &starts(&structure, reference, known, h)?)?.0);
        }
    }
    Ok(all)
}

/// Contact stiffnesses over that of the contact node: from the exact motion, or else from the solution with the
/// stiffness before.
pub fn harmonic_balance(case: &Case, reference: &Reference) -> Result<Vec<Measurement>, Failure> {
    const STEPS: i32 = 3;
    let mut all = Vec::new();
    for h in fewer_harmonics(case) {
        let mut before: Option<Vec<f64>> = None;
        for k in 0..=6 * STEPS {
            let stiffness = 10_f64.powf(f64::from(k) / f64::from(STEPS));
            let structure = match CondensedStructure::new(with_springs(case, reference, stiffness)?, usize::MAX) {
                Ok(structure) => structure,
                // The structure is lost in rounding beside its springs.
                Err(HbmError::ContactTooStiff { .. }) => break,
                Err(error) => return Err(error.into()),
            };
            let itself = reference.unknowns(&structure, h)?;
            if k % STEPS > 0 {
                // A step of the way only.
                let mut problem = problem(&structure, h, Switching::Exact, "active-set")?;
                before.iter_mut().for_each(|z| *z = newton(&mut problem, z, z.len() - 1).z);
                continue;
            }
            let starts: Vec<Vec<f64>> = std::iter::once(itself).chain(before.take()).collect();
            let method = Method::HarmonicBalance { stiffness };
            let setting = Setting { method, harmonics: h, switching: Switching::Exact, solver: "active-set" };
            let (m, found) = measure(&structure, reference, &setting, &starts)?;
            all.push(m);
            before = found.into_iter().next().or(starts.into_iter().next_back());
        }
    }
    Ok(all)
}

/// The structure with each stop on a spring of `stiffness` times the stiffness of its contact node, the same masses as
/// the reference.
fn with_springs(case: &Case, reference: &Reference, stiffness: f64) -> Result<MasslessContactModel, Failure> {
    let k_nn = reference.model.k_nn();
    let place = |dof: usize| reference.model.contact_dofs().iter().position(|d| *d == dof).unwrap_or(0);
    let on_spring = |c: &Contact| {
        let node = place(c.normal.entries()[0].0);
        c.clone().on_spring(stiffness * k_nn[(node, node)])
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

/// Error below which no nearer solution is looked for.
const NEAR: f64 = 1e-3;

/// What is measured.
pub struct Setting {
    pub method: Method,
    pub harmonics: usize,
    pub switching: Switching,
    pub solver: &'static str,
}

/// Errors, and the time of a point; with the unknowns found.
fn measure(
    structure: &CondensedStructure,
    reference: &Reference,
    setting: &Setting,
    starts: &[Vec<f64>],
) -> Result<(Measurement, Vec<Vec<f64>>), Failure> {
    let (mut m, found) = errors(structure, reference, setting, starts)?;
    if let Some(there) = found.last().filter(|_| m.displacement.is_finite()) {
        let mut problem = problem(structure, setting.harmonics, setting.switching, setting.solver)?;
        let frequency = problem.n_coefficients();
        let (time, timed, off) = timed(&mut problem, there, frequency, frequency);
        (m.time, m.iterations, m.off) = (time, timed.iterations, off);
    }
    Ok((m, found))
}

/// Errors at the frequency and at the energy of the reference; with the unknowns found, those at the energy first. Of
/// the solutions to which the starts lead, the nearest to the exact motion counts.
pub fn errors(
    structure: &CondensedStructure,
    reference: &Reference,
    setting: &Setting,
    starts: &[Vec<f64>],
) -> Result<(Measurement, Vec<Vec<f64>>), Failure> {
    let Setting { method, harmonics, switching, solver } = *setting;
    let mut problem = problem(structure, harmonics, switching, solver)?;
    let (n, frequency) = (problem.dim(), problem.n_coefficients());
    let nothing = f64::NAN;
    let mut m = Measurement {
        method,
        harmonics,
        solver,
        displacement: nothing,
        frequency: nothing,
        mean_force: nothing,
        time: nothing,
        iterations: 0,
        residual: 0.0,
        off: 0.0,
    };
    let mut at_energy = None;
    for z in starts {
        let mut guess = z.clone();
        guess[n] = reference.parameter_of(structure)?;
        let there = search(&mut problem, &guess, n);
        let error = (problem.omega(&there.z[..n]) / reference.omega - 1.0).abs();
        let better = error < if m.frequency.is_nan() { ANOTHER.1 } else { m.frequency };
        if there.residual >= FOUND || !better {
            continue;
        }
        let Ok(point) = structure.modal_point(&mut problem, &there.z[..n], 0.0) else { continue };
        let mean_force: f64 = point.contacts.iter().map(|contact| contact.mean_force).sum();
        m.frequency = error;
        m.mean_force = (mean_force / reference.mean_force - 1.0).abs();
        m.residual = there.residual;
        at_energy = Some(there.z);
        if error < NEAR {
            break;
        }
    }
    let (mut at_frequency, mut residual) = (None, 0.0);
    for z in starts.iter().chain(&at_energy) {
        let mut guess = z.clone();
        guess[frequency] *= reference.omega / problem.omega(&z[..n]);
        let there = search(&mut problem, &guess, frequency);
        if there.residual >= FOUND || structure.modal_point(&mut problem, &there.z[..n], 0.0).is_err() {
            continue;
        }
        let error = displacement_error((structure, &mut problem), &there.z[..n], method, reference)?;
        if error < if m.displacement.is_nan() { ANOTHER.0 } else { m.displacement } {
            (m.displacement, residual) = (error, there.residual);
            at_frequency = Some(there.z);
            if error < NEAR {
                break;
            }
        }
    }
    m.residual = m.residual.max(residual);
    Ok((m, at_energy.into_iter().chain(at_frequency).collect()))
}

fn displacement_error(
    (structure, problem): (&CondensedStructure, &mut nlmodes::hbm::PeriodicSystem),
    x: &[f64],
    method: Method,
    reference: &Reference,
) -> Result<f64, Failure> {
    if let Method::HarmonicBalance { .. } = method {
        // The contact node itself, not the tip of the spring.
        let point = structure.modal_point(problem, x, 0.0)?;
        let dof = reference.model.contacts()[0].dof;
        let phase = |j: usize| std::f64::consts::TAU * j as f64 / INSTANTS as f64;
        return Ok(reference.displacement_error(|j| point.coefficients.value(dof, phase(j))));
    }
    let history = problem.equidistant_histories(x, structure.model().contacts(), INSTANTS, "")?.swap_remove(0);
    Ok(reference.displacement_error(|j| history.displacement[j]))
}
