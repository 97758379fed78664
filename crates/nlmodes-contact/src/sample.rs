//! One problem of a series in scaled units, and the judge's verdict on it.

use std::sync::Arc;

use crate::{
    LcpError, LcpMatrix, kernel,
    scaled::{Scaled, exponent, power_of_two},
};

/// Largest violation accepted as a solution: half of the documented limit, to allow for another order of summation.
pub(crate) const ACCEPTED: f64 = 0.5e-10;

/// Scaled force above which its rounding is taken into account.
const SUSPICIOUS: f64 = 1e8;

/// If rounding may hide a violation of this size, the forces are not a solution, whatever is computed.
const LOST: f64 = 1e-3;

/// `b`, `λ` and `g` of one problem, `b` of a size between one and two.
#[derive(Debug)]
pub(crate) struct Sample {
    matrix: Arc<Scaled>,
    pub(crate) b: Vec<f64>,
    pub(crate) lambda: Vec<f64>,
    pub(crate) gap: Vec<f64>,
    /// A proof of infeasibility, if the method found one.
    pub(crate) ray: Vec<f64>,
    scale: f64,
    /// The size of `b` to which violations are relative.
    size: f64,
}

/// The judge's verdict on the forces of a sample. Only the judge can construct one.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Verdict {
    violation: f64,
}

impl Verdict {
    pub(crate) fn violation(self) -> f64 {
        self.violation
    }

    pub(crate) fn is_accepted(self) -> bool {
        self.violation <= ACCEPTED
    }
}

impl Sample {
    pub(crate) fn new(matrix: &LcpMatrix) -> Self {
        let zeros = vec![0.0; matrix.n_contacts()];
        let [b, lambda, gap, ray] = [zeros.clone(), zeros.clone(), zeros.clone(), zeros];
        Self { matrix: matrix.scaled().clone(), b, lambda, gap, ray, scale: 1.0, size: 1.0 }
    }

    pub(crate) fn matrix(&self) -> &Arc<Scaled> {
        &self.matrix
    }

    /// Sets `b` (m) and resets everything else. Returns a verdict if no contact needs a force: there is nothing to
    /// solve.
    pub(crate) fn begin(&mut self, b: &[f64]) -> Result<Option<Verdict>, LcpError> {
        let extent = kernel::products(b, self.matrix.gap_unit(), &mut self.b);
        let extent = extent.ok_or(LcpError::NotFinite { what: "b" })?;
        if extent.least >= 0.0 {
            // λ = 0 and g = b ≥ 0 violate nothing. `unload_gaps` only converts the units back.
            self.gap.copy_from_slice(&self.b);
            self.scale = 1.0;
            return Ok(Some(Verdict { violation: 0.0 }));
        }
        self.scale_down(extent.largest);
        Ok(None)
    }

    /// Sets `b` (m) and resets everything else.
    pub(crate) fn load(&mut self, b: &[f64]) -> Result<(), LcpError> {
        let extent = kernel::products(b, self.matrix.gap_unit(), &mut self.b);
        self.scale_down(extent.ok_or(LcpError::NotFinite { what: "b" })?.largest);
        Ok(())
    }

    fn scale_down(&mut self, largest: f64) {
        let e = if largest > 0.0 { exponent(largest) } else { 0 };
        self.scale = power_of_two(e);
        self.size = self.matrix.rescale(power_of_two(-e), &mut self.b);
        self.lambda.fill(0.0);
    }

    /// Sets `lambda` (N).
    pub(crate) fn load_forces(&mut self, lambda: &[f64]) {
        for ((scaled, l), unit) in self.lambda.iter_mut().zip(lambda).zip(self.matrix.force_unit()) {
            *scaled = (l / unit) / self.scale;
        }
    }

    /// Recomputes the gaps of all contacts and judges the forces.
    pub(crate) fn judge(&mut self) -> Verdict {
        self.refresh_gaps();
        Verdict { violation: self.violation() }
    }

    /// The violation of forces whose gaps are up to date.
    pub(crate) fn violation(&self) -> f64 {
        let found = self.matrix.violation(self.size, &self.lambda, &self.gap);
        if found <= ACCEPTED && self.is_lost() { self.rounding() } else { found }
    }

    /// Possible contribution of rounding the forces and summing `A λ + b` to the violation.
    pub(crate) fn rounding(&self) -> f64 {
        let c = self.b.len();
        let row = |i: usize| {
            let column = self.matrix.column(i).iter();
            column.zip(&self.lambda).fold(self.b[i].abs(), |sum, (a, l)| sum + (a * l).abs())
        };
        let mut sums: Vec<f64> = (0..c).map(row).collect();
        0.5 * f64::EPSILON * (c + 2) as f64 * self.matrix.rescale(1.0, &mut sums) / self.size
    }

    /// Whether `b` is lost in the rounding of `A λ`, so that the gaps are meaningless: forces of a dependent set of
    /// contacts that grew without bound.
    fn is_lost(&self) -> bool {
        let largest = self.lambda.iter().fold(0.0_f64, |m, l| m.max(*l));
        largest > SUSPICIOUS && self.rounding() > LOST
    }

    pub(crate) fn refresh_gaps(&mut self) {
        self.matrix.gap(&self.b, &self.lambda, &mut self.gap);
    }

