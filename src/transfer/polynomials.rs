//! Polynomials of cells straight to DOFs.
//!
//! In a cell the functions of the basis and those of a fit ([`mod@crate::taylor`]) are fixed, so that their
//! products have fixed sums over the points of a rule of quadrature, and all three are products along the
//! axes: with `A_a[i][k] = sum_g w_g N_i(x_g) f_k(x_g)` along the axis `a`, of `f_0 = 1`, `f_1 = s` and
//! `f_2 = s^2 / 2 - 1 / 6`,
//!
//! ```text
//! sum_g w_g N_i(x_g) psi_k(x_g) = prod_a A_a[i_a][k_a]
//! ```
//!
//! and for a gradient the slopes along its axis. Coefficients are summed along one axis after another;
//! nothing is evaluated at points.

#[cfg(test)]
mod tests;

use super::Sweep;
use super::fits::{Kinds, MOST_POINTS};
use super::sums::{Parts, Sums};
use crate::basis::{BasisFamily, Factors, MOST_WIDTH};
use crate::grid::Cell;
use crate::scalar::Scalar;
use crate::simd::{LANES, Number, Packs, each};

/// Taylor functions in three dimensions.
pub(super) const MOST_FUNCTIONS: usize = 10;

/// Functions of one coordinate: the constant, the linear and the quadratic one.
const POWERS: usize = 3;

/// Of each function of the basis along an axis its sums with [`POWERS`], a cell in each lane.
type Along<V> = [[V; POWERS]; MOST_WIDTH];

/// Sums along the first axis: of each function of the basis there, of each power along the other axes.
type Lines<V> = [[[V; POWERS]; POWERS]; MOST_WIDTH];

/// Sums along the first two axes: of each two functions of the basis, of each power along the last axis.
type Planes<V> = [[[V; POWERS]; MOST_WIDTH]; MOST_WIDTH];

/// The matrices of four cells.
pub(super) struct CellMatrices<T, V, const D: usize> {
    kinds: Kinds<D>,
    /// Coordinates from -1 to 1, and shares of the axis.
    line: [(T, T); MOST_POINTS],
    points: usize,
    /// Whether the rule sees quadratic functions: at two Gauss points they are zero.
    pub(super) sees_squares: bool,
    value: [Along<V>; D],
    /// The slopes, those of the coordinate in metres.
    slope: [Along<V>; D],
}

/// The functions of one coordinate.
#[inline(always)]
fn powers<T: Scalar>(s: T) -> [T; POWERS] {
    [T::one(), s, (s * s - T::one() / T::lit(3.0)) / T::lit(2.0)]
}

/// Number of the Taylor function with the given powers along the axes 0, 1 and 2, two in all at most.
#[inline(always)]
const fn function<const D: usize>(powers: [usize; 3]) -> usize {
    let [a, b, c] = powers;
    // The axis of a single power, or the sum of two axes.
    let axes = b + 2 * c;
    match a + b + c {
        0 => 0,
        1 => 1 + axes,
        _ if a == 2 || b == 2 || c == 2 => 1 + D + axes / 2,
        _ => 2 * D + axes,
    }
}

/// Calls `f` for each number below `count`, a constant of four at most, in code of its own: what is indexed
/// by it can stay in registers.
#[inline(always)]
fn unrolled(count: usize, mut f: impl FnMut(usize)) {
    if count > 0 {
        f(0);
    }
    if count > 1 {
        f(1);
    }
    if count > 2 {
        f(2);
    }
    if count > 3 {
        f(3);
    }
}

impl<T: Scalar, V: Number<T>, const D: usize> CellMatrices<T, V, D> {
    /// For the points with the given coordinates and shares along each axis.
    #[inline(always)]
    pub(super) fn new<K: Packs<T, V = V>>(k: K, points: impl Iterator<Item = (T, T)>) -> Self {
        let mut line = [(T::zero(), T::zero()); MOST_POINTS];
        let (mut count, mut largest) = (0, T::zero());
        for (place, point) in line.iter_mut().zip(points) {
            *place = point;
            count += 1;
            largest = largest.max(powers(point.0)[2].abs());
        }
        let nothing = [[k.splat(T::zero()); POWERS]; MOST_WIDTH];
        Self {
            kinds: Kinds::new(),
            line,
            points: count,
            sees_squares: largest > T::default_epsilon() * T::lit(8.0),
            value: [nothing; D],
            slope: [nothing; D],
        }
    }

    /// Brings them up to date for four cells.
    #[inline(always)]
    pub(super) fn take<B: BasisFamily<T, D>, K: Packs<T, V = V>>(
        &mut self,
        k: K,
        sweep: &Sweep<'_, T, D, B>,
        cells: &[Cell<D>; LANES],
    ) {
        if self.kinds.change(sweep, cells) {
            self.compute(k, sweep, cells);
        }
    }

