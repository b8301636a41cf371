//! Factors of matrices with few bands, eliminated from both ends at once.
//!
//! Elimination is a chain: each row waits for the inverse pivot of the one before. From both ends there are
//! two chains, which a processor follows side by side, or two threads; they meet in the middle (twisted
//! factorisation; Babuska 1972). The result is the same either way.

use nalgebra::SVector;

use super::inverse;
use crate::parallel::both;
use crate::scalar::Scalar;

/// Fewest rows of a chain that another thread is worth being woken for.
const MANY: usize = 4096;

/// Those above, between and below: the first are eliminated downwards, the last upwards, and those between,
/// `least` or one more, after both.
#[inline(always)]
fn split<X>(items: &[X], least: usize) -> [&[X]; 3] {
    let half = items.len().saturating_sub(least) / 2;
    let (above, rest) = items.split_at(half);
    let (between, below) = rest.split_at(rest.len() - half);
    [above, between, below]
}

/// The same.
#[inline(always)]
fn split_mut<X>(items: &mut [X], least: usize) -> [&mut [X]; 3] {
    let half = items.len().saturating_sub(least) / 2;
    let (above, rest) = items.split_at_mut(half);
    let (between, below) = rest.split_at_mut(rest.len() - half);
    [above, between, below]
}

/// Elimination downwards; the entry `(i, j)` of row `i` is at `W - 1 + j - i`.
#[derive(Clone, Copy)]
pub(super) struct Downwards<T, const W: usize> {
    /// The `W - 1` rows before, the latest last; the last entry of each is its inverse pivot.
    before: [[T; W]; W],
}

impl<T: Scalar, const W: usize> Downwards<T, W> {
    #[inline(always)]
    pub(super) fn new() -> Self {
        Self {
            before: [[T::zero(); W]; W],
        }
    }

    /// Makes the next row one of `L`, with the inverse pivot on the diagonal.
    #[inline(always)]
    pub(super) fn take(&mut self, row: &mut [T; W], negligible: T) {
        let before = &mut self.before;
        // L D, left to right; column k belongs to the row `before[k + 1]`.
        let mut entries = *row;
        for k in 0..W - 1 {
            for m in 0..k {
                entries[k] -= entries[m] * before[k + 1][W - 1 - (k - m)];
            }
        }
        let mut pivot = row[W - 1];
        for k in 0..W - 1 {
            row[k] = entries[k] * before[k + 1][W - 1];
            pivot -= entries[k] * row[k];
        }
        row[W - 1] = inverse(pivot, negligible);
        for k in 1..W {
            before[k - 1] = before[k];
        }
        before[W - 1] = *row;
    }
}

/// Elimination upwards.
#[derive(Clone, Copy)]
struct Upwards<T, const W: usize> {
    /// What is still to be taken from the rows above, the nearest first.
    taken: [[T; W]; W],
}

impl<T: Scalar, const W: usize> Upwards<T, W> {
    #[inline(always)]
    fn new() -> Self {
        Self {
            taken: [[T::zero(); W]; W],
        }
    }

    /// Makes the next row above one of the factor, with the inverse pivot on the diagonal.
    #[inline(always)]
    fn take(&mut self, row: &mut [T; W], negligible: T) {
        let entries: [T; W] = std::array::from_fn(|k| row[k] - self.taken[0][k]);
        let inverse_pivot = inverse(entries[W - 1], negligible);
        for k in 0..W - 1 {
            row[k] = entries[k] * inverse_pivot;
        }
        row[W - 1] = inverse_pivot;
        for above in 0..W - 1 {
            self.taken[above] = self.taken[above + 1];
            // From the entry `r` to the left of that row's diagonal.
            for r in 0..W - 1 - above {
                self.taken[above][W - 1 - r] += entries[W - 2 - above] * row[W - 2 - above - r];
            }
        }
    }
}

/// Substitution away from an end, into the rows ahead, and of a row from those behind it; the nearest first.
#[derive(Clone, Copy)]
struct Taken<T, const W: usize>([T; W]);

impl<T: Scalar, const W: usize> Taken<T, W> {
    /// Takes from the next number what is to be taken, and notes what `row` has that number take from those
    /// after it.
    #[inline(always)]
    fn pass(&mut self, row: &[T; W], number: T) -> T {
        let value = number - self.0[0];
        for k in 0..W - 1 {
            self.0[k] = self.0[k + 1] + row[W - 2 - k] * value;
        }
        value
    }
}

/// The last numbers found, the latest last.
#[derive(Clone, Copy)]
struct Found<T, const W: usize>([T; W]);

impl<T: Scalar, const W: usize> Found<T, W> {
    /// The next number, less what `row` has it take from the last ones.
    #[inline(always)]
    fn pass(&mut self, row: &[T; W], number: T) -> T {
        let mut value = number;
        for k in 0..W - 1 {
            value -= row[k] * self.0[k + 1];
        }
        for k in 1..W {
            self.0[k - 1] = self.0[k];
        }
        self.0[W - 1] = value;
        value
    }
}

/// A row and its number.
type Item<'a, T, const D: usize, const W: usize> = (&'a mut [T; W], &'a mut SVector<T, D>);