    /// Sets negative forces to zero, and judges again if there were any.
    pub(crate) fn clamp(&mut self, verdict: Verdict) -> Verdict {
        if kernel::none_negative(&self.lambda) {
            return verdict;
        }
        for l in &mut self.lambda {
            *l = if *l > 0.0 { *l } else { 0.0 };
        }
        self.judge()
    }

    /// Whether the ray proves that no forces below 1e8 (scaled) open all contacts. Larger ones could not be verified:
    /// rounding them alone changes the gaps by more than [`ACCEPTED`].
    pub(crate) fn is_proven_infeasible(&mut self) -> bool {
        let largest = kernel::max_abs(&self.ray);
        if !(largest > 0.0 && largest.is_finite()) || self.ray.iter().any(|z| *z < -1e-12 * largest) {
            return false;
        }
        for z in &mut self.ray {
            *z = if *z > 0.0 { *z / largest } else { 0.0 };
        }
        let zeros = vec![0.0; self.ray.len()];
        let mut image = zeros.clone();
        self.matrix.gap(&zeros, &self.ray, &mut image);
        // Forces that do no work prove nothing, as for opposing stops without clearance.
        let work = kernel::dot(&self.b, &self.ray);
        work < 0.0 && kernel::max_abs(&image) <= -1e-8 * work
    }

    /// The ray in N.
    pub(crate) fn ray(&self) -> Vec<f64> {
        self.ray.iter().zip(self.matrix.force_unit()).map(|(z, unit)| z * unit).collect()
    }

    /// Writes the forces in N. False if one of them overflows or underflows there.
    pub(crate) fn unload_forces(&self, lambda: &mut [f64]) -> bool {
        kernel::scaled_products(&self.lambda, self.scale, self.matrix.force_unit(), lambda)
    }

    /// Writes the gaps in m.
    pub(crate) fn unload_gaps(&self, gaps: &mut [f64]) {
        for ((out, g), inverse) in gaps.iter_mut().zip(&self.gap).zip(self.matrix.inverse_gap_unit()) {
            *out = (g * self.scale) * inverse;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Mat;

    /// Opposing stops: opening one contact closes the other.
    fn pinch(b: [f64; 2]) -> Sample {
        let matrix = LcpMatrix::new(&Mat::from_fn(2, 2, |i, j| if i == j { 1.0 } else { -1.0 })).unwrap();
        let mut sample = Sample::new(&matrix);
        sample.load(&b).unwrap();
        sample
    }

    fn proves(sample: &mut Sample, ray: [f64; 2]) -> bool {
        sample.ray.copy_from_slice(&ray);
        sample.is_proven_infeasible()
    }

    #[test]
    fn a_ray_of_any_length_proves_that_a_pinch_with_interference_has_no_solution() {
        for length in [1e-200, 1e-3, 0.1, 1.0, 1e200] {
            let mut sample = pinch([-1.0, 0.5]);
            assert!(proves(&mut sample, [length, length]));
            assert_eq!(sample.ray, [1.0, 1.0]);
            assert!(!proves(&mut pinch([-1.0, 1.5]), [length, length]), "with clearance");
            assert!(!proves(&mut pinch([-1.0, 1.0]), [length, length]), "without either");
            assert!(!proves(&mut sample, [length, 0.999 * length]), "forces that open a gap");
        }
    }

    #[test]
    fn rays_that_pull_that_vanish_or_that_are_no_numbers_prove_nothing() {
        let mut sample = pinch([-1.0, 0.5]);
        for ray in [[0.0, 0.0], [-1.0, -1.0], [f64::NAN, 1.0], [f64::INFINITY, 1.0]] {
            assert!(!proves(&mut sample, ray), "{ray:?}");
        }
        // A third, distant contact with a small tensile force that is not rounding.
        let matrix = LcpMatrix::new(&Mat::from_fn(3, 3, |i, j| [[1.0, -1.0, 0.0], [-1.0, 1.0, 0.0], [0.0; 3]][i][j]));
        let mut sample = Sample::new(&matrix.unwrap());
        sample.load(&[-1.0, 0.5, 0.0]).unwrap();
        for (pull, proven) in [(0.0, true), (-1e-13, true), (-1e-11, false), (-0.1, false)] {
            sample.ray.copy_from_slice(&[1.0, 1.0, pull]);
            assert_eq!(sample.is_proven_infeasible(), proven, "{pull}");
        }
    }

    #[test]
    fn a_proof_holds_for_forces_up_to_1e8_and_no_further() {
        // Forces (f, f) move either gap by e f / 2, so that gaps of −1 and 0.5 in sum open from f = 1 / (2 e) on.
        for (e, proven) in [(0.4e-8, true), (0.6e-8, false)] {
            let matrix = LcpMatrix::new(&Mat::from_fn(2, 2, |i, j| if i == j { 1.0 } else { -1.0 + e })).unwrap();
            let mut sample = Sample::new(&matrix);
            sample.load(&[-1.0, 0.5]).unwrap();
            assert_eq!(proves(&mut sample, [1.0, 1.0]), proven, "{e:e}");
        }
    }

    #[test]
    fn negative_forces_are_put_out_and_judged_again() {
        let mut sample = pinch([-1.0, 1.5]);
        sample.lambda.copy_from_slice(&[1.0, -1e-14]);
        let verdict = sample.judge();
        let verdict = sample.clamp(verdict);
        assert_eq!(sample.lambda, [1.0, 0.0]);
        assert!(verdict.violation() == 0.0 && sample.gap == [0.0, 0.5]);
    }
}
