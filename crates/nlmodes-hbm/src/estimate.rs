use nlmodes_contact::LcpSolver;
use nlmodes_continuation::{Linearization, ParametricSystem};
use nlmodes_linalg::{DenseLu, Mat};
use num_complex::Complex64;

use crate::periodic::{Load, LoadTerm, Source};
use crate::series::RealSeries;
use crate::trigonometric::inner;
use crate::{CondensedStructure, HbmError, PeriodicSettings, PeriodicSystem, Scales, Symmetry};

/// Frequency over that of the highest held mode up to which harmonics can be resonant, for contacts stiffen; and where
/// modes are left out, up to which the terms that represent these hold.
const MARGIN: (f64, f64) = (1.2, 0.5);

/// Most harmonics by which the larger problem reaches out for held modes: a step of Newton's method on it takes
/// milliseconds.
const FURTHEST: usize = 300;

/// Estimated errors of a [conservative mode](CondensedStructure::conservative_mode) that come from what its series
/// leave out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TruncationError {
    /// Relative error of the frequency at the same averaged kinetic energy; where energy or frequency hardly change
    /// along the branch, more generally the distance between the branches in the plane of `ln ω` and `ln E_av`.
    /// Infinite where no solution of the larger problem is near.
    pub frequency: f64,
    /// The share of it that comes from the held modes left out.
    pub held_modes: f64,
    /// Relative error of `b(t)`, root mean square over a period, across the branch.
    pub motion: f64,
}

impl TruncationError {
    const UNKNOWN: Self = Self { frequency: f64::INFINITY, held_modes: f64::INFINITY, motion: f64::INFINITY };
}

/// Estimates what harmonics and held modes left out change, by one step of Newton's method on a larger problem.
///
/// The larger problem has `M = max(2 N_h + 1, N_h + 6)` harmonics, and as many as reach to the highest held mode: an
/// internal resonance with a harmonic beyond the larger problem would stay unseen. Where a step is not small, as next
/// to a resonance, two larger problems differ: the larger of both estimates counts. For what the fixed-interface modes
/// that were not computed change, it has the first term of what the reduction
/// [leaves out](nlmodes_model::reduction::GalerkinReduction::left_out) too:
///
/// ```text
/// forces ν⁴ S q_N,n on the contact nodes , Σ_n ν⁴/2 q_N,nᴴ S q_N,n more energy        up to 1/(1 − ν²/λ_m) times that
/// [J; tᵀ] δ = [−R; 0]     at the solution, with tangent t, seen as one of the larger problem
/// e = |δ_ω t_p − δ_p t_ω| / √(t_ω² + t_p²)                                    in ln ω and p = ln E_av
/// ```
///
/// Frequency and energy are stationary: their error is of the order of the square of that of the motion. So where `e`
/// is less than the square of the relative change of `b`, as where it happens to change its sign, that square is the
/// estimate.
///
/// As the error falls with about the fifth power of `N_h`, the larger problem counts as exact; the step of Newton's
/// method, which neglects only squares of the error, is the error with its sign turned. Where an internal resonance
/// that the solution does not know is present, `[J; tᵀ]` is nearly singular and the estimate large.
pub struct TruncationEstimator<'s> {
    structure: &'s CondensedStructure,
    coarse: RealSeries,
    fine: PeriodicSystem,
    at: Linearization,
    bordered: Mat<f64>,
    lu: DenseLu,
    /// The one with twice as many harmonics, where this one has more.
    near: Option<Box<TruncationEstimator<'s>>>,
}

impl<'s> TruncationEstimator<'s> {
    /// For solutions of the problem with these settings and scales. The larger problem reaches as far as the highest
    /// held mode, up to 300 harmonics; the one with twice as many harmonics is asked too, and the larger estimate
    /// counts.
    ///
    /// # Errors
    /// As [`CondensedStructure::conservative_mode`].
    pub fn new(
        structure: &'s CondensedStructure,
        settings: (PeriodicSettings, Symmetry),
        scales: Scales,
        solver: &dyn LcpSolver,
    ) -> Result<Self, HbmError> {
        let margin = if structure.has_all_modes() { MARGIN.0 } else { MARGIN.1 };
        let reach = ((margin * structure.highest_frequency() / scales.omega).ceil() as usize).min(FURTHEST);
        let mut far = Self::reaching(structure, settings, reach, scales, solver)?;
        let near = Self::reaching(structure, settings, 0, scales, solver)?;
        if near.fine.series().n_harmonics < far.fine.series().n_harmonics {
            far.near = Some(Box::new(near));
        }
        Ok(far)
    }

