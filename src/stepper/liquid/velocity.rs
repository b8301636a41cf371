//! Velocities of the DOFs of both phases from their momenta.

use super::super::acceleration::Walls;
use super::super::velocity::undo_mass;
use super::super::{Forcing, Stepper};
use crate::basis::BasisFamily;
use crate::law::LawSweep;
use crate::phase::Phase;
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
    /// DOF velocities of both phases at the step's start. The masses of the mapping serve again after the
    /// update: nothing has moved by then.
    pub(in super::super) fn map_both_before(&mut self, dt: T, forcing: &Forcing<T, D>) {
        if !R::AMOUNTS_AT_PARTICLES {
            self.fit_momenta(true);
        }
        self.divide_both(dt, forcing, true);
    }

    /// Momenta to velocities, with the told values at held DOFs and no slip through sealed surfaces.
    pub(in super::super) fn divide_both(&mut self, dt: T, forcing: &Forcing<T, D>, fresh: bool) {
        let walls = [
            Walls::of_solid(&self.face_dofs, forcing),
            Walls::of_liquid(&self.face_dofs, forcing),
        ];
        for (dofs, walls) in [&mut self.dofs, &mut self.liquid].into_iter().zip(walls) {
            undo_mass(dofs, self.mass, &walls, fresh);
        }
        self.hold_velocities(dt, forcing);
        if R::PARTICLE_MATRIX {
            self.seal_mapped_jointly();
        } else {
            self.seal_velocities(dt);
        }
    }

    /// Told velocities at held DOFs. Where the liquid passes, the drag that the solid's change makes in a
    /// step moves it along, as it does with the accelerations: held otherwise in one than in the other, kick
    /// and drift are not adjoint, and where the drag is strong the energy grows at any step near the wave's.
    fn hold_velocities(&mut self, dt: T, forcing: &Forcing<T, D>) {
        let share = self.share_of_drag(dt);
        let (solid, liquid) = (&mut self.dofs.velocity, &mut self.liquid.velocity);
        let (mass, drag) = (&self.liquid.mass, &self.drag);
        Walls::of_solid(&self.face_dofs, forcing).for_each_held(|dof, axis, velocity, _| {
            liquid[dof][axis] += share(mass[dof], drag[dof]) * (velocity - solid[dof][axis]);
            solid[dof][axis] = velocity;
        });
        Walls::of_liquid(&self.face_dofs, forcing).for_each_held(|dof, axis, velocity, _| {
            liquid[dof][axis] = velocity;
        });
    }
}
