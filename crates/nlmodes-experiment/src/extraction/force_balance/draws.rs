//! The force with modes that are off by their errors, drawn by lot.

use nlmodes_modal::LinearModes;
use num_complex::Complex64;
use rand::SeedableRng;
use rand::rngs::Xoshiro256PlusPlus;
use rand_distr::{Distribution, StandardNormal};

use super::ForceBalance;

/// Number of draws: their standard deviation is known to 4 %.
const DRAWS: usize = 400;

/// Seed of the draws: they are the same in each run.
const SEED: u64 = 1;

impl ForceBalance<'_> {
    /// Harmonics of the force with modes and sensors that are each off by its own error.
    pub(super) fn drawn(&self, shares: &[Vec<Complex64>]) -> Vec<Vec<Complex64>> {
        let errors = self.errors;
        let is_exact = errors.frequency == 0.0 && errors.damping == 0.0 && errors.shape == 0.0;
        if is_exact && self.sensors.iter().all(|error| *error == 0.0) {
            return vec![];
        }
        let mut random = Xoshiro256PlusPlus::seed_from_u64(SEED);
        let draw = |_| {
            let table = self.table(self.off(&mut random)?);
            let scaled = |(q, error): (&Vec<Complex64>, &f64)| {
                let normal: f64 = if *error > 0.0 { StandardNormal.sample(&mut random) } else { 0.0 };
                q.iter().map(|q| q * (1.0 + error * normal)).collect()
            };
            let coefficients: Vec<Vec<Complex64>> = self.blocks.all.iter().zip(&self.sensors).map(scaled).collect();
            Some(self.again(&table, &coefficients, shares))
        };
        (0..DRAWS).filter_map(draw).collect()
    }

    fn off(&self, random: &mut Xoshiro256PlusPlus) -> Option<LinearModes> {
        let (modes, errors) = (self.modes, self.errors);
        let mut of = |value: &f64, error: f64| {
            let normal: f64 = StandardNormal.sample(random);
            value * (1.0 + error * normal)
        };
        let omegas: Vec<f64> = modes.omegas().iter().map(|omega| of(omega, errors.frequency)).collect();
        let damping: Vec<f64> = modes.damping_ratios().iter().map(|zeta| of(zeta, errors.damping).max(0.0)).collect();
        let mut shapes = Vec::with_capacity(modes.n_coordinates());
        for d in 0..modes.n_coordinates() {
            shapes.push((0..modes.n_modes()).map(|k| of(&modes.shape(d, k), errors.shape)).collect());
        }
        LinearModes::new(modes.positions(), &omegas, &damping, &shapes).ok()
    }
}
