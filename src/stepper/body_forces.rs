//! Body forces that differ from particle to particle.

use nalgebra::SVector;

use super::Stepper;
use crate::basis::BasisFamily;
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
    /// Sets the force per mass (N/kg) of every particle, a function of where it was at the start, beside the uniform one of
    /// [`super::Forcing`]. It acts in every step until it is set again; the first call allocates. Steps of one phase only.
    pub fn set_body_forces(&mut self, mut force: impl FnMut(&SVector<T, D>) -> SVector<T, D>) {
        self.body_forces.clear();
        let points = self.particles.initial_position.iter();
        self.body_forces.extend(points.map(&mut force));
    }

    /// `f_i += sum_p m_p b_p phi_i(x_p)`.
    pub(super) fn add_body_forces(&mut self) {
        let (basis, grid, force) = (&self.basis, &self.grid, &mut self.dofs.force);
        let particles = self.particles.mass.iter().zip(&self.particles.position);
        for ((b, (&mass, x)), cell) in self.body_forces.iter().zip(particles).zip(self.bins.cells()) {
            basis.for_each(grid, cell, x, |i, phi, _| force[i] += b * (mass * phi));
        }
    }
}
