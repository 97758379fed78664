//! Random points of the unit cube.

use rand::rngs::Xoshiro256PlusPlus;
use rand::{RngExt, SeedableRng};

/// A number in the open unit interval.
fn inner(random: &mut Xoshiro256PlusPlus) -> f64 {
    (f64::from(random.random::<u32>()) + 0.5) / 2f64.powi(32)
}

/// Independent points. A larger number of them begins with the same ones.
pub fn independent(count: usize, dimensions: usize, seed: u64) -> Vec<Vec<f64>> {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
    (0..count).map(|_| (0..dimensions).map(|_| inner(&mut random)).collect()).collect()
}

/// A Latin hypercube: in each dimension one point in each of `count` strata, at a random position in it.
pub fn latin_hypercube(count: usize, dimensions: usize, seed: u64) -> Vec<Vec<f64>> {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
    let mut points = vec![vec![0.0; dimensions]; count];
    for d in 0..dimensions {
        let mut strata: Vec<usize> = (0..count).collect();
        for k in (1..count).rev() {
            strata.swap(k, random.random_range(0..=k));
        }
        for (point, stratum) in points.iter_mut().zip(strata) {
            point[d] = (stratum as f64 + inner(&mut random)) / count as f64;
        }
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_latin_hypercube_meets_each_stratum_once() {
        let points = latin_hypercube(50, 3, 4);
        for d in 0..3 {
            let mut strata: Vec<usize> = points.iter().map(|point| (point[d] * 50.0) as usize).collect();
            strata.sort_unstable();
            assert_eq!(strata, (0..50).collect::<Vec<_>>());
        }
        assert_ne!(points, latin_hypercube(50, 3, 5));
    }

    #[test]
    fn more_independent_points_begin_with_the_same_ones() {
        assert_eq!(independent(20, 3, 1)[..10], independent(10, 3, 1));
    }
}
