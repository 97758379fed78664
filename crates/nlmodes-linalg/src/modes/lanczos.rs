//! Large pencils: Lanczos steps with `(K + sM)⁻¹ M`, which is symmetric in the inner product of `M`.

use faer::{Col, ColRef, MatRef, Side};

use super::{Pencil, column, diagonal};
use crate::{LinalgError, Mat, multiply};

/// A Ritz vector has converged when its residual is this share of its `θ`.
const TOLERANCE: f64 = 1e-12;

/// A deflated run that has nothing above the modes found so far after this many steps will not find it later.
const VERIFICATION_STEPS: usize = 30;

/// M-orthonormal Ritz vectors of the `count` largest `θ = 1/(λ + s)`, largest first; fewer if there are no more.
///
/// One run sees one vector of the space of a multiple `θ`. So the run is repeated in the complement of what was found, until it
/// finds nothing that belongs to the first `count`.
pub(super) fn invariant_subspace(pencil: &Pencil, count: usize) -> Result<Mat<f64>, LinalgError> {
    let rank = (0..pencil.mass.nrows()).filter(|&i| diagonal(pencil.mass, i) > 0.0).count();
    let mut found: Vec<(f64, Vec<f64>)> = Vec::new();
    for seed in 1.. {
        let floor = found.get(count - 1).map_or(0.0, |worst| worst.0 * (1.0 + 1e-10));
        let Some(run) = Run::start(pencil, &found, seed, rank) else { break };
        let batch = run.complete(count.saturating_sub(found.len()).max(1), floor, found.len())?;
        if batch.is_empty() {
            break;
        }
        found.extend(batch);
        found.sort_by(|a, b| b.0.total_cmp(&a.0));
    }
    found.truncate(count);
    Ok(Mat::from_fn(pencil.mass.nrows(), found.len(), |i, j| found[j].1[i]))
}

/// A Lanczos process in the M-orthogonal complement of the vectors found before.
struct Run<'a> {
    pencil: &'a Pencil<'a>,
    n: usize,
    /// Columns found before, then the Lanczos vectors, one after the other.
    basis: Vec<f64>,
    locked: usize,
    most_steps: usize,
    /// Diagonal and subdiagonal of the projected operator.
    alpha: Vec<f64>,
    beta: Vec<f64>,
}

impl<'a> Run<'a> {
    /// Starts from `K⁻¹ M r`, which has no part in the null space of `M`. None if everything has been found.
    fn start(pencil: &'a Pencil<'a>, found: &[(f64, Vec<f64>)], seed: u64, rank: usize) -> Option<Self> {
        let (n, locked) = (pencil.mass.nrows(), found.len());
        let basis = found.iter().flat_map(|f| f.1.iter().copied()).collect();
        let most_steps = rank.saturating_sub(locked);
        let mut run = Self { pencil, n, basis, locked, most_steps, alpha: Vec::new(), beta: Vec::new() };
        let mut v = Col::from_iter(noise(seed, n));
        run.orthogonalise(&mut v);
        let mut v = run.apply(&v);
        let norm = run.orthogonalise(&mut v);
        (most_steps > 0 && norm > 0.0).then(|| run.append(&v, norm))?;
        Some(run)
    }

    /// `(K + sM)⁻¹ M v`.
    fn apply(&self, v: &Col<f64>) -> Col<f64> {
        let mut w = self.mass_times(v);
        self.pencil.factor.solve_in_place(slice_mut(&mut w));
        w
    }

    fn mass_times(&self, v: &Col<f64>) -> Col<f64> {
        let mut mv = Col::zeros(self.n);
        multiply(self.pencil.mass, slice(v), slice_mut(&mut mv));
        mv
    }

    /// Takes the basis out of `w`, twice if the first pass took most of it, and returns what is left of its M-norm.
    fn orthogonalise(&self, w: &mut Col<f64>) -> f64 {
        let basis = MatRef::from_column_major_slice(&self.basis, self.n, self.basis.len() / self.n);
        let mut before = f64::INFINITY;
        loop {
            let mw = self.mass_times(w);
            let norm = dot(w, &mw).sqrt();
            // The square root of a negative number, which is rounding of zero, is not positive either.
            let vanishes = norm.is_nan() || norm == 0.0;
            if vanishes || norm > 0.7 * before {
                return if vanishes { 0.0 } else { norm };
            }
            before = norm;
            let overlap = basis.transpose() * &mw;
            *w -= basis * overlap;
        }
    }

