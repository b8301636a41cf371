//! One factorisation for both fits of a step.
//!
//! Between the fit of the stress and that of the densities no particle moves, so both have the same Gram
//! matrix. With the constant function last in `L D L^T` the columns before it are the factor of the fit whose
//! mean is given, and all of them that of the free one. Only for cells that clearly determine all functions,
//! whatever their order: where some are left out the order decides which.

use nalgebra::SVector;

use super::basis::taylor_sizes;
use super::fit::GRAM_SHARE;
use super::four::{Products, Rights};
use crate::scalar::Scalar;
use crate::simd::{LANES, Number, Packs, unrolled};

/// The factor of four cells, functions in the order of [`function`].
#[derive(Clone, Copy)]
pub(crate) struct SharedFactor<V, const NB: usize> {
    /// The inverse of the unit triangle `L` below the diagonal, one over the squares that are left on it: it
    /// solves by products that need not wait for each other.
    inverse: Products<V, NB>,
    /// Products of each function with the constant one.
    pub(crate) with_constant: [V; NB],
}

/// Which function is the `m`-th.
#[inline(always)]
const fn function<const NB: usize>(m: usize) -> usize {
    if m + 1 < NB { m + 1 } else { 0 }
}

/// Numbers that are kept of a cell: the factor, the products with the constant, and whether there are any.
pub(crate) const fn kept<const NB: usize>() -> usize {
    NB * (NB + 1) / 2 + NB + 1
}

/// `L D L^T` of Gram matrices: `L` below the diagonal, one over `D` on it.
#[inline(always)]
fn triangle<T: Scalar, K: Packs<T>, const NB: usize>(k: K, gram: &Products<K::V, NB>) -> Products<K::V, NB> {
    let (zero, one) = (k.splat(T::zero()), k.splat(T::one()));
    let mut lower = [[zero; NB]; NB];
    unrolled::<NB>(
        #[inline(always)]
        |m| {
            let own = function::<NB>(m);
            let mut left = gram[own][own];
            let mut row = [zero; NB];
            unrolled::<NB>(
                #[inline(always)]
                |j| {
                    if j >= m {
                        return;
                    }
                    let other = function::<NB>(j);
                    let (high, low) = if own > other { (own, other) } else { (other, own) };
                    let mut dot = gram[high][low];
                    unrolled::<NB>(
                        #[inline(always)]
                        |i| {
                            if i < j {
                                dot = dot - lower[j][i] * row[i];
                            }
                        },
                    );
                    row[j] = dot;
                    lower[m][j] = dot * lower[j][j];
                    left = left - lower[m][j] * dot;
                },
            );
            lower[m][m] = one / left;
        },
    );
    lower
}

/// The inverse of the unit triangle below the diagonal, in its place.
#[inline(always)]
fn invert<T: Scalar, V: Number<T>, const NB: usize>(zero: V, lower: &mut Products<V, NB>) {
    unrolled::<NB>(
        #[inline(always)]
        |n| {
            // Rows above are inverted already.
            let row = lower[n];
            unrolled::<NB>(
                #[inline(always)]
                |j| {
                    if j >= n {
                        return;
                    }
                    let mut entry = row[j];
                    unrolled::<NB>(
                        #[inline(always)]
                        |i| {
                            if j < i && i < n {
                                entry = row[i].mul_add(lower[i][j], entry);
                            }
                        },
                    );
                    lower[n][j] = zero - entry;
                },
            );
        },
    );
}

