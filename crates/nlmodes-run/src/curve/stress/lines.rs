//! Stress along rods and beams.

use std::f64::consts::TAU;

use nlmodes::fem::{FemError, StressRow};
use nlmodes::modal::{HarmonicCoefficients, PeakStress};
use nlmodes_scene::assemble::Body;
use nlmodes_scene::scene::{Scene, Thermal};
use num_complex::Complex64;

use super::instants;

/// The places of rods and beams at which stress is recovered.
pub struct Lines {
    rows: Vec<StressRow>,
    /// Strain that heat causes without stress.
    heat: f64,
}

impl Lines {
    /// Of the structures of a scene; none where the height of a section is not known.
    ///
    /// # Errors
    /// [`FemError`]; a checked scene gives no reason for that.
    pub fn of(scene: &Scene) -> Result<Option<Self>, FemError> {
        let mut rows = Vec::new();
        for body in Body::all(scene.structure.bodies())? {
            let Some(own) = body.elements.stress_rows(body.model.dofs()) else { return Ok(None) };
            rows.extend(own.into_iter().map(|mut row| {
                row.weights.iter_mut().for_each(|weight| weight.0 += body.first);
                row
            }));
        }
        let heat = match scene.static_loads.thermal {
            Some(Thermal::Strain { expansion, temperature }) => expansion * temperature,
            _ => 0.0,
        };
        Ok(Some(Self { rows, heat }))
    }

    /// The degrees of freedom that are needed, ascending.
    pub fn dofs(&self) -> Vec<usize> {
        let mut all: Vec<usize> = self.rows.iter().flat_map(|row| row.weights.iter().map(|weight| weight.0)).collect();
        all.sort_unstable();
        all.dedup();
        all
    }

    /// The largest stress over a period of a motion of these degrees of freedom, and its position along the axis.
    pub fn largest(&self, dofs: &[usize], motion: &HarmonicCoefficients) -> Option<PeakStress> {
        let count = instants(motion.n_harmonics());
        let turns: Vec<Complex64> = (0..count).map(|k| Complex64::cis(TAU * k as f64 / count as f64)).collect();
        let mut found: Option<PeakStress> = None;
        for row in &self.rows {
            let mut series = vec![Complex64::default(); motion.n_harmonics() + 1];
            for (dof, weight) in &row.weights {
                let own = motion.of(dofs.binary_search(dof).ok()?);
                series.iter_mut().zip(own).for_each(|(sum, q)| *sum += q * *weight);
            }
            series[0] -= row.youngs_modulus * self.heat;
            let at = |k: usize| series.iter().enumerate().map(|(n, z)| (z * turns[n * k % count]).re).sum::<f64>();
            let stress = (0..count).map(|k| at(k).abs()).fold(0.0, f64::max);
            if found.is_none_or(|found| stress > found.stress) {
                found = Some(PeakStress { stress, at: row.position });
            }
        }
        found
    }
}
