use nlmodes_linalg::Mat;

use crate::{LcpError, LcpMatrix};

/// A linear elastic body with massless contact nodes: displacements with contact from those without, and their
/// derivative.
///
/// ```text
/// u = u_free + C W λ ,   g = Wᵀ u + g₀ ,   0 ≤ g ⊥ λ ≥ 0
/// ```
///
/// `u` (n, m) are the displacements of the contact nodes, `u_free` those without contact forces, `C` (n × n, m/N) the
/// compliance of the body at these nodes, column i of `W` (n × c) the direction in which contact i opens, and `g₀` (c,
/// m) the gaps of the undeformed body; `g` is zero where a contact is closed, whatever the deflection of its stop. So
/// `A = Wᵀ C W` and `b = Wᵀ u_free + g₀`. In mixed-shooting harmonic balance, eqs. (11), (13), `u = q_N`, `C = K_NN⁻¹`
/// and `u_free = −K_NN⁻¹ K_NL q_L`: the derivative of `q_N` with respect to `q_L` is that of `u` with respect to
/// `u_free` times `−K_NN⁻¹ K_NL`.
///
/// ```
/// use nlmodes_contact::{ActiveSet, ContactBody, Mat, Series, SeriesSolution, Start};
/// // Two nodes, 2 µm per N under a load and 1 µm per N across; the first has a stop on either side.
/// let c = |i: usize, j: usize| if i == j { 2e-6 } else { 1e-6 };
/// let w = Mat::from_fn(2, 2, |node, contact| [[1.0, -1.0], [0.0, 0.0]][node][contact]);
/// let c_w = Mat::from_fn(2, 2, |node, contact| c(node, 0) * w[(0, contact)]);
/// let body = ContactBody::new(w, c_w, vec![1e-3, 1e-3])?;
/// let mut series = Series::of_body(&body, &ActiveSet::default())?;
/// let (free, mut solution) = ([-3e-3, 0.0], SeriesSolution::default());
/// series.solve(&body.free_gaps(&free)?, Start::Cold, &mut solution)?;
/// let mut u = [0.0; 2];
/// body.displacements(&free, solution.lambda(0), &mut u)?;
/// // The first node remains at its stop, and the second moves by half of the displacement removed from the first.
/// assert!((u[0] + 1e-3).abs() < 1e-15 && (u[1] - 1e-3).abs() < 1e-15);
/// let response = series.response(solution.closed(0))?;
/// let p = response.displacement();
/// assert!(p[(0, 0)].abs() < 1e-12 && (p[(1, 0)] + 0.5).abs() < 1e-12 && (p[(1, 1)] - 1.0).abs() < 1e-12);
/// # Ok::<(), nlmodes_contact::LcpError>(())
/// ```
#[derive(Debug, Clone)]
pub struct ContactBody {
    w: Mat<f64>,
    compliance_w: Mat<f64>,
    gaps: Vec<f64>,
    matrix: LcpMatrix,
}

/// Linear response of a body while a set of contacts remains closed.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct ClosedResponse {
    /// `S = dλ/db` (c × c, N/m): [`LcpMatrix::sensitivity`].
    pub lambda: Mat<f64>,
    /// `dg/db = I + A S` (c × c, no unit). The rows of closed contacts vanish.
    pub gaps: Mat<f64>,
    /// `I − du/du_free = −C W S Wᵀ` (n × n, no unit): the part of a free displacement that the closed contacts prevent.
    pub blocked: Mat<f64>,
    /// `C W S g₀` (n, m): `u = (du/du_free) u_free + offset`.
    pub offset: Vec<f64>,
}

impl ClosedResponse {
    /// `P = du/du_free = I + C W S Wᵀ` (n × n, no unit).
    ///
    /// A projection where all stops are rigid, `P P = P`: onto the displacements that do not change the closed gaps,
    /// `W_aᵀ P = 0`, closest to the free displacement in the energy norm of the body. Unlike `dλ/db`, it is unique even
    /// if closed contacts are redundant.
    pub fn displacement(&self) -> Mat<f64> {
        let n = self.blocked.nrows();
        Mat::from_fn(n, n, |i, j| f64::from(u8::from(i == j)) - self.blocked[(i, j)])
    }
}

