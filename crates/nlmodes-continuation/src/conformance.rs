//! What any [`ParametricSystem`] must pass.

use nlmodes_linalg::Mat;

use crate::{Linearization, ParametricSystem};

/// Largest difference between the Jacobian at `(x, p)` and central differences of the residual with step `h`, over the
/// largest entry of the Jacobian.
///
/// # Errors
/// What the system reports.
pub fn jacobian_defect<S: ParametricSystem>(system: &mut S, x: &[f64], p: f64, h: f64) -> Result<f64, S::Error> {
    let n = system.dim();
    let room = Linearization::for_solver(&*system.solver(), n);
    let (mut at, mut plus, mut minus) = (room.clone(), room.clone(), room);
    system.linearize(x, p, &mut at)?;
    let mut jacobian = Mat::<f64>::zeros(n, n + 1);
    at.each(|i, j, value| jacobian[(i, j)] += value);
    let (mut largest, mut defect) = (f64::MIN_POSITIVE, 0.0_f64);
    for j in 0..=n {
        let shifted = |s: f64| {
            let mut z: Vec<f64> = x.iter().copied().chain([p]).collect();
            z[j] += s;
            z
        };
        let (high, low) = (shifted(h), shifted(-h));
        plus.entries.clear();
        minus.entries.clear();
        system.linearize(&high[..n], high[n], &mut plus)?;
        system.linearize(&low[..n], low[n], &mut minus)?;
        for i in 0..n {
            let difference = (plus.residual[i] - minus.residual[i]) / (2.0 * h);
            largest = largest.max(jacobian[(i, j)].abs());
            defect = defect.max((difference - jacobian[(i, j)]).abs());
        }
    }
    Ok(defect / largest)
}
