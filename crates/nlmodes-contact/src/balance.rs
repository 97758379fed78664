//! Contact forces that balance a load on motions without stiffness.

use nlmodes_linalg::{DenseLu, Mat, symmetric_eigen};

use crate::{LcpError, LcpMatrix, LcpSolver};

/// Compliance, over that of the contacts, of the springs to the ground that represent the missing stiffness while the
/// closed contacts are sought; the result does not depend on it.
const GROUND: f64 = 1e3;

/// Most steps from one set of closed contacts to the next.
const MOST_STEPS: usize = 100;

/// Share of the load, or of the largest force or gap, that is rounding.
const ROUNDING: f64 = 1e-9;

/// Least motion of the closed contacts, squared and over the largest one, of a motion that they hold.
const HELD: f64 = 1e-12;

/// A body with free motions at rest on its contacts.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Balance {
    /// Contact forces `λ ≥ 0`, c, N.
    pub forces: Vec<f64>,
    /// How far it has gone along the free motions, `η`, k.
    pub motion: Vec<f64>,
    /// Gaps, c, m.
    pub gaps: Vec<f64>,
    /// The closed contacts; of redundant ones those that carry the force.
    pub closed: Vec<bool>,
}

/// Where a body with free motions rests on its contacts under a load:
///
/// ```text
/// 0 ≤ λ ⊥ g = A λ + b + R η ≥ 0 ,   Rᵀ λ + p = 0
/// ```
///
/// which minimises `½ λᵀ A λ + bᵀ λ` over the forces that balance the load. `A` (c × c, m/N) is the compliance of the
/// contacts without the free motions, `R` (`rows`, c × k) what these do to the gaps, `b` (c, m) the gaps without
/// forces, `p` (`load`, k) the work of the load on each motion.
///
/// # Errors
/// [`LcpError::Unbalanced`] if no forces balance the load, [`LcpError::Loose`] if the closed contacts leave a motion
/// free; [`LcpError::Dimension`], or what `solver` reports.
pub fn balance(
    a: &Mat<f64>,
    rows: &Mat<f64>,
    b: &[f64],
    load: &[f64],
    solver: &dyn LcpSolver,
) -> Result<Balance, LcpError> {
    let (c, k) = (b.len(), load.len());
    let sizes = [
        ("rows of the compliance", c, a.nrows()),
        ("columns of the compliance", c, a.ncols()),
        ("contacts of the free motions", c, rows.nrows()),
        ("free motions", k, rows.ncols()),
    ];
    if let Some(&(what, expected, found)) = sizes.iter().find(|(_, expected, found)| expected != found) {
        return Err(LcpError::Dimension { what, expected, found });
    }
    refuse_unbalanced(rows, load, solver)?;
    let problem = Problem { a, rows, b, load, units: units(a, rows) };
    let soft = GROUND * problem.units[0] / problem.units[1].powi(2);
    let grounded =
        Mat::from_fn(c, c, |i, j| a[(i, j)] + soft * (0..k).map(|r| rows[(i, r)] * rows[(j, r)]).sum::<f64>());
    let mut workspace = solver.workspace(&LcpMatrix::new(&grounded)?)?;
    let (mut motion, mut forces, mut closed) = (vec![0.0; k], vec![0.0; c], vec![false; c]);
    let mut is_loose = false;
    for _ in 0..MOST_STEPS {
        let along = |i: usize| (0..k).map(|r| rows[(i, r)] * (motion[r] + soft * load[r])).sum::<f64>();
        let free: Vec<f64> = (0..c).map(|i| b[i] + along(i)).collect();
        workspace.solve(&free, &mut closed, &mut forces)?;
        let left = resultant(rows, load, &forces);
        motion.iter_mut().zip(&left).for_each(|(motion, left)| *motion += soft * left);
        match problem.with_closed(&closed)? {
            // Pushed away until nothing presses any more, it may be anywhere beyond.
            Some(found) if problem.stands(&found) && problem.is_unpressed(&found) => return Err(LcpError::Loose),
            Some(found) if problem.stands(&found) => return Ok(found),
            Some(_) => is_loose = false,
            None => is_loose = true,
        }
    }
    if is_loose {
        return Err(LcpError::Loose);
    }
    let (iterations, lambda) = (MOST_STEPS, forces);
    Err(LcpError::NotConverged { solver: solver.name(), iterations, violation: f64::NAN, lambda })
}

/// What a compliance and a row near one mean.
fn units(a: &Mat<f64>, rows: &Mat<f64>) -> [f64; 2] {
    let compliance = (0..a.nrows()).map(|i| a[(i, i)]).fold(0.0, f64::max);
    let row = (0..rows.ncols()).flat_map(|r| rows.col(r).iter().copied()).fold(0.0_f64, |m, v| m.max(v.abs()));
    [compliance, row].map(|unit| if unit > 0.0 { unit } else { 1.0 })
}

