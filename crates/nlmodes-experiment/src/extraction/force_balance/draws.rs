//! The force with modes that are off by their errors, drawn by lot.

use nlmodes_modal::LinearModes;
use num_complex::Complex64;

use super::ForceBalance;

/// Number of draws: their standard deviation is known to a tenth.
const DRAWS: usize = 40;

/// Normal random numbers, the same in each run.
struct Normal(u64);

impl Normal {
    fn uniform(&mut self) -> f64 {
        // xorshift64*
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11) as f64 / (1u64 << 53) as f64
    }

    fn draw(&mut self) -> f64 {
        let (a, b) = (self.uniform().max(f64::MIN_POSITIVE), self.uniform());
        (-2.0 * a.ln()).sqrt() * (std::f64::consts::TAU * b).cos()
    }
}

impl ForceBalance<'_> {
    /// Harmonics of the force with modes that are each off by its own error.
    pub(super) fn drawn(&self, shares: &[Vec<f64>]) -> Vec<Vec<Complex64>> {
        let errors = self.errors;
        if errors.frequency == 0.0 && errors.damping == 0.0 && errors.shape == 0.0 {
            return vec![];
        }
        let mut normal = Normal(0x9E37_79B9_7F4A_7C15);
        let draw = |_| {
            let table = self.table(&self.off(&mut normal)?)?;
            Some(self.again(&table, &self.blocks.all, shares))
        };
        (0..DRAWS).filter_map(draw).collect()
    }

    fn off(&self, normal: &mut Normal) -> Option<LinearModes> {
        let (modes, errors) = (self.modes, self.errors);
        let mut of = |value: &f64, error: f64| value * (1.0 + error * normal.draw());
        let omegas: Vec<f64> = modes.omegas().iter().map(|omega| of(omega, errors.frequency)).collect();
        let damping: Vec<f64> = modes.damping_ratios().iter().map(|zeta| of(zeta, errors.damping).max(0.0)).collect();
        let mut shapes = Vec::with_capacity(modes.n_coordinates());
        for d in 0..modes.n_coordinates() {
            shapes.push((0..modes.n_modes()).map(|k| of(&modes.shape(d, k), errors.shape)).collect());
        }
        LinearModes::new(modes.positions(), &omegas, &damping, &shapes).ok()
    }
}
