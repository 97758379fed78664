//! Contact forces with twice the digits.

use num_complex::Complex64;

use crate::ContactOperator;
use crate::double::{Double, DoubleComplex};

impl ContactOperator {
    /// Contact forces (N, c × width) of gaps with twice the digits (m, c × width), between the instants of the last
    /// solution.
    ///
    /// A closed rigid stop leaves of the gaps without contact forces only what it is pressed by, which may be 10⁻⁸ of
    /// them: then forces have half of the digits of these gaps. Where the instants are off by δτ, forces are by δτ²,
    /// since they start from zero.
    pub(crate) fn fine_forces(&self, y: &[Double]) -> Vec<f64> {
        let (c, series) = (self.n_contacts(), self.series());
        let (width, h) = (series.width(), series.n_harmonics);
        let gaps: Vec<Vec<DoubleComplex>> = y.chunks(width).map(|y| self.two_sided(y)).collect();
        let mut sums = vec![vec![DoubleComplex::ZERO; h + 1]; c];
        for set in self.closed_sets() {
            let averages = self.fine_averages(set);
            let closed = self.sets.get(set);
            let of = |m: isize| {
                let average = averages[m.unsigned_abs()];
                if m < 0 { average.conj() } else { average }
            };
            for &i in &closed.active {
                let pressed: Vec<DoubleComplex> =
                    (0..=2 * h).map(|k| combined(closed.force_row(i), &gaps, k)).collect();
                for (n, sum) in sums[i].iter_mut().enumerate() {
                    for (k, z) in pressed.iter().enumerate() {
                        *sum = *sum + of(n as isize - (k as isize - h as isize)) * *z;
                    }
                }
            }
        }
        // As averages over time, of which a series has twice the parts beyond the mean.
        let coefficients = |sums: &Vec<DoubleComplex>| {
            let averages: Vec<Complex64> = sums.iter().map(|sum| sum.value()).collect();
            series.coefficients_of(&averages)
        };
        sums.iter().flat_map(coefficients).collect()
    }

    /// Amplitudes of `e^{ikτ}`, k = −H … H.
    fn two_sided(&self, y: &[Double]) -> Vec<DoubleComplex> {
        let (series, h) = (self.series(), self.series().n_harmonics);
        let half = |y: Double| Double { high: 0.5 * y.high, low: 0.5 * y.low };
        let positive = |n: usize| match (n, series.sine(n)) {
            (0, _) => DoubleComplex { re: y[0], im: Double::ZERO },
            (_, Some(sine)) => DoubleComplex { re: half(y[n]), im: -half(y[sine]) },
            (_, None) => DoubleComplex { re: half(y[n]), im: Double::ZERO },
        };
        let negative = (1..=h).rev().map(|n| positive(n).conj());
        negative.chain((0..=h).map(positive)).collect()
    }

    /// The sets with a closed contact that occur.
    fn closed_sets(&self) -> Vec<usize> {
        self.spectra.iter().map(|spectrum| spectrum.set).collect()
    }

    /// `(1/2π) ∫ χ e^{−ikτ} dτ`, k = 0 … 2H, of a set.
    fn fine_averages(&self, set: usize) -> Vec<DoubleComplex> {
        let mut averages = vec![DoubleComplex::ZERO; 2 * self.series().n_harmonics + 1];
        let turn = 1.0 / Double::TAU.high;
        // 1/2π with twice the digits, by one step of Newton's method.
        let per_turn = Double::of(turn) * (Double::of(2.0) - Double::TAU * Double::of(turn));
        for interval in self.intervals().iter().filter(|interval| interval.set == set) {
            let (a, b) = (DoubleComplex::cis(-interval.from), DoubleComplex::cis(-interval.to));
            let (mut at_a, mut at_b) = (a, b);
            averages[0].re = averages[0].re + Double::sum(interval.to, -interval.from) * per_turn;
            for (k, average) in averages.iter_mut().enumerate().skip(1) {
                // ∫ e^{−ikτ} = (e^{−ik·from} − e^{−ik·to}) / (ik)
                let difference = at_a - at_b;
                let over = |v: Double| v.over(k as f64) * per_turn;
                *average = *average + DoubleComplex { re: over(difference.im), im: -over(difference.re) };
                (at_a, at_b) = (at_a * a, at_b * b);
            }
        }
        averages
    }
}

/// `Σ_j s_j y_j` of amplitude `k`.
fn combined(row: impl Iterator<Item = (usize, f64)>, gaps: &[Vec<DoubleComplex>], k: usize) -> DoubleComplex {
    row.fold(DoubleComplex::ZERO, |sum, (j, s)| sum + gaps[j][k].scaled(Double::of(s)))
}
