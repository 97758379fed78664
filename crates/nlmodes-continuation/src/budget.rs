//! Time for what is done beside a study, such as the stability of its points.

use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use crate::Watch;

/// Without a number, so many times what is done beside it, and so many seconds at least.
const TIMES: u32 = 3;
const LEAST: Duration = Duration::from_secs(10);

/// A budget of wall time for optional work: what exceeds it is cut off, and counted.
#[derive(Debug)]
pub struct Budget {
    limit: Option<Duration>,
    begun: Instant,
    spent: Duration,
    left_out: usize,
}

impl Budget {
    /// Of so many seconds; without a number three times what is done beside it, and ten seconds at least.
    pub fn new(seconds: Option<f64>) -> Self {
        let limit = seconds.map(|s| Duration::try_from_secs_f64(s.max(0.0)).unwrap_or(Duration::MAX));
        Self { limit, begun: Instant::now(), spent: Duration::ZERO, left_out: 0 }
    }

    /// Does the work with a watch that ends it where the budget is used up, or where `watch` does; `None` where it did
    /// not come to an end.
    pub fn spend<T>(&mut self, watch: &Watch, work: impl FnOnce(&Watch) -> Option<T>) -> Option<T> {
        let left = self.left();
        if left.is_zero() {
            self.left_out += 1;
            return None;
        }
        let (began, own) = (Instant::now(), watch.clone());
        let watched = Watch::new(move |_, _| match own.lets_go_on() {
            ControlFlow::Continue(()) if began.elapsed() >= left => ControlFlow::Break(()),
            other => other,
        });
        let found = work(&watched);
        self.spent += began.elapsed();
        if found.is_none() && watched.has_ended() && !watch.has_ended() {
            self.left_out += 1;
        }
        found
    }

    fn left(&self) -> Duration {
        let limit = self.limit.unwrap_or_else(|| LEAST.max(self.beside().saturating_mul(TIMES)));
        limit.saturating_sub(self.spent)
    }

    /// Whether no time is left.
    pub fn is_used_up(&self) -> bool {
        self.left().is_zero()
    }

    /// Time that has passed without the work.
    pub fn beside(&self) -> Duration {
        self.begun.elapsed().saturating_sub(self.spent)
    }

    /// How often the work was left out or cut off.
    pub fn left_out(&self) -> usize {
        self.left_out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_beyond_the_budget_is_left_out_and_counted() {
        let mut budget = Budget::new(Some(0.0));
        assert_eq!(budget.spend(&Watch::default(), |_| Some(1)), None);
        assert!(budget.left_out() == 1 && budget.is_used_up());
        let mut budget = Budget::new(Some(0.02));
        let until_ended = |watch: &Watch| -> Option<()> {
            while watch.evaluates().is_ok() {
                std::thread::sleep(Duration::from_millis(1));
            }
            None
        };
        assert_eq!(budget.spend(&Watch::default(), until_ended), None);
        assert_eq!(budget.left_out(), 1);
        // What finds nothing by itself is not cut off.
        let mut budget = Budget::new(None);
        assert_eq!(budget.spend(&Watch::default(), |_| None::<()>), None);
        assert_eq!((budget.spend(&Watch::default(), |_| Some(3)), budget.left_out()), (Some(3), 0));
    }
}
