//! Jobs on all threads of the current pool.
//!
//! Rayon's iterators are compiled again for each closure, which was half of the machine code and of the build time.
//! Here only the result of a job is generic, not the scheduling.

use rayon::ThreadPool;
use rayon::prelude::*;
use std::cell::Cell;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// The result of `job` on a thread of `pool`; the functions of this module then use the pool's threads.
///
/// ```
/// # fn main() -> Result<(), rayon::ThreadPoolBuildError> {
/// use plaus_mcmc::parallel;
///
/// let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build()?;
/// assert_eq!(parallel::install(&pool, || parallel::map(3, |k| k + 1)), [1, 2, 3]);
/// # Ok(())
/// # }
/// ```
pub fn install<T: Send>(pool: &ThreadPool, job: impl FnOnce() -> T + Send) -> T {
    let (mut job, mut made) = (Some(job), None);
    enter(pool, &mut || made = job.take().map(|job| job()));
    made.unwrap_or_else(|| unreachable!("a job that does not panic makes something"))
}

/// The result of `job`, within which the functions of this module use no other thread than this one.
///
/// A pool of one thread would not do where many jobs do this at once: a thread that waits for another pool begins more
/// of its own pool's jobs meanwhile, each on top of the last, until its stack is full.
pub fn alone<T>(job: impl FnOnce() -> T) -> T {
    struct Before(bool);
    impl Drop for Before {
        fn drop(&mut self) {
            ALONE.set(self.0);
        }
    }
    let _before = Before(ALONE.replace(true));
    job()
}

thread_local! {
    /// Whether this thread is inside [`alone`].
    static ALONE: Cell<bool> = const { Cell::new(false) };
}

fn enter(pool: &ThreadPool, job: &mut (dyn FnMut() + Send)) {
    pool.install(job);
}

/// Threads of a run's own. Where there are none, as in WebAssembly, the one that calls does everything.
#[cfg(not(target_family = "wasm"))]
pub(crate) struct Threads(ThreadPool);

#[cfg(not(target_family = "wasm"))]
impl Threads {
    /// So many; 0 means one per core.
    pub(crate) fn new(count: usize) -> Result<Self, rayon::ThreadPoolBuildError> {
        Ok(Self(rayon::ThreadPoolBuilder::new().num_threads(count).build()?))
    }

    /// The result of `job` on one of them, see [`install`].
    pub(crate) fn install<T: Send>(&self, job: impl FnOnce() -> T + Send) -> T {
        install(&self.0, job)
    }
}

#[cfg(target_family = "wasm")]
pub(crate) struct Threads;

#[cfg(target_family = "wasm")]
impl Threads {
    pub(crate) fn new(_: usize) -> Result<Self, rayon::ThreadPoolBuildError> {
        Ok(Self)
    }

    pub(crate) fn install<T: Send>(&self, job: impl FnOnce() -> T + Send) -> T {
        job()
    }
}

/// Does a job for each number below `count`.
fn each(count: usize, job: &(dyn Fn(usize) + Sync)) {
    if cfg!(target_family = "wasm") || count < 2 || ALONE.get() || rayon::current_num_threads() == 1 {
        return (0..count).for_each(job);
    }
    (0..count).into_par_iter().with_max_len(1).for_each(job);
}

/// After a panic any content is acceptable, because the panic is passed on.
pub(crate) fn lock<T>(of: &Mutex<T>) -> MutexGuard<'_, T> {
    of.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The results of `job` for each number below `count`, in order.
///
/// ```
/// assert_eq!(plaus_mcmc::parallel::map(4, |k| k * k), [0, 1, 4, 9]);
/// ```
pub fn map<T: Send>(count: usize, job: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let made: Vec<Mutex<Option<T>>> = (0..count).map(|_| Mutex::new(None)).collect();
    each(count, &|k| {
        let one = job(k);
        *lock(&made[k]) = Some(one);
    });
    made.into_iter().filter_map(|one| one.into_inner().unwrap_or_else(PoisonError::into_inner)).collect()
}

/// The same for jobs that may fail. When one fails, jobs of larger numbers that have not begun are skipped.
///
/// # Errors
///
/// The error of the job with the smallest number that fails, even if another one failed earlier.
pub fn try_map<T: Send, E: Send>(count: usize, job: impl Fn(usize) -> Result<T, E> + Sync) -> Result<Vec<T>, E> {
    let failed = AtomicUsize::new(usize::MAX);
    let made = map(count, |k| {
        if k > failed.load(Relaxed) {
            return None;
        }
        let one = job(k);
        if one.is_err() {
            failed.fetch_min(k, Relaxed);
        }
        Some(one)
    });
    made.into_iter().flatten().collect()
}

/// The results of `job` for each of `items`, which it may change, in order.
pub fn map_mut<T: Send, R: Send>(items: &mut [T], job: impl Fn(usize, &mut T) -> R + Sync) -> Vec<R> {
    let items: Vec<Mutex<&mut T>> = items.iter_mut().map(Mutex::new).collect();
    map(items.len(), |k| job(k, &mut lock(&items[k])))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_failure_is_reported_whichever_job_was_faster() {
        for _ in 0..50 {
            let tried = try_map(200, |k| if k % 7 == 5 { Err(k) } else { Ok(k) });
            assert_eq!(tried, Err(5));
        }
        assert_eq!(try_map(3, Ok::<usize, ()>), Ok(vec![0, 1, 2]));
    }

    #[test]
    #[cfg_attr(target_family = "wasm", ignore = "needs threads")]
    fn a_thread_that_works_alone_begins_no_other_job() -> Result<(), rayon::ThreadPoolBuildError> {
        thread_local! {
            static BEGUN: Cell<usize> = const { Cell::new(0) };
        }
        let begin = |by: &dyn Fn() -> Vec<usize>| {
            BEGUN.set(BEGUN.get() + 1);
            let (depth, made) = (BEGUN.get(), by());
            BEGUN.set(BEGUN.get() - 1);
            depth.max(made.into_iter().max().unwrap_or(0))
        };
        let inner = || map(50, |_| begin(&Vec::new));
        let deepest = |outer: &(dyn Fn() -> Vec<usize> + Sync)| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(4).build()?;
            Ok(install(&pool, || map(200, |_| begin(&outer))).into_iter().max())
        };
        assert_eq!(deepest(&|| alone(inner))?, Some(2));
        // What waits for another pool takes what there is.
        let other = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
        assert!(deepest(&|| install(&other, inner))? > Some(2));
        Ok(())
    }

    #[test]
    fn each_item_is_changed_once() {
        let mut items: Vec<u64> = (0..100).collect();
        let before = map_mut(&mut items, |k, item| {
            let was = *item;
            *item += 1000 * k as u64;
            was
        });
        assert_eq!(before, (0..100).collect::<Vec<u64>>());
        assert!(items.iter().zip(0..).all(|(item, k)| *item == 1001 * k));
    }
}