    /// As [`new`](Self::new), the larger problem with `harmonics` at least; the step costs the third power of that.
    /// With fewer than the highest held mode takes, an internal resonance beyond them stays unseen.
    ///
    /// # Errors
    /// As [`CondensedStructure::conservative_mode`].
    pub fn reaching(
        structure: &'s CondensedStructure,
        settings: (PeriodicSettings, Symmetry),
        harmonics: usize,
        scales: Scales,
        solver: &dyn LcpSolver,
    ) -> Result<Self, HbmError> {
        let (settings, symmetry) = settings;
        let coarse = RealSeries { symmetry, n_harmonics: settings.harmonics };
        let harmonics = harmonics.max(2 * settings.harmonics + 1).max(settings.harmonics + 6);
        let finer = (PeriodicSettings { harmonics, ..settings }, symmetry);
        let mut fine = structure.conservative_mode(finer, scales, solver)?;
        if !structure.has_all_modes() {
            // What is left out is a load, beside which rows have the signs of motions of any phase.
            fine.response.take_any_phase();
        }
        let n = fine.dim();
        let (at, bordered) = (Linearization::new(n), Mat::zeros(n + 1, n + 1));
        Ok(Self { structure, coarse, fine, at, bordered, lu: DenseLu::default(), near: None })
    }

    /// The errors of the solution `x` at the parameter `p` with the tangent (n + 1) of its branch.
    pub fn estimate(&mut self, x: &[f64], p: f64, tangent: &[f64]) -> TruncationError {
        let own = self.try_estimate(x, p, tangent).unwrap_or(TruncationError::UNKNOWN);
        let near = self.near.as_mut().map(|near| near.estimate(x, p, tangent));
        near.filter(|near| near.frequency > own.frequency).unwrap_or(own)
    }

    /// `None` where the larger problem has no step of Newton's method.
    fn try_estimate(&mut self, x: &[f64], p: f64, tangent: &[f64]) -> Option<TruncationError> {
        let (z, tangent) = (self.fine.resized(x, self.coarse), self.fine.resized(tangent, self.coarse));
        self.fine.accepted(&z, p);
        let harmonics = self.step(&z, p, &tangent)?;
        let frequency = self.across(&harmonics, &z, &tangent);
        let held_modes = self.held_modes(&z, p, &tangent)?;
        let coefficients = self.fine.n_coefficients();
        let length = |v: &[f64]| self.mean_square(&v[..coefficients]).sqrt();
        let motion = length(&harmonics) / length(&z).max(f64::MIN_POSITIVE);
        let harmonics = frequency.abs().max(motion * motion);
        let error = TruncationError { frequency: harmonics + held_modes, held_modes, motion };
        error.frequency.is_finite().then_some(error)
    }

    /// Newton's step `δ`.
    fn step(&mut self, z: &[f64], p: f64, tangent: &[f64]) -> Option<Vec<f64>> {
        self.fine.linearize(z, p, &mut self.at).ok()?;
        let n = z.len();
        for (j, component) in tangent.iter().enumerate() {
            (0..n).for_each(|i| self.bordered[(i, j)] = self.at.jacobian[(i, j)]);
            self.bordered[(n, j)] = *component;
        }
        self.lu.refactor(&self.bordered).ok()?;
        Some(self.solve())
    }

    fn solve(&self) -> Vec<f64> {
        let mut delta: Vec<f64> = self.at.residual.iter().map(|r| -r).chain([0.0]).collect();
        self.lu.solve_in_place(&mut delta);
        delta
    }

