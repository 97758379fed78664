//! How Newton's method comes to rest.

/// Share of the shortest Newton step so far below which one counts as shorter: towards a point where curves cross, each
/// is half the one before. So many that are not shorter have come to rest.
const SHORTER: f64 = 0.7;
pub(super) const IDLE: usize = 3;

/// How the lengths of Newton's steps fall.
#[derive(Debug)]
pub(super) struct Progress {
    pub last: f64,
    pub least: f64,
    /// Steps in a row that were not clearly shorter than the shortest before.
    pub idle: usize,
}

impl Default for Progress {
    fn default() -> Self {
        Self { last: f64::INFINITY, least: f64::INFINITY, idle: 0 }
    }
}

impl Progress {
    pub fn step(&mut self, update: f64) {
        self.idle = if update < SHORTER * self.least { 0 } else { self.idle + 1 };
        self.least = self.least.min(update);
        self.last = update;
    }

    /// Whether this step is hardly shorter than the last.
    pub fn stagnates(&self, update: f64) -> bool {
        update > 0.5 * self.last
    }

    /// Whether steps do not become shorter any more.
    pub fn rests(&self, update: f64) -> bool {
        self.idle + usize::from(update >= SHORTER * self.least) >= IDLE
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whether steps of these lengths have come to rest with the last, and whether that hardly is shorter than the one
    /// before.
    fn seen(steps: &[f64]) -> (bool, bool) {
        let (last, before) = steps.split_last().unwrap();
        let mut progress = Progress::default();
        before.iter().for_each(|step| progress.step(*step));
        (progress.rests(*last), progress.stagnates(*last))
    }

    #[test]
    fn steps_rest_where_three_in_a_row_are_not_shorter_in_any_unit() {
        for unit in [1.0, 1e-9] {
            let seen = |steps: &[f64]| seen(&steps.iter().map(|step| unit * step).collect::<Vec<f64>>());
            // Towards a branch point each step is half the one before; so they go on.
            assert_eq!(seen(&[1.0, 0.5, 0.25, 0.125, 0.0625]), (false, false));
            assert_eq!(seen(&[1.0, 0.1, 0.09, 0.11]), (false, true));
            assert_eq!(seen(&[1.0, 0.1, 0.09, 0.11, 0.1]), (true, true));
            // One that is shorter begins the count anew.
            assert_eq!(seen(&[1.0, 0.1, 0.09, 0.11, 0.02, 0.03, 0.02]), (false, true));
        }
    }
}
