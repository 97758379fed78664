use std::rc::Rc;

use crate::corrector::{Correction, Corrector, Hyperplane, Surface};
use crate::pencil::Bordered;
use crate::predictor::{Behind, predicted};
use crate::vectors::{along, distance, dot};
use crate::{ContinuationError, CorrectionFailure, ParametricSystem, Refusal};

/// Length of a step and what makes it credible.
#[derive(Debug, Clone, PartialEq)]
pub struct StepSettings {
    /// First step. This and all lengths are distances between points whose unknowns are over their sizes. Default 0.01.
    pub initial: f64,
    /// Shortest step. Where it is refused, the half-branches around the point are looked for, at ten times that
    /// distance. Default 1e-6.
    pub min: f64,
    /// Share of the shortest step down to which a branch is followed where no half-branches are found there either: it
    /// bends within less, as motions do that touch a rigid stop softly. Default 1e-2; 1 for none.
    pub bend: f64,
    /// Distance at which second differences for the branching equation are taken, and least distance at which
    /// half-branches are searched where more than one direction is free: far above the last digits of the unknowns,
    /// whose third power the cubic terms are. Default 1e-3.
    pub arm: f64,
    /// Most evaluations of a search for half-branches, where more than one direction is free or the branching equation
    /// does not tell them; following them inward comes on top. Default 4000, twice what four free directions take.
    pub search: usize,
    /// Ratio of the pivots from which on the Jacobian tells a half-branch from its neighbours. Default 1e-6, well above
    /// the error of a Jacobian by differences, of the order of √ε.
    pub isolated: f64,
    /// Longest step. Default 0.1.
    pub max: f64,
    /// Largest unknown, over its size, beyond which the longest step grows in proportion to it; four at most where
    /// sizes other than one are found, or where all is zero at the start and nothing tells a size. Default infinite:
    /// the longest step is the same everywhere.
    pub far: f64,
    /// Largest turn of the tangent within a step, rad. Default 0.35 (20°).
    pub max_turn: f64,
    /// Largest distance from the predicted to the corrected point, as a share of the step. Default 0.3.
    pub max_correction: f64,
    /// Turn beyond which, or a change of pattern upon which, the middle of the step is checked too. Default 0.1 rad.
    pub checked_turn: f64,
    /// Residual, largest entry over the size of its equation, at which a point counts as found if Newton's method also
    /// has come to rest. Default 1e-11.
    pub tolerance: f64,
    /// Newton iterations permitted a step; three times as many for the start and for steps near the shortest.
    /// Default 8.
    pub max_iterations: usize,
}

impl Default for StepSettings {
    fn default() -> Self {
        Self {
            initial: 0.01,
            min: 1e-6,
            bend: 1e-2,
            arm: 1e-3,
            search: 4000,
            isolated: 1e-6,
            max: 0.1,
            far: f64::INFINITY,
            max_turn: 0.35,
            max_correction: 0.3,
            checked_turn: 0.1,
            tolerance: 1e-11,
            max_iterations: 8,
        }
    }
}

impl StepSettings {
    pub(crate) fn check<E: std::error::Error + 'static>(&self) -> Result<(), ContinuationError<E>> {
        let positive = [
            ("initial step", self.initial),
            ("shortest step", self.min),
            ("share of the shortest step", self.bend),
            ("distance of half-branches", self.arm),
            ("ratio of pivots of a half-branch", self.isolated),
            ("longest step", self.max),
            ("largest turn", self.max_turn),
            ("largest correction", self.max_correction),
            ("tolerance", self.tolerance),
        ];
        for (what, value) in positive {
            if !(value.is_finite() && value > 0.0) {
                return Err(ContinuationError::Setting { what, value, expected: "a positive number" });
            }
        }
        if self.far.is_nan() || self.far <= 0.0 {
            let what = "largest unknown for which the longest step is meant";
            return Err(ContinuationError::Setting { what, value: self.far, expected: "a positive number" });
        }
        if self.search == 0 {
            let what = "number of evaluations permitted a search for half-branches";
            return Err(ContinuationError::Setting { what, value: 0.0, expected: "at least one" });
        }
        if self.max_iterations == 0 {
            let what = "number of Newton iterations permitted";
            return Err(ContinuationError::Setting { what, value: 0.0, expected: "at least one" });
        }
        if self.checked_turn.is_nan() {
            let what = "turn beyond which the middle of a step is checked";
            return Err(ContinuationError::Setting { what, value: f64::NAN, expected: "a number" });
        }
        if self.min > self.max {
            return Err(ContinuationError::Setting {
                what: "shortest step",
                value: self.min,
                expected: "at most the longest",
            });
        }
        Ok(())
    }
}

/// Distance that the end of a correction may be off, over the Newton step below which it counts as settled.
const SETTLED: f64 = 100.0;

