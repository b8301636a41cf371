//! Accelerations of both phases.

use nalgebra::SVector;

use super::super::Forcing;
use super::super::acceleration::Walls;
use super::super::dofs::Dofs;
use super::super::inner::Inner;
use crate::law::LawSweep;
use crate::phase::{Drag, Phase};
use crate::scalar::Scalar;
use crate::transfer::Transfer;

impl<T, const D: usize, L, P, X> Inner<T, D, L, P, X>
where
    T: Scalar,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
    X: Transfer<T, D>,
{
    /// Turns the forces of both phases into accelerations; a DOF that no particle reaches has none.
    ///
    /// Implicit drag takes the velocities at the end of the step, `v + dt a`: two equations in two unknowns a
    /// DOF, here solved without products of masses, which would underflow in nearly empty cells.
    #[inline(never)]
    pub(in super::super) fn accelerate_both(&mut self, dt: T, forcing: &Forcing<T, D>) {
        if self.in_acceleration() {
            return self.solve_both(dt, forcing);
        }
        let mixture = Mixture {
            porosity: self.phase.porosity(),
            implicit: self.phase.drag_treatment() == Drag::Implicit,
            body_force: forcing.body_force,
        };
        accelerate_lumped(&mut self.dofs, &mut self.liquid, &self.drag, &mixture, dt);
        let walls = Walls::of_both(&self.face_dofs, forcing);
        let share = self.share_of_drag(dt);
        let dofs = [&mut self.dofs, &mut self.liquid];
        hold_accelerations(dofs, &self.drag, walls, share);
        self.seal_accelerations(dt);
    }

    /// Share of a change of the solid's velocity that the drag passes on to the liquid within a step.
    pub(super) fn share_of_drag(&self, dt: T) -> ShareOfDrag<T> {
        ShareOfDrag {
            porosity: self.phase.porosity(),
            dt: match self.phase.drag_treatment() {
                Drag::Implicit => dt,
                Drag::Explicit => T::zero(),
            },
        }
    }
}

/// What accelerations of both phases depend on besides forces, masses and drag.
struct Mixture<T, const D: usize> {
    porosity: T,
    implicit: bool,
    body_force: SVector<T, D>,
}

/// Forces to accelerations where every DOF answers by itself.
#[inline(never)]
fn accelerate_lumped<T: Scalar, const D: usize>(
    solid: &mut Dofs<T, D>,
    liquid: &mut Dofs<T, D>,
    drag: &[T],
    mixture: &Mixture<T, D>,
    dt: T,
) {
    let Mixture {
        porosity: n,
        implicit,
        body_force,
    } = *mixture;
    for (i, &d) in drag.iter().enumerate() {
        let (m_s, m_bar) = (solid.mass[i], liquid.mass[i]);
        if !(m_s > T::zero() && m_bar > T::zero()) {
            solid.force[i] = SVector::zeros();
            liquid.force[i] = SVector::zeros();
            continue;
        }
        let m_w = m_bar / n;
        let slip = solid.velocity[i] - liquid.velocity[i];
        let on_liquid = liquid.force[i] + body_force * m_w + slip * d;
        let on_whole = solid.force[i] + body_force * (m_s + m_bar);
        let a_w = if implicit {
            let drag = dt * d;
            (on_liquid + on_whole * (drag / m_s)) / (m_w + drag * (T::one() + m_bar / m_s))
        } else {
            on_liquid / m_w
        };
        solid.force[i] = (on_whole - a_w * m_bar) / m_s;
        liquid.force[i] = a_w;
    }
}

/// Told accelerations at held DOFs. Where the liquid passes a held face it still feels the solid's drag, now
/// that of a solid that moves as told.
#[inline(never)]
fn hold_accelerations<T: Scalar, const D: usize>(
    [solid, liquid]: [&mut Dofs<T, D>; 2],
    drag: &[T],
    [of_solid, of_liquid]: [Walls<'_, T, D>; 2],
    share: ShareOfDrag<T>,
) {
    let Dofs { mass, force, .. } = liquid;
    of_solid.for_each_held(|dof, axis, _, told| {
        force[dof][axis] += share.of(mass[dof], drag[dof]) * (told - solid.force[dof][axis]);
        solid.force[dof][axis] = told;
    });
    of_liquid.for_each_held(|dof, axis, _, told| {
        force[dof][axis] = told;
    });
}

/// Share of a change of the solid's velocity that the drag passes on to the liquid within a step: none where
/// the drag is felt at the step's start.
#[derive(Clone, Copy)]
pub(super) struct ShareOfDrag<T> {
    porosity: T,
    /// The step's size, or zero.
    dt: T,
}

impl<T: Scalar> ShareOfDrag<T> {
    /// Given the liquid's mass and the drag of a DOF.
    pub(super) fn of(self, mass: T, drag: T) -> T {
        if mass > T::zero() {
            drag * self.dt / (mass / self.porosity + drag * self.dt)
        } else {
            T::zero()
        }
    }
}
