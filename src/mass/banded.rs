//! Symmetric banded matrices.

mod both_ends;
mod narrow;

use nalgebra::SVector;

use crate::parallel::many_threads;
use crate::scalar::Scalar;
use crate::simd::with_features;

/// A symmetric matrix of order `n` with half band width `w`: entries `(i, j)` with `|i - j| <= w`, the lower
/// half stored by rows. Factorised in place as `L D L^T`, `O(n w^2)`; solved in `O(n w)`.
///
/// A mass matrix of a fit need not be positive definite (a fitted density may be negative somewhere), which
/// `L D L^T` does not mind as long as no pivot vanishes.
#[derive(Clone, Debug)]
pub struct Banded<T> {
    order: usize,
    half_band: usize,
    rows: Vec<T>,
}

impl<T: Scalar> Banded<T> {
    /// The zero matrix.
    pub fn zeros(order: usize, half_band: usize) -> Self {
        Self {
            order,
            half_band,
            rows: vec![T::zero(); order * (half_band + 1)],
        }
    }

    /// Number of stored entries.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Whether the matrix has order zero.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Half band width.
    pub fn half_band(&self) -> usize {
        self.half_band
    }

    /// The lower half's rows end to end, see [`banded_row`].
    pub(crate) fn rows_mut(&mut self) -> &mut [T] {
        &mut self.rows
    }

    /// Sets every entry to zero.
    pub fn clear(&mut self) {
        self.rows.fill(T::zero());
    }

    #[inline(always)]
    fn at(&self, i: usize, j: usize) -> usize {
        i * (self.half_band + 1) + j + self.half_band - i
    }

    /// Adds to the entry `(i, j)` of the lower half, `j <= i <= j + half_band`; entries of the upper half are
    /// left out, since they are the same.
    #[inline(always)]
    pub fn add(&mut self, i: usize, j: usize, value: T) {
        if j <= i {
            let at = self.at(i, j);
            self.rows[at] += value;
        }
    }

    /// The entry `(i, j)` of the lower half, `j <= i <= j + half_band`.
    pub fn get(&self, i: usize, j: usize) -> T {
        self.rows[self.at(i, j)]
    }

    /// Makes the matrix a copy of `other`.
    pub fn copy_from(&mut self, other: &Self) {
        self.order = other.order;
        self.half_band = other.half_band;
        self.rows.clone_from(&other.rows);
    }

    /// Moves the known part of unknown `c`, component `axis`, to the right-hand side of the other equations.
    pub fn move_known<const D: usize>(&self, c: usize, axis: usize, value: T, right: &mut [SVector<T, D>]) {
        for j in c.saturating_sub(self.half_band)..(c + self.half_band + 1).min(self.order) {
            right[j][axis] -= self.rows[self.at(c.max(j), c.min(j))] * value;
        }
    }

    /// Component `axis` of row `c` times `x`.
    pub(crate) fn row_product<const D: usize>(&self, c: usize, axis: usize, x: &[SVector<T, D>]) -> T {
        let columns = c.saturating_sub(self.half_band)..(c + self.half_band + 1).min(self.order);
        columns.fold(T::zero(), |sum, j| {
            sum + self.rows[self.at(c.max(j), c.min(j))] * x[j][axis]
        })
    }

    /// Prescribes component `axis` of unknown `c`: moves its known part to the right-hand side and replaces
    /// its equation by `x_c = value`.
    pub fn prescribe<const D: usize>(
        &mut self,
        c: usize,
        axis: usize,
        value: T,
        right: &mut [SVector<T, D>],
    ) {
        for j in c.saturating_sub(self.half_band)..(c + self.half_band + 1).min(self.order) {
            let at = self.at(c.max(j), c.min(j));
            if j == c {
                self.rows[at] = T::one();
                right[c][axis] = value;
            } else {
                right[j][axis] -= self.rows[at] * value;
                self.rows[at] = T::zero();
            }
        }
    }

    /// Lumps the rows of a matrix of masses whose diagonal holds less than the share `least` of their sum:
    /// what lies beside the diagonal goes to it, in the rows of both DOFs, so that all sums of rows stay.
    pub fn lump_weak(&mut self, least: T) {
        for i in 0..self.order {
            let band = i.saturating_sub(self.half_band)..(i + self.half_band + 1).min(self.order);
            let sum = band.fold(T::zero(), |sum, j| sum + self.rows[self.at(i.max(j), i.min(j))]);
            if self.rows[self.at(i, i)] < least * sum {
                self.lump(i);
            }
        }
    }

