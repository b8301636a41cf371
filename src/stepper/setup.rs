//! All that a stepper is made of.

use super::SurfacePoint;
use crate::grid::Grid;
use crate::law::LawSweep;
use crate::mass::VelocityMass;
use crate::particles::Particles;
use crate::phase::Phase;
use crate::scalar::Scalar;
use crate::transfer::{Flip, Transfer};

/// All that a [`Stepper`](super::Stepper) is made of: [`Setup::new`] names what every one needs, and the rest
/// is added where it is wanted.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Setup<T, const D: usize, B, R, L: LawSweep<T, D>, P: Phase<T, D>, X: Transfer<T, D> = Flip>
where
    T: Scalar,
{
    /// Background grid.
    pub grid: Grid<T, D>,
    /// Basis family.
    pub basis: B,
    /// Reconstruction.
    pub reconstruction: R,
    /// Constitutive law.
    pub law: L,
    /// Phases.
    pub phase: P,
    /// How velocities reach the grid and come back.
    pub transfer: X,
    /// Mass behind the DOF velocities; [`crate::reconstruction::Shepard`] lumps always and
    /// [`crate::reconstruction::RelaxedTaylor`] constrains always.
    pub velocity_mass: VelocityMass,
    /// Particles in their initial state.
    pub particles: Particles<T, D, L::Number, P::Particle>,
    /// What the transfer remembers of each particle; empty if nothing yet.
    pub memory: Vec<X::Particle>,
    /// Particles at the surfaces that carry tractions or, with a liquid in the pores, pressures: there, every
    /// surface of a body that is not held. So too along one axis with any reconstruction but those by
    /// particle sums: fits end there.
    pub surface: Vec<SurfacePoint<T>>,
}

impl<T, const D: usize, B, R, L, P> Setup<T, D, B, R, L, P>
where
    T: Scalar,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
{
    /// Particles on a grid, FLIP, lumped mass behind the DOF velocities, no loaded surfaces.
    pub fn new(
        grid: Grid<T, D>,
        basis: B,
        reconstruction: R,
        law: L,
        phase: P,
        particles: Particles<T, D, L::Number, P::Particle>,
    ) -> Self {
        Self {
            grid,
            basis,
            reconstruction,
            law,
            phase,
            transfer: Flip,
            velocity_mass: VelocityMass::Lumped,
            particles,
            memory: Vec::new(),
            surface: Vec::new(),
        }
    }
}

impl<T, const D: usize, B, R, L, P, X> Setup<T, D, B, R, L, P, X>
where
    T: Scalar,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
    X: Transfer<T, D>,
{
    /// With another mass behind the DOF velocities.
    #[must_use]
    pub fn with_velocity_mass(self, velocity_mass: VelocityMass) -> Self {
        Self {
            velocity_mass,
            ..self
        }
    }

    /// With particles at surfaces.
    #[must_use]
    pub fn with_surface(self, surface: Vec<SurfacePoint<T>>) -> Self {
        Self { surface, ..self }
    }

    /// With another transfer, which remembers nothing yet.
    #[must_use]
    pub fn with_transfer<Y: Transfer<T, D>>(self, transfer: Y) -> Setup<T, D, B, R, L, P, Y> {
        Setup {
            grid: self.grid,
            basis: self.basis,
            reconstruction: self.reconstruction,
            law: self.law,
            phase: self.phase,
            transfer,
            velocity_mass: self.velocity_mass,
            particles: self.particles,
            memory: Vec::new(),
            surface: self.surface,
        }
    }

    /// With what the transfer remembers of each particle.
    #[must_use]
    pub fn with_memory(self, memory: Vec<X::Particle>) -> Self {
        Self { memory, ..self }
    }
}
