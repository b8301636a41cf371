//! Contact with walls that let go and rub.
//!
//! At the DOFs on the wall (Bardenhagen, Brackbill & Sulsky 2000): of a velocity into the wall the normal part is taken away, and the
//! tangential part is slowed by at most the coefficient of friction times what was taken. It happens twice in a step: to the
//! velocity that the accelerations lead to, which makes the wall's force, and to the velocity mapped from the particles, so that
//! none moves through the wall. A consistent mass matrix does not know of it: the DOFs are corrected one by one after its
//! solution.

use nalgebra::SVector;

use super::{FaceCondition, Forcing, Stepper};
use crate::basis::BasisFamily;
use crate::grid::{Cell, Face, Grid, Side};
use crate::law::ConstitutiveLaw;
use crate::phase::Phase;
use crate::reconstruction::Reconstruction;
use crate::scalar::Scalar;

impl<T, const D: usize, B, R, L, P> Stepper<T, D, B, R, L, P>
where
    T: Scalar,
    B: BasisFamily<T, D>,
    R: Reconstruction<T, D>,
    L: ConstitutiveLaw<T, D>,
    P: Phase<T, D>,
{
    /// Bends the accelerations of DOFs that would move into a wall within `dt`.
    pub(super) fn stop_at_walls(&mut self, dt: T, forcing: &Forcing<T, D>) {
        if frictional(forcing).next().is_none() {
            return;
        }
        self.map_momentum_before(forcing);
        for (face, coefficient) in frictional(forcing) {
            for &dof in face_dofs(&self.face_dofs, face) {
                let (dof, mass) = (dof as usize, self.dofs.mass[dof as usize]);
                if mass > T::zero() {
                    let before = self.dofs.velocity[dof] / mass;
                    let after = slide(before + self.dofs.force[dof] * dt, face, coefficient);
                    self.dofs.force[dof] = (after - before) / dt;
                }
            }
        }
    }

    /// Bends the velocities of DOFs that move into a wall.
    pub(super) fn slide_along_walls(&mut self, forcing: &Forcing<T, D>) {
        for (face, coefficient) in frictional(forcing) {
            for &dof in face_dofs(&self.face_dofs, face) {
                let velocity = &mut self.dofs.velocity[dof as usize];
                *velocity = slide(*velocity, face, coefficient);
            }
        }
    }

    /// Momentum of the particles as they are, at the DOFs on the walls; the array is the one that the momentum after their update
    /// will fill.
    fn map_momentum_before(&mut self, forcing: &Forcing<T, D>) {
        let (basis, grid, momentum) = (&self.basis, &self.grid, &mut self.dofs.velocity);
        momentum.fill(SVector::zeros());
        let particles = &self.particles;
        let bodies = particles.velocity.iter().zip(&particles.mass);
        for ((x, cell), (velocity, &mass)) in particles.position.iter().zip(self.bins.cells()).zip(bodies) {
            // Functions of further cells have no value at the wall.
            let reaches = |(face, _)| cells_to(grid, cell, face) <= basis.degree();
            if !frictional(forcing).any(reaches) {
                continue;
            }
            let amount = velocity * mass;
            basis.for_each(grid, cell, x, |i, phi, _| momentum[i] += amount * phi);
        }
    }
}

/// The frictional faces with their coefficients.
fn frictional<T: Scalar, const D: usize>(forcing: &Forcing<T, D>) -> impl Iterator<Item = (Face, T)> {
    Face::all::<D>().filter_map(|face| match forcing.face(face) {
        FaceCondition::Frictional { coefficient } => Some((face, *coefficient)),
        _ => None,
    })
}

/// Cells between `cell` and a face.
fn cells_to<T: Scalar, const D: usize>(grid: &Grid<T, D>, cell: &Cell<D>, face: Face) -> usize {
    let (index, count) = (cell[face.axis] as usize, grid.cells()[face.axis]);
    match face.side {
        Side::Min => index,
        Side::Max => count - 1 - index,
    }
}

/// DOFs of a face in the stepper's lists.
fn face_dofs(lists: &[Vec<u32>], face: Face) -> &[u32] {
    lists
        .get(2 * face.axis + face.side as usize)
        .map_or(&[], Vec::as_slice)
}

/// What is left of a velocity at a wall.
fn slide<T: Scalar, const D: usize>(
    mut velocity: SVector<T, D>,
    face: Face,
    coefficient: T,
) -> SVector<T, D> {
    let into = match face.side {
        Side::Min => -velocity[face.axis],
        Side::Max => velocity[face.axis],
    };
    if into <= T::zero() {
        return velocity;
    }
    velocity[face.axis] = T::zero();
    let speed = velocity.iter().fold(T::zero(), |sum, &v| sum + v * v).sqrt();
    let lost = coefficient * into;
    if speed <= lost {
        return SVector::zeros();
    }
    velocity * ((speed - lost) / speed)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::vector;

    const FLOOR: Face = Face {
        axis: 1,
        side: Side::Min,
    };

    #[test]
    fn a_wall_takes_what_moves_into_it_and_rubs_in_proportion() {
        assert_eq!(
            slide(vector![3.0, 1.0], FLOOR, 0.5),
            vector![3.0, 1.0],
            "moves away"
        );
        assert_eq!(slide(vector![3.0, -2.0], FLOOR, 0.5), vector![2.0, 0.0], "slides");
        assert_eq!(slide(vector![3.0, -8.0], FLOOR, 0.5), vector![0.0, 0.0], "sticks");
        assert_eq!(
            slide(vector![3.0, -2.0], FLOOR, 0.0),
            vector![3.0, 0.0],
            "is smooth"
        );
        let ceiling = Face {
            side: Side::Max,
            ..FLOOR
        };
        assert_eq!(slide(vector![3.0, -2.0], ceiling, 0.5), vector![3.0, -2.0]);
    }
}