    fn append(&mut self, w: &Col<f64>, norm: f64) {
        self.basis.extend(w.iter().map(|v| v / norm));
    }

    fn steps(&self) -> usize {
        self.alpha.len()
    }

    /// Lanczos vector `j` of this run.
    fn vector(&self, j: usize) -> ColRef<'_, f64> {
        let at = (self.locked + j) * self.n;
        ColRef::from_slice(&self.basis[at..at + self.n])
    }

    /// One more column of the projected operator. False if the space is exhausted.
    fn step(&mut self) -> bool {
        let j = self.steps();
        let v = self.vector(j).to_owned();
        let mut w = self.apply(&v);
        let alpha = dot(&w, &self.mass_times(&v));
        self.alpha.push(alpha);
        // The three-term recurrence takes most of it; one pass through the basis is then enough nearly always.
        w -= alpha * v;
        if j > 0 {
            w -= self.beta[j - 1] * self.vector(j - 1);
        }
        let scale = self.alpha.iter().fold(0.0_f64, |s, a| s.max(a.abs()));
        let beta = self.orthogonalise(&mut w);
        self.beta.push(beta);
        if beta <= 1e-15 * scale || self.steps() == self.most_steps {
            return false;
        }
        self.append(&w, beta);
        true
    }

    /// Iterates until the `wanted` largest `θ` above `floor` have converged and returns them with their vectors.
    fn complete(mut self, wanted: usize, floor: f64, found: usize) -> Result<Vec<(f64, Vec<f64>)>, LinalgError> {
        let limit = 20 * wanted + 600;
        let mut next_look = if floor > 0.0 { VERIFICATION_STEPS } else { 2 * wanted + 10 };
        loop {
            let more = self.step();
            if more && self.steps() < next_look {
                continue;
            }
            next_look = self.steps() + (self.steps() / 6).max(5);
            let (theta, s) = self.projected(wanted + found)?;
            let noise = 16.0 * f64::EPSILON * theta[0];
            let last = self.beta[self.steps() - 1];
            let above = theta.iter().take(wanted).filter(|&&t| t > floor.max(noise * 1e-12)).count();
            let open = |i: usize| (last * s[(self.steps() - 1, i)]).abs() > TOLERANCE * theta[i] + noise;
            let converged = (0..above).filter(|&i| !open(i)).count();
            if !more || converged == above {
                return Ok(self.ritz(&theta, &s, above));
            }
            if self.steps() >= limit {
                return Err(LinalgError::ModesNotConverged {
                    wanted: found + wanted,
                    converged: found + converged,
                    iterations: self.steps(),
                });
            }
        }
    }

    /// Eigenvalues of the projected operator, largest first, and its eigenvectors.
    fn projected(&self, wanted: usize) -> Result<(Vec<f64>, Mat<f64>), LinalgError> {
        let m = self.steps();
        let t = Mat::from_fn(m, m, |i, j| match i.abs_diff(j) {
            0 => self.alpha[i],
            1 => self.beta[i.min(j)],
            _ => 0.0,
        });
        let failed = LinalgError::ModesNotConverged { wanted, converged: 0, iterations: m };
        let eigen = t.self_adjoint_eigen(Side::Lower).map_err(|_| failed)?;
        let values = eigen.S().column_vector().iter().rev().copied().collect();
        Ok((values, eigen.U().reverse_cols().to_owned()))
    }

    /// The first `count` Ritz pairs.
    fn ritz(&self, theta: &[f64], s: &Mat<f64>, count: usize) -> Vec<(f64, Vec<f64>)> {
        let own = &self.basis[self.locked * self.n..][..self.steps() * self.n];
        let vectors = MatRef::from_column_major_slice(own, self.n, self.steps()) * s.subcols(0, count);
        (0..count).map(|i| (theta[i], column(vectors.as_ref(), i).to_vec())).collect()
    }
}

fn dot(a: &Col<f64>, b: &Col<f64>) -> f64 {
    a.transpose() * b
}

fn slice(a: &Col<f64>) -> &[f64] {
    a.try_as_col_major().expect("an owned column is contiguous").as_slice()
}

fn slice_mut(a: &mut Col<f64>) -> &mut [f64] {
    a.try_as_col_major_mut().expect("an owned column is contiguous").as_slice_mut()
}

/// Values in −½ … ½, the same in every run.
fn noise(seed: u64, n: usize) -> impl Iterator<Item = f64> {
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15);
    (0..n).map(move |_| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
    })
}
