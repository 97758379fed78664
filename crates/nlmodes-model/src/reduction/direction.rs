//! Derivatives of free-interface modes by entries of stiffness and mass.

use nlmodes_linalg::{Mat, SparseMatrix, Triplet, multiply_many, multiply_transposed};

use crate::reduction::residual::{Beside, dense_columns};
use crate::reduction::{OpenModes, ReductionError};

/// How stiffness and mass of a structure change with a parameter: `dK` and `dM` per unit of it, symmetric, each entry
/// beside the diagonal given once for itself and its mirror image.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MatrixDirection {
    /// Entries of `dK`.
    pub stiffness: Vec<Triplet>,
    /// Entries of `dM`.
    pub mass: Vec<Triplet>,
}

/// Derivatives of a structure in free-interface modes, as some of its places see it, per unit of a parameter.
///
/// The modes are those that change as little as they can, `Φ₀ᵀ M₀ dΦ` symmetric: their stiffness is a full matrix,
/// their mass stays the identity, and neither signs nor modes of one frequency matter.
#[derive(Debug, Clone, PartialEq)]
pub struct OpenChange {
    /// Of `Φᵀ K Φ`, m × m.
    pub stiffness: Mat<f64>,
    /// Of `Wᵀ Φ`, places × m.
    pub rows: Mat<f64>,
    /// Of `Wᵀ G W`, places × places, `G` the residual flexibility.
    pub flexibility: Mat<f64>,
}

/// A structure in free-interface modes, with what its derivatives need, solved for once: none of them solves anything.
///
/// ```text
/// v = G w ,   z_r = (K − ω_r² M)⁺ M v ,   u_r = (K − ω_r² M)⁺ w = v + ω_r² z_r        w a place, ⁺ beyond the modes
/// dΦ = −½ Φ T + X ,   T = Φᵀ dM Φ ,   X_r = −(K − ω_r² M)⁺ (dK − ω_r² dM) φ_r
/// d(Φᵀ K Φ) = Φᵀ dK Φ − ½ (T Ω² + Ω² T) ,   d(wᵀ φ_r) = −½ wᵀ Φ T_r − u_rᵀ (dK − ω_r² dM) φ_r
/// d(wᵀ G w') = −vᵀ dK v' − vᵀ (dM Φ + M X) Φᵀ w' − wᵀ Φ (Φᵀ dM + Xᵀ M) v'
/// ```
///
/// The shift of a structure that floats is in `G`: nothing of this divides by `ω_r²`.
#[derive(Debug, Clone)]
pub struct OpenDerivative<'a> {
    open: &'a OpenModes,
    /// `Wᵀ Φ`, places × m.
    rows: Mat<f64>,
    /// `v`, n × places, and `z_r` of each mode.
    v: Mat<f64>,
    z: Vec<Mat<f64>>,
}

/// Share of a solution beyond the modes that is left when its iteration ends, and most of its steps: as many as there
/// are modes next to the retained ones.
const SETTLED: f64 = 1e-14;
const MOST_STEPS: usize = 400;

/// Share of `ω²` by which the next mode has to be apart.
const APART: f64 = 1e-8;

impl OpenModes {
    /// What derivatives need of these modes and of places, columns of `places` (n × any).
    ///
    /// # Errors
    /// [`ReductionError::Dimension`]; [`ReductionError::ModesGiven`] of a structure that was reduced elsewhere;
    /// [`ReductionError::CutBetweenModes`] where a mode that is left out has the frequency of one that is not.
    pub fn derivative(&self, places: &SparseMatrix) -> Result<OpenDerivative<'_>, ReductionError> {
        crate::reduction::open_modes::same_size("rows of the places", self.n_dofs(), places.nrows())?;
        let mass = self.residual.mass().ok_or(ReductionError::ModesGiven)?;
        let beside = self.residual.beside(&self.shapes);
        let v = beside.answer(dense_columns(places, 0..places.ncols()));
        let start = beside.answer(multiply_many(mass, &v));
        let squares = self.omega_squared.iter().enumerate();
        let squares = squares.map(|(r, square)| if r < self.n_rigid() { 0.0 } else { *square });
        let z = squares.enumerate().map(|(r, square)| {
            let solved = beyond(&beside, mass, square, &start);
            solved.ok_or(ReductionError::CutBetweenModes { mode: r + 1, retained: self.n_modes() })
        });
        let z = z.collect::<Result<_, _>>()?;
        Ok(OpenDerivative { open: self, rows: multiply_transposed(places, &self.shapes), v, z })
    }
}

