//! Small tensor operations that need the dimension spelled out, and principal values.

mod spectral;

pub use spectral::Spectral;
pub(crate) use spectral::is_plain;

use nalgebra::SMatrix;

use crate::scalar::Scalar;

/// Determinant, `D` = 1, 2 or 3 (nalgebra's asks for bounds that a generic `D` cannot state).
#[inline(always)]
pub fn determinant<T: Scalar, const D: usize>(a: &SMatrix<T, D, D>) -> T {
    const { assert!(D >= 1 && D <= 3, "a grid has one, two or three dimensions") };
    match D {
        1 => a[(0, 0)],
        2 => a[(0, 0)] * a[(1, 1)] - a[(0, 1)] * a[(1, 0)],
        _ => {
            let minor = |i: usize, j: usize| a[(1, i)] * a[(2, j)] - a[(1, j)] * a[(2, i)];
            a[(0, 0)] * minor(1, 2) - a[(0, 1)] * minor(0, 2) + a[(0, 2)] * minor(0, 1)
        }
    }
}

/// Symmetric part.
#[inline(always)]
pub fn symmetric<T: Scalar, const D: usize>(a: &SMatrix<T, D, D>) -> SMatrix<T, D, D> {
    (a + a.transpose()) * (T::one() / T::lit(2.0))
}

#[cfg(test)]
mod tests {
    use super::determinant;
    use approx::assert_relative_eq;
    use nalgebra::{Matrix1, matrix};

    #[test]
    fn determinants_agree_with_the_library() {
        let a = matrix![2.0_f64, 1.0, 0.5; -1.0, 3.0, 0.25; 0.1, 0.7, 1.5];
        let b = matrix![2.0_f64, 1.0; -1.0, 3.0];
        assert_relative_eq!(determinant(&a), a.determinant(), max_relative = 1e-15);
        assert_relative_eq!(determinant(&b), 7.0, max_relative = 1e-15);
        assert_eq!(determinant(&Matrix1::new(4.0)), 4.0);
    }
}
