use crate::{LinalgError, Mat, SparseCholesky, SparseMatrix, add_scaled, asymmetry, max_norm, select, triplets};

mod basis;
mod common;
mod full;
mod lanczos;
mod openness;
mod operator;
mod orthonormal;
mod refine;
mod written;

pub use common::CommonMotions;
pub use openness::Openness;
pub use written::{Origin, Written};

use openness::Known;
use operator::Operator;

/// Up to this number of unknowns, and this number per requested mode, the pencil is solved as a dense one: Lanczos
/// vectors would span half of the space.
const DENSE: [usize; 2] = [20, 4];

/// Modes that are looked at to find those that strain something.
const FEW: usize = 8;

/// Lowest solutions of `K φ = λ M φ`, ascending, with `φᵀ M φ = 1`.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Modes {
    /// λ, squared angular frequencies in rad²/s².
    pub eigenvalues: Vec<f64>,
    /// φ, one a column (n × modes). The largest component of each is positive.
    pub vectors: Mat<f64>,
}

/// Lowest `count` modes of the sparse symmetric pencil `K φ = λ M φ`.
///
/// `M` may be singular (massless degrees of freedom): modes with infinite λ are left out, and fewer than `count` are
/// returned if the pencil has no more. Massless degrees of freedom follow the others statically, `φ_0 = −K_00⁻¹ K_0m
/// φ_m`. `K` may be singular too (rigid-body modes, λ = 0 up to rounding and never negative): the pencil is then solved
/// as `(K + sM) φ = (λ + s) M φ` with an `s > 0` of the size of the first elastic λ.
///
/// The solved problem is always `(K + sM)⁻¹ M φ = φ / (λ + s)`: densely for few rows or if about a quarter of the modes
/// is requested, otherwise by Lanczos steps with `L⁻¹ M L⁻ᵀ` of the factor, with blocks of vectors if the factor has
/// dense blocks, repeated in the complement of the modes found until nothing is missing: multiple λ are returned with
/// all their modes. Each λ is then computed from the quotient `φᵀMφ / φᵀM (K + sM)⁻¹ Mφ`, whose error is the square of
/// that of φ, so that the low modes, which suffer from the conditioning of `K` in the quotient `φᵀKφ / φᵀMφ`, are the
/// most accurate ones. Uniform chains agree with the closed form to some 1e-12 at any size. With rigid-body modes the
/// rounding of the entries of `K + sM` matters: up to 1e-16 times the largest λ of the pencil.
///
/// The result is the same in every run. Where several components of φ have the largest magnitude, the first is
/// positive. Modes of equal λ form an M-orthonormal, otherwise arbitrary basis.
///
/// ```
/// use nlmodes_linalg::{lowest_modes, sparse_from_triplets};
/// // Two unit masses between three unit springs: λ = 1 and 3.
/// let k = sparse_from_triplets(2, 2, &[(0, 0, 2.0), (0, 1, -1.0), (1, 0, -1.0), (1, 1, 2.0)])?;
/// let m = sparse_from_triplets(2, 2, &[(0, 0, 1.0), (1, 1, 1.0)])?;
/// let modes = lowest_modes(&k, &m, 2)?;
/// assert!((modes.eigenvalues[0] - 1.0).abs() < 1e-14 && (modes.eigenvalues[1] - 3.0).abs() < 1e-14);
/// # Ok::<(), nlmodes_linalg::LinalgError>(())
/// ```
///
/// # Errors
/// [`LinalgError::Dimension`] if the matrices are not square and of one size, [`LinalgError::NotSymmetric`],
/// [`LinalgError::NotPositiveDefinite`] if no small shift makes the stiffness positive definite,
/// [`LinalgError::ModesNotConverged`].
pub fn lowest_modes(stiffness: &SparseMatrix, mass: &SparseMatrix, count: usize) -> Result<Modes, LinalgError> {
    check(stiffness, mass)?;
    if count == 0 || (0..mass.nrows()).all(|i| diagonal(mass, i) <= 0.0) {
        return Ok(Modes { eigenvalues: Vec::new(), vectors: Mat::zeros(mass.nrows(), 0) });
    }
    Pencil::of_checked(stiffness, mass)?.lowest(count)
}

fn check(stiffness: &SparseMatrix, mass: &SparseMatrix) -> Result<(), LinalgError> {
    for (what, a) in [("stiffness matrix", stiffness), ("mass matrix", mass)] {
        for found in [a.nrows(), a.ncols()] {
            if found != stiffness.nrows() {
                return Err(LinalgError::Dimension { what, expected: stiffness.nrows(), found });
            }
        }
        if a.val().iter().any(|v| !v.is_finite()) {
            return Err(LinalgError::NotFinite { what });
        }
        if let Some((row, column, value, mirrored)) = asymmetry(a) {
            return Err(LinalgError::NotSymmetric { what, row, column, value, mirrored });
        }
    }
    Ok(())
}

fn diagonal(a: &SparseMatrix, i: usize) -> f64 {
    a.get(i, i).copied().unwrap_or(0.0)
}

