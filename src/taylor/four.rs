//! The fits of four cells at once.
//!
//! The same least squares as [`super::CellFit`] from the Gram matrix, one cell in each lane, and solved where
//! they stand instead of being kept. A function of which the points clearly see nothing is left out here too;
//! a cell where that is in doubt, or digits would be lost, is *hard* and left to [`super::CellFit`].

use nalgebra::SVector;

use super::basis::taylor_sizes;
use super::fit::{GRAM_SHARE, ROUNDING};
use crate::field::Field;
use crate::scalar::Scalar;
use crate::simd::{LANES, Lanes, Number, Packs, each, in_lanes, unrolled};

/// Most components of a field: a tensor in three dimensions.
pub const MOST_COMPONENTS: usize = 9;

/// Components of the fields of a step along one axis, at most: mass and momentum.
pub(crate) const FEW_COMPONENTS: usize = 2;

/// Whether a field along one axis has no more of them: arrays are then short. A constant, so that a compiler
/// makes no code for the other case.
pub(crate) const fn are_few<T: Scalar, Q: Field<T>, const D: usize>() -> bool {
    D == 1 && Q::COMPONENTS <= FEW_COMPONENTS
}

/// The Taylor functions, as [`super::taylor_functions`].
#[inline(always)]
pub(crate) fn taylor_lanes<T: Scalar, K: Lanes<T>, const D: usize, const NB: usize>(
    k: K,
    s: &[K::V; D],
) -> [K::V; NB] {
    let half = k.splat(T::one() / T::lit(2.0));
    let sixth = k.splat(T::one() / T::lit(6.0));
    let mut psi = [k.splat(T::one()); NB];
    for a in 0..D {
        psi[1 + a] = s[a];
    }
    if NB > D + 1 {
        for a in 0..D {
            psi[1 + D + a] = s[a] * s[a] * half - sixth;
        }
        let mut n = 1 + 2 * D;
        for a in 0..D {
            for b in a + 1..D {
                psi[n] = s[a] * s[b];
                n += 1;
            }
        }
    }
    psi
}

/// Sums over the points of four cells: of products of the functions, and of functions times the components of
/// a field.
#[derive(Clone, Copy)]
pub(crate) struct BatchSums<V, const NB: usize, const C: usize = MOST_COMPONENTS> {
    /// The lower half.
    pub(crate) gram: Products<V, NB>,
    pub(crate) right: Rights<V, NB, C>,
}

/// Of each function, sums over points or coefficients, component by component.
pub(crate) type Rights<V, const NB: usize, const C: usize = MOST_COMPONENTS> = [[V; C]; NB];

/// Products of two functions, the lower half.
pub(crate) type Products<V, const NB: usize> = [[V; NB]; NB];

/// Unit triangular factor below the diagonal, one over the squares that are left on it, zero for functions
/// left out.
#[derive(Clone, Copy)]
pub(crate) struct Factor<V, const NB: usize>(pub(crate) Products<V, NB>);

/// The factors of four cells.
pub(crate) struct Factored<V, const NB: usize> {
    pub(crate) factor: Factor<V, NB>,
    pub(crate) hard: [bool; LANES],
    /// Number of functions.
    pub(crate) functions: [usize; LANES],
    /// Whether all cells clearly have all functions; not always told.
    pub(crate) are_full: bool,
}

/// What became of four fits.
pub(crate) struct FourFits<V, const NB: usize, const C: usize> {
    /// Coefficients of each function.
    pub(crate) coefficients: Rights<V, NB, C>,
    pub(crate) hard: [bool; LANES],
    /// Number of functions.
    pub(crate) functions: [usize; LANES],
    /// Whether all cells clearly have all functions; not always told.
    pub(crate) are_full: bool,
}

impl<V: Copy, const NB: usize, const C: usize> BatchSums<V, NB, C> {
    #[inline(always)]
    pub(crate) fn new<T: Scalar, K: Lanes<T, V = V>>(k: K) -> Self {
        let zero = k.splat(T::zero());
        Self {
            gram: [[zero; NB]; NB],
            right: [[zero; C]; NB],
        }
    }

    /// Adds the products of a point of each cell with its weight, zero where a cell has no further point:
    /// all, or of the functions from number `from` on with those before them.
    #[inline(always)]
    pub(crate) fn add_products<T: Scalar>(&mut self, psi: &[V; NB], weight: V, from: usize)
    where
        V: Number<T>,
    {
        for i in from..NB {
            let weighted = psi[i] * weight;
            for j in 0..i + 1 {
                self.gram[i][j] = weighted.mul_add(psi[j], self.gram[i][j]);
            }
        }
    }

