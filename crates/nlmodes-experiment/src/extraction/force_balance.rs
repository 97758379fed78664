//! The force at the stop from the motion: what the equations of the linear modes lack.
//!
//! ```text
//! (ω_k² − (nω)² + 2iζ_k ω_k nω) η_k,n = φ_k(drive) F_n − φ_k(stop) Λ_n      of each mode k and harmonic n
//! x_i,n = Σ_k φ_k(i) (φ_k(drive) F_n − φ_k(stop) Λ_n) / Z_k(nω)
//! ```
//!
//! The second ones, of each place i, take the place of the first where there are fewer places than modes. Each equation
//! gives each harmonic of the force; they are averaged, each weighted by what noise of the sensors and errors of the
//! modes leave of it: near its frequency a mode counts most. The mean is the one with which the force rests between
//! contacts.

mod draws;
mod equations;
mod figures;

use nlmodes_modal::LinearModes;
use num_complex::Complex64;

use crate::extraction::blocks::Blocks;
use crate::extraction::layout::{Place, displacement};
use crate::extraction::{ModeErrors, Stop};

pub use figures::BalanceFigures;

/// What the force is taken from.
pub struct ForceBalance<'a> {
    /// The modes at all positions of their table.
    pub modes: &'a LinearModes,
    /// How well they are known.
    pub errors: ModeErrors,
    /// Relative standard errors of the sensitivities of all channels.
    pub sensors: Vec<f64>,
    /// Places of the motion, in the order of `rows`.
    pub places: &'a [Place],
    /// Rows of the modes at these places.
    pub rows: Vec<usize>,
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
    modes: LinearModes,
    /// At the places of the motion, where these tell all modes apart.
    at_places: Option<LinearModes>,
    drive: Vec<f64>,
    /// Toward the stop.
    stop: Vec<f64>,
}

/// Harmonics 1, 2 … of the force, with the weight of each equation in them.
struct Harmonics {
    force: Vec<Complex64>,
    /// Share of each equation in the harmonics, harmonic by harmonic.
    shares: Vec<Vec<Complex64>>,
    /// Squared standard errors by noise, and by the errors of the modes.
    by_noise: Vec<f64>,
    by_modes: Vec<f64>,
}

impl ForceBalance<'_> {
    fn side(&self) -> f64 {
        if self.settings.positive { 1.0 } else { -1.0 }
    }

    /// The rows of a table of modes at all positions.
    fn table(&self, modes: LinearModes) -> Table {
        let n = modes.n_modes();
        let row = |d: usize, factor: f64| (0..n).map(|k| factor * modes.shape(d, k)).collect::<Vec<_>>();
        let drive = self.drive.map_or_else(|| vec![0.0; n], |(d, _)| row(d, 1.0));
        let stop = row(self.stop, self.side());
        let at_places = (self.rows.len() >= n).then(|| modes.restricted(&self.rows, n).ok()).flatten();
        Table { at_places, drive, stop, modes }
    }

    /// Highest harmonic.
    fn last(&self) -> usize {
        self.blocks.all.first().map_or(0, |q| q.len().saturating_sub(1))
    }

    /// Displacement at the places in a harmonic.
    fn motion(&self, q: &[Vec<Complex64>], n: usize) -> Vec<Complex64> {
        self.places.iter().map(|place| displacement(place, q, &self.blocks.noise, self.omega, n)).collect()
    }

    /// The harmonics from all periods, with the shares of the equations.
    fn harmonics(&self, table: &Table) -> Harmonics {
        let mut found = Harmonics { force: vec![], shares: vec![], by_noise: vec![], by_modes: vec![] };
        let projected = self.unit_projections(table);
        for n in 1..=self.last() {
            let equations = self.equations(table, &self.blocks.all, n);
            let noise = self.noise(table, &projected, n);
            let rough = equations.solved(&equations.shares(&noise));
            let modes = self.mode_errors(table, &projected, &equations, rough, n);
            let both: Vec<f64> = noise.iter().zip(&modes).map(|(noise, modes)| noise + modes).collect();
            let shares = equations.shares(&both);
            let variance = |of: &[f64]| shares.iter().zip(of).map(|(share, of)| share.norm_sqr() * of).sum::<f64>();
            found.force.push(equations.solved(&shares));
            found.by_noise.push(variance(&noise));
            found.by_modes.push(variance(&modes));
            found.shares.push(shares);
        }
        found
    }

    /// The harmonics of other coefficients or modes with the same shares.
    fn again(&self, table: &Table, q: &[Vec<Complex64>], shares: &[Vec<Complex64>]) -> Vec<Complex64> {
        shares.iter().enumerate().map(|(n, shares)| self.equations(table, q, n + 1).solved(shares)).collect()
    }
}
