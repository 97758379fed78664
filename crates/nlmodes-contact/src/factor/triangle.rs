//! Solves with the packed triangle.

use super::offset;
use crate::kernel;

fn row(rows: &[f64], i: usize) -> &[f64] {
    &rows[offset(i)..offset(i) + i]
}

fn four_rows(rows: &[f64], i: usize) -> [&[f64]; 4] {
    [row(rows, i), row(rows, i + 1), row(rows, i + 2), row(rows, i + 3)]
}

/// Four rows at a time.
pub(super) fn forward(rows: &[f64], inverse_diagonal: &[f64], x: &mut [f64]) {
    let whole = x.len() / 4 * 4;
    for i in (0..whole).step_by(4) {
        forward_block(four_rows(rows, i), &inverse_diagonal[i..i + 4], x, i);
    }
    forward_rest(rows, &inverse_diagonal[..x.len()], x, whole);
}

/// The products of four rows with the finished part, then the small triangle.
#[inline]
fn forward_block(block: [&[f64]; 4], inverse_diagonal: &[f64], x: &mut [f64], i: usize) {
    let (done, rest) = x.split_at_mut(i);
    let sums = kernel::dot4(block.map(|r| &r[..i]), done);
    for k in 0..4 {
        let mut v = rest[k] - sums[k];
        for l in 0..k {
            v -= block[k][i + l] * rest[l];
        }
        rest[k] = v * inverse_diagonal[k];
    }
}

fn forward_rest(rows: &[f64], inverse_diagonal: &[f64], x: &mut [f64], whole: usize) {
    for (i, inverse) in inverse_diagonal.iter().enumerate().skip(whole) {
        let (done, rest) = x.split_at_mut(i);
        rest[0] = (rest[0] - kernel::dot(row(rows, i), done)) * inverse;
    }
}

pub(super) fn backward(rows: &[f64], inverse_diagonal: &[f64], x: &mut [f64]) {
    let n = x.len();
    let whole = n / 4 * 4;
    for i in (whole..n).rev() {
        let (head, tail) = x.split_at_mut(i);
        tail[0] *= inverse_diagonal[i];
        kernel::axpy(-tail[0], row(rows, i), head);
    }
    for i in (0..whole).step_by(4).rev() {
        let block = four_rows(rows, i);
        let (head, tail) = x.split_at_mut(i);
        for k in (0..4).rev() {
            for l in k + 1..4 {
                tail[k] -= block[l][i + k] * tail[l];
            }
            tail[k] *= inverse_diagonal[i + k];
        }
        kernel::axpy4([-tail[0], -tail[1], -tail[2], -tail[3]], block, head);
    }
}

/// [`forward`] of several vectors of n entries at once, so that the triangle is read only once.
pub(super) fn forward_all(rows: &[f64], inverse_diagonal: &[f64], xs: &mut [&mut [f64]]) {
    let n = inverse_diagonal.len();
    let whole = n / 4 * 4;
    for i in (0..whole).step_by(4) {
        let block = four_rows(rows, i);
        for x in xs.iter_mut() {
            forward_block(block, &inverse_diagonal[i..i + 4], x, i);
        }
    }
    for x in xs.iter_mut() {
        forward_rest(rows, inverse_diagonal, x, whole);
    }
}
