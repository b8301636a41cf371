//! What the liquid meets at the bodies' surfaces.

use nalgebra::{SMatrix, SVector};

use super::super::{FaceCondition, Forcing, PoreCondition, Stepper, SurfacePoint};
use crate::basis::BasisFamily;
use crate::field::Pair;
use crate::law::ConstitutiveLaw;
use crate::phase::{Drag, Phase};
use crate::reconstruction::Reconstruction;
use crate::scalar::Scalar;

/// An even state that balances the load of a surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct EvenLoad<T> {
    /// Total stress (Pa).
    pub(super) stress: T,
    /// Pressure of the liquid (Pa).
    pub(super) pressure: T,
}

impl<T: Scalar> EvenLoad<T> {
    /// Total stress and pressure of a particle less the even state.
    #[inline(always)]
    pub(super) fn rest<const D: usize, P: Phase<T, D>>(
        &self,
        phase: &P,
        effective: &SMatrix<T, D, D>,
        data: &P::Particle,
    ) -> Pair<SMatrix<T, D, D>, T> {
        let mut total = phase.total_stress(effective, data);
        for a in 0..D {
            total[(a, a)] -= self.stress;
        }
        Pair(total, phase.liquid(data).pressure - self.pressure)
    }
}

fn is_held<T: Scalar, const D: usize>(forcing: &Forcing<T, D>, point: &SurfacePoint<T>) -> bool {
    matches!(forcing.face(point.face), FaceCondition::Held { .. })
}

/// Whether the liquid does not pass a surface, which no wall holds.
pub(super) fn is_sealed<T: Scalar, const D: usize>(forcing: &Forcing<T, D>, point: &SurfacePoint<T>) -> bool {
    !is_held(forcing, point) && forcing.pores(point.face) == PoreCondition::Sealed
}

/// Force per area (Pa) on the whole.
fn traction<T: Scalar, const D: usize>(forcing: &Forcing<T, D>, point: &SurfacePoint<T>) -> SVector<T, D> {
    match forcing.face(point.face) {
        FaceCondition::Traction(traction) if point.loaded => *traction,
        FaceCondition::Traction(_)
        | FaceCondition::Free
        | FaceCondition::Held { .. }
        | FaceCondition::Frictional { .. } => SVector::zeros(),
    }
}

impl<T, const D: usize, B, R, L, P> Stepper<T, D, B, R, L, P>
where
    T: Scalar,
    B: BasisFamily<T, D>,
    R: Reconstruction<T, D>,
    L: ConstitutiveLaw<T, D>,
    P: Phase<T, D>,
{
    /// The load of one surface, as an even state of the whole body.
    ///
    /// With every surface of the bodies known, `integral(t phi_i) - integral(sigma grad phi_i)` does not change if the same
    /// even stress is taken from `sigma` and, times the normal, from the loads `t`. Taking the load of a surface itself leaves
    /// nothing to integrate where the body is in equilibrium with it, so that particles as quadrature points are exact there;
    /// a point load against their sum is not. Beyond one dimension no even state fits a load, and none is taken.
    pub(super) fn even_load(&self, forcing: &Forcing<T, D>) -> EvenLoad<T> {
        let mut even = EvenLoad {
            stress: T::zero(),
            pressure: T::zero(),
        };
        if D > 1 {
            return even;
        }
        let free = |point: &&SurfacePoint<T>| !is_held(forcing, point);
        if let Some(point) = self.surface.iter().find(free) {
            even.stress = traction(forcing, point)[0] * point.outward();
        }
        let pressures = self.surface.iter().map(|point| forcing.pores(point.face));
        for condition in pressures {
            if let PoreCondition::Pressure(pressure) = condition {
                even.pressure = pressure;
                break;
            }
        }
        even
    }

    /// What loads the surfaces besides the even part: tractions on the whole, pressures on the liquid where it passes.
    pub(super) fn add_uneven_loads(&mut self, even: &EvenLoad<T>, forcing: &Forcing<T, D>) {
        for k in 0..self.surface.len() {
            let point = &self.surface[k];
            let (axis, area, outward) = (point.face.axis, point.area, point.outward());
            let mut load = SVector::zeros();
            if !is_held(forcing, point) {
                load = traction(forcing, point);
                load[axis] -= even.stress * outward;
            }
            let pressure = match forcing.pores(point.face) {
                PoreCondition::Pressure(pressure) => (pressure - even.pressure) * outward,
                PoreCondition::Sealed => T::zero(),
            };
            let x = self.surface_position(point);
            let cell = self.bins.cell_of(point.particle);
            let (whole, liquid) = (&mut self.dofs.force, &mut self.liquid.force);
            self.basis.for_each(&self.grid, cell, &x, |i, phi, _| {
                whole[i] += load * (area * phi);
                liquid[i][axis] += pressure * area * phi;
            });
        }
    }

    /// A surface that the liquid does not pass: the pressure there is whatever keeps the liquid's velocity at the end of the
    /// step equal to the solid's. One equation a surface, since a pressure `P` on the liquid alone changes
    /// `a_w - a_s` of DOF `i` by `P phi_i (m_s + mbar) / det`.
    pub(super) fn seal_surfaces(&mut self, dt: T, forcing: &Forcing<T, D>) {
        for k in 0..self.surface.len() {
            let point = &self.surface[k];
            if !is_sealed(forcing, point) {
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
