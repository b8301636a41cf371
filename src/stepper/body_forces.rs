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
        // By the particles' numbers: their order in memory may change before a step uses them.
        self.body_forces.resize(self.particles.len(), SVector::zeros());
        for (place, x) in self.particles.initial_position.iter().enumerate() {
            self.body_forces[self.order.number(place)] = force(x);
        }
    }

    /// `f_i += sum_p m_p b_p phi_i(x_p)`.
    pub(super) fn add_body_forces(&mut self) {
        let (basis, grid, force) = (&self.basis, &self.grid, &mut self.dofs.force);
        let load = &mut self.balance.load;
        let particles = self.particles.mass.iter().zip(&self.particles.position);
        for (place, ((&mass, x), cell)) in particles.zip(self.bins.cells()).enumerate() {
            let weight = self.body_forces[self.order.number(place)] * mass;
            *load += weight;
            basis.for_each(grid, cell, x, |i, phi, _| force[i] += weight * phi);
        }
    }
}
