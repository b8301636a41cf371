//! Velocities of the DOFs of both phases from their momenta.

use super::super::acceleration::Walls;
use super::super::dofs::Dofs;
use super::super::inner::Inner;
use super::super::velocity::undo_mass;
use super::super::{Forcing, Stepper};
use super::acceleration::ShareOfDrag;
use crate::basis::BasisFamily;
use crate::law::LawSweep;
use crate::mass::MassModel;
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
        if const { !R::Mass::OF_PARTICLES } {
            self.fit_momenta(true);
        }
        self.inner.divide_both(dt, forcing, true);
    }
}

impl<T, const D: usize, L, P, X> Inner<T, D, L, P, X>
where
    T: Scalar,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
    X: Transfer<T, D>,
{
    /// Momenta to velocities, with the told values at held DOFs and no slip through sealed surfaces.
    #[inline(never)]
    pub(in super::super) fn divide_both(&mut self, dt: T, forcing: &Forcing<T, D>, fresh: bool) {
        let walls = Walls::of_both(&self.face_dofs, forcing);
        let dofs = [&mut self.dofs, &mut self.liquid];
        for (dofs, walls) in dofs.into_iter().zip(&walls) {
            undo_mass(dofs, self.mass, walls, fresh);
        }
        let share = self.share_of_drag(dt);
        hold_velocities([&mut self.dofs, &mut self.liquid], &self.drag, walls, share);
        if self.in_acceleration() {
            self.seal_mapped_jointly();
        } else {
            self.seal_velocities(dt);
        }
    }
}

/// Told velocities at held DOFs. Where the liquid passes, the drag that the solid's change makes in a step
/// moves it along, as it does with the accelerations: held otherwise in one than in the other, kick and drift
/// are not adjoint, and where the drag is strong the energy grows at any step near the wave's.
#[inline(never)]
fn hold_velocities<T: Scalar, const D: usize>(
    [solid, liquid]: [&mut Dofs<T, D>; 2],
    drag: &[T],
    [of_solid, of_liquid]: [Walls<'_, T, D>; 2],
    share: ShareOfDrag<T>,
) {
    let Dofs {
        mass,
        velocity: liquid,
        ..
    } = liquid;
    let solid = &mut solid.velocity;
    of_solid.for_each_held(|dof, axis, velocity, _| {
        liquid[dof][axis] += share.of(mass[dof], drag[dof]) * (velocity - solid[dof][axis]);
        solid[dof][axis] = velocity;
    });
    of_liquid.for_each_held(|dof, axis, velocity, _| {
        liquid[dof][axis] = velocity;
    });
}
