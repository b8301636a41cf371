//! Least squares in the Taylor functions of one cell.
//!
//! The fit is kept as a triangular matrix `C` that turns the Taylor functions into functions orthonormal on
//! the cell's particles, `pi = C psi`. Then the coefficients of any field are `C^T sum_p pi(x_p) q_p`: one
//! geometry serves stress, density and momentum. Where the points are well spread, `C` comes from the Gram
//! matrix (a few sums per particle). Where they are not, squaring the condition number would cost the
//! digits that are left (and a Cholesky factorisation of a singular matrix may well succeed with garbage),
//! so there `C` comes from Givens rotations, one particle at a time. A function is dropped where the points hardly see it:
//! where what is left of it after the functions before it, in root mean square over the points, is less than a share of
//! its root mean square over the cell.
//!
//! Round-off of the coefficients still counts the condition number of `C` twice, which the share bounds: harmless with the
//! default of 2 %, not with a share near the machine epsilon.

use nalgebra::{SMatrix, SVector};

use super::basis::taylor_sizes;
use super::taylor_functions;
use crate::field::Field;
use crate::scalar::Scalar;

/// Default of [`CellFit::new`]'s `tolerance`: 2 %. Much smaller ones let particles that lie close together, or all near a
/// zero of a function, decide a slope of the whole cell, so that the noise of their values swamps the fit; 10 % and more
/// smooth what the particles do resolve.
pub const DEFAULT_TOLERANCE: f64 = 0.02;

/// Share of a function's square sum that must be independent for the Gram matrix to be trusted.
const GRAM_SHARE: f64 = 1e-2;

/// Least-squares fit of fields in one cell, prepared for a set of points.
#[derive(Clone, Copy, Debug)]
pub struct CellFit<T, const NB: usize> {
    orthonormal: SMatrix<T, NB, NB>,
    functions: usize,
}

impl<T: Scalar, const NB: usize> CellFit<T, NB> {
    /// Prepares the fit on the points with local coordinates `points`, a sequence that can be run through
    /// repeatedly.
    ///
    /// `first` is 0 for the free fit and 1 where the mean is given. At most as many functions as points are used, and
    /// none of which less than the share `tolerance` is left on the points ([`DEFAULT_TOLERANCE`]).
    pub fn new<const D: usize>(
        points: impl Iterator<Item = SVector<T, D>> + Clone,
        first: usize,
        tolerance: T,
    ) -> Self {
        Self::weighted(points.map(|s| (s, T::one())), first, tolerance)
    }

    /// The same for weighted least squares: `points` come with positive weights, and so must the samples of
    /// [`CellFit::coefficients`].
    pub fn weighted<const D: usize>(
        points: impl Iterator<Item = (SVector<T, D>, T)> + Clone,
        first: usize,
        tolerance: T,
    ) -> Self {
        let (count, total) = points
            .clone()
            .fold((0, T::zero()), |(count, total), (_, weight)| {
                (count + 1, total + weight)
            });
        let rows = points.map(|(s, weight)| taylor_functions::<T, D, NB>(&s) * weight.sqrt());
        let end = NB.min(count);
        let mut wanted = [false; NB];
        wanted[first.min(end)..end].fill(true);
        let least = taylor_sizes::<T, D, NB>() * (tolerance * total.sqrt());
        Self::from_gram(rows.clone(), &wanted, &least)
            .unwrap_or_else(|| Self::from_rotations(rows, wanted, &least))
    }

