//! Symmetric matrices of DOFs on a lattice.

use crate::parallel::{each_span, many_threads};
use crate::scalar::Scalar;
use crate::simd::with_features;

/// Rows whose products are summed side by side: their sums stay in the nearest cache.
const BLOCK: usize = 128;
/// Rows in a span that threads share.
const SPAN: usize = 32 * BLOCK;
/// Fewest entries of which another thread is given rows: so many take a thread a tenth of a millisecond and
/// more. Of fewer, sharing brought nothing, and other threads had to be woken for each of the many products
/// of a solution.
const MANY: usize = 1 << 20;

/// A symmetric matrix of order `n` whose entry `(i, j)` may differ from zero only if the DOFs `i` and `j` of
/// a lattice are neighbours within a given reach along every axis. The lower half is stored diagonal by
/// diagonal: of 25 diagonals in the plane (reach 2) 13, whatever the lattice's size, where a band would hold
/// rows of the lattice between them.
#[derive(Clone, Debug)]
pub struct Lattice<T> {
    order: usize,
    /// Differences of the numbers of two neighbours, ascending from zero.
    offsets: Vec<usize>,
    /// Place of each difference among them, [`NONE`] for others.
    places: Vec<u16>,
    /// The entry `(i, i - offsets[k])` at `k * order + i`.
    entries: Vec<T>,
}

const NONE: u16 = u16::MAX;

impl<T: Scalar> Lattice<T> {
    /// The zero matrix for a lattice with `shape` DOFs along its axes, axis 0 fastest.
    #[inline(never)]
    pub fn zeros<const D: usize>(shape: [usize; D], reach: usize) -> Self {
        let offsets = offsets(shape, reach);
        let order = shape.iter().product();
        let mut places = vec![NONE; offsets.last().map_or(0, |&last| last + 1)];
        for (k, &offset) in offsets.iter().enumerate() {
            places[offset] = k as u16;
        }
        Self {
            entries: vec![T::zero(); order * offsets.len()],
            order,
            offsets,
            places,
        }
    }

    /// One that holds nothing.
    pub fn none() -> Self {
        Self {
            order: 0,
            offsets: Vec::new(),
            places: Vec::new(),
            entries: Vec::new(),
        }
    }

    /// Order of the matrix.
    pub fn order(&self) -> usize {
        self.order
    }

    /// Bytes allocated.
    pub fn bytes(&self) -> usize {
        size_of::<T>() * self.entries.capacity()
            + size_of::<usize>() * self.offsets.capacity()
            + size_of::<u16>() * self.places.capacity()
    }

    /// Sets every entry to zero.
    pub fn clear(&mut self) {
        self.entries.fill(T::zero());
    }

    /// Adds to the entry `(i, j)`, `j <= i`, and so to `(j, i)`. What DOFs that are no neighbours have in
    /// common is zero and left out.
    #[inline(always)]
    pub fn add(&mut self, i: usize, j: usize, value: T) {
        if let Some(&place) = self.places.get(i - j)
            && place != NONE
        {
            self.entries[usize::from(place) * self.order + i] += value;
        }
    }

    /// The entries `(i, i)`.
    pub fn diagonal(&self) -> &[T] {
        &self.entries[..self.order.min(self.entries.len())]
    }

    /// `y = M x`.
    pub fn multiply(&self, x: &[T], y: &mut [T]) {
        let parallel = self.entries.len() >= MANY && many_threads();
        each_span(parallel, SPAN, y, &|first, y| {
            with_features(
                #[inline(always)]
                move || {
                    for (k, y) in y.chunks_mut(BLOCK).enumerate() {
                        self.multiply_block(first + k * BLOCK, x, y);
                    }
                },
            );
        });
    }

    /// The rows from `first` on, as many as `y` has.
    #[inline(always)]
    fn multiply_block(&self, first: usize, x: &[T], y: &mut [T]) {
        y.fill(T::zero());
        let end = first + y.len();
        for (&offset, entries) in self.offsets.iter().zip(self.entries.chunks_exact(self.order)) {
            let low = first.max(offset);
            if low < end {
                add_products(
                    &mut y[low - first..],
                    &entries[low..end],
                    &x[low - offset..end - offset],
                );
            }
            let high = end.min(self.order - offset);
            if offset > 0 && first < high {
                let above = first + offset..high + offset;
                add_products(&mut y[..high - first], &entries[above.clone()], &x[above]);
            }
        }
    }

    /// Sums of the rows.
    pub fn row_sums(&self, sums: &mut [T]) {
        sums.fill(T::zero());
        for (&offset, entries) in self.offsets.iter().zip(self.entries.chunks_exact(self.order)) {
            for i in offset..self.order {
                sums[i] += entries[i];
                if offset > 0 {
                    sums[i - offset] += entries[i];
                }
            }
        }
    }

    /// Lumps the row of a DOF in a matrix of masses: what lies beside the diagonal goes to it, in the rows of
    /// both DOFs, so that all sums of rows stay.
    pub fn lump(&mut self, i: usize) {
        for k in 1..self.offsets.len() {
            let offset = self.offsets[k];
            if i >= offset {
                self.lump_entry(k, i);
            }
            if i + offset < self.order {
                self.lump_entry(k, i + offset);
            }
        }
    }

    fn lump_entry(&mut self, k: usize, i: usize) {
        let entry = std::mem::replace(&mut self.entries[k * self.order + i], T::zero());
        self.entries[i] += entry;
        self.entries[i - self.offsets[k]] += entry;
    }
}