    /// Lumps the row of a DOF.
    pub(crate) fn lump(&mut self, i: usize) {
        let band = i.saturating_sub(self.half_band)..(i + self.half_band + 1).min(self.order);
        band.filter(|&j| j != i).for_each(|j| self.lump_entry(i, j));
    }

    fn lump_entry(&mut self, i: usize, j: usize) {
        let at = self.at(i.max(j), i.min(j));
        let entry = std::mem::replace(&mut self.rows[at], T::zero());
        for k in [i, j] {
            let diagonal = self.at(k, k);
            self.rows[diagonal] += entry;
        }
    }

    /// Sum of all entries of the symmetric matrix.
    pub fn total(&self) -> T {
        match self.half_band {
            1 => total::<T, 2>(&self.rows),
            2 => total::<T, 3>(&self.rows),
            3 => total::<T, 4>(&self.rows),
            half_band => {
                let rows = self.rows.chunks_exact(half_band + 1);
                rows.fold(T::zero(), |sum, row| {
                    let lower = row[..half_band].iter().fold(T::zero(), |s, &x| s + x);
                    sum + lower + lower + row[half_band]
                })
            }
        }
    }

    /// Factorises in place; the diagonal then holds the inverse pivots. A pivot that vanishes against the
    /// matrix's largest diagonal entry marks a DOF that no mass reaches: it is cut off, and [`Banded::solve`]
    /// returns zero for it.
    pub fn factorise(&mut self) {
        let negligible = self.negligible();
        match self.half_band {
            1 => narrow::factorise::<T, 2>(&mut self.rows, negligible),
            2 => narrow::factorise::<T, 3>(&mut self.rows, negligible),
            3 => narrow::factorise::<T, 4>(&mut self.rows, negligible),
            _ => self.factorise_wide(negligible),
        }
    }

    /// Factorises in place, from both ends at once where there are one to three bands beside the diagonal,
    /// and solves for component `axis`: two chains of inverse pivots that do not wait for each other, and
    /// that two threads share. See [`Banded::factorise`]; the factors are those that [`Banded::solve_again`]
    /// wants, and no other.
    pub fn factorise_and_solve<const D: usize>(&mut self, x: &mut [SVector<T, D>], axis: usize) {
        let (negligible, parallel) = (self.negligible(), many_threads());
        let rows = &mut self.rows;
        match self.half_band {
            1 => both_ends::factorise_and_solve::<T, D, 2>(rows, negligible, x, axis, parallel),
            2 => both_ends::factorise_and_solve::<T, D, 3>(rows, negligible, x, axis, parallel),
            3 => both_ends::factorise_and_solve::<T, D, 4>(rows, negligible, x, axis, parallel),
            _ => {
                self.factorise_wide(negligible);
                self.solve_wide(x, axis);
            }
        }
    }

    /// Solves for component `axis` with the factors that [`Banded::factorise_and_solve`] left.
    pub fn solve_again<const D: usize>(&self, x: &mut [SVector<T, D>], axis: usize) {
        let parallel = many_threads();
        match self.half_band {
            1 => both_ends::solve::<T, D, 2>(&self.rows, x, axis, parallel),
            2 => both_ends::solve::<T, D, 3>(&self.rows, x, axis, parallel),
            3 => both_ends::solve::<T, D, 4>(&self.rows, x, axis, parallel),
            _ => self.solve_wide(x, axis),
        }
    }

    /// What vanishes against the largest diagonal entry.
    fn negligible(&self) -> T {
        let largest = match self.half_band {
            1 => largest_diagonal::<T, 2>(&self.rows),
            2 => largest_diagonal::<T, 3>(&self.rows),
            3 => largest_diagonal::<T, 4>(&self.rows),
            half_band => {
                let rows = self.rows.chunks_exact(half_band + 1);
                rows.fold(T::zero(), |m, row| m.max(row[half_band].abs()))
            }
        };
        largest * T::default_epsilon() * T::default_epsilon()
    }

