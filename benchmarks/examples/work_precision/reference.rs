//! The exact motion by shooting, and what the others are measured by.

use std::f64::consts::TAU;
use std::ops::ControlFlow;

use nlmodes::contact::solver_by_name;
use nlmodes::hbm::{CondensedStructure, Grazing, MixedShooting, MixedShootingSettings, Switching, Symmetry, grazing};
use nlmodes::linalg::{DenseLu, Mat};
use nlmodes::model::{Drop, MasslessContactModel};
use nlmodes::study::{BranchSettings, BranchStart, compute_branch};
use nlmodes::timestep::{ContactDynamics, Floquet, PeriodicMotion, Shooting, ShootingScales};
use nlmodes_benchmarks::Failure;

use crate::cases::Case;
use crate::newton::{FOUND, newton};

/// Instants of a period at which displacements are compared.
pub const INSTANTS: usize = 1 << 10;

/// An exact periodic motion.
pub struct Reference {
    pub model: MasslessContactModel,
    /// The exact motion; where none lies beside the truncated ones, the reference is MS-HBM with the harmonics of the seed.
    pub motion: Option<PeriodicMotion>,
    /// Angular frequency, rad/s.
    pub omega: f64,
    /// Averaged kinetic energy, J.
    pub kinetic_energy: f64,
    /// Energy at grazing, J, and frequency there, rad/s.
    pub grazing: (f64, f64),
    /// Displacements of all degrees of freedom at equidistant instants.
    pub displacements: Vec<Vec<f64>>,
    /// Mean force of all contacts together, N.
    pub mean_force: f64,
    /// Residual of the shooting equations.
    residual: f64,
    intervals: usize,
    contact_share: f64,
    stability: Option<f64>,
}

impl Reference {
    /// The first frequency of the case at which there is an exact motion beside the truncated ones.
    pub fn new(case: &Case) -> Result<Self, Failure> {
        let mut last = Failure::from("no frequency to try");
        for frequency in case.frequencies {
            match Self::at(case, *frequency) {
                Ok(reference) => return Ok(reference),
                Err(error) => {
                    println!("({} at {frequency}: {error})", case.slug);
                    last = error;
                }
            }
        }
        if case.with_truncated_reference {
            let ladder = case.frequencies.iter().find_map(|f| Self::climb(case, *f).ok());
            return ladder.map_or(Err(last), |ladder| ladder.truncated(case));
        }
        Err(last)
    }

    fn at(case: &Case, frequency: f64) -> Result<Self, Failure> {
        Self::climb(case, frequency)?.exact()
    }

    /// On the backbone with few harmonics, then at the same frequency with many.
    fn climb(case: &Case, frequency: f64) -> Result<Ladder, Failure> {
        let model = MasslessContactModel::new(&case.model, &Drop)?;
        let structure = CondensedStructure::new(model.clone(), usize::MAX)?;
        let start = grazing(&structure, 1)?;
        let hz = if frequency > 0.0 { frequency } else { -frequency * start.omega / TAU };
        let (mut z, mut width) = (backbone(case, &model, hz)?, case.leading_harmonics);
        for harmonics in [7, 10, 14, 20, 28, 40, 56, 80, case.seed_harmonics] {
            if harmonics <= width || harmonics > case.seed_harmonics {
                continue;
            }
            let mut problem = problem(&structure, harmonics, Switching::Exact, "active-set")?;
            let guess = widened(&z, width, harmonics, structure.n_contact_dofs());
            let fixed = problem.frequency_index();
            let found = newton(&mut problem, &guess, fixed);
            let moved = found.z[found.z.len() - 1] - guess[guess.len() - 1];
            if found.residual > FOUND || moved.abs() > 0.2 {
                let residual = found.residual;
                return Err(format!("{harmonics} harmonics: residual {residual:.1e}, ln E moved by {moved:.1e}").into());
            }
            (z, width) = (found.z, harmonics);
        }
        Ok(Ladder { model, structure, start, z, width })
    }

    pub fn describe(&self) -> String {
        let ratio = self.kinetic_energy / self.grazing.0;
        format!(
            "f = {:.12} Hz ({:.6} times that at grazing), E_av = {ratio:.6} times that at grazing, {} stretches of contact over one period, \
             the first contact closed in {:.2} % of it; largest multiplier {}; residual of the shooting equations {:.1e}",
            self.omega / TAU,
            self.omega / self.grazing.1,
            self.intervals,
            100.0 * self.contact_share,
            self.stability.map_or_else(|| "unknown".to_owned(), |m| format!("{m:.6}")),
            self.residual,
        )
    }

