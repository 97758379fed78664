//! The variables of a study from measured points of a curve: Gauss-Newton with the gradients of the curve.
//!
//! ```text
//! min Σ ((q_i(x) − m_i)/σ_i)² ,   Cov(x) = (Jᵀ J)⁻¹ ,   J = (dq_i/dx)/σ_i
//! ```
//!
//! `q_i` is a column of `branch.csv` where the column `over` has the value of row i; each trial is a case with
//! gradients, in the store like any other. Where no deviations are stated, they follow from what the fit leaves.

mod error;
mod model;
mod outcome;
mod written;

pub use error::FitError;
pub use outcome::{FitOutcome, Fitted, FittedRow};

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use nlmodes::least_squares::{SearchError, SearchSettings, least_squares};
use nlmodes_scene::assemble::Structures;

use crate::run::{Settings, StudyObserver, Worker, watched};
use crate::study::Study;
use model::Trials;

/// Changes of the variables in one step at most, and at the end, over their values at the start: what is left of them
/// is far below what any measurement says.
const SEARCH: SearchSettings =
    SearchSettings { largest_step: 0.3, smallest_step: 1e-6, indistinct: 1e-12, max_steps: 40 };

/// Fits the variables of the study to its measured points.
///
/// # Errors
/// [`FitError`].
pub fn fit(study: &Study, settings: &Settings, observer: &mut dyn StudyObserver) -> Result<FitOutcome, FitError> {
    let (ended, structures) = (Arc::new(AtomicBool::new(false)), Structures::within(settings.limit()));
    let cases = Worker { study, settings, ended: &ended, structures: &structures };
    watched(&ended, observer, || found(study, &cases)).unwrap_or(Err(FitError::Ended))
}

fn found(study: &Study, cases: &Worker<'_>) -> Result<FitOutcome, FitError> {
    let measured = study.fit.as_ref().ok_or(FitError::NothingMeasured)?;
    let mut trials = Trials::new(study, measured, cases)?;
    let (points, parameters) = (trials.n_points(), study.variables.len());
    if points < parameters {
        return Err(FitError::Few { points, parameters });
    }
    let search = least_squares(&vec![1.0; parameters], &SEARCH, &mut trials);
    let minimum = match search {
        Ok(minimum) => minimum,
        Err(SearchError::Model(error)) => return Err(error),
        Err(SearchError::Start) => return Err(FitError::Start { reason: trials.missing }),
        Err(SearchError::Indistinct { along }) => return Err(FitError::indistinct(study, &along)),
        Err(SearchError::Linalg(source)) => return Err(FitError::Linalg(source)),
        Err(_) => return Err(FitError::Ended),
    };
    FitOutcome::new(study, measured, &mut trials, &minimum)
}