/// The pencil `K φ = λ M φ` with the Cholesky factor of `K + sM`, for users who need both modes and statics of one
/// structure: it is factored once. `s` is zero where `K` is positive definite, else of the size of the first elastic λ.
#[derive(Debug)]
pub struct Pencil<'a> {
    stiffness: &'a SparseMatrix,
    mass: &'a SparseMatrix,
    shift: f64,
    factor: SparseCholesky,
    written: Option<Written>,
}

impl<'a> Pencil<'a> {
    /// Checks the two matrices and factors `K`, or `K + sM` if `K` is singular.
    ///
    /// # Errors
    /// As [`lowest_modes`], except that there is no iteration yet if `K` is positive definite.
    pub fn new(stiffness: &'a SparseMatrix, mass: &'a SparseMatrix) -> Result<Self, LinalgError> {
        check(stiffness, mass)?;
        Self::of_checked(stiffness, mass)
    }

    /// The same of matrices whose entries have only these digits, of `K` and of `M`, or were made of such.
    ///
    /// Where these leave open whether a motion strains anything, as of a structure that floats, it does not matter
    /// whether `K` happens to be positive definite in its last digits: `K + sM` is factored, with the first λ that is
    /// distinguished from zero as `s`.
    ///
    /// # Errors
    /// As [`Pencil::new`]; [`LinalgError::NeitherStiffnessNorMass`] if both matrices vanish in some motions.
    pub fn known_to(
        stiffness: &'a SparseMatrix,
        mass: &'a SparseMatrix,
        written: impl Into<Written>,
    ) -> Result<Self, LinalgError> {
        check(stiffness, mass)?;
        let written = written.into();
        let of = |shift, factor| Self { stiffness, mass, shift, factor, written: Some(written.clone()) };
        let held = match SparseCholesky::factor(stiffness, "stiffness matrix") {
            Ok(factor) => match common::nearly_singular(written.stiffness(stiffness), factor)? {
                (false, factor) => return Ok(of(0.0, factor)),
                (true, factor) => Some(factor),
            },
            Err(LinalgError::NotPositiveDefinite { .. }) => None,
            Err(error) => return Err(error),
        };
        let mut floating = match Self::singular(stiffness, mass, Some(&written)) {
            Ok(floating) => floating,
            Err(error) => return Err(common::refuse(stiffness, mass, &written)?.unwrap_or(error)),
        };
        let sum = add_scaled(stiffness, floating.shift, mass)?;
        let origin = written.origin_of_sum(floating.shift)?;
        let (suspect, factor) = common::nearly_singular(written.sum(&sum, origin.as_ref()), floating.factor)?;
        if suspect && let Some(error) = common::refuse(stiffness, mass, &written)? {
            return Err(error);
        }
        floating.factor = factor;
        match held {
            Some(factor) if floating.openness_of_lowest()?.strainless == 0 => Ok(of(0.0, factor)),
            _ => Ok(floating),
        }
    }

    /// What the digits leave open of these modes; nothing where they are not known.
    pub fn openness(&self, modes: &Modes) -> Openness {
        let of = |written| Known::new(self.stiffness, self.mass, written).openness(modes);
        self.written.as_ref().map_or_else(Openness::default, of)
    }

    /// Of the lowest modes, and of one at least that strains something, where there is one.
    fn openness_of_lowest(&self) -> Result<Openness, LinalgError> {
        let mut count = FEW;
        loop {
            let modes = self.solve(count.min(self.mass.nrows()))?;
            let found = self.openness(&modes);
            if found.strainless < modes.eigenvalues.len() || modes.eigenvalues.len() < count {
                return Ok(found);
            }
            count *= 2;
        }
    }

    /// The lowest `count` modes, as from [`lowest_modes`].
    ///
    /// # Errors
    /// [`LinalgError::NotPositiveDefinite`] if the stiffness of the massless degrees of freedom is singular,
    /// [`LinalgError::ModesNotConverged`], [`LinalgError::OutOfMemory`].
    pub fn lowest(&self, count: usize) -> Result<Modes, LinalgError> {
        let massless: Vec<usize> = (0..self.mass.nrows()).filter(|&i| diagonal(self.mass, i) <= 0.0).collect();
        let wanted = count.min(self.mass.nrows() - massless.len());
        if wanted == 0 {
            return Ok(Modes { eigenvalues: Vec::new(), vectors: Mat::zeros(self.mass.nrows(), 0) });
        }
        let mut modes = self.solve(wanted)?;
        follow_statically(self.stiffness, &massless, &mut modes.vectors)?;
        orient(&mut modes.vectors);
        Ok(modes)
    }

    /// The shift `s`, rad²/s²; zero if `K` itself was factored.
    pub fn shift(&self) -> f64 {
        self.shift
    }

    /// The factor of `K + sM`.
    pub fn factor(&self) -> &SparseCholesky {
        &self.factor
    }

    /// The factor of `K + sM`, after the pencil is dropped.
    pub fn into_factor(self) -> SparseCholesky {
        self.factor
    }

