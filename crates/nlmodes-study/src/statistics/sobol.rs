//! Sobol' indices of a design that has the points for them.

use rand::rngs::Xoshiro256PlusPlus;
use rand::{RngExt, SeedableRng};
use serde::Serialize;

/// Number of bootstrap samples.
const SAMPLES: usize = 400;
/// Minimum number of blocks.
const FEWEST: usize = 4;

/// Shares of the variance due to a variable.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SobolIndex {
    /// First-order index.
    pub first: f64,
    /// Its standard error, by bootstrap over the blocks, smaller in fact for points of a Sobol' sequence; or the bound
    /// of an expansion.
    pub first_error: f64,
    /// Total index.
    pub total: f64,
    /// The same of it.
    pub total_error: f64,
}

/// Sobol' indices from blocks of the values at A, B, and A with one variable of B for each variable; and the number of
/// excluded blocks.
///
/// First-order ones by Saltelli et al., Computer Physics Communications 181 (2010) 259-270, table 2 (b); total ones by
/// Jansen, the same (f).
pub fn sobol_indices(values: &[Option<f64>], variables: usize, seed: u64) -> (Vec<SobolIndex>, usize) {
    let blocks: Vec<Vec<f64>> =
        values.chunks_exact(variables + 2).filter_map(|block| block.iter().copied().collect()).collect();
    let left_out = values.len() / (variables + 2) - blocks.len();
    let all: Vec<usize> = (0..blocks.len()).collect();
    if blocks.len() < FEWEST {
        return (Vec::new(), left_out);
    }
    let found = indices(&blocks, &all, variables);
    let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
    let mut squares = vec![[0.0; 2]; variables];
    for _ in 0..SAMPLES {
        let drawn: Vec<usize> = all.iter().map(|_| random.random_range(0..blocks.len())).collect();
        for ((sum, other), own) in squares.iter_mut().zip(indices(&blocks, &drawn, variables)).zip(&found) {
            (0..2).for_each(|k| sum[k] += (other[k] - own[k]).powi(2) / SAMPLES as f64);
        }
    }
    let index = |([first, total], square): ([f64; 2], [f64; 2])| {
        let [first_error, total_error] = square.map(f64::sqrt);
        SobolIndex { first, first_error, total, total_error }
    };
    (found.into_iter().zip(squares).map(index).collect(), left_out)
}

/// First-order and total index of each variable, from the blocks of these numbers.
fn indices(blocks: &[Vec<f64>], numbers: &[usize], variables: usize) -> Vec<[f64; 2]> {
    let n = numbers.len() as f64;
    let sum = |f: &dyn Fn(&[f64]) -> f64| numbers.iter().map(|k| f(&blocks[*k])).sum::<f64>() / n;
    // Centred values have smaller products and therefore smaller errors.
    let mean = sum(&|block| 0.5 * (block[0] + block[1]));
    let variance = sum(&|block| 0.5 * ((block[0] - mean).powi(2) + (block[1] - mean).powi(2)));
    let of = |k: usize| {
        let first = sum(&|block| (block[1] - mean) * (block[k + 2] - block[0]));
        let total = 0.5 * sum(&|block| (block[0] - block[k + 2]).powi(2));
        [first / variance, total / variance]
    };
    (0..variables).map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::Points;
    use crate::distribution::Distribution;
    use crate::study::{Design, DesignKind, Study, Values, Variable};

    /// Values of a function at the points of a design with indices, uniform on the unit cube.
    fn values(kind: DesignKind, samples: usize, variables: usize, f: impl Fn(&[f64]) -> f64) -> Vec<Option<f64>> {
        let variable = |k: usize| Variable {
            name: k.to_string(),
            keys: vec![k.to_string()],
            values: Values::Drawn(Distribution::Uniform { low: 0.0, high: 1.0 }),
        };
        let study = Study {
            title: String::new(),
            scene_name: String::new(),
            scene_text: String::new(),
            design: Design { kind, samples, seed: 3, sobol_indices: true, box_deviations: 3.0, ..Design::default() },
            variables: (0..variables).map(variable).collect(),
            quantities: Vec::new(),
            fit: None,
            directory: std::path::PathBuf::new(),
            keep: Default::default(),
        };
        let points = Points::new(&study);
        (0..points.len())
            .map(|k| {
                let x: Vec<f64> = points.get(k).iter().map(|keys| keys[0].as_f64().unwrap()).collect();
                Some(f(&x))
            })
            .collect()
    }

    /// Sobol' g-function: g_k = (|4 x − 2| + a) / (1 + a), first index V_k / V with V_k = 1 / (3 (1 + a)²).
    fn g(a: &[f64]) -> impl Fn(&[f64]) -> f64 + '_ {
        move |x| x.iter().zip(a).map(|(x, a)| ((4.0 * x - 2.0).abs() + a) / (1.0 + a)).product()
    }

    fn exact(a: &[f64]) -> Vec<[f64; 2]> {
        let own: Vec<f64> = a.iter().map(|a| 1.0 / (3.0 * (1.0 + a).powi(2))).collect();
        let whole = own.iter().map(|v| 1.0 + v).product::<f64>() - 1.0;
        own.iter().map(|v| [v / whole, v * (whole + 1.0) / (1.0 + v) / whole]).collect()
    }

    fn worst(kind: DesignKind, samples: usize) -> (f64, f64) {
        let a = [0.0, 1.0, 4.5];
        let (found, left_out) = sobol_indices(&values(kind, samples, 3, g(&a)), 3, 1);
        assert_eq!(left_out, 0);
        let errors = found.iter().zip(exact(&a)).flat_map(|(f, e)| [(f.first - e[0]).abs(), (f.total - e[1]).abs()]);
        let said = found.iter().flat_map(|f| [f.first_error, f.total_error]).fold(0.0, f64::max);
        (errors.fold(0.0, f64::max), said)
    }

    #[test]
    fn indices_of_the_g_function_come_out_and_their_errors_fall_as_theory_says() {
        // Random points: the error is that of the bootstrap, and decreases with the square root of their number.
        for samples in [256, 4096] {
            let (error, said) = worst(DesignKind::Random, samples);
            assert!(error < 3.0 * said && said < 2.0 / (samples as f64).sqrt(), "{samples} {error} {said}");
        }
        // Points of the sequence: nearly with their number.
        let (coarse, fine) = (worst(DesignKind::Sobol, 64).0, worst(DesignKind::Sobol, 4096).0);
        assert!(fine < 2e-3 && fine < coarse / 16.0, "{coarse} {fine}");
    }

    #[test]
    fn a_block_with_a_hole_is_left_out() {
        let mut values = values(DesignKind::Sobol, 64, 2, |x| x[0]);
        values[5] = None;
        let (found, left_out) = sobol_indices(&values, 2, 1);
        assert_eq!(left_out, 1);
        assert!((found[0].total - 1.0).abs() < 0.1 && found[1].total.abs() < 1e-12);
    }
}
