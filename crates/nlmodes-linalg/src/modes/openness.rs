//! What the last digits of the matrices leave open of the modes.

use std::collections::HashMap;

use faer::ColRef;

use super::written::{Entries, Written};
use super::{Modes, diagonal};
use crate::{Digits, Mat, SparseMatrix};

/// What the digits of the matrices leave open of modes.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct Openness {
    /// Standard deviation of each eigenvalue, rad²/s²:
    ///
    /// ```text
    /// σ_λ² = Σ (δK_v Σ_ij φ_i φ_j)² + λ² Σ (δM_v Σ_ij φ_i φ_j)²
    /// ```
    ///
    /// The inner sums are over the entries with one value `v`, as meshes of equal elements have many: these are cut off
    /// alike. In matrices of more than eight million entries each counts by itself. Where the matrices were made of
    /// others ([`Written::origin`]), entries and motions are those of these.
    pub deviations: Vec<f64>,
    /// The largest eigenvalue that a strainless mode might have unnoticed, rad²/s²; zero where there is none. It may be
    /// lost among deviations, or in springs to the ground of less than half a unit `u` of the last digit of the
    /// diagonal, which leave no trace: `Σ u_ii φ_i²` where there is one at each row.
    pub unseen: f64,
    /// So many of the lowest modes strain nothing, as far as the digits tell: they are motions of rigid bodies or of
    /// mechanisms, or they have been lost among the digits.
    pub strainless: usize,
}

impl Openness {
    /// That of the lowest `count` modes alone.
    pub fn of_lowest(&self, count: usize) -> Self {
        let deviations = self.deviations.iter().take(count).copied().collect();
        Self { deviations, strainless: self.strainless.min(count), ..*self }
    }
}

/// Half a unit of the last digit, in deviations.
const HALF_UNIT: f64 = 1.732_050_807_568_877_2;
/// An eigenvalue up to so many deviations is not distinguished from zero.
const UNCERTAIN: f64 = 5.0;
/// One up to so many is that of a motion that strains nothing if [`BALANCED`] and [`GAP`] say so too: programs add up
/// their elements with some more rounding than that of the last binary digit, and not at random. Free bodies of own
/// bricks in double precision had up to 180.
const SUSPECT: f64 = 1e3;
/// The same where decimal digits have been cut off, which is far more than that rounding, but not at random where few
/// values differ: free bodies of CalculiX had up to 5.3.
const SUSPECT_DECIMAL: f64 = 10.0;
/// The force of a motion that strains nothing is at most so many of its deviations, in any row.
const BALANCED: f64 = 100.0;
/// The next eigenvalue is larger by this factor.
const GAP: f64 = 1e6;

/// Up to so many entries, those of one value are taken together; beyond, the table of values would cost more than it
/// tells.
const ALIKE: usize = 1 << 23;

/// A pencil whose entries have these digits.
#[derive(Debug, Clone, Copy)]
pub(super) struct Known<'a> {
    pub stiffness: Entries<'a>,
    pub mass: Entries<'a>,
}

impl<'a> Known<'a> {
    /// `K` and `M`, written as this says.
    pub fn new(stiffness: &'a SparseMatrix, mass: &'a SparseMatrix, written: &'a Written) -> Self {
        Self { stiffness: written.stiffness(stiffness), mass: written.mass(mass) }
    }

    /// Of modes in ascending order.
    pub fn openness(&self, modes: &Modes) -> Openness {
        let sums = self.sums(&modes.vectors);
        // The eigenvalues are never negative; the energies are where the matrix is so.
        let value = |k: usize| if modes.eigenvalues[k] > 0.0 { modes.eigenvalues[k] } else { sums[k].energy };
        let deviation = |k: usize| (sums[k].stiffness + value(k).powi(2) * sums[k].mass).sqrt();
        let deviations: Vec<f64> = (0..modes.eigenvalues.len()).map(deviation).collect();
        let strainless = self.strainless(modes, &deviations, value);
        let limit = |k: usize| if value(k).abs() <= UNCERTAIN * deviations[k] { UNCERTAIN } else { self.suspect() };
        let (written, moved) = (self.stiffness.written(), self.stiffness.moved(&modes.vectors));
        let last = |i: usize| HALF_UNIT * self.stiffness.digits.deviation(diagonal(written, i));
        let shape = |k: usize| moved.col(k).iter().enumerate();
        let lost = |k: usize| shape(k).map(|(i, φ)| last(i) * φ * φ).sum::<f64>();
        let unseen = (0..strainless).map(|k| lost(k).max(limit(k) * deviations[k])).fold(0.0, f64::max);
        Openness { deviations, strainless, unseen }
    }

    /// Deviations up to which an eigenvalue may be that of a motion that strains nothing.
    fn suspect(&self) -> f64 {
        if matches!(self.stiffness.digits, Digits::Decimal(_)) { SUSPECT_DECIMAL } else { SUSPECT }
    }

    /// Whether this may be a motion that strains nothing.
    pub fn is_suspect(&self, modes: &Modes, mode: usize) -> bool {
        let column = modes.vectors.subcols(mode, 1).to_owned();
        let sums = self.sums(&column);
        modes.eigenvalues[mode].max(sums[0].energy) <= self.suspect() * sums[0].stiffness.sqrt()
    }

