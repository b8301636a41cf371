//! Principal values and axes of a symmetric tensor.

use nalgebra::{SMatrix, SVector};

use crate::scalar::Scalar;
use crate::simd::is;

/// Sweeps after which the iteration ends whatever is left. Convergence is quadratic: a 3 x 3 tensor takes
/// three to five.
const SWEEPS: usize = 12;

/// Sweeps without anything to turn that are made for the derivatives that numbers carry: each squares what is
/// left of them.
const SWEEPS_OF_DERIVATIVES: usize = 2;

/// Principal values and axes of a symmetric tensor, `A = sum_k value_k axis_k axis_k^T`, in no particular
/// order.
///
/// Jacobi's rotations (Golub & Van Loan, *Matrix Computations*, 8.5): in two dimensions a single one is the
/// closed form, in three they are repeated. Equal values are no special case, and of a positive definite
/// tensor even a value much smaller than the others keeps its digits (Demmel & Veselic 1992), as far as the
/// entries determine it.
///
/// # Derivatives
/// Axes have no derivative where two values are equal, but isotropic functions of the tensor have one. So
/// with dual numbers the axes of values that are equal, or nearly so, are turned without derivatives, and
/// what these leave off the diagonal is kept as [`Spectral::rest`]: `A = Q (diag(values) + rest) Q^T` holds
/// with all derivatives. A function of the tensor has `f[value_p, value_q] rest_pq` there, with the divided
/// difference of `f`, which is `f'` for equal values (Daleckii & Krein 1965). First derivatives are right for
/// any values, higher ones where all values differ by more than the cube root of the scalar's epsilon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spectral<T, const D: usize> {
    /// Principal values.
    pub values: SVector<T, D>,
    /// Unit axes, one per column; a rotation.
    pub axes: SMatrix<T, D, D>,
    rest: SMatrix<T, D, D>,
}

/// Whether numbers of this type are no more than their value. Any other may carry derivatives where its value
/// is zero.
#[inline(always)]
pub(crate) fn is_plain<T: 'static>() -> bool {
    is::<T, f64>() || is::<T, f32>()
}

impl<T: Scalar, const D: usize> Spectral<T, D> {
    /// Of the symmetric tensor `a`; only the upper triangle is read.
    #[inline]
    pub fn of(a: &SMatrix<T, D, D>) -> Self {
        if !is_plain::<T>() {
            return Self::with_derivatives(a);
        }
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
        Self {
            values: SVector::from_fn(|i, _| a[(i, i)]),
            axes,
            rest: SMatrix::zeros(),
        }
    }

    /// The same for numbers that may be more than their value.
    #[inline(never)]
    fn with_derivatives(a: &SMatrix<T, D, D>) -> Self {
        let (mut a, mut axes) = (*a, SMatrix::identity());
        let mut still = 0;
        for _ in 0..SWEEPS {
            let mut turned = false;
            for p in 0..D {
                for q in p + 1..D {
                    turned |= annihilate_with_derivatives(&mut a, &mut axes, p, q);
                }
            }
            still = if turned { 0 } else { still + 1 };
            if still > SWEEPS_OF_DERIVATIVES {
                break;
            }
        }
        Self {
            values: SVector::from_fn(|i, _| a[(i, i)]),
            axes,
            rest: SMatrix::from_fn(|i, j| {
                if i == j {
                    T::zero()
                } else {
                    a[(i.min(j), i.max(j))]
                }
            }),
        }
    }

