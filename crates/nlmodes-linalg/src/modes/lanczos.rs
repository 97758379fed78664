//! Large pencils: block Lanczos steps with `L⁻¹ M L⁻ᵀ`, whose vectors are orthogonal without a product with `M`.

use faer::linalg::matmul::matmul;
use faer::{Accum, Par};

use super::basis::Basis;
use super::operator::Operator;
use super::orthonormal::{Orthonormal, orthonormalise};
use super::{Pencil, diagonal};
use crate::{LinalgError, Mat, max_norm, symmetric_eigen};

/// A Ritz vector has converged when its residual is this fraction of its `θ`.
const TOLERANCE: f64 = 1e-12;

/// If a run in the complement has found nothing above the known modes after this many vectors, and its largest `θ` has
/// converged, it will not find anything later.
const VERIFICATION: usize = 30;

/// Number of vectors of a check in the complement of a run. A missing mode is, in the worst case, a hundredth of the
/// first vector, and dominates all others by the third step.
const BESIDE: usize = 12;

/// Vectors per step if the factor has dense blocks: a solution for four costs little more than for one. Twenty modes of
/// a solid took the same time with six and eight, but wider blocks need more vectors.
const WIDTH: usize = 4;

/// Above this number of modes all steps have this many vectors: most of the work is then orthogonalisation, and several
/// vectors at a time read the basis only once.
const MANY: usize = 64;

/// `L⁻ᵀ u` of the orthonormal Ritz vectors `u` of the `count` largest `θ = 1/(λ + s)`, largest first; fewer if there
/// are no more.
///
/// One run finds at most as many vectors of a multiple `θ` as its blocks have. The run is therefore repeated in the
/// complement of the vectors found, until it finds nothing that belongs to the first `count`.
pub(super) fn invariant_subspace(pencil: &Pencil, operator: &Operator, count: usize) -> Result<Mat<f64>, LinalgError> {
    let n = pencil.mass.nrows();
    let rank = (0..n).filter(|&i| diagonal(pencil.mass, i) > 0.0).count();
    let width = if pencil.factor.has_dense_blocks() || count > MANY { WIDTH } else { 1 };
    let (mut theta, mut found) = (Vec::<f64>::new(), Basis::new(n));
    for seed in 1.. {
        let floor = descending(&theta).get(count - 1).map_or(0.0, |&worst| theta[worst] * (1.0 + 1e-10));
        let Some(run) = Run::start(operator, &found, seed, [n, width, rank]) else { break };
        let wanted = if floor > 0.0 { width } else { count.saturating_sub(theta.len()).max(1) };
        let (batch, ritz, mut run) = run.complete(wanted, floor)?;
        // The vectors of the last step are not in the projection: what they found is still missing.
        run.basis.truncate(run.size());
        if batch.is_empty() {
            break;
        }
        theta.extend(batch);
        let all = found.len() == 0
            && descending(&theta).get(count - 1).is_some_and(|&worst| nothing_missed(&run, theta[worst], rank));
        let basis = run.basis.turned(ritz.as_ref());
        found.join(basis);
        if all {
            break;
        }
    }
    let mut order = descending(&theta);
    order.truncate(count);
    let mut vectors = Mat::zeros(n, order.len());
    order.iter().enumerate().for_each(|(j, &from)| vectors.col_mut(j).copy_from(found.column(from)));
    drop(found);
    Ok(operator.shapes(vectors))
}

/// Whether there is nothing above `floor` orthogonal to all vectors of the first run. The slowest converging vectors
/// are included in them, so the largest `θ` in the complement is far smaller, and converges after few vectors. If this
/// remains undecided, another run decides.
fn nothing_missed(run: &Run<'_>, floor: f64, rank: usize) -> bool {
    let seed = 0x5EED;
    let Some(mut beside) = Run::start(run.operator, &run.basis, seed, [run.current.nrows(), run.width, rank]) else {
        return true;
    };
    loop {
        let more = beside.step();
        if more && beside.size() < BESIDE {
            continue;
        }
        let Ok((theta, s)) = beside.projected() else { return false };
        return theta[0] + beside.residual(&s, 0) < floor;
    }
}

