//! All that a stepper is made of.

use super::SurfacePoint;
use crate::grid::Grid;
use crate::law::LawSweep;
use crate::particles::Particles;
use crate::phase::Phase;
use crate::reconstruction::Reconstruction;
use crate::scalar::Scalar;
use crate::transfer::{Flip, Transfer};

/// All that a [`Stepper`](super::Stepper) is made of: [`Setup::new`] names what every one needs, and the rest
/// is added where it is wanted.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Setup<T, const D: usize, B, R, L: LawSweep<T, D>, P: Phase<T, D>, X: Transfer<T, D> = Flip>
where
    T: Scalar,
    R: Reconstruction<T, D>,
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
    /// Mass behind the DOF velocities, one of those that the reconstruction has.
    pub velocity_mass: R::Mass,
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
    R: Reconstruction<T, D>,
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
            velocity_mass: R::Mass::default(),
            particles,
            memory: Vec::new(),
            surface: Vec::new(),
        }
    }
}

impl<T, const D: usize, B, R, L, P, X> Setup<T, D, B, R, L, P, X>
where
    T: Scalar,
    R: Reconstruction<T, D>,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
    X: Transfer<T, D>,
{
    /// With another mass behind the DOF velocities, where the reconstruction has a choice: a
    /// [`VelocityMass`](crate::mass::VelocityMass) for fits of the density. One that it does not have does
    /// not compile:
    ///
    /// ```compile_fail,E0308
    /// use materialpoint::basis::Linear;
    /// use materialpoint::grid::Grid;
    /// use materialpoint::law::{LinearElastic, Moduli};
    /// use materialpoint::mass::VelocityMass;
    /// use materialpoint::particles::{Particles, lattice};
    /// use materialpoint::phase::OnePhase;
    /// use materialpoint::reconstruction::Shepard; // lumps always
    /// use materialpoint::stepper::Setup;
    /// use nalgebra::vector;
    ///
    /// let grid = Grid::new(vector![0.0], vector![1.0], [4]).unwrap();
    /// let particles = Particles::at_rest(&lattice(&grid, grid.min(), grid.max(), [2]), 1.0);
    /// let law = LinearElastic { moduli: Moduli::uniaxial(1.0).unwrap() };
    /// Setup::new(grid, Linear, Shepard, law, OnePhase, particles)
    ///     .with_velocity_mass(VelocityMass::Consistent);
    /// ```
    #[must_use]
    pub fn with_velocity_mass(self, velocity_mass: R::Mass) -> Self {
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