    fn of_checked(stiffness: &'a SparseMatrix, mass: &'a SparseMatrix) -> Result<Self, LinalgError> {
        match SparseCholesky::factor(stiffness, "stiffness matrix") {
            Ok(factor) => Ok(Self { stiffness, mass, shift: 0.0, factor, written: None }),
            Err(LinalgError::NotPositiveDefinite { .. }) => Self::singular(stiffness, mass, None),
            Err(error) => Err(error),
        }
    }

    /// Starts from a shift that only has to exceed rounding, and uses the first elastic λ as the final one.
    fn singular(
        stiffness: &'a SparseMatrix,
        mass: &'a SparseMatrix,
        written: Option<&Written>,
    ) -> Result<Self, LinalgError> {
        // Rayleigh quotients of unit vectors: λ_1 is not larger than any of them.
        let quotients = (0..mass.nrows()).filter_map(|i| {
            let quotient = diagonal(stiffness, i) / diagonal(mass, i);
            (quotient > 0.0 && quotient.is_finite()).then_some(quotient)
        });
        let scale = quotients.fold(f64::INFINITY, f64::min);
        let scale = if scale.is_finite() { scale } else { 1.0 };
        let shifted = |shift| Self::shifted(stiffness, mass, shift, written);
        let mut rough = shifted(1e-6 * scale);
        for size in [1e-4, 1e-2] {
            rough = rough.or_else(|_| shifted(size * scale));
        }
        let rough = rough?;
        match rough.first_elastic()? {
            Some(λ) => shifted(λ).or(Ok(rough)),
            None => Ok(rough),
        }
    }

    /// The first λ that is distinguished from zero: by the digits, or as above the rounding of the shift.
    fn first_elastic(&self) -> Result<Option<f64>, LinalgError> {
        let (mut count, n) = (FEW, self.mass.nrows());
        loop {
            let modes = self.solve(count.min(n))?;
            let first = match self.written {
                Some(_) => modes.eigenvalues.get(self.openness(&modes).strainless).copied().filter(|λ| *λ > 0.0),
                None => modes.eigenvalues.iter().copied().find(|&λ| λ > 1e-6 * self.shift),
            };
            if first.is_some() || self.written.is_none() || modes.eigenvalues.len() < count || count >= n {
                return Ok(first);
            }
            count *= 2;
        }
    }

    fn shifted(
        stiffness: &'a SparseMatrix,
        mass: &'a SparseMatrix,
        shift: f64,
        written: Option<&Written>,
    ) -> Result<Self, LinalgError> {
        let sum = add_scaled(stiffness, shift, mass)?;
        let factor = SparseCholesky::factor(&sum, "shifted stiffness matrix")?;
        Ok(Self { stiffness, mass, shift, factor, written: written.cloned() })
    }

    /// Lowest modes, M-orthonormal, of those degrees of freedom that have mass.
    fn solve(&self, count: usize) -> Result<Modes, LinalgError> {
        let n = self.mass.nrows();
        let operator = Operator::new(self);
        let vectors = if n <= DENSE[0] + DENSE[1] * count {
            operator.permuted(&full::invariant_subspace(self, count)?)
        } else {
            lanczos::invariant_subspace(self, &operator, count)?
        };
        let (eigenvalues, vectors) = refine::rayleigh_ritz(&operator, vectors, count, self.shift);
        Ok(Modes { eigenvalues, vectors: operator.restored(&vectors) })
    }
}

/// Replaces the components at the massless degrees of freedom by their equilibrium values.
fn follow_statically(k: &SparseMatrix, massless: &[usize], vectors: &mut Mat<f64>) -> Result<(), LinalgError> {
    if massless.is_empty() {
        return Ok(());
    }
    let mut heavy = vec![true; k.nrows()];
    massless.iter().for_each(|&i| heavy[i] = false);
    let heavy: Vec<usize> = (0..k.nrows()).filter(|&i| heavy[i]).collect();
    let factor = SparseCholesky::factor(&select(k, massless, massless)?, "stiffness of the massless coordinates")?;
    let coupling = select(k, massless, &heavy)?;
    let mut statics = Mat::zeros(massless.len(), vectors.ncols());
    for (i, j, value) in triplets(&coupling) {
        for r in 0..vectors.ncols() {
            statics[(i, r)] -= value * vectors[(heavy[j], r)];
        }
    }
    factor.solve_many(&mut statics);
    for r in 0..vectors.ncols() {
        massless.iter().enumerate().for_each(|(i, &dof)| vectors[(dof, r)] = statics[(i, r)]);
    }
    Ok(())
}

/// Makes the largest component of each column positive; of several equal ones, the first.
fn orient(vectors: &mut Mat<f64>) {
    for j in 0..vectors.ncols() {
        let largest = max_norm(vectors.col(j).iter().copied());
        // Components that differ by rounding count as equal.
        let first = vectors.col(j).iter().find(|v| v.abs() >= (1.0 - 1e-6) * largest);
        if first.is_some_and(|v| *v < 0.0) {
            vectors.col_mut(j).iter_mut().for_each(|v| *v = -*v);
        }
    }
}

#[cfg(test)]
mod tests;
