//! The sweeps of a basis and a reconstruction behind a pointer.
//!
//! For what takes many sweeps and is compiled for no method: the list of stages, impulses of walls, critical
//! steps. A call through a pointer for each sweep over all particles costs nothing.

use super::fitted::Fitted;
use super::inner::Inner;
use super::sums::Targets;
use super::{Forcing, Stepper, cloud};
use crate::basis::BasisFamily;
use crate::error::StepError;
use crate::law::LawSweep;
use crate::parallel::{CELLS, PARTICLES, are_many};
use crate::phase::Phase;
use crate::reconstruction::{Reconstruction, Streams, Stresses};
use crate::scalar::Scalar;
use crate::transfer::Transfer;

/// Any stepper of a law, phases and a transfer.
pub(super) trait Sweeps<T, const D: usize, L, P, X>: Send
where
    T: Scalar,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
    X: Transfer<T, D>,
{
    /// What of it is of no basis and no reconstruction.
    fn inner(&mut self) -> &mut Inner<T, D, L, P, X>;

    /// Whether a step is worth being sent to a pool of threads.
    fn is_worth_sending(&self) -> bool;

    /// Takes in where the particles are.
    fn prepare(&mut self);

    /// The stages that end with the velocities of particles and DOFs.
    fn kick(&mut self, dt: T, forcing: &Forcing<T, D>);

    /// Those that follow: what diffuses, positions, strains and stresses of the particles.
    fn drift(&mut self, dt: T, forcing: &Forcing<T, D>) -> Result<(), StepError>;

    /// G2P of the accelerations over a time (s).
    fn kick_particles(&mut self, dt: T);

    /// P2G of the momenta, of both phases.
    fn map_momenta(&mut self);

    /// P2G of the masses, of the solid alone.
    fn sum_solid_masses(&mut self);

    /// P2G of the momenta, of the solid alone.
    fn map_solid(&mut self);

    /// G2P of velocity gradients, and P2G of the forces of the stresses that they make in one second.
    fn map_stress_rates(&mut self);

    /// G2P of the accelerations of the solid alone over a time (s).
    fn kick_solid(&mut self, dt: T);

    /// See [`Inner::largest_ratio`].
    fn largest_ratio(&self, held: &[bool], amounts: Option<[&[T]; 2]>) -> T;
}

impl<T, const D: usize, B, R, L, P, X> Sweeps<T, D, L, P, X> for Stepper<T, D, B, R, L, P, X>
where
    T: Scalar,
    B: BasisFamily<T, D>,
    R: Reconstruction<T, D>,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
    X: Transfer<T, D>,
{
    fn inner(&mut self) -> &mut Inner<T, D, L, P, X> {
        &mut self.inner
    }

    fn is_worth_sending(&self) -> bool {
        let inner = &self.inner;
        let cells = match R::Points::AT_PARTICLES {
            true => 0,
            false => inner.bins.occupied().len(),
        };
        are_many::<D>(inner.particles.len(), PARTICLES) || are_many::<D>(cells, CELLS)
    }

    fn kick(&mut self, dt: T, forcing: &Forcing<T, D>) {
        self.kick(dt, forcing);
    }

    fn drift(&mut self, dt: T, forcing: &Forcing<T, D>) -> Result<(), StepError> {
        self.inner.diffuse(&self.basis, dt, forcing)?;
        self.inner.drift(&self.basis, dt)
    }

    fn prepare(&mut self) {
        self.prepare();
    }

    fn kick_particles(&mut self, dt: T) {
        self.kick_particles(dt);
    }

    fn map_momenta(&mut self) {
        self.map_momenta();
    }

    fn sum_solid_masses(&mut self) {
        self.sum_solid_masses();
    }

    fn map_solid(&mut self) {
        self.map_solid();
    }

    fn map_stress_rates(&mut self) {
        let batched = self.batched();
        let inner = &mut self.inner;
        let rates = inner.stress_rates(&self.basis);
        let fitted = Fitted {
            basis: &self.basis,
            cloud: cloud(&inner.grid, &inner.bins, &inner.particles, &inner.cuts),
            domains: inner.particles.domains.views(),
            reconstruction: &mut self.reconstruction,
            spans: &mut inner.spans,
            batched,
        };
        let force = Targets::<T, D, 0, 0, 1>::of_forces([&mut inner.dofs.force]);
        fitted.forces::<1>(Stresses(&rates), force);
    }

    fn kick_solid(&mut self, dt: T) {
        self.inner.kick_phases::<_, 1, 0>(&self.basis, dt);
    }

    fn largest_ratio(&self, held: &[bool], amounts: Option<[&[T]; 2]>) -> T {
        self.inner.largest_ratio(&self.basis, held, amounts)
    }
}