impl ContactBody {
    /// From `w` (n × c), `compliance_w` = `C W` (n × c, m/N) and the gaps `gaps` = `g₀` (c, m) of the undeformed body.
    ///
    /// `Wᵀ C W` may be asymmetric by 1e-6 of its diagonal, the rounding error of a solution with an ill-conditioned
    /// stiffness.
    ///
    /// # Errors
    /// [`LcpError::Dimension`] if the shapes do not agree, [`LcpError::NotFinite`], or an error of [`LcpMatrix::new`]
    /// for `A`.
    pub fn new(w: Mat<f64>, compliance_w: Mat<f64>, gaps: Vec<f64>) -> Result<Self, LcpError> {
        let same = |what, expected, found| {
            if expected == found { Ok(()) } else { Err(LcpError::Dimension { what, expected, found }) }
        };
        same("rows of C W", w.nrows(), compliance_w.nrows())?;
        same("columns of C W", w.ncols(), compliance_w.ncols())?;
        same("gaps of the undeformed body", w.ncols(), gaps.len())?;
        if gaps.iter().any(|g| !g.is_finite()) {
            return Err(LcpError::NotFinite { what: "a gap of the undeformed body" });
        }
        let matrix = LcpMatrix::new(&symmetric(&(w.transpose() * &compliance_w))?)?;
        Ok(Self { w, compliance_w, gaps, matrix })
    }

    /// The same body with elastic stops: contact i has the compliance `compliance[i]` (c, m/N, not negative; zero for a
    /// rigid stop), in series with the body, `A = Wᵀ C W + diag(compliance)`.
    ///
    /// # Errors
    /// [`LcpError::Dimension`] if there are not c of them, or an error of [`LcpMatrix::new`] for `A`.
    pub fn with_stop_compliance(self, compliance: &[f64]) -> Result<Self, LcpError> {
        let (expected, found) = (self.gaps.len(), compliance.len());
        if expected != found {
            return Err(LcpError::Dimension { what: "compliances of the stops", expected, found });
        }
        let mut a = self.matrix.a().clone();
        compliance.iter().enumerate().for_each(|(i, c)| a[(i, i)] += c);
        Ok(Self { matrix: LcpMatrix::new(&a)?, ..self })
    }

    /// `A = Wᵀ C W` and, in its diagonal, the compliance of the stops; c × c, m/N.
    pub fn matrix(&self) -> &LcpMatrix {
        &self.matrix
    }

    /// `C W`, n × c, m/N: displacements by a unit force at each contact.
    pub fn compliance_w(&self) -> &Mat<f64> {
        &self.compliance_w
    }

    /// Gaps `g₀` of the undeformed body, c, m.
    pub fn gaps(&self) -> &[f64] {
        &self.gaps
    }

    /// Number of displacements n.
    pub fn n_displacements(&self) -> usize {
        self.w.nrows()
    }

    /// Gaps without contact forces, `b = Wᵀ u_free + g₀`, sample by sample (c each, m).
    ///
    /// # Errors
    /// [`LcpError::Dimension`] if `u_free` (n each, m) is not a whole number of samples.
    pub fn free_gaps(&self, u_free: &[f64]) -> Result<Vec<f64>, LcpError> {
        let n = self.n_displacements();
        let samples = u_free.len() / n.max(1);
        if samples * n != u_free.len() {
            let (expected, found) = ((samples + 1) * n, u_free.len());
            return Err(LcpError::Dimension { what: "u_free of whole samples", expected, found });
        }
        let gap = |u: &[f64], i: usize| self.w.col(i).iter().zip(u).map(|(w, u)| w * u).sum::<f64>() + self.gaps[i];
        let sample = |k: usize| {
            let u = &u_free[k * n..(k + 1) * n];
            (0..self.gaps.len()).map(move |i| gap(u, i))
        };
        Ok((0..samples).flat_map(sample).collect())
    }

