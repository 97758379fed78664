//! The exact motion by shooting, and what the others are measured by.

use std::f64::consts::TAU;
use std::ops::ControlFlow;

use nlmodes::branches::{BranchSettings, BranchStart, compute_branch};
use nlmodes::contact::solver_by_name;
use nlmodes::continuation::ParametricSystem;
use nlmodes::hbm::{CondensedStructure, Grazing, PeriodicSettings, PeriodicSystem, Switching, Symmetry, grazing};
use nlmodes::linalg::{DenseLu, Mat};
use nlmodes::model::{Drop, MasslessContactModel};
use nlmodes::timestep::{ClosedInterval, ContactDynamics, Floquet, PeriodicMotion, Shooting, ShootingScales};
use nlmodes_benchmarks::Failure;

use crate::cases::{Case, Whole};
use crate::newton::{FOUND, newton, search};

/// Instants of a period at which displacements are compared.
pub const INSTANTS: usize = 1 << 10;

/// An exact periodic motion.
#[derive(Clone)]
pub struct Reference {
    pub model: MasslessContactModel,
    pub motion: PeriodicMotion,
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
    /// The exact motion beside the one with few harmonics, at the frequency of the case.
    pub fn new(case: &Case) -> Result<Self, Failure> {
        let structure = CondensedStructure::new(Self::model(case)?, usize::MAX)?;
        let start = grazing(&structure, 1)?;
        let hz = if case.frequency > 0.0 { case.frequency } else { -case.frequency * start.omega / TAU };
        let z = backbone(case, structure.model(), hz)?;
        Self::beside(&structure, &start, &z, case.leading_harmonics, case.leading_harmonics)
    }

    /// The structure of the case, the masses of its contacts dropped.
    pub fn model(case: &Case) -> Result<MasslessContactModel, Failure> {
        Ok(MasslessContactModel::new(&case.model, &Drop)?)
    }

    /// From unknowns and parameter with `width` harmonics to those with more at the same frequency, and from there to
    /// the exact motion.
    pub fn beside(
        structure: &CondensedStructure,
        start: &Grazing,
        z: &[f64],
        width: usize,
        harmonics: usize,
    ) -> Result<Self, Failure> {
        let mut problem = problem(structure, harmonics, Switching::Exact, "active-set")?;
        let guess = resized(z, width, harmonics, structure.n_contact_dofs());
        let (n, fixed) = (problem.dim(), problem.n_coefficients());
        let found = search(&mut problem, &guess, fixed);
        if found.residual > FOUND {
            return Err(format!("{harmonics} harmonics: residual {:.1e}", found.residual).into());
        }
        let point = structure.modal_point(&mut problem, &found.z[..n], 0.0)?;
        let dynamics = ContactDynamics::new(structure.model().clone())?;
        let state = dynamics.state_of_harmonics(&point.coefficients, point.omega, 0.0)?;
        let mut shooting = Shooting::new(dynamics, ShootingScales { omega: start.omega, energy: start.energy })?;
        let mut guess = shooting.unknowns(&state, point.omega);
        guess.push(found.z[n]);
        let n = guess.len() - 1;
        let exact = newton(&mut shooting, &guess, n - 1);
        let moved = exact.z[n] - guess[n];
        if exact.residual > 1e-11 || moved.abs() > 0.5 {
            return Err(format!("shooting: residual {:.1e}, ln E moved by {moved:.1e}", exact.residual).into());
        }
        Self::of_motion(structure.model().clone(), start, &mut shooting, &exact.z, exact.residual)
    }

    /// The exact motion of a solution of the shooting equations, unknowns and parameter.
    fn of_motion(
        model: MasslessContactModel,
        start: &Grazing,
        shooting: &mut Shooting,
        z: &[f64],
        residual: f64,
    ) -> Result<Self, Failure> {
        let motion = shooting.motion(&z[..z.len() - 1])?;
        let stability = Floquet::new(shooting.dynamics(), &motion).ok().map(|f| f.largest());
        let period = TAU / motion.omega;
        let intervals = motion.trajectory.closed_intervals();
        let contact_share = intervals.iter().filter(|i| i.contact == 0).map(|i| i.to - i.from).sum::<f64>() / period;
        let at = |j: usize| motion.trajectory.at(period * j as f64 / INSTANTS as f64).displacement;
        Ok(Self {
            displacements: (0..INSTANTS).map(at).collect(),
            mean_force: mean_force(&motion),
            residual,
            intervals: stretches(&intervals, period),
            contact_share,
            stability,
            grazing: (start.energy, start.omega),
            omega: motion.omega,
            kinetic_energy: motion.kinetic_energy,
            motion,
            model,
        })
    }

