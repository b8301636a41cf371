//! Taylor functions of one cell in the coordinates of its neighbour.

use crate::field::Field;
use crate::scalar::Scalar;
use crate::simd::{Lanes, Number};

/// Turns sums of `psi(s) q` into sums of `psi(s + 2 e_axis) q` (`up`) or of `psi(s - 2 e_axis) q`: from a
/// cell's own local coordinates to those of its neighbour below or above along `axis`. The functions span the
/// polynomials of their degree, so no point need be visited again.
#[inline(always)]
pub(crate) fn shift_sums<T: Scalar, const D: usize, const NB: usize, Q: Field<T>>(
    sums: &mut [Q; NB],
    axis: usize,
    up: bool,
) {
    let two = if up { T::lit(2.0) } else { -T::lit(2.0) };
    if NB > D + 1 {
        // (s + 2)^2/2 - 1/6 = (s^2/2 - 1/6) + 2 s + 2, with the s of before.
        let (constant, linear) = (sums[0], sums[1 + axis]);
        sums[1 + D + axis].add_scaled(two, linear);
        sums[1 + D + axis].add_scaled(T::lit(2.0), constant);
        let mut k = 1 + 2 * D;
        for a in 0..D {
            for b in a + 1..D {
                if a == axis || b == axis {
                    let other = sums[1 + a + b - axis];
                    sums[k].add_scaled(two, other);
                }
                k += 1;
            }
        }
    }
    let constant = sums[0];
    sums[1 + axis].add_scaled(two, constant);
}

/// The same for four cells at once and rows of any length, of which the first `columns` count.
#[inline(always)]
pub(crate) fn shift_lanes<T: Scalar, K: Lanes<T>, const D: usize, const NB: usize, const N: usize>(
    k: K,
    rows: &mut [[K::V; N]; NB],
    columns: usize,
    axis: usize,
    up: bool,
) {
    let two = k.splat(T::lit(2.0));
    let step = if up { two } else { k.splat(-T::lit(2.0)) };
    for q in 0..columns {
        let constant = rows[0][q];
        if NB > D + 1 {
            let square = step.mul_add(rows[1 + axis][q], rows[1 + D + axis][q]);
            rows[1 + D + axis][q] = two.mul_add(constant, square);
            let mut n = 1 + 2 * D;
            for a in 0..D {
                for b in a + 1..D {
                    if a == axis || b == axis {
                        rows[n][q] = step.mul_add(rows[1 + a + b - axis][q], rows[n][q]);
                    }
                    n += 1;
                }
            }
        }
        rows[1 + axis][q] = step.mul_add(constant, rows[1 + axis][q]);
    }
}

#[cfg(test)]
mod tests {
    use super::super::taylor_functions;
    use super::*;
    use crate::simd::{Four, Plain};
    use approx::assert_relative_eq;
    use nalgebra::{SVector, vector};

    fn check<const D: usize, const NB: usize>(s: SVector<f64, D>) {
        for axis in 0..D {
            for (up, step) in [(true, 2.0), (false, -2.0)] {
                let mut shifted = s;
                shifted[axis] += step;
                let expected = taylor_functions::<f64, D, NB>(&shifted);
                let mut found: [f64; NB] = taylor_functions::<f64, D, NB>(&s).into();
                shift_sums::<f64, D, NB, f64>(&mut found, axis, up);
                let mut rows = taylor_functions::<f64, D, NB>(&s).data.0[0].map(|psi| [Four([psi; 4])]);
                shift_lanes::<f64, Plain, D, NB, 1>(Plain, &mut rows, 1, axis, up);
                for k in 0..NB {
                    assert_relative_eq!(found[k], expected[k], epsilon = 1e-14);
                    assert_relative_eq!(rows[k][0].0[3], expected[k], epsilon = 1e-14);
                }
            }
        }
    }

    #[test]
    fn functions_of_a_neighbour_are_sums_of_ones_own() {
        check::<1, 3>(vector![0.3]);
        check::<1, 2>(vector![0.3]);
        check::<2, 6>(vector![0.3, -0.7]);
        check::<2, 3>(vector![0.3, -0.7]);
        check::<3, 10>(vector![0.3, -0.7, 0.9]);
        check::<3, 4>(vector![0.3, -0.7, 0.9]);
    }
}
