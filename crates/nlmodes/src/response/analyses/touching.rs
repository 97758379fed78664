use nlmodes_contact::LcpSolver;
use nlmodes_continuation::StepSettings;
use nlmodes_hbm::PeriodicSystem;

use crate::response::{ResponseError, ResponseSettings};
use crate::touching::{Closing, NotClosed};

/// [`Closing::unknowns`] of a response.
///
/// # Errors
/// [`ResponseError::NoModeTouching`] where the way does not arrive, [`ResponseError::Stopped`].
pub(super) fn as_gaps_close(
    system: &PeriodicSystem,
    x: &[f64],
    opening: &[f64],
    (settings, solver): (&ResponseSettings, &dyn LcpSolver),
) -> Result<Vec<f64>, ResponseError> {
    let closing = Closing { step: &StepSettings::default(), solver, watch: &settings.watch };
    let most = opening.iter().copied().fold(0.0, f64::max);
    closing.unknowns(system, x, opening, &mut settings.log.clone()).map_err(|failure| match failure {
        NotClosed::Lost { left, why } => NotClosed::Lost { left: left * most, why }.into(),
        failure => failure.into(),
    })
}

impl From<NotClosed> for ResponseError {
    fn from(failure: NotClosed) -> Self {
        match failure {
            NotClosed::Lost { left, why } => Self::NoModeTouching { left, why },
            NotClosed::Ended => Self::Stopped,
            NotClosed::Problem(error) => error.into(),
        }
    }
}
