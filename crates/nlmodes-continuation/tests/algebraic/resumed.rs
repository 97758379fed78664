//! A run that was cut off and goes on from its log is the run that was never cut off.

use std::cell::Cell;
use std::convert::Infallible;
use std::ops::ControlFlow;

use nlmodes_continuation::{
    Branch, BranchPoint, BranchTree, Continuation, Correction, Linearization, ParametricSystem, RunLog, StepRecord,
};

use crate::samples::{piecewise, smooth, window};

/// The steps of runs, in their order.
#[derive(Default, Clone)]
struct Log {
    runs: Vec<(Correction, Vec<StepRecord>)>,
    /// Number of the run in progress, from 1.
    run: usize,
}

impl Log {
    /// As if the computation had been cut off behind so many steps.
    fn cut(&self, steps: usize) -> Self {
        let (mut runs, mut left) = (Vec::new(), steps);
        for (start, records) in &self.runs {
            let kept = records.len().min(left);
            left -= kept;
            if kept > 0 {
                runs.push((start.clone(), records[..kept].to_vec()));
            }
        }
        Self { runs, run: 0 }
    }

    fn steps(&self) -> usize {
        self.runs.iter().map(|(_, records)| records.len()).sum()
    }
}

impl RunLog for Log {
    fn begin(&mut self, start: &Correction) -> Vec<StepRecord> {
        self.run += 1;
        match self.runs.get(self.run - 1) {
            Some((known, records)) => {
                assert_eq!(known.z, start.z);
                records.clone()
            }
            None => {
                self.runs.push((start.clone(), Vec::new()));
                Vec::new()
            }
        }
    }

    fn record(&mut self, step: &StepRecord) -> ControlFlow<()> {
        let records = &mut self.runs[self.run - 1].1;
        // What was asked to end goes on now.
        records.pop_if(|last| last.stop.is_some());
        records.push(step.clone());
        ControlFlow::Continue(())
    }
}

/// Counts how often a system is evaluated.
struct Counted<'a, S>(S, &'a Cell<usize>);

impl<S: ParametricSystem> ParametricSystem for Counted<'_, S> {
    type Error = S::Error;

    fn dim(&self) -> usize {
        self.0.dim()
    }

    fn linearize(&mut self, x: &[f64], p: f64, out: &mut Linearization) -> Result<(), S::Error> {
        self.1.set(self.1.get() + 1);
        self.0.linearize(x, p, out)
    }

    fn pattern(&self) -> u64 {
        self.0.pattern()
    }
}

/// Follows a curve with the log; `shown` sees the points and may stop it.
fn follow<S: ParametricSystem>(
    settings: &Continuation,
    mut system: S,
    from: [f64; 2],
    log: &mut Log,
    shown: impl FnMut(&BranchPoint) -> ControlFlow<()>,
) -> Branch {
    log.run = 0;
    settings.run_with_log(&mut system, &from[..1], from[1], &[0.0, 1.0], log, shown).unwrap()
}

/// Cuts the run at every step and at every point, and compares.
fn check<S: ParametricSystem<Error = Infallible>>(settings: &Continuation, system: impl Fn() -> S, from: [f64; 2]) {
    let mut whole = Log::default();
    let go_on = |_: &BranchPoint| ControlFlow::Continue(());
    let expected = follow(settings, system(), from, &mut whole, go_on);
    for steps in 0..=whole.steps() {
        let mut log = whole.cut(steps);
        let (count, mut seen) = (Cell::new(0), Vec::new());
        let found = follow(settings, Counted(system(), &count), from, &mut log, |point| {
            seen.push(point.clone());
            ControlFlow::Continue(())
        });
        assert_eq!(found, expected, "cut behind step {steps}");
        assert_eq!(seen, expected.points, "each point is shown once");
        assert_eq!(log.runs, whole.runs);
        if steps == whole.steps() {
            // One for each point and each arm, to see that they solve the equations.
            let arms: usize = expected.crossings.iter().map(|crossing| crossing.arms.len()).sum();
            let (known, count) = (expected.points.len() + arms, count.get());
            assert!(count < known + 5, "{count} evaluations for a branch of {known} points that are known");
        }
    }
    for point in 1..=expected.points.len() {
        let (mut log, mut count) = (Log::default(), 0);
        let stopped = follow(settings, system(), from, &mut log, |_| {
            count += 1;
            if count == point { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        assert_eq!(stopped.points, expected.points[..point]);
        let mut seen = Vec::new();
        let found = follow(settings, system(), from, &mut log, |point| {
            seen.push(point.clone());
            ControlFlow::Continue(())
        });
        assert_eq!((&found, &seen), (&expected, &expected.points), "stopped at point {point}");
        assert_eq!(log.runs, whole.runs);
    }
}

#[test]
fn a_closed_curve_goes_on_wherever_it_was_cut() {
    let circle = || smooth(|x, p| [x * x + p * p - 1.0, 2.0 * x, 2.0 * p]);
    check(&Continuation::default(), circle, [1.0, 0.0]);
}

#[test]
fn a_curve_through_a_crossing_goes_on_wherever_it_was_cut() {
    let pitchfork = || smooth(|x: f64, p: f64| [x * (p - x * x), p - 3.0 * x * x, x]);
    check(&window(1, -1.0, 0.9), pitchfork, [0.0, -0.613]);
}

#[test]
fn a_curve_around_a_corner_goes_on_wherever_it_was_cut() {
    let slope = |p: f64| if p < 0.0 { 0.2 } else { -8.0 };
    let corner = || piecewise(move |x, p| [x - slope(p) * p, 1.0, -slope(p)], |_, p| u64::from(p >= 0.0));
    check(&window(1, -0.7, 0.6), corner, [-0.14, -0.7]);
}

#[test]
fn a_tree_goes_on_wherever_it_was_cut() {
    let circles = || {
        smooth(|x: f64, p: f64| {
            let (a, b) = (x * x + p * p - 1.0, (x - 1.0) * (x - 1.0) + p * p - 1.0);
            [a * b, 2.0 * x * b + 2.0 * (x - 1.0) * a, 2.0 * p * (a + b)]
        })
    };
    let follow = |log: &mut Log| -> BranchTree {
        log.run = 0;
        let go_on = |_: usize, _: &BranchPoint| ControlFlow::Continue(());
        Continuation::default().run_tree_with_log(&mut circles(), &[-1.0], 0.0, &[0.0, 1.0], 20, log, go_on).unwrap()
    };
    let mut whole = Log::default();
    let expected = follow(&mut whole);
    assert!(expected.branches.len() > 1);
    for steps in 0..=whole.steps() {
        let mut log = whole.cut(steps);
        assert_eq!(follow(&mut log), expected, "cut behind step {steps}");
        assert_eq!(log.runs, whole.runs);
    }
}
