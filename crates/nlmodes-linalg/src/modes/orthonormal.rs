//! Orthonormal blocks.

use faer::{MatRef, unzip, zip};

use super::basis::Basis;
use crate::Mat;

/// A column of which less than this fraction remains after orthogonalisation to its block is orthogonalised again.
const CANCELLED: f64 = 0.1;
const MOST_ROUNDS: usize = 4;

/// `W = Q R` up to components in the bases, with orthonormal `Q`.
pub(super) struct Orthonormal {
    pub q: Mat<f64>,
    /// As many rows as `Q` has columns, one column for each of `W`.
    pub r: Mat<f64>,
}

/// Orthogonalises the columns of `w` to the `bases` and makes them orthonormal. Columns of which at most `negligible`
/// remains are dropped, and at most `most` are kept.
pub(super) fn orthonormalise(bases: [&Basis; 2], w: Mat<f64>, negligible: f64, most: usize) -> Orthonormal {
    let (mut block, mut r) = (w, None::<Mat<f64>>);
    let mut round = 1;
    loop {
        take_out(bases, &mut block, negligible);
        // From the second round on columns have length one: a column that is shortened was rounding.
        let least = if round == 1 { negligible } else { 0.5 };
        let (within, cancelled) = gram_schmidt(block, least, most);
        let whole = match r {
            Some(before) => &within.r * before,
            None => within.r,
        };
        if !cancelled || round == MOST_ROUNDS {
            return Orthonormal { q: within.q, r: whole };
        }
        (block, r, round) = (within.q, Some(whole), round + 1);
    }
}

/// Orthogonalises the columns of `w` to the bases, repeatedly as long as a column loses much of its length.
fn take_out(bases: [&Basis; 2], w: &mut Mat<f64>, negligible: f64) {
    let mut before = vec![f64::INFINITY; w.ncols()];
    loop {
        let norms: Vec<f64> = (0..w.ncols()).map(|j| norm(w.as_ref(), j)).collect();
        if norms.iter().zip(&before).all(|(norm, before)| *norm <= negligible || *norm > 0.7 * before) {
            return;
        }
        before = norms;
        for basis in bases {
            let overlap = basis.overlap(w.as_ref());
            basis.take_out(&overlap, w);
        }
    }
}

/// Columns of `w` made orthonormal one after the other, and whether one of them was nearly a combination of the others.
fn gram_schmidt(mut w: Mat<f64>, least: f64, most: usize) -> (Orthonormal, bool) {
    let p = w.ncols();
    let (mut r, mut kept, mut cancelled) = (Mat::zeros(p, p), 0, false);
    for j in 0..p {
        let before = norm(w.as_ref(), j);
        let (done, mut rest) = w.as_mut().split_at_col_mut(j);
        let (done, mut column) = (done.as_ref(), rest.as_mut().col_mut(0));
        for k in 0..kept {
            let share = done.col(k).transpose() * column.as_ref();
            zip!(&mut column, done.col(k)).for_each(|unzip!(to, from)| *to -= share * *from);
            r[(k, j)] = share;
        }
        let left = column.norm_l2();
        if left <= least || kept == most {
            continue;
        }
        cancelled |= left < CANCELLED * before;
        column *= 1.0 / left;
        if kept < j {
            let (mut to, from) = w.as_mut().split_at_col_mut(j);
            to.as_mut().col_mut(kept).copy_from(from.col(0));
        }
        r[(kept, j)] = left;
        kept += 1;
    }
    let q = if kept == p { w } else { w.subcols(0, kept).to_owned() };
    (Orthonormal { q, r: r.subrows(0, kept).to_owned() }, cancelled)
}

fn norm(w: MatRef<'_, f64>, j: usize) -> f64 {
    w.col(j).squared_norm_l2().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dependent_columns_are_dropped_and_the_product_is_what_came_in() {
        let n = 40;
        let column = |i: usize, j: usize| 1e-3 * ((((i + 1) * (3 * j + 2)) % 13) as f64 - 6.0);
        // The third column is nearly, the fourth exactly a sum of the first two.
        let w = Mat::from_fn(n, 4, |i, j| match j {
            2 => column(i, 0) - column(i, 1) + 1e-9 * column(i, 2),
            3 => 2.0 * column(i, 0) + column(i, 1),
            _ => column(i, j),
        });
        let mut basis = Basis::new(n);
        let none = Basis::new(n);
        let first = orthonormalise([&none, &none], Mat::from_fn(n, 1, |i, _| column(i, 5)), 0.0, 9);
        basis.extend(first.q.as_ref());
        let out = orthonormalise([&basis, &none], w.clone(), 1e-14, 9);
        assert_eq!((out.q.ncols(), out.r.nrows(), out.r.ncols()), (3, 3, 4));
        let gram = out.q.transpose() * &out.q;
        assert!((0..3).all(|i| (0..3).all(|j| (gram[(i, j)] - f64::from(i == j)).abs() < 1e-13)), "{gram:?}");
        let beside = basis.overlap(out.q.as_ref());
        assert!((0..3).all(|j| beside[(0, j)].abs() < 1e-13), "{beside:?}");
        let product = &out.q * &out.r + &first.q * basis.overlap(w.as_ref());
        let off = |i: usize, j: usize| (product[(i, j)] - w[(i, j)]).abs();
        assert!((0..n).all(|i| (0..4).all(|j| off(i, j) < 1e-15)));
    }

    #[test]
    fn no_more_columns_are_kept_than_asked_for() {
        let w = Mat::from_fn(12, 5, |i, j| if (i + j) % 3 == 0 { 1.0 + i as f64 } else { 0.5 - j as f64 });
        let none = Basis::new(12);
        assert_eq!(orthonormalise([&none, &none], w, 0.0, 2).q.ncols(), 2);
    }

    #[test]
    fn a_column_behind_a_dropped_one_takes_its_place() {
        let w = Mat::from_fn(5, 3, |i, j| if j < 2 { f64::from(i == 1) } else { f64::from(i == 3) });
        let none = Basis::new(5);
        let out = orthonormalise([&none, &none], w, 1e-15, 9);
        assert_eq!((out.q.ncols(), out.q[(1, 0)], out.q[(3, 1)]), (2, 1.0, 1.0));
        assert_eq!(out.r, Mat::from_fn(2, 3, |i, j| [[1.0, 1.0, 0.0], [0.0, 0.0, 1.0]][i][j]));
    }
}
