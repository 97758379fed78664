//! Products and solutions with one panel for few right-hand sides: the panel is read from memory only once, column by
//! column.

use pulp::{Arch, Simd, WithSimd};

use crate::Mat;

/// Columns that are read side by side.
const TOGETHER: usize = 8;

/// `own ← L⁻¹ own` with the diagonal block of a panel, then `below ← below − B own` with what is below it. One row each
/// for the rows.
pub(super) fn forward<const K: usize>(panel: &Mat<f64>, own: &mut [[f64; K]], below: &mut [[f64; K]]) {
    Arch::new().dispatch(Forward { panel, own, below });
}

/// `own ← L⁻ᵀ (own − Bᵀ below)`.
pub(super) fn backward<const K: usize>(panel: &Mat<f64>, own: &mut [[f64; K]], below: &[[f64; K]]) {
    Arch::new().dispatch(Backward { panel, own, below });
}

struct Forward<'a, const K: usize> {
    panel: &'a Mat<f64>,
    own: &'a mut [[f64; K]],
    below: &'a mut [[f64; K]],
}

impl<const K: usize> WithSimd for Forward<'_, K> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { panel, own, below } = self;
        let mut at = 0;
        while at < own.len() {
            at += match own.len() - at {
                TOGETHER.. => forward_columns::<S, TOGETHER, K>(panel, at, own, below),
                4.. => forward_columns::<S, 4, K>(panel, at, own, below),
                _ => forward_columns::<S, 1, K>(panel, at, own, below),
            };
        }
    }
}

struct Backward<'a, const K: usize> {
    panel: &'a Mat<f64>,
    own: &'a mut [[f64; K]],
    below: &'a [[f64; K]],
}

impl<const K: usize> WithSimd for Backward<'_, K> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { panel, own, below } = self;
        // The same columns together as in the forward solution.
        let mut left = own.len();
        while left > 0 {
            left -= match (left % TOGETHER, left % 4) {
                (0, _) => backward_columns::<S, TOGETHER, K>(panel, left - TOGETHER, own, below),
                (_, 0) => backward_columns::<S, 4, K>(panel, left - 4, own, below),
                _ => backward_columns::<S, 1, K>(panel, left - 1, own, below),
            };
        }
    }
}

/// Columns `at..at + G` of the panel, and their number.
#[inline(always)]
fn forward_columns<S: Simd, const G: usize, const K: usize>(
    panel: &Mat<f64>,
    at: usize,
    own: &mut [[f64; K]],
    below: &mut [[f64; K]],
) -> usize {
    let width = own.len();
    let columns: [&[f64]; G] = std::array::from_fn(|g| panel.col_as_slice(at + g));
    let mut x = [[0.0; K]; G];
    for g in 0..G {
        let mut sum = own[at + g];
        for h in 0..g {
            take::<S, K>(&mut sum, columns[h][at + g], &x[h]);
        }
        x[g] = sum.map(|v| v / columns[g][at + g]);
        own[at + g] = x[g];
    }
    take_rows::<S, G, K>(columns.map(|column| &column[at + G..width]), &x, &mut own[at + G..]);
    take_rows::<S, G, K>(columns.map(|column| &column[width..]), &x, below);
    G
}

#[inline(always)]
fn backward_columns<S: Simd, const G: usize, const K: usize>(
    panel: &Mat<f64>,
    at: usize,
    own: &mut [[f64; K]],
    below: &[[f64; K]],
) -> usize {
    let width = own.len();
    let columns: [&[f64]; G] = std::array::from_fn(|g| panel.col_as_slice(at + g));
    let mut sums: [[f64; K]; G] = std::array::from_fn(|g| own[at + g]);
    take_columns::<S, G, K>(columns.map(|column| &column[at + G..width]), &own[at + G..], &mut sums);
    take_columns::<S, G, K>(columns.map(|column| &column[width..]), below, &mut sums);
    for g in (0..G).rev() {
        let mut sum = sums[g];
        for h in g + 1..G {
            take::<S, K>(&mut sum, columns[g][at + h], &own[at + h]);
        }
        own[at + g] = sum.map(|v| v / columns[g][at + g]);
    }
    G
}

/// `to ← to − Σ_g columns_g x_gᵀ`.
#[inline(always)]
fn take_rows<S: Simd, const G: usize, const K: usize>(columns: [&[f64]; G], x: &[[f64; K]; G], to: &mut [[f64; K]]) {
    let columns = columns.map(|column| &column[..to.len()]);
    for (i, to) in to.iter_mut().enumerate() {
        let mut sum = *to;
        for g in 0..G {
            take::<S, K>(&mut sum, columns[g][i], &x[g]);
        }
        *to = sum;
    }
}

/// `sums_g ← sums_g − Σ_i columns_g[i] x_i`.
#[inline(always)]
fn take_columns<S: Simd, const G: usize, const K: usize>(
    columns: [&[f64]; G],
    x: &[[f64; K]],
    sums: &mut [[f64; K]; G],
) {
    let columns = columns.map(|column| &column[..x.len()]);
    let mut own = *sums;
    for (i, x) in x.iter().enumerate() {
        for g in 0..G {
            take::<S, K>(&mut own[g], columns[g][i], x);
        }
    }
    *sums = own;
}

#[inline(always)]
fn take<S: Simd, const K: usize>(sum: &mut [f64; K], factor: f64, x: &[f64; K]) {
    for r in 0..K {
        // One instruction if the processor has it, otherwise a slow function.
        sum[r] = if S::IS_SCALAR { sum[r] - factor * x[r] } else { (-factor).mul_add(x[r], sum[r]) };
    }
}
