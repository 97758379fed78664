use super::ticks::{Tick, linear_ticks, logarithmic_ticks};
use crate::svg::text_width;

/// Span of values, relative to their size, below which they are equal to rounding.
const ROUNDING: f64 = 1e-9;
/// Span, relative to its value, of a linear axis around equal values.
const AROUND_EQUAL: f64 = 0.02;
/// Narrowest span of a logarithmic axis, decades.
const NARROWEST_DECADES: f64 = 0.1;
/// Minimum distance of two abscissa labels, relative to their font size.
const BETWEEN: f64 = 1.0;

/// Span of an axis and its division.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Scale {
    Linear { low: f64, high: f64 },
    Logarithmic { low: f64, high: f64 },
}

impl Scale {
    /// Linear axis over all finite values with the share `margin` left free on each side; none without such a value.
    pub fn linear(values: impl IntoIterator<Item = f64>, margin: f64) -> Option<Self> {
        let (low, high) = extent(values, |value| value.is_finite())?;
        let size = low.abs().max(high.abs());
        let padding = match high - low {
            _ if size == 0.0 => 0.5,
            span if span <= ROUNDING * size => 0.5 * AROUND_EQUAL * size,
            span => margin * span,
        };
        Some(Self::Linear { low: low - padding, high: high + padding })
    }

    /// Logarithmic axis over all positive finite values; `margin` as in [`Scale::linear`], in decades.
    pub fn logarithmic(values: impl IntoIterator<Item = f64>, margin: f64) -> Option<Self> {
        let (low, high) = extent(values, |value| value.is_finite() && value > 0.0)?;
        let decades = (high / low).log10();
        let padding = (margin * decades).max(0.5 * (NARROWEST_DECADES - decades));
        Some(Self::Logarithmic { low: low * 10f64.powf(-padding), high: high * 10f64.powf(padding) })
    }

    /// The same axis, which now ends exactly at `low`.
    pub fn starting_at(self, start: f64) -> Self {
        match self {
            Self::Linear { high, .. } if start < high => Self::Linear { low: start, high },
            Self::Logarithmic { high, .. } if start < high && start > 0.0 => Self::Logarithmic { low: start, high },
            unchanged => unchanged,
        }
    }

    /// Its ends.
    pub fn ends(self) -> (f64, f64) {
        match self {
            Self::Linear { low, high } | Self::Logarithmic { low, high } => (low, high),
        }
    }

    /// Position of a value between the ends, 0 … 1; none for a value that the axis cannot show.
    pub fn place(self, value: f64) -> Option<f64> {
        let share = match self {
            Self::Linear { low, high } => (value - low) / (high - low),
            Self::Logarithmic { low, high } => (value / low).ln() / (high / low).ln(),
        };
        share.is_finite().then_some(share)
    }

    /// Ticks within the ends, about `target` of them with a label, and at least three if floating-point resolution
    /// permits.
    pub fn ticks(self, target: usize) -> Vec<Tick> {
        let of = |target: usize| match self {
            Self::Linear { low, high } => linear_ticks(low, high, target),
            Self::Logarithmic { low, high } => logarithmic_ticks(low, high, target),
        };
        let labelled = |ticks: &Vec<Tick>| ticks.iter().filter(|tick| tick.label.is_some()).count() >= 3;
        (target..target + 6).map(of).find(labelled).unwrap_or_else(|| of(target))
    }

    /// Ticks of an abscissa of this width, pixels, about `most` of them with a label in letters of this size: fewer if
    /// they do not fit, and none if even a few do not fit.
    pub fn ticks_with_room(self, most: usize, width: f64, letters: f64) -> Vec<Tick> {
        let extent = |tick: &Tick| {
            let (middle, half) = (self.place(tick.value)? * width, 0.5 * text_width(tick.label.as_ref()?, letters));
            Some([middle - half, middle + half])
        };
        let is_clear = |before: [f64; 2], next: [f64; 2]| next[0] - before[1] >= BETWEEN * letters;
        let fits = |ticks: &Vec<Tick>| {
            let all: Vec<[f64; 2]> = ticks.iter().filter_map(extent).collect();
            all.windows(2).all(|pair| is_clear(pair[0], pair[1]))
        };
        if let Some(ticks) = (1..=most).rev().map(|target| self.ticks(target)).find(fits) {
            return ticks;
        }
        let mut last: Option<[f64; 2]> = None;
        let mut ticks = self.ticks(1);
        for tick in &mut ticks {
            let Some(own) = extent(tick) else { continue };
            match last {
                Some(before) if !is_clear(before, own) => tick.label = None,
                _ => last = Some(own),
            }
        }
        ticks
    }
}

