//! Mutual consistency of the responses: each channel compared with all others, at the same position and through the
//! linear modes.
//!
//! ```text
//! min_η Σ_i |x_i − φ_i η|²/σ_i² + Σ_k |η_k|²/τ_k²
//! ```
//!
//! `x_i` is the fundamental of the displacement from channel `i`, `σ_i` its calibration and noise. Modes far from the
//! frequency `ω` follow a force as static ones do, so that `τ_k` falls with `ω²/|ω_k² − ω²|`; the nearest mode is free.
//! Channels at a place without a row of the modes share an unknown of their own.

use nalgebra::{DMatrix, DVector};
use nlmodes_modal::LinearModes;
use num_complex::Complex64;

/// Calibration error of a sensor of which none was stated, relative.
const CALIBRATION: f64 = 0.05;
/// Error of a mode shape over its largest entry.
const SHAPE_ERROR: f64 = 2e-3;
/// Modal coordinates of other modes over that of the nearest one, in parts of `ω²/|ω_k² − ω²|`.
const OTHER_MODES: f64 = 3.0;
/// The same at least: no linear mode is known exactly.
const LEAST: f64 = 0.02;
/// Magnitudes of unknowns without information, relative to those of the motion.
const FREE: f64 = 1e3;
/// Entries of a shape below this fraction of its largest one give no information on the amplitude of its mode.
const NODE: f64 = 0.01;

/// The fundamental from one channel.
#[derive(Debug, Clone)]
pub struct Row {
    /// Number of the channel.
    pub channel: usize,
    /// Number of the place.
    pub place: usize,
    /// Row of the linear modes.
    pub shape: Option<usize>,
    /// Displacement, m.
    pub value: Complex64,
    /// Standard deviation from noise, m.
    pub noise: f64,
    /// Relative error of its calibration, where that was stated.
    pub calibration: Option<f64>,
}

impl Row {
    fn calibration(&self) -> f64 {
        self.calibration.unwrap_or(CALIBRATION)
    }
}

/// The motion that some of the rows have in common.
#[derive(Debug)]
#[non_exhaustive]
pub struct Common {
    /// Sum of the squared residuals, relative to the expected one.
    pub misfit: f64,
    /// Expected displacement of every row with its standard deviation.
    pub expected: Vec<(Complex64, f64)>,
}

/// All rows, and the modes that connect them.
#[derive(Debug)]
pub struct Consensus<'a> {
    pub rows: Vec<Row>,
    pub modes: Option<&'a LinearModes>,
    pub omega: f64,
}