    fn strainless(&self, modes: &Modes, deviations: &[f64], value: impl Fn(usize) -> f64) -> usize {
        let count = deviations.len();
        let moved = self.stiffness.moved(&modes.vectors);
        let uncertain = (0..count).take_while(|&k| value(k).abs() <= UNCERTAIN * deviations[k]).count();
        let suspect =
            |k: &usize| value(*k).abs() <= self.suspect() * deviations[*k] && self.imbalance(moved.col(*k)) <= BALANCED;
        let all = uncertain + (uncertain..count).take_while(suspect).count();
        let apart = |k: usize| k < count && value(k) >= GAP * value(k - 1).abs();
        if all > uncertain && apart(all) { all } else { uncertain }
    }

    /// Of each column the energy, and what the digits leave open of it.
    fn sums(&self, shapes: &Mat<f64>) -> Vec<Sums> {
        let of = |a: &Entries<'_>| forms(a.written(), &a.moved(shapes), a.digits);
        let (of_stiffness, of_mass) = (of(&self.stiffness), of(&self.mass));
        let both = of_stiffness.into_iter().zip(of_mass);
        both.map(|((energy, stiffness), (_, mass))| Sums { energy, stiffness, mass }).collect()
    }

    /// The largest force of a motion of the written rows, in deviations of the row.
    fn imbalance(&self, shape: ColRef<'_, f64>) -> f64 {
        let (k, digits) = (self.stiffness.written(), self.stiffness.digits);
        let mut rows = vec![(0.0_f64, 0.0_f64); k.nrows()];
        for j in 0..k.ncols() {
            for (&i, &value) in k.symbolic().row_idx_of_col_raw(j).iter().zip(k.val_of_col(j)) {
                rows[i].0 += value * shape[j];
                rows[i].1 += (digits.deviation(value) * shape[j]).powi(2);
            }
        }
        rows.iter().filter(|row| row.1 > 0.0).map(|row| row.0.abs() / row.1.sqrt()).fold(0.0, f64::max)
    }

    /// The mean of `K_ii` over that of `M_ii`: with this shift both count.
    pub fn mean_shift(&self) -> f64 {
        let sum = |a: &SparseMatrix| (0..a.nrows()).map(|i| diagonal(a, i).max(0.0)).sum::<f64>();
        let shift = sum(self.stiffness.matrix) / sum(self.mass.matrix);
        if shift.is_finite() && shift > 0.0 { shift } else { 1.0 }
    }
}

/// `xᵀ A x` and its variance, for the columns of `shapes`.
fn forms(a: &SparseMatrix, shapes: &Mat<f64>, digits: Digits) -> Vec<(f64, f64)> {
    if a.compute_nnz() > ALIKE {
        return each_by_itself(a, shapes, digits);
    }
    let values = Values::of(a);
    (0..shapes.ncols()).map(|k| values.form(a, shapes.col(k), digits)).collect()
}

/// The same where each entry is cut off in its own way, in one pass.
fn each_by_itself(a: &SparseMatrix, shapes: &Mat<f64>, digits: Digits) -> Vec<(f64, f64)> {
    let mut sums = vec![(0.0, 0.0); shapes.ncols()];
    for (i, j, value) in upper(a) {
        let (times, deviation) = (if i == j { 1.0 } else { 2.0 }, digits.deviation(value));
        for (k, (energy, variance)) in sums.iter_mut().enumerate() {
            let product = times * shapes[(i, k)] * shapes[(j, k)];
            *energy += value * product;
            *variance += (deviation * product).powi(2);
        }
    }
    sums
}

/// The different values among the entries of an upper triangle, without their signs.
struct Values {
    values: Vec<f64>,
    /// Of each entry, in order.
    number: Vec<u32>,
}

impl Values {
    fn of(a: &SparseMatrix) -> Self {
        let (mut values, mut known) = (Vec::new(), HashMap::new());
        let number = upper(a).map(|(_, _, value)| {
            *known.entry(value.abs().to_bits()).or_insert_with(|| {
                values.push(value.abs());
                values.len() as u32 - 1
            })
        });
        let number = number.collect();
        Self { values, number }
    }

    /// `xᵀ A x` and its variance.
    fn form(&self, a: &SparseMatrix, x: ColRef<'_, f64>, digits: Digits) -> (f64, f64) {
        let mut products = vec![0.0; self.values.len()];
        for ((i, j, value), &number) in upper(a).zip(&self.number) {
            // An entry and its mirror image are one number.
            let times = if i == j { 1.0 } else { 2.0 };
            products[number as usize] += times * value.signum() * x[i] * x[j];
        }
        let each = || self.values.iter().zip(&products);
        let variance = each().map(|(value, product)| (digits.deviation(*value) * product).powi(2)).sum();
        (each().map(|(value, product)| value * product).sum(), variance)
    }
}

fn upper(a: &SparseMatrix) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
    let column =
        |j: usize| a.symbolic().row_idx_of_col_raw(j).iter().zip(a.val_of_col(j)).map(move |(i, v)| (*i, j, *v));
    (0..a.ncols()).flat_map(column).filter(|(i, j, _)| i <= j)
}

/// `φᵀ K φ`, and the variances of `φᵀ K φ` and `φᵀ M φ`.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    energy: f64,
    stiffness: f64,
    mass: f64,
}