    /// Adds the functions times the components of a field; `first` is the weight with the first function,
    /// which is one.
    #[inline(always)]
    pub(crate) fn add_values<T: Scalar>(
        &mut self,
        psi: &[V; NB],
        weight: V,
        first: V,
        values: &[V; C],
        components: usize,
    ) where
        V: Number<T>,
    {
        for i in 0..NB {
            let weighted = if i == 0 { first } else { psi[i] * weight };
            for q in 0..components {
                self.right[i][q] = weighted.mul_add(values[q], self.right[i][q]);
            }
        }
    }

    /// Takes the mean of each component over a cell of the given volume, whose integral is its sum with the
    /// first function, out of the sums; returns it.
    #[inline(always)]
    pub(crate) fn take_out_mean<T: Scalar, K: Lanes<T, V = V>>(
        &mut self,
        k: K,
        volume: T,
        components: usize,
    ) -> [V; C]
    where
        V: Number<T>,
    {
        let whole = k.splat(T::one() / volume);
        let mut mean = [k.splat(T::zero()); C];
        for q in 0..components {
            mean[q] = self.right[0][q] * whole;
        }
        self.take_out(&mean, components);
        mean
    }

    /// Takes a mean, known of each component, out of the sums.
    #[inline(always)]
    fn take_out<T: Scalar>(&mut self, mean: &[V; C], components: usize)
    where
        V: Number<T>,
    {
        for k in 1..NB {
            for q in 0..components {
                self.right[k][q] = self.right[k][q] - self.gram[k][0] * mean[q];
            }
        }
    }

    /// Fits with the functions from `first` on, as many as a cell has points, `counts`, at most.
    #[inline(always)]
    pub(crate) fn fit<T: Scalar, K: Packs<T, V = V>, const D: usize>(
        &self,
        k: K,
        first: usize,
        counts: &[usize; LANES],
        tolerance: T,
        components: usize,
    ) -> FourFits<V, NB, C>
    where
        V: Number<T>,
    {
        let zero = k.splat(T::zero());
        let Factored {
            factor,
            hard,
            functions,
            are_full,
        } = factorise::<T, K, D, NB>(k, &self.gram, first, counts, tolerance);
        let mut coefficients = [[zero; C]; NB];
        for q in 0..components {
            factor.solve::<T, C>(zero, first, q, &self.right, &mut coefficients);
        }
        FourFits {
            coefficients,
            hard,
            functions,
            are_full,
        }
    }
}

/// `L D L^T` of four Gram matrices, with the functions from `first` on.
#[inline(always)]
pub(crate) fn factorise<T: Scalar, K: Packs<T>, const D: usize, const NB: usize>(
    k: K,
    gram: &Products<K::V, NB>,
    first: usize,
    counts: &[usize; LANES],
    tolerance: T,
) -> Factored<K::V, NB> {
    if const { D > 1 } {
        return factorise_any::<T, K, D, NB>(k, gram, first, counts, tolerance);
    }
    match factorise_full::<T, K, D, NB>(k, gram, first, counts, tolerance) {
        Some(factor) => Factored {
            factor,
            hard: [false; LANES],
            functions: [NB - first; LANES],
            are_full: true,
        },
        None => factorise_apart::<T, K, D, NB>(k, gram, first, counts, tolerance),
    }
}

/// The same where all points clearly see all functions: the same operations without what then changes
/// nothing.
#[inline(always)]
fn factorise_full<T: Scalar, K: Packs<T>, const D: usize, const NB: usize>(
    k: K,
    gram: &Products<K::V, NB>,
    first: usize,
    counts: &[usize; LANES],
    tolerance: T,
) -> Option<Factor<K::V, NB>> {
    let (zero, one) = (k.splat(T::zero()), k.splat(T::one()));
    let sizes: SVector<T, NB> = taylor_sizes::<T, D, NB>();
    let share = k.splat(T::lit(GRAM_SHARE));
    let mut l = [[zero; NB]; NB];
    let mut full = one;
    for m in first..NB {
        let mut left = gram[m][m];
        let mut row = [zero; NB];
        for j in first..m {
            let mut dot = gram[m][j];
            for i in first..j {
                dot = dot - l[j][i] * row[i];
            }
            row[j] = dot;
            l[m][j] = dot * l[j][j];
            left = left - l[m][j] * dot;
        }
        let least = gram[0][0] * k.splat(tolerance * tolerance * sizes[m] * sizes[m]);
        full = full * left.above(least) * left.above(gram[m][m] * share);
        l[m][m] = one / left;
    }
    let are_enough = counts[0] >= NB && counts[1] >= NB && counts[2] >= NB && counts[3] >= NB;
    let (half, two) = (k.splat(T::one() / T::lit(2.0)), k.splat(T::lit(2.0)));
    (are_enough && k.are_between(full, half, two)).then_some(Factor(l))
}

