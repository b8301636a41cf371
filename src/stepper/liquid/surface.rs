//! What the liquid meets at the bodies' surfaces.

use super::super::{FaceCondition, Forcing, PoreCondition, Stepper};
use crate::basis::BasisFamily;
use crate::law::ConstitutiveLaw;
use crate::phase::{Drag, Phase};
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
    /// The outside pressure on the liquid, where it passes.
    pub(super) fn add_pore_pressures(&mut self, forcing: &Forcing<T, D>) {
        for k in 0..self.surface.len() {
            let point = &self.surface[k];
            let PoreCondition::Pressure(pressure) = forcing.pores(point.face) else {
                continue;
            };
            let x = self.surface_position(point);
            let cell = self.bins.cell_of(point.particle);
            let (axis, load) = (point.face.axis, pressure * point.area * point.outward());
            let force = &mut self.liquid.force;
            self.basis
                .for_each(&self.grid, cell, &x, |i, phi, _| force[i][axis] += load * phi);
        }
    }

    /// A surface that the liquid does not pass: the pressure there is whatever keeps the liquid's velocity at the end of the
    /// step equal to the solid's. One equation a surface, since a pressure `P` on the liquid alone changes
    /// `a_w - a_s` of DOF `i` by `P phi_i (m_s + mbar) / det`.
    pub(super) fn seal_surfaces(&mut self, dt: T, forcing: &Forcing<T, D>) {
        for k in 0..self.surface.len() {
            let point = &self.surface[k];
            let held = matches!(forcing.face(point.face), FaceCondition::Held { .. });
            if held || forcing.pores(point.face) != PoreCondition::Sealed {
                continue;
            }
            let axis = point.face.axis;
            let x = self.surface_position(point);
            let cell = self.bins.cell_of(point.particle);
            let (solid, liquid, drag) = (&mut self.dofs, &mut self.liquid, &self.drag);
            let implicit = self.phase.drag_treatment() == Drag::Implicit;
            let n = self.phase.porosity();
            // Accelerations of both phases for a unit force on the liquid alone.
            let response = |m_s: T, m_bar: T, d: T| {
                if !(m_s > T::zero() && m_bar > T::zero()) {
                    return (T::zero(), T::zero());
                }
                let drag = if implicit { dt * d } else { T::zero() };
                let a_w = T::one() / (m_bar / n + drag * (T::one() + m_bar / m_s));
                (-m_bar * a_w / m_s, a_w)
            };
            let (mut slip, mut gain) = (T::zero(), T::zero());
            self.basis.for_each(&self.grid, cell, &x, |i, phi, _| {
                let velocity = liquid.velocity[i] - solid.velocity[i];
                let acceleration = liquid.force[i] - solid.force[i];
                slip += (velocity[axis] + acceleration[axis] * dt) * phi;
                let (a_s, a_w) = response(solid.mass[i], liquid.mass[i], drag[i]);
                gain += (a_w - a_s) * phi * phi * dt;
            });
            if gain <= T::zero() {
                continue;
            }
            let force = -slip / gain;
            self.basis.for_each(&self.grid, cell, &x, |i, phi, _| {
                let (a_s, a_w) = response(solid.mass[i], liquid.mass[i], drag[i]);
                solid.force[i][axis] += a_s * phi * force;
                liquid.force[i][axis] += a_w * phi * force;
            });
        }
    }
}
