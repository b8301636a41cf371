//! Work cut into spans that any number of threads may share without changing a bit of the result.
//!
//! A pass over particles or cells is cut into spans of fixed length. Each span writes to places of its own:
//! its share of the particles, its *window* of the DOFs, its partial result. What several spans contribute to
//! is added up span by span, in order. So the result depends on where the cuts are, which is fixed, and not
//! on who did which span.
//!
//! Spans are halved recursively ([`each_span`]) and shared by `rayon::join`: nothing is allocated here, and
//! little by rayon, when it wakes its threads. Without the feature `rayon`, or for one thread, the halves
//! follow one another.

mod sliced;
mod windows;

pub(crate) use sliced::{Groups, Maybe, PerSpan, Rows, Sliced};
pub(crate) use windows::{SpanWindow, Windows, add_up, fit};

/// Particles in a span.
pub(crate) const PARTICLES: usize = 4096;
/// Occupied cells in a span.
pub(crate) const CELLS: usize = 512;

/// Calls `f(first, part)` for each span of `work`, `first` the index of its first item; several at once if
/// `parallel`.
pub(crate) fn each_span<W: Sliced>(parallel: bool, span: usize, work: W, f: &(impl Fn(usize, W) + Sync)) {
    halve(parallel, span, 0, work, f);
}

/// Compiled once for each kind of work, not for each pass: what a span is passed to is called through a
/// pointer.
#[inline(never)]
fn halve<W: Sliced>(parallel: bool, span: usize, first: usize, work: W, f: &(dyn Fn(usize, W) + Sync)) {
    let spans = work.items().div_ceil(span);
    if spans <= 1 {
        return f(first, work);
    }
    let (left, right) = work.split(spans / 2, spans / 2 * span);
    let middle = first + spans / 2 * span;
    let (mut left, mut right) = (Some(left), Some(right));
    both(
        parallel,
        &mut || {
            left.take()
                .map_or((), |work| halve(parallel, span, first, work, f))
        },
        &mut || {
            right
                .take()
                .map_or((), |work| halve(parallel, span, middle, work, f))
        },
    );
}

/// Does both, at once if `parallel`. Not generic, for the sake of compile time: a call through a pointer for
/// thousands of particles costs nothing, `rayon::join` in every pass of every stepper minutes.
pub(crate) fn both(parallel: bool, a: &mut (dyn FnMut() + Send), b: &mut (dyn FnMut() + Send)) {
    #[cfg(feature = "rayon")]
    if parallel {
        rayon::join(a, b);
        return;
    }
    let _ = parallel;
    a();
    b();
}

/// Does `work` as one of the threads that share spans: in the pool of this thread, or else in rayon's global
/// one if it is `worth` being sent there.
///
/// `rayon::join` outside of a pool sends its work there and sleeps until it is done. A step has twenty joins:
/// so sent one by one, they cost more than a second thread brings, and the whole step is sent at once.
pub(crate) fn within_pool(worth: bool, work: &mut (dyn FnMut() + Send)) {
    #[cfg(feature = "rayon")]
    if worth && rayon::current_thread_index().is_none() && rayon::current_num_threads() > 1 {
        return rayon::scope(|_| work());
    }
    let _ = worth;
    work();
}

/// Whether so many items, cut into spans, are enough for two threads: four spans along one axis, where a pass
/// over a span takes some microseconds; two in the plane; one and a half in space, of which one thread leaves
/// the other a third.
///
/// Measured on cores that share a cache and on cores that do not (a word takes 0.3 microseconds to the other
/// and back). On the latter, with plain steps along one axis, 8200 particles took two threads 1.2 times the
/// time of one, 16 000 took 0.9; in the plane 6100 took as long, 8100 took 0.85. Where the cache is shared it
/// was 0.7, 0.6, 0.75 and 0.6, in space 0.75 with 5800 particles and 0.55 with 8000.
pub(crate) fn are_many<const D: usize>(items: usize, span: usize) -> bool {
    let half_spans = match D {
        1 => 8,
        2 => 4,
        _ => 3,
    };
    2 * items >= half_spans * span
}

/// Whether threads should share so many items.
pub(crate) fn worth_sharing<const D: usize>(items: usize, span: usize) -> bool {
    are_many::<D>(items, span) && many_threads()
}

/// Whether there is more than one thread to share spans, and this is one of them.
pub(crate) fn many_threads() -> bool {
    #[cfg(feature = "rayon")]
    return rayon::current_thread_index().is_some() && rayon::current_num_threads() > 1;
    #[cfg(not(feature = "rayon"))]
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_span_is_visited_once_with_its_own_part() {
        for (count, parallel) in [
            (0, false),
            (1, true),
            (9, false),
            (10, true),
            (11, true),
            (1000, true),
        ] {
            let mut numbers = vec![0_usize; count];
            let mut sums = vec![0_usize; count.div_ceil(10)];
            let work = (&mut numbers[..], PerSpan(&mut sums[..]));
            each_span(parallel, 10, work, &|first, (numbers, PerSpan(sums))| {
                for (k, number) in numbers.iter_mut().enumerate() {
                    *number += first + k;
                    sums[0] += 1;
                }
            });
            assert!(numbers.iter().enumerate().all(|(k, &number)| k == number));
            assert_eq!(sums.iter().sum::<usize>(), count);
            assert!(sums.iter().rev().skip(1).all(|&n| n == 10));
        }
    }
}
