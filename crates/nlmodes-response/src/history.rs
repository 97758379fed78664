//! What a contact does over one period, instant by instant.

use std::f64::consts::TAU;

use nlmodes_contact::{LcpMatrix, solver_by_name};
use nlmodes_hbm::{HbmError, PeriodicMotion};
use num_complex::Complex64;

use crate::{ResponseError, ResponseModel};

/// Motions and forces of the contacts over a period, its end included: exact for the harmonics of the motion, since the contact problem is solved
/// at each instant.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactHistory {
    /// Time, s.
    pub time: Vec<f64>,
    /// Displacement of each contact toward its stop, from rest, m: contacts × instants.
    pub displacement: Vec<Vec<f64>>,
    /// Its rate, m/s.
    pub velocity: Vec<Vec<f64>>,
    /// Contact forces, N, not negative.
    pub force: Vec<Vec<f64>>,
}

impl ResponseModel {
    /// The contacts over one period of the motion at `samples + 1` instants; `subharmonic` periods of the load are one of the motion.
    ///
    /// # Errors
    /// [`ResponseError::Problem`] where a contact problem has no solution.
    pub fn contact_history(
        &self,
        motion: &PeriodicMotion,
        subharmonic: usize,
        samples: usize,
    ) -> Result<ContactHistory, ResponseError> {
        let structure = self.structure();
        let (c, samples, omega) = (structure.n_contacts(), samples.max(1), motion.at.omega);
        let y = self.gap_harmonics(motion, subharmonic);
        let failed = |error| ResponseError::Problem(HbmError::Compliance(error));
        let matrix = structure.compliance();
        let mut workspace = solver_by_name("active-set").and_then(|s| s.workspace(matrix)).map_err(failed)?;
        let (mut closed, mut lambda, mut gaps) = (vec![false; c], vec![0.0; c], vec![0.0; c]);
        let empty = || vec![Vec::with_capacity(samples + 1); c];
        let mut history = ContactHistory { time: Vec::new(), displacement: empty(), velocity: empty(), force: empty() };
        for j in 0..=samples {
            let tau = TAU * j as f64 / samples as f64;
            let value = |i: usize| y[i].iter().enumerate().map(|(n, z)| (z * Complex64::cis(n as f64 * tau)).re).sum();
            let rate = |i: usize| -> f64 {
                let one = |(n, z): (usize, &Complex64)| {
                    let nu = n as f64 * omega;
                    (Complex64::new(0.0, nu) * z * Complex64::cis(n as f64 * tau)).re
                };
                y[i].iter().enumerate().map(one).sum()
            };
            let b: Vec<f64> = (0..c).map(value).collect();
            let rates: Vec<f64> = (0..c).map(rate).collect();
            workspace.solve(&b, &mut closed, &mut lambda).map_err(failed)?;
            workspace.gaps(&mut gaps).map_err(failed)?;
            let force_rates = force_rates(matrix, &closed, &rates).map_err(failed)?;
            history.time.push(tau / omega);
            for i in 0..c {
                let own = structure.stop_compliance()[i];
                let gap_rate: f64 = (0..c).map(|k| matrix.a()[(i, k)] * force_rates[k]).sum::<f64>() + rates[i];
                history.displacement[i].push(structure.gaps()[i] - (gaps[i] - own * lambda[i]));
                history.velocity[i].push(own * force_rates[i] - gap_rate);
                history.force[i].push(lambda[i]);
            }
        }
        Ok(history)
    }

    /// Gaps without contact forces of this instant, harmonic by harmonic of each contact.
    fn gap_harmonics(&self, motion: &PeriodicMotion, subharmonic: usize) -> Vec<Vec<Complex64>> {
        let structure = self.structure();
        let omega = motion.at.omega * subharmonic as f64;
        let gap = |i: usize| {
            let mut y: Vec<Complex64> = motion
                .eta
                .iter()
                .map(|eta| eta.iter().enumerate().map(|(k, eta)| eta * structure.rows()[(i, k)]).sum())
                .collect();
            y[0] += structure.gaps()[i];
            for term in self.terms() {
                if let Some(y) = y.get_mut(term.harmonic * subharmonic) {
                    *y += term.gaps[i] * (motion.at.level * omega.powi(term.omega_power));
                }
            }
            y
        };
        (0..structure.n_contacts()).map(gap).collect()
    }
}

/// `dλ/dt = S ẏ` with these contacts closed.
fn force_rates(matrix: &LcpMatrix, closed: &[bool], rates: &[f64]) -> Result<Vec<f64>, nlmodes_contact::LcpError> {
    let c = rates.len();
    if !closed.contains(&true) {
        return Ok(vec![0.0; c]);
    }
    let s = matrix.sensitivity(closed)?;
    Ok((0..c).map(|i| (0..c).map(|k| s[(i, k)] * rates[k]).sum()).collect())
}