impl<V: Copy, const NB: usize> SharedFactor<V, NB> {
    /// Of the Gram matrices `gram` of cells with so many points, if these clearly determine all functions of
    /// all four.
    #[inline(always)]
    pub(crate) fn new<T: Scalar, K: Packs<T, V = V>, const D: usize>(
        k: K,
        gram: &Products<V, NB>,
        counts: &[usize; LANES],
        tolerance: T,
    ) -> Option<Self>
    where
        V: Number<T>,
    {
        if counts[0].min(counts[1]).min(counts[2].min(counts[3])) < NB {
            return None;
        }
        let (zero, one) = (k.splat(T::zero()), k.splat(T::one()));
        let sizes: SVector<T, NB> = taylor_sizes::<T, D, NB>();
        let share = k.splat(T::lit(GRAM_SHARE));
        let mut inverse = triangle::<T, K, NB>(k, gram);
        invert(zero, &mut inverse);
        let mut full = one;
        unrolled::<NB>(
            #[inline(always)]
            |m| {
                // The `m`-th entry on the diagonal of the inverse of the Gram matrix: one over the square
                // that all other functions leave of the `m`-th. In no order is less left of it, so that a
                // function that passes by this is kept by every fit.
                let mut diagonal = inverse[m][m];
                unrolled::<NB>(
                    #[inline(always)]
                    |n| {
                        if n > m {
                            diagonal = (inverse[n][m] * inverse[n][m]).mul_add(inverse[n][n], diagonal);
                        }
                    },
                );
                let own = function::<NB>(m);
                let least = gram[0][0] * k.splat(tolerance * tolerance * sizes[own] * sizes[own]);
                let enough = one.above(diagonal * least) * one.above(diagonal * gram[own][own] * share);
                full = full * inverse[m][m].above(zero) * enough;
            },
        );
        let mut with_constant = [gram[0][0]; NB];
        for n in 1..NB {
            with_constant[n] = gram[n][0];
        }
        let (half, two) = (k.splat(T::one() / T::lit(2.0)), k.splat(T::lit(2.0)));
        k.are_between(full, half, two).then_some(Self {
            inverse,
            with_constant,
        })
    }

    /// Keeps it, or that there is none.
    #[inline(always)]
    pub(crate) fn keep<T: Scalar, K: Packs<T, V = V>>(factor: Option<&Self>, k: K, kept: &mut [[T; LANES]]) {
        // All checks of lengths at once.
        let Some((first, kept)) = kept.split_first_mut() else {
            return;
        };
        let Some(factor) = factor else {
            *first = [T::zero(); LANES];
            return;
        };
        *first = [T::one(); LANES];
        let Some(kept) = kept.get_mut(..NB * (NB + 1) / 2 + NB) else {
            return;
        };
        unrolled::<NB>(
            #[inline(always)]
            |m| {
                unrolled::<NB>(
                    #[inline(always)]
                    |j| {
                        if j <= m {
                            kept[row::<NB>(m) + j] = k.array(factor.inverse[m][j]);
                        }
                    },
                );
                kept[row::<NB>(m) + m + 1] = k.array(factor.with_constant[m]);
            },
        );
    }

    /// What was kept, if anything was.
    #[inline(always)]
    pub(crate) fn kept<T: Scalar, K: Packs<T, V = V>>(k: K, kept: &[[T; LANES]]) -> Option<Self> {
        let (there, numbers) = kept.split_first()?;
        let numbers = numbers.get(..NB * (NB + 1) / 2 + NB)?;
        if there[0] != T::one() {
            return None;
        }
        let zero = k.splat(T::zero());
        let (mut inverse, mut with_constant) = ([[zero; NB]; NB], [zero; NB]);
        unrolled::<NB>(
            #[inline(always)]
            |m| {
                unrolled::<NB>(
                    #[inline(always)]
                    |j| {
                        if j <= m {
                            inverse[m][j] = k.pack(numbers[row::<NB>(m) + j]);
                        }
                    },
                );
                with_constant[m] = k.pack(numbers[row::<NB>(m) + m + 1]);
            },
        );
        Some(Self {
            inverse,
            with_constant,
        })
    }

    /// Coefficients of component `q` from its sums, with all functions or, given the mean, all but the
    /// constant.
    #[inline(always)]
    pub(crate) fn solve<T: Scalar, const C: usize>(
        &self,
        zero: V,
        all: bool,
        q: usize,
        right: &Rights<V, NB, C>,
        coefficients: &mut Rights<V, NB, C>,
    ) where
        V: Number<T>,
    {
        let (inverse, count) = (&self.inverse, if all { NB } else { NB - 1 });
        let mut x = [zero; NB];
        unrolled::<NB>(
            #[inline(always)]
            |m| {
                if m >= count {
                    return;
                }
                let mut sum = right[function::<NB>(m)][q];
                unrolled::<NB>(
                    #[inline(always)]
                    |j| {
                        if j < m {
                            sum = inverse[m][j].mul_add(right[function::<NB>(j)][q], sum);
                        }
                    },
                );
                x[m] = sum * inverse[m][m];
            },
        );
        unrolled::<NB>(
            #[inline(always)]
            |m| {
                if m >= count {
                    return;
                }
                let mut sum = x[m];
                unrolled::<NB>(
                    #[inline(always)]
                    |j| {
                        if m < j && j < count {
                            sum = inverse[j][m].mul_add(x[j], sum);
                        }
                    },
                );
                coefficients[function::<NB>(m)][q] = sum;
            },
        );
    }
}