    /// Logarithm of the energy over that at grazing: the parameter of all methods.
    pub fn parameter(&self) -> f64 {
        (self.kinetic_energy / self.grazing.0).ln()
    }

    /// Unknowns of `structure` with these harmonics for the exact motion, and its parameter.
    pub fn unknowns(&self, structure: &CondensedStructure, harmonics: usize) -> Result<Vec<f64>, Failure> {
        let (model, start) = (structure.model(), grazing(structure, 1)?);
        let k_nn = DenseLu::factor(model.k_nn())?;
        let n = structure.n_contact_dofs();
        let positions: Vec<Vec<f64>> = self.displacements.iter().map(|q| free_position(model, &k_nn, q)).collect();
        let cosine = |d: usize, n: usize| {
            let phase = |j: usize| TAU * ((n * j) % INSTANTS) as f64 / INSTANTS as f64;
            let sum: f64 = positions.iter().enumerate().map(|(j, b)| b[d] * phase(j).cos()).sum();
            sum * if n == 0 { 1.0 } else { 2.0 } / INSTANTS as f64 / start.scales().length
        };
        let mut z: Vec<f64> =
            (0..n).flat_map(|d| (0..=harmonics).map(move |m| (d, m))).map(|(d, m)| cosine(d, m)).collect();
        z.extend([self.omega / start.omega, (self.kinetic_energy / start.energy).ln()]);
        Ok(z)
    }

    /// Relative error in the L2 norm of a displacement of the first contact over the period.
    pub fn displacement_error(&self, displacement: impl Fn(usize) -> f64) -> f64 {
        let dof = self.model.contacts()[0].dof;
        let (mut error, mut size) = (0.0, 0.0);
        for (j, exact) in self.displacements.iter().enumerate() {
            error += (displacement(j) - exact[dof]).powi(2);
            size += exact[dof].powi(2);
        }
        f64::sqrt(error / size)
    }
}

/// The point with the harmonics of the seed.
struct Ladder {
    model: MasslessContactModel,
    structure: CondensedStructure,
    start: Grazing,
    z: Vec<f64>,
    width: usize,
}

impl Ladder {
    /// The exact motion from there.
    fn exact(self) -> Result<Reference, Failure> {
        let Self { model, structure, start, z, width } = self;
        let point = problem(&structure, width, Switching::Exact, "active-set")?.modal_point(&z[..z.len() - 1], 0.0)?;
        let dynamics = ContactDynamics::new(model.clone())?;
        let state = dynamics.state_of_harmonics(&point.coefficients, point.omega, 0.0)?;
        let scales = ShootingScales { omega: start.omega, energy: start.energy };
        let mut shooting = Shooting::new(dynamics, scales)?;
        let mut guess = shooting.unknowns(&state, point.omega);
        guess.push(z[z.len() - 1]);
        let n = guess.len() - 1;
        let found = newton(&mut shooting, &guess, n - 1);
        let moved = found.z[n] - guess[n];
        if found.residual > 1e-11 || moved.abs() > 0.02 {
            return Err(format!("shooting: residual {:.1e}, ln E moved by {moved:.1e}", found.residual).into());
        }
        let motion = shooting.motion(&found.z[..n])?;
        let stability = Floquet::new(shooting.dynamics(), &motion).ok().map(|f| f.largest());
        let period = TAU / motion.omega;
        let intervals = motion.trajectory.closed_intervals();
        let contact_share = intervals.iter().filter(|i| i.contact == 0).map(|i| i.to - i.from).sum::<f64>() / period;
        let at = |j: usize| motion.trajectory.at(period * j as f64 / INSTANTS as f64).displacement;
        Ok(Reference {
            displacements: (0..INSTANTS).map(at).collect(),
            mean_force: mean_force(&motion),
            residual: found.residual,
            intervals: intervals.len(),
            contact_share,
            stability,
            grazing: (start.energy, start.omega),
            omega: motion.omega,
            kinetic_energy: motion.kinetic_energy,
            motion: Some(motion),
            model,
        })
    }

