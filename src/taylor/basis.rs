//! The Taylor basis functions.

use nalgebra::SVector;

use crate::scalar::Scalar;

/// The `NB` Taylor functions at the local coordinates `s` (each in `[-1, 1]` inside the cell), in the order
/// 1; s, t, r; s^2/2 - 1/6, ...; s t, s r, t r.
///
/// `NB` is 3, 6 or 10 (quadratic in 1, 2, 3 dimensions) or `D + 1` (linear); anything else does not compile.
///
/// ```compile_fail
/// # use nalgebra::vector;
/// materialpoint::taylor::taylor_functions::<f64, 2, 5>(&vector![0.1, 0.2]);
/// ```
#[inline(always)]
pub fn taylor_functions<T: Scalar, const D: usize, const NB: usize>(s: &SVector<T, D>) -> SVector<T, NB> {
    const {
        assert!(
            NB == D + 1 || NB == (D + 1) * (D + 2) / 2,
            "the Taylor basis has 3, 6 or 10 functions in 1, 2 or 3 dimensions, or D + 1 if linear"
        )
    };
    let (two, six) = (T::lit(2.0), T::lit(6.0));
    let mut psi = SVector::repeat(T::one());
    for a in 0..D {
        psi[1 + a] = s[a];
    }
    if NB > D + 1 {
        for a in 0..D {
            psi[1 + D + a] = s[a] * s[a] / two - T::one() / six;
        }
        let mut k = 1 + 2 * D;
        for a in 0..D {
            for b in a + 1..D {
                psi[k] = s[a] * s[b];
                k += 1;
            }
        }
    }
    psi
}

/// Root mean square of each Taylor function over the cell, in the same order: 1; 1/sqrt 3; 1/sqrt 45; 1/3.
pub(super) fn taylor_sizes<T: Scalar, const D: usize, const NB: usize>() -> SVector<T, NB> {
    SVector::from_fn(|k, _| {
        let square = match k {
            0 => 1.0,
            _ if k <= D => 3.0,
            _ if k <= 2 * D => 45.0,
            _ => 9.0,
        };
        T::one() / T::lit(square).sqrt()
    })
}
