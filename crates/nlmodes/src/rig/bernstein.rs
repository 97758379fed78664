/// Binomial coefficients beyond this degree are not needed: Taylor series of one step are shorter.
const MOST: usize = 32;

/// Maximum depth of subdivision: an interval of `2⁻⁵⁰` is a point.
const DEPTH: u32 = 50;

/// Smallest `τ` in [0, 1] at which `Σ a_i τ^i` becomes negative.
///
/// On the interval the polynomial is bounded by its smallest and largest Bernstein coefficients, and has at most as
/// many roots as these have sign changes. Nothing is missed, however briefly it becomes negative: intervals are halved
/// until they have no sign change (no root) or one (one root, then bisected).
pub(crate) fn first_negative(power: &[f64]) -> Option<f64> {
    let n = power.len() - 1;
    assert!(n <= MOST, "a Taylor series of one step has a fixed, lower order");
    let mut bernstein = [0.0; MOST + 1];
    // b_j = Σ_i C(j, i) / C(n, i) a_i, by the differences of the scaled coefficients.
    let mut binomial = 1.0;
    for i in 0..=n {
        bernstein[i] = power[i] / binomial;
        binomial *= (n - i) as f64 / (i + 1) as f64;
    }
    for level in 1..=n {
        for j in (level..=n).rev() {
            bernstein[j] += bernstein[j - 1];
        }
    }
    search(&bernstein[..=n], 0.0, 1.0, 0)
}

fn search(b: &[f64], left: f64, width: f64, depth: u32) -> Option<f64> {
    if b[0] < 0.0 {
        return Some(left);
    }
    let changes = b.windows(2).filter(|pair| (pair[0] < 0.0) != (pair[1] < 0.0)).count();
    if changes == 0 {
        return None;
    }
    if depth == DEPTH {
        return Some(left);
    }
    let (first, second) = halves(b);
    let n = b.len();
    let half = 0.5 * width;
    if changes == 1 {
        // One root: it is in the half at whose ends the signs differ.
        return if first[n - 1] < 0.0 {
            search(&first[..n], left, half, depth + 1)
        } else {
            search(&second[..n], left + half, half, depth + 1)
        };
    }
    search(&first[..n], left, half, depth + 1).or_else(|| search(&second[..n], left + half, half, depth + 1))
}

/// De Casteljau's subdivision at the middle.
fn halves(b: &[f64]) -> ([f64; MOST + 1], [f64; MOST + 1]) {
    let n = b.len();
    let (mut first, mut second) = ([0.0; MOST + 1], [0.0; MOST + 1]);
    second[..n].copy_from_slice(b);
    for (level, value) in first[..n].iter_mut().enumerate() {
        *value = second[0];
        for j in 1..n - level {
            second[j - 1] = 0.5 * (second[j - 1] + second[j]);
        }
    }
    (first, second)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Coefficients of `sign · Π (r_i − τ)`, positive at zero for positive roots and sign.
    fn product(roots: &[f64]) -> Vec<f64> {
        let mut power = vec![1.0];
        for root in roots {
            let mut next = vec![0.0; power.len() + 1];
            for (i, a) in power.iter().enumerate() {
                next[i] += a * root;
                next[i + 1] -= a;
            }
            power = next;
        }
        power
    }

    proptest! {
        #[test]
        fn the_smallest_root_is_found(mut roots in prop::collection::vec(0.05..3.0f64, 1..7)) {
            roots.sort_by(f64::total_cmp);
            prop_assume!(roots.windows(2).all(|pair| pair[1] - pair[0] > 0.02));
            let found = first_negative(&product(&roots));
            match found {
                Some(root) => prop_assert!((root - roots[0]).abs() < 1e-8, "{root} {roots:?}"),
                None => prop_assert!(roots[0] >= 1.0 - 1e-8, "{roots:?}"),
            }
        }
    }

    #[test]
    fn a_short_dip_is_seen_and_a_touch_is_not() {
        // (τ − 1/2)² ∓ 1e-10
        let root = first_negative(&[0.25 - 1e-10, -1.0, 1.0]).unwrap();
        assert!((root - (0.5 - 1e-5)).abs() < 1e-10);
        assert_eq!(first_negative(&[0.25 + 1e-10, -1.0, 1.0]), None);
        assert_eq!(first_negative(&[0.0, 0.0, 0.0]), None);
        assert_eq!(first_negative(&[-1e-30, 1.0]), Some(0.0));
    }
}
