//! Solving with the consistent mass matrix.

use super::Dofs;
use super::acceleration::Walls;
use crate::mass::VelocityMass;
use crate::scalar::Scalar;

/// What is solved for, in place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Unknown {
    /// From forces.
    Acceleration,
    /// From momenta.
    Velocity,
}

impl<T: Scalar, const D: usize> Dofs<T, D> {
    /// `M x = right`. The held DOFs are eliminated if they are constraints; they may differ from axis to axis. `pick` says
    /// which of their told velocity and acceleration counts. Without `fresh` the matrix is the one of the last call.
    pub(super) fn solve(
        &mut self,
        unknown: Unknown,
        mass: VelocityMass,
        walls: &Walls<'_, T, D>,
        fresh: bool,
        pick: impl Fn(T, T) -> T,
    ) {
        let right = match unknown {
            Unknown::Acceleration => &mut self.force,
            Unknown::Velocity => &mut self.velocity,
        };
        let factor = &mut self.factor;
        if mass != VelocityMass::Constrained {
            if fresh {
                factor.copy_from(&self.matrix);
                factor.factorise();
            }
            (0..D).for_each(|axis| factor.solve(right, axis));
            return;
        }
        if D == 1 && !fresh {
            walls.for_each_held(|dof, axis, velocity, acceleration| {
                self.matrix
                    .move_known(dof, axis, pick(velocity, acceleration), right);
            });
            // Only then: what is known of one DOF also moves to the equations of other known ones.
            walls.for_each_held(|dof, axis, velocity, acceleration| {
                right[dof][axis] = pick(velocity, acceleration);
            });
            factor.solve(right, 0);
            return;
        }
        for axis in 0..D {
            factor.copy_from(&self.matrix);
            walls.for_each_held(|dof, held, velocity, acceleration| {
                if held == axis {
                    factor.prescribe(dof, axis, pick(velocity, acceleration), right);
                }
            });
            factor.factorise();
            factor.solve(right, axis);
        }
    }
}
