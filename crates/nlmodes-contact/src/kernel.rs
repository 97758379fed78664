//! Dense kernels on slices: the inner loops of every backend.
//!
//! Written in lanes of `a * b + c`, which the compiler turns into vector instructions on any target; a fused
//! `mul_add` would be a library call where the target has none.

/// `aᵀ b`.
#[inline]
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let n = a.len().min(b.len());
    let ((a8, a_rest), (b8, b_rest)) = (a[..n].as_chunks::<8>(), b[..n].as_chunks::<8>());
    let mut lanes = [0.0; 8];
    for (x, y) in a8.iter().zip(b8) {
        for l in 0..8 {
            lanes[l] += x[l] * y[l];
        }
    }
    let rest: f64 = a_rest.iter().zip(b_rest).fold(0.0, |s, (x, y)| s + x * y);
    let [p, q, r, s] = [0, 1, 2, 3].map(|l| lanes[l] + lanes[l + 4]);
    (p + q) + (r + s) + rest
}

/// `rowsᵀ x` of four rows at once, all as long as `x`.
#[inline]
pub(crate) fn dot4(rows: [&[f64]; 4], x: &[f64]) -> [f64; 4] {
    let n = x.len();
    let (x4, x_rest) = x.as_chunks::<4>();
    let [r0, r1, r2, r3] = rows.map(|r| r[..n].as_chunks::<4>().0);
    let mut lanes = [[0.0; 4]; 4];
    for ((((v, a), b), c), d) in x4.iter().zip(r0).zip(r1).zip(r2).zip(r3) {
        for l in 0..4 {
            lanes[0][l] += a[l] * v[l];
            lanes[1][l] += b[l] * v[l];
            lanes[2][l] += c[l] * v[l];
            lanes[3][l] += d[l] * v[l];
        }
    }
    let mut sums = lanes.map(|l| (l[0] + l[1]) + (l[2] + l[3]));
    let start = n - x_rest.len();
    for (sum, row) in sums.iter_mut().zip(rows) {
        *sum += row[start..n].iter().zip(x_rest).fold(0.0, |s, (a, b)| s + a * b);
    }
    sums
}

/// `y += f x`.
#[inline]
pub(crate) fn axpy(f: f64, x: &[f64], y: &mut [f64]) {
    for (y, x) in y.iter_mut().zip(x) {
        *y += f * x;
    }
}

/// `y += Σ f_k x_k` over four vectors, all at least as long as `y`.
#[inline]
pub(crate) fn axpy4(f: [f64; 4], x: [&[f64]; 4], y: &mut [f64]) {
    let n = y.len();
    let [a, b, c, d] = x.map(|x| &x[..n]);
    for i in 0..n {
        y[i] += (f[0] * a[i] + f[1] * b[i]) + (f[2] * c[i] + f[3] * d[i]);
    }
}

/// `y += Σ_j f_j x_j` over the columns with a factor other than zero.
pub(crate) fn add_columns<'a>(f: &[f64], column: impl Fn(usize) -> &'a [f64], y: &mut [f64]) {
    let (mut pending, mut n) = ([0; 4], 0);
    for (j, _) in f.iter().enumerate().filter(|(_, f)| **f != 0.0) {
        pending[n] = j;
        n += 1;
        if n == 4 {
            axpy4(pending.map(|j| f[j]), pending.map(&column), y);
            n = 0;
        }
    }
    for &j in &pending[..n] {
        axpy(f[j], column(j), y);
    }
}

/// Largest entry by absolute value; zero for an empty slice. NaN is ignored.
pub(crate) fn max_abs(x: &[f64]) -> f64 {
    if x.len() < 8 {
        return x.iter().fold(0.0, |m, v| larger(v.abs(), m));
    }
    let (x8, rest) = x.as_chunks::<8>();
    let mut lanes = [0.0; 8];
    for v in x8 {
        for l in 0..8 {
            lanes[l] = larger(v[l].abs(), lanes[l]);
        }
    }
    lanes.iter().chain(rest).fold(0.0, |m, v| larger(v.abs(), m))
}

/// Whether any of the flags is set.
pub(crate) fn any(flags: &[bool]) -> bool {
    let (eights, rest) = flags.as_chunks::<8>();
    eights.iter().any(|flags| u64::from_le_bytes(flags.map(u8::from)) != 0) || rest.contains(&true)
}

/// Whether no entry is negative or NaN.
pub(crate) fn none_negative(x: &[f64]) -> bool {
    let (x8, rest) = x.as_chunks::<8>();
    x8.iter().all(|v| v.iter().fold(true, |none, v| none & (*v >= 0.0))) && rest.iter().all(|v| *v >= 0.0)
}

