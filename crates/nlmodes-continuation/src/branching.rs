//! Branch points: the half-branches of a point at which the Jacobian has a kernel of two dimensions or more.

use std::f64::consts::TAU;

use crate::ParametricSystem;
use crate::corrector::Corrector;
use crate::half_branches::{HalfBranches, Sphere, outward};
use crate::kink;
use crate::singular::SingularDirections;
use crate::step::StepSettings;
use crate::vectors::{along, dot};

/// Discriminant of the branching equation, over the square of its largest coefficient, below which its roots are not
/// distinguished.
const DEGENERATE: f64 = 1e-6;

/// Coefficient of the branching equation that is distinguished from rounding, over that of second differences.
const ABOVE_ROUNDING: f64 = 1e3;

/// Largest distance of a search for half-branches, over the longest step, to which that is doubled.
const FURTHEST: f64 = 2.56;

/// The half-branches at `center`, of which `way_back` tells the point at a distance on that along which the branch
/// came.
pub(crate) fn half_branches<S: ParametricSystem>(
    system: &mut S,
    corrector: &mut Corrector,
    settings: &StepSettings,
    center: &[f64],
    way_back: impl Fn(f64) -> Vec<f64>,
) -> Option<HalfBranches> {
    let back = |radius: f64| outward(center, &way_back(radius));
    let near = back(10.0 * settings.min);
    corrector.evaluate(system, center).ok()?;
    let free = corrector.singular_directions()?;
    let found = match free.right.len() {
        1 => {
            return kink::half_branches(system, corrector, 10.0 * settings.min, center, &near)
                .filter(|found| found.balanced);
        }
        2 => simple(system, corrector, settings, center, &near, &free),
        _ => None,
    };
    found.or_else(|| several(system, corrector, settings, center, back, &free))
}

/// The four half-branches of a simple branch point; `None` where the branching equation does not tell them.
fn simple<S: ParametricSystem>(
    system: &mut S,
    corrector: &mut Corrector,
    settings: &StepSettings,
    center: &[f64],
    back: &[f64],
    free: &SingularDirections,
) -> Option<HalfBranches> {
    let directions = quadratic(system, corrector, center, free, settings.arm)?;
    let mut sphere = Sphere::new(system, corrector, center, 10.0 * settings.min);
    directions.iter().for_each(|direction| {
        sphere.take(direction);
    });
    corrector.evaluations += sphere.corrector.evaluations;
    if sphere.found.len() < directions.len() { None } else { sphere.finish(back, 2, true) }
}

/// The directions `v = α φ₁ + β φ₂` of a simple branch point, from the branching equation
///
/// ```text
/// a α² + 2 b α β + c β² = 0 ,   a = uᵀ R_zz φ₁ φ₁ ,   b = uᵀ R_zz φ₁ φ₂ ,   c = uᵀ R_zz φ₂ φ₂
/// ```
///
/// whose coefficients are second differences at the distance `s` along the kernel φ of the Jacobian, u being that of
/// its transpose. `None` where it has no two roots, or the points do not lie on one smooth piece.
fn quadratic<S: ParametricSystem>(
    system: &mut S,
    corrector: &mut Corrector,
    center: &[f64],
    free: &SingularDirections,
    s: f64,
) -> Option<Vec<Vec<f64>>> {
    let [first, second] = free.right.as_slice() else { return None };
    let left = free.left.first()?;
    let mut at = |z: &[f64]| {
        corrector.evaluate(system, z).ok()?;
        Some((dot(left, &corrector.linearization().residual), system.pattern()))
    };
    let (here, _) = at(center)?;
    let mut pieces = Vec::new();
    let mut form = |v: &[f64]| {
        let [(ahead, to), (behind, from)] = [at(&along(center, s, v))?, at(&along(center, -s, v))?];
        pieces.extend([to, from]);
        Some((ahead + behind - 2.0 * here) / (s * s))
    };
    let (a, c, sum) = (form(first)?, form(second)?, form(&along(first, 1.0, second))?);
    let b = 0.5 * (sum - a - c);
    let rounding = corrector.rounding.iter().fold(0.0_f64, |m, r| m.max(*r)) / (s * s);
    let largest = a.abs().max(b.abs()).max(c.abs());
    if pieces.iter().any(|piece| *piece != pieces[0])
        || largest < ABOVE_ROUNDING * rounding
        || b * b - a * c < DEGENERATE * largest * largest
    {
        return None;
    }
    // (a + c)/2 + ρ cos(2θ − ψ) = 0
    let (half, rho) = (0.5 * (a - c), (0.25 * (a - c).powi(2) + b * b).sqrt());
    let (psi, turned) = (b.atan2(half), (-0.5 * (a + c) / rho).clamp(-1.0, 1.0).acos());
    let at_angle = |angle: f64| {
        let (sin, cos) = angle.sin_cos();
        first.iter().zip(second).map(|(a, b)| cos * a + sin * b).collect::<Vec<f64>>()
    };
    let angles = [psi + turned, psi - turned].map(|double| 0.5 * double);
    Some(angles.iter().flat_map(|angle| [at_angle(*angle), at_angle(angle + 0.5 * TAU)]).collect())
}

