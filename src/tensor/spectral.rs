//! Principal values and axes of a symmetric tensor.

use nalgebra::{SMatrix, SVector};

use crate::scalar::Scalar;

/// Sweeps after which the iteration ends whatever is left. Convergence is quadratic: a 3 x 3 tensor takes three to five.
const SWEEPS: usize = 12;

/// Principal values and axes of a symmetric tensor, `A = sum_k value_k axis_k axis_k^T`, in no particular order.
///
/// Jacobi's rotations (Golub & Van Loan, *Matrix Computations*, 8.5): in two dimensions a single one is the closed form, in three
/// they are repeated. Equal values are no special case, and of a positive definite tensor even a value much smaller than the
/// others keeps its digits (Demmel & Veselic 1992), as far as the entries determine it. Of dual numbers, derivatives are lost
/// where two values are equal, since the axes then have none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spectral<T, const D: usize> {
    /// Principal values.
    pub values: SVector<T, D>,
    /// Unit axes, one per column; a rotation.
    pub axes: SMatrix<T, D, D>,
}

impl<T: Scalar, const D: usize> Spectral<T, D> {
    /// Of the symmetric tensor `a`; only the upper triangle is read.
    #[inline]
    pub fn of(a: &SMatrix<T, D, D>) -> Self {
        let (mut a, mut axes) = (*a, SMatrix::identity());
        for _ in 0..SWEEPS {
            let mut turned = false;
            for p in 0..D {
                for q in p + 1..D {
                    turned |= annihilate(&mut a, &mut axes, p, q);
                }
            }
            // A single pair is done after one rotation.
            if D < 3 || !turned {
                break;
            }
        }
        let values = SVector::from_fn(|i, _| a[(i, i)]);
        Self { values, axes }
    }

    /// The tensor with the same axes and the given principal values.
    #[inline]
    pub fn with_values(&self, values: &SVector<T, D>) -> SMatrix<T, D, D> {
        let mut scaled = self.axes;
        for k in 0..D {
            for i in 0..D {
                scaled[(i, k)] *= values[k];
            }
        }
        let a = scaled * self.axes.transpose();
        // Exactly symmetric, which the product of rounded numbers is not.
        SMatrix::from_fn(|i, j| a[(i.min(j), i.max(j))])
    }

    /// The isotropic tensor function that applies `f` to each principal value.
    #[inline]
    pub fn map(&self, f: impl FnMut(T) -> T) -> SMatrix<T, D, D> {
        self.with_values(&self.values.map(f))
    }
}

/// Rotates axes `p < q` such that `a_pq` vanishes; whether there was anything to do.
#[inline(always)]
fn annihilate<T: Scalar, const D: usize>(
    a: &mut SMatrix<T, D, D>,
    axes: &mut SMatrix<T, D, D>,
    p: usize,
    q: usize,
) -> bool {
    let (app, aqq, apq) = (a[(p, p)], a[(q, q)], a[(p, q)]);
    let small = T::default_epsilon() / T::lit(4.0);
    // Relative to both values, so that the smaller keeps its digits.
    if apq.is_zero() || apq.abs() <= small * (app.abs().sqrt() * aqq.abs().sqrt()) {
        a[(p, q)] = T::zero();
        return false;
    }
    let cotangent = (aqq - app) / (apq + apq);
    let size = T::one() / (cotangent.abs() + (T::one() + cotangent * cotangent).sqrt());
    let tangent = if cotangent < T::zero() { -size } else { size };
    let cosine = T::one() / (T::one() + tangent * tangent).sqrt();
    let sine = tangent * cosine;
    a[(p, p)] = app - tangent * apq;
    a[(q, q)] = aqq + tangent * apq;
    a[(p, q)] = T::zero();
    for r in 0..D {
        if r != p && r != q {
            let (at_p, at_q) = ((r.min(p), r.max(p)), (r.min(q), r.max(q)));
            let (arp, arq) = (a[at_p], a[at_q]);
            a[at_p] = cosine * arp - sine * arq;
            a[at_q] = sine * arp + cosine * arq;
        }
        let (xp, xq) = (axes[(r, p)], axes[(r, q)]);
        axes[(r, p)] = cosine * xp - sine * xq;
        axes[(r, q)] = sine * xp + cosine * xq;
    }
    true
}