/// A point from which steps start.
#[derive(Debug, Clone)]
pub(crate) struct BasePoint {
    pub z: Vec<f64>,
    pub tangent: Vec<f64>,
    pub orientation: f64,
    pub pattern: u64,
    pub regularity: f64,
    /// The point before, where no kink lies in between.
    pub behind: Option<Behind>,
    /// The Jacobian, where it is known and wanted.
    pub border: Option<Rc<Bordered>>,
}

impl From<&Correction> for BasePoint {
    fn from(c: &Correction) -> Self {
        let Correction { orientation, pattern, regularity, .. } = *c;
        Self {
            z: c.z.clone(),
            tangent: c.tangent.clone(),
            orientation,
            pattern,
            regularity,
            behind: None,
            border: None,
        }
    }
}

/// Corrects at distance `h` along the tangent of `base point`, without judging the result.
pub(crate) fn reach<S: ParametricSystem>(
    system: &mut S,
    corrector: &mut Corrector,
    base: &BasePoint,
    h: f64,
) -> Result<Correction, CorrectionFailure> {
    let predicted = predicted(base, h);
    corrector.correct(system, &predicted, &Surface::Plane(Hyperplane::through(&predicted, &base.tangent)))
}

/// A step of length `h` that is shown to stay on the branch, or the reason why it is refused.
pub(crate) fn step<S: ParametricSystem>(
    system: &mut S,
    corrector: &mut Corrector,
    settings: &StepSettings,
    base: &BasePoint,
    h: f64,
) -> Result<Correction, Refusal> {
    let end = reach(system, corrector, base, h).map_err(Refusal::End)?;
    let turn = near_and_straight(settings, base, &end, h)?;
    confirm(system, corrector, settings, base, &end, h, turn)?;
    Ok(end)
}

/// A step with the Jacobian at its end, and where the Jacobian is singular within.
pub(crate) struct Watched {
    pub end: Correction,
    pub border: Option<Rc<Bordered>>,
    /// Shares of the step, ascending.
    pub singular: Vec<f64>,
}

/// A step that also is refused if the Jacobian becomes singular more than once within, unless it is so short that these
/// are one point.
pub(crate) fn watched_step<S: ParametricSystem>(
    system: &mut S,
    corrector: &mut Corrector,
    settings: &StepSettings,
    base: &BasePoint,
    h: f64,
) -> Result<Watched, Refusal> {
    let end = reach(system, corrector, base, h).map_err(Refusal::End)?;
    let turn = near_and_straight(settings, base, &end, h)?;
    let border = corrector.border().map(Rc::new);
    let singular = match (&base.border, &border) {
        (Some(from), Some(to)) => to.singular_since(from, end.orientation * base.orientation < 0.0),
        _ => Vec::new(),
    };
    if let [first, .., last] = singular.as_slice() {
        let near = settings.arm.max(10.0 * settings.min);
        let spread = (last - first) * h;
        if h > 1.01 * near || (spread > ONE_POINT * near && h > 10.0 * settings.min) {
            return Err(Refusal::SeveralCrossings { count: singular.len(), next: telling(&singular, h, near) });
        }
    }
    confirm(system, corrector, settings, base, &end, h, turn)?;
    Ok(Watched { end, border, singular })
}

/// Spread of singular points, over the distance at which half-branches are looked for, up to which they are one.
const ONE_POINT: f64 = 0.05;

/// The length of a step that tells singular points apart, or ends just before the first ones if they are close
/// together.
fn telling(singular: &[f64], h: f64, near: f64) -> f64 {
    if h <= 1.01 * near {
        return 0.5 * h;
    }
    let apart = singular.windows(2).find(|pair| (pair[1] - pair[0]) * h > 4.0 * near);
    match apart {
        Some(pair) => 0.5 * (pair[0] + pair[1]) * h,
        None => (singular[0] * h - 0.5 * near).max(near),
    }
}

/// The turn of the tangent within a step, unless that or the distance from the prediction is too large.
fn near_and_straight(settings: &StepSettings, base: &BasePoint, end: &Correction, h: f64) -> Result<f64, Refusal> {
    let moved = distance(&end.z, &along(&base.z, h, &base.tangent));
    if moved > settings.max_correction * h {
        return Err(Refusal::FarFromPrediction { steps: moved / h });
    }
    let turn = dot(&end.tangent, &base.tangent).clamp(-1.0, 1.0).acos();
    if turn > settings.max_turn { Err(Refusal::Turn { radians: turn }) } else { Ok(turn) }
}

