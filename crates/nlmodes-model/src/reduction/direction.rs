//! Derivatives of free-interface modes by entries of stiffness and mass.

use std::collections::BTreeMap;

use nlmodes_linalg::{Mat, SparseMatrix, Triplet, column, multiply_many, multiply_transposed};

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

/// Derivatives of a number by a structure in free-interface modes, as some of its places see it: a weight for each
/// entry.
#[derive(Debug, Clone, PartialEq)]
pub struct OpenWeights {
    /// Of `Φᵀ K Φ`, m × m.
    pub stiffness: Mat<f64>,
    /// Of `Wᵀ Φ`, places × m.
    pub rows: Mat<f64>,
    /// Of `Wᵀ G W`, places × places, `G` the residual flexibility.
    pub flexibility: Mat<f64>,
}

/// Directions in which stiffness and mass of a structure in free-interface modes change, of which the derivatives of a
/// number are products of few vectors: none of them is a matrix of the modes.
///
/// ```text
/// v = G w ,   z_r = (K − ω_r² M)⁺ M v ,   u_r = (K − ω_r² M)⁺ w = v + ω_r² z_r        w a place, ⁺ beyond the modes
/// dΦ = −½ Φ T + X ,   T = Φᵀ dM Φ ,   X_r = −(K − ω_r² M)⁺ (dK − ω_r² dM) φ_r
/// d(Φᵀ K Φ) = Φᵀ dK Φ − ½ (T Ω² + Ω² T) ,   d(wᵀ φ_r) = −½ wᵀ Φ T_r − u_rᵀ (dK − ω_r² dM) φ_r
/// d(wᵀ G w') = −vᵀ dK v' − vᵀ (dM Φ + M X) Φᵀ w' − wᵀ Φ (Φᵀ dM + Xᵀ M) v'
/// ```
///
/// All of this is linear in `dK` and `dM`: with weights of its left sides it is `Σ dK_ab (S_a · φ_b − F_a · v_b)` and
/// `Σ dM_ab (N_a · φ_b)`, with a row of `S`, `F` and `N` for each degree of freedom that a direction changes.
///
/// The modes are those that change as little as they can, `Φ₀ᵀ M₀ dΦ` symmetric: their stiffness is a full matrix,
/// their mass stays the identity, and neither signs nor modes of one frequency matter. The shift of a structure that
/// floats is in `G`: nothing of this divides by `ω_r²`.
#[derive(Debug, Clone, PartialEq)]
pub struct OpenDirections {
    /// `ω_r²`, zero of rigid modes.
    squares: Vec<f64>,
    /// `Wᵀ Φ`, places × m.
    rows: Mat<f64>,
    /// A column for each degree of freedom that changes: of the modes, of `v`, and of `u_r` and `z_r` of all places,
    /// one mode after the other.
    shapes: Mat<f64>,
    v: Mat<f64>,
    u: Mat<f64>,
    z: Mat<f64>,
    /// The directions, in these columns.
    all: Vec<MatrixDirection>,
}

/// Share of a solution beyond the modes that is left when its iteration ends, and most of its steps: as many as there
/// are modes next to the retained ones.
const SETTLED: f64 = 1e-14;
const MOST_STEPS: usize = 400;

/// Share of `ω²` by which the next mode has to be apart.
const APART: f64 = 1e-8;

