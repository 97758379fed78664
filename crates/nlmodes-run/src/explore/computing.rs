//! One computation at a time, the newest one.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use nlmodes::branches::Watch;

/// A new computation ends the current one.
#[derive(Default)]
pub struct Computing {
    /// Number of the newest.
    newest: Arc<AtomicU64>,
    at_work: Mutex<()>,
}

impl Computing {
    /// Ends the current computation, waits for its end, and computes; `None` if a newer request has arrived meanwhile.
    pub fn newest<T>(&self, work: impl FnOnce(Watch) -> T) -> Option<T> {
        let own = self.newest.fetch_add(1, Ordering::SeqCst) + 1;
        // A panic there leaves no inconsistent state.
        let _at_work = self.at_work.lock().unwrap_or_else(PoisonError::into_inner);
        if self.newest.load(Ordering::SeqCst) != own {
            return None;
        }
        let newest = Arc::clone(&self.newest);
        Some(work(Watch::until(move || newest.load(Ordering::SeqCst) != own)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::AtomicUsize;
    use std::thread;
    use std::time::{Duration, Instant};

    #[test]
    fn of_a_hundred_at_once_one_computes_at_a_time_and_the_newest_to_its_end() {
        let (computing, at_once, most) = (Computing::default(), AtomicUsize::new(0), AtomicUsize::new(0));
        let finished = AtomicUsize::new(0);
        let began = Instant::now();
        thread::scope(|scope| {
            for _ in 0..100 {
                scope.spawn(|| {
                    let done = computing.newest(|_| {
                        most.fetch_max(at_once.fetch_add(1, Ordering::SeqCst) + 1, Ordering::SeqCst);
                        thread::sleep(Duration::from_millis(5));
                        at_once.fetch_sub(1, Ordering::SeqCst);
                    });
                    finished.fetch_add(usize::from(done.is_some()), Ordering::SeqCst);
                });
            }
        });
        assert_eq!(most.load(Ordering::SeqCst), 1);
        let finished = finished.load(Ordering::SeqCst);
        assert!(finished >= 1 && began.elapsed() < Duration::from_secs(30), "{finished}");
        assert!(computing.newest(|_| ()).is_some());
    }
}