    pub fn describe(&self) -> String {
        let ratio = self.kinetic_energy / self.grazing.0;
        format!(
            "f = {:.12} Hz ({:.6} times that at grazing), E_av = {ratio:.6} times that at grazing, {} stretches of \
             contact a period, \
             the first contact closed in {:.2} % of it; largest multiplier {}; residual of the shooting equations \
             {:.1e}",
            self.omega / TAU,
            self.omega / self.grazing.1,
            self.intervals,
            100.0 * self.contact_share,
            self.stability.map_or_else(|| "unknown".to_owned(), |m| format!("{m:.6}")),
            self.residual,
        )
    }

    /// The same motion in all degrees of freedom of the structure that was reduced.
    pub fn of_the_whole(&self, whole: &Whole) -> Self {
        Self {
            model: whole.model.clone(),
            displacements: self.displacements.iter().map(|q| whole.reduction.expand(q)).collect(),
            ..self.clone()
        }
    }

    /// Energy over that at grazing, stretches of contact, share of the period.
    pub fn brief(&self) -> String {
        format!(
            "{:.4} | {} | {:.2} %",
            self.kinetic_energy / self.grazing.0,
            self.intervals,
            100.0 * self.contact_share
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
        // The first contact of each direction sees them.
        let w = model.w();
        let toward = |d: usize| (0..w.ncols()).find(|&i| w[(d, i)] != 0.0).map_or((0, 0.0), |i| (i, w[(d, i)]));
        let mut seen: Vec<(usize, f64, usize)> =
            (0..structure.n_contact_dofs()).map(|d| (toward(d).0, toward(d).1, d)).collect();
        seen.sort_by_key(|(contact, ..)| *contact);
        let positions: Vec<Vec<f64>> = self.displacements.iter().map(|q| free_position(model, &k_nn, q)).collect();
        let cosine = |d: usize, n: usize| {
            let phase = |j: usize| TAU * ((n * j) % INSTANTS) as f64 / INSTANTS as f64;
            let sum: f64 = positions.iter().enumerate().map(|(j, b)| b[d] * phase(j).cos()).sum();
            sum * if n == 0 { 1.0 } else { 2.0 } / INSTANTS as f64 / start.scales().length
        };
        let mut z: Vec<f64> =
            seen.iter().flat_map(|&(_, w, d)| (0..=harmonics).map(|m| w * cosine(d, m)).collect::<Vec<_>>()).collect();
        z.extend([self.omega / start.omega, self.parameter_of(structure)?]);
        Ok(z)
    }

    /// The parameter of the exact motion in the scales of `structure`.
    pub fn parameter_of(&self, structure: &CondensedStructure) -> Result<f64, Failure> {
        Ok((self.kinetic_energy / grazing(structure, 1)?.energy).ln())
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

/// Stretches of contact in a period: one that goes on from its end to its beginning counts once.
pub fn stretches(intervals: &[ClosedInterval], period: f64) -> usize {
    let from_start = intervals.iter().filter(|i| i.from <= 0.0);
    let goes_on = |first: &&ClosedInterval| {
        first.to < period && intervals.iter().any(|last| last.contact == first.contact && last.to >= period)
    };
    intervals.len() - from_start.filter(goes_on).count()
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
pub fn problem(
    structure: &CondensedStructure,
    harmonics: usize,
    switching: Switching,
    solver: &str,
) -> Result<PeriodicSystem, Failure> {
    let settings = (PeriodicSettings { harmonics, switching, ..PeriodicSettings::default() }, Symmetry::Even);
    let scales = grazing(structure, 1)?.scales();
    Ok(structure.conservative_mode(settings, scales, solver_by_name(solver)?.as_ref())?)
}

/// Unknowns and parameter on the backbone at the frequency `hz`.
pub fn backbone(case: &Case, model: &MasslessContactModel, hz: f64) -> Result<Vec<f64>, Failure> {
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

/// Unknowns and parameter with more harmonics, the new ones zero, or with fewer.
pub fn resized(z: &[f64], from: usize, to: usize, n: usize) -> Vec<f64> {
    let mut other: Vec<f64> = Vec::with_capacity(n * (to + 1) + 2);
    for d in 0..n {
        other.extend(z[d * (from + 1)..(d + 1) * (from + 1)].iter().take(to + 1));
        other.resize((d + 1) * (to + 1), 0.0);
    }
    other.extend(&z[n * (from + 1)..]);
    other
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
