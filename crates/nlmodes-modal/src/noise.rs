//! Level of white noise on a smooth signal.

/// Fourth differences of a signal suppress its smooth part and multiply the variance of white noise by 70.
const FOURTH_DIFFERENCE_VARIANCE: f64 = 70.0;
/// Median of the magnitude of a normal variable with unit variance.
const NORMAL_MEDIAN: f64 = 0.674_489_750_196_082;

/// Standard deviation of white noise on a signal, from the median of its fourth differences, so that kinks and bursts
/// in less than half of the record have no effect. Zero with fewer than five samples.
pub fn noise_level(samples: &[f64]) -> f64 {
    let fourth = |w: &[f64]| w[0] - 4.0 * w[1] + 6.0 * w[2] - 4.0 * w[3] + w[4];
    let mut magnitudes: Vec<f64> = samples.windows(5).map(|w| fourth(w).abs()).collect();
    if magnitudes.is_empty() {
        return 0.0;
    }
    let middle = magnitudes.len() / 2;
    let (_, median, _) = magnitudes.select_nth_unstable_by(middle, f64::total_cmp);
    *median / (NORMAL_MEDIAN * FOURTH_DIFFERENCE_VARIANCE.sqrt())
}

/// Normal numbers from a small generator, for tests.
#[cfg(test)]
pub mod tests {
    use super::*;

    pub struct Normal(u64);

    impl Normal {
        pub fn new(seed: u64) -> Self {
            Self(seed.wrapping_mul(2).wrapping_add(1))
        }

        fn uniform(&mut self) -> f64 {
            // xorshift64*
            self.0 ^= self.0 >> 12;
            self.0 ^= self.0 << 25;
            self.0 ^= self.0 >> 27;
            (self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11) as f64 / (1u64 << 53) as f64
        }

        pub fn draw(&mut self) -> f64 {
            let (a, b) = (self.uniform().max(1e-300), self.uniform());
            (-2.0 * a.ln()).sqrt() * (std::f64::consts::TAU * b).cos()
        }
    }

    #[test]
    fn noise_is_found_under_a_smooth_signal_with_bursts() {
        let mut normal = Normal::new(7);
        let signal = |j: usize| (0.02 * j as f64).sin() + if j % 200 < 10 { (j % 7) as f64 } else { 0.0 };
        let samples: Vec<f64> = (0..20_000).map(|j| signal(j) + 0.01 * normal.draw()).collect();
        let level = noise_level(&samples);
        // Ten of two hundred samples are in bursts, so the median is at the 0.53 quantile of the rest.
        assert!((level / 0.01 - 1.0).abs() < 0.1, "{level}");
        assert_eq!(noise_level(&[1.0, 2.0]), 0.0);
    }
}