    /// What is left off the diagonal in the principal axes, symmetric: zeros, but for the derivatives that
    /// numbers carry.
    #[inline(always)]
    pub fn rest(&self) -> &SMatrix<T, D, D> {
        &self.rest
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

    /// The same with the given entries off the diagonal in those axes, `rest(p, q)` for `p < q`; plain
    /// numbers have none.
    #[inline]
    pub fn with_values_and_rest(
        &self,
        values: &SVector<T, D>,
        mut rest: impl FnMut(usize, usize) -> T,
    ) -> SMatrix<T, D, D> {
        let mut tensor = self.with_values(values);
        if is_plain::<T>() {
            return tensor;
        }
        for p in 0..D {
            for q in p + 1..D {
                let (x, y) = (self.axes.column(p), self.axes.column(q));
                tensor += (x * y.transpose() + y * x.transpose()) * rest(p, q);
            }
        }
        tensor
    }

    /// The isotropic tensor function that applies `f` to each principal value.
    ///
    /// The divided difference of values that are nearly equal is that over what is left between them, about
    /// their mean.
    #[inline]
    pub fn map(&self, mut f: impl FnMut(T) -> T) -> SMatrix<T, D, D> {
        let values = self.values.map(&mut f);
        self.with_values_and_rest(&values, |p, q| {
            let two = T::lit(2.0);
            let (mean, rest) = ((self.values[p] + self.values[q]) / two, self.rest[(p, q)]);
            (f(mean + rest) - f(mean - rest)) / two
        })
    }
}

/// Whether `a_pq` is round-off, relative to both values, so that the smaller keeps its digits.
#[inline(always)]
fn is_negligible<T: Scalar>(app: T, aqq: T, apq: T) -> bool {
    let small = T::default_epsilon() / T::lit(4.0);
    apq.is_zero() || apq.abs() <= small * (app.abs().sqrt() * aqq.abs().sqrt())
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
    if is_negligible(app, aqq, apq) {
        a[(p, q)] = T::zero();
        return false;
    }
    let cotangent = (aqq - app) / (apq + apq);
    let size = T::one() / (cotangent.abs() + (T::one() + cotangent * cotangent).sqrt());
    let tangent = if cotangent < T::zero() { -size } else { size };
    a[(p, p)] = app - tangent * apq;
    a[(q, q)] = aqq + tangent * apq;
    a[(p, q)] = T::zero();
    turn(a, axes, (p, q), tangent);
    true
}

/// The same for numbers that may be more than their value. A rotation that takes derivatives with it has one
/// over the difference of the values in them, so between nearly equal values the rotation is one of plain
/// numbers, and `a_pq` keeps what that leaves.
fn annihilate_with_derivatives<T: Scalar, const D: usize>(
    a: &mut SMatrix<T, D, D>,
    axes: &mut SMatrix<T, D, D>,
    p: usize,
    q: usize,
) -> bool {
    let (app, aqq, apq) = (a[(p, p)], a[(q, q)], a[(p, q)]);
    let (difference, twice) = (aqq - app, apq + apq);
    let negligible = is_negligible(app, aqq, apq);
    let close = T::default_epsilon().cbrt() * (app.abs() + aqq.abs());
    let alike = difference.abs().max(twice.abs()) <= close;
    let tangent = match (negligible, alike) {
        (true, true) => return false,
        // Its value is zero or next to it.
        (true, false) => twice / (difference + signed_root(difference, twice)),
        (false, _) => {
            let cotangent = difference / twice;
            T::one() / (cotangent + signed_root(cotangent, T::one()))
        }
    };
    let tangent = if alike { T::lit(tangent.primal()) } else { tangent };
    let cosine_squared = T::one() / (T::one() + tangent * tangent);
    let both = tangent * cosine_squared;
    let sine_squared = tangent * both;
    a[(p, p)] = cosine_squared * app - both * twice + sine_squared * aqq;
    a[(q, q)] = sine_squared * app + both * twice + cosine_squared * aqq;
    a[(p, q)] = (cosine_squared - sine_squared) * apq - both * difference;
    turn(a, axes, (p, q), tangent);
    !negligible
}

/// `sqrt(x^2 + y^2)` with the sign of `x`, positive for zero.
fn signed_root<T: Scalar>(x: T, y: T) -> T {
    let root = (x * x + y * y).sqrt();
    if x < T::zero() { -root } else { root }
}

/// Turns the other entries of the upper triangle, and the axes.
#[inline(always)]
fn turn<T: Scalar, const D: usize>(
    a: &mut SMatrix<T, D, D>,
    axes: &mut SMatrix<T, D, D>,
    (p, q): (usize, usize),
    tangent: T,
) {
    let cosine = T::one() / (T::one() + tangent * tangent).sqrt();
    let sine = tangent * cosine;
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
}
