//! The one queue of work: threads that take pieces one after the other.

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// As many threads as there are cores.
pub(crate) fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// Does every piece on so many threads, which take them in their order.
pub(crate) fn each<T: Sync>(jobs: usize, pieces: &[T], work: impl Fn(&T) + Sync) {
    let next = AtomicUsize::new(0);
    std::thread::scope(|scope| {
        for _ in 0..jobs.clamp(1, pieces.len().max(1)) {
            scope.spawn(|| {
                while let Some(piece) = pieces.get(next.fetch_add(1, Ordering::Relaxed)) {
                    work(piece);
                }
            });
        }
    });
}

/// The results of `work` at `0..count`, each at its own place; only what `order` names is done, in that order.
pub(crate) fn map<T: Send>(
    jobs: usize,
    count: usize,
    order: &[usize],
    work: impl Fn(usize) -> Option<T> + Sync,
) -> Vec<Option<T>> {
    let found: Vec<Mutex<Option<T>>> = (0..count).map(|_| Mutex::new(None)).collect();
    each(jobs, order, |&i| {
        let result = work(i);
        if let Ok(mut place) = found[i].lock() {
            *place = result;
        }
    });
    found.into_iter().map(|place| place.into_inner().ok().flatten()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_stand_at_their_own_places_whatever_thread_found_them() {
        let order: Vec<usize> = (0..100).rev().filter(|i| i % 3 != 0).collect();
        for jobs in [0, 1, 7, 1000] {
            let found = map(jobs, 100, &order, |i| (i % 5 != 0).then_some(i));
            let right = |(i, result): (usize, &Option<usize>)| *result == (i % 3 != 0 && i % 5 != 0).then_some(i);
            assert!(found.iter().enumerate().all(right), "{jobs} threads: {found:?}");
        }
        assert!(map(3, 0, &[], Some).is_empty());
    }
}
