//! Number of threads.

use std::cell::Cell;
use std::marker::PhantomData;
use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, OnceLock, PoisonError};
use std::thread;

use faer::MatMut;

/// Maximum number of threads of one computation: it has few tasks, and memory bandwidth supports no more.
const MOST: usize = 8;

/// Threads registered as busy.
static WORKERS: AtomicUsize = AtomicUsize::new(0);
/// Threads currently helping others.
static HELPERS: AtomicUsize = AtomicUsize::new(0);

/// Registers a busy thread for as long as this value lives: factorisations of large matrices, which otherwise use all
/// cores, leave it its core.
///
/// Results do not depend on it, to the last bit.
#[derive(Debug)]
pub struct Worker {
    /// It belongs to the thread that created it.
    own: PhantomData<*const ()>,
}

thread_local! {
    /// Number of registered [`Worker`]s of this thread.
    static COUNTED: Cell<usize> = const { Cell::new(0) };
}

impl Worker {
    /// Registers the calling thread.
    pub fn new() -> Self {
        count(1);
        Self { own: PhantomData }
    }

    /// Waits with `wait` for another thread, which may use the core of this one meanwhile.
    pub fn idle<T>(wait: impl FnOnce() -> T) -> T {
        let counted = COUNTED.get();
        uncount(counted);
        let result = wait();
        count(counted);
        result
    }
}

impl Default for Worker {
    fn default() -> Self {
        Self::new()
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        uncount(1);
    }
}

fn count(workers: usize) {
    COUNTED.set(COUNTED.get() + workers);
    WORKERS.fetch_add(workers, Ordering::Relaxed);
}

fn uncount(workers: usize) {
    COUNTED.set(COUNTED.get() - workers);
    WORKERS.fetch_sub(workers, Ordering::Relaxed);
}

/// Number of threads currently free to help: the cores that are not used by [`Worker`]s (one is assumed if none is
/// registered) or by helpers.
#[derive(Debug)]
struct Helpers(usize);

impl Helpers {
    fn at_most(wanted: usize) -> Self {
        #[cfg(test)]
        if let Some(count) = tests::FORCED.get() {
            let count = wanted.min(count);
            HELPERS.fetch_add(count, Ordering::Relaxed);
            return Self(count);
        }
        let free = |taken: usize| cores().saturating_sub(WORKERS.load(Ordering::Relaxed).max(1) + taken).min(wanted);
        let mut count = 0;
        let took = HELPERS.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |taken| {
            count = free(taken);
            Some(taken + count)
        });
        Self(took.map_or(0, |_| count))
    }
}

impl Drop for Helpers {
    fn drop(&mut self) {
        HELPERS.fetch_sub(self.0, Ordering::Relaxed);
    }
}

/// Cores of the machine that this process may use, eight at most.
fn cores() -> usize {
    static CORES: OnceLock<usize> = OnceLock::new();
    *CORES.get_or_init(|| thread::available_parallelism().map_or(1, NonZeroUsize::get).min(MOST))
}

/// This many multiplications take some milliseconds: fewer are not worth a thread.
const WORTHWHILE: usize = 1 << 22;

/// Whether several threads are worthwhile for this many multiplications. It depends on the problem alone, not on the
/// machine.
pub(crate) fn pays(multiplications: usize) -> bool {
    multiplications >= WORTHWHILE
}

/// Rows of a piece of a tall matrix that one thread works on.
const TALL: usize = 1 << 14;

/// The rows of `x` in pieces for [`spread`], with the first row of each.
pub(crate) fn in_pieces(mut x: MatMut<'_, f64>) -> Vec<(usize, MatMut<'_, f64>)> {
    let (mut pieces, mut first) = (Vec::new(), 0);
    while x.nrows() > TALL {
        let (piece, rest) = x.split_at_row_mut(TALL);
        pieces.push((first, piece));
        (x, first) = (rest, first + TALL);
    }
    pieces.push((first, x));
    pieces
}

