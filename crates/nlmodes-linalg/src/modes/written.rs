//! Where the digits of a pencil are: in its own entries, or in those of matrices of which it was made.

use std::borrow::Cow;
use std::sync::Arc;

use crate::{Digits, LinalgError, Mat, SparseMatrix, add_scaled, multiply_many};

/// How far the entries of `K` and `M` are known: the digits with which they were written, here or in the matrices of
/// which these were made.
#[derive(Debug, Clone)]
pub struct Written {
    /// Digits of the entries of `K` and `M`, or of those of the origin.
    pub digits: [Digits; 2],
    /// What was written, where other unknowns have taken the place of the written ones.
    pub origin: Option<Arc<Origin>>,
}

/// Matrices as they were written (n₀ × n₀), and the motion of their rows in other unknowns (n₀ × n): `K = Tᵀ K₀ T` and
/// `M = Tᵀ M₀ T`.
///
/// An entry of `K` may be a small difference of large ones of `K₀`, with as few digits as these leave.
#[derive(Debug, Clone)]
pub struct Origin {
    /// `K₀`.
    pub stiffness: SparseMatrix,
    /// `M₀`.
    pub mass: SparseMatrix,
    /// `T`.
    pub motion: SparseMatrix,
}

impl From<[Digits; 2]> for Written {
    fn from(digits: [Digits; 2]) -> Self {
        Self { digits, origin: None }
    }
}

impl Written {
    /// The stiffness `K`.
    pub(super) fn stiffness<'a>(&'a self, matrix: &'a SparseMatrix) -> Entries<'a> {
        self.entries(matrix, self.digits[0], self.origin.as_ref().map(|origin| &origin.stiffness))
    }

    /// The mass `M`.
    pub(super) fn mass<'a>(&'a self, matrix: &'a SparseMatrix) -> Entries<'a> {
        self.entries(matrix, self.digits[1], self.origin.as_ref().map(|origin| &origin.mass))
    }

    /// `K + sM`, with what [`origin_of_sum`](Self::origin_of_sum) gives; its digits are those of the stiffness.
    pub(super) fn sum<'a>(&'a self, matrix: &'a SparseMatrix, origin: Option<&'a SparseMatrix>) -> Entries<'a> {
        self.entries(matrix, self.digits[0], origin)
    }

    /// `K₀ + sM₀`, if there is an origin.
    pub(super) fn origin_of_sum(&self, shift: f64) -> Result<Option<SparseMatrix>, LinalgError> {
        self.origin.as_ref().map(|origin| add_scaled(&origin.stiffness, shift, &origin.mass)).transpose()
    }

    fn entries<'a>(
        &'a self,
        matrix: &'a SparseMatrix,
        digits: Digits,
        written: Option<&'a SparseMatrix>,
    ) -> Entries<'a> {
        let motion = self.origin.as_ref().map(|origin| &origin.motion);
        Entries { matrix, digits, origin: written.zip(motion) }
    }
}

/// A matrix, and where its digits are.
#[derive(Debug, Clone, Copy)]
pub(super) struct Entries<'a> {
    /// The matrix `A`.
    pub matrix: &'a SparseMatrix,
    /// Digits of its entries, or of those of `B`.
    pub digits: Digits,
    /// `B` and `T` where `A = Tᵀ B T` was made.
    origin: Option<(&'a SparseMatrix, &'a SparseMatrix)>,
}

impl<'a> Entries<'a> {
    /// Of a matrix that was made in double precision.
    pub fn exact(matrix: &'a SparseMatrix) -> Self {
        Self { matrix, digits: Digits::DOUBLE, origin: None }
    }

    /// The matrix whose entries have the digits: `B` or `A`.
    pub fn written(&self) -> &'a SparseMatrix {
        self.origin.map_or(self.matrix, |(written, _)| written)
    }

    /// Motions of the rows of the written matrix: `T x` or `x`, column by column.
    pub fn moved<'s>(&self, shapes: &'s Mat<f64>) -> Cow<'s, Mat<f64>> {
        self.origin.map_or(Cow::Borrowed(shapes), |(_, motion)| Cow::Owned(multiply_many(motion, shapes)))
    }
}