/// Bounds of the entries of a vector.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Extent {
    /// `max |x_i|`.
    pub(crate) largest: f64,
    /// `min x_i`, zero for an empty vector.
    pub(crate) least: f64,
}

/// `z_i = x_i p_i` and their extent. None if a product is not finite.
pub(crate) fn products(x: &[f64], p: &[f64], z: &mut [f64]) -> Option<Extent> {
    let ((x4, x_rest), (p4, p_rest), (z4, z_rest)) = (x.as_chunks::<4>(), p.as_chunks::<4>(), z.as_chunks_mut::<4>());
    let (mut largest, mut least, mut sum) = ([0.0; 4], [f64::INFINITY; 4], [0.0; 4]);
    for ((x, p), z) in x4.iter().zip(p4).zip(z4) {
        for l in 0..4 {
            z[l] = x[l] * p[l];
            largest[l] = larger(z[l].abs(), largest[l]);
            least[l] = smaller(z[l], least[l]);
            sum[l] += z[l].abs();
        }
    }
    for ((x, p), v) in x_rest.iter().zip(p_rest).zip(z_rest) {
        *v = x * p;
        largest[0] = larger(v.abs(), largest[0]);
        least[0] = smaller(*v, least[0]);
        sum[0] += v.abs();
    }
    // A finite sum has finite terms; one that is not may have overflowed.
    let finite = sum.iter().all(|s| s.is_finite()) || all_finite(&z[..x.len()]);
    let extent = Extent {
        largest: max_abs(&largest),
        least: if x.is_empty() { 0.0 } else { least.iter().copied().fold(f64::INFINITY, f64::min) },
    };
    finite.then_some(extent)
}

/// `x ← f x`. Returns `max |x_i p_i|`; NaN is ignored.
pub(crate) fn rescale(f: f64, x: &mut [f64], p: &[f64]) -> f64 {
    let ((x4, x_rest), (p4, p_rest)) = (x.as_chunks_mut::<4>(), p.as_chunks::<4>());
    let mut lanes = [0.0; 4];
    for (x, p) in x4.iter_mut().zip(p4) {
        for l in 0..4 {
            x[l] *= f;
            lanes[l] = larger((x[l] * p[l]).abs(), lanes[l]);
        }
    }
    for (x, p) in x_rest.iter_mut().zip(p_rest) {
        *x *= f;
        lanes[0] = larger((*x * p).abs(), lanes[0]);
    }
    max_abs(&lanes)
}

/// `z_i = (x_i f) p_i`. Returns whether all nonzero ones are normal numbers.
pub(crate) fn scaled_products(x: &[f64], f: f64, p: &[f64], z: &mut [f64]) -> bool {
    let ((x4, x_rest), (p4, p_rest), (z4, z_rest)) = (x.as_chunks::<4>(), p.as_chunks::<4>(), z.as_chunks_mut::<4>());
    let (mut least, mut largest) = ([1.0; 4], [0.0; 4]);
    let mut take = |l: usize, x: f64, p: f64| {
        let z = (x * f) * p;
        let size = z.abs();
        least[l] = smaller(if x == 0.0 { 1.0 } else { size }, least[l]);
        largest[l] = larger(size, largest[l]);
        z
    };
    for ((x, p), z) in x4.iter().zip(p4).zip(z4) {
        for l in 0..4 {
            z[l] = take(l, x[l], p[l]);
        }
    }
    for ((x, p), z) in x_rest.iter().zip(p_rest).zip(z_rest) {
        *z = take(0, *x, *p);
    }
    least.iter().all(|l| *l >= f64::MIN_POSITIVE) && largest.iter().all(|l| *l <= f64::MAX)
}

