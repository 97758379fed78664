//! The equations of one harmonic of the force: of the modes, or, where the places do not tell all modes apart, of the
//! places.

use nlmodes_modal::LinearModes;
use num_complex::Complex64;

use super::{ForceBalance, Table};
use crate::extraction::ModeErrors;
use crate::extraction::layout::{Place, displacement_noise};

/// `a Λ = b` of each mode or place.
pub(super) struct Equations {
    factors: Vec<Complex64>,
    sides: Vec<Complex64>,
    /// Modal coordinates, of the equations of modes.
    eta: Vec<Complex64>,
    /// Harmonic of the exciting force, N.
    force: Complex64,
}

impl Equations {
    /// Weights that make the force of all equations, for squared errors of their sides.
    pub fn shares(&self, errors: &[f64]) -> Vec<Complex64> {
        let weight = |(factor, error): (&Complex64, &f64)| factor.conj() / error.max(f64::MIN_POSITIVE);
        let weights: Vec<Complex64> = self.factors.iter().zip(errors).map(weight).collect();
        let sum: Complex64 = weights.iter().zip(&self.factors).map(|(weight, factor)| weight * factor).sum();
        let share = |weight: &Complex64| if sum.re > 0.0 { weight / sum.re } else { Complex64::default() };
        weights.iter().map(share).collect()
    }

    /// The force with these shares, N.
    pub fn solved(&self, shares: &[Complex64]) -> Complex64 {
        let of = |values: &[Complex64]| shares.iter().zip(values).map(|(share, x)| share * x).sum::<Complex64>();
        let sum = of(&self.factors);
        if sum == Complex64::default() { sum } else { of(&self.sides) / sum }
    }
}

fn impedance(modes: &LinearModes, k: usize, at: f64) -> Complex64 {
    let (own, zeta) = (modes.omegas()[k], modes.damping_ratios()[k]);
    Complex64::new(own * own - at * at, 2.0 * zeta * own * at)
}