    /// Displacements `u = u_free + C W λ` (n, m) of one sample.
    ///
    /// # Errors
    /// [`LcpError::Dimension`] if a slice has not n, c, n entries.
    pub fn displacements(&self, u_free: &[f64], lambda: &[f64], u: &mut [f64]) -> Result<(), LcpError> {
        let (n, c) = (self.n_displacements(), self.gaps.len());
        for (what, expected, found) in [("u_free", n, u_free.len()), ("lambda", c, lambda.len()), ("u", n, u.len())] {
            if expected != found {
                return Err(LcpError::Dimension { what, expected, found });
            }
        }
        u.copy_from_slice(u_free);
        for (i, force) in lambda.iter().enumerate().filter(|(_, force)| **force != 0.0) {
            u.iter_mut().zip(self.compliance_w.col(i).iter()).for_each(|(u, c)| *u += c * force);
        }
        Ok(())
    }

    /// Derivatives with the contacts of `closed` kept closed and all others open. Where closed contacts are redundant,
    /// forces are those of an independent subset; gaps and displacements do not depend on the choice.
    ///
    /// At a degenerate contact (`g = λ = 0`) open and closed both give a valid generalised derivative.
    ///
    /// # Errors
    /// [`LcpError::Dimension`] if `closed` has not c entries.
    pub fn response(&self, closed: &[bool]) -> Result<ClosedResponse, LcpError> {
        let lambda = self.matrix.sensitivity(closed)?;
        let gaps = gap_derivative(&self.matrix, &lambda, closed);
        let shift = &self.compliance_w * &lambda;
        let blocked = -(&shift * self.w.transpose());
        let offset = (0..shift.nrows()).map(|d| self.gaps.iter().enumerate().map(|(i, g)| shift[(d, i)] * g).sum());
        Ok(ClosedResponse { lambda, gaps, blocked, offset: offset.collect() })
    }
}

/// A body of which only the gaps matter: `u = g`, `u_free = b`.
pub(crate) fn response_of_gaps(matrix: &LcpMatrix, closed: &[bool]) -> Result<ClosedResponse, LcpError> {
    let lambda = matrix.sensitivity(closed)?;
    let gaps = gap_derivative(matrix, &lambda, closed);
    let c = closed.len();
    let blocked = Mat::from_fn(c, c, |i, j| f64::from(u8::from(i == j)) - gaps[(i, j)]);
    Ok(ClosedResponse { lambda, gaps, blocked, offset: vec![0.0; c] })
}

/// `I + A S`, with exact zeros for the gaps that remain closed.
fn gap_derivative(matrix: &LcpMatrix, lambda: &Mat<f64>, closed: &[bool]) -> Mat<f64> {
    let c = closed.len();
    let mut product = matrix.a() * lambda;
    for j in 0..c {
        product[(j, j)] += 1.0;
        (0..c).filter(|i| closed[*i]).for_each(|i| product[(i, j)] = 0.0);
    }
    product
}

