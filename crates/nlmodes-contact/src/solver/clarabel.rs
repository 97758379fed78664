use clarabel::{
    algebra::CscMatrix,
    solver::{DefaultSettings, DefaultSolver, IPSolver, SolverStatus, SupportedConeT::NonnegativeConeT},
};

use super::{
    closed_form::OneContact,
    polish::Polish,
    workspace::{Method, Outcome, Workspace},
};
use crate::{LcpError, LcpMatrix, LcpSolver, LcpWorkspace, sample::Sample, scaled::Scaled};

pub(crate) const NAME: &str = "clarabel";

/// The convex quadratic programme `min ½ λᵀ A λ + bᵀ λ` over `λ ≥ 0` by the interior-point solver Clarabel.
///
/// The programme is built once per matrix; only `b` changes between samples. There is no warm start. Near opening and
/// closing the error of an interior point is of the order of the square root of the tolerance, so only the closed set
/// is taken from it and its block is solved exactly; the judge decides as for every solver.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Clarabel {
    /// Tolerance of gap and residuals. Default 1e-12.
    pub tolerance: f64,
    /// Maximum number of interior-point iterations. Default 100.
    pub max_iterations: u32,
    /// Exact solution with the closed set found. Default true.
    pub polished: bool,
}

impl Default for Clarabel {
    fn default() -> Self {
        Self { tolerance: 1e-12, max_iterations: 100, polished: true }
    }
}

impl LcpSolver for Clarabel {
    fn name(&self) -> &'static str {
        NAME
    }

    fn workspace(&self, a: &LcpMatrix) -> Result<Box<dyn LcpWorkspace>, LcpError> {
        let c = a.n_contacts();
        if c == 0 {
            return Ok(Box::new(Workspace::new(a, OneContact)));
        }
        // The scaling inside Clarabel is fixed here, with a b of the same size as all later ones.
        let representative = vec![-1.0; c];
        let (quadratic, constraint) = (upper_triangle(a.scaled()), minus_identity(c));
        let cones = [NonnegativeConeT(c)];
        let programme =
            DefaultSolver::new(&quadratic, &representative, &constraint, &vec![0.0; c], &cones, self.settings())
                .map_err(|e| LcpError::Setup { solver: NAME, reason: e.to_string() })?;
        let polish = self.polished.then(|| Polish::new(c));
        Ok(Box::new(Workspace::new(a, InteriorPoint { programme, polish })))
    }
}

impl Clarabel {
    fn settings(&self) -> DefaultSettings<f64> {
        DefaultSettings {
            verbose: false,
            max_iter: self.max_iterations,
            tol_gap_abs: self.tolerance,
            tol_gap_rel: self.tolerance,
            tol_feas: self.tolerance,
            static_regularization_constant: 1e-12,
            presolve_enable: false,
            input_sparse_dropzeros: false,
            max_threads: 1,
            ..DefaultSettings::default()
        }
    }
}

fn upper_triangle(matrix: &Scaled) -> CscMatrix<f64> {
    let c = matrix.n_contacts();
    let starts = (0..=c).map(|j| j * (j + 1) / 2).collect();
    let rows = (0..c).flat_map(|j| 0..=j).collect();
    let values = (0..c).flat_map(|j| matrix.column(j)[..=j].iter().copied()).collect();
    CscMatrix::new(c, c, starts, rows, values)
}

fn minus_identity(c: usize) -> CscMatrix<f64> {
    CscMatrix::new(c, c, (0..=c).collect(), (0..c).collect(), vec![-1.0; c])
}

struct InteriorPoint {
    programme: DefaultSolver<f64>,
    polish: Option<Polish>,
}

impl Method for InteriorPoint {
    const NAME: &'static str = NAME;

    fn run(&mut self, sample: &mut Sample, closed: &mut [bool]) -> Outcome {
        let updated = self.programme.update_q(&sample.b).is_ok();
        if updated {
            self.programme.solve();
            self.unload(sample);
        }
        let iterations = self.programme.solution.iterations as usize;
        if updated && self.is_unbounded(sample) {
            return Outcome { iterations, verdict: sample.judge(), infeasible: true };
        }
        closed.iter_mut().zip(&sample.lambda).for_each(|(closed, l)| *closed = *l > 0.0);
        match &mut self.polish {
            Some(polish) => Outcome { iterations, ..polish.run(sample, closed) },
            None => Outcome { iterations, verdict: sample.judge(), infeasible: false },
        }
    }
}

impl InteriorPoint {
    fn unload(&self, sample: &mut Sample) {
        for (l, x) in sample.lambda.iter_mut().zip(&self.programme.solution.x) {
            *l = if *x > 0.0 && x.is_finite() { *x } else { 0.0 };
        }
    }

    /// Whether Clarabel's proof of an unbounded programme, which is one of contradictory contacts, is valid.
    fn is_unbounded(&self, sample: &mut Sample) -> bool {
        let status = self.programme.solution.status;
        if !matches!(status, SolverStatus::DualInfeasible | SolverStatus::AlmostDualInfeasible) {
            return false;
        }
        sample.ray.copy_from_slice(&sample.lambda);
        sample.is_proven_infeasible()
    }
}