/// The larger one; the second if one is NaN.
#[inline]
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// The smaller one; the second if one is NaN.
#[inline]
fn smaller(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// `max |min(x_i p_i, y_i q_i)|`, and zero plus NaN if anything is not finite.
pub(crate) fn max_abs_min(x: &[f64], p: &[f64], y: &[f64], q: &[f64]) -> f64 {
    let (x4, p4, y4, q4) = (x.as_chunks::<4>(), p.as_chunks::<4>(), y.as_chunks::<4>(), q.as_chunks::<4>());
    let (mut worst, mut poison) = ([0.0; 4], [0.0; 4]);
    // 0 · v is zero for finite v and NaN otherwise.
    for (((x, p), y), q) in x4.0.iter().zip(p4.0).zip(y4.0).zip(q4.0) {
        for l in 0..4 {
            let (a, b) = (x[l] * p[l], y[l] * q[l]);
            worst[l] = larger(smaller(a, b).abs(), worst[l]);
            poison[l] += a * 0.0 + b * 0.0;
        }
    }
    for (((x, p), y), q) in x4.1.iter().zip(p4.1).zip(y4.1).zip(q4.1) {
        let (a, b) = (x * p, y * q);
        worst[0] = larger(smaller(a, b).abs(), worst[0]);
        poison[0] += a * 0.0 + b * 0.0;
    }
    max_abs(&worst) + ((poison[0] + poison[1]) + (poison[2] + poison[3]))
}

/// Whether all entries are finite.
pub(crate) fn all_finite(x: &[f64]) -> bool {
    let (x8, rest) = x.as_chunks::<8>();
    x8.iter().all(|v| v.iter().fold(true, |finite, v| finite & v.is_finite())) && rest.iter().all(|v| v.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kernels_agree_with_their_definitions_at_every_length() {
        for n in 0..40 {
            let x: Vec<f64> = (0..n).map(|i| f64::from(i) + 1.0).collect();
            let rows: Vec<Vec<f64>> = (0..4).map(|r| (0..n).map(|i| f64::from(i * r - 3)).collect()).collect();
            let refs = [0, 1, 2, 3].map(|r: usize| rows[r].as_slice());
            let expected = refs.map(|r| r.iter().zip(&x).map(|(a, b)| a * b).sum::<f64>());
            assert_eq!(dot4(refs, &x), expected);
            assert_eq!(dot(refs[1], &x), expected[1]);
            let (mut y, mut z) = (x.clone(), x.clone());
            axpy4([1.0, 2.0, 3.0, 4.0], refs, &mut y);
            for (f, r) in [1.0, 2.0, 3.0, 4.0].into_iter().zip(refs) {
                axpy(f, r, &mut z);
            }
            assert_eq!(y, z);
            assert!(all_finite(&x));
        }
    }

    #[test]
    fn largest_entries_are_found_wherever_they_are() {
        for n in 1..23 {
            for at in 0..n {
                let (mut x, y, ones) = (vec![0.5; n], vec![3.0; n], vec![1.0; n]);
                x[at] = -2.0;
                assert_eq!(max_abs(&x), 2.0);
                assert!(!none_negative(&x) && none_negative(&y));
                let flags: Vec<bool> = x.iter().map(|v| *v < 0.0).collect();
                assert!(any(&flags) && !any(&vec![false; n]));
                let mut z = vec![0.0; n];
                let extent = products(&x, &y, &mut z).unwrap();
                assert_eq!((extent.largest, extent.least), (6.0, -6.0));
                assert_eq!((z[at], rescale(0.5, &mut z, &y)), (-6.0, 9.0));
                assert!(scaled_products(&x, 2.0, &y, &mut z));
                assert_eq!(z[at], -12.0);
                for abnormal in [1e-310, -1e-310, f64::MAX] {
                    z.copy_from_slice(&ones);
                    z[at] = abnormal;
                    assert!(!scaled_products(&z, 2.0, &y, &mut vec![0.0; n]));
                }
                assert_eq!(max_abs_min(&x, &ones, &y, &ones), 2.0);
                x[at] = f64::INFINITY;
                assert!(max_abs_min(&x, &ones, &y, &ones).is_nan());
                assert!(none_negative(&x));
                assert!(products(&x, &y, &mut z).is_none());
                x[at] = f64::NAN;
                assert!(!none_negative(&x));
                assert!(products(&x, &y, &mut z).is_none());
                x.fill(f64::MAX);
                assert!(products(&x, &ones, &mut z).is_some());
            }
        }
    }

    #[test]
    fn extents_are_those_of_the_entries_in_any_unit() {
        for unit in [2f64.powi(-60), 1.0, 2f64.powi(60)] {
            for n in 1..23 {
                let (x, ones) = (vec![-unit; n], vec![1.0; n]);
                let mut z = vec![0.0; n];
                let extent = products(&x, &ones, &mut z).unwrap();
                assert_eq!((max_abs(&x), extent.largest, extent.least), (unit, unit, -unit));
                assert_eq!(max_abs_min(&x, &ones, &ones, &ones), unit);
                assert_eq!(rescale(0.5, &mut z, &ones), 0.5 * unit);
            }
        }
        assert_eq!(max_abs(&[0.0; 9]), 0.0);
        assert!(none_negative(&[0.0; 9]));
    }

    #[test]
    fn a_single_value_that_is_not_finite_is_found() {
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            for at in 0..19 {
                let mut x = [f64::MAX; 19];
                x[at] = bad;
                assert!(!all_finite(&x));
            }
        }
    }
}