    /// The point itself as the reference; contacts where they are without filtering.
    fn truncated(self, case: &Case) -> Result<Reference, Failure> {
        let Self { model, structure, start, z, width } = self;
        let x = &z[..z.len() - 1];
        let mut problem = problem(&structure, width, Switching::Exact, "active-set")?;
        let point = problem.modal_point(x, 0.0)?;
        let phase = |j: usize| TAU * j as f64 / INSTANTS as f64;
        let n = point.coefficients.n_coordinates();
        let at = |j: usize| (0..n).map(|d| point.coefficients.value(d, phase(j))).collect();
        let mut displacements: Vec<Vec<f64>> = (0..INSTANTS).map(at).collect();
        for (contact, of) in model.contacts().iter().enumerate() {
            let history = problem.time_history(x, contact, INSTANTS, "")?;
            displacements.iter_mut().zip(&history.displacement).for_each(|(q, at)| q[of.dof] = *at);
        }
        println!("({}: the reference is MS-HBM with {width} harmonics)", case.slug);
        Ok(Reference {
            displacements,
            mean_force: problem.mean_forces().iter().sum(),
            residual: 0.0,
            intervals: point.contact_intervals,
            contact_share: point.contact_fraction,
            stability: None,
            grazing: (start.energy, start.omega),
            omega: point.omega,
            kinetic_energy: point.kinetic_energy,
            motion: None,
            model,
        })
    }
}

/// Where the massless coordinates would be without stops, `b = −K_NN⁻¹ K_NL q_L`.
fn free_position(model: &MasslessContactModel, k_nn: &DenseLu, q: &[f64]) -> Vec<f64> {
    let k_ln: &Mat<f64> = model.k_ln();
    let force = |d: usize| model.linear_dofs().iter().enumerate().map(|(i, &dof)| -k_ln[(i, d)] * q[dof]).sum();
    let mut b: Vec<f64> = (0..k_ln.ncols()).map(force).collect();
    k_nn.solve_in_place(&mut b);
    b
}

/// The periodic problem of a structure.
pub fn problem<'s>(
    structure: &'s CondensedStructure,
    harmonics: usize,
    switching: Switching,
    solver: &str,
) -> Result<MixedShooting<'s>, Failure> {
    let settings = MixedShootingSettings { harmonics, symmetry: Symmetry::Even, switching };
    let scales = grazing(structure, 1)?.scales();
    Ok(MixedShooting::new(structure, settings, scales, solver_by_name(solver)?.as_ref())?)
}

/// Unknowns and parameter on the backbone at the frequency `hz`.
fn backbone(case: &Case, model: &MasslessContactModel, hz: f64) -> Result<Vec<f64>, Failure> {
    let settings = BranchSettings {
        harmonics: case.leading_harmonics,
        start: BranchStart::Frequency { hz, upward: true },
        max_points: 1,
        ..BranchSettings::default()
    };
    let found = compute_branch(model.clone(), &settings, |_| ControlFlow::Continue(()))?;
    let (x, point) = (found.unknowns.first(), found.branch.points.first());
    let (x, point) = x.zip(point).ok_or("no point on the backbone")?;
    Ok(x.iter().copied().chain([(point.kinetic_energy / found.grazing.energy).ln()]).collect())
}

/// Unknowns and parameter with more harmonics, the new ones zero.
pub fn widened(z: &[f64], from: usize, to: usize, n: usize) -> Vec<f64> {
    let mut wide: Vec<f64> = Vec::with_capacity(n * (to + 1) + 2);
    for d in 0..n {
        wide.extend(&z[d * (from + 1)..(d + 1) * (from + 1)]);
        wide.resize((d + 1) * (to + 1), 0.0);
    }
    wide.extend(&z[n * (from + 1)..]);
    wide
}

/// `(1/T) ∫ Σ λ dt` by Gauss's rule between the contact instants, where forces are analytic.
fn mean_force(motion: &PeriodicMotion) -> f64 {
    const NODES: [(f64, f64); 4] = [
        (0.183_434_642_495_649_8, 0.362_683_783_378_362),
        (0.525_532_409_916_329, 0.313_706_645_877_887_3),
        (0.796_666_477_413_626_7, 0.222_381_034_453_374_5),
        (0.960_289_856_497_536_3, 0.101_228_536_290_376_26),
    ];
    let intervals = motion.trajectory.closed_intervals();
    let mut instants: Vec<f64> = intervals.iter().flat_map(|i| [i.from, i.to]).collect();
    instants.sort_by(f64::total_cmp);
    let mut sum = 0.0;
    for pair in instants.windows(2).filter(|pair| pair[1] > pair[0]) {
        let panels = (600.0 * (pair[1] - pair[0]) * motion.omega / TAU).ceil().max(4.0);
        let half = 0.5 * (pair[1] - pair[0]) / panels;
        for panel in 0..panels as usize {
            let middle = pair[0] + half * (2 * panel + 1) as f64;
            for (node, weight) in NODES {
                for t in [middle - half * node, middle + half * node] {
                    sum += weight * half * motion.trajectory.at(t).forces.iter().sum::<f64>();
                }
            }
        }
    }
    sum * motion.omega / TAU
}
