//! How Newton's method comes to rest.

/// Share of the shortest Newton step so far below which one counts as shorter: towards a point where curves cross, each is half the one before.
/// So many that are not shorter have come to rest.
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
