//! What can be reconstructed and summed: [`Field`].

use std::ops::Add;

use nalgebra::{SMatrix, SVector};
use num_traits::Zero;

use crate::scalar::Scalar;

/// A quantity that particles carry and that can be added and scaled: a scalar, a vector, a tensor,
/// or several of them fitted in one pass ([`MassMomentum`]).
pub trait Field<T>: Copy + Zero + Send + Sync {
    /// `self += weight * other`.
    fn add_scaled(&mut self, weight: T, other: Self);

    /// Number of scalars in it.
    const COMPONENTS: usize;

    /// Which of its scalars, the `i`-th as bit `i`, are densities of something that is nowhere negative
    /// (mass). Conservative reconstructions keep them positive where they stream them.
    const DENSITIES: u32 = 0;

    /// Its `i`-th scalar, `i < COMPONENTS`.
    fn component(&self, i: usize) -> T;

    /// Sets its `i`-th scalar, `i < COMPONENTS`.
    fn set_component(&mut self, i: usize, value: T);

    /// `weight * self`.
    #[inline(always)]
    fn scaled(self, weight: T) -> Self {
        let mut result = Self::zero();
        result.add_scaled(weight, self);
        result
    }
}

impl<T: Scalar> Field<T> for T {
    const COMPONENTS: usize = 1;

    #[inline(always)]
    fn component(&self, _i: usize) -> T {
        *self
    }

    #[inline(always)]
    fn set_component(&mut self, _i: usize, value: T) {
        *self = value;
    }

    #[inline(always)]
    fn add_scaled(&mut self, weight: T, other: Self) {
        *self += weight * other;
    }
}

impl<T: Scalar, const R: usize, const C: usize> Field<T> for SMatrix<T, R, C> {
    const COMPONENTS: usize = R * C;

    #[inline(always)]
    fn component(&self, i: usize) -> T {
        self[i]
    }

    #[inline(always)]
    fn set_component(&mut self, i: usize, value: T) {
        self[i] = value;
    }

    #[inline(always)]
    fn add_scaled(&mut self, weight: T, other: Self) {
        *self += other * weight;
    }
}

/// A symmetric tensor as a field: the entries on the diagonal and those above it, no other is fitted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Symmetric<T: Scalar, const D: usize>(pub SMatrix<T, D, D>);

/// Number of the component at `(row, column)` of a symmetric tensor: the diagonal first, then the rows above
/// it.
#[inline(always)]
pub(crate) const fn symmetric_component<const D: usize>(row: usize, column: usize) -> usize {
    if row == column {
        row
    } else if const { D == 3 } {
        row + column + 2
    } else {
        D
    }
}

/// The place of a component.
#[inline(always)]
pub(crate) const fn symmetric_place<const D: usize>(component: usize) -> (usize, usize) {
    match (component < D, component - if component < D { 0 } else { D }) {
        (true, axis) => (axis, axis),
        (false, 0) => (0, 1),
        (false, 1) => (0, 2),
        (false, _) => (1, 2),
    }
}

impl<T: Scalar, const D: usize> Add for Symmetric<T, D> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self(self.0 + other.0)
    }
}

impl<T: Scalar, const D: usize> Zero for Symmetric<T, D> {
    #[inline(always)]
    fn zero() -> Self {
        Self(SMatrix::zeros())
    }

    fn is_zero(&self) -> bool {
        self.0.is_zero()
    }
}

impl<T: Scalar, const D: usize> Field<T> for Symmetric<T, D> {
    const COMPONENTS: usize = D * (D + 1) / 2;

    #[inline(always)]
    fn component(&self, i: usize) -> T {
        self.0[symmetric_place::<D>(i)]
    }

    #[inline(always)]
    fn set_component(&mut self, i: usize, value: T) {
        let (row, column) = symmetric_place::<D>(i);
        self.0[(row, column)] = value;
        self.0[(column, row)] = value;
    }

    #[inline(always)]
    fn add_scaled(&mut self, weight: T, other: Self) {
        self.0 += other.0 * weight;
    }
}

/// Two fields mapped together: one pass, one fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair<A, B>(pub A, pub B);

impl<A: Add<Output = A>, B: Add<Output = B>> Add for Pair<A, B> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self(self.0 + other.0, self.1 + other.1)
    }
}

impl<A: Zero, B: Zero> Zero for Pair<A, B> {
    #[inline(always)]
    fn zero() -> Self {
        Self(A::zero(), B::zero())
    }

    fn is_zero(&self) -> bool {
        self.0.is_zero() && self.1.is_zero()
    }
}

impl<T, A: Field<T>, B: Field<T>> Field<T> for Pair<A, B>
where
    T: Copy,
{
    const COMPONENTS: usize = A::COMPONENTS + B::COMPONENTS;
    const DENSITIES: u32 = A::DENSITIES | B::DENSITIES << A::COMPONENTS;

    #[inline(always)]
    fn component(&self, i: usize) -> T {
        if i < A::COMPONENTS {
            self.0.component(i)
        } else {
            self.1.component(i - A::COMPONENTS)
        }
    }

    #[inline(always)]
    fn set_component(&mut self, i: usize, value: T) {
        if i < A::COMPONENTS {
            self.0.set_component(i, value);
        } else {
            self.1.set_component(i - A::COMPONENTS, value);
        }
    }

    #[inline(always)]
    fn add_scaled(&mut self, weight: T, other: Self) {
        self.0.add_scaled(weight, other.0);
        self.1.add_scaled(weight, other.1);
    }
}

/// Mass and linear momentum, or their densities, mapped together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MassMomentum<T, const D: usize> {
    /// Mass (kg), or mass density where a density is mapped.
    pub mass: T,
    /// Linear momentum (kg m/s), or its density.
    pub momentum: SVector<T, D>,
}

impl<T: Scalar, const D: usize> Add for MassMomentum<T, D> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self {
            mass: self.mass + other.mass,
            momentum: self.momentum + other.momentum,
        }
    }
}

impl<T: Scalar, const D: usize> Zero for MassMomentum<T, D> {
    #[inline(always)]
    fn zero() -> Self {
        Self {
            mass: T::zero(),
            momentum: SVector::zeros(),
        }
    }

    fn is_zero(&self) -> bool {
        self.mass.is_zero() && self.momentum.is_zero()
    }
}

impl<T: Scalar, const D: usize> Field<T> for MassMomentum<T, D> {
    const COMPONENTS: usize = 1 + D;
    const DENSITIES: u32 = 1;

    #[inline(always)]
    fn component(&self, i: usize) -> T {
        if i == 0 { self.mass } else { self.momentum[i - 1] }
    }

    #[inline(always)]
    fn set_component(&mut self, i: usize, value: T) {
        if i == 0 {
            self.mass = value;
        } else {
            self.momentum[i - 1] = value;
        }
    }

    #[inline(always)]
    fn add_scaled(&mut self, weight: T, other: Self) {
        self.mass += weight * other.mass;
        self.momentum += other.momentum * weight;
    }
}