/// `Rᵀ λ + p`.
fn resultant(rows: &Mat<f64>, load: &[f64], forces: &[f64]) -> Vec<f64> {
    let of = |r: usize| forces.iter().enumerate().map(|(i, force)| rows[(i, r)] * force).sum::<f64>();
    load.iter().enumerate().map(|(r, p)| of(r) + p).collect()
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0_f64, |largest, value| largest.max(value.abs()))
}

/// The forces that come nearest to balancing the load solve a contact problem of their own.
fn refuse_unbalanced(rows: &Mat<f64>, load: &[f64], solver: &dyn LcpSolver) -> Result<(), LcpError> {
    let (c, size) = (rows.nrows(), largest(load.iter().copied()));
    if size == 0.0 {
        return Ok(());
    }
    let product = rows * rows.transpose();
    let matrix = LcpMatrix::new(&Mat::from_fn(c, c, |i, j| 0.5 * (product[(i, j)] + product[(j, i)])))?;
    let pull: Vec<f64> = (0..c).map(|i| (0..load.len()).map(|r| rows[(i, r)] * load[r]).sum()).collect();
    let (mut closed, mut forces) = (vec![false; c], vec![0.0; c]);
    solver.workspace(&matrix)?.solve(&pull, &mut closed, &mut forces)?;
    let motion = resultant(rows, load, &forces);
    match largest(motion.iter().copied()) > ROUNDING * size {
        true => Err(LcpError::Unbalanced { motion }),
        false => Ok(()),
    }
}

struct Problem<'a> {
    a: &'a Mat<f64>,
    rows: &'a Mat<f64>,
    b: &'a [f64],
    load: &'a [f64],
    units: [f64; 2],
}

