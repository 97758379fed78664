//! Orthonormal blocks in the inner product of `M`.

use faer::MatRef;

use super::basis::Basis;
use crate::{Mat, SparseMatrix, multiply_many};

/// A column that keeps less than this share of itself beside the others of its block is orthogonalised again as a whole.
const CANCELLED: f64 = 0.1;
const MOST_ROUNDS: usize = 4;

/// `W = Q R` up to what lies in the bases: `Q` M-orthonormal, and `M Q`.
pub(super) struct Orthonormal {
    pub q: Mat<f64>,
    pub mass_q: Mat<f64>,
    /// As many rows as `Q` has columns, one column for each of `W`.
    pub r: Mat<f64>,
}

/// Takes the `bases` out of the columns of `w` and makes them M-orthonormal. Columns of which no more than `negligible` is left are dropped, and no
/// more than `most` are kept.
pub(super) fn orthonormalise(
    mass: &SparseMatrix,
    bases: [&Basis; 2],
    w: Mat<f64>,
    negligible: f64,
    most: usize,
) -> Orthonormal {
    let (mut block, mut r) = (w, None::<Mat<f64>>);
    let mut round = 1;
    loop {
        let mass_block = take_out(mass, bases, &mut block, negligible);
        // From the second round on columns come in with length one: one that is shortened was rounding.
        let least = if round == 1 { negligible } else { 0.5 };
        let (within, cancelled) = gram_schmidt(block.as_ref(), mass_block, least, most);
        let whole = match r {
            Some(before) => &within.r * before,
            None => within.r,
        };
        if !cancelled || round == MOST_ROUNDS {
            return Orthonormal { q: within.q, mass_q: within.mass_q, r: whole };
        }
        (block, r, round) = (within.q, Some(whole), round + 1);
    }
}

/// Takes the bases out of the columns of `w`, again as long as a column lost much of its length; returns `M w`.
fn take_out(mass: &SparseMatrix, bases: [&Basis; 2], w: &mut Mat<f64>, negligible: f64) -> Mat<f64> {
    let mut before = vec![f64::INFINITY; w.ncols()];
    loop {
        let mass_w = multiply_many(mass, w);
        let norms: Vec<f64> = (0..w.ncols()).map(|j| norm(w.as_ref(), mass_w.as_ref(), j)).collect();
        if norms.iter().zip(&before).all(|(norm, before)| *norm <= negligible || *norm > 0.7 * before) {
            return mass_w;
        }
        before = norms;
        for basis in bases {
            let overlap = basis.overlap(mass_w.as_ref());
            basis.take_out(&overlap, w);
        }
    }
}

/// Columns of `w` made orthonormal one after the other, and whether one of them nearly was a combination of others.
fn gram_schmidt(w: MatRef<'_, f64>, mut mass_w: Mat<f64>, least: f64, most: usize) -> (Orthonormal, bool) {
    let (n, p) = (w.nrows(), w.ncols());
    let (mut q, mut mass_q, mut r) = (Mat::zeros(n, p), Mat::zeros(n, p), Mat::zeros(p, p));
    let (mut kept, mut cancelled) = (0, false);
    for j in 0..p {
        let mut column = w.col(j).to_owned();
        let before = norm(w, mass_w.as_ref(), j);
        for k in 0..kept {
            let share = q.col(k).transpose() * mass_w.col(j);
            column -= share * q.col(k);
            mass_w.col_mut(j).iter_mut().zip(mass_q.col(k).iter()).for_each(|(to, from)| *to -= share * from);
            r[(k, j)] = share;
        }
        let left = length(column.as_ref().transpose() * mass_w.col(j));
        if left <= least || kept == most {
            continue;
        }
        cancelled |= left < CANCELLED * before;
        q.col_mut(kept).iter_mut().zip(column.iter()).for_each(|(to, from)| *to = from / left);
        mass_q.col_mut(kept).iter_mut().zip(mass_w.col(j).iter()).for_each(|(to, from)| *to = from / left);
        r[(kept, j)] = left;
        kept += 1;
    }
    let first = |a: Mat<f64>| if kept == p { a } else { a.subcols(0, kept).to_owned() };
    (Orthonormal { q: first(q), mass_q: first(mass_q), r: r.subrows(0, kept).to_owned() }, cancelled)
}

fn norm(w: MatRef<'_, f64>, mass_w: MatRef<'_, f64>, j: usize) -> f64 {
    length(w.col(j).transpose() * mass_w.col(j))
}

/// The root of a square, which rounding may have made negative: then it is that of zero.
fn length(square: f64) -> f64 {
    square.max(0.0).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sparse_from_triplets;

    #[test]
    fn dependent_columns_are_dropped_and_the_product_is_what_came_in() {
        let n = 40;
        let entries: Vec<_> = (0..n).map(|i| (i, i, 1e-6 * (1 + i % 4) as f64)).collect();
        let mass = sparse_from_triplets(n, n, &entries).unwrap();
        let column = |i: usize, j: usize| (((i + 1) * (3 * j + 2)) % 13) as f64 - 6.0;
        // The third column is nearly, the fourth exactly a sum of the first two.
        let w = Mat::from_fn(n, 4, |i, j| match j {
            2 => column(i, 0) - column(i, 1) + 1e-9 * column(i, 2),
            3 => 2.0 * column(i, 0) + column(i, 1),
            _ => column(i, j),
        });
        let mut basis = Basis::new(n);
        let first =
            orthonormalise(&mass, [&Basis::new(n), &Basis::new(n)], Mat::from_fn(n, 1, |i, _| column(i, 5)), 0.0, 9);
        basis.extend(first.q.as_ref());
        let out = orthonormalise(&mass, [&basis, &Basis::new(n)], w.clone(), 1e-14, 9);
        assert_eq!((out.q.ncols(), out.r.nrows(), out.r.ncols()), (3, 3, 4));
        let gram = out.q.transpose() * multiply_many(&mass, &out.q);
        assert!((0..3).all(|i| (0..3).all(|j| (gram[(i, j)] - f64::from(i == j)).abs() < 1e-13)), "{gram:?}");
        let beside = basis.overlap(multiply_many(&mass, &out.q).as_ref());
        assert!((0..3).all(|j| beside[(0, j)].abs() < 1e-13), "{beside:?}");
        let share = basis.overlap(multiply_many(&mass, &w).as_ref());
        let product = &out.q * &out.r + &first.q * share;
        let off = |i: usize, j: usize| (product[(i, j)] - w[(i, j)]).abs();
        assert!((0..n).all(|i| (0..4).all(|j| off(i, j) < 1e-12)));
    }

    #[test]
    fn no_more_columns_are_kept_than_asked_for() {
        let n = 12;
        let mass = sparse_from_triplets(n, n, &(0..n).map(|i| (i, i, 2.0)).collect::<Vec<_>>()).unwrap();
        let w = Mat::from_fn(n, 5, |i, j| if (i + j) % 3 == 0 { 1.0 + i as f64 } else { 0.5 - j as f64 });
        let none = Basis::new(n);
        assert_eq!(orthonormalise(&mass, [&none, &none], w, 0.0, 2).q.ncols(), 2);
    }
}