    #[inline(never)]
    fn compute<B: BasisFamily<T, D>, K: Packs<T, V = V>>(
        &mut self,
        k: K,
        sweep: &Sweep<'_, T, D, B>,
        cells: &[Cell<D>; LANES],
    ) {
        let half = T::one() / T::lit(2.0);
        let units = k.pack(each(|g| (self.line[g].0 + T::one()) * half));
        let of_cells: [Factors<V, D>; LANES] = k.run(
            #[inline(always)]
            || {
                each(
                    #[inline(always)]
                    |l| sweep.basis.factors(k, sweep.grid, &cells[l], &[units; D]),
                )
            },
        );
        for axis in 0..D {
            // The volume of a cell goes with the first axis.
            let size = if axis == 0 {
                sweep.grid.cell_volume()
            } else {
                T::one()
            };
            for i in 0..B::WIDTH {
                let value = each(|l| k.array(of_cells[l].value[axis][i]));
                let slope = each(|l| k.array(of_cells[l].slope[axis][i]));
                let inverse = sweep.grid.inverse_cell_size()[axis];
                self.value[axis][i] = self.sums(k, &value, size);
                self.slope[axis][i] = self.sums(k, &slope, size * inverse);
            }
        }
    }

    /// Sums over the points, from the values there in each cell.
    fn sums<K: Packs<T, V = V>>(&self, k: K, values: &[[T; LANES]; LANES], factor: T) -> [V; POWERS] {
        let mut sums = [[T::zero(); LANES]; POWERS];
        for (g, &(s, share)) in self.line[..self.points].iter().enumerate() {
            for (sums, power) in sums.iter_mut().zip(powers(s)) {
                for (sum, values) in sums.iter_mut().zip(values) {
                    *sum += values[g] * power * share * factor;
                }
            }
        }
        sums.map(|sums| k.pack(sums))
    }

    /// Writes to `sums` what polynomials, given by the coefficients `parts` of each Taylor function, add to
    /// the DOFs of their cells.
    #[inline(always)]
    pub(super) fn put<B: BasisFamily<T, D>, const S: usize, const C: usize, const G: usize>(
        &self,
        parts: &[Parts<V, D, S, C, G>; MOST_FUNCTIONS],
        sums: &mut Sums<V, D, S, C, G>,
    ) {
        match self.sees_squares {
            true => self.put_powers::<POWERS, B, S, C, G>(parts, sums),
            false => self.put_powers::<2, B, S, C, G>(parts, sums),
        }
    }

    /// The same of so many powers along each axis.
    #[inline(always)]
    fn put_powers<const P: usize, B: BasisFamily<T, D>, const S: usize, const C: usize, const G: usize>(
        &self,
        parts: &[Parts<V, D, S, C, G>; MOST_FUNCTIONS],
        sums: &mut Sums<V, D, S, C, G>,
    ) {
        for q in 0..S {
            self.values::<P, B>(
                &each(
                    #[inline(always)]
                    |n| parts[n].scalars[q],
                ),
                #[inline(always)]
                |place, sum| sums.scalars[place][q] = sum,
            );
        }
        for q in 0..C {
            for c in 0..D {
                self.values::<P, B>(
                    &each(
                        #[inline(always)]
                        |n| parts[n].vectors[q][c],
                    ),
                    #[inline(always)]
                    |place, sum| sums.vectors[place][q][c] = sum,
                );
            }
        }
        for q in 0..G {
            for c in 0..D {
                self.slopes::<P, B>(
                    &each(
                        #[inline(always)]
                        |a| {
                            each(
                                #[inline(always)]
                                |n| parts[n].tensors[q][c][a],
                            )
                        },
                    ),
                    #[inline(always)]
                    |place, sum| sums.forces[place][q][c] = sum,
                );
            }
        }
    }

    /// Hands `put(place, sum)` the sums of a scalar times the functions of the basis.
    #[inline(always)]
    fn values<const P: usize, B: BasisFamily<T, D>>(
        &self,
        scalar: &[V; MOST_FUNCTIONS],
        mut put: impl FnMut(usize, V),
    ) {
        let lines = self.first::<P, B>(scalar, &self.value[0]);
        if const { D == 1 } {
            return unrolled(
                B::WIDTH,
                #[inline(always)]
                |i| put(i, lines[i][0][0]),
            );
        }
        let planes = self.second::<P, B>(&[(&lines, &self.value[1.min(D - 1)])]);
        self.third::<P, B>(&[(&planes, &self.value[D - 1])], put);
    }

