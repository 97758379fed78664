//! Step control: the length of the next step, from how the last one went.

use crate::{Refusal, StepSettings};

/// Growth of the step after one that was easy, below this length, where a corner has just been passed, and above.
const GROWTH: [(f64, f64); 2] = [(1e-3, 2.5), (f64::INFINITY, 1.4)];

/// Distance of the branch from its tangent at the end of a step, over the step, up to which that was easy. Half the turn of the tangent is
/// about as much, so curvature decides how long steps become. Iterations do not count: near rounding Newton's method takes many.
const EASY: f64 = 0.06;

/// Shares of a step that are tried next where it is refused: at first, and again.
const SHORTER: [f64; 2] = [0.5, 0.25];

/// Shortest step, over the distance by which rounding blurs the point from which it starts: what is shorter says nothing about the curve.
const ABOVE_ROUNDING: f64 = 50.0;

/// The lengths that steps may have, and how often the step in progress was refused.
#[derive(Debug)]
pub(crate) struct StepControl {
    /// The settings, with a shortest step that is no shorter than rounding permits at the foot.
    pub limits: StepSettings,
    shortest: f64,
    refused_in_a_row: usize,
}

impl StepControl {
    pub fn new(settings: &StepSettings) -> Self {
        Self { limits: settings.clone(), shortest: settings.min, refused_in_a_row: 0 }
    }

    /// The first step.
    pub fn initial(&self) -> f64 {
        self.limits.initial.clamp(self.limits.min, self.limits.max)
    }

    /// How often the step in progress was refused.
    pub fn refused_in_a_row(&self) -> usize {
        self.refused_in_a_row
    }

    /// Points near the foot are known up to `blur`: no shorter step makes sense there.
    pub fn set_blur(&mut self, blur: f64) {
        self.limits.min = self.shortest.max(ABOVE_ROUNDING * blur).min(self.limits.max);
    }

    /// Whether rounding alone forbids shorter steps.
    pub fn is_held_by_rounding(&self) -> bool {
        self.limits.min > self.shortest
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

    /// The step after one of length `h` that was taken, at whose end the branch is at the distance `moved` from its tangent; from the point `z`.
    pub fn after_taken(&mut self, h: f64, moved: f64, z: &[f64]) -> f64 {
        let growth = GROWTH.iter().find(|(below, _)| h < *below).map_or(1.0, |(_, growth)| *growth);
        if moved <= EASY * h { (h * growth).min(self.longest(z)) } else { h }
    }

    /// A step begins, or a corner was passed.
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
