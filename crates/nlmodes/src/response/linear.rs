use nlmodes_continuation::{Linearization, ParametricSystem};
use nlmodes_hbm::{HbmError, PeriodicSystem};
use nlmodes_linalg::DenseLu;
use nlmodes_model::reduction::RestState;

use crate::response::ResponseError;

/// Unknowns of a response at the level zero, of a structure that its stops press or, without `rest`, of one with open
/// contacts.
pub(crate) fn unknowns_at_rest(system: &PeriodicSystem, rest: Option<&RestState>) -> Vec<f64> {
    let mut x = rest.map_or_else(Vec::new, |rest| system.coefficients_at_rest(&rest.eta, &rest.forces));
    x.resize(system.dim(), 0.0);
    x
}

/// The linear motion per unit of the parameter of a response over the level, from these unknowns at rest: they are
/// linear in the level until a contact changes its state.
pub(crate) fn linear_motion(system: &mut PeriodicSystem, rest: &[f64]) -> Result<Vec<f64>, ResponseError> {
    let n = system.dim();
    let mut at = Linearization::new(n);
    system.linearize(rest, 0.0, &mut at)?;
    let square = at.jacobian.subcols(0, n).to_owned();
    let lu = DenseLu::factor(&square)
        .map_err(|source| HbmError::Linalg { what: "the linear response (an undamped resonance?)", source })?;
    let mut x: Vec<f64> = at.jacobian.col(n).iter().map(|v| -v).collect();
    lu.solve_in_place(&mut x);
    Ok(x)
}