    /// The same of a vector, one component after another, times the gradients.
    #[inline(always)]
    fn slopes<const P: usize, B: BasisFamily<T, D>>(
        &self,
        vector: &[[V; MOST_FUNCTIONS]; D],
        mut put: impl FnMut(usize, V),
    ) {
        let along = self.first::<P, B>(&vector[0], &self.slope[0]);
        if const { D == 1 } {
            return unrolled(
                B::WIDTH,
                #[inline(always)]
                |i| put(i, along[i][0][0]),
            );
        }
        let aside = self.first::<P, B>(&vector[1.min(D - 1)], &self.value[0]);
        let (value, slope) = (&self.value[1.min(D - 1)], &self.slope[1.min(D - 1)]);
        let planes = self.second::<P, B>(&[(&along, value), (&aside, slope)]);
        if const { D == 2 } {
            return self.third::<P, B>(&[(&planes, value)], put);
        }
        let across = self.first::<P, B>(&vector[D - 1], &self.value[0]);
        let across = self.second::<P, B>(&[(&across, value)]);
        let (value, slope) = (&self.value[D - 1], &self.slope[D - 1]);
        self.third::<P, B>(&[(&planes, value), (&across, slope)], put);
    }

    /// Sums along axis 0.
    #[inline(always)]
    fn first<const P: usize, B: BasisFamily<T, D>>(
        &self,
        coefficients: &[V; MOST_FUNCTIONS],
        matrix: &Along<V>,
    ) -> Lines<V> {
        let mut lines = [[[coefficients[0]; POWERS]; POWERS]; MOST_WIDTH];
        let (second, third) = (if D > 1 { P } else { 1 }, if D > 2 { P } else { 1 });
        unrolled(
            third,
            #[inline(always)]
            |c| {
                unrolled(
                    left::<P>(c).min(second),
                    #[inline(always)]
                    |b| {
                        unrolled(
                            B::WIDTH,
                            #[inline(always)]
                            |i| {
                                let mut sum = coefficients[function::<D>([0, b, c])] * matrix[i][0];
                                unrolled(
                                    left::<P>(b + c),
                                    #[inline(always)]
                                    |a| {
                                        if a > 0 {
                                            let coefficient = coefficients[function::<D>([a, b, c])];
                                            sum = coefficient.mul_add(matrix[i][a], sum);
                                        }
                                    },
                                );
                                lines[i][b][c] = sum;
                            },
                        );
                    },
                );
            },
        );
        lines
    }

    /// Sums along axis 1, of one product or two.
    #[inline(always)]
    fn second<const P: usize, B: BasisFamily<T, D>>(&self, products: &[(&Lines<V>, &Along<V>)]) -> Planes<V> {
        let mut planes = [[[products[0].0[0][0][0]; POWERS]; MOST_WIDTH]; MOST_WIDTH];
        unrolled(
            if D > 2 { P } else { 1 },
            #[inline(always)]
            |c| {
                unrolled(
                    B::WIDTH,
                    #[inline(always)]
                    |j| {
                        unrolled(
                            B::WIDTH,
                            #[inline(always)]
                            |i| {
                                planes[i][j][c] = sum_of(
                                    left::<P>(c),
                                    products,
                                    #[inline(always)]
                                    |(lines, matrix), b| (lines[i][b][c], matrix[j][b]),
                                );
                            },
                        );
                    },
                );
            },
        );
        planes
    }

    /// Hands over the sums along axis 2, or what there is where that is missing.
    #[inline(always)]
    fn third<const P: usize, B: BasisFamily<T, D>>(
        &self,
        products: &[(&Planes<V>, &Along<V>)],
        mut put: impl FnMut(usize, V),
    ) {
        unrolled(
            if D > 2 { B::WIDTH } else { 1 },
            #[inline(always)]
            |k| {
                unrolled(
                    B::WIDTH,
                    #[inline(always)]
                    |j| {
                        unrolled(
                            B::WIDTH,
                            #[inline(always)]
                            |i| {
                                let place = i + B::WIDTH * (j + B::WIDTH * k);
                                if const { D == 2 } {
                                    return put(place, products[0].0[i][j][0]);
                                }
                                let sum = sum_of(
                                    P,
                                    products,
                                    #[inline(always)]
                                    |(planes, matrix), c| (planes[i][j][c], matrix[k][c]),
                                );
                                put(place, sum);
                            },
                        );
                    },
                );
            },
        );
    }
}

/// How many powers of one coordinate go with others of which `used` is the sum.
#[inline(always)]
const fn left<const P: usize>(used: usize) -> usize {
    if POWERS - used < P { POWERS - used } else { P }
}

/// The sum over `count` powers and one product or two of what are two factors.
#[inline(always)]
fn sum_of<T, V: Number<T>, A: Copy>(count: usize, products: &[A], factors: impl Fn(A, usize) -> (V, V)) -> V {
    let (first, second) = factors(products[0], 0);
    let mut sum = first * second;
    unrolled(
        count,
        #[inline(always)]
        |power| {
            if power > 0 {
                let (first, second) = factors(products[0], power);
                sum = first.mul_add(second, sum);
            }
        },
    );
    if products.len() > 1 {
        unrolled(
            count,
            #[inline(always)]
            |power| {
                let (first, second) = factors(products[1], power);
                sum = first.mul_add(second, sum);
            },
        );
    }
    sum
}