impl ForceBalance<'_> {
    pub(super) fn equations(&self, table: &Table, q: &[Vec<Complex64>], n: usize) -> Equations {
        let at = n as f64 * self.omega;
        let force = self.drive.map_or(Complex64::default(), |(_, channel)| q[channel][n]);
        let motion = self.motion(q, n);
        let Some(modes) = &table.at_places else {
            let of = |shape: &[f64]| self.receptances(table, shape, at);
            let (drive, stop) = (of(&table.drive), of(&table.stop));
            let sides = drive.iter().zip(&motion).map(|(drive, x)| drive * force - x).collect();
            return Equations { factors: stop, sides, eta: vec![], force };
        };
        let eta = modes.project(&motion);
        let side = |k: usize| table.drive[k] * force - impedance(modes, k, at) * eta[k];
        let sides = (0..eta.len()).map(side).collect();
        let factors = table.stop.iter().map(|stop| Complex64::from(*stop)).collect();
        Equations { factors, sides, eta, force }
    }

    /// Displacement at each place by a unit force where the modes have these entries, m/N.
    fn receptances(&self, table: &Table, shape: &[f64], at: f64) -> Vec<Complex64> {
        let of = |row: &usize| {
            let term = |k: usize| table.modes.shape(*row, k) * shape[k] / impedance(&table.modes, k, at);
            (0..shape.len()).map(term).sum()
        };
        self.rows.iter().map(of).collect()
    }

    /// Displacement toward the stop that both forces give there, m.
    pub(super) fn at_stop_by_forces(&self, table: &Table, contact: Complex64, n: usize) -> Complex64 {
        let at = n as f64 * self.omega;
        let force = self.drive.map_or(Complex64::default(), |(_, channel)| self.blocks.all[channel][n]);
        let term = |k: usize| {
            table.stop[k] * (table.drive[k] * force - table.stop[k] * contact) / impedance(&table.modes, k, at)
        };
        (0..table.stop.len()).map(term).sum()
    }

    /// Modal coordinates of a unit displacement at each place; none where the places do not tell the modes apart.
    pub(super) fn unit_projections(&self, table: &Table) -> Vec<Vec<f64>> {
        let Some(modes) = &table.at_places else { return vec![] };
        let unit = |d: usize| {
            let motion: Vec<Complex64> =
                (0..self.places.len()).map(|i| if i == d { 1.0 } else { 0.0 }.into()).collect();
            modes.project(&motion).iter().map(|eta| eta.re).collect()
        };
        (0..self.places.len()).map(unit).collect()
    }

    /// Squared errors that noise of the sensors leaves of the sides.
    pub(super) fn noise(&self, table: &Table, projected: &[Vec<f64>], n: usize) -> Vec<f64> {
        let at = n as f64 * self.omega;
        let sigma = |place: &Place| displacement_noise(place, &self.blocks.noise, self.omega, n, self.n_samples);
        let sigmas: Vec<f64> = self.places.iter().map(sigma).collect();
        let force = self.drive.map_or(0.0, |(_, channel)| self.blocks.noise[channel]);
        let of_force = 2.0 / self.n_samples as f64 * force * force;
        let Some(modes) = &table.at_places else {
            let drive = self.receptances(table, &table.drive, at);
            return sigmas
                .iter()
                .zip(drive)
                .map(|(sigma, drive)| sigma * sigma + drive.norm_sqr() * of_force)
                .collect();
        };
        let of = |k: usize| {
            let eta: f64 = projected.iter().zip(&sigmas).map(|(unit, sigma)| (unit[k] * sigma).powi(2)).sum();
            impedance(modes, k, at).norm_sqr() * eta + table.drive[k].powi(2) * of_force
        };
        (0..modes.n_modes()).map(of).collect()
    }

    /// Squared errors that frequencies, damping ratios and shapes leave of the sides, with the force as it is roughly
    /// known.
    pub(super) fn mode_errors(
        &self,
        table: &Table,
        projected: &[Vec<f64>],
        equations: &Equations,
        rough: Complex64,
        n: usize,
    ) -> Vec<f64> {
        let at = n as f64 * self.omega;
        let ModeErrors { frequency, damping, shape } = self.errors;
        let Some(modes) = &table.at_places else { return self.place_errors(table, equations.force, rough, at) };
        let (eta, n_modes) = (&equations.eta, modes.n_modes());
        // Errors of a shape are a share of its size there.
        let moved = |d: usize| (0..n_modes).map(|j| (shape * modes.shape(d, j)).powi(2) * eta[j].norm_sqr()).sum();
        let moved: Vec<f64> = (0..self.places.len()).map(moved).collect();
        let of = |k: usize| {
            let (own, zeta) = (modes.omegas()[k], modes.damping_ratios()[k]);
            let size = eta[k].norm_sqr();
            let by_shape: f64 = projected.iter().zip(&moved).map(|(unit, moved)| unit[k] * unit[k] * moved).sum();
            (2.0 * own * own * frequency).powi(2) * size
                + (2.0 * zeta * own * at * damping).powi(2) * size
                + impedance(modes, k, at).norm_sqr() * by_shape
        };
        (0..n_modes).map(of).collect()
    }

    /// The same of the equations of places.
    fn place_errors(&self, table: &Table, force: Complex64, contact: Complex64, at: f64) -> Vec<f64> {
        let ModeErrors { frequency, damping, shape } = self.errors;
        let modes = &table.modes;
        let of = |row: &usize| -> f64 {
            let term = |k: usize| {
                let (own, zeta, entry) = (modes.omegas()[k], modes.damping_ratios()[k], modes.shape(*row, k));
                let (by_drive, by_stop) = (table.drive[k] * force, table.stop[k] * contact);
                let impedance = impedance(modes, k, at).norm_sqr();
                let size = entry * entry * (by_drive - by_stop).norm_sqr() / impedance;
                let of_impedance = (2.0 * own * own * frequency).powi(2) + (2.0 * zeta * own * at * damping).powi(2);
                let ends = entry * entry * (by_drive.norm_sqr() + by_stop.norm_sqr()) / impedance;
                size * (of_impedance / impedance + shape * shape) + shape * shape * ends
            };
            (0..table.stop.len()).map(term).sum()
        };
        self.rows.iter().map(of).collect()
    }
}
