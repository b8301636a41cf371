//! What is summed and read at one DOF, side by side: the particles' loops touch one place in memory per DOF.

use std::ops::Add;

use nalgebra::SVector;
use num_traits::Zero;

use super::super::{Dofs, Stepper};
use crate::law::LawSweep;
use crate::phase::Phase;
use crate::scalar::Scalar;

/// Sums over the particles.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct Sums<T, const D: usize> {
    pub(super) solid_mass: T,
    pub(super) liquid_mass: T,
    pub(super) drag: T,
    pub(super) momenta: [SVector<T, D>; 2],
    /// On the whole and on the liquid.
    pub(super) forces: [SVector<T, D>; 2],
}

impl<T: Scalar, const D: usize> Add for Sums<T, D> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let both = |a: [SVector<T, D>; 2], b: [SVector<T, D>; 2]| [a[0] + b[0], a[1] + b[1]];
        Self {
            solid_mass: self.solid_mass + other.solid_mass,
            liquid_mass: self.liquid_mass + other.liquid_mass,
            drag: self.drag + other.drag,
            momenta: both(self.momenta, other.momenta),
            forces: both(self.forces, other.forces),
        }
    }
}

impl<T: Scalar, const D: usize> Zero for Sums<T, D> {
    #[inline(always)]
    fn zero() -> Self {
        Self {
            solid_mass: T::zero(),
            liquid_mass: T::zero(),
            drag: T::zero(),
            momenta: [SVector::zeros(); 2],
            forces: [SVector::zeros(); 2],
        }
    }

    fn is_zero(&self) -> bool {
        self.solid_mass.is_zero()
            && self.liquid_mass.is_zero()
            && self.drag.is_zero()
            && self.momenta.iter().chain(&self.forces).all(SVector::is_zero)
    }
}

/// A vector of solid and liquid at every DOF: accelerations, then momenta, then velocities.
pub(super) type Motion<T, const D: usize> = [SVector<T, D>; 2];

impl<T, const D: usize, B, R, L, P> Stepper<T, D, B, R, L, P>
where
    T: Scalar,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
{
    /// Hands the sums to the DOFs of the two phases.
    pub(super) fn take_sums(&mut self) {
        for (i, sums) in self.sums.iter().enumerate() {
            self.dofs.mass[i] = sums.solid_mass;
            self.liquid.mass[i] = sums.liquid_mass;
            self.drag[i] = sums.drag;
            [self.dofs.velocity[i], self.liquid.velocity[i]] = sums.momenta;
            [self.dofs.force[i], self.liquid.force[i]] = sums.forces;
        }
    }

    /// Lays the accelerations of both phases side by side.
    pub(super) fn lay_accelerations(&mut self) {
        lay(&mut self.motion, &self.dofs, &self.liquid, |dofs| &dofs.force);
    }

    /// Lays the velocities of both phases side by side.
    pub(super) fn lay_velocities(&mut self) {
        lay(&mut self.motion, &self.dofs, &self.liquid, |dofs| &dofs.velocity);
    }
}

fn lay<T: Scalar, const D: usize>(
    motion: &mut [Motion<T, D>],
    solid: &Dofs<T, D>,
    liquid: &Dofs<T, D>,
    pick: impl Fn(&Dofs<T, D>) -> &[SVector<T, D>],
) {
    for ((both, s), w) in motion.iter_mut().zip(pick(solid)).zip(pick(liquid)) {
        *both = [*s, *w];
    }
}