impl OpenModes {
    /// These directions, as places see them, columns of `places` (n × any): one solution for each mode and place.
    ///
    /// # Errors
    /// [`ReductionError::Dimension`], for an entry that the structure does not have too; [`ReductionError::NotFinite`];
    /// [`ReductionError::ModesGiven`] of a structure that was reduced elsewhere; [`ReductionError::CutBetweenModes`]
    /// where a mode that is left out has the frequency of one that is not.
    pub fn along(
        &self,
        places: &SparseMatrix,
        directions: &[MatrixDirection],
    ) -> Result<OpenDirections, ReductionError> {
        let n = self.n_dofs();
        crate::reduction::open_modes::same_size("rows of the places", n, places.nrows())?;
        let mut touched = BTreeMap::new();
        for direction in directions {
            for (index, &(i, j, value)) in direction.stiffness.iter().chain(&direction.mass).enumerate() {
                if i.max(j) >= n {
                    let (what, found) = ("degrees of freedom of a direction", i.max(j) + 1);
                    return Err(ReductionError::Dimension { what, expected: n, found });
                }
                if !value.is_finite() {
                    return Err(ReductionError::NotFinite { what: "entry of a direction", index, value });
                }
                touched.extend([(i, 0), (j, 0)]);
            }
        }
        touched.values_mut().enumerate().for_each(|(k, column)| *column = k);
        let dofs: Vec<usize> = touched.keys().copied().collect();
        let numbered = |entries: &[Triplet]| entries.iter().map(|(i, j, v)| (touched[i], touched[j], *v)).collect();
        let numbered =
            |of: &MatrixDirection| MatrixDirection { stiffness: numbered(&of.stiffness), mass: numbered(&of.mass) };
        let mass = self.residual.mass().ok_or(ReductionError::ModesGiven)?;
        let beside = self.residual.beside(&self.shapes);
        let all_v = beside.answer(dense_columns(places, 0..places.ncols()));
        let start = beside.answer(multiply_many(mass, &all_v));
        let squares = self.omega_squared.iter().enumerate();
        let squares: Vec<f64> = squares.map(|(r, square)| if r < self.n_rigid() { 0.0 } else { *square }).collect();
        let (m, p) = (self.n_modes(), places.ncols());
        let (mut u, mut z) = (Mat::zeros(m * p, dofs.len()), Mat::zeros(m * p, dofs.len()));
        for (r, &square) in squares.iter().enumerate() {
            let cut = || ReductionError::CutBetweenModes { mode: r + 1, retained: m };
            let solved = beyond(&beside, mass, square, &start).ok_or_else(cut)?;
            for (k, &dof) in dofs.iter().enumerate() {
                for i in 0..p {
                    z[(r * p + i, k)] = solved[(dof, i)];
                    u[(r * p + i, k)] = all_v[(dof, i)] + square * solved[(dof, i)];
                }
            }
        }
        Ok(OpenDirections {
            squares,
            rows: multiply_transposed(places, &self.shapes),
            shapes: Mat::from_fn(m, dofs.len(), |r, k| self.shapes[(dofs[k], r)]),
            v: Mat::from_fn(p, dofs.len(), |i, k| all_v[(dofs[k], i)]),
            u,
            z,
            all: directions.iter().map(numbered).collect(),
        })
    }
}

impl OpenDirections {
    /// How many places see them.
    pub fn n_places(&self) -> usize {
        self.v.nrows()
    }

    /// The derivative along each direction of a number with these weights.
    ///
    /// # Panics
    /// If the weights are of other modes or places.
    pub fn times(&self, weights: &OpenWeights) -> Vec<f64> {
        let OpenWeights { stiffness, rows, flexibility } = weights;
        let (m, p) = (self.squares.len(), self.v.nrows());
        let both = Mat::from_fn(p, p, |i, j| flexibility[(i, j)] + flexibility[(j, i)]);
        let inertia = both * &self.rows;
        let turned = self.rows.transpose() * rows;
        let massive = Mat::from_fn(m, m, |r, s| {
            -0.5 * (stiffness[(r, s)] * (self.squares[r] + self.squares[s]) + turned[(r, s)])
        });
        let mut of_stiffness = stiffness.transpose() * &self.shapes;
        let mut of_mass = massive.transpose() * &self.shapes;
        for k in 0..self.shapes.ncols() {
            let (u, z) = (column(&self.u, k).chunks(p.max(1)), column(&self.z, k).chunks(p.max(1)));
            for (r, (u, z)) in u.zip(z).enumerate() {
                let (own, inertia) = (column(rows, r), column(&inertia, r));
                let (mut by_stiffness, mut by_mass) = (0.0, 0.0);
                for i in 0..p {
                    by_stiffness += u[i] * own[i] - z[i] * inertia[i];
                    by_mass += u[i] * (self.squares[r] * own[i] - inertia[i]);
                }
                of_stiffness[(r, k)] -= by_stiffness;
                of_mass[(r, k)] += by_mass;
            }
        }
        let of_flexibility = flexibility.transpose() * &self.v;
        let along = |direction: &MatrixDirection| {
            form(&direction.stiffness, &of_stiffness, &self.shapes)
                - form(&direction.stiffness, &of_flexibility, &self.v)
                + form(&direction.mass, &of_mass, &self.shapes)
        };
        self.all.iter().map(along).collect()
    }
}

/// `Σ A_ab x_a · y_b` of columns, `A` symmetric by its entries.
fn form(entries: &[Triplet], x: &Mat<f64>, y: &Mat<f64>) -> f64 {
    let dot = |a: usize, b: usize| column(x, a).iter().zip(column(y, b)).map(|(x, y)| x * y).sum::<f64>();
    let one = |&(a, b, value): &Triplet| value * if a == b { dot(a, b) } else { dot(a, b) + dot(b, a) };
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
