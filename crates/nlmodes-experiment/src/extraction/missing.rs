//! What modes beyond those that the sensors tell apart add to the motion, by the forces that drive them.
//!
//! ```text
//! η_k,n = (φ_k(drive) F_n − φ_k(stop) Λ_n) / (ω_k² − (nω)² + 2iζ_k ω_k nω)
//! ```
//!
//! They follow the forces nearly as springs do, so that they are known from these where no sensor tells them.

use nlmodes_modal::LinearModes;
use num_complex::Complex64;

/// The modes that are left over.
#[derive(Debug, Clone)]
pub struct Missing {
    omegas: Vec<f64>,
    damping_ratios: Vec<f64>,
    /// At the places of the motion, place by place.
    entries: Vec<Vec<f64>>,
    drive: Vec<f64>,
    /// Toward the stop.
    stop: Vec<f64>,
    /// Channels of the exciting force and of that at the stop, with the side of the stop.
    channels: (usize, Option<(usize, f64)>),
    /// Share of them that is taken: all, but for their error.
    share: f64,
}

impl Missing {
    /// Those behind the first `known` ones; `rows` are those of the places, `drive` and `stop` those of the forces with
    /// their channels.
    pub fn new(
        modes: &LinearModes,
        known: usize,
        rows: &[usize],
        drive: (usize, usize),
        stop: Option<(usize, usize, f64)>,
    ) -> Self {
        let row = |d: usize, factor: f64| (known..modes.n_modes()).map(|k| factor * modes.shape(d, k)).collect();
        let side = stop.map_or(0.0, |(_, _, side)| side);
        Self {
            omegas: modes.omegas()[known..].to_vec(),
            damping_ratios: modes.damping_ratios()[known..].to_vec(),
            entries: rows.iter().map(|d| row(*d, 1.0)).collect(),
            drive: row(drive.0, 1.0),
            stop: row(stop.map_or(0, |(d, _, _)| d), side),
            channels: (drive.1, stop.map(|(_, channel, side)| (channel, side))),
            share: 1.0,
        }
    }

    /// The same, larger by a share.
    #[must_use]
    pub fn larger_by(&self, share: f64) -> Self {
        Self { share: 1.0 + share, ..self.clone() }
    }

    /// Their coordinates in harmonic `n` of the coefficients (channels × harmonics), m·√kg; `omega` in rad/s.
    pub fn coordinates(&self, coefficients: &[Vec<Complex64>], n: usize, omega: f64) -> Vec<Complex64> {
        let (force, contact) = self.channels;
        let at = n as f64 * omega;
        let force = coefficients[force][n];
        // A stop pushes back: its force is positive away from it.
        let contact = contact.map_or(Complex64::default(), |(channel, side)| coefficients[channel][n] * side.abs());
        let of = |k: usize| {
            let (own, zeta) = (self.omegas[k], self.damping_ratios[k]);
            let impedance = Complex64::new(own * own - at * at, 2.0 * zeta * own * at);
            self.share * (self.drive[k] * force - self.stop[k] * contact) / impedance
        };
        (0..self.omegas.len()).map(of).collect()
    }

    /// Displacement at a place by these coordinates, m.
    pub fn at(&self, place: usize, coordinates: &[Complex64]) -> Complex64 {
        self.entries[place].iter().zip(coordinates).map(|(entry, eta)| entry * eta).sum()
    }

    /// Power that their damping takes in harmonic `n`, W.
    pub fn dissipated(&self, coordinates: &[Complex64], n: usize, omega: f64) -> f64 {
        let rates = self.omegas.iter().zip(&self.damping_ratios).map(|(own, zeta)| own * zeta);
        (n as f64 * omega).powi(2) * rates.zip(coordinates).map(|(rate, eta)| rate * eta.norm_sqr()).sum::<f64>()
    }
}
