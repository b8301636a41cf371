//! The balance of momentum: what a step changes of it against the impulses of all that acts from outside.

use nalgebra::SVector;

use super::acceleration::Walls;
use super::diagnostics::Diagnostics;
use super::dofs::Dofs;
use crate::scalar::Scalar;
use crate::transfer::Momentum;

/// Forces from outside in a step, and the momentum that they found.
#[derive(Clone, Copy, Debug)]
pub(super) struct Balance<T, const D: usize> {
    /// Momentum of the particles before the step; not known before the first one.
    pub(super) momentum: Option<SVector<T, D>>,
    /// Tractions and body forces that differ from particle to particle (N).
    pub(super) load: SVector<T, D>,
    /// Forces of held faces (N).
    pub(super) reaction: SVector<T, D>,
    /// Components in which the forces of held faces are not known.
    pub(super) unknown: [bool; D],
}

impl<T: Scalar, const D: usize> Balance<T, D> {
    pub(super) fn none() -> Self {
        Self {
            momentum: None,
            load: SVector::zeros(),
            reaction: SVector::zeros(),
            unknown: [false; D],
        }
    }

    /// No force yet in this step. The particles' momentum is summed before the first step; later it is known
    /// from the step before.
    #[inline(never)]
    pub(super) fn begin(&mut self, velocities: &[SVector<T, D>], masses: &[T]) {
        *self = Self {
            momentum: self.momentum,
            ..Self::none()
        };
        if self.momentum.is_none() {
            let particles = velocities.iter().zip(masses);
            self.momentum = Some(particles.fold(SVector::zeros(), |sum, (v, &m)| sum + v * m));
        }
    }

    /// Compares the change of momentum with the impulses of loads and held faces.
    #[inline(never)]
    pub(super) fn close(
        &mut self,
        dt: T,
        body_force: &SVector<T, D>,
        after: &Momentum<T, D>,
        diagnostics: &mut Diagnostics<T>,
    ) {
        let weight = body_force * diagnostics.total_mass;
        let impulses = [weight * dt, self.load * dt, self.reaction * dt];
        let change = after.momentum - self.momentum.unwrap_or_else(SVector::zeros);
        let mut difference = impulses.iter().fold(change, |left, impulse| left - impulse);
        for axis in (0..D).filter(|&axis| self.unknown[axis]) {
            difference[axis] = T::zero();
        }
        let scale = impulses
            .iter()
            .fold(after.scale, |sum, impulse| sum + impulse.norm());
        diagnostics.record_impulse(difference.norm(), scale);
        self.momentum = Some(after.momentum);
    }

    /// Notes what `f + m b` gives to held components before accelerations are solved for with the particles'
    /// matrix.
    pub(super) fn note_loads_on_held(&mut self, right: &[SVector<T, D>], walls: &Walls<'_, T, D>) {
        walls.for_each_held(|dof, axis, _, _| {
            // Beyond one axis a row of the matrix costs as much as a product with all of it.
            self.unknown[axis] = D > 1;
            self.reaction[axis] -= right[dof][axis];
        });
    }

    /// Adds what the matrix makes of the accelerations there.
    pub(super) fn note_inertia_of_held(&mut self, dofs: &Dofs<T, D>, walls: &Walls<'_, T, D>) {
        if const { D > 1 } {
            return;
        }
        walls.for_each_held(|dof, axis, _, _| {
            self.reaction[axis] += dofs.matrix.band().row_product(dof, axis, &dofs.force);
        });
    }
}