/// The results of `work` for the `tasks`, in their order. The tasks are started in this order, by this thread and those
/// that are free to help, each with its own workspace.
pub(crate) fn spread<A: Send, B: Send, W>(
    tasks: Vec<A>,
    workspace: impl Fn() -> W + Sync,
    work: impl Fn(&mut W, A) -> B + Sync,
) -> Vec<B> {
    let helpers = Helpers::at_most(tasks.len().saturating_sub(1));
    spread_over(helpers.0, tasks, workspace, work)
}

/// As [`spread`], with this many additional threads.
fn spread_over<A: Send, B: Send, W>(
    helpers: usize,
    tasks: Vec<A>,
    workspace: impl Fn() -> W + Sync,
    work: impl Fn(&mut W, A) -> B + Sync,
) -> Vec<B> {
    if helpers == 0 {
        let mut own = workspace();
        return tasks.into_iter().map(|task| work(&mut own, task)).collect();
    }
    let count = tasks.len();
    let queue = Mutex::new(tasks.into_iter().enumerate());
    let next = || queue.lock().unwrap_or_else(PoisonError::into_inner).next();
    let worker = || {
        let (mut own, mut done) = (workspace(), Vec::new());
        while let Some((i, task)) = next() {
            done.push((i, work(&mut own, task)));
        }
        done
    };
    let mut results: Vec<(usize, B)> = Vec::with_capacity(count);
    thread::scope(|scope| {
        let others: Vec<_> = (0..helpers).map(|_| scope.spawn(worker)).collect();
        results.extend(worker());
        for other in others {
            match other.join() {
                Ok(done) => results.extend(done),
                Err(panic) => std::panic::resume_unwind(panic),
            }
        }
    });
    results.sort_unstable_by_key(|result| result.0);
    results.into_iter().map(|result| result.1).collect()
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    thread_local! {
        pub(super) static FORCED: Cell<Option<usize>> = const { Cell::new(None) };
    }

    /// The result of `work` on this thread with this many additional threads, whatever the machine has.
    pub(crate) fn with_helpers<T>(count: usize, work: impl FnOnce() -> T) -> T {
        FORCED.set(Some(count));
        let result = work();
        FORCED.set(None);
        result
    }

    #[test]
    fn results_are_in_the_order_of_their_tasks_with_any_number_of_threads() {
        for helpers in [0, 1, 5] {
            let squares = with_helpers(helpers, || spread((0..100).collect(), || 0, |_, i: usize| i * i));
            assert!(squares.iter().enumerate().all(|(i, square)| *square == i * i) && squares.len() == 100);
            assert!(with_helpers(helpers, || spread(Vec::<u8>::new(), || (), |(), i| i)).is_empty());
        }
    }

    #[test]
    fn each_thread_has_a_workspace_of_its_own() {
        // As many tasks as threads, each of which waits for the others.
        let all = std::sync::Barrier::new(3);
        let counts = with_helpers(2, || {
            spread(
                vec![(); 3],
                || 0,
                |own, ()| {
                    all.wait();
                    *own += 1;
                    *own
                },
            )
        });
        assert_eq!(counts, [1, 1, 1]);
    }

    #[test]
    fn pieces_of_a_matrix_have_all_of_its_rows() {
        for rows in [0, 1, TALL, TALL + 1, 3 * TALL] {
            let mut x = crate::Mat::zeros(rows, 2);
            for (first, mut piece) in in_pieces(x.as_mut()) {
                (0..piece.nrows()).for_each(|i| piece[(i, 1)] = (first + i) as f64);
            }
            assert!((0..rows).all(|i| x[(i, 1)] == i as f64));
        }
    }

    #[test]
    fn workers_leave_no_core_to_helpers() {
        let workers: Vec<_> = (0..MOST).map(|_| Worker::new()).collect();
        assert_eq!(Helpers::at_most(7).0, 0);
        let beside = || WORKERS.load(Ordering::Relaxed);
        let (working, idle) = (beside(), Worker::idle(beside));
        assert_eq!((working - idle, beside() - idle), (MOST, MOST));
        drop(workers);
    }
}
