//! Accelerations of both phases.

use nalgebra::SVector;

use super::super::acceleration::Walls;
use super::super::{Forcing, Stepper};
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
    /// Turns the forces of both phases into accelerations; a DOF that no particle reaches has none.
    ///
    /// Implicit drag takes the velocities at the end of the step, `v + dt a`: two equations in two unknowns a
    /// DOF, here solved without products of masses, which would underflow in nearly empty cells.
    pub(in super::super) fn accelerate_both(&mut self, dt: T, forcing: &Forcing<T, D>) {
        if R::PARTICLE_MATRIX {
            return self.solve_both(dt, forcing);
        }
        let n = self.phase.porosity();
        let implicit = self.phase.drag_treatment() == Drag::Implicit;
        let body_force = forcing.body_force;
        let (solid, liquid) = (&mut self.dofs, &mut self.liquid);
        for (i, &d) in self.drag.iter().enumerate() {
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
        self.hold_both(dt, forcing);
        self.seal_accelerations(dt);
    }

    /// Told accelerations at held DOFs. Where the liquid passes a held face it still feels the solid's drag,
    /// now that of a solid that moves as told.
    fn hold_both(&mut self, dt: T, forcing: &Forcing<T, D>) {
        let share = self.share_of_drag(dt);
        let (solid, liquid, drag) = (&mut self.dofs.force, &mut self.liquid.force, &self.drag);
        let liquid_mass = &self.liquid.mass;
        Walls::of_solid(&self.face_dofs, forcing).for_each_held(|dof, axis, _, told| {
            liquid[dof][axis] += share(liquid_mass[dof], drag[dof]) * (told - solid[dof][axis]);
            solid[dof][axis] = told;
        });
        Walls::of_liquid(&self.face_dofs, forcing).for_each_held(|dof, axis, _, told| {
            liquid[dof][axis] = told;
        });
    }

    /// Share of a change of the solid's velocity that the drag passes on to the liquid within a step, given
    /// the liquid's mass and the drag of a DOF: none where the drag is felt at the step's start.
    pub(super) fn share_of_drag(&self, dt: T) -> impl Fn(T, T) -> T + use<T, D, B, R, L, P, X> {
        let n = self.phase.porosity();
        let dt = match self.phase.drag_treatment() {
            Drag::Implicit => dt,
            Drag::Explicit => T::zero(),
        };
        move |mass, drag| {
            if mass > T::zero() {
                drag * dt / (mass / n + drag * dt)
            } else {
                T::zero()
            }
        }
    }
}