/// Keeps the Gram matrices of cells that share no factor.
#[inline(always)]
pub(crate) fn keep_products<T: Scalar, K: Packs<T>, const NB: usize>(
    k: K,
    gram: &Products<K::V, NB>,
    kept: &mut [[T; LANES]],
) {
    let Some((first, kept)) = kept.split_first_mut() else {
        return;
    };
    let Some(kept) = kept.get_mut(..NB * (NB + 1) / 2) else {
        return;
    };
    *first = [T::lit(PRODUCTS); LANES];
    unrolled::<NB>(
        #[inline(always)]
        |m| {
            unrolled::<NB>(
                #[inline(always)]
                |j| {
                    if j <= m {
                        kept[m * (m + 1) / 2 + j] = k.array(gram[m][j]);
                    }
                },
            );
        },
    );
}

/// Gram matrices, if they were kept.
#[inline(always)]
pub(crate) fn kept_products<T: Scalar, K: Packs<T>, const NB: usize>(
    k: K,
    kept: &[[T; LANES]],
) -> Option<Products<K::V, NB>> {
    let (first, numbers) = kept.split_first()?;
    let numbers = numbers.get(..NB * (NB + 1) / 2)?;
    if first[0] != T::lit(PRODUCTS) {
        return None;
    }
    let mut gram = [[k.splat(T::zero()); NB]; NB];
    unrolled::<NB>(
        #[inline(always)]
        |m| {
            unrolled::<NB>(
                #[inline(always)]
                |j| {
                    if j <= m {
                        gram[m][j] = k.pack(numbers[m * (m + 1) / 2 + j]);
                    }
                },
            );
        },
    );
    Some(gram)
}

/// What is kept first where the rest are products: one tells that they are a factor, zero that there are
/// none.
const PRODUCTS: f64 = 2.0;

/// Where row `m` of what is kept begins.
#[inline(always)]
const fn row<const NB: usize>(m: usize) -> usize {
    m * (m + 1) / 2 + m
}

#[cfg(test)]
mod tests {
    use nalgebra::vector;
    use proptest::collection::vec;
    use proptest::prelude::*;

    use super::super::basis::taylor_functions;
    use super::super::four::factorise;
    use super::*;
    use crate::simd::{Four, Lanes, Plain};
    use crate::taylor::{BatchSums, taylor_lanes};

    /// Sums over points that lie in no order, another count in each cell.
    fn sums<const D: usize, const NB: usize>(counts: &[usize; LANES]) -> BatchSums<Four<f64>, NB, 2> {
        let mut sums = BatchSums::new::<f64, _>(Plain);
        let number = |seed: usize| ((seed * seed + 7 * seed + 3) % 101) as f64 / 50.5 - 1.0;
        for p in 0..*counts.iter().max().unwrap() {
            let s = std::array::from_fn(|a| Four(std::array::from_fn(|l| number(31 * p + 7 * a + 3 * l))));
            let psi = taylor_lanes::<f64, Plain, D, NB>(Plain, &s);
            let weight = Four(counts.map(|count| f64::from(u8::from(p < count))));
            let value = Four(std::array::from_fn(|l| number(13 * p + l)));
            sums.add_products(&psi, weight, 0);
            sums.add_values(&psi, weight, weight, &[value, weight], 2);
        }
        sums
    }

