//! The matrix in the units in which all backends work.

use faer::MatMut;
use nlmodes_linalg::Mat;

use crate::{
    LcpError,
    factor::{Factor, MANY, Memory, factor_in_place},
    kernel,
};

/// `S A F` with powers of two on the diagonals of `S` and `F`, so that scaling is free of rounding errors and the
/// diagonal is in `[1, 4)`; it is zero for contacts without compliance. `F` is `S` or `S / 2`.
///
/// The result of the solver then does not change by a single bit when the units of length or force, of all contacts or
/// of one, change by a power of two.
#[derive(Debug)]
pub(crate) struct Scaled {
    c: usize,
    entries: Vec<f64>,
    only_opens: bool,
    /// `S`: `b` and `g` scaled are `S b` and `S g`.
    gap_unit: Vec<f64>,
    inverse_gap_unit: Vec<f64>,
    /// `F`: `λ = F λ_scaled`.
    force_unit: Vec<f64>,
    /// Square roots of the scaled diagonal, in `[1, 2)`, and their inverses: the step to an exact unit diagonal.
    root: Vec<f64>,
    inverse_root: Vec<f64>,
}

impl Scaled {
    /// `a` must be square and finite.
    pub(crate) fn new(a: &Mat<f64>) -> Self {
        let c = a.nrows();
        let (gap_unit, force_unit) = units(a);
        let mut entries = Vec::with_capacity(c * c);
        extend_scaled(a, &gap_unit, &force_unit, &mut entries);
        let root: Vec<f64> = (0..c).map(|i| entries[i * c + i]).map(|d| if d > 0.0 { d.sqrt() } else { 1.0 }).collect();
        let inverse_root = root.iter().map(|r| 1.0 / r).collect();
        let only_opens = kernel::none_negative(&entries);
        let inverse_gap_unit = gap_unit.iter().map(|u| 1.0 / u).collect();
        Self { c, entries, only_opens, gap_unit, inverse_gap_unit, force_unit, root, inverse_root }
    }

    pub(crate) fn is_finite(&self) -> bool {
        kernel::all_finite(&self.entries)
    }

    /// Whether no entry is negative: forces only open gaps.
    pub(crate) fn only_opens(&self) -> bool {
        self.only_opens
    }

    pub(crate) fn n_contacts(&self) -> usize {
        self.c
    }

    /// Column `j`, which is also row `j`.
    pub(crate) fn column(&self, j: usize) -> &[f64] {
        &self.entries[j * self.c..(j + 1) * self.c]
    }

    pub(crate) fn diagonal(&self, j: usize) -> f64 {
        self.entries[j * self.c + j]
    }

    pub(crate) fn gap_unit(&self) -> &[f64] {
        &self.gap_unit
    }

    /// Exact, as all units are powers of two.
    pub(crate) fn inverse_gap_unit(&self) -> &[f64] {
        &self.inverse_gap_unit
    }

    pub(crate) fn force_unit(&self) -> &[f64] {
        &self.force_unit
    }

    /// `g = A λ + b`; columns with a zero force cost nothing.
    pub(crate) fn gap(&self, b: &[f64], lambda: &[f64], g: &mut [f64]) {
        g.copy_from_slice(b);
        kernel::add_columns(lambda, |j| self.column(j), g);
    }

    /// `b ← f b`. Returns the size of `b` with the diagonal of `A` scaled to one exactly: `max |D b|`.
    pub(crate) fn rescale(&self, f: f64, b: &mut [f64]) -> f64 {
        kernel::rescale(f, b, &self.inverse_root)
    }

    /// The judge: `max |min(D⁻¹ λ, D g)| / size` with the diagonal of `A` scaled to one exactly.
    ///
    /// Infinite if anything is not finite, zero if nothing is violated.
    pub(crate) fn violation(&self, size: f64, lambda: &[f64], g: &[f64]) -> f64 {
        let worst = kernel::max_abs_min(lambda, &self.root, g, &self.inverse_root);
        if worst == 0.0 {
            0.0
        } else if worst.is_finite() {
            worst / size
        } else {
            f64::INFINITY
        }
    }

    /// Checks that `A + 1e-13 c I` has a Cholesky factor. Rounding errors of a singular `A` are smaller.
    ///
    /// For many contacts the factor is computed by blocks, in place of the entries, which are restored from `a`
    /// afterwards; if there is no factor, it is computed row by row, to find the contact.
    pub(crate) fn check_semidefinite(&mut self, a: &Mat<f64>) -> Result<(), LcpError> {
        let shift = 1e-13 * self.c as f64;
        if self.c >= MANY && (0..self.c).all(|i| self.diagonal(i) >= 0.0) {
            let definite = self.factor_with(shift);
            self.entries.clear();
            extend_scaled(a, &self.gap_unit, &self.force_unit, &mut self.entries);
            if definite {
                return Ok(());
            }
        }
        let mut factor = Factor::default();
        for contact in 0..self.c {
            let slack = shift * self.root[contact] * self.root[contact];
            let pivot = factor.try_append(self, contact, slack);
            if pivot <= 0.0 || self.diagonal(contact) < 0.0 {
                return Err(LcpError::NotPositiveSemidefinite { contact, pivot: pivot - slack });
            }
        }
        Ok(())
    }

