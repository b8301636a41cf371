//! The balance of momentum: what a step changes of it against the impulses of all that acts from outside.

use nalgebra::SVector;

use super::acceleration::Walls;
use super::{Forcing, Stepper};
use crate::basis::BasisFamily;
use crate::law::LawSweep;
use crate::phase::Phase;
use crate::reconstruction::Reconstruction;
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

    /// No force yet in this step.
    pub(super) fn begin(&mut self) {
        *self = Self {
            momentum: self.momentum,
            ..Self::none()
        };
    }
}

impl<T, const D: usize, B, R, L, P> Stepper<T, D, B, R, L, P>
where
    T: Scalar,
    B: BasisFamily<T, D>,
    R: Reconstruction<T, D>,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
{
    /// Sums the particles' momentum before the first step; later it is known from the step before.
    pub(super) fn begin_balance(&mut self) {
        if P::FLOWS {
            return;
        }
        self.balance.begin();
        if self.balance.momentum.is_none() {
            let particles = self.particles.velocity.iter().zip(&self.particles.mass);
            self.balance.momentum = Some(particles.fold(SVector::zeros(), |sum, (v, &m)| sum + v * m));
        }
    }

    /// Compares the change of momentum with the impulses of loads and held faces.
    pub(super) fn balance_momentum(&mut self, dt: T, forcing: &Forcing<T, D>, after: &Momentum<T, D>) {
        if P::FLOWS {
            return;
        }
        let Balance {
            momentum,
            load,
            reaction,
            unknown,
        } = self.balance;
        let weight = forcing.body_force * self.diagnostics.total_mass;
        let impulses = [weight * dt, load * dt, reaction * dt];
        let change = after.momentum - momentum.unwrap_or_else(SVector::zeros);
        let mut difference = impulses.iter().fold(change, |left, impulse| left - impulse);
        for axis in (0..D).filter(|&axis| unknown[axis]) {
            difference[axis] = T::zero();
        }
        let scale = impulses
            .iter()
            .fold(after.scale, |sum, impulse| sum + impulse.norm());
        self.diagnostics.record_impulse(difference.norm(), scale);
        self.balance.momentum = Some(after.momentum);
    }

    /// Prescribes the accelerations of held components and notes the forces that this takes, where masses are lumped.
    pub(super) fn hold_accelerations(&mut self, forcing: &Forcing<T, D>) {
        let (force, masses, balance) = (&mut self.dofs.force, &self.dofs.mass, &mut self.balance);
        Walls::of_solid(&self.face_dofs, forcing).for_each_held(|dof, axis, _, acceleration| {
            if !R::PARTICLE_MATRIX {
                balance.reaction[axis] += (acceleration - force[dof][axis]) * masses[dof];
            }
            force[dof][axis] = acceleration;
        });
    }

    /// Notes what `f + m b` gives to held components before accelerations are solved for with the particles' matrix.
    pub(super) fn note_loads_on_held(&mut self, forcing: &Forcing<T, D>) {
        let (right, balance) = (&self.dofs.force, &mut self.balance);
        Walls::of_solid(&self.face_dofs, forcing).for_each_held(|dof, axis, _, _| {
            // Beyond one axis a row of the matrix costs as much as a product with all of it.
            balance.unknown[axis] = D > 1;
            balance.reaction[axis] -= right[dof][axis];
        });
    }

    /// Adds what the matrix makes of the accelerations there.
    pub(super) fn note_inertia_of_held(&mut self, forcing: &Forcing<T, D>) {
        if D > 1 {
            return;
        }
        let (dofs, balance) = (&self.dofs, &mut self.balance);
        Walls::of_solid(&self.face_dofs, forcing).for_each_held(|dof, axis, _, _| {
            balance.reaction[axis] += dofs.matrix.band().row_product(dof, axis, &dofs.force);
        });
    }
}
