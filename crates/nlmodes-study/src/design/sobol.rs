//! Sobol' sequences with the directions of Joe and Kuo (2008), scrambled.
//!
//! S. Joe, F. Y. Kuo, SIAM Journal on Scientific Computing 30 (2008) 2635-2654, their table `new-joe-kuo-6`, first 256
//! dimensions. Scrambled by random lower triangular matrices and a random shift, which preserve the uniformity of the
//! points (J. Matoušek, Journal of Complexity 14 (1998) 527-556).

use rand::rngs::Xoshiro256PlusPlus;
use rand::{RngExt, SeedableRng};

/// Dimensions of the table.
pub const MAX_DIMENSIONS: usize = 256;
const BITS: usize = 32;
/// One line per dimension from the second one on: degree s of the primitive polynomial, its inner coefficients a, and
/// m_1 … m_s.
const TABLE: &str = include_str!("joe_kuo.txt");

/// Direction numbers, whose exclusive or gives the coordinates of points, in one dimension.
type Directions = [u32; BITS];

/// A scrambled Sobol' sequence.
#[derive(Debug, Clone)]
pub struct Sobol {
    directions: Vec<Directions>,
    shifts: Vec<u32>,
}

impl Sobol {
    /// In this many dimensions, at most [`MAX_DIMENSIONS`], scrambled by the random seed.
    pub fn new(dimensions: usize, seed: u64) -> Self {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
        let mut sequence = Self::plain(dimensions);
        for (directions, shift) in sequence.directions.iter_mut().zip(&mut sequence.shifts) {
            // Row i of the matrix: any bits above the diagonal bit, which is set.
            let rows: [u32; BITS] = std::array::from_fn(|i| {
                let diagonal = 1 << (BITS - 1 - i);
                let above = !(u32::MAX >> i);
                (random.random::<u32>() & above) | diagonal
            });
            *directions = directions.map(|direction| product(&rows, direction));
            *shift = random.random();
        }
        sequence
    }

    /// Unscrambled as in the literature, beginning with the origin.
    fn plain(dimensions: usize) -> Self {
        let first: Directions = std::array::from_fn(|k| 1 << (BITS - 1 - k));
        let others = TABLE.lines().map(of_line);
        let directions: Vec<Directions> = std::iter::once(first).chain(others).take(dimensions).collect();
        Self { shifts: vec![0; directions.len()], directions }
    }

    /// A point within the unit cube, none of its coordinates 0 or 1; the first 2³² differ.
    pub fn point(&self, number: usize) -> Vec<f64> {
        let coordinate = |(directions, shift): (&Directions, &u32)| {
            let set = (0..BITS).filter(|k| number >> k & 1 == 1);
            let x = set.fold(*shift, |x, k| x ^ directions[k]);
            (f64::from(x) + 0.5) / 2f64.powi(BITS as i32)
        };
        self.directions.iter().zip(&self.shifts).map(coordinate).collect()
    }
}

/// The matrix with these rows, the highest bit first, times a vector of bits.
fn product(rows: &[u32; BITS], vector: u32) -> u32 {
    rows.iter().fold(0, |bits, row| bits << 1 | ((row & vector).count_ones() & 1))
}

/// Directions of a line of the table: v_k = a_1 v_{k−1} ⊕ … ⊕ a_{s−1} v_{k−s+1} ⊕ v_{k−s} ⊕ v_{k−s} / 2^s.
fn of_line(line: &str) -> Directions {
    let numbers: Vec<u32> = line.split_whitespace().filter_map(|number| number.parse().ok()).collect();
    let [s, a, m @ ..] = numbers.as_slice() else { return [0; BITS] };
    let s = *s as usize;
    let mut v = [0; BITS];
    for k in 0..BITS {
        v[k] = match m.get(k) {
            Some(m) => m << (BITS - 1 - k),
            None => (1..s).filter(|i| a >> (s - 1 - i) & 1 == 1).fold(v[k - s] ^ v[k - s] >> s, |x, i| x ^ v[k - i]),
        };
    }
    v
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coordinates_are_those_that_others_publish() {
        // Points 0 to 7 in six dimensions, and single coordinates, of SciPy 1.17, which numbers points by Gray code.
        let sequence = Sobol::plain(256);
        let gray = |k: usize| sequence.point(k ^ (k >> 1));
        let half = 0.5 / 2f64.powi(32);
        let known = [
            [0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            [0.5, 0.5, 0.5, 0.5, 0.5, 0.5],
            [0.75, 0.25, 0.25, 0.25, 0.75, 0.75],
            [0.25, 0.75, 0.75, 0.75, 0.25, 0.25],
            [0.375, 0.375, 0.625, 0.875, 0.375, 0.125],
            [0.875, 0.875, 0.125, 0.375, 0.875, 0.625],
            [0.625, 0.125, 0.875, 0.625, 0.625, 0.875],
            [0.125, 0.625, 0.375, 0.125, 0.125, 0.375],
        ];
        for (k, point) in known.iter().enumerate() {
            for (d, x) in point.iter().enumerate() {
                assert_eq!(gray(k)[d] - half, *x, "{k} {d}");
            }
        }
        for (k, d, x) in
            [(777, 99, 0.5107421875), (1000, 149, 0.5419921875), (513, 40, 0.7470703125), (1023, 199, 0.1865234375)]
        {
            assert_eq!(gray(k)[d] - half, x, "{k} {d}");
        }
    }

    #[test]
    fn scrambled_points_are_as_even_as_they_were() {
        // Of 2^m points one lies in each of 2^m strata of each dimension, and of the elementary boxes of the first two.
        let sequence = Sobol::new(40, 7);
        let points: Vec<Vec<f64>> = (0..256).map(|k| sequence.point(k)).collect();
        for d in 0..40 {
            let mut strata: Vec<usize> = points.iter().map(|point| (point[d] * 256.0) as usize).collect();
            strata.sort_unstable();
            assert_eq!(strata, (0..256).collect::<Vec<_>>(), "{d}");
        }
        for rows in 0..=8 {
            let (n, m) = (2f64.powi(rows), 2f64.powi(8 - rows));
            let mut boxes: Vec<usize> =
                points.iter().map(|p| (p[0] * n) as usize * m as usize + (p[1] * m) as usize).collect();
            boxes.sort_unstable();
            assert_eq!(boxes, (0..256).collect::<Vec<_>>(), "{rows}");
        }
    }

    #[test]
    fn seeds_differ_and_repeat() {
        assert_eq!(Sobol::new(3, 1).point(5), Sobol::new(3, 1).point(5));
        assert_ne!(Sobol::new(3, 1).point(5), Sobol::new(3, 2).point(5));
    }
}
