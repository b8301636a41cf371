//! The stages of two phases that differ where the particles' consistent matrices are used.

use nalgebra::SVector;

use super::super::acceleration::Walls;
use super::super::forces::{WEAK, fill_with_pairs};
use super::super::ghost::lump_undetermined_cells;
use super::super::inner::Inner;
use super::super::matrix::MassMatrix;
use super::super::{Forcing, Stepper};
use super::joint::Joint;
use super::seal::Components;
use crate::basis::BasisFamily;
use crate::law::LawSweep;
use crate::phase::{Drag, Phase};
use crate::reconstruction::Reconstruction;
use crate::scalar::Scalar;
use crate::transfer::Transfer;

impl<T, const D: usize, B, R, L, P, X> Stepper<T, D, B, R, L, P, X>
where
    T: Scalar,
    B: BasisFamily<T, D>,
    R: Reconstruction<T, D>,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
    X: Transfer<T, D>,
{
    /// The matrices of both masses and of the drag.
    pub(in super::super) fn assemble_joint_matrices(&mut self) {
        let (phase, particles) = (&self.inner.phase, &self.inner.particles);
        let n = phase.porosity();
        let Joint {
            liquid_mass,
            drag_of,
            drag,
            ..
        } = &mut self.inner.joint;
        let bodies = particles.mass.iter().zip(&particles.volume);
        for ((mass, drag), (&solid_mass, &volume)) in liquid_mass.iter_mut().zip(&mut drag_of[..]).zip(bodies)
        {
            *mass = phase.liquid_mass(volume);
            *drag = n * phase.drag(solid_mass, volume);
        }
        let filled = [
            (&particles.mass[..], &mut self.inner.dofs.matrix),
            (&liquid_mass[..], &mut self.inner.liquid.matrix),
            (&drag_of[..], drag),
        ];
        for (masses, matrix) in filled {
            let bodies = particles.sites(self.inner.bins.cells());
            fill_with_pairs(
                &self.basis,
                &self.inner.grid,
                bodies,
                masses,
                &mut self.inner.pairs,
                matrix,
            );
            let space = (&self.basis, &self.inner.grid, &self.inner.bins);
            lump_undetermined_cells(space, &self.reconstruction, matrix);
            matrix.complete(Some(T::lit(WEAK)));
        }
    }
}

impl<T, const D: usize, L, P, X> Inner<T, D, L, P, X>
where
    T: Scalar,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
    X: Transfer<T, D>,
{
    /// Turns the forces of both phases into accelerations.
    #[inline(never)]
    pub(super) fn solve_both(&mut self, dt: T, forcing: &Forcing<T, D>) {
        let implicit = self.phase.drag_treatment() == Drag::Implicit;
        let (n, b) = (self.phase.porosity(), forcing.body_force);
        let (solid, liquid) = (&mut self.dofs, &mut self.liquid);
        let Joint {
            drag,
            right,
            response,
            ..
        } = &mut self.joint;
        // No response is kept yet: there is room for the slips and what resists them.
        let (slips, resistance) = response.split_at_mut(solid.velocity.len());
        let velocities = solid.velocity.iter().zip(&liquid.velocity);
        for (slip, (of_solid, of_liquid)) in slips.iter_mut().zip(velocities) {
            *slip = of_solid - of_liquid;
        }
        resistance.fill(SVector::zeros());
        drag.band().add_product(slips, resistance);
        for (i, resistance) in resistance.iter().enumerate() {
            let (m_s, m_w) = (solid.mass[i], liquid.mass[i]);
            right[2 * i] = solid.force[i] + b * (m_s + m_w);
            right[2 * i + 1] = liquid.force[i] * n + b * m_w + resistance;
        }
        let joint = &mut self.joint;
        let drag_step = if implicit { dt } else { T::zero() };
        joint.assemble(solid.matrix.band(), liquid.matrix.band(), drag_step);
        joint.solve([
            Walls::of_solid(&self.face_dofs, forcing),
            Walls::of_liquid(&self.face_dofs, forcing),
        ]);
        self.seal_jointly(forcing);
        let accelerations = self.dofs.force.iter_mut().zip(&mut self.liquid.force);
        for (both, (of_solid, of_liquid)) in self.joint.right.chunks_exact(2).zip(accelerations) {
            *of_solid = both[0];
            *of_liquid = both[0] + both[1];
        }
    }

    /// As [`Inner::seal_accelerations`], where all DOFs answer to the force on one.
    fn seal_jointly(&mut self, forcing: &Forcing<T, D>) {
        if self.seal.is_empty() {
            return;
        }
        let walls = [
            Walls::of_solid(&self.face_dofs, forcing),
            Walls::of_liquid(&self.face_dofs, forcing),
        ];
        let joint = &mut self.joint;
        self.seal
            .components
            .for_each::<D>(|dof, axis, _, _, slip| *slip = joint.right[2 * dof + 1][axis]);
        self.seal.solve_with(|components| {
            joint.respond_to(components, walls);
            components.for_each::<D>(|dof, axis, _, _, slip| *slip = joint.response[2 * dof + 1][axis]);
        });
        joint.respond_to(&self.seal.components, walls);
        for (acceleration, response) in joint.right.iter_mut().zip(&joint.response) {
            *acceleration += response;
        }
    }

    /// As [`Inner::seal_velocities`], with the matrices that the velocities were mapped with.
    #[inline(never)]
    pub(super) fn seal_mapped_jointly(&mut self) {
        if self.seal.is_empty() {
            return;
        }
        let (solid, liquid) = (&mut self.dofs, &mut self.liquid);
        let matrices = [&solid.matrix, &liquid.matrix];
        // No response to a pressure is kept by then: there is room for the velocities that it makes.
        let (of_solid, of_liquid) = self.joint.response.split_at_mut(solid.velocity.len());
        self.seal.components.for_each::<D>(|dof, axis, _, _, slip| {
            *slip = liquid.velocity[dof][axis] - solid.velocity[dof][axis];
        });
        self.seal.solve_with(|components| {
            answer_to(components, matrices, [of_solid, of_liquid]);
            components.for_each::<D>(|dof, axis, _, _, slip| {
                *slip = of_liquid[dof][axis] - of_solid[dof][axis];
            });
        });
        answer_to(&self.seal.components, matrices, [of_solid, of_liquid]);
        for (dofs, answers) in [(solid, of_solid), (liquid, of_liquid)] {
            for (velocity, answer) in dofs.velocity.iter_mut().zip(answers) {
                *velocity += *answer;
            }
        }
    }
}

/// Velocities of solid and liquid that the impulses of `components` on the liquid, and their opposites on the
/// solid, make with the matrices of their masses.
fn answer_to<T: Scalar, const D: usize>(
    components: &Components<T>,
    matrices: [&MassMatrix<T, D>; 2],
    answers: [&mut [SVector<T, D>]; 2],
) {
    let signs = [-T::one(), T::one()];
    for (phase, (matrix, answer)) in matrices.into_iter().zip(answers).enumerate() {
        answer.fill(SVector::zeros());
        let forces = components.force.iter().zip(&components.held);
        for ((dof, axis), (&force, held)) in components.places::<D>().zip(forces) {
            if !held[phase] {
                answer[dof][axis] = force * signs[phase];
            }
        }
        matrix.solve_again(answer);
    }
}
