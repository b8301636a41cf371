//! Factors of matrices with few bands, `W` numbers a row: the rows that matter stay in registers.

use nalgebra::SVector;

use super::both_ends::Downwards;
use crate::scalar::Scalar;

/// `L D L^T` in place, inverse pivots on the diagonal.
pub(super) fn factorise<T: Scalar, const W: usize>(rows: &mut [T], negligible: T) {
    let (rows, _) = rows.as_chunks_mut::<W>();
    let mut down = Downwards::new();
    rows.iter_mut().for_each(|row| down.take(row, negligible));
}

/// Solves for component `axis`.
pub(super) fn solve<T: Scalar, const D: usize, const W: usize>(
    rows: &[T],
    x: &mut [SVector<T, D>],
    axis: usize,
) {
    solve_each::<T, _, W>(rows, x, |x| &mut x[axis]);
}

/// How many lines are solved side by side: one alone waits for itself.
pub(super) const ABREAST: usize = 8;

/// Solves for one number each in [`ABREAST`] lines that lie end to end.
#[inline(always)]
pub(super) fn solve_abreast<T: Scalar, const W: usize>(rows: &[T], x: &mut [T]) {
    let (rows, _) = rows.as_chunks::<W>();
    let length = rows.len();
    let x = &mut x[..ABREAST * length];
    let mut before = [[T::zero(); ABREAST]; W];
    for (i, row) in rows.iter().enumerate() {
        let mut value: [T; ABREAST] = std::array::from_fn(|l| x[l * length + i]);
        for k in 0..W - 1 {
            for l in 0..ABREAST {
                value[l] -= row[k] * before[k + 1][l];
            }
        }
        for l in 0..ABREAST {
            x[l * length + i] = value[l];
        }
        for k in 1..W {
            before[k - 1] = before[k];
        }
        before[W - 1] = value;
    }
    let mut taken = [[T::zero(); ABREAST]; W];
    for (i, row) in rows.iter().enumerate().rev() {
        let mut value = [T::zero(); ABREAST];
        for l in 0..ABREAST {
            value[l] = x[l * length + i] * row[W - 1] - taken[0][l];
            x[l * length + i] = value[l];
        }
        for k in 0..W - 1 {
            for l in 0..ABREAST {
                taken[k][l] = taken[k + 1][l] + row[W - 2 - k] * value[l];
            }
        }
    }
}

/// Solves for one number each.
#[inline(always)]
pub(super) fn solve_line<T: Scalar, const W: usize>(rows: &[T], x: &mut [T]) {
    solve_each::<T, _, W>(rows, x, |x| x);
}

#[inline(always)]
fn solve_each<T: Scalar, X, const W: usize>(rows: &[T], x: &mut [X], of: impl Fn(&mut X) -> &mut T) {
    let (rows, _) = rows.as_chunks::<W>();
    let mut before = [T::zero(); W];
    for (row, x) in rows.iter().zip(x.iter_mut()) {
        let x = of(x);
        let mut value = *x;
        for k in 0..W - 1 {
            value -= row[k] * before[k + 1];
        }
        *x = value;
        for k in 1..W {
            before[k - 1] = before[k];
        }
        before[W - 1] = value;
    }
    // What the rows already solved take from the next ones, nearest first.
    let mut taken = [T::zero(); W];
    for (row, x) in rows.iter().zip(x.iter_mut()).rev() {
        let x = of(x);
        let value = *x * row[W - 1] - taken[0];
        *x = value;
        for k in 0..W - 1 {
            taken[k] = taken[k + 1] + row[W - 2 - k] * value;
        }
    }
}
