//! The weighted fit of one patch.

use crate::scalar::Scalar;

/// Smallest part of what a full patch leaves of a function, besides those before it, for the function to be
/// kept.
const LEAST: f64 = 0.09;

/// Sums of products of the functions of a patch, the lower half of a symmetric matrix; once factorised $L$
/// and $D$ of $L D L^T$, without functions that the particles do not tell apart from those before them.
#[derive(Clone, Copy, Debug)]
pub(super) struct PatchFit<T, const NB: usize> {
    rows: [[T; NB]; NB],
    kept: [bool; NB],
}

impl<T: Scalar, const NB: usize> PatchFit<T, NB> {
    pub(super) fn zero() -> Self {
        Self {
            rows: [[T::zero(); NB]; NB],
            kept: [false; NB],
        }
    }

    /// Adds a point.
    #[inline(always)]
    pub(super) fn add(&mut self, weight: T, psi: &[T; NB]) {
        for i in 0..NB {
            let scaled = weight * psi[i];
            for j in 0..=i {
                self.rows[i][j] += scaled * psi[j];
            }
        }
    }

    /// Sum of the weights.
    #[inline(always)]
    pub(super) fn total(&self) -> T {
        self.rows[0][0]
    }

    /// Whether the first `functions` are kept.
    pub(super) fn keeps(&self, functions: usize) -> bool {
        self.kept.iter().take(functions).all(|&kept| kept)
    }

    /// Factorises in place, without the functions of which less is left than [`LEAST`] of `full`, the pivots
    /// of a full patch over the sum of its weights.
    pub(super) fn factorise(&mut self, full: &[T; NB]) {
        let total = self.total();
        for i in 0..NB {
            let pivot = self.eliminate(i);
            self.kept[i] = pivot > full[i] * total * T::lit(LEAST);
            self.rows[i][i] = pivot;
        }
    }

    /// The pivots over the sum of the weights, where all functions are kept.
    pub(super) fn pivots(mut self) -> [T; NB] {
        let (total, mut pivots) = (self.total(), [T::zero(); NB]);
        for i in 0..NB {
            self.rows[i][i] = self.eliminate(i);
            self.kept[i] = true;
            pivots[i] = self.rows[i][i] / total;
        }
        pivots
    }

    /// Makes row `i` one of $L$ up to its diagonal; returns the pivot.
    fn eliminate(&mut self, i: usize) -> T {
        for j in 0..i {
            let mut sum = self.rows[i][j];
            for k in 0..j {
                sum -= self.rows[i][k] * self.rows[j][k] * self.rows[k][k];
            }
            self.rows[i][j] = match self.kept[j] {
                true => sum / self.rows[j][j],
                false => T::zero(),
            };
        }
        (0..i).fold(self.rows[i][i], |pivot, k| {
            pivot - self.rows[i][k] * self.rows[i][k] * self.rows[k][k]
        })
    }

    /// Replaces sums of the functions times a component by its coefficients.
    pub(super) fn solve(&self, sums: &mut [T; NB]) {
        for i in 0..NB {
            for k in 0..i {
                let known = sums[k];
                sums[i] -= self.rows[i][k] * known;
            }
        }
        for i in 0..NB {
            sums[i] = match self.kept[i] {
                true => sums[i] / self.rows[i][i],
                false => T::zero(),
            };
        }
        for i in (0..NB).rev() {
            for k in i + 1..NB {
                let known = sums[k];
                sums[i] -= self.rows[k][i] * known;
            }
        }
    }
}
