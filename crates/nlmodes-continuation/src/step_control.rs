//! Step control: the length of the next step, from how the last one went.

use crate::{Refusal, StepSettings};

/// Growth of the step after one that was easy, below this length, where a kink has just been passed, and above.
const GROWTH: [(f64, f64); 2] = [(1e-3, 2.5), (f64::INFINITY, 1.4)];

/// Distance of the branch from its tangent at the end of a step, over the step, up to which that was easy. Half the
/// turn of the tangent is about as much, so curvature decides how long steps become. Iterations do not count: near
/// rounding Newton's method takes many.
const EASY: f64 = 0.06;

/// Shares of a step that are tried next where it is refused: at first, and again.
const SHORTER: [f64; 2] = [0.5, 0.25];

/// Share of the shortest step from which on one is as long as that.
const SHORTER_THAN: f64 = 1.0 - 1e-9;

/// Shortest step, over the distance by which rounding blurs the point from which it starts: what is shorter says
/// nothing about the curve.
const ABOVE_ROUNDING: f64 = 50.0;

/// The lengths that steps may have, and how often the step in progress was refused.
#[derive(Debug)]
pub(crate) struct StepControl {
    /// The settings, with a shortest step that is no shorter than rounding permits at the base point.
    pub limits: StepSettings,
    shortest: f64,
    /// The branch bends within less than its shortest step: steps of `bend` times that are permitted until they have
    /// grown to it again.
    is_in_bend: bool,
    blur: f64,
    refused_in_a_row: usize,
}

impl StepControl {
    pub fn new(settings: &StepSettings) -> Self {
        let limits = settings.clone();
        Self { limits, shortest: settings.min, is_in_bend: false, blur: 0.0, refused_in_a_row: 0 }
    }

    /// The first step.
    pub fn initial(&self) -> f64 {
        self.limits.initial.clamp(self.limits.min, self.limits.max)
    }

    /// How often the step in progress was refused.
    pub fn refused_in_a_row(&self) -> usize {
        self.refused_in_a_row
    }

    /// Points near the base point are known up to `blur`: no shorter step makes sense there.
    pub fn set_blur(&mut self, blur: f64) {
        self.blur = blur;
        self.limits.min = self.least().max(ABOVE_ROUNDING * blur).min(self.limits.max);
    }

    /// The shortest step but for rounding.
    fn least(&self) -> f64 {
        if self.is_in_bend { self.limits.bend * self.shortest } else { self.shortest }
    }

    /// Whether rounding alone forbids shorter steps.
    pub fn is_held_by_rounding(&self) -> bool {
        self.limits.min > self.least()
    }

    /// A step of length `h` is about to be taken: a bend has been passed where it is as long as the shortest one
    /// elsewhere.
    pub fn set_length(&mut self, h: f64) {
        let is_in_bend = h < SHORTER_THAN * self.shortest;
        if is_in_bend != self.is_in_bend {
            self.is_in_bend = is_in_bend;
            self.set_blur(self.blur);
        }
    }

    /// A step below the shortest, where that was refused and no kink explains it; `None` where rounding forbids one.
    pub fn begin_bend(&mut self, h: f64) -> Option<f64> {
        let shorter = SHORTER[1] * h;
        if self.is_in_bend || shorter >= SHORTER_THAN * self.shortest {
            return None;
        }
        self.set_length(shorter);
        let is_permitted = shorter >= self.limits.min;
        if !is_permitted {
            self.set_length(h);
        }
        is_permitted.then_some(shorter)
    }

    /// The longest step from a point: far from zero, in proportion to the largest unknown.
    pub fn longest(&self, z: &[f64]) -> f64 {
        let largest = z.iter().fold(0.0_f64, |m, z| m.max(z.abs()));
        self.limits.max * (largest / self.limits.far).max(1.0)
    }

    /// Whether one step more is worth more than the iterations saved by giving it up.
    pub fn is_precious(&self, h: f64) -> bool {
        h < 100.0 * self.limits.min
    }

