//! Least squares in the Taylor functions of one cell.
//!
//! The fit is kept as a unit triangular matrix `U` that turns the Taylor functions into functions orthogonal
//! on the cell's particles, `pi = U psi`, and their inverse squares `1/d_k`, `d_k = sum_p pi_k(x_p)^2`. Then
//! the coefficients of any field are `U^T D^-1 sum_p pi(x_p) q_p`: one geometry serves stress, density and
//! momentum.
//!
//! Where the points are well spread, `U` comes from the Gram matrix (a few sums per particle), and the sums
//! may be taken of `psi q` and turned once per cell. Where they are not, squaring the condition number would
//! cost the digits that are left (and a Cholesky factorisation of a singular matrix may well succeed with
//! garbage), so there `U` comes from Givens rotations, one particle at a time, and the sums are of `pi q`. A
//! function is dropped where the points hardly see it: where what is left of it after the functions before
//! it, in root mean square over the points, is less than a share of its root mean square over the cell.
//!
//! There each function is fitted to what those before it left, so that round-off of the coefficients counts
//! the condition number of `U` once. The share bounds it.

use std::ops::Range;

use nalgebra::{SMatrix, SVector};

use super::basis::taylor_sizes;
use super::{shift_sums, taylor_functions};
use crate::field::Field;
use crate::scalar::Scalar;

/// Tolerance of a fit along one axis: 2 %. Much smaller ones let particles that lie close together, or all
/// near a zero of a function, decide a slope of the whole cell, so that the noise of their values swamps the
/// fit; 10 % and more smooth what the particles do resolve.
pub const DEFAULT_TOLERANCE: f64 = 0.02;

/// Tolerance in two and three dimensions: 30 %. There six or ten functions share about as many particles, and
/// irregular ones leave little of the last functions. On the manufactured waves of
/// `docs/verification/space.md` tolerances from 2 % to 40 % give the same errors where nine particles a cell
/// lie on a lattice; where they are jittered, errors grow under refinement with 2 %, and fall with 20 % and
/// more. Above 41 % the field of `tests/identities/anchors.rs` loses its mixed function.
pub const DEFAULT_TOLERANCE_IN_SPACE: f64 = 0.3;

/// The default tolerance in so many dimensions.
pub fn default_tolerance<T: Scalar>(dimensions: usize) -> T {
    T::lit(match dimensions {
        1 => DEFAULT_TOLERANCE,
        _ => DEFAULT_TOLERANCE_IN_SPACE,
    })
}

/// Share of a function's square sum that must be independent for the Gram matrix to be trusted.
pub(super) const GRAM_SHARE: f64 = 1e-2;
/// Share of a function's square sum, in units of the rounding of one, that rounding may make of nothing.
pub(super) const ROUNDING: f64 = 1e4;

/// Least-squares fit of fields in one cell, prepared for a set of points.
#[derive(Clone, Copy, Debug)]
pub struct CellFit<T, const NB: usize> {
    /// `U` below the diagonal, `1/d_k` on it; a dropped function has zeros.
    factors: SMatrix<T, NB, NB>,
    functions: u32,
    /// Whether sums of `psi q` are accurate enough.
    well_spread: bool,
}

/// Sums over a cell's points, of which every fit of the cell is made.
#[derive(Clone, Copy, Debug)]
pub struct Gram<T, const NB: usize> {
    /// `sum_p w_p psi_i(x_p) psi_j(x_p)`, the lower half.
    products: SMatrix<T, NB, NB>,
    count: usize,
}

/// What is done with local coordinates, weight and value of a point.
type Visit<'a, T, const D: usize, Q> = dyn FnMut(&SVector<T, D>, T, Q) + 'a;

impl<T: Scalar, const NB: usize> Gram<T, NB> {
    /// Of the points with local coordinates and positive weights `points`.
    #[inline(always)]
    pub fn new<const D: usize>(points: impl Iterator<Item = (SVector<T, D>, T)>) -> Self {
        let mut gram = Self {
            products: SMatrix::zeros(),
            count: 0,
        };
        for (s, weight) in points {
            let psi = taylor_functions::<T, D, NB>(&s);
            for i in 0..NB {
                let weighted = weight * psi[i];
                for j in 0..=i {
                    gram.products[(i, j)] += weighted * psi[j];
                }
            }
            gram.count += 1;
        }
        gram
    }

    /// `sum_p w_p psi_k(x_p)`.
    #[inline(always)]
    pub fn sum(&self, k: usize) -> T {
        self.products[(k, 0)]
    }

