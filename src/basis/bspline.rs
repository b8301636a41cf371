//! B-splines on open uniform knots.

use super::tensor::{AxisBasis, AxisCell, Functions};
use crate::scalar::Scalar;
use crate::simd::{Lanes, Number, each, inlined};

/// B-splines of degree $P$ on an open uniform knot vector $\xi$ (Cox-de Boor; Steffen, Kirby & Berzins 2008,
/// journal section 4): `cells + P` DOFs along an axis, the first and last of which interpolate.
///
/// $$\phi_{i,l}(x) = \frac{x-\xi_i}{\xi_{i+l}-\xi_i}\phi_{i,l-1}(x) +
/// \frac{\xi_{i+l+1}-x}{\xi_{i+l+1}-\xi_{i+1}}\phi_{i+1,l-1}(x),\qquad \phi_{i,0} = 1 \text{ in span } i.$$
///
/// Degrees 1, 2 and 3 are implemented; degree 1 equals [`super::Linear`].
#[doc = include_str!("../../docs/formulas.html")]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BSpline<const P: usize>;

/// The `W = P + 1` functions of a cell by de Boor's triangle; `left[j]` and `right[j]` are the distances to
/// the `j`-th knot on either side, `inverse_width(j, r)` is one over the width of the `r`-th support of
/// degree `j - 1`.
#[inline(always)]
fn triangle<T: Scalar, const W: usize>(
    left: &[T; W],
    right: &[T; W],
    inverse_width: impl Fn(usize, usize) -> T,
) -> ([T; W], [T; W]) {
    let degree = W - 1;
    let mut value = [T::zero(); W];
    let mut slope = [T::zero(); W];
    value[0] = T::one();
    for j in 1..W {
        let mut carried = T::zero();
        for r in 0..j {
            let part = value[r] * inverse_width(j, r);
            value[r] = carried + right[r] * part;
            carried = left[j - 1 - r] * part;
            if j == degree {
                slope[r] -= T::count(degree) * part;
                slope[r + 1] += T::count(degree) * part;
            }
        }
        value[j] = carried;
    }
    (value, slope)
}

/// Functions of a cell that sees the repeated knots at an end of the axis.
#[inline(never)]
fn outer<T: Scalar, const W: usize>(cells: usize, cell: usize, unit: T) -> ([T; W], [T; W]) {
    let below = |j: usize| cell.min(j);
    let above = |j: usize| (cells - cell).min(j + 1);
    let left = std::array::from_fn(|j| unit + T::count(below(j)));
    let right = std::array::from_fn(|j| T::count(above(j)) - unit);
    triangle(&left, &right, |j, r| {
        T::one() / T::count(above(r) + below(j - 1 - r))
    })
}

#[inline(always)]
fn all_knots_distinct(degree: usize, cells: usize, cell: usize) -> bool {
    cell + 1 >= degree && cell + degree <= cells
}

/// Functions of a cell whose knots are all distinct, written out: the quadratic ones take a third of the
/// triangle's operations.
#[inline(always)]
fn inner<T: Scalar, K: Lanes<T>, const W: usize>(k: K, unit: K::V) -> Functions<K::V, W> {
    let number = inlined(
        #[inline(always)]
        |n: f64| k.splat(T::lit(n)),
    );
    let (zero, one) = (number(0.0), number(1.0));
    let rest = one - unit;
    let half = k.splat(T::one() / T::lit(2.0));
    let sixth = k.splat(T::one() / T::lit(6.0));
    // Of the cubics at a distance d <= 1 from their middle: 2/3 - d^2 + d^3/2.
    let near = inlined(
        #[inline(always)]
        |d: K::V| (d * half - one).mul_add(d * d, number(4.0) * sixth),
    );
    let near_slope = inlined(
        #[inline(always)]
        |d: K::V| (d * number(3.0) * half - number(2.0)) * d,
    );
    let [a, b] = [half * rest * rest, half * unit * unit];
    let (value, slope) = match W {
        2 => ([rest, unit, zero, zero], [zero - one, one, zero, zero]),
        3 => (
            [a, unit.mul_add(rest, half), b, zero],
            [zero - rest, rest - unit, unit, zero],
        ),
        _ => (
            [
                sixth * rest * rest * rest,
                near(unit),
                near(rest),
                sixth * unit * unit * unit,
            ],
            [zero - a, near_slope(unit), zero - near_slope(rest), b],
        ),
    };
    Functions {
        value: each(
            #[inline(always)]
            |k| value[k],
        ),
        slope: each(
            #[inline(always)]
            |k| slope[k],
        ),
    }
}

