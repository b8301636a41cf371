//! Body forces that differ from particle to particle.

use nalgebra::SVector;

use super::Stepper;
use super::order::Order;
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
    /// Sets the force per mass (N/kg) of every particle, a function of where it was at the start, beside the
    /// uniform one of [`super::Forcing`]. It acts in every step until it is set again; the first call
    /// allocates. Where a liquid flows through the pores it is the force per mass of both, the solid and the
    /// liquid that the particle holds.
    pub fn set_body_forces(&mut self, mut force: impl FnMut(&SVector<T, D>) -> SVector<T, D>) {
        let initial = &self.particles.initial_position;
        at_particles(initial, &self.order, &mut force, &mut self.body_forces);
    }

    /// `f_i += sum_p m_p b_p phi_i(x_p)`.
    pub(super) fn add_body_forces(&mut self) {
        if P::FLOWS {
            return self.add_body_forces_to_both();
        }
        let (basis, grid, force) = (&self.basis, &self.grid, &mut self.dofs.force);
        let load = &mut self.balance.load;
        let sites = self.particles.sites(self.bins.cells());
        for (place, &mass) in self.particles.mass.iter().enumerate() {
            let weight = self.body_forces[self.order.number(place)] * mass;
            *load += weight;
            sites.for_each(basis, grid, place, |i, phi, _| force[i] += weight * phi);
        }
    }

    /// The same of two: the mixture feels `(m_s + n m_w) b`, the liquid, whose balance is per porosity `n`,
    /// feels `m_w b`.
    fn add_body_forces_to_both(&mut self) {
        let (basis, grid, phase) = (&self.basis, &self.grid, &self.phase);
        let (whole, liquid) = (&mut self.dofs.force, &mut self.liquid.force);
        let inverse = T::one() / phase.porosity();
        let bodies = self.particles.mass.iter().zip(&self.particles.volume);
        let sites = self.particles.sites(self.bins.cells());
        for (place, (&solid_mass, &volume)) in bodies.enumerate() {
            let force = self.body_forces[self.order.number(place)];
            let liquid_mass = phase.liquid_mass(volume);
            let (on_whole, on_liquid) = (
                force * (solid_mass + liquid_mass),
                force * (liquid_mass * inverse),
            );
            sites.for_each(basis, grid, place, |i, phi, _| {
                whole[i] += on_whole * phi;
                liquid[i] += on_liquid * phi;
            });
        }
    }
}

/// The `forces` of all particles, a function of where they were at the start.
#[inline(never)]
fn at_particles<T: Scalar, const D: usize>(
    initial: &[SVector<T, D>],
    order: &Order,
    force: &mut dyn FnMut(&SVector<T, D>) -> SVector<T, D>,
    forces: &mut Vec<SVector<T, D>>,
) {
    // By the particles' numbers: their order in memory may change before a step uses them.
    forces.resize(initial.len(), SVector::zeros());
    for (place, x) in initial.iter().enumerate() {
        forces[order.number(place)] = force(x);
    }
}