    /// What the fixed-interface modes left out change of the motion solved last, at most.
    fn held_modes(&mut self, z: &[f64], p: f64, tangent: &[f64]) -> Option<f64> {
        if self.structure.has_all_modes() {
            return Some(0.0);
        }
        let at = self.fine.operating_point(z, p);
        let (mut terms, mut energy) = (Vec::new(), 0.0);
        for harmonic in 1..=self.fine.series().n_harmonics {
            let nu4 = (harmonic as f64 * at.omega).powi(4);
            let q = self.structure.contact_coordinates(&self.fine, harmonic, at);
            let forces: Vec<Complex64> = self.structure.left_out(&q).into_iter().map(|f| f * nu4).collect();
            let [modal, gaps] = [&self.structure.follow, &self.structure.pressed]
                .map(|rows| (0..rows.ncols()).map(|k| along(rows, k, &forces)).collect());
            terms.push(LoadTerm { harmonic, omega_power: 0, modal, gaps });
            energy += 0.5 * q.iter().zip(&forces).map(|(q, f)| (q.conj() * f).re).sum::<f64>();
        }
        let system = &mut self.fine;
        let load = Load::new(&system.structure, terms).ok()?;
        let before = (std::mem::replace(&mut system.load, load), system.closing.level);
        system.closing.level = Source::Fixed(1.0);
        let without = self.at.residual.clone();
        let found = system.linearize(z, p, &mut self.at);
        (system.load, system.closing.level) = before;
        found.ok()?;
        let coefficients = self.fine.n_coefficients();
        self.at.residual[coefficients] += energy / (self.fine.scales.energy * p.exp());
        self.at.residual.iter_mut().zip(&without).for_each(|(with, without)| *with -= without);
        let change = self.solve();
        let remainder = self.structure.remainder(self.coarse.n_harmonics as f64 * at.omega);
        (remainder > 0.0).then(|| self.across(&change, z, tangent).abs() / remainder)
    }

    /// Signed distance of `δ` from the tangent in the plane of `ln ω` and the parameter.
    fn across(&self, delta: &[f64], z: &[f64], tangent: &[f64]) -> f64 {
        let (k, p) = (self.fine.n_coefficients(), z.len());
        let (d_omega, t_omega) = (delta[k] / z[k], tangent[k] / z[k]);
        let length = t_omega.hypot(tangent[p]);
        // Where neither changes along the branch, as on the tip of an internal-resonance branch, every direction is
        // across.
        if length < 1e-9 {
            return d_omega.hypot(delta[p]);
        }
        (d_omega * tangent[p] - delta[p] * t_omega) / length
    }

    /// `Σ_d ⟨b_d²⟩` of coefficients.
    fn mean_square(&self, coefficients: &[f64]) -> f64 {
        let width = self.fine.series().width();
        let mean = |row: &[f64]| row[0] * row[0] + 0.5 * inner(&row[1..], &row[1..]);
        coefficients.chunks(width).map(mean).sum()
    }
}

/// `Rᵀ f` of column k.
fn along(rows: &Mat<f64>, k: usize, f: &[Complex64]) -> Complex64 {
    f.iter().zip(rows.col(k).iter()).map(|(f, row)| f * row).sum()
}

#[cfg(test)]
mod tests {
    use nlmodes_linalg::sparse_from_triplets;
    use nlmodes_model::reduction::HeldModes;
    use nlmodes_model::{Contact, Dof, DofKind, Drop, MasslessContactModel, Side, StructuralModel};

    use super::*;
    use crate::grazing;

    /// Five masses in a row and a massless node before a stop, with so many of the five held modes.
    fn chain(n_modes: usize) -> CondensedStructure {
        chain_of(5, n_modes)
    }

    /// The same with so many masses.
    fn chain_of(masses: usize, n_modes: usize) -> CondensedStructure {
        let mut k = vec![(0, 0, 3e4)];
        for i in 1..=masses {
            k.extend([(i, i, 2e4), (i - 1, i - 1, 2e4), (i, i - 1, -2e4), (i - 1, i, -2e4)]);
        }
        let m: Vec<_> = (0..masses).map(|i| (i, i, 0.1 + 0.02 * i as f64)).collect();
        let dofs = (0..=masses).map(|node| Dof { node, position: node as f64, kind: DofKind::Axial }).collect();
        let matrix = |entries: &[_]| sparse_from_triplets(masses + 1, masses + 1, entries).unwrap();
        let stop = Contact::rigid(masses, Side::Positive, 1e-3);
        let model = StructuralModel::new(matrix(&m), matrix(&k), dofs, vec![stop]).unwrap();
        CondensedStructure::new(MasslessContactModel::new(&model, &Drop).unwrap(), n_modes).unwrap()
    }

