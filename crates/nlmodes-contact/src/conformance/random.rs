//! Random problems constructed from a known solution, identical on every machine: the generator is part of the suite.

use nlmodes_linalg::Mat;

use super::{Case, Expected};

pub(super) fn cases(at_most: usize) -> Vec<Case> {
    let mut all = Vec::new();
    for c in [2, 10, 50].into_iter().filter(|c| *c <= at_most) {
        all.extend([0.0, 3.0, 6.0, 9.0, 12.0].map(|power| conditioned(c, power)));
        all.push(low_rank(c));
        all.push(contradictory(c));
        all.extend((0..5).map(|seed| dense(c, seed)));
    }
    if at_most >= 200 {
        all.extend([3.0, 6.0, 9.0, 12.0].map(|power| conditioned(200, power)));
        all.extend([low_rank(200), contradictory(200)]);
    }
    all.extend([200, 1000].into_iter().filter(|c| *c <= at_most).map(|c| dense(c, 0)));
    all
}

/// Multiplicative congruential generator.
struct Random(u64);

impl Random {
    fn new(seed: usize) -> Self {
        Self((seed as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    /// Uniform between −1 and 1.
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    fn vector(&mut self, n: usize) -> Vec<f64> {
        (0..n).map(|_| self.next()).collect()
    }

    /// Forces and gaps, a third each closed, open and both zero.
    fn solution(&mut self, c: usize) -> (Vec<f64>, Vec<f64>) {
        let pair = |v: f64| {
            if v > 0.33 {
                (v, 0.0)
            } else if v < -0.33 {
                (0.0, -v)
            } else {
                (0.0, 0.0)
            }
        };
        self.vector(c).into_iter().map(pair).unzip()
    }
}

/// `G Gᵀ / n` with a c × n matrix G.
fn gram(random: &mut Random, c: usize, n: usize) -> Mat<f64> {
    let g: Vec<Vec<f64>> = (0..c).map(|_| random.vector(n)).collect();
    Mat::from_fn(c, c, |i, j| g[i].iter().zip(&g[j]).map(|(a, b)| a * b).sum::<f64>() / n as f64)
}

fn dense(c: usize, seed: usize) -> Case {
    let mut random = Random::new(1000 * seed + c);
    let n = if c < 100 { c + c / 4 + 1 } else { 40 };
    let mut a = gram(&mut random, c, n);
    if c >= 100 {
        (0..c).for_each(|i| a[(i, i)] += 0.1);
    }
    let (lambda, gaps) = random.solution(c);
    Case::with_solution(format!("random, {c}, seed {seed}"), a, &lambda, &gaps)
}

fn low_rank(c: usize) -> Case {
    let mut random = Random::new(7 * c);
    let a = gram(&mut random, c, c.div_ceil(2));
    let (lambda, gaps) = random.solution(c);
    Case::with_solution(format!("low rank, {c}"), a, &lambda, &gaps)
}

/// `A = G Gᵀ` of half the rank with `b = −v`, where `v ≥ 0` and `Gᵀ v = 0`: pushed in a direction in which the body is
/// rigid.
fn contradictory(c: usize) -> Case {
    let mut random = Random::new(11 * c);
    let v: Vec<f64> = random.vector(c).into_iter().map(|x| 0.1 + x.abs()).collect();
    let norm: f64 = v.iter().map(|x| x * x).sum();
    let columns: Vec<Vec<f64>> = (0..c.div_ceil(2))
        .map(|_| {
            let g = random.vector(c);
            let along = g.iter().zip(&v).map(|(a, b)| a * b).sum::<f64>() / norm;
            g.iter().zip(&v).map(|(g, v)| g - along * v).collect()
        })
        .collect();
    let a = Mat::from_fn(c, c, |i, j| columns.iter().map(|g| g[i] * g[j]).sum::<f64>());
    Case { name: format!("contradictory, {c}"), a, b: v.iter().map(|v| -v).collect(), expected: Expected::Infeasible }
}

/// Eigenvalues from 1 to `10^-power`, equally spaced in the logarithm, in a random basis of reflections.
fn conditioned(c: usize, power: f64) -> Case {
    let mut random = Random::new(13 * c + power as usize);
    let eigenvalue = |i: usize| 10f64.powf(-power * i as f64 / (c - 1) as f64);
    let mut a = Mat::from_fn(c, c, |i, j| if i == j { eigenvalue(i) } else { 0.0 });
    for _ in 0..c.min(6) {
        a = reflected(&a, &random.vector(c));
    }
    let (lambda, gaps) = random.solution(c);
    Case::with_solution(format!("condition 1e{power}, {c}"), a, &lambda, &gaps)
}

/// `H A H` with the reflection `H = I − 2 v vᵀ / vᵀv`, made symmetric again.
fn reflected(a: &Mat<f64>, v: &[f64]) -> Mat<f64> {
    let c = v.len();
    let norm: f64 = v.iter().map(|x| x * x).sum();
    let av: Vec<f64> = (0..c).map(|i| (0..c).map(|j| a[(i, j)] * v[j]).sum::<f64>()).collect();
    let vav: f64 = av.iter().zip(v).map(|(a, b)| a * b).sum();
    let cross = |i: usize, j: usize| 2.0 / norm * (v[i] * av[j] + av[i] * v[j]);
    Mat::from_fn(c, c, |i, j| {
        let (i, j) = (i.min(j), i.max(j));
        a[(i, j)] - cross(i, j) + 4.0 * vav / (norm * norm) * v[i] * v[j]
    })
}