/// Indices of the values, largest first.
fn descending(values: &[f64]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&a, &b| values[b].total_cmp(&values[a]));
    order
}

/// A Lanczos process in the orthogonal complement of the vectors found before.
struct Run<'a> {
    operator: &'a Operator<'a>,
    found: &'a Basis,
    width: usize,
    most: usize,
    /// All Lanczos vectors, those of `current` the last ones.
    basis: Basis,
    previous: Mat<f64>,
    current: Mat<f64>,
    /// Diagonal blocks of the projected operator, and those below them.
    alpha: Vec<Mat<f64>>,
    beta: Vec<Mat<f64>>,
}

impl<'a> Run<'a> {
    /// Starts from `L⁻¹ M r`, which is in the range of the operator. `None` if everything has been found.
    fn start(operator: &'a Operator<'a>, found: &'a Basis, seed: u64, [n, width, rank]: [usize; 3]) -> Option<Self> {
        let most = rank.saturating_sub(found.len());
        let width = width.min(most);
        let mut random = noise(seed);
        let mut start = Mat::zeros(n, width);
        (0..width).for_each(|j| start.col_mut(j).iter_mut().for_each(|v| *v = random()));
        operator.press(&mut start);
        let basis = Basis::new(n);
        let first = orthonormalise([found, &basis], start, 0.0, most);
        let none = Mat::zeros(n, 0);
        let (alpha, beta) = (Vec::new(), Vec::new());
        let mut run = Self { operator, found, width, most, basis, previous: none.clone(), current: none, alpha, beta };
        (first.q.ncols() > 0).then(|| run.append(first))?;
        Some(run)
    }

    fn append(&mut self, block: Orthonormal) {
        self.basis.extend(block.q.as_ref());
        self.previous = std::mem::replace(&mut self.current, block.q);
    }

    /// Columns of the projected operator.
    fn size(&self) -> usize {
        self.alpha.iter().map(Mat::ncols).sum()
    }

    /// One more block of columns of the projected operator. Returns false if the space is exhausted.
    fn step(&mut self) -> bool {
        let mut w = self.current.clone();
        self.operator.apply(&mut w);
        // The three-term recurrence removes most of it; one pass through the basis is then nearly always enough.
        let alpha = self.current.transpose() * &w;
        matmul(w.as_mut(), Accum::Add, &self.current, &alpha, -1.0, Par::Seq);
        if let Some(beta) = self.beta.last() {
            matmul(w.as_mut(), Accum::Add, &self.previous, beta.transpose(), -1.0, Par::Seq);
        }
        self.previous = Mat::zeros(w.nrows(), 0);
        self.alpha.push(alpha);
        let scale = max_norm(self.alpha.iter().flat_map(|a| (0..a.ncols()).map(|i| a[(i, i)])));
        let left = self.most.saturating_sub(self.basis.len());
        let next = orthonormalise([self.found, &self.basis], w, 1e-15 * scale, left);
        self.beta.push(next.r.clone());
        let more = next.q.ncols() > 0;
        if more {
            self.append(next);
        }
        more
    }

