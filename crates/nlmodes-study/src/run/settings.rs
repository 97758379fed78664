//! Settings of the computation of a study.

use std::fmt;
use std::num::NonZeroUsize;
use std::str::FromStr;
use std::thread;

use nlmodes_scene::memory::Limit;

/// Settings of the computation of a study.
#[derive(Debug, Clone, Copy, Default)]
pub struct Settings {
    /// Number of cases at a time; default: the number of cores.
    pub jobs: Option<NonZeroUsize>,
    /// The shard of the cases.
    pub shard: Shard,
    /// Whether cases that failed are computed again.
    pub retry: bool,
    /// Whether figures and page of each case are drawn.
    pub drawn: bool,
    /// Maximum memory of all cases computed at the same time; default: that of the machine.
    pub memory_limit: Option<Limit>,
}

impl Settings {
    /// Number of cases at a time.
    pub fn jobs(&self) -> usize {
        let cores = || thread::available_parallelism().map_or(1, NonZeroUsize::get);
        self.jobs.map_or_else(cores, NonZeroUsize::get)
    }

    /// Memory limit of one case.
    pub(crate) fn limit(&self) -> Limit {
        self.memory_limit.unwrap_or_else(Limit::of_machine).shared_by(self.jobs())
    }
}

/// Every n-th point of the design, beginning with one of the first n: `i/n`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    number: usize,
    of: usize,
}

impl Default for Shard {
    fn default() -> Self {
        Self { number: 0, of: 1 }
    }
}

impl Shard {
    /// The shard with this number; `None` if it is not below their number.
    pub fn new(number: usize, of: usize) -> Option<Self> {
        (number < of).then_some(Self { number, of })
    }

    /// Whether the point belongs to it.
    pub fn has(self, point: usize) -> bool {
        point % self.of == self.number
    }

    /// Whether it includes all cases.
    pub fn is_all(self) -> bool {
        self.of == 1
    }
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || format!("expected i/n with i from 0 to n − 1, as 0/8 to 7/8; found {text}");
        let (number, of) = text.split_once('/').ok_or_else(wrong)?;
        let number = number.trim().parse().map_err(|_| wrong())?;
        let of = of.trim().parse().map_err(|_| wrong())?;
        Self::new(number, of).ok_or_else(wrong)
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.number, self.of)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_share_all_cases_and_none_twice() {
        let shards: Vec<Shard> = (0..7).map(|k| format!("{k}/7").parse().unwrap()).collect();
        assert!((0..100).all(|case| shards.iter().filter(|shard| shard.has(case)).count() == 1));
        for wrong in ["7/7", "1", "a/b", "0/0", "-1/3", "8/7", "1/"] {
            assert!(wrong.parse::<Shard>().is_err(), "{wrong}");
        }
        assert!((0..10).all(|case| Shard::default().has(case)));
    }
}