/// Looks at the middle of a step where its end alone does not tell enough.
fn confirm<S: ParametricSystem>(
    system: &mut S,
    corrector: &mut Corrector,
    settings: &StepSettings,
    base: &BasePoint,
    end: &Correction,
    h: f64,
    turn: f64,
) -> Result<(), Refusal> {
    let moved = distance(&end.z, &along(&base.z, h, &base.tangent));
    // An arc lies half its turn off its tangent; what lies further off may be another half-branch.
    let sideways = moved > turn * h + 1e-6 * h + SETTLED * corrector.resolution.max(0.1 * corrector.blur);
    if turn > settings.checked_turn || sideways || end.pattern != base.pattern {
        let most = if sideways { 0.2 * moved.max(turn * h) } else { 0.03 * h };
        check_middle(system, corrector, base, h, end, most.min(0.03 * h))?;
    }
    Ok(())
}

/// The point at half the step must lie on the cubic through both ends, but for `most`: after a jump to another
/// half-branch it does not.
fn check_middle<S: ParametricSystem>(
    system: &mut S,
    corrector: &mut Corrector,
    base: &BasePoint,
    h: f64,
    end: &Correction,
    most: f64,
) -> Result<(), Refusal> {
    let middle = reach(system, corrector, base, 0.5 * h).map_err(Refusal::Middle)?;
    let chord = distance(&end.z, &base.z);
    let cubic: Vec<f64> = (0..end.z.len())
        .map(|i| 0.5 * (base.z[i] + end.z[i]) + chord / 8.0 * (base.tangent[i] - end.tangent[i]))
        .collect();
    // The middle in the plane is not the middle of the arc: only the distance across the tangent counts.
    let gap: Vec<f64> = middle.z.iter().zip(&cubic).map(|(a, b)| a - b).collect();
    let on_tangent = dot(&gap, &middle.tangent);
    let off = (dot(&gap, &gap) - on_tangent * on_tangent).max(0.0).sqrt();
    if off > most {
        return Err(Refusal::MiddleOff { steps: off / h });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::convert::Infallible;

    use super::*;
    use crate::Linearization;

    /// `x = 0`: the axis of the parameter.
    struct Axis;

    impl ParametricSystem for Axis {
        type Error = Infallible;

        fn dim(&self) -> usize {
            1
        }

        fn linearize(&mut self, x: &[f64], _: f64, out: &mut Linearization) -> Result<(), Infallible> {
            out.residual[0] = x[0];
            (out.jacobian[(0, 0)], out.jacobian[(0, 1)]) = (1.0, 0.0);
            Ok(())
        }
    }

    fn at(x: f64, p: f64, turn: f64) -> Correction {
        let (tangent, pattern) = (vec![turn.sin(), turn.cos()], 0);
        Correction { z: vec![x, p], tangent, orientation: 1.0, residual: 0.0, iterations: 1, pattern, regularity: 1.0 }
    }

    #[test]
    fn a_step_that_ends_far_from_its_prediction_or_turns_too_much_is_refused() {
        let (settings, base, h) = (StepSettings::default(), BasePoint::from(&at(0.0, 0.0, 0.0)), 0.05);
        let judged = |x: f64, p: f64, turn: f64| near_and_straight(&settings, &base, &at(x, p, turn), h);
        assert!((judged(0.29 * h, h, 0.2).unwrap() - 0.2).abs() < 1e-12);
        // Sideways, and along the tangent.
        for (x, p) in [(0.31 * h, h), (-0.31 * h, h), (0.0, 0.69 * h), (0.0, 1.31 * h)] {
            let Err(Refusal::FarFromPrediction { steps }) = judged(x, p, 0.0) else { panic!("{x} {p}") };
            assert!((steps - 0.31).abs() < 1e-12);
        }
        for turn in [0.34, -0.34] {
            assert!((judged(0.0, h, turn).unwrap() - 0.34).abs() < 1e-12);
        }
        for turn in [0.36, -0.36, 3.0] {
            let Err(Refusal::Turn { radians }) = judged(0.0, h, turn) else { panic!("{turn}") };
            assert!((radians - turn.abs()).abs() < 1e-9);
        }
    }

    #[test]
    fn a_step_whose_middle_lies_elsewhere_is_refused_with_its_distance() {
        let (settings, base, h) = (StepSettings::default(), BasePoint::from(&at(0.0, 0.0, 0.0)), 0.05);
        let confirmed = |x: f64, turn: f64| {
            let mut corrector = Corrector::new(1, settings.tolerance, settings.max_iterations);
            confirm(&mut Axis, &mut corrector, &settings, &base, &at(x, h, turn), h, turn)
        };
        assert!(confirmed(0.0, 0.0).is_ok() && confirmed(0.0, 0.11).is_ok());
        // Half of what the end is off: 0.1 h on a straight line.
        let Err(Refusal::MiddleOff { steps }) = confirmed(0.2 * h, 0.0) else { panic!("0.2 h to the side") };
        assert!((steps - 0.1).abs() < 1e-3, "{steps}");
        // An arc of this turn may be that far off its tangent, and the axis is straight: nothing to be seen without a
        // look.
        assert!(confirmed(0.04 * h, 0.05).is_ok());
    }
}
