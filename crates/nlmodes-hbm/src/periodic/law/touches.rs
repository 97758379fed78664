//! When a stop with a law of force is touched, and the instants at which its force is evaluated then.

use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};

use nlmodes_linalg::gauss_legendre;
use num_complex::Complex64;

use super::ForceLaw;

/// Instants of a period for each harmonic, and at least, between which touches are sought.
const SCAN: usize = 16;
const FEWEST: usize = 256;

/// Evaluations in a touch: at least, and for each harmonic and radian of its length; their numbers are multiples of the
/// last one.
const LEAST: usize = 24;
const BY_LENGTH: f64 = 3.0;
const MULTIPLE: usize = 8;

/// A displacement `Re Σ z_n e^{inτ}` and its derivative by the phase.
pub(crate) fn value(z: &[Complex64], tau: f64) -> (f64, f64) {
    let (turn, mut turned) = (Complex64::cis(tau), Complex64::ONE);
    let mut sum = (0.0, 0.0);
    for (n, z) in z.iter().enumerate() {
        let term = z * turned;
        sum = (sum.0 + term.re, sum.1 - n as f64 * term.im);
        turned *= turn;
    }
    sum
}

/// The spans of the phase (rad) in which a law acts over a period of the displacement with the complex amplitudes `z`
/// (m) at the angular frequency `omega` (rad/s), in order; the first one may begin before zero. A touch between two
/// instants of the search is found at the largest displacement between them.
pub fn touch_spans(law: &dyn ForceLaw, z: &[Complex64], omega: f64) -> Vec<[f64; 2]> {
    let acts = |tau: f64| {
        let (v, slope) = value(z, tau);
        law.at(v, omega * slope).force > 0.0
    };
    let count = (SCAN * z.len()).max(FEWEST);
    let at = |j: usize| TAU * j as f64 / count as f64;
    // Phases at which it begins or ends to act.
    let mut switches: Vec<(f64, bool)> = Vec::new();
    let begin = acts(0.0);
    let (mut before, mut slope) = (begin, value(z, 0.0).1);
    for j in 1..=count {
        let (from, to) = (at(j - 1), at(j));
        let after = if j == count { begin } else { acts(to) };
        let next = value(z, to).1;
        if after != before {
            switches.push((halved(from, to, |tau| acts(tau) == before), after));
        } else if slope * next < 0.0 {
            let top = halved(from, to, |tau| value(z, tau).1 * slope > 0.0);
            if acts(top) != before {
                switches.push((halved(from, top, |tau| acts(tau) == before), !before));
                switches.push((halved(top, to, |tau| acts(tau) != before), before));
            }
        }
        (before, slope) = (after, next);
    }
    if switches.is_empty() {
        return if begin { vec![[0.0, TAU]] } else { Vec::new() };
    }
    if begin {
        // The touch at the phase zero begins in the period before.
        let (last, _) = switches[switches.len() - 1];
        switches.pop();
        switches.insert(0, (last - TAU, true));
    }
    switches.chunks(2).filter_map(|pair| Some([pair.first()?.0, pair.get(1)?.0])).filter(|[a, b]| b > a).collect()
}

/// The phase between `low`, where `is_before` holds, and `high`, where it does not any more.
fn halved(mut low: f64, mut high: f64, is_before: impl Fn(f64) -> bool) -> f64 {
    loop {
        let middle = 0.5 * (low + high);
        match middle > low && middle < high {
            true if is_before(middle) => low = middle,
            true => high = middle,
            false => return middle,
        }
    }
}

/// Rules of Gauss and Legendre on [−1, 1] by their number of nodes.
#[derive(Default)]
pub(crate) struct Rules(BTreeMap<usize, Vec<[f64; 2]>>);

impl Rules {
    /// Phases (rad) within touches, and weights that add up to the share of the period that these are.
    ///
    /// Within a touch the phase is `middle − half cos θ`, and the rule is one in θ: where a force begins with the power
    /// 3/2 of the time, it is smooth in θ.
    pub fn instants(&mut self, spans: &[[f64; 2]], harmonics: usize) -> Vec<[f64; 2]> {
        let mut all = Vec::new();
        for [from, to] in spans {
            let by_length = (BY_LENGTH * harmonics as f64 * (to - from)).ceil() as usize;
            let count = (LEAST + by_length).next_multiple_of(MULTIPLE);
            let rule = self.0.entry(count).or_insert_with(|| gauss_legendre(count));
            let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
            all.extend(rule.iter().map(|[x, weight]| {
                let (sine, cosine) = (0.5 * PI * (x + 1.0)).sin_cos();
                [middle - half * cosine, 0.5 * PI * weight * half * sine / TAU]
            }));
        }
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::HertzStop;

    /// `cos τ` beyond `1 − d`: one touch of half-width `acos(1 − d)`, however short, and mean powers of the approach
    /// against quadrature by trapezoids in the same substitution.
    #[test]
    fn touches_are_found_however_short_and_their_force_has_all_digits() {
        let law = |gap: f64| HertzStop { stiffness: 1.0, exponent: 1.5, gap, dissipation: 0.0 };
        for depth in [1.2, 0.3, 1e-3, 1e-8] {
            for turn in [0.0, 0.4, 3.0] {
                let z = [Complex64::default(), Complex64::cis(turn)];
                let spans = touch_spans(&law(1.0 - depth), &z, 1.0);
                let half = (1.0 - depth).acos();
                assert_eq!(spans.len(), 1);
                assert!((0.5 * (spans[0][1] - spans[0][0]) - half).abs() < 1e-8 * half, "{depth} {spans:?}");
                let force = |tau: f64| law(1.0 - depth).at(value(&z, tau).0, 0.0).force;
                let found: f64 = Rules::default().instants(&spans, 1).iter().map(|[tau, w]| w * force(*tau)).sum();
                let count = 20000;
                let part = |j: usize| {
                    let theta = PI * (j as f64 + 0.5) / count as f64;
                    force(-turn - half * theta.cos()) * half * theta.sin()
                };
                let expected = (0..count).map(part).sum::<f64>() * PI / count as f64 / TAU;
                assert!((found / expected - 1.0).abs() < 1e-7, "{depth} {turn}: {found} {expected}");
            }
        }
        let always = touch_spans(&law(-2.0), &[Complex64::default(), Complex64::ONE], 1.0);
        assert_eq!(always, [[0.0, TAU]]);
        assert!(touch_spans(&law(1.1), &[Complex64::default(), Complex64::ONE], 1.0).is_empty());
    }
}