    fn factorise_wide(&mut self, negligible: T) {
        for i in 0..self.order {
            let first = i.saturating_sub(self.half_band);
            // Row i of L D until its pivots are known.
            for j in first..i {
                let low = first.max(j.saturating_sub(self.half_band));
                let mut sum = self.rows[self.at(i, j)];
                for k in low..j {
                    sum -= self.rows[self.at(i, k)] * self.rows[self.at(j, k)];
                }
                let at = self.at(i, j);
                self.rows[at] = sum;
            }
            let mut pivot = self.rows[self.at(i, i)];
            for j in first..i {
                let at = self.at(i, j);
                // A cut-off DOF has an inverse pivot of zero and passes nothing on.
                let entry = self.rows[at] * self.rows[self.at(j, j)];
                pivot -= self.rows[at] * entry;
                self.rows[at] = entry;
            }
            let at = self.at(i, i);
            self.rows[at] = inverse(pivot, negligible);
        }
    }

    /// Solves for component `axis` with the factorised matrix.
    pub fn solve<const D: usize>(&self, x: &mut [SVector<T, D>], axis: usize) {
        match self.half_band {
            1 => narrow::solve::<T, D, 2>(&self.rows, x, axis),
            2 => narrow::solve::<T, D, 3>(&self.rows, x, axis),
            3 => narrow::solve::<T, D, 4>(&self.rows, x, axis),
            _ => self.solve_wide(x, axis),
        }
    }

    fn solve_wide<const D: usize>(&self, x: &mut [SVector<T, D>], axis: usize) {
        let order = self.order.min(x.len());
        for i in 0..order {
            for j in i.saturating_sub(self.half_band)..i {
                let below = x[j][axis] * self.rows[self.at(i, j)];
                x[i][axis] -= below;
            }
        }
        for i in (0..order).rev() {
            x[i][axis] *= self.rows[self.at(i, i)];
            for k in i + 1..(i + self.half_band + 1).min(order) {
                let above = x[k][axis] * self.rows[self.at(k, i)];
                x[i][axis] -= above;
            }
        }
    }

    /// Solves with the factorised matrix for all right-hand sides in `x`. What belongs to an unknown is a row
    /// of `stride` numbers, and so many rows as there are unknowns lie end to end again and again.
    pub(crate) fn solve_lines(&self, x: &mut [T], stride: usize) {
        with_features(
            #[inline(always)]
            move || self.solve_lines_here(x, stride),
        );
    }

    #[inline(always)]
    fn solve_lines_here(&self, x: &mut [T], stride: usize) {
        match (stride, self.half_band) {
            (1, 1) => self.solve_narrow_lines::<2>(x),
            (1, 2) => self.solve_narrow_lines::<3>(x),
            (1, 3) => self.solve_narrow_lines::<4>(x),
            _ => {
                for lines in x.chunks_exact_mut((stride * self.order).max(1)) {
                    self.solve_wide_lines(lines, stride);
                }
            }
        }
    }

    #[inline(always)]
    fn solve_narrow_lines<const W: usize>(&self, x: &mut [T]) {
        let mut several = x.chunks_exact_mut((narrow::ABREAST * self.order).max(1));
        for lines in several.by_ref() {
            narrow::solve_abreast::<T, W>(&self.rows, lines);
        }
        for line in several.into_remainder().chunks_exact_mut(self.order.max(1)) {
            narrow::solve_line::<T, W>(&self.rows, line);
        }
    }

    #[inline(always)]
    fn solve_wide_lines(&self, x: &mut [T], stride: usize) {
        for i in 0..self.order {
            let (before, here) = x.split_at_mut(i * stride);
            for j in i.saturating_sub(self.half_band)..i {
                take(here, self.get(i, j), &before[j * stride..(j + 1) * stride]);
            }
        }
        for i in (0..self.order).rev() {
            let (here, after) = x.split_at_mut((i + 1) * stride);
            let here = &mut here[i * stride..];
            let inverse_pivot = self.get(i, i);
            here.iter_mut().for_each(|x| *x *= inverse_pivot);
            for k in i + 1..(i + self.half_band + 1).min(self.order) {
                let first = (k - i - 1) * stride;
                take(here, self.get(k, i), &after[first..first + stride]);
            }
        }
    }