/// The mean of `a` and its transpose.
fn symmetric(a: &Mat<f64>) -> Result<Mat<f64>, LcpError> {
    let size = |i: usize| a[(i, i)].abs().sqrt();
    for column in 0..a.ncols() {
        for row in 0..column {
            let (value, transposed) = (a[(row, column)], a[(column, row)]);
            if (value - transposed).abs() > 1e-6 * size(row) * size(column) {
                return Err(LcpError::NotSymmetric { row, column, value, transposed });
            }
        }
    }
    Ok(Mat::from_fn(a.nrows(), a.ncols(), |i, j| 0.5 * a[(i, j)] + 0.5 * a[(j, i)]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ActiveSet, LcpSolver};

    /// Six nodes of a string on springs. Contacts: stops on both sides of node 1, two equal ones at node 2, one at an
    /// angle between nodes 3 and 4, and one at node 3, at node 4: three that depend on each other.
    fn body() -> ContactBody {
        let c = Mat::from_fn(6, 6, |i, j| 1e-6 * (-(i.abs_diff(j) as f64) / 2.0).exp());
        let w = [[0.0, 1.0, 0.0, 0.0, 0.0, 0.0], [0.0, -1.0, 0.0, 0.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0, 0.0, 0.0]];
        let v = [[0.0, 0.0, 2.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 0.6, 0.8, 0.0], [0.0, 0.0, 0.0, 1.0, 0.0, 0.0]];
        let rows = [w[0], w[1], w[2], v[0], v[1], v[2], [0.0, 0.0, 0.0, 0.0, 1.0, 0.0]];
        let w = Mat::from_fn(6, 7, |node, contact| rows[contact][node]);
        let gaps = vec![1e-3, 1e-3, 2e-3, 4e-3, 1.4e-3, 1e-3, 1e-3];
        ContactBody::new(w.clone(), &c * &w, gaps).unwrap()
    }

    /// `u` and the closed contacts (by the gaps, so with all redundant ones) for a free displacement.
    fn solved(body: &ContactBody, u_free: &[f64]) -> (Vec<f64>, Vec<bool>) {
        let c = body.matrix().n_contacts();
        let (mut closed, mut lambda, mut u) = (vec![false; c], vec![0.0; c], vec![0.0; u_free.len()]);
        let mut workspace = ActiveSet::default().workspace(body.matrix()).unwrap();
        workspace.solve(&body.free_gaps(u_free).unwrap(), &mut closed, &mut lambda).unwrap();
        body.displacements(u_free, &lambda, &mut u).unwrap();
        let gaps = body.free_gaps(&u).unwrap();
        (u, gaps.iter().map(|g| *g < 1e-12).collect())
    }

    /// Free displacements that close none, one, two equal and three dependent contacts, and how many.
    const FREE: [([f64; 6], usize); 4] = [
        ([0.0; 6], 0),
        ([0.0, -2e-3, 1e-3, 1e-3, 1e-3, 0.0], 1),
        ([1e-3, -9e-4, -5e-3, 1e-3, 1e-3, 0.0], 2),
        ([0.0, 3e-3, 1e-3, -3e-3, -4e-3, 1e-3], 4),
    ];

    #[test]
    fn a_stop_that_yields_shares_the_displacement_with_the_body() {
        // Springs in series: the body takes its share of the overlap of the free displacement with the stop.
        let (c, stop, gap, free) = (3e-6, 1e-6, 1e-3, -5e-3);
        let body = ContactBody::new(Mat::from_fn(1, 1, |_, _| 1.0), Mat::from_fn(1, 1, |_, _| c), vec![gap]).unwrap();
        let body = body.with_stop_compliance(&[stop]).unwrap();
        let force = (-free - gap) / (c + stop);
        let mut u = [0.0];
        body.displacements(&[free], &[force], &mut u).unwrap();
        approx::assert_relative_eq!(u[0], -gap - stop * force, max_relative = 1e-14);
        let response = body.response(&[true]).unwrap();
        let p = response.displacement()[(0, 0)];
        approx::assert_relative_eq!(p, stop / (c + stop), max_relative = 1e-14);
        approx::assert_relative_eq!(p * free + response.offset[0], u[0], max_relative = 1e-14);
        assert!(body.with_stop_compliance(&[]).is_err());
    }

    #[test]
    fn displacements_differ_as_the_projection_says_also_where_contacts_are_redundant() {
        let body = body();
        for (free, count) in FREE {
            let (u, closed) = solved(&body, &free);
            assert_eq!(closed.iter().filter(|closed| **closed).count(), count, "{closed:?}");
            let response = body.response(&closed).unwrap();
            let p = response.displacement();
            for j in 0..6 {
                let moved = |step: f64| {
                    let mut free = free;
                    free[j] += step;
                    solved(&body, &free).0
                };
                let (above, below) = (moved(1e-7), moved(-1e-7));
                for i in 0..6 {
                    // Displacements are piecewise linear: differences err by rounding only.
                    approx::assert_abs_diff_eq!(p[(i, j)], (above[i] - below[i]) / 2e-7, epsilon = 1e-8);
                }
            }
            for i in 0..6 {
                let linear: f64 = (0..6).map(|j| p[(i, j)] * free[j]).sum::<f64>() + response.offset[i];
                approx::assert_abs_diff_eq!(u[i], linear, epsilon = 1e-15);
            }
        }
    }

    #[test]
    fn the_derivative_is_a_projection_that_keeps_closed_gaps() {
        let body = body();
        for closed in [[false; 7], [true; 7], [true, false, true, true, false, false, true]] {
            let p = body.response(&closed).unwrap().displacement();
            let (twice, gaps) = (&p * &p, body.w.transpose() * &p);
            for j in 0..6 {
                (0..6).for_each(|i| assert!((twice[(i, j)] - p[(i, j)]).abs() < 1e-12));
                (0..7).filter(|i| closed[*i]).for_each(|i| assert!(gaps[(i, j)].abs() < 1e-12));
            }
        }
    }

    #[test]
    fn redundant_contacts_leave_the_displacements_of_any_independent_ones() {
        let body = body();
        // Contacts 4, 5, 6 are dependent: any two of them fix nodes 3 and 4, as do all three.
        let all = body.response(&[false, false, false, false, true, true, true]).unwrap().displacement();
        for left_out in [4, 5, 6] {
            let closed: Vec<bool> = (0..7).map(|i| i >= 4 && i != left_out).collect();
            let p = body.response(&closed).unwrap().displacement();
            (0..6).for_each(|j| (0..6).for_each(|i| assert!((p[(i, j)] - all[(i, j)]).abs() < 1e-12)));
        }
    }

    #[test]
    fn one_stop_at_a_node_answers_in_closed_form() {
        // u_0 = −g₀ at the stop; the rest follows by the ratio of the compliance at node 1 to that at node 0.
        let body = ContactBody::new(
            Mat::from_fn(2, 1, |i, _| [1.0, 0.0][i]),
            Mat::from_fn(2, 1, |i, _| [4e-6, 1e-6][i]),
            vec![1e-3],
        )
        .unwrap();
        let response = body.response(&[true]).unwrap();
        let p = response.displacement();
        let expected = [[0.0, 0.0], [-0.25, 1.0]];
        (0..2)
            .for_each(|i| (0..2).for_each(|j| approx::assert_abs_diff_eq!(p[(i, j)], expected[i][j], epsilon = 1e-15)));
        approx::assert_abs_diff_eq!(response.lambda[(0, 0)], -0.25e6, epsilon = 1e-9);
        assert_eq!(response.gaps[(0, 0)], 0.0);
        approx::assert_abs_diff_eq!(response.offset[..], [-1e-3, -0.25e-3][..], epsilon = 1e-15);
    }

    #[test]
    fn shapes_that_do_not_agree_and_compliances_that_are_none_are_refused() {
        let one = |v: f64| Mat::from_fn(1, 1, |_, _| v);
        assert!(ContactBody::new(one(1.0), Mat::zeros(2, 1), vec![0.0]).is_err());
        assert!(ContactBody::new(one(1.0), one(1.0), vec![0.0; 2]).is_err());
        assert!(ContactBody::new(one(1.0), one(1.0), vec![f64::NAN]).is_err());
        assert!(ContactBody::new(one(1.0), one(-1.0), vec![0.0]).is_err());
        let skew = Mat::from_fn(2, 2, |i, j| [[1.0, 0.1], [0.2, 1.0]][i][j]);
        let unit = Mat::from_fn(2, 2, |i, j| f64::from(u8::from(i == j)));
        assert!(matches!(ContactBody::new(unit, skew, vec![0.0; 2]), Err(LcpError::NotSymmetric { .. })));
        let body = body();
        let error = body.free_gaps(&[0.0; 7]).unwrap_err();
        assert_eq!(error, LcpError::Dimension { what: "u_free of whole samples", expected: 12, found: 7 });
        assert!(body.displacements(&[0.0; 6], &[0.0; 6], &mut [0.0; 6]).is_err());
        assert!(body.response(&[true]).is_err());
    }
}