/// Factorises in place, inverse pivots on the diagonal, and solves for component `axis`.
pub(super) fn factorise_and_solve<T: Scalar, const D: usize, const W: usize>(
    rows: &mut [T],
    negligible: T,
    x: &mut [SVector<T, D>],
    axis: usize,
    parallel: bool,
) {
    let (rows, _) = rows.as_chunks_mut::<W>();
    let x = &mut x[..rows.len()];
    let [above, between, below] = split_mut(rows, W - 1);
    let [x_above, x_between, x_below] = split_mut(x, W - 1);
    let (found, taken) = (Found([T::zero(); W]), Taken([T::zero(); W]));
    let step = |(down, found): &mut (Downwards<T, W>, Found<T, W>), (row, x): Item<'_, T, D, W>| {
        down.take(row, negligible);
        x[axis] = found.pass(row, x[axis]);
    };
    let down_above = Chain {
        state: (Downwards::new(), found),
        items: above.iter_mut().zip(x_above),
        step,
    };
    let up_below = Chain {
        state: (Upwards::new(), taken),
        items: below.iter_mut().zip(x_below).rev(),
        step: |(up, taken): &mut (Upwards<T, W>, Taken<T, W>), (row, x): Item<'_, T, D, W>| {
            up.take(row, negligible);
            x[axis] = taken.pass(row, x[axis]);
        },
    };
    let (mut down, (up, taken)) = follow(parallel, down_above, up_below);
    let left = up.taken[..W - 1].iter().zip(taken.0);
    for ((row, x), (entries, number)) in between.iter_mut().zip(&mut *x_between).rev().zip(left) {
        for k in 0..W {
            row[k] -= entries[k];
        }
        x[axis] -= number;
    }
    for item in between.iter_mut().zip(x_between) {
        step(&mut down, item);
    }
    substitute(rows, x, axis, parallel);
}

/// Solves for component `axis` with the factors of [`factorise_and_solve`].
pub(super) fn solve<T: Scalar, const D: usize, const W: usize>(
    rows: &[T],
    x: &mut [SVector<T, D>],
    axis: usize,
    parallel: bool,
) {
    let (rows, _) = rows.as_chunks::<W>();
    let x = &mut x[..rows.len()];
    let [above, between, below] = split(rows, W - 1);
    let [x_above, x_between, x_below] = split_mut(x, W - 1);
    let find = |down: &mut Found<T, W>, (row, x): (&[T; W], &mut SVector<T, D>)| {
        x[axis] = down.pass(row, x[axis]);
    };
    let down_above = Chain {
        state: Found([T::zero(); W]),
        items: above.iter().zip(x_above),
        step: find,
    };
    let up_below = Chain {
        state: Taken([T::zero(); W]),
        items: below.iter().zip(x_below).rev(),
        step: |up: &mut Taken<T, W>, (row, x): (&[T; W], &mut SVector<T, D>)| {
            x[axis] = up.pass(row, x[axis]);
        },
    };
    let (mut down, up) = follow(parallel, down_above, up_below);
    for (x, &taken) in x_between.iter_mut().rev().zip(&up.0[..W - 1]) {
        x[axis] -= taken;
    }
    for item in between.iter().zip(x_between) {
        find(&mut down, item);
    }
    substitute(rows, x, axis, parallel);
}

/// Puts what is known in, from the middle to both ends.
#[inline(always)]
fn substitute<T: Scalar, const D: usize, const W: usize>(
    rows: &[[T; W]],
    x: &mut [SVector<T, D>],
    axis: usize,
    parallel: bool,
) {
    let [above, between, below] = split(rows, W - 1);
    let [x_above, x_between, x_below] = split_mut(x, W - 1);
    let mut up = Taken([T::zero(); W]);
    for (row, x) in between.iter().zip(&mut *x_between).rev() {
        x[axis] = up.pass(row, x[axis] * row[W - 1]);
    }
    let mut down = Found([T::zero(); W]);
    for (k, x) in x_between.iter().rev().take(W - 1).enumerate() {
        down.0[W - 1 - k] = x[axis];
    }
    let up_above = Chain {
        state: up,
        items: above.iter().zip(x_above).rev(),
        step: |up: &mut Taken<T, W>, (row, x): (&[T; W], &mut SVector<T, D>)| {
            x[axis] = up.pass(row, x[axis] * row[W - 1]);
        },
    };
    let down_below = Chain {
        state: down,
        items: below.iter().zip(x_below),
        step: |down: &mut Found<T, W>, (row, x): (&[T; W], &mut SVector<T, D>)| {
            x[axis] = down.pass(row, x[axis] * row[W - 1]);
        },
    };
    follow(parallel, up_above, down_below);
}

/// Steps that each change a state and an item.
struct Chain<S, I, F> {
    state: S,
    items: I,
    step: F,
}

impl<S, I: Iterator, F: Fn(&mut S, I::Item)> Chain<S, I, F> {
    /// The state after all steps. The state is a variable of this function's own, which a compiler keeps in
    /// registers.
    #[inline(always)]
    fn last(self) -> S {
        let mut state = self.state;
        for item in self.items {
            (self.step)(&mut state, item);
        }
        state
    }
}

/// The states after all steps of two chains of the same length, which are followed side by side or by a
/// thread each.
#[inline(always)]
fn follow<S, I, F, R, J, G>(parallel: bool, first: Chain<S, I, F>, second: Chain<R, J, G>) -> (S, R)
where
    S: Copy + Send,
    I: ExactSizeIterator + Send,
    F: Fn(&mut S, I::Item) + Send,
    R: Copy + Send,
    J: Iterator + Send,
    G: Fn(&mut R, J::Item) + Send,
{
    if parallel && first.items.len() >= MANY {
        let (mut s, mut r) = (first.state, second.state);
        let (mut first, mut second) = (Some(first), Some(second));
        both(true, &mut || s = first.take().map_or(s, Chain::last), &mut || {
            r = second.take().map_or(r, Chain::last)
        });
        return (s, r);
    }
    // Others than those of above, to which threads have pointers: these stay in registers.
    let (mut s, mut r) = (first.state, second.state);
    for (a, b) in first.items.zip(second.items) {
        (first.step)(&mut s, a);
        (second.step)(&mut r, b);
    }
    (s, r)
}