/// [`factorise_any`], out of the way of the code that usually runs.
#[cold]
#[inline(never)]
fn factorise_apart<T: Scalar, K: Packs<T>, const D: usize, const NB: usize>(
    k: K,
    gram: &Products<K::V, NB>,
    first: usize,
    counts: &[usize; LANES],
    tolerance: T,
) -> Factored<K::V, NB> {
    k.run(
        #[inline(always)]
        || factorise_any::<T, K, D, NB>(k, gram, first, counts, tolerance),
    )
}

/// The same whatever the points see.
#[inline(always)]
fn factorise_any<T: Scalar, K: Packs<T>, const D: usize, const NB: usize>(
    k: K,
    gram: &Products<K::V, NB>,
    first: usize,
    counts: &[usize; LANES],
    tolerance: T,
) -> Factored<K::V, NB> {
    let (zero, one) = (k.splat(T::zero()), k.splat(T::one()));
    let sizes: SVector<T, NB> = taylor_sizes::<T, D, NB>();
    let share = k.splat(T::lit(GRAM_SHARE));
    let rounding = k.splat(T::lit(ROUNDING) * T::default_epsilon());
    let (total, numbers) = (
        gram[0][0],
        k.pack(in_lanes(
            #[inline(always)]
            |l| T::count(counts[l]),
        )),
    );
    let mut l = [[zero; NB]; NB];
    let (mut doubt, mut functions) = (zero, zero);
    unrolled::<NB>(
        #[inline(always)]
        |m| {
            if m < first {
                return;
            }
            let square = gram[m][m];
            let mut left = square;
            let mut row = [zero; NB];
            unrolled::<NB>(
                #[inline(always)]
                |j| {
                    if j < first || j >= m {
                        return;
                    }
                    let mut dot = gram[m][j];
                    unrolled::<NB>(
                        #[inline(always)]
                        |i| {
                            if first <= i && i < j {
                                dot = dot - l[j][i] * row[i];
                            }
                        },
                    );
                    row[j] = dot;
                    l[m][j] = dot * l[j][j];
                    left = left - l[m][j] * dot;
                },
            );
            let least = total * k.splat(tolerance * tolerance * sizes[m] * sizes[m]);
            let allowed = numbers.above(k.splat(T::count(m)));
            let kept = left.above(least) * left.above(square * share) * allowed;
            let seen = (left + square * rounding).above(least) * allowed;
            doubt = doubt + (seen - kept);
            functions = functions + kept;
            l[m][m] = kept / (left * kept + (one - kept));
            unrolled::<NB>(
                #[inline(always)]
                |j| {
                    if first <= j && j < m {
                        l[m][j] = l[m][j] * kept;
                    }
                },
            );
        },
    );
    let (doubt, functions) = (k.array(doubt), k.array(functions));
    Factored {
        factor: Factor(l),
        hard: each(
            #[inline(always)]
            |l| doubt[l] != T::zero(),
        ),
        functions: each(
            #[inline(always)]
            |l| functions[l].primal() as usize,
        ),
        are_full: false,
    }
}

impl<V: Copy, const NB: usize> Factor<V, NB> {
    /// Coefficients of component `q` from its sums.
    #[inline(always)]
    pub(crate) fn solve<T: Scalar, const C: usize>(
        &self,
        zero: V,
        first: usize,
        q: usize,
        right: &Rights<V, NB, C>,
        coefficients: &mut Rights<V, NB, C>,
    ) where
        V: Number<T>,
    {
        let l = &self.0;
        let mut x = [zero; NB];
        unrolled::<NB>(
            #[inline(always)]
            |k| {
                if k < first {
                    return;
                }
                x[k] = right[k][q];
                unrolled::<NB>(
                    #[inline(always)]
                    |j| {
                        if first <= j && j < k {
                            x[k] = x[k] - l[k][j] * x[j];
                        }
                    },
                );
            },
        );
        for k in first..NB {
            x[k] = x[k] * l[k][k];
        }
        // From the last one down.
        unrolled::<NB>(
            #[inline(always)]
            |n| {
                let k = NB - 1 - n;
                if k < first {
                    return;
                }
                unrolled::<NB>(
                    #[inline(always)]
                    |j| {
                        if k < j {
                            x[k] = x[k] - l[j][k] * x[j];
                        }
                    },
                );
                coefficients[k][q] = x[k];
            },
        );
    }
}