/// The same of a cell near an end, point by point. Out of the way of the cells that need it not.
#[inline(never)]
fn near_end<T: Scalar, K: Lanes<T>, const W: usize>(k: K, at: AxisCell, unit: K::V) -> Functions<K::V, W> {
    let [value, slope] = k.one_by_one(unit, |unit| {
        let (value, slope) = outer(at.cells, at.cell, unit);
        [value, slope]
    });
    Functions { value, slope }
}

macro_rules! degree {
    ($degree:literal, $width:literal) => {
        impl<T: Scalar> AxisBasis<T, $width> for BSpline<$degree> {
            fn dofs_on_axis(&self, cells: usize) -> usize {
                cells + $degree
            }

            /// The Greville abscissa: the mean of the function's inner knots.
            fn interpolation_point(&self, cells: usize, dof: usize) -> T {
                let knots = (dof + 1..=dof + $degree).map(|k| k.saturating_sub($degree).min(cells));
                T::count(knots.sum()) / T::count($degree)
            }

            #[inline(always)]
            fn evaluate<K: Lanes<T>>(&self, k: K, at: AxisCell, unit: K::V) -> Functions<K::V, $width> {
                if all_knots_distinct($degree, at.cells, at.cell) {
                    inner(k, unit)
                } else {
                    near_end(k, at, unit)
                }
            }
        }

        crate::tensor_product_family!(BSpline<$degree>, width = $width, degree = $degree);
    };
}

degree!(1, 2);
degree!(2, 3);
degree!(3, 4);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::{One, Packs, Plain};

    /// Cox-de Boor as printed (journal section 4), on explicit knots: an independent evaluation.
    fn printed(knots: &[f64], i: usize, l: usize, x: f64) -> f64 {
        if l == 0 {
            return f64::from(u8::from(knots[i] <= x && x < knots[i + 1]));
        }
        let part = |a: f64, width: f64, lower: f64| if width > 0.0 { a / width * lower } else { 0.0 };
        part(x - knots[i], knots[i + l] - knots[i], printed(knots, i, l - 1, x))
            + part(
                knots[i + l + 1] - x,
                knots[i + l + 1] - knots[i + 1],
                printed(knots, i + 1, l - 1, x),
            )
    }

    fn compare<const P: usize, const W: usize>(cells: usize)
    where
        BSpline<P>: AxisBasis<f64, W>,
    {
        let knots: Vec<f64> = (0..=cells + 2 * P)
            .map(|k| k.saturating_sub(P).min(cells) as f64)
            .collect();
        for cell in 0..cells {
            for unit in [0.0, 0.125, 0.5, 0.93] {
                let found = BSpline::<P>.evaluate(One, AxisCell { cells, cell }, unit);
                for k in 0..W {
                    let exact = printed(&knots, cell + k, P, cell as f64 + unit);
                    assert!(
                        (found.value[k] - exact).abs() < 1e-15,
                        "{cells} {cell} {unit} {k}"
                    );
                }
            }
        }
    }

    fn compare_packs<const P: usize, const W: usize>(cells: usize)
    where
        BSpline<P>: AxisBasis<f64, W>,
    {
        let units = [0.0, 0.125, 0.5, 0.93];
        for cell in 0..cells {
            let at = AxisCell { cells, cell };
            let four = BSpline::<P>.evaluate(Plain, at, Plain.pack(units));
            for l in 0..4 {
                let one = BSpline::<P>.evaluate(One, at, units[l]);
                for k in 0..W {
                    assert!((one.value[k] - four.value[k].0[l]).abs() < 1e-15);
                    assert!((one.slope[k] - four.slope[k].0[l]).abs() < 1e-15);
                }
            }
        }
    }

    #[test]
    fn four_points_at_once_see_what_each_sees() {
        for cells in 1..9 {
            compare_packs::<1, 2>(cells);
            compare_packs::<2, 3>(cells);
            compare_packs::<3, 4>(cells);
        }
    }

    #[test]
    fn values_follow_the_printed_recursion_on_few_and_many_cells() {
        for cells in 1..9 {
            compare::<1, 2>(cells);
            compare::<2, 3>(cells);
            compare::<3, 4>(cells);
        }
    }
}