fn extent(values: impl IntoIterator<Item = f64>, usable: impl Fn(f64) -> bool) -> Option<(f64, f64)> {
    values.into_iter().filter(|value| usable(*value)).fold(None, |ends, value| {
        let (low, high) = ends.unwrap_or((value, value));
        Some((value.min(low), value.max(high)))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounding_noise_does_not_fill_the_axis() {
        let scale = Scale::linear([60.786_607_27, 60.786_607_27 + 1e-13], 0.05).unwrap();
        let (low, high) = scale.ends();
        assert!((high - low - 0.02 * 60.786_607_27).abs() < 1e-6, "{low} {high}");
    }

    #[test]
    fn equal_values_have_an_axis_around_them() {
        for value in [0.0, -3.0, 1e-300, 1e12] {
            let scale = Scale::linear([value, value], 0.05).unwrap();
            assert!((scale.place(value).unwrap() - 0.5).abs() < 1e-6, "{value}: {scale:?}");
        }
        assert!((Scale::logarithmic([8.0e8], 0.05).unwrap().place(8.0e8).unwrap() - 0.5).abs() < 1e-9);
    }

    #[test]
    fn every_axis_has_three_labels() {
        for k in 0..200 {
            let low = 0.013 * f64::from(k) - 1.0;
            for width in [1e-3, 0.37, 0.41, 1.9, 5.3] {
                for scale in [
                    Scale::Linear { low, high: low + width },
                    Scale::Logarithmic { low: low.exp(), high: (low + 2.0 * width).exp() },
                ] {
                    for target in [2, 3, 7] {
                        let n = scale.ticks(target).iter().filter(|tick| tick.label.is_some()).count();
                        assert!((3..=2 * target + 4).contains(&n), "{scale:?}: {n} for {target}");
                    }
                }
            }
        }
    }

    #[test]
    fn labels_of_an_abscissa_keep_apart_whatever_the_room() {
        let scales = [
            Scale::Linear { low: 2.1e-5, high: 4.8e-5 },
            Scale::Linear { low: 60.78661, high: 60.78667 },
            Scale::Logarithmic { low: 3e-5, high: 1.6e-4 },
            Scale::Logarithmic { low: 1e-9, high: 1.0 },
        ];
        for scale in scales {
            for width in [90.0, 150.0, 320.0, 640.0] {
                let ticks = scale.ticks_with_room(7, width, 10.5);
                let labels: Vec<(f64, f64)> = ticks
                    .iter()
                    .filter_map(|t| Some((scale.place(t.value)? * width, text_width(t.label.as_ref()?, 10.5))))
                    .collect();
                assert!(!labels.is_empty(), "{scale:?} {width}");
                for pair in labels.windows(2) {
                    let gap = pair[1].0 - pair[0].0 - 0.5 * (pair[0].1 + pair[1].1);
                    assert!(gap >= 10.5 - 1e-9, "{scale:?} {width}: {labels:?}");
                }
            }
        }
    }

    #[test]
    fn values_that_no_axis_shows_are_left_out() {
        assert_eq!(Scale::linear([f64::NAN, f64::INFINITY], 0.05), None);
        assert_eq!(Scale::logarithmic([0.0, -1.0], 0.05), None);
        let scale = Scale::logarithmic([0.0, 1.0, 100.0, f64::NAN], 0.0).unwrap();
        assert_eq!(scale.ends(), (1.0, 100.0));
        assert_eq!(scale.place(0.0), None);
        assert_eq!(scale.place(-2.0), None);
    }
}
