//! Body forces that differ from particle to particle.

use nalgebra::SVector;

use super::Stepper;
use super::inner::Inner;
use super::order::Order;
use crate::basis::BasisFamily;
use crate::grid::Grid;
use crate::law::LawSweep;
use crate::phase::Phase;
use crate::reconstruction::Reconstruction;
use crate::scalar::Scalar;
use crate::transfer::{Sites, Transfer};

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
        self.inner.set_body_forces(&mut force);
    }
}

impl<T, const D: usize, L, P, X> Inner<T, D, L, P, X>
where
    T: Scalar,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
    X: Transfer<T, D>,
{
    /// See [`Stepper::set_body_forces`].
    #[inline(never)]
    fn set_body_forces(&mut self, force: &mut dyn FnMut(&SVector<T, D>) -> SVector<T, D>) {
        let initial = &self.particles.initial_position;
        at_particles(initial, &self.order, force, &mut self.body_forces);
    }

    /// `f_i += sum_p m_p b_p phi_i(x_p)`.
    pub(super) fn add_body_forces<B: BasisFamily<T, D>>(&mut self, basis: &B) {
        if const { P::FLOWS } {
            return self.add_body_forces_to_both(basis);
        }
        self.balance.load += add_weights(
            (basis, &self.grid, self.particles.sites(self.bins.cells())),
            &self.particles.mass,
            (&self.body_forces, &self.order),
            &mut self.dofs.force,
        );
    }

    /// The same of two: the mixture feels `(m_s + n m_w) b`, the liquid, whose balance is per porosity `n`,
    /// feels `m_w b`.
    fn add_body_forces_to_both<B: BasisFamily<T, D>>(&mut self, basis: &B) {
        add_weights_of_both(
            (basis, &self.grid, self.particles.sites(self.bins.cells())),
            (&self.particles.mass, &self.particles.volume),
            &self.phase,
            (&self.body_forces, &self.order),
            [&mut self.dofs.force, &mut self.liquid.force],
        );
    }
}

/// Where particles are, and in which functions they are seen.
type Space<'a, T, const D: usize, B> = (&'a B, &'a Grid<T, D>, Sites<'a, T, D>);

/// Adds the weights of particles, whose forces per mass are given by their numbers; returns their sum.
#[inline(never)]
fn add_weights<T: Scalar, const D: usize, B: BasisFamily<T, D>>(
    (basis, grid, sites): Space<'_, T, D, B>,
    masses: &[T],
    (body_forces, order): (&[SVector<T, D>], &Order),
    force: &mut [SVector<T, D>],
) -> SVector<T, D> {
    let mut load = SVector::zeros();
    for (place, &mass) in masses.iter().enumerate() {
        let weight = body_forces[order.number(place)] * mass;
        load += weight;
        sites.for_each(basis, grid, place, |i, phi, _| force[i] += weight * phi);
    }
    load
}

/// The same of both phases.
#[inline(never)]
fn add_weights_of_both<T: Scalar, const D: usize, B: BasisFamily<T, D>, P: Phase<T, D>>(
    (basis, grid, sites): Space<'_, T, D, B>,
    (masses, volumes): (&[T], &[T]),
    phase: &P,
    (body_forces, order): (&[SVector<T, D>], &Order),
    [whole, liquid]: [&mut [SVector<T, D>]; 2],
) {
    let inverse = T::one() / phase.porosity();
    for (place, (&solid_mass, &volume)) in masses.iter().zip(volumes).enumerate() {
        let force = body_forces[order.number(place)];
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