    fn check<const D: usize, const NB: usize>() {
        let counts = [2 * NB, 3 * NB, 2 * NB + 1, 4 * NB];
        let mut sums = sums::<D, NB>(&counts);
        let factor = SharedFactor::new::<f64, _, D>(Plain, &sums.gram, &counts, 1e-3).unwrap();
        let mut kept = vec![[0.0; LANES]; super::kept::<NB>()];
        SharedFactor::keep::<f64, _>(Some(&factor), Plain, &mut kept);
        let again = SharedFactor::kept::<f64, _>(Plain, &kept).unwrap();
        for all in [true, false] {
            let first = usize::from(!all);
            let expected = sums.fit::<f64, _, D>(Plain, first, &counts, 1e-3, 2);
            assert_eq!(expected.hard, [false; LANES]);
            let mut found = [[Four([0.0; LANES]); 2]; NB];
            for q in 0..2 {
                again.solve::<f64, 2>(Four([0.0; LANES]), all, q, &sums.right, &mut found);
            }
            for (found, expected) in found.iter().zip(&expected.coefficients).skip(first) {
                for l in 0..LANES {
                    assert!((found[0].0[l] - expected[0].0[l]).abs() < 1e-11, "{D} {all}");
                }
            }
            sums.take_out_mean::<f64, _>(Plain, 2.0, 2);
        }
    }

    #[test]
    fn it_solves_both_fits_as_two_factorisations_do() {
        check::<1, 3>();
        check::<1, 2>();
        check::<2, 6>();
        check::<3, 10>();
    }

    #[test]
    fn cells_with_few_points_have_none() {
        let counts = [12, 12, 5, 12];
        let sums = sums::<2, 6>(&counts);
        assert!(SharedFactor::new::<f64, _, 2>(Plain, &sums.gram, &counts, 1e-3).is_none());
        let mut kept = vec![[1.0; LANES]; super::kept::<6>()];
        SharedFactor::<Four<f64>, 6>::keep::<f64, _>(None, Plain, &mut kept);
        assert!(SharedFactor::<Four<f64>, 6>::kept::<f64, _>(Plain, &kept).is_none());
    }

    /// Whether the factor is shared, and whether the free fit and the one of known mean keep all functions.
    fn decisions<const NB: usize>(points: &[SVector<f64, 2>], tolerance: f64) -> (bool, [bool; 2]) {
        let zero = Lanes::<f64>::splat(Plain, 0.0);
        let mut gram = [[zero; NB]; NB];
        for point in points {
            let psi: SVector<f64, NB> = taylor_functions(point);
            for i in 0..NB {
                for j in 0..=i {
                    gram[i][j] = gram[i][j] + Lanes::<f64>::splat(Plain, psi[i] * psi[j]);
                }
            }
        }
        let counts = [points.len(); LANES];
        let shared = SharedFactor::new::<f64, Plain, 2>(Plain, &gram, &counts, tolerance);
        let full = [0, 1].map(|first| {
            let found = factorise::<f64, Plain, 2, NB>(Plain, &gram, first, &counts, tolerance);
            found.functions == [NB - first; LANES] && found.hard == [false; LANES]
        });
        (shared.is_some(), full)
    }

    proptest! {
        /// Points that crowd together, as where a surface cuts a cell: which functions they determine depends
        /// on the order, and what is shared must be right in both.
        #[test]
        fn a_shared_factor_is_of_functions_that_both_fits_keep(
            points in vec((-1.0..1.0_f64, -1.0..1.0_f64), 3..16),
            size in (0.02..1.0_f64, 0.02..1.0_f64),
            middle in (-0.9..0.9_f64, -0.9..0.9_f64),
        ) {
            let placed = points.iter().map(|(x, y)| vector![middle.0 + size.0 * x, middle.1 + size.1 * y]);
            let points: Vec<_> = placed.map(|x: SVector<f64, 2>| x.map(|x| x.clamp(-1.0, 1.0))).collect();
            for tolerance in [1e-3, 0.03, 0.1, 0.3] {
                let found = [decisions::<3>(&points, tolerance), decisions::<6>(&points, tolerance)];
                for (shared, full) in found {
                    prop_assert!(!shared || full == [true; 2], "{full:?}, {tolerance}");
                }
            }
        }
    }

    #[test]
    fn a_filled_cell_shares_its_factor() {
        let at = |n: usize| (n as f64 - 1.0) * 2.0 / 3.0;
        let points: Vec<_> = (0..9).map(|n| vector![at(n % 3), at(n / 3)]).collect();
        assert!(decisions::<3>(&points, 0.1).0 && decisions::<6>(&points, 0.1).0);
    }
}