    /// Iterates until the `wanted` largest `θ` above `floor` have converged and returns them, and further ones that
    /// have converged, with the coefficients of their vectors in the basis.
    fn complete(mut self, wanted: usize, floor: f64) -> Result<(Vec<f64>, Mat<f64>, Self), LinalgError> {
        let limit = 20 * wanted + 600;
        let wide = 4 * self.width;
        let mut next_look = match (floor > 0.0, self.width) {
            (true, _) => VERIFICATION.max(wide),
            (false, 1) => 2 * wanted + 10,
            (false, _) => wanted + wide,
        };
        let mut before = None;
        loop {
            let more = self.step();
            let size = self.size();
            if more && size < next_look {
                continue;
            }
            let (theta, s) = self.projected()?;
            let noise = 16.0 * f64::EPSILON * theta[0];
            let residual = |i: usize| self.residual(&s, i);
            let excess = |i: usize| residual(i) / (TOLERANCE * theta[i] + noise);
            let open = |i: usize| excess(i) > 1.0;
            let above = theta.iter().take(wanted).filter(|&&t| t > floor.max(noise * 1e-12)).count();
            let converged = (0..above).filter(|&i| !open(i)).count();
            // Values below the floor count only once they have converged.
            let settled = above > 0 || theta[0] + residual(0) < floor || !open(0);
            if !more || (converged == above && settled) {
                // As accurate as the others: vectors found later are orthogonal to them.
                let known = |i: &usize| residual(*i) <= TOLERANCE * theta[*i];
                let aside = (above..theta.len()).take(self.width).take_while(known).count();
                let kept = if above == 0 { 0 } else { above + aside };
                return Ok((theta[..kept].to_vec(), s.subcols(0, kept).to_owned(), self));
            }
            let far = (0..above).map(excess).fold(1.0, f64::max).ln();
            next_look = size + to_next_look(size, far, before);
            before = Some((size, far));
            if size >= limit {
                let (wanted, converged) = (self.found.len() + wanted, self.found.len() + converged);
                return Err(LinalgError::ModesNotConverged { wanted, converged, iterations: size });
            }
        }
    }

    /// Norm of the residual of a Ritz vector, from its coupling to the last block.
    fn residual(&self, s: &Mat<f64>, i: usize) -> f64 {
        let Some(beta) = self.beta.last() else { return 0.0 };
        let last = s.nrows() - beta.ncols();
        let coupled = |row: usize| (0..beta.ncols()).map(|k| beta[(row, k)] * s[(last + k, i)]).sum::<f64>();
        (0..beta.nrows()).map(|row| coupled(row).powi(2)).sum::<f64>().sqrt()
    }

    /// Eigenvalues of the projected operator, largest first, and its eigenvectors.
    fn projected(&self) -> Result<(Vec<f64>, Mat<f64>), LinalgError> {
        let m = self.size();
        let (mut t, mut first) = (Mat::<f64>::zeros(m, m), 0);
        for (alpha, beta) in self.alpha.iter().zip(&self.beta) {
            let p = alpha.ncols();
            for (i, j) in (0..p).flat_map(|i| (0..p).map(move |j| (i, j))) {
                t[(first + i, first + j)] = 0.5 * (alpha[(i, j)] + alpha[(j, i)]);
            }
            let next = first + p;
            if next < m {
                for (i, j) in (0..beta.nrows()).flat_map(|i| (0..p).map(move |j| (i, j))) {
                    (t[(next + i, first + j)], t[(first + j, next + i)]) = (beta[(i, j)], beta[(i, j)]);
                }
            }
            first = next;
        }
        let (values, vectors) = symmetric_eigen(&t)?;
        Ok((values.into_iter().rev().collect(), vectors.reverse_cols().to_owned()))
    }
}

/// Number of further vectors before the next convergence check, from the logarithms of the ratio of the worst residual
/// to its limit at two checks: extrapolated linearly, less a tenth since convergence accelerates; at most a sixth of
/// the space.
fn to_next_look(size: usize, far: f64, before: Option<(usize, f64)>) -> usize {
    let most = (size / 6).max(5);
    match before {
        Some((earlier, farther)) if far > 0.0 && farther > far => {
            let left = 0.9 * far * (size - earlier) as f64 / (farther - far);
            (left as usize).clamp(1, most)
        }
        _ => most,
    }
}

/// Values in −½ … ½, the same in every run.
fn noise(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15);
    move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_next_look_is_where_the_residuals_are_expected_to_have_fallen() {
        // Ten orders in forty vectors, and five left: twenty vectors more, less a tenth. Never more than a sixth of the
        // space.
        let ln = |orders: f64| orders * std::f64::consts::LN_10;
        assert_eq!(to_next_look(240, ln(5.0), Some((200, ln(15.0)))), 18);
        assert_eq!(to_next_look(240, ln(5.0), Some((200, ln(5.5)))), 40);
        assert_eq!(to_next_look(240, ln(5.0), Some((200, ln(4.0)))), 40);
        assert_eq!(to_next_look(240, ln(1e-3), Some((200, ln(15.0)))), 1);
        assert_eq!(to_next_look(12, ln(5.0), None), 5);
    }
}