impl Problem<'_> {
    /// Forces and motion with these contacts closed, whatever their signs; none if they leave a motion free.
    fn with_closed(&self, closed: &[bool]) -> Result<Option<Balance>, LcpError> {
        let set: Vec<usize> = (0..closed.len()).filter(|&i| closed[i]).collect();
        let (s, k, [compliance, row]) = (set.len(), self.load.len(), self.units);
        let felt = Mat::from_fn(k, k, |r, q| {
            set.iter().map(|&i| self.rows[(i, r)] * self.rows[(i, q)]).sum::<f64>() / (row * row)
        });
        let strengths = symmetric_eigen(&felt).map_or_else(|_| vec![0.0], |(values, _)| values);
        if strengths.iter().any(|strength| *strength < HELD) {
            return Ok(None);
        }
        let matrix = Mat::from_fn(s + k, s + k, |i, j| match (i.checked_sub(s), j.checked_sub(s)) {
            (None, None) => self.a[(set[i], set[j])] / compliance,
            (None, Some(r)) => self.rows[(set[i], r)] / row,
            (Some(r), None) => self.rows[(set[j], r)] / row,
            (Some(_), Some(_)) => 0.0,
        });
        let Ok(lu) = DenseLu::factor(&matrix) else { return Ok(None) };
        let mut x: Vec<f64> = set.iter().map(|&i| -self.b[i]).collect();
        x.extend(self.load.iter().map(|p| -p * compliance / row));
        lu.solve_in_place(&mut x);
        let mut forces = vec![0.0; closed.len()];
        set.iter().zip(&x).for_each(|(&i, force)| forces[i] = force / compliance);
        let motion: Vec<f64> = x[s..].iter().map(|eta| eta / row).collect();
        let gap = |i: usize| {
            let pressed: f64 = set.iter().map(|&j| self.a[(i, j)] * forces[j]).sum();
            self.b[i] + pressed + motion.iter().enumerate().map(|(r, eta)| self.rows[(i, r)] * eta).sum::<f64>()
        };
        let gaps = (0..closed.len()).map(|i| if closed[i] { 0.0 } else { gap(i) }).collect();
        Ok(Some(Balance { forces, motion, gaps, closed: closed.to_vec() }))
    }

    fn length(&self, of: &Balance) -> f64 {
        let force = largest(of.forces.iter().copied());
        largest(self.b.iter().chain(&of.gaps).copied()).max(self.units[0] * force)
    }

    /// Whether no contact has a force.
    fn is_unpressed(&self, of: &Balance) -> bool {
        self.units[0] * largest(of.forces.iter().copied()) <= ROUNDING * self.length(of)
    }

    /// Whether no force pulls and no gap is negative.
    fn stands(&self, of: &Balance) -> bool {
        let (force, length) = (largest(of.forces.iter().copied()), self.length(of));
        of.forces.iter().all(|f| *f >= -ROUNDING * force) && of.gaps.iter().all(|g| *g >= -ROUNDING * length)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver_by_name;

    fn rest(a: &[f64], rows: &[&[f64]], b: &[f64], load: &[f64]) -> Result<Balance, LcpError> {
        let a = Mat::from_fn(b.len(), b.len(), |i, j| if i == j { a[i] } else { 0.0 });
        let rows = Mat::from_fn(b.len(), load.len(), |i, r| rows[i][r]);
        balance(&a, &rows, b, load, solver_by_name("active-set")?.as_ref())
    }

    fn near(found: &[f64], expected: &[f64]) -> bool {
        found.iter().zip(expected).all(|(a, b)| (a - b).abs() <= 1e-12 * (1.0 + b.abs()))
    }

    /// A bar of length 2 on springs at both ends and in the middle, which is lower: its weight of 10 N acts off the
    /// middle. Compliances in units from nanometres to metres a newton.
    #[test]
    fn a_bar_lies_on_the_supports_that_carry_it() {
        let rows: [&[f64]; 3] = [&[1.0, -1.0], &[1.0, 0.0], &[1.0, 1.0]];
        for unit in [1e-9, 1.0, 1e6] {
            // At −1 and 1: 10 N at 0.4 are 3 N and 7 N; the middle is 20 of these compliances lower.
            let found = rest(&[unit, unit, unit], &rows, &[0.0, 20.0 * unit, 0.0], &[-10.0, -4.0]).unwrap();
            assert!(near(&found.forces, &[3.0, 0.0, 7.0]) && found.closed == [true, false, true], "{found:?}");
            assert!(near(&found.motion.map_by(unit), &[-5.0, -2.0]), "{found:?}");
            assert!(near(&found.gaps.map_by(unit), &[0.0, 15.0, 0.0]), "{found:?}");
        }
        // A middle at the same height takes a third of the weight: three springs and three unknowns.
        let found = rest(&[1.0; 3], &rows, &[0.0; 3], &[-10.0, -4.0]).unwrap();
        assert!(near(&found.forces, &[10.0 / 3.0 - 2.0, 10.0 / 3.0, 10.0 / 3.0 + 2.0]), "{found:?}");
    }

    #[test]
    fn a_body_that_falls_away_is_refused_with_the_motion() {
        // Up, and beyond the support: no push from below balances that.
        let up = rest(&[1.0], &[&[1.0]], &[0.0], &[10.0]).unwrap_err();
        assert_eq!(up, LcpError::Unbalanced { motion: vec![10.0] });
        let rows: [&[f64]; 2] = [&[1.0, -1.0], &[1.0, 1.0]];
        let beyond = rest(&[1.0; 2], &rows, &[0.0; 2], &[-10.0, -15.0]).unwrap_err();
        assert!(matches!(beyond, LcpError::Unbalanced { .. }), "{beyond:?}");
        // On one of two supports it could tip over, and between stops that it does not touch it may be anywhere.
        assert_eq!(rest(&[1.0; 2], &rows, &[0.0, 30.0], &[-10.0, 10.0]).unwrap_err(), LcpError::Loose);
        assert_eq!(rest(&[1.0; 2], &[&[1.0], &[-1.0]], &[1.0, 1.0], &[0.0]).unwrap_err(), LcpError::Loose);
        assert_eq!(rest(&[1.0; 2], &[&[1.0], &[-1.0]], &[-1.0, 5.0], &[0.0]).unwrap_err(), LcpError::Loose);
    }

    /// Between stops on both sides that it interferes with: `λ (A_1 + A_2) = −(b_1 + b_2)`, without any load.
    #[test]
    fn a_body_is_pressed_between_two_stops() {
        let found = rest(&[1.0, 3.0], &[&[1.0], &[-1.0]], &[-1.0, -7.0], &[0.0]).unwrap();
        assert!(near(&found.forces, &[2.0, 2.0]) && near(&found.motion, &[-1.0]), "{found:?}");
        let loaded = rest(&[1.0, 3.0], &[&[1.0], &[-1.0]], &[-1.0, -7.0], &[-1.0]).unwrap();
        assert!(near(&loaded.forces, &[2.75, 1.75]), "{loaded:?}");
    }

    trait MapBy {
        fn map_by(&self, unit: f64) -> Vec<f64>;
    }

    impl MapBy for Vec<f64> {
        fn map_by(&self, unit: f64) -> Vec<f64> {
            self.iter().map(|v| v / unit).collect()
        }
    }
}