    #[test]
    fn the_guess_for_the_held_modes_is_rayleighs_of_the_modes_left_out() {
        let (all, few) = (chain(5), chain(2));
        let (start, held) = (grazing(&few, 1).unwrap(), HeldModes::new(all.model(), 5).unwrap().modes);
        for harmonics in [1, 2, 3] {
            // S = Σ g²/λ³ over the modes left out, but for what their static shape has of it as a mode of its own;
            // beyond the leading term, the factor of the last one kept.
            let sum = |power: i32| held[2..].iter().map(|m| m.g[0].powi(2) / m.lambda.powi(power)).sum::<f64>();
            let left_out = sum(3) - sum(2).powi(2) / sum(1);
            let rest = 1.0 - (harmonics as f64 * start.omega).powi(2) / held[1].lambda;
            let form = start.contact_amplitudes(&few)[0].powi(2) * left_out;
            let expected = harmonics as f64 * start.omega.powi(4) * form / (8.0 * start.energy) / rest;
            let found = few.held_modes_error(&start, start.omega, harmonics);
            assert!(rest > 0.0 && (found / expected - 1.0).abs() < 1e-6, "{harmonics}: {found:e} {expected:e}");
        }
        assert_eq!(few.held_modes_error(&start, start.omega, 100), f64::INFINITY, "the modes end below the harmonics");
        assert!(all.held_modes_error(&start, start.omega, 1) < 1e-12, "none is left out");
    }

    /// The mean over a period, from samples of it.
    #[test]
    fn the_size_of_a_motion_is_its_mean_square() {
        let (structure, samples) = (chain(5), 64);
        let (start, symmetry) = (grazing(&structure, 1).unwrap(), Symmetry::Even);
        let settings = (PeriodicSettings { harmonics: 3, ..PeriodicSettings::default() }, symmetry);
        let solver = nlmodes_contact::solver_by_name("active-set").unwrap();
        let estimator =
            TruncationEstimator::reaching(&structure, settings, 0, start.scales(), solver.as_ref()).unwrap();
        let b: Vec<f64> = (0..estimator.fine.series().width()).map(|n| (1.3 * n as f64 + 0.4).cos()).collect();
        let value = |j: usize| {
            let tau = std::f64::consts::TAU * j as f64 / samples as f64;
            b.iter().enumerate().map(|(n, b)| b * (n as f64 * tau).cos()).sum::<f64>()
        };
        let expected = (0..samples).map(|j| value(j).powi(2)).sum::<f64>() / samples as f64;
        assert!((estimator.mean_square(&b) / expected - 1.0).abs() < 1e-13);
    }

    /// A step along the branch is no error, whatever else there is.
    #[test]
    fn the_distance_from_the_branch_does_not_see_what_lies_along_it() {
        let structure = chain(5);
        let start = grazing(&structure, 1).unwrap();
        let settings = settings(3);
        let solver = nlmodes_contact::solver_by_name("active-set").unwrap();
        let estimator =
            TruncationEstimator::reaching(&structure, settings, 0, start.scales(), solver.as_ref()).unwrap();
        let (n, k) = (estimator.fine.dim(), estimator.fine.n_coefficients());
        let vector = |seed: f64| (0..=n).map(|i| (1.7 * i as f64 + seed).sin()).collect::<Vec<f64>>();
        let (z, delta, mut tangent) = (vector(0.4), vector(2.0), vector(3.3));
        let along = |delta: &[f64], tangent: &[f64], share: f64| {
            let moved: Vec<f64> = delta.iter().zip(tangent).map(|(d, t)| d + share * t).collect();
            estimator.across(&moved, &z[..n], tangent)
        };
        let own = along(&delta, &tangent, 0.0);
        assert!(own.abs() > 1e-3);
        for share in [-2.0, 0.37, 11.0] {
            assert!((along(&delta, &tangent, share) - own).abs() < 1e-12, "{share}");
        }
        // Where the frequency stays along the branch it is the change of its logarithm.
        tangent[k] = 0.0;
        assert!((along(&delta, &tangent, 0.0).abs() - (delta[k] / z[k]).abs()).abs() < 1e-14);
        // Where neither changes every direction is across.
        tangent[n] = 0.0;
        assert!((along(&delta, &tangent, 0.0) - (delta[k] / z[k]).hypot(delta[n])).abs() < 1e-14);
    }