impl Consensus<'_> {
    /// The motion that the rows `used` have in common; `None` without rows.
    pub fn common(&self, used: &[usize]) -> Option<Common> {
        if used.is_empty() {
            return None;
        }
        let free = self.free_places();
        let n_modes = self.modes.map_or(0, LinearModes::n_modes);
        let entries = |row: &Row| {
            let mut entries = DVector::zeros(n_modes + free.len());
            match (row.shape, self.modes) {
                (Some(d), Some(modes)) => (0..n_modes).for_each(|k| entries[k] = modes.shape(d, k)),
                _ => free
                    .iter()
                    .position(|place| *place == row.place)
                    .into_iter()
                    .for_each(|k| entries[n_modes + k] = 1.0),
            }
            entries
        };
        let largest = used.iter().map(|i| self.rows[*i].value.norm()).fold(0.0, f64::max);
        let size = self.size(used).unwrap_or(0.0);
        let mut sizes = self.sizes(size, largest);
        sizes.resize(n_modes + free.len(), FREE * largest);
        let shape_error = self.nearest().map_or(0.0, |m| SHAPE_ERROR * size * self.largest_entry(m));
        let mut matrix = DMatrix::from_diagonal(&DVector::from_iterator(sizes.len(), sizes.iter().map(|s| s.powi(-2))));
        let mut sides = [DVector::zeros(sizes.len()), DVector::zeros(sizes.len())];
        for i in used {
            let (row, a) = (&self.rows[*i], entries(&self.rows[*i]));
            let weight = self.deviation(row, shape_error, largest).powi(-2);
            matrix += weight * &a * a.transpose();
            sides[0] += weight * row.value.re * &a;
            sides[1] += weight * row.value.im * &a;
        }
        let factor = matrix.cholesky()?;
        let [re, im] = sides.map(|side| factor.solve(&side));
        let expected = self.rows.iter().map(|row| {
            let a = entries(row);
            let variance = a.dot(&factor.solve(&a));
            (Complex64::new(a.dot(&re), a.dot(&im)), variance.max(0.0).sqrt().hypot(shape_error))
        });
        let expected: Vec<(Complex64, f64)> = expected.collect();
        let left = |i: &usize| {
            let row = &self.rows[*i];
            (row.value - expected[*i].0).norm_sqr() / self.deviation(row, shape_error, largest).powi(2)
        };
        let priors = sizes.iter().enumerate().map(|(k, s)| (re[k] * re[k] + im[k] * im[k]) / (s * s));
        Some(Common { misfit: used.iter().map(left).sum::<f64>() + priors.sum::<f64>(), expected })
    }

    /// How far a row is from what the others expect, over what both may be off.
    pub fn deviate(&self, row: usize, common: &Common) -> f64 {
        let (value, (expected, error)) = (self.rows[row].value, common.expected[row]);
        let own = self.rows[row].noise.hypot(self.rows[row].calibration() * value.norm());
        let deviate = (value - expected).norm() / own.hypot(error);
        if deviate.is_finite() { deviate } else { 0.0 }
    }

    /// The linear mode next to the frequency.
    fn nearest(&self) -> Option<usize> {
        let distance = |omega: f64| (omega / self.omega).ln().abs();
        let omegas = self.modes?.omegas();
        (0..omegas.len()).min_by(|a, b| distance(omegas[*a]).total_cmp(&distance(omegas[*b])))
    }

    fn largest_entry(&self, mode: usize) -> f64 {
        let entries = self.rows.iter().filter_map(|row| Some(self.modes?.shape(row.shape?, mode).abs()));
        entries.fold(0.0, f64::max)
    }

    /// Modal coordinate of the nearest mode, from the median of what the rows make of it.
    fn size(&self, used: &[usize]) -> Option<f64> {
        let mode = self.nearest()?;
        let least = NODE * self.largest_entry(mode);
        let of = |i: &usize| {
            let entry = self.modes?.shape(self.rows[*i].shape?, mode).abs();
            (entry > least).then(|| self.rows[*i].value.norm() / entry)
        };
        let mut all: Vec<f64> = used.iter().filter_map(of).collect();
        all.sort_by(f64::total_cmp);
        all.get(all.len() / 2).copied().filter(|size| *size > 0.0)
    }

    /// Sizes `τ_k` of the modal coordinates.
    fn sizes(&self, size: f64, largest: f64) -> Vec<f64> {
        let (Some(modes), nearest) = (self.modes, self.nearest()) else { return Vec::new() };
        let of = |(k, omega): (usize, &f64)| {
            let follows = self.omega.powi(2) / (omega.powi(2) - self.omega.powi(2)).abs();
            let share = if Some(k) == nearest { FREE } else { (OTHER_MODES * follows).clamp(LEAST, FREE) };
            if size > 0.0 { share * size } else { FREE * largest / self.largest_entry(k).max(f64::MIN_POSITIVE) }
        };
        modes.omegas().iter().enumerate().map(of).collect()
    }

    /// Places without a row of the modes.
    fn free_places(&self) -> Vec<usize> {
        let mut places: Vec<usize> = Vec::new();
        for row in self.rows.iter().filter(|row| row.shape.is_none() || self.modes.is_none()) {
            if !places.contains(&row.place) {
                places.push(row.place);
            }
        }
        places
    }

    fn deviation(&self, row: &Row, shape_error: f64, largest: f64) -> f64 {
        let shape_error = if row.shape.is_some() { shape_error } else { 0.0 };
        (row.calibration() * row.value.norm())
            .hypot(row.noise)
            .hypot(shape_error)
            .max(1e-9 * largest)
            .max(f64::MIN_POSITIVE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(place: usize, shape: Option<usize>, value: Complex64, noise: f64) -> Row {
        Row { channel: place, place, shape, value, noise, calibration: None }
    }

    /// Two sensors at the same position have their variance-weighted mean, and their distance is their difference
    /// relative to its standard deviation.
    #[test]
    fn sensors_at_one_place_have_their_weighted_mean_in_any_unit() {
        for unit in [1.0, 1e-9, 1e4] {
            let (a, b) = (Complex64::new(1.0, 0.3) * unit, Complex64::new(1.2, 0.2) * unit);
            let rows = vec![row(0, None, a, 0.02 * unit), row(0, None, b, 0.1 * unit)];
            let consensus = Consensus { rows, modes: None, omega: 7.0 };
            let squares = [(a, 0.02), (b, 0.1)].map(|(x, noise)| (0.05 * x.norm()).powi(2) + (noise * unit).powi(2));
            let [wa, wb] = squares.map(f64::recip);
            // Quantities without information get a thousandth of the largest weight.
            let prior = (1e3 * b.norm()).powi(-2);
            let common = consensus.common(&[0, 1]).unwrap();
            let (mean, error) = common.expected[1];
            let near = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-9, "{unit:e}: {a:e}, not {b:e}");
            near((mean / ((a * wa + b * wb) / (wa + wb + prior))).re, 1.0);
            near(error, (wa + wb + prior).sqrt().recip());
            let left = wa * (a - mean).norm_sqr() + wb * (b - mean).norm_sqr();
            near(common.misfit, left + prior * mean.norm_sqr());
            let alone = consensus.common(&[0]).unwrap();
            let off = (b - alone.expected[1].0).norm() / (squares[1] + alone.expected[1].1.powi(2)).sqrt();
            near(consensus.deviate(1, &alone), off);
        }
    }

    /// Shapes in another unit of mass have modal coordinates in the inverse one: what is expected of a sensor stays.
    #[test]
    fn what_modes_expect_does_not_depend_on_their_norm() {
        let found = |norm: f64| {
            let shapes = [[0.2, -0.5], [0.6, -0.9], [1.0, 0.1], [1.4, 1.3]].map(|row| row.map(|y| norm * y).to_vec());
            let modes = LinearModes::new(&[0.1, 0.2, 0.3, 0.4], &[100.0, 600.0], &[0.01; 2], &shapes).unwrap();
            // The first mode with a little of the second, the last sensor twice too large.
            let value =
                |d: usize| (modes.shape(d, 0) + 0.01 * modes.shape(d, 1)) / norm * if d == 3 { 2.0 } else { 1.0 };
            let rows = (0..4).map(|d| row(d, Some(d), Complex64::from(1e-3 * value(d)), 1e-7)).collect();
            let consensus = Consensus { rows, modes: Some(&modes), omega: 105.0 };
            let common = consensus.common(&[0, 1, 2]).unwrap();
            let expected = common.expected.iter().flat_map(|(x, error)| [x.re, *error]);
            let off = (0..4).map(|i| consensus.deviate(i, &common));
            (expected.chain(off).collect::<Vec<f64>>(), common)
        };
        let (usual, common) = found(1.0);
        // Of the last sensor twice what the others expect of it, to the calibration of these.
        let last = 1e-3 * (1.4 + 0.013);
        assert!((common.expected[3].0.re / last - 1.0).abs() < 0.05, "{:?}", common.expected);
        assert!(usual[8..11].iter().all(|off| *off < 1.0) && usual[11] > 4.0, "{usual:?}");
        for norm in [1e-3, 30.0] {
            for (a, b) in found(norm).0.iter().zip(&usual) {
                assert!((a - b).abs() < 1e-6 * b.abs().max(1e-6), "{norm}: {a:e}, not {b:e}");
            }
        }
    }
}
