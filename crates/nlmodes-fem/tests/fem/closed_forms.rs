//! Frequency equations of uniform beams and rods.

use std::f64::consts::PI;

/// Zeros of `f` in `(0, end)`, ascending, by bisection between the sign changes on a fine grid.
pub fn zeros(f: impl Fn(f64) -> f64, end: f64) -> Vec<f64> {
    let n = 200_000;
    let at = |i: usize| (i as f64 + 0.37) * end / n as f64;
    let bracket = |i: usize| {
        let (mut a, mut b) = (at(i), at(i + 1));
        (f(a) * f(b) < 0.0).then(|| {
            for _ in 0..80 {
                let middle = 0.5 * (a + b);
                if f(a) * f(middle) <= 0.0 { b = middle } else { a = middle }
            }
            0.5 * (a + b)
        })
    };
    (0..n - 1).filter_map(bracket).collect()
}

/// `f = (2k − 1) c / 4L` as angular frequency.
pub fn clamped_free_rod(c: f64, length: f64, k: usize) -> f64 {
    (2 * k - 1) as f64 * PI * c / (2.0 * length)
}

/// Euler-Bernoulli: `β` of `ω = (β/L)² √(EI/ρA)`.
pub mod euler_bernoulli {
    use super::zeros;

    /// `cos β cosh β = −1`.
    pub fn clamped_free() -> Vec<f64> {
        zeros(|b| b.cos() + 1.0 / b.cosh(), 20.0)
    }

    /// `cos β cosh β = 1`; clamped-clamped has the same.
    pub fn free_free() -> Vec<f64> {
        zeros(|b| b.cos() - 1.0 / b.cosh(), 20.0).into_iter().filter(|b| *b > 1.0).collect()
    }

    /// `tan β = tanh β`.
    pub fn clamped_pinned() -> Vec<f64> {
        zeros(|b| b.sin() - b.tanh() * b.cos(), 20.0).into_iter().filter(|b| *b > 1.0).collect()
    }

    /// `tan β = −tanh β`.
    pub fn clamped_sliding() -> Vec<f64> {
        zeros(|b| b.sin() + b.tanh() * b.cos(), 20.0)
    }

    /// `sin β = 0`.
    pub fn pinned_pinned() -> Vec<f64> {
        zeros(f64::sin, 20.0)
    }
}

/// Timoshenko beam of length L, in the numbers `b² = ρA L⁴ ω² / EI`, `r² = I / A L²`, `s² = EI / κGA L²`.
///
/// With `α, β = √(½ (∓(r² + s²) + √((r² − s²)² + 4/b²)))` the shapes are combinations of `cosh bαξ`, `sinh bαξ`,
/// `cos bβξ`, `sin bβξ`, as long as `b² r² s² < 1` (T. C. Huang, *Journal of Applied Mechanics* 28 (1961) 579-584).
pub struct Timoshenko {
    pub r2: f64,
    pub s2: f64,
}

impl Timoshenko {
    fn roots(&self, b: f64) -> (f64, f64) {
        let (sum, root) = (self.r2 + self.s2, ((self.r2 - self.s2).powi(2) + 4.0 / (b * b)).sqrt());
        (b * ((root - sum) / 2.0).sqrt(), b * ((root + sum) / 2.0).sqrt())
    }

    fn cut_on(&self) -> f64 {
        1.0 / (self.r2 * self.s2).sqrt()
    }

    fn below_cut_on(&self, f: impl Fn(f64) -> f64) -> Vec<f64> {
        zeros(f, 0.999 * self.cut_on())
    }

    /// `2 + (b² (r² − s²)² + 2) cosh bα cos bβ − b (r² + s²) / √(1 − b² r² s²) · sinh bα sin bβ = 0`.
    pub fn clamped_free(&self) -> Vec<f64> {
        self.below_cut_on(|b| {
            let (x, y) = self.roots(b);
            let odd = b * (self.r2 + self.s2) / (1.0 - b * b * self.r2 * self.s2).sqrt();
            let even = b * b * (self.r2 - self.s2).powi(2) + 2.0;
            2.0 / x.cosh() + even * y.cos() - odd * x.tanh() * y.sin()
        })
    }

    /// `2 − 2 cosh bα cos bβ + b (b² r² (r² − s²)² + 3r² − s²) / √(1 − b² r² s²) · sinh bα sin bβ = 0`.
    pub fn free_free(&self) -> Vec<f64> {
        self.symmetric(self.r2, self.s2)
    }

    /// As free-free with `r` and `s` exchanged in the last bracket.
    pub fn clamped_clamped(&self) -> Vec<f64> {
        self.symmetric(self.s2, self.r2)
    }

    fn symmetric(&self, p: f64, q: f64) -> Vec<f64> {
        let zeros = self.below_cut_on(|b| {
            let (x, y) = self.roots(b);
            let bracket = b * b * p * (p - q).powi(2) + 3.0 * p - q;
            let odd = b * bracket / (1.0 - b * b * self.r2 * self.s2).sqrt();
            2.0 / x.cosh() - 2.0 * y.cos() + odd * x.tanh() * y.sin()
        });
        // The rigid-body modes at b = 0 are zeros of high order, where rounding changes the sign.
        zeros.into_iter().filter(|b| *b > 1.0).collect()
    }

    /// `sin bβ = 0`.
    pub fn pinned_pinned(&self) -> Vec<f64> {
        self.below_cut_on(|b| self.roots(b).1.sin())
    }
}