    fn settings(harmonics: usize) -> (PeriodicSettings, Symmetry) {
        (PeriodicSettings { harmonics, ..PeriodicSettings::default() }, Symmetry::Even)
    }

    /// Unknowns, tangent and index of the frequency where the branch from grazing has so many times the energy of
    /// grazing.
    fn branch(structure: &CondensedStructure, harmonics: usize, ratio: f64) -> (Vec<f64>, Vec<f64>, usize) {
        let start = grazing(structure, 1).unwrap();
        let solver = nlmodes_contact::solver_by_name("active-set").unwrap();
        let mut problem = structure.conservative_mode(settings(harmonics), start.scales(), solver.as_ref()).unwrap();
        let (n, p) = (problem.dim(), ratio.ln());
        let (x, direction) = problem.start(&start);
        let bound = nlmodes_continuation::Bound { coordinate: n, min: -3.0, max: p };
        let method = nlmodes_continuation::Continuation { bounds: vec![bound], ..Default::default() };
        let run = method.run(&mut problem, &x, 0.0, &direction, |_| std::ops::ControlFlow::Continue(())).unwrap();
        let last = run.points.last().unwrap().clone();
        assert!((last.p - p).abs() < 1e-12);
        (last.x, last.tangent, problem.n_coefficients())
    }

    /// Near grazing, where a motion has hardly any harmonics beyond those asked for, the share of the held modes left
    /// out is what these change; farther out the harmonics that the estimate looks at beside them have their part in
    /// it, and it is up to twice as much.
    #[test]
    fn the_share_of_the_held_modes_is_what_those_left_out_change() {
        let (few, all) = (chain_of(12, 5), chain_of(12, 12));
        let [own, whole] = [&few, &all].map(|structure| grazing(structure, 1).unwrap());
        let solver = nlmodes_contact::solver_by_name("active-set").unwrap();
        for (harmonics, ratio, least) in [(2, 1.02, 0.95), (3, 1.02, 0.85), (3, 1.2, 0.5), (3, 4.0, 0.5)] {
            let (x, tangent, k) = branch(&few, harmonics, ratio);
            let (better, _, at) = branch(&all, harmonics, ratio * own.energy / whole.energy);
            let mut estimator =
                TruncationEstimator::reaching(&few, settings(harmonics), 0, own.scales(), solver.as_ref()).unwrap();
            let found = estimator.estimate(&x, ratio.ln(), &tangent);
            let (t_omega, t_p) = (tangent[k] / x[k], tangent[x.len()]);
            let change = (better[at] * whole.omega / (x[k] * own.omega)).ln().abs();
            let share = change * t_p.abs() / t_omega.hypot(t_p) / found.held_modes;
            assert!(share > least && share < 1.0, "{harmonics} {ratio}: {share}");
            assert!(found.frequency > found.held_modes && found.frequency.is_finite());
        }
    }

    /// The estimate at few harmonics is the distance of the solution with many.
    #[test]
    fn the_estimate_is_what_more_harmonics_change() {
        let structure = chain(5);
        let start = grazing(&structure, 1).unwrap();
        let solver = nlmodes_contact::solver_by_name("active-set").unwrap();
        let (ratio, p) = (1.4, 1.4_f64.ln());
        let ((x, tangent, k), (better, _, at)) = (branch(&structure, 5, ratio), branch(&structure, 60, ratio));
        let mut estimator = TruncationEstimator::new(&structure, settings(5), start.scales(), solver.as_ref()).unwrap();
        let found = estimator.estimate(&x, p, &tangent);
        let (t_omega, t_p) = (tangent[k] / x[k], tangent[x.len()]);
        let expected = (better[at] / x[k]).ln().abs() * t_p.abs() / t_omega.hypot(t_p);
        assert!((found.frequency / expected - 1.0).abs() < 0.2, "{:e} for {expected:e}", found.frequency);
        assert!(found.held_modes == 0.0 && found.motion > 0.0);
    }
}