    /// Replaces the entries by the factor of them plus this multiple of the diagonal. Returns whether there is one.
    fn factor_with(&mut self, shift: f64) -> bool {
        for (i, root) in self.root.iter().enumerate() {
            self.entries[i * self.c + i] += shift * root * root;
        }
        let matrix = MatMut::from_column_major_slice_mut(&mut self.entries, self.c, self.c);
        factor_in_place(matrix, &mut Memory::default())
    }
}

/// `S A F`, column by column.
fn extend_scaled(a: &Mat<f64>, gap_unit: &[f64], force_unit: &[f64], entries: &mut Vec<f64>) {
    for (j, force_unit) in force_unit.iter().enumerate() {
        entries.extend(a.col_as_slice(j).iter().zip(gap_unit).map(|(v, unit)| (v * unit) * force_unit));
    }
}

/// Powers of two `S`, `F` with `1 ≤ S_i A_ii F_i < 4`, bit for bit the same `S A F` whatever power of two the units
/// of `A` are multiplied by. An odd power cannot be split between `S` and `F` evenly: the parity of the first contact
/// goes to `F`.
fn units(a: &Mat<f64>) -> (Vec<f64>, Vec<f64>) {
    let diagonal = || (0..a.nrows()).map(|i| a[(i, i)]);
    let reference = diagonal().find(|d| *d > 0.0).map_or(0, exponent);
    // A contact without compliance has no scale of its own: it gets the largest.
    let largest = diagonal().filter(|d| *d > 0.0).map(exponent).max().unwrap_or(0);
    let half = |e: i32| -(e - reference).div_euclid(2) - reference.div_euclid(2);
    let powers: Vec<i32> = diagonal().map(|d| half(if d > 0.0 { exponent(d) } else { largest })).collect();
    let parity = reference.rem_euclid(2);
    let unit = |shift: i32| powers.iter().map(|e| power_of_two(e - shift)).collect();
    (unit(0), unit(parity))
}

/// `e` with `2^e ≤ x < 2^(e+1)` for a positive finite x.
pub(crate) fn exponent(x: f64) -> i32 {
    let biased = |x: f64| ((x.to_bits() >> 52) & 0x7ff) as i32 - 1023;
    if x >= f64::MIN_POSITIVE { biased(x) } else { biased(x * power_of_two(100)) - 100 }
}

/// `2^e`, exact; the nearest power of two that is a normal number outside its range.
pub(crate) fn power_of_two(e: i32) -> f64 {
    f64::from_bits(((e.clamp(-1022, 1023) + 1023) as u64) << 52)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_of_two_are_exact_and_stay_normal() {
        for e in [-1022, -1021, -53, -1, 0, 1, 52, 1022, 1023] {
            assert_eq!(power_of_two(e), 2f64.powi(e), "{e}");
        }
        assert_eq!([power_of_two(-5000), power_of_two(5000)], [f64::MIN_POSITIVE, 2f64.powi(1023)]);
    }

    #[test]
    fn exponents_are_those_of_the_power_below() {
        let smallest = 5e-324;
        for (x, e) in [
            (1.0, 0),
            (1.999, 0),
            (2.0, 1),
            (0.75, -1),
            (f64::MIN_POSITIVE, -1022),
            (f64::MAX, 1023),
            (smallest, -1074),
        ] {
            assert_eq!(exponent(x), e, "{x}");
        }
    }

    #[test]
    fn the_scaled_diagonal_lies_between_one_and_four_whatever_the_units() {
        let sizes = [3e-290, 1e-9, 0.7, 1.0, 2.0, 5e3, 8e290, 0.0];
        for first in 0..sizes.len() {
            let diagonal = |i: usize| sizes[(i + first) % sizes.len()];
            let scaled = Scaled::new(&Mat::from_fn(8, 8, |i, j| if i == j { diagonal(i) } else { 0.0 }));
            for i in 0..8 {
                let (d, exact) = (scaled.diagonal(i), (diagonal(i) * scaled.gap_unit()[i]) * scaled.force_unit()[i]);
                assert_eq!(d, exact);
                assert!(
                    if diagonal(i) == 0.0 { d == 0.0 } else { (1.0..4.0).contains(&d) },
                    "{} becomes {d}",
                    diagonal(i)
                );
                assert_eq!(scaled.gap_unit()[i] * scaled.inverse_gap_unit()[i], 1.0);
            }
        }
    }
}
