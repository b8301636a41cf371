//! Terms of the series of the inverse of the particles' consistent matrix.
//!
//! With the row sums $L$ of the matrix $M$, the lumped masses of the DOFs,
//! $N_k = \sum_{j \lt k} (1 - L^{-1} M)^j L^{-1}$ is $L^{-1}$ for one term and $M^{-1}$ for many. It is
//! symmetric whatever `k`, so that a step by it keeps the balance of energy, and of momentum because
//! $L^{-1} M 1 = 1$. Functions that few particles see get `k` times what the lumped mass gives them, where
//! the inverse has no bound: nothing has to be tied or lumped, and nothing is iterated to a tolerance.

use super::acceleration::Walls;
use super::deflation::Deflation;
use super::dofs::Dofs;
use super::matrix::Unknown;
use crate::scalar::Scalar;

/// What the terms are summed in, one component after the other.
#[derive(Clone, Debug)]
pub(super) struct Series<T, const D: usize> {
    right: Vec<T>,
    sum: Vec<T>,
    product: Vec<T>,
    /// What held DOFs are told.
    told: Vec<Option<T>>,
    pub(super) deflation: Deflation<T, D>,
}

impl<T: Scalar, const D: usize> Series<T, D> {
    /// For so many DOFs.
    pub(super) fn new(dofs: usize) -> Self {
        Self {
            right: vec![T::zero(); dofs],
            sum: vec![T::zero(); dofs],
            product: vec![T::zero(); dofs],
            told: vec![None; dofs],
            deflation: Deflation::new(dofs),
        }
    }

    pub(super) fn bytes(&self) -> usize {
        size_of::<Self>()
            + size_of::<T>() * 3 * self.sum.len()
            + size_of::<Option<T>>() * self.told.len()
            + self.deflation.bytes()
    }

    /// Held DOFs keep what they are told in every term.
    fn hold(&mut self) {
        for (sum, told) in self.sum.iter_mut().zip(&self.told) {
            *sum = told.unwrap_or(*sum);
        }
    }
}

impl<T: Scalar, const D: usize> Dofs<T, D> {
    /// Replaces forces by accelerations or momenta by velocities: `terms` of the series, and linear functions
    /// of free bodies as the matrix has them. `pick` says which of the told velocity and acceleration counts.
    #[inline(never)]
    pub(super) fn sum_series(
        &mut self,
        unknown: Unknown,
        terms: u8,
        walls: &Walls<'_, T, D>,
        pick: &dyn Fn(T, T) -> T,
    ) {
        let Self {
            mass,
            force,
            velocity,
            matrix,
            series,
            ..
        } = self;
        let Some(series) = series.as_deref_mut() else {
            return;
        };
        let right = match unknown {
            Unknown::Acceleration => force,
            Unknown::Velocity => velocity,
        };
        if unknown == Unknown::Acceleration {
            // The same matrix, and the same held DOFs, serve the velocities of the step.
            walls.for_each_held(|dof, _, _, _| series.deflation.hold(dof));
            series.deflation.prepare(&mut |x, y| matrix.multiply(x, y));
        }
        for axis in 0..D {
            series.told.fill(None);
            walls.for_each_held(|dof, along, velocity, acceleration| {
                if along == axis {
                    series.told[dof] = Some(pick(velocity, acceleration));
                }
            });
            for (known, right) in series.right.iter_mut().zip(&right[..]) {
                *known = right[axis];
            }
            series.deflation.take_out(&mut series.right);
            for ((sum, &known), &mass) in series.sum.iter_mut().zip(&series.right).zip(&mass[..]) {
                *sum = over(known, mass);
            }
            series.hold();
            for _ in 1..terms {
                matrix.multiply(&series.sum, &mut series.product);
                let rests = series.right.iter().zip(&series.product).zip(&mass[..]);
                for (sum, ((&known, &product), &mass)) in series.sum.iter_mut().zip(rests) {
                    *sum += over(known - product, mass);
                }
                series.hold();
            }
            series.deflation.put_back(&mut series.sum);
            for (right, &sum) in right.iter_mut().zip(&series.sum) {
                right[axis] = sum;
            }
        }
    }
}

/// Momentum over mass; a DOF that no particle reaches is at rest.
#[inline(always)]
fn over<T: Scalar>(momentum: T, mass: T) -> T {
    match mass > T::zero() {
        true => momentum / mass,
        false => T::zero(),
    }
}
