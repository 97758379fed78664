//! The force at the stop from the motion: what the equations of the linear modes lack.
//!
//! ```text
//! (ω_k² − (nω)² + 2iζ_k ω_k nω) η_k,n = φ_k(drive) F_n − φ_k(stop) Λ_n      of each mode k and harmonic n
//! ```
//!
//! Each mode gives each harmonic of the force; they are averaged, each weighted by what noise of the sensors and errors
//! of the modes leave of it: near its frequency a mode counts most. The mean is the one with which the force rests
//! between contacts.

mod draws;
mod figures;

use nlmodes_modal::LinearModes;
use num_complex::Complex64;

use crate::extraction::blocks::Blocks;
use crate::extraction::layout::{Place, displacement, displacement_noise};
use crate::extraction::{ModeErrors, Stop};

pub use figures::BalanceFigures;

/// What the force is taken from.
pub struct ForceBalance<'a> {
    /// The modes at all positions of their table.
    pub modes: &'a LinearModes,
    /// How well they are known.
    pub errors: ModeErrors,
    /// Places of the motion, in the order of `rows`.
    pub places: &'a [Place],
    /// Rows of the modes at these places.
    pub rows: Vec<usize>,
    /// Number of modes that the places tell apart.
    pub n_modes: usize,
    /// Row of the drive point and the channel of the force there, if there is one.
    pub drive: Option<(usize, usize)>,
    /// Row of the stop.
    pub stop: usize,
    pub settings: Stop,
    pub blocks: &'a Blocks,
    pub omega: f64,
    pub n_samples: usize,
}

/// The modes at the places, the drive point and the stop.
struct Table {
    at_places: LinearModes,
    drive: Vec<f64>,
    /// Toward the stop.
    stop: Vec<f64>,
}

/// Harmonics 1, 2 … of the force, with the weight of each mode in them.
struct Harmonics {
    force: Vec<Complex64>,
    /// Share of each mode in the harmonics, harmonic by harmonic.
    shares: Vec<Vec<f64>>,
    /// Squared standard errors by noise, and by the errors of the modes.
    by_noise: Vec<f64>,
    by_modes: Vec<f64>,
}