    /// Product with `x` of the matrix before it is factorised.
    pub fn multiply<const D: usize>(&self, x: &[SVector<T, D>]) -> Vec<SVector<T, D>> {
        let mut y = vec![SVector::zeros(); self.order];
        self.add_product(x, &mut y);
        y
    }

    /// `y = M x` of one component, before the matrix is factorised.
    pub(crate) fn multiply_column(&self, x: &[T], y: &mut [T]) {
        y.fill(T::zero());
        for i in 0..self.order.min(x.len()).min(y.len()) {
            for j in i.saturating_sub(self.half_band)..=i {
                let entry = self.rows[self.at(i, j)];
                y[i] += x[j] * entry;
                if j < i {
                    y[j] += x[i] * entry;
                }
            }
        }
    }

    /// Adds to `y` the product with `x` of the matrix before it is factorised.
    pub fn add_product<const D: usize>(&self, x: &[SVector<T, D>], y: &mut [SVector<T, D>]) {
        for i in 0..self.order.min(x.len()).min(y.len()) {
            for j in i.saturating_sub(self.half_band)..=i {
                let entry = self.rows[self.at(i, j)];
                y[i] += x[j] * entry;
                if j < i {
                    y[j] += x[i] * entry;
                }
            }
        }
    }
}

/// Sum of all entries, the columns of the band side by side: one chain of additions would wait for itself.
fn total<T: Scalar, const W: usize>(rows: &[T]) -> T {
    let (rows, _) = rows.as_chunks::<W>();
    let mut sums = [T::zero(); W];
    for row in rows {
        for k in 0..W {
            sums[k] += row[k];
        }
    }
    let lower = sums[..W - 1].iter().fold(T::zero(), |s, &x| s + x);
    lower + lower + sums[W - 1]
}

/// Largest size of a diagonal entry, four of them side by side.
fn largest_diagonal<T: Scalar, const W: usize>(rows: &[T]) -> T {
    let (rows, _) = rows.as_chunks::<W>();
    let (fours, rest) = rows.as_chunks::<4>();
    let mut largest = [T::zero(); 4];
    for four in fours {
        for k in 0..4 {
            largest[k] = largest[k].max(four[k][W - 1].abs());
        }
    }
    let all = largest.into_iter().chain(rest.iter().map(|row| row[W - 1].abs()));
    all.fold(T::zero(), T::max)
}

/// `y -= a x` for as many numbers as `x` has.
#[inline(always)]
fn take<T: Scalar>(y: &mut [T], a: T, x: &[T]) {
    for (y, &x) in y.iter_mut().zip(x) {
        *y -= a * x;
    }
}

/// One over a pivot, zero where it vanishes.
#[inline(always)]
fn inverse<T: Scalar>(pivot: T, negligible: T) -> T {
    if pivot.abs() <= negligible {
        T::zero()
    } else {
        T::one() / pivot
    }
}