impl OpenDerivative<'_> {
    /// The derivatives by a parameter that changes stiffness and mass like this.
    ///
    /// # Errors
    /// [`ReductionError::Dimension`] for an entry that the structure does not have, [`ReductionError::NotFinite`].
    pub fn along(&self, direction: &MatrixDirection) -> Result<OpenChange, ReductionError> {
        let (n, shapes, squares) = (self.open.n_dofs(), &self.open.shapes, &self.open.omega_squared);
        for (index, &(i, j, value)) in direction.stiffness.iter().chain(&direction.mass).enumerate() {
            if i.max(j) >= n {
                let (what, found) = ("degrees of freedom of a direction", i.max(j) + 1);
                return Err(ReductionError::Dimension { what, expected: n, found });
            }
            if !value.is_finite() {
                return Err(ReductionError::NotFinite { what: "entry of a direction", index, value });
            }
        }
        let (m, p) = (self.open.n_modes(), self.v.ncols());
        let (k, mass) = (&direction.stiffness, &direction.mass);
        let t = Mat::from_fn(m, m, |r, s| form(mass, (shapes, r), (shapes, s)));
        let square = |r: usize| if r < self.open.n_rigid() { 0.0 } else { squares[r] };
        let stiffness =
            Mat::from_fn(m, m, |r, s| form(k, (shapes, r), (shapes, s)) - 0.5 * t[(r, s)] * (square(r) + square(s)));
        // `(dK − ω_r² dM)` between a vector and mode r.
        let across = |x: &Mat<f64>, i: usize, r: usize| {
            form(k, (x, i), (shapes, r)) - square(r) * form(mass, (x, i), (shapes, r))
        };
        let of_v = Mat::from_fn(p, m, |i, r| across(&self.v, i, r));
        let of_z = Mat::from_fn(p, m, |i, r| across(&self.z[r], i, r));
        let turned = &self.rows * &t;
        let rows = Mat::from_fn(p, m, |i, r| -0.5 * turned[(i, r)] - of_v[(i, r)] - square(r) * of_z[(i, r)]);
        // `vᵀ (dM Φ + M X)`.
        let inertia = Mat::from_fn(p, m, |i, r| form(mass, (&self.v, i), (shapes, r)) - of_z[(i, r)]);
        let mixed = &inertia * self.rows.transpose();
        let flexibility =
            Mat::from_fn(p, p, |i, j| -form(k, (&self.v, i), (&self.v, j)) - mixed[(i, j)] - mixed[(j, i)]);
        Ok(OpenChange { stiffness, rows, flexibility })
    }
}

/// `xᵀ A y` of columns, `A` symmetric by its entries.
fn form(entries: &[Triplet], (x, i): (&Mat<f64>, usize), (y, j): (&Mat<f64>, usize)) -> f64 {
    let one = |&(a, b, value): &Triplet| {
        let own = x[(a, i)] * y[(b, j)];
        value * if a == b { own } else { own + x[(b, i)] * y[(a, j)] }
    };
    entries.iter().map(one).sum()
}

/// `(K − ω² M)⁺ b` beyond the modes, from the static answers `G b`, column by column: `(1 − ω² G M) z = G b` by
/// conjugate gradients in the inner product of `M`, in which this is positive definite. Few steps, since all modes far
/// above ω answer statically. None where it does not settle.
fn beyond(beside: &Beside<'_>, mass: &SparseMatrix, square: f64, start: &Mat<f64>) -> Option<Mat<f64>> {
    if square == 0.0 {
        return Some(start.clone());
    }
    let (n, p) = (start.nrows(), start.ncols());
    let again = |x: &Mat<f64>| {
        let mut moved = beside.answer(multiply_many(mass, x));
        (0..p).for_each(|j| moved.col_mut(j).iter_mut().for_each(|v| *v *= square));
        moved
    };
    let dots = |a: &Mat<f64>, b: &Mat<f64>| -> Vec<f64> {
        let inertia = multiply_many(mass, b);
        (0..p).map(|j| (0..n).map(|i| a[(i, j)] * inertia[(i, j)]).sum()).collect()
    };
    let add = |to: &mut Mat<f64>, factors: &[f64], from: &Mat<f64>| {
        for (j, factor) in factors.iter().enumerate() {
            to.col_mut(j).iter_mut().zip(from.col(j).iter()).for_each(|(to, from)| *to += factor * from);
        }
    };
    let sizes = dots(start, start);
    let mut x = start.clone();
    let mut residual = again(&x);
    let (mut step, mut squares) = (residual.clone(), dots(&residual, &residual));
    for _ in 0..MOST_STEPS {
        let open: Vec<bool> = (0..p).map(|j| squares[j] > SETTLED * SETTLED * sizes[j]).collect();
        if !open.contains(&true) {
            // What has no mass follows.
            let moved = again(&x);
            return Some(start + moved);
        }
        let image = &step - again(&step);
        let curvatures = dots(&step, &image);
        let lengths_of_step = dots(&step, &step);
        if (0..p).any(|j| open[j] && curvatures[j] <= APART * lengths_of_step[j]) {
            return None;
        }
        let length = |j: usize| if open[j] { squares[j] / curvatures[j] } else { 0.0 };
        let lengths: Vec<f64> = (0..p).map(length).collect();
        add(&mut x, &lengths, &step);
        add(&mut residual, &lengths.iter().map(|l| -l).collect::<Vec<_>>(), &image);
        let next = dots(&residual, &residual);
        for j in 0..p {
            let factor = if open[j] { next[j] / squares[j] } else { 0.0 };
            (0..n).for_each(|i| step[(i, j)] = residual[(i, j)] + factor * step[(i, j)]);
        }
        squares = next;
    }
    None
}