impl ForceBalance<'_> {
    fn side(&self) -> f64 {
        if self.settings.positive { 1.0 } else { -1.0 }
    }

    /// The rows of a table of modes at all positions.
    fn table(&self, modes: &LinearModes) -> Option<Table> {
        let row = |d: usize, factor: f64| (0..self.n_modes).map(|k| factor * modes.shape(d, k)).collect();
        Some(Table {
            at_places: modes.restricted(&self.rows, self.n_modes).ok()?,
            drive: self.drive.map_or_else(|| vec![0.0; self.n_modes], |(d, _)| row(d, 1.0)),
            stop: row(self.stop, self.side()),
        })
    }

    /// Highest harmonic.
    fn last(&self) -> usize {
        self.blocks.all.first().map_or(0, |q| q.len().saturating_sub(1))
    }

    /// Displacement at the places in a harmonic.
    fn motion(&self, q: &[Vec<Complex64>], n: usize) -> Vec<Complex64> {
        self.places.iter().map(|place| displacement(place, q, &self.blocks.noise, self.omega, n)).collect()
    }

    fn impedance(modes: &LinearModes, k: usize, at: f64) -> Complex64 {
        let (own, zeta) = (modes.omegas()[k], modes.damping_ratios()[k]);
        Complex64::new(own * own - at * at, 2.0 * zeta * own * at)
    }

    /// What each mode lacks in a harmonic: `φ(drive) F − Z η`.
    fn lacks(&self, table: &Table, q: &[Vec<Complex64>], n: usize) -> (Vec<Complex64>, Vec<Complex64>) {
        let eta = table.at_places.project(&self.motion(q, n));
        let force = self.drive.map_or(Complex64::default(), |(_, channel)| q[channel][n]);
        let at = n as f64 * self.omega;
        let lack = |k: usize| table.drive[k] * force - Self::impedance(&table.at_places, k, at) * eta[k];
        let lacks = (0..self.n_modes).map(lack).collect();
        (lacks, eta)
    }

    /// The harmonics from all periods, with the shares of the modes.
    fn harmonics(&self, table: &Table) -> Harmonics {
        let mut found = Harmonics { force: vec![], shares: vec![], by_noise: vec![], by_modes: vec![] };
        let projected = self.unit_projections(table);
        for n in 1..=self.last() {
            let (lacks, eta) = self.lacks(table, &self.blocks.all, n);
            let noise = self.noise(table, &projected, n);
            let modes = self.mode_errors(table, &projected, &eta, n);
            let weight = |k: usize| table.stop[k] / (noise[k] + modes[k]).max(f64::MIN_POSITIVE);
            let sum: f64 = (0..self.n_modes).map(|k| weight(k) * table.stop[k]).sum();
            let shares: Vec<f64> = (0..self.n_modes).map(|k| if sum > 0.0 { weight(k) / sum } else { 0.0 }).collect();
            let variance = |of: &[f64]| shares.iter().zip(of).map(|(share, of)| share * share * of).sum::<f64>();
            found.force.push(shares.iter().zip(&lacks).map(|(share, lack)| lack * *share).sum());
            found.by_noise.push(variance(&noise));
            found.by_modes.push(variance(&modes));
            found.shares.push(shares);
        }
        found
    }

    /// The harmonics of other coefficients or modes with the same shares.
    fn again(&self, table: &Table, q: &[Vec<Complex64>], shares: &[Vec<f64>]) -> Vec<Complex64> {
        let of = |(n, shares): (usize, &Vec<f64>)| {
            let (lacks, _) = self.lacks(table, q, n + 1);
            let sum: f64 = shares.iter().zip(&table.stop).map(|(share, stop)| share * stop).sum();
            shares.iter().zip(&lacks).map(|(share, lack)| lack * *share).sum::<Complex64>() / sum
        };
        shares.iter().enumerate().map(of).collect()
    }

    /// Modal coordinates of a unit displacement at each place.
    fn unit_projections(&self, table: &Table) -> Vec<Vec<f64>> {
        let unit = |d: usize| {
            let motion: Vec<Complex64> =
                (0..self.places.len()).map(|i| if i == d { 1.0 } else { 0.0 }.into()).collect();
            table.at_places.project(&motion).iter().map(|eta| eta.re).collect()
        };
        (0..self.places.len()).map(unit).collect()
    }

    /// Squared errors that noise of the sensors leaves of what the modes lack.
    fn noise(&self, table: &Table, projected: &[Vec<f64>], n: usize) -> Vec<f64> {
        let at = n as f64 * self.omega;
        let sigma = |place: &Place| displacement_noise(place, &self.blocks.noise, self.omega, n, self.n_samples);
        let sigmas: Vec<f64> = self.places.iter().map(sigma).collect();
        let force = self.drive.map_or(0.0, |(_, channel)| self.blocks.noise[channel]);
        let of_force = 2.0 / self.n_samples as f64 * force * force;
        let of = |k: usize| {
            let eta: f64 = projected.iter().zip(&sigmas).map(|(unit, sigma)| (unit[k] * sigma).powi(2)).sum();
            Self::impedance(&table.at_places, k, at).norm_sqr() * eta + table.drive[k].powi(2) * of_force
        };
        (0..self.n_modes).map(of).collect()
    }

    /// Squared errors that frequencies, damping ratios and shapes leave of what the modes lack.
    fn mode_errors(&self, table: &Table, projected: &[Vec<f64>], eta: &[Complex64], n: usize) -> Vec<f64> {
        let at = n as f64 * self.omega;
        let modes = &table.at_places;
        let ModeErrors { frequency, damping, shape } = self.errors;
        // Errors of a shape are a share of its size there.
        let moved = |d: usize| (0..self.n_modes).map(|j| (shape * modes.shape(d, j)).powi(2) * eta[j].norm_sqr()).sum();
        let moved: Vec<f64> = (0..self.places.len()).map(moved).collect();
        let of = |k: usize| {
            let (own, zeta) = (modes.omegas()[k], modes.damping_ratios()[k]);
            let size = eta[k].norm_sqr();
            let by_shape: f64 = projected.iter().zip(&moved).map(|(unit, moved)| unit[k] * unit[k] * moved).sum();
            (2.0 * own * own * frequency).powi(2) * size
                + (2.0 * zeta * own * at * damping).powi(2) * size
                + Self::impedance(modes, k, at).norm_sqr() * by_shape
        };
        (0..self.n_modes).map(of).collect()
    }
}