    /// The step after one of length `h` that was taken, at whose end the branch is at the distance `moved` from its
    /// tangent; from the point `z`.
    pub fn after_taken(&mut self, h: f64, moved: f64, z: &[f64]) -> f64 {
        let growth = GROWTH.iter().find(|(below, _)| h < *below).map_or(1.0, |(_, growth)| *growth);
        if moved <= EASY * h { (h * growth).min(self.longest(z)) } else { h }
    }

    /// A step begins, or a kink was passed.
    pub fn begin(&mut self) {
        self.refused_in_a_row = 0;
    }

    /// A shorter step than one that was refused; `None` where that was the shortest.
    pub fn after_refused(&mut self, h: f64, refusal: &Refusal) -> Option<f64> {
        let min = self.limits.min;
        if h <= min {
            return None;
        }
        let shorter = match refusal {
            Refusal::SeveralCrossings { next, .. } => next.min(0.7 * h),
            _ => h * SHORTER[self.refused_in_a_row.min(1)],
        };
        self.refused_in_a_row += 1;
        Some(shorter.max(min))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn control() -> StepControl {
        StepControl::new(&StepSettings { initial: 0.02, min: 1e-6, max: 0.5, far: 2.0, ..StepSettings::default() })
    }

    #[test]
    fn easy_steps_grow_to_the_longest_and_others_keep_their_length() {
        let mut control = control();
        assert_eq!(control.initial(), 0.02);
        // A circle of radius one leaves its tangent by h²/2.
        let after = |control: &mut StepControl, h: f64| control.after_taken(h, 0.5 * h * h, &[0.3, -1.0]);
        for (h, expected) in [(1e-4, 2.5e-4), (0.01, 0.014), (0.11, 0.154), (0.13, 0.13)] {
            assert!((after(&mut control, h) / expected - 1.0).abs() < 1e-12, "{h}: {}", after(&mut control, h));
        }
        assert_eq!(control.after_taken(0.45, 0.0, &[0.3, -1.0]), 0.5);
        // Five times as far away as where that begins, steps are five times as long at most.
        assert_eq!(control.longest(&[0.3, -10.0]), 2.5);
        assert_eq!(control.after_taken(2.4, 0.0, &[0.3, -10.0]), 2.5);
    }

    #[test]
    fn refused_steps_become_shorter_down_to_the_shortest_and_not_shorter_than_rounding_permits() {
        let mut control = control();
        let refusal = Refusal::CloseCurves;
        assert_eq!(control.after_refused(0.08, &refusal), Some(0.04));
        assert_eq!(control.after_refused(0.04, &refusal), Some(0.01));
        assert_eq!((control.after_refused(0.01, &refusal), control.refused_in_a_row()), (Some(0.0025), 3));
        control.begin();
        assert_eq!((control.refused_in_a_row(), control.after_refused(0.08, &refusal)), (0, Some(0.04)));
        // What is likely to tell branch points apart, but shorter by a third at least.
        for (next, expected) in [(0.03, 0.03), (0.09, 0.056)] {
            let several = Refusal::SeveralCrossings { count: 2, next };
            assert!((control.after_refused(0.08, &several).unwrap() - expected).abs() < 1e-15);
        }
        assert_eq!(control.after_refused(2e-6, &refusal), Some(1e-6));
        assert_eq!(control.after_refused(1e-6, &refusal), None);
        // In a bend that no kink explains down to a hundredth of it, until steps are as long again.
        assert_eq!(control.begin_bend(1e-6), Some(2.5e-7));
        assert_eq!((control.limits.min, control.begin_bend(2.5e-7)), (1e-8, None));
        control.set_length(9e-7);
        assert_eq!(control.limits.min, 1e-8);
        control.set_length(1e-6);
        assert_eq!(control.limits.min, 1e-6);
        assert!(control.is_precious(0.9e-4) && !control.is_precious(1.1e-4));
        assert!(!control.is_held_by_rounding());
        control.set_blur(1e-5);
        assert!(control.is_held_by_rounding());
        assert!((control.after_refused(1e-3, &refusal).unwrap() - 5e-4).abs() < 1e-15);
        assert_eq!(control.after_refused(5e-4, &refusal), None);
    }
}
