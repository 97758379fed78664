//! Periodic motions of results, and the states on them.

use std::f64::consts::TAU;
use std::path::Path;

use nlmodes::linalg::Mat;
use nlmodes::modal::HarmonicCoefficients;
use nlmodes::response::Weights;
use num_complex::Complex64;

use crate::model::Model;
use crate::verify::{VerifyError, results};

/// A periodic motion of results as its harmonics.
pub struct Motion {
    /// Its angular frequency, rad/s.
    pub omega: f64,
    /// Coefficients of the displacements of the recorded degrees of freedom, m.
    pub coefficients: HarmonicCoefficients,
}

impl Motion {
    /// A displacement (m) at `n` instants of its period, the first after `1/n` of it.
    pub fn samples(&self, of: &Weights, n: usize) -> Vec<f64> {
        let at = |share: f64| -> f64 {
            let turn = |k: usize| Complex64::cis(TAU * share * k as f64);
            let dof = |d: usize| self.coefficients.of(d).iter().enumerate().map(|(k, q)| (turn(k) * q).re).sum::<f64>();
            of.iter().map(|&(d, w)| w * dof(d)).sum()
        };
        (1..=n).map(|k| at(k as f64 / n as f64)).collect()
    }

    /// Reads a point of `harmonics.npz`.
    ///
    /// # Errors
    /// [`VerifyError`] if there is none.
    pub fn read(directory: &Path, point: usize) -> Result<Self, VerifyError> {
        let path = directory.join(results::HARMONICS);
        if !path.is_file() {
            return Err(VerifyError::Missing { name: results::HARMONICS });
        }
        let (omega, coefficients, _) = results::read_motion(&path, point)?;
        Ok(Self { omega, coefficients })
    }
}

/// The state of a motion of the degrees of freedom after a share of its period.
///
/// # Errors
/// Why there is none, in words.
pub fn state_of(motion: &Motion, model: &Model, share: f64) -> Result<Vec<f64>, String> {
    let (n, open) = (motion.coefficients.n_coordinates(), model.open_modes());
    if n != open.n_dofs() || model.recorded.len() != n {
        return Err(format!(
            "harmonics.npz has the motion of {n} of {} degrees of freedom: the state in the modes is not \
             known from these",
            open.n_dofs()
        ));
    }
    let at = |d: usize, order: i32| -> f64 {
        let of = motion.coefficients.of(d).iter().enumerate();
        let turned = |n: usize| Complex64::cis(TAU * share * n as f64);
        of.map(|(n, q)| (Complex64::new(0.0, n as f64 * motion.omega).powi(order) * turned(n) * q).re).sum()
    };
    let moved = |d: usize| model.moved.get(d).copied().unwrap_or(0.0);
    let q = Mat::from_fn(n, 2, |d, j| if j == 0 { at(d, 0) - moved(d) } else { at(d, 1) });
    let eta = open.modal_coordinates(&q).ok_or("the mass of its displacements is not known")?;
    let gaps = open.gaps();
    // The position of a dissipative stop is known while it is touched.
    let stops = model.stop_dampers.iter().map(|&(contact, _)| {
        let toward: f64 = model.contacts[contact].iter().map(|&(dof, w)| q[(dof, 0)] * w).sum();
        (toward - gaps[contact]).max(0.0)
    });
    Ok((0..2).flat_map(|j| eta.col(j).iter().copied().collect::<Vec<f64>>()).chain(stops).collect())
}