/// `y += a x`, number by number.
#[inline(always)]
fn add_products<T: Scalar>(y: &mut [T], a: &[T], x: &[T]) {
    for ((y, &a), &x) in y.iter_mut().zip(a).zip(x) {
        *y += a * x;
    }
}

/// Differences of the numbers of DOFs that are at most `reach` apart along each axis, those that are not
/// negative.
fn offsets<const D: usize>(shape: [usize; D], reach: usize) -> Vec<usize> {
    let mut all = vec![0_isize];
    let mut stride = 1;
    for count in shape {
        let steps = reach.min(count.saturating_sub(1)) as isize;
        let before = std::mem::take(&mut all);
        for step in -steps..=steps {
            all.extend(before.iter().map(|offset| offset + step * stride));
        }
        stride *= count as isize;
    }
    let mut offsets: Vec<usize> = all.into_iter().filter_map(|d| usize::try_from(d).ok()).collect();
    offsets.sort_unstable();
    offsets.dedup();
    offsets
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use nalgebra::{DMatrix, DVector};

    /// Whether two DOFs of the lattice are neighbours.
    fn near<const D: usize>(shape: [usize; D], reach: usize, mut i: usize, mut j: usize) -> bool {
        shape.into_iter().all(|count| {
            let apart = (i % count).abs_diff(j % count);
            (i, j) = (i / count, j / count);
            apart <= reach
        })
    }

    fn sample<const D: usize>(shape: [usize; D], reach: usize) -> (Lattice<f64>, DMatrix<f64>) {
        let mut lattice = Lattice::zeros(shape, reach);
        let n = lattice.order();
        let mut dense = DMatrix::zeros(n, n);
        for i in 0..n {
            for j in (0..=i).filter(|&j| near(shape, reach, i, j)) {
                let entry = 1.0 + ((i * 7 + j * 3) % 5) as f64;
                lattice.add(i, j, entry);
                dense[(i, j)] = entry;
                dense[(j, i)] = entry;
            }
        }
        (lattice, dense)
    }

    fn check<const D: usize>(shape: [usize; D], reach: usize) {
        let (mut lattice, dense) = sample(shape, reach);
        let n = lattice.order();
        let x: Vec<f64> = (0..n).map(|i| (i * i % 11) as f64 - 4.0).collect();
        let (mut y, mut sums) = (vec![0.0; n], vec![0.0; n]);
        lattice.multiply(&x, &mut y);
        lattice.row_sums(&mut sums);
        let product = &dense * DVector::from_column_slice(&x);
        for i in 0..n {
            assert_relative_eq!(y[i], product[i], epsilon = 1e-12);
            assert_relative_eq!(sums[i], dense.row(i).sum(), epsilon = 1e-12);
            assert_eq!(lattice.diagonal()[i], dense[(i, i)]);
        }
        let before = sums.clone();
        lattice.lump(n - 1);
        lattice.row_sums(&mut sums);
        assert!(lattice.diagonal()[n - 1] > 0.0);
        let x: Vec<f64> = (0..n).map(|i| f64::from(u8::from(i + 1 == n))).collect();
        lattice.multiply(&x, &mut y);
        assert_eq!(
            y.iter().filter(|&&y| y != 0.0).count(),
            1,
            "nothing beside the diagonal"
        );
        for i in 0..n {
            assert_relative_eq!(sums[i], before[i], epsilon = 1e-12);
        }
    }

    #[test]
    fn it_is_the_matrix_it_stands_for_on_lattices_of_every_shape() {
        check([7], 2);
        check([300, 2], 1);
        check([6, 5], 2);
        check([3, 4], 3);
        check([4, 5, 3], 1);
        check([5, 4, 6], 2);
        check([1, 1], 2);
    }

    #[test]
    fn in_the_plane_thirteen_diagonals_hold_a_reach_of_two() {
        assert_eq!(Lattice::<f64>::zeros([100, 50], 2).offsets.len(), 13);
        assert_eq!(Lattice::<f64>::zeros([30, 20, 10], 2).offsets.len(), 63);
    }

    #[cfg(feature = "rayon")]
    #[test]
    fn threads_multiply_right_and_to_the_bit_as_one_alone() {
        let mut lattice = Lattice::<f64>::zeros([400, 210], 2);
        assert!(lattice.entries.len() >= MANY && lattice.order() > 2 * SPAN);
        for (k, entry) in lattice.entries.iter_mut().enumerate() {
            *entry = 1.0 / (1 + k % 97) as f64;
        }
        let x: Vec<f64> = (0..lattice.order()).map(|i| (i as f64).sin()).collect();
        let product = |threads| {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .unwrap();
            let mut y = vec![0.0; x.len()];
            pool.install(|| lattice.multiply(&x, &mut y));
            y
        };
        let alone = product(1);
        for (i, &y) in alone.iter().enumerate() {
            let mut expected = 0.0;
            for (entries, &offset) in lattice.entries.chunks(x.len()).zip(&lattice.offsets) {
                if i >= offset {
                    expected += entries[i] * x[i - offset];
                }
                if offset > 0 && i + offset < x.len() {
                    expected += entries[i + offset] * x[i + offset];
                }
            }
            assert!((y - expected).abs() < 1e-12, "row {i}: {y} {expected}");
        }
        for threads in [2, 3] {
            assert!(product(threads) == alone);
        }
    }
}