    /// Cholesky factorisation of the Gram matrix; `None` where it loses too many digits or leaves too little of a
    /// function.
    fn from_gram(
        rows: impl Iterator<Item = SVector<T, NB>>,
        wanted: &[bool; NB],
        least: &SVector<T, NB>,
    ) -> Option<Self> {
        let mut gram = SMatrix::<T, NB, NB>::zeros();
        for psi in rows {
            for i in 0..NB {
                for j in 0..=i {
                    gram[(i, j)] += psi[i] * psi[j];
                }
            }
        }
        let mut r = SMatrix::<T, NB, NB>::zeros();
        for k in (0..NB).filter(|&k| wanted[k]) {
            let mut left = gram[(k, k)];
            for j in (0..k).filter(|&j| wanted[j]) {
                let dot = (0..j).fold(gram[(k, j)], |sum, i| sum - r[(i, j)] * r[(i, k)]);
                r[(j, k)] = dot / r[(j, j)];
                left -= r[(j, k)] * r[(j, k)];
            }
            if left <= gram[(k, k)] * T::lit(GRAM_SHARE) || left <= least[k] * least[k] {
                return None;
            }
            r[(k, k)] = left.sqrt();
        }
        Some(Self::from_factor(&r, wanted))
    }

    /// QR factorisation by Givens rotations, again without each function of which too little is left.
    fn from_rotations(
        rows: impl Iterator<Item = SVector<T, NB>> + Clone,
        mut wanted: [bool; NB],
        least: &SVector<T, NB>,
    ) -> Self {
        loop {
            let r = rotate(rows.clone(), &wanted);
            match (0..NB).find(|&k| wanted[k] && r[(k, k)].abs() <= least[k]) {
                Some(k) => wanted[k] = false,
                None => return Self::from_factor(&r, &wanted),
            }
        }
    }

    /// `C = R^-T`, row by row: `pi_k = (psi_k - sum_j r_jk pi_j) / r_kk`.
    fn from_factor(r: &SMatrix<T, NB, NB>, wanted: &[bool; NB]) -> Self {
        let mut c = SMatrix::<T, NB, NB>::zeros();
        for k in (0..NB).filter(|&k| wanted[k]) {
            let mut row = SMatrix::<T, 1, NB>::zeros();
            row[k] = T::one();
            for j in (0..k).filter(|&j| wanted[j]) {
                row -= c.row(j) * r[(j, k)];
            }
            c.set_row(k, &(row / r[(k, k)]));
        }
        Self {
            orthonormal: c,
            functions: wanted.iter().filter(|&&w| w).count(),
        }
    }

    /// Number of functions in the fit; a given mean is not counted.
    pub fn functions(&self) -> usize {
        self.functions
    }

    /// Coefficients of the field with the given `samples` (local coordinates, weight and value at the same points as
    /// at the preparation; weight 1 unless it was weighted), less `mean`. The mean itself is *not* added to the first coefficient.
    #[inline(always)]
    pub fn coefficients<const D: usize, Q: Field<T>>(
        &self,
        samples: impl Iterator<Item = (SVector<T, D>, T, Q)>,
        mean: Q,
    ) -> [Q; NB] {
        let mut moments = [Q::zero(); NB];
        for (s, weight, value) in samples {
            let psi = taylor_functions::<T, D, NB>(&s);
            let mut rest = value;
            rest.add_scaled(-T::one(), mean);
            for k in 0..NB {
                let pi = (0..=k).fold(T::zero(), |sum, j| sum + self.orthonormal[(k, j)] * psi[j]);
                moments[k].add_scaled(weight * pi, rest);
            }
        }
        std::array::from_fn(|j| {
            let mut coefficient = Q::zero();
            for k in j..NB {
                coefficient.add_scaled(self.orthonormal[(k, j)], moments[k]);
            }
            coefficient
        })
    }
}

/// Upper triangular factor of the matrix with the given rows, `wanted` columns only (the others stay zero).
fn rotate<T: Scalar, const NB: usize>(
    rows: impl Iterator<Item = SVector<T, NB>>,
    wanted: &[bool; NB],
) -> SMatrix<T, NB, NB> {
    let mut r = SMatrix::<T, NB, NB>::zeros();
    for mut row in rows {
        for k in (0..NB).filter(|&k| wanted[k]) {
            if row[k] == T::zero() {
                continue;
            }
            let length = r[(k, k)].hypot(row[k]);
            let (cos, sin) = (r[(k, k)] / length, row[k] / length);
            for j in k..NB {
                let (above, below) = (r[(k, j)], row[j]);
                r[(k, j)] = cos * above + sin * below;
                row[j] = cos * below - sin * above;
            }
        }
    }
    r
}