/// Half-branches where more than one direction is free, or the branching equation does not tell: by a search, at the
/// least distance at which each that is found is distinguished from its neighbours. Where that is nowhere, as of waves
/// around a ring, whose phase is free but for terms below rounding, the branch itself alone.
fn several<S: ParametricSystem>(
    system: &mut S,
    corrector: &mut Corrector,
    settings: &StepSettings,
    center: &[f64],
    back: impl Fn(f64) -> Vec<f64>,
    free: &SingularDirections,
) -> Option<HalfBranches> {
    let (least, kernel) = (10.0 * settings.min, free.right.len());
    let first = settings.arm.max(least);
    let radii = std::iter::successors(Some(first), |r| Some(2.0 * r)).take_while(|r| *r <= FURTHEST * settings.max);
    let mut budget = settings.search;
    for radius in radii {
        let (mut sphere, back) = (Sphere::new(system, corrector, center, radius), back(radius));
        sphere.take(&back);
        let isolated = sphere.search(&free.right, budget, settings.isolated);
        budget = budget.saturating_sub(sphere.corrector.evaluations);
        let found = isolated && (sphere.found.len() > 2 || kernel == 2) && (sphere.is_balanced() || sphere.is_smooth());
        // Of two, one is the way back and the other the way on, whatever happens in between; on several pieces, several
        // boundaries lie close together.
        if found && sphere.found.len() > 2 && sphere.is_smooth() {
            sphere.keep_those_that_lead_to_center(least, settings.isolated);
        }
        corrector.evaluations += sphere.corrector.evaluations;
        if found {
            return sphere.finish(&back, kernel, false);
        }
    }
    if free.ratio > settings.isolated {
        return None;
    }
    let radius = settings.arm.max(least);
    let (mut sphere, back) = (Sphere::new(system, corrector, center, radius), back(radius));
    sphere.take(&back);
    sphere.take(&back.iter().map(|b| -b).collect::<Vec<f64>>());
    corrector.evaluations += sphere.corrector.evaluations;
    Some(HalfBranches { isolated: false, ..sphere.finish(&back, kernel, false)? })
}

#[cfg(test)]
mod tests {
    use std::convert::Infallible;

    use super::*;
    use crate::Linearization;

    /// `a x² + 2 b x p + c p² + d x³ = 0`.
    struct Cubic([f64; 4]);

    impl ParametricSystem for Cubic {
        type Error = Infallible;

        fn dim(&self) -> usize {
            1
        }

        fn linearize(&mut self, x: &[f64], p: f64, out: &mut Linearization) -> Result<(), Infallible> {
            let ([a, b, c, d], x) = (self.0, x[0]);
            out.residual[0] = a * x * x + 2.0 * b * x * p + c * p * p + d * x * x * x;
            out.jacobian[(0, 0)] = 2.0 * (a * x + b * p) + 3.0 * d * x * x;
            out.jacobian[(0, 1)] = 2.0 * (b * x + c * p);
            Ok(())
        }
    }

    fn directions(of: [f64; 4]) -> Option<Vec<Vec<f64>>> {
        let mut corrector = Corrector::new(1, 1e-11, 8);
        corrector.evaluate(&mut Cubic(of), &[0.0; 2]).unwrap();
        let free = corrector.singular_directions().unwrap();
        assert_eq!(free.right.len(), 2);
        quadratic(&mut Cubic(of), &mut corrector, &[0.0; 2], &free, 1e-3)
    }

    #[test]
    fn directions_of_a_simple_branch_point_solve_the_branching_equation() {
        // Two lines that cross; a transcritical point; a pitchfork, whose cubic term bends what leaves across the axis.
        for of in [[1.0, 0.0, -1.0, 0.0], [1.0, -0.5, 0.0, 0.3], [0.0, 0.5, 0.0, -1.0], [0.2, 3.0, -0.7, 5.0]] {
            let found = directions(of).unwrap();
            assert_eq!(found.len(), 4, "{of:?}");
            for (i, v) in found.iter().enumerate() {
                let [a, b, c, _] = of;
                let value = a * v[0] * v[0] + 2.0 * b * v[0] * v[1] + c * v[1] * v[1];
                assert!(value.abs() < 1e-8, "{of:?}: {value:e} along {v:?}");
                assert!(found[..i].iter().all(|other| dot(other, v) < 0.999), "{of:?}: one twice");
            }
        }
        // A single point, a cusp, and no quadratic terms.
        for of in [[1.0, 0.0, 1.0, 0.0], [1.0, 0.0, 0.0, 1.0], [0.0, 0.0, 0.0, 1.0]] {
            assert_eq!(directions(of), None, "{of:?}");
        }
    }
}
