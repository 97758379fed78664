//! The smooth pieces of a periodic problem: its contact patterns, and where one passes into another.

use nlmodes_continuation::Boundary;
use num_complex::Complex64;

use super::load::Load;
use super::operating_point::{OperatingPoint, Source};
use super::system::PeriodicSystem;
use crate::RealSeries;
use crate::trigonometric::Trigonometric;
use crate::trigonometric::inner;

impl PeriodicSystem {
    /// The contact pattern alone at `z = (x, p)`; `None` where there is none.
    fn intervals_at(&mut self, z: &[f64]) -> Option<()> {
        let (p, x) = z.split_last()?;
        let at = self.operating_point(x, *p);
        let moved = self.load_gaps(at);
        self.form_gaps(x, &moved[3]);
        self.operator.solve(&self.y).ok()
    }

    /// Number of the contact pattern at `z = (x, p)`.
    pub(super) fn piece_at(&mut self, z: &[f64]) -> Option<u64> {
        self.intervals_at(z)?;
        Some(self.operator.pattern())
    }

    /// The boundary between the contact patterns of two points, as a function of `z` in lengths of the scales.
    pub(super) fn boundary_between(&mut self, from: &[f64], to: &[f64]) -> Option<Boundary> {
        self.intervals_at(from)?;
        let intervals = self.operator.intervals.clone();
        self.intervals_at(to)?;
        let boundary = self.operator.boundary_from(&intervals)?;
        let (gaps, length) = (self.gaps_of_unknowns(), self.scales.length);
        Some(Boundary::new(move |z| boundary.value(|weights| gaps.sum(weights, z)) / length))
    }

    fn gaps_of_unknowns(&self) -> Gaps {
        Gaps {
            series: self.series(),
            map: self.gap_map.clone(),
            unit: self.unit(),
            at_rest: self.structure.gaps().to_vec(),
            load: if self.load.moves_gaps() { self.load.clone() } else { Load::default() },
            sources: self.closing.sources(),
        }
    }
}

/// What makes gaps of the unknowns, by itself: `y = g₀ + P x + a`.
struct Gaps {
    series: RealSeries,
    /// `P`, c × d, row-major.
    map: Vec<f64>,
    /// Unit of the coefficients.
    unit: f64,
    /// `g₀`, m, c.
    at_rest: Vec<f64>,
    /// What adds `a`.
    load: Load,
    /// Where ω, ξ and the level come from.
    sources: [Source; 3],
}

impl Gaps {
    /// The weighted sum of all gaps without contact forces over time, for `z = (x, p)`.
    fn sum(&self, weights: &[f64], z: &[f64]) -> Trigonometric {
        let (width, d) = (self.series.width(), self.map.len() / weights.len().max(1));
        let mut real = vec![0.0; width];
        for j in 0..d {
            let factor: f64 =
                weights.iter().zip(self.map.chunks(d)).map(|(w, row)| w * row[j]).sum::<f64>() * self.unit;
            if factor != 0.0 {
                real.iter_mut().zip(&z[j * width..]).for_each(|(sum, x)| *sum += factor * x);
            }
        }
        real[0] += inner(weights, &self.at_rest);
        let mut sum = Trigonometric { z: vec![Complex64::default(); self.series.n_harmonics + 1] };
        self.series.to_complex(&real, &mut sum.z);
        let at = self.at(&z[d * width..]);
        for n in 0..=self.load.highest_harmonic() {
            for (i, weight) in weights.iter().enumerate() {
                sum.z[n] += self.load.gap(n, i, at).value * *weight;
            }
        }
        sum
    }

    /// Frequency, negative damping and level, from the unknowns behind the coefficients and the parameter.
    fn at(&self, behind: &[f64]) -> OperatingPoint {
        let (p, unknowns) = behind.split_last().map_or((0.0, behind), |(p, unknowns)| (*p, unknowns));
        let [omega, xi, level] = self.sources.map(|source| source.at(unknowns, p));
        OperatingPoint { omega, xi, level }
    }
}
