//! B-splines on open uniform knots.

use super::tensor::{AxisFamily, Row, one_by_one};
use crate::lanes::SideBySide;
use crate::scalar::Scalar;

/// B-splines of degree $P$ on an open uniform knot vector $\xi$ (Cox-de Boor; Steffen, Kirby & Berzins 2008, journal section
/// 4): `cells + P` DOFs along an axis, the first and last of which interpolate.
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

/// Functions of a cell whose knots are all distinct. The quadratic ones are written out: a third of the triangle's operations.
#[inline(always)]
fn inner<T: Scalar, const W: usize>(unit: T) -> ([T; W], [T; W]) {
    if W == 3 {
        let (half, rest) = (T::one() / T::lit(2.0), T::one() - unit);
        let value = [half * rest * rest, half + unit * rest, half * unit * unit];
        let slope = [-rest, rest - unit, unit];
        return (
            std::array::from_fn(|k| value[k]),
            std::array::from_fn(|k| slope[k]),
        );
    }
    let left = std::array::from_fn(|j| unit + T::count(j));
    let right = std::array::from_fn(|j| T::count(j + 1) - unit);
    triangle(&left, &right, |j, _| T::one() / T::count(j))
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

/// The functions of [`inner`] at several points, written out.
#[inline(always)]
fn inner_lanes<T: Scalar, V: SideBySide<T>, const W: usize>(unit: V) -> ([V; W], [V; W]) {
    let number = |n: f64| V::splat(T::lit(n));
    let (zero, one) = (number(0.0), number(1.0));
    let rest = one - unit;
    let half = V::splat(T::one() / T::lit(2.0));
    let sixth = V::splat(T::one() / T::lit(6.0));
    // Of the cubics at a distance d <= 1 from their middle: 2/3 - d^2 + d^3/2.
    let near = |d: V| (d * half - one).mul_add(d * d, number(4.0) * sixth);
    let near_slope = |d: V| (d * number(3.0) * half - number(2.0)) * d;
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
    (
        std::array::from_fn(|k| value[k]),
        std::array::from_fn(|k| slope[k]),
    )
}

macro_rules! degree {
    ($degree:literal, $width:literal) => {
        impl<T: Scalar> AxisFamily<T, $width> for BSpline<$degree> {
            fn dofs_on_axis(&self, cells: usize) -> usize {
                cells + $degree
            }

            /// The Greville abscissa: the mean of the function's inner knots.
            fn interpolation_point(&self, cells: usize, dof: usize) -> T {
                let knots = (dof + 1..=dof + $degree).map(|k| k.saturating_sub($degree).min(cells));
                T::count(knots.sum()) / T::count($degree)
            }

            #[inline(always)]
            fn row(&self, cells: usize, cell: usize, unit: T) -> Row<T, $width> {
                let (value, slope) = if all_knots_distinct($degree, cells, cell) {
                    inner(unit)
                } else {
                    outer(cells, cell, unit)
                };
                Row {
                    dof: std::array::from_fn(|k| cell + k),
                    value,
                    slope,
                }
            }

            const UNIFORM: bool = true;

            #[inline(always)]
            fn lanes<V: SideBySide<T>>(
                &self,
                cells: usize,
                cell: usize,
                unit: V,
            ) -> ([V; $width], [V; $width]) {
                if all_knots_distinct($degree, cells, cell) {
                    inner_lanes(unit)
                } else {
                    one_by_one(self, cells, cell, unit)
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
        BSpline<P>: AxisFamily<f64, W>,
    {
        let knots: Vec<f64> = (0..=cells + 2 * P)
            .map(|k| k.saturating_sub(P).min(cells) as f64)
            .collect();
        for cell in 0..cells {
            for unit in [0.0, 0.125, 0.5, 0.93] {
                let row = BSpline::<P>.row(cells, cell, unit);
                for k in 0..W {
                    let exact = printed(&knots, row.dof[k], P, cell as f64 + unit);
                    assert!((row.value[k] - exact).abs() < 1e-15, "{cells} {cell} {unit} {k}");
                }
            }
        }
    }

    fn compare_lanes<const P: usize, const W: usize>(cells: usize)
    where
        BSpline<P>: AxisFamily<f64, W>,
    {
        let units = [0.0, 0.125, 0.5, 0.93];
        for cell in 0..cells {
            let (values, slopes) = BSpline::<P>.lanes(cells, cell, wide::f64x4::new(units));
            for l in 0..4 {
                let row = BSpline::<P>.row(cells, cell, units[l]);
                for k in 0..W {
                    assert!((row.value[k] - values[k].to_array()[l]).abs() < 1e-15);
                    assert!((row.slope[k] - slopes[k].to_array()[l]).abs() < 1e-15);
                }
            }
        }
    }

    #[test]
    fn four_points_at_once_see_what_each_sees() {
        for cells in 1..9 {
            compare_lanes::<1, 2>(cells);
            compare_lanes::<2, 3>(cells);
            compare_lanes::<3, 4>(cells);
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
