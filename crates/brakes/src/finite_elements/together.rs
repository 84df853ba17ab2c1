//! Number of solutions of the whole brake that are under way together: each takes the memory of a factorisation, of which a machine with many threads may not hold
//! one for each.

use std::sync::{Condvar, Mutex, PoisonError};

use rayon::prelude::*;

use crate::Error;

/// Settings of a search of the whole brake, of which so many are under way together: they share the threads.
pub(super) fn search_options(together: usize) -> sparse::Options {
    let threads = (rayon::current_num_threads() / together.max(1)).max(1);
    sparse::Options { threads, ..sparse::Options::default() }
}

/// Places for solutions of the whole brake.
#[derive(Debug)]
pub(super) struct Together {
    count: usize,
    free: Mutex<usize>,
    freed: Condvar,
}

/// A place that is taken, until it is dropped.
struct Taken<'a>(&'a Together);

impl Together {
    /// `count` places, or one if that is 0.
    pub fn new(count: usize) -> Self {
        let count = count.max(1);
        Self { count, free: Mutex::new(count), freed: Condvar::new() }
    }

    /// Number of all places.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Complete solutions, as many together as there are places. These may themselves share their work among threads.
    ///
    /// # Errors
    /// An error of one of the solutions.
    pub fn map<T: Send, U: Send>(
        &self,
        mut of: Vec<T>,
        solve: impl Fn(T) -> Result<U, Error> + Sync,
    ) -> Result<Vec<U>, Error> {
        let mut all = Vec::with_capacity(of.len());
        while !of.is_empty() {
            let rest = of.split_off(self.count.min(of.len()));
            all.extend(of.into_par_iter().map(&solve).collect::<Result<Vec<U>, Error>>()?);
            of = rest;
        }
        Ok(all)
    }

    /// A solution in a place of its own, for which it waits. It may not share its work among threads: one that waits for its own part could be
    /// given work that waits for this place.
    pub fn one<T>(&self, solve: impl FnOnce() -> T) -> T {
        let mut free = self.free.lock().unwrap_or_else(PoisonError::into_inner);
        while *free == 0 {
            free = self.freed.wait(free).unwrap_or_else(PoisonError::into_inner);
        }
        *free -= 1;
        drop(free);
        let _place = Taken(self);
        solve()
    }
}

impl Drop for Taken<'_> {
    fn drop(&mut self) {
        *self.0.free.lock().unwrap_or_else(PoisonError::into_inner) += 1;
        self.0.freed.notify_one();
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use super::*;

    /// The most that were under way at any time, of work that says when it begins and ends.
    fn most_at_once(work: impl FnOnce(&(dyn Fn() + Sync))) -> usize {
        let (now, most) = (AtomicUsize::new(0), AtomicUsize::new(0));
        work(&|| {
            most.fetch_max(now.fetch_add(1, Ordering::SeqCst) + 1, Ordering::SeqCst);
            (0..100).for_each(|_| std::thread::yield_now());
            now.fetch_sub(1, Ordering::SeqCst);
        });
        most.into_inner()
    }

    #[test]
    fn no_more_are_under_way_than_there_are_places() {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(6).build().unwrap();
        for count in [0, 1, 2, 3] {
            let together = Together::new(count);
            let complete = most_at_once(|work| {
                let solve = |at: usize| {
                    work();
                    Ok(at)
                };
                let all = pool.install(|| together.map((0..20).collect(), solve)).unwrap();
                assert_eq!(all, (0..20).collect::<Vec<_>>());
            });
            let single = most_at_once(|work| pool.install(|| (0..40).into_par_iter().for_each(|_| together.one(work))));
            assert!(complete <= count.max(1) && single <= count.max(1), "{count}: {complete} {single}");
        }
    }

    #[test]
    fn a_solution_that_panics_gives_its_place_back() {
        let together = Together::new(1);
        let panics = || together.one(|| panic!("of the test"));
        assert!(std::panic::catch_unwind(std::panic::AssertUnwindSafe(panics)).is_err());
        assert_eq!(together.one(|| 3), 3);
    }
}