    /// Adds the points of a neighbouring cell, given by the sums of its own: it is the one `above` or below
    /// along `axis`.
    #[inline(always)]
    pub(crate) fn add_neighbour<const D: usize>(&mut self, other: &Self, axis: usize, above: bool) {
        // Rows, then columns of the whole symmetric matrix.
        let mut rows: [SVector<T, NB>; NB] =
            std::array::from_fn(|i| SVector::from_fn(|j, _| other.products[(i.max(j), i.min(j))]));
        shift_sums::<T, D, NB, _>(&mut rows, axis, above);
        let mut columns: [SVector<T, NB>; NB] = std::array::from_fn(|j| SVector::from_fn(|i, _| rows[i][j]));
        shift_sums::<T, D, NB, _>(&mut columns, axis, above);
        for i in 0..NB {
            for j in 0..=i {
                self.products[(i, j)] += columns[j][i];
            }
        }
        self.count += other.count;
    }

    /// Square below which what is left of a function counts as nothing.
    #[inline(always)]
    fn least<const D: usize>(&self, tolerance: T) -> SVector<T, NB> {
        let scale = tolerance * tolerance * self.products[(0, 0)];
        taylor_sizes::<T, D, NB>().map(|size| size * size * scale)
    }
}

impl<T: Scalar, const NB: usize> CellFit<T, NB> {
    /// Prepares the fit on the points with local coordinates `points`, a sequence that can be run through
    /// repeatedly.
    ///
    /// `first` is 0 for the free fit and 1 where the mean is given. At most as many functions as points are
    /// used, and none of which less than the share `tolerance` is left on the points ([`default_tolerance`]).
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
        let gram = Gram::new(points.clone());
        Self::with_gram(&gram, points, first, tolerance)
    }

    /// The same with the sums over the points at hand.
    #[inline(always)]
    pub fn with_gram<const D: usize>(
        gram: &Gram<T, NB>,
        points: impl Iterator<Item = (SVector<T, D>, T)> + Clone,
        first: usize,
        tolerance: T,
    ) -> Self {
        let end = NB.min(gram.count);
        let least = gram.least::<D>(tolerance);
        let first = first.min(end);
        if let Some(fit) = Self::from_gram(gram, first..end, &least) {
            return fit;
        }
        let mut wanted = [false; NB];
        wanted[first..end].fill(true);
        Self::from_rotations(points, wanted, &least)
    }

    /// The fit with all functions from sums alone; `None` where it would lose too many digits or the points
    /// do not tell the functions apart.
    #[inline(always)]
    pub(crate) fn full<const D: usize>(gram: &Gram<T, NB>, tolerance: T) -> Option<Self> {
        if gram.count < NB {
            return None;
        }
        let fit = Self::from_gram(gram, 0..NB, &gram.least::<D>(tolerance))?;
        (fit.functions() == NB).then_some(fit)
    }

    /// `L D L^T` factorisation of the Gram matrix, without each function of which clearly too little is left;
    /// `None` where that is in doubt, or too many digits are lost.
    #[inline(always)]
    fn from_gram(gram: &Gram<T, NB>, wanted: Range<usize>, least: &SVector<T, NB>) -> Option<Self> {
        let first = wanted.start;
        let mut functions = wanted.len();
        let rounding = T::lit(ROUNDING) * T::default_epsilon();
        let gram = &gram.products;
        // Rows of L below the diagonal, and the inverse squares on it.
        let mut l = SMatrix::<T, NB, NB>::zeros();
        for k in wanted.clone() {
            let mut left = gram[(k, k)];
            // L D, row k.
            let mut row = SVector::<T, NB>::zeros();
            for j in first..k {
                let dot = (first..j).fold(gram[(k, j)], |sum, i| sum - l[(j, i)] * row[i]);
                row[j] = dot;
                l[(k, j)] = dot * l[(j, j)];
                left -= l[(k, j)] * dot;
            }
            let square = gram[(k, k)];
            if left > square * T::lit(GRAM_SHARE) && left > least[k] {
                l[(k, k)] = T::one() / left;
            } else if left + square * rounding <= least[k] {
                l.row_mut(k).fill(T::zero());
                functions -= 1;
            } else {
                return None;
            }
        }
        Some(Self {
            factors: inverse_below_the_diagonal(&l, first),
            functions: functions as u32,
            well_spread: true,
        })
    }

    /// QR factorisation by Givens rotations, again without each function of which too little is left.
    #[cold]
    #[inline(never)]
    fn from_rotations<const D: usize>(
        points: impl Iterator<Item = (SVector<T, D>, T)> + Clone,
        mut wanted: [bool; NB],
        least: &SVector<T, NB>,
    ) -> Self {
        let rows = points.map(|(s, weight)| taylor_functions::<T, D, NB>(&s) * weight.sqrt());
        let r = loop {
            let r = rotate(rows.clone(), &wanted);
            match (0..NB).find(|&k| wanted[k] && r[(k, k)] * r[(k, k)] <= least[k]) {
                Some(k) => wanted[k] = false,
                None => break r,
            }
        };
        let mut l = SMatrix::<T, NB, NB>::zeros();
        for k in (0..NB).filter(|&k| wanted[k]) {
            for j in (0..k).filter(|&j| wanted[j]) {
                l[(k, j)] = r[(j, k)] / r[(j, j)];
            }
            l[(k, k)] = T::one() / (r[(k, k)] * r[(k, k)]);
        }
        Self {
            factors: inverse_below_the_diagonal(&l, 0),
            functions: wanted.iter().filter(|&&w| w).count() as u32,
            well_spread: false,
        }
    }

    /// Number of functions in the fit; a given mean is not counted.
    pub fn functions(&self) -> usize {
        self.functions as usize
    }

    /// Whether the points are so well spread that [`CellFit::coefficients_from_sums`] loses no digits.
    #[inline(always)]
    pub fn is_well_spread(&self) -> bool {
        self.well_spread
    }

    /// Coefficients of the field with the given `samples` (local coordinates, weight and value at the same
    /// points as at the preparation; weight 1 unless it was weighted), less `mean`. The mean itself is *not*
    /// added to the first coefficient. Where the points are not well spread the samples are run through once
    /// for each function.
    #[inline(always)]
    pub fn coefficients<const D: usize, Q: Field<T>>(
        &self,
        samples: impl Iterator<Item = (SVector<T, D>, T, Q)> + Clone,
        mean: Q,
    ) -> [Q; NB] {
        if self.well_spread {
            let mut sums = [Q::zero(); NB];
            for (s, weight, value) in samples {
                let psi = taylor_functions::<T, D, NB>(&s);
                let mut rest = value;
                rest.add_scaled(-T::one(), mean);
                for k in 0..NB {
                    sums[k].add_scaled(weight * psi[k], rest);
                }
            }
            return self.coefficients_from_sums(sums);
        }
        self.successive_coefficients(mean, &mut |visit| {
            for (s, weight, value) in samples.clone() {
                visit(&s, weight, value);
            }
        })
    }

    /// Coefficients where the points are not well spread: each function is fitted to what those before it
    /// have left. Fitted to the values themselves, a function that is small on the points would be given the
    /// round-off of all that the values have in common, divided by the square of what is left of it.
    /// `samples` hands over local coordinates, weight and value of each point; a call through a pointer, so
    /// that this is compiled once for a field.
    #[cold]
    #[inline(never)]
    fn successive_coefficients<const D: usize, Q: Field<T>>(
        &self,
        mean: Q,
        samples: &mut dyn FnMut(&mut Visit<'_, T, D, Q>),
    ) -> [Q; NB] {
        let mut coefficients = [Q::zero(); NB];
        for k in (0..NB).filter(|&k| self.factors[(k, k)] != T::zero()) {
            let mut sum = Q::zero();
            samples(&mut |s, weight, value| {
                let psi = taylor_functions::<T, D, NB>(s);
                let (mut rest, mut pi) = (value, psi[k]);
                rest.add_scaled(-T::one(), mean);
                for j in 0..k {
                    rest.add_scaled(-psi[j], coefficients[j]);
                    pi += self.factors[(k, j)] * psi[j];
                }
                sum.add_scaled(weight * pi, rest);
            });
            coefficients[k] = sum.scaled(self.factors[(k, k)]);
            let last = coefficients[k];
            for j in 0..k {
                coefficients[j].add_scaled(self.factors[(k, j)], last);
            }
        }
        coefficients
    }

    /// Coefficients from the sums of `w psi_k q` over the points. Only where [`CellFit::is_well_spread`].
    #[inline(always)]
    pub fn coefficients_from_sums<Q: Field<T>>(&self, mut sums: [Q; NB]) -> [Q; NB] {
        for k in (1..NB).rev() {
            for j in 0..k {
                let below = sums[j];
                sums[k].add_scaled(self.factors[(k, j)], below);
            }
        }
        self.orthogonal_coefficients(sums)
    }

    /// `U^T D^-1` times the sums of `w pi_k q`.
    #[inline(always)]
    fn orthogonal_coefficients<Q: Field<T>>(&self, sums: [Q; NB]) -> [Q; NB] {
        let scaled: [Q; NB] = std::array::from_fn(|k| sums[k].scaled(self.factors[(k, k)]));
        std::array::from_fn(|j| {
            let mut coefficient = scaled[j];
            for k in j + 1..NB {
                coefficient.add_scaled(self.factors[(k, j)], scaled[k]);
            }
            coefficient
        })
    }
}

/// The unit triangular inverse of a unit lower triangular matrix, whose diagonal holds other things and is
/// kept, from row and column `first` on.
#[inline(always)]
fn inverse_below_the_diagonal<T: Scalar, const NB: usize>(
    l: &SMatrix<T, NB, NB>,
    first: usize,
) -> SMatrix<T, NB, NB> {
    let mut inverse = *l;
    for k in first..NB {
        for j in first..k {
            inverse[(k, j)] = (j + 1..k).fold(-l[(k, j)], |sum, i| sum - l[(k, i)] * inverse[(i, j)]);
        }
    }
    inverse
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
