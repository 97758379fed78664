use nlmodes_continuation::Linearization;
use nlmodes_linalg::{Mat, column_mut};
use num_complex::Complex64;

use super::block::HarmonicBlock;
use crate::series::RealSeries;

/// The Jacobian of a periodic problem with respect to its coefficients, made row by row.
///
/// A complex row `r = L x − G λ̂` with `x = c − i s` is two real ones, those of its cosine and its sine:
/// `Re r = Re(L) c + Im(L) s − …` and `−Im r = −Im(L) c + Re(L) s − …`.
pub(crate) struct Assembly {
    coordinates: usize,
    series: RealSeries,
    /// `dλ̂/dx`, row-major.
    forces: Vec<f64>,
    /// Rows of all equations, row-major.
    rows: Vec<f64>,
}

impl Assembly {
    pub fn new(coordinates: usize, series: RealSeries) -> Self {
        let size = coordinates * series.width();
        let zeros = vec![0.0; size * size];
        Self { coordinates, series, forces: zeros.clone(), rows: zeros }
    }

    /// Number of coefficients.
    pub fn size(&self) -> usize {
        self.coordinates * self.series.width()
    }

    pub fn clear_forces(&mut self) {
        self.forces.fill(0.0);
    }

    /// Adds the share of one closed set to `dλ̂/dx`: `map` (d × d) while it is closed, and `product` for when that is.
    pub fn add_forces(&mut self, map: &[f64], product: &[f64]) {
        let (d, width, size) = (self.coordinates, self.series.width(), self.size());
        for (i, m) in (0..d).flat_map(|i| (0..width).map(move |m| (i, m))) {
            let row = &mut self.forces[(i * width + m) * size..][..size];
            let product = &product[m * width..(m + 1) * width];
            for (block, factor) in row.chunks_mut(width).zip(&map[i * d..(i + 1) * d]).filter(|(_, f)| **f != 0.0) {
                block.iter_mut().zip(product).for_each(|(to, from)| *to += factor * from);
            }
        }
    }

    /// Residual, over `unit`, sizes and rows of harmonic `n`.
    pub fn rows_of(&mut self, n: usize, block: &HarmonicBlock, unit: f64, out: &mut Linearization) {
        let (d, width, size) = (self.coordinates, self.series.width(), self.size());
        let sine = self.series.sine(n);
        for i in 0..d {
            out.residual[i * width + n] = block.residual[i].re / unit;
            out.sizes[i * width + n] = block.sizes[i];
            if let Some(sine) = sine {
                out.residual[i * width + sine] = -block.residual[i].im / unit;
                out.sizes[i * width + sine] = block.sizes[i];
            }
            for (m, is_sine) in std::iter::once((n, false)).chain(sine.map(|s| (s, true))) {
                let row = &mut self.rows[(i * width + m) * size..][..size];
                row.fill(0.0);
                for e in 0..d {
                    let (l, g) = (block.l[i * d + e], block.g[i * d + e]);
                    // Factors of the cosine and of the sine coefficient in this row.
                    let (of_l, of_g) =
                        if is_sine { ([-l.im, l.re], [-g.im, g.re]) } else { ([l.re, l.im], [g.re, g.im]) };
                    row[e * width + n] += of_l[0];
                    subtract(row, of_g[0], &self.forces[(e * width + n) * size..][..size]);
                    if let Some(sine) = sine {
                        row[e * width + sine] += of_l[1];
                        subtract(row, of_g[1], &self.forces[(e * width + sine) * size..][..size]);
                    }
                }
            }
        }
    }

    /// Adds the derivative of harmonic `n` with respect to scalar `t` (ω, ξ, level), times `factor`, to a column;
    /// `force` is that of `λ̂`, or empty.
    #[expect(clippy::too_many_arguments, reason = "one product with all its factors")]
    pub fn scalar_column(
        &self,
        n: usize,
        block: &HarmonicBlock,
        t: usize,
        force: &[Complex64],
        factor: f64,
        column: usize,
        jacobian: &mut Mat<f64>,
    ) {
        let (d, width) = (self.coordinates, self.series.width());
        for i in 0..d {
            let through: Complex64 = block.g[i * d..].iter().zip(force).map(|(g, force)| g * force).sum();
            let value = block.d_residual[t][i] - through;
            jacobian[(i * width + n, column)] += value.re * factor;
            if let Some(sine) = self.series.sine(n) {
                jacobian[(i * width + sine, column)] -= value.im * factor;
            }
        }
    }

    /// Writes all rows into the columns of the coefficients.
    pub fn write(&self, jacobian: &mut Mat<f64>) {
        let size = self.size();
        for j in 0..size {
            let from = self.rows[j..].iter().step_by(size);
            column_mut(jacobian, j).iter_mut().zip(from).for_each(|(to, from)| *to = *from);
        }
    }
}

/// Complex amplitudes of harmonic `n` of many series, one after the other.
pub(crate) fn complex_harmonic(series: RealSeries, real: &[f64], n: usize) -> Vec<Complex64> {
    let mut all = Vec::new();
    write_harmonic(series, real, n, &mut all);
    all
}

/// Writes the complex amplitudes of harmonic `n` of many series, one after the other.
pub(crate) fn write_harmonic(series: RealSeries, real: &[f64], n: usize, to: &mut Vec<Complex64>) {
    let (width, sine) = (series.width(), series.sine(n));
    to.resize(real.len() / width, Complex64::default());
    for (k, z) in to.iter_mut().enumerate() {
        z.re = real[k * width + n];
        z.im = sine.map_or(0.0, |sine| -real[k * width + sine]);
    }
}

/// Adds weights `w` of complex amplitudes, of which `Re(w z)` counts, times `factor` to those of the real coefficients.
pub(crate) fn add_weights(series: RealSeries, n: usize, weights: &[Complex64], factor: f64, real: &mut [f64]) {
    let sine = series.sine(n);
    for (real, w) in real.chunks_mut(series.width()).zip(weights) {
        real[n] += factor * w.re;
        if let Some(sine) = sine {
            real[sine] += factor * w.im;
        }
    }
}

fn subtract(to: &mut [f64], factor: f64, from: &[f64]) {
    if factor != 0.0 {
        to.iter_mut().zip(from).for_each(|(to, from)| *to -= factor * from);
    }
}