/// Row `i` of a lower half stored by rows; the entry `(i, j)` is at `half_band + j - i`.
#[inline(always)]
pub(crate) fn banded_row<T>(rows: &mut [T], i: usize, half_band: usize) -> &mut [T] {
    &mut rows[i * (half_band + 1)..(i + 1) * (half_band + 1)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use nalgebra::{DMatrix, vector};

    fn sample(n: usize, w: usize) -> (Banded<f64>, DMatrix<f64>) {
        let mut banded = Banded::zeros(n, w);
        let mut dense = DMatrix::zeros(n, n);
        for i in 0..n {
            for j in i.saturating_sub(w)..=i {
                let entry = if i == j {
                    4.0 + i as f64
                } else {
                    ((i * 7 + j * 3) % 5) as f64 - 2.0
                };
                banded.add(i, j, entry);
                dense[(i, j)] = entry;
                dense[(j, i)] = entry;
            }
        }
        (banded, dense)
    }

    #[test]
    fn lines_abreast_are_solved_to_the_bit_as_one_alone() {
        for w in 1..=3 {
            let (mut banded, _) = sample(11, w);
            banded.factorise();
            let lines: Vec<f64> = (0..11 * 21).map(|i| (i * i % 17) as f64 - 8.0).collect();
            let mut abreast = lines.clone();
            banded.solve_lines(&mut abreast, 1);
            for (line, found) in lines.chunks(11).zip(abreast.chunks(11)) {
                let mut x: Vec<_> = line.iter().map(|&x| vector![x]).collect();
                banded.solve(&mut x, 0);
                let alone: Vec<f64> = x.iter().map(|x| x[0]).collect();
                assert_eq!(found, alone);
            }
        }
    }

    #[test]
    fn from_both_ends_it_solves_the_same() {
        for w in 1..=4 {
            for n in 1..30 {
                let (mut one_way, _) = sample(n, w.min(n - 1));
                let mut both_ways = one_way.clone();
                let right: Vec<_> = (0..n).map(|i| vector![1.0, (i * i % 17) as f64 - 8.0]).collect();
                let (mut x, mut y, mut again) = (right.clone(), right.clone(), right);
                one_way.factorise();
                one_way.solve(&mut x, 1);
                both_ways.factorise_and_solve(&mut y, 1);
                both_ways.solve_again(&mut again, 1);
                assert_eq!(y, again);
                for (x, y) in x.iter().zip(&y) {
                    assert_relative_eq!(x[1], y[1], epsilon = 1e-12, max_relative = 1e-12);
                    assert_eq!(y[0], 1.0);
                }
            }
        }
    }

    fn two_threads_do_what_one_does<const W: usize>() {
        let n = 20_001;
        let entry = |k: usize| {
            if k % W == W - 1 {
                5.0
            } else {
                (k * k % 5) as f64 / 3.0 - 0.7
            }
        };
        let rows: Vec<f64> = (0..n * W).map(entry).collect();
        let right: Vec<_> = (0..n).map(|i| vector![(i * i % 17) as f64 - 8.0]).collect();
        let found = [false, true].map(|parallel| {
            let (mut rows, mut x, mut again) = (rows.clone(), right.clone(), right.clone());
            both_ends::factorise_and_solve::<f64, 1, W>(&mut rows, 0.0, &mut x, 0, parallel);
            both_ends::solve::<f64, 1, W>(&rows, &mut again, 0, parallel);
            assert_eq!(x, again);
            (rows, x)
        });
        assert_eq!(found[0], found[1]);
    }

    #[test]
    fn two_threads_factorise_and_solve_to_the_bit_as_one_alone() {
        two_threads_do_what_one_does::<2>();
        two_threads_do_what_one_does::<3>();
        two_threads_do_what_one_does::<4>();
    }

    #[test]
    fn it_solves_what_a_dense_factorisation_solves() {
        for (n, w) in [(1, 0), (5, 1), (9, 3), (4, 3)] {
            let (mut banded, dense) = sample(n, w);
            let right: Vec<_> = (0..n).map(|i| vector![i as f64 - 1.0, 2.0]).collect();
            assert_relative_eq!(banded.total(), dense.sum(), max_relative = 1e-13);
            let mut x = right.clone();
            banded.factorise();
            banded.solve(&mut x, 0);
            banded.solve(&mut x, 1);
            for c in 0..2 {
                let b = nalgebra::DVector::from_fn(n, |i, _| right[i][c]);
                let exact = dense.clone().lu().solve(&b).unwrap();
                for i in 0..n {
                    assert_relative_eq!(x[i][c], exact[i], epsilon = 1e-12);
                }
            }
        }
    }

    #[test]
    fn a_dof_without_mass_is_cut_off_and_the_rest_is_solved() {
        let (_, dense) = sample(6, 2);
        for massless in 0..6 {
            let mut cut = Banded::zeros(6, 2);
            for i in 0..6_usize {
                for j in i.saturating_sub(2)..=i {
                    if i != massless && j != massless {
                        cut.add(i, j, dense[(i, j)]);
                    }
                }
            }
            let right = std::array::from_fn::<_, 6, _>(|i| vector![f64::from(i != massless)]);
            let (unfactorised, mut other) = (cut.clone(), cut.clone());
            let (mut x, mut y) = (right, right);
            cut.factorise();
            cut.solve(&mut x, 0);
            other.factorise_and_solve(&mut y, 0);
            for x in [x, y] {
                assert_eq!(x[massless][0], 0.0);
                for (a, b) in unfactorised.multiply(&x).iter().zip(&right) {
                    assert!((a - b).norm() < 1e-13);
                }
            }
        }
    }
}
