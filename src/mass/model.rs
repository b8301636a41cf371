//! What momenta of DOFs are divided by, as types.

use std::fmt::Debug;

/// Which mass turns the DOFs' momentum into their velocity, for reconstructions that fit the density of mass:
/// the acceleration then divides by the lumped mass of the particles (journal section 5.4).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum VelocityMass {
    /// The matrix `integral(rho phi_i phi_j)`, solved with a banded factorisation in one dimension and by
    /// preconditioned conjugate gradients beyond; held DOFs are then overwritten with what they are told, as
    /// published.
    Consistent,
    /// The same matrix, solved under the constraint that the held DOFs have what they are told. Overwriting
    /// leaves the neighbours of a held DOF as if it were free, an error of one order less in the strain of
    /// the cells at the wall.
    Constrained,
    /// Its row sums `integral(rho phi_i)`.
    #[default]
    Lumped,
}

impl VelocityMass {
    /// Name in scenes.
    pub fn name(self) -> &'static str {
        match self {
            Self::Consistent => "consistent",
            Self::Constrained => "constrained",
            Self::Lumped => "lumped",
        }
    }
}

/// The particles' lumped masses `sum_p m_p phi_i`, in acceleration and velocity: nothing is fitted, and there
/// is nothing to choose.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct ParticleMass;

/// The particles' consistent matrix `sum_p m_p phi_i phi_j`, in acceleration and velocity, held DOFs
/// eliminated from both.
///
/// Beyond one dimension it goes with a filter that says which cells their particles determine
/// ([`NullSpace`](crate::reconstruction::NullSpace)): the matrix has no inverse where they do not.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct ParticleMatrix;

/// What the momenta of DOFs are divided by, as a reconstruction has it: [`ParticleMass`],
/// [`ParticleMatrix`], or a choice of [`VelocityMass`] where densities are fitted. Nobody else can implement
/// it.
pub trait MassModel: Copy + Debug + Default + PartialEq + Send + Sync + 'static + sealed::Divides {
    /// Whether masses and momenta of DOFs are sums over the particles, and nothing is fitted.
    const OF_PARTICLES: bool;

    /// Whether accelerations too are solved with a consistent matrix.
    const IN_ACCELERATION: bool = false;

    /// The one of this name in scenes; `None` if the reconstruction has no such mass.
    fn named(name: VelocityMass) -> Option<Self>;

    /// The one of this name or, where the reconstruction has no such mass, the one that it has: for what is
    /// written for many reconstructions.
    fn preferring(name: VelocityMass) -> Self {
        Self::named(name).unwrap_or_default()
    }
}

impl MassModel for ParticleMass {
    const OF_PARTICLES: bool = true;

    /// They are lumped.
    fn named(name: VelocityMass) -> Option<Self> {
        (name == VelocityMass::Lumped).then_some(Self)
    }
}

impl MassModel for ParticleMatrix {
    const OF_PARTICLES: bool = true;
    const IN_ACCELERATION: bool = true;

    /// Held DOFs are eliminated: overwritten walls would tear at an acceleration that knows nothing of them.
    fn named(name: VelocityMass) -> Option<Self> {
        (name == VelocityMass::Constrained).then_some(Self)
    }
}

impl MassModel for VelocityMass {
    const OF_PARTICLES: bool = false;

    fn named(name: Self) -> Option<Self> {
        Some(name)
    }
}

/// What forces and momenta of DOFs are divided by, as a step asks. Forces are by the particles' lumped masses
/// but for [`Divisor::ParticleMatrix`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Divisor {
    /// Lumped masses of the particles.
    Particles,
    /// Row sums of fitted masses.
    FittedLumped,
    /// The consistent matrix of fitted masses; held DOFs are overwritten or, if told so, eliminated.
    FittedMatrix { constrained: bool },
    /// The particles' consistent matrix, held DOFs eliminated.
    ParticleMatrix,
}

impl Divisor {
    /// Whether there is a matrix.
    pub fn has_matrix(self) -> bool {
        matches!(self, Self::FittedMatrix { .. } | Self::ParticleMatrix)
    }

    /// Whether held DOFs are eliminated from the matrix.
    pub fn is_constrained(self) -> bool {
        matches!(
            self,
            Self::FittedMatrix { constrained: true } | Self::ParticleMatrix
        )
    }
}

/// Out of reach of other crates.
pub(crate) mod sealed {
    use super::{Divisor, ParticleMass, ParticleMatrix, VelocityMass};

    /// What a step asks of a mass model. One number, not a type, tells the choices of [`VelocityMass`] apart:
    /// no stage is compiled for each of them.
    pub trait Divides {
        /// What it is at run time.
        fn divisor(self) -> Divisor;
    }

    impl Divides for ParticleMass {
        fn divisor(self) -> Divisor {
            Divisor::Particles
        }
    }

    impl Divides for ParticleMatrix {
        fn divisor(self) -> Divisor {
            Divisor::ParticleMatrix
        }
    }

    impl Divides for VelocityMass {
        fn divisor(self) -> Divisor {
            match self {
                Self::Lumped => Divisor::FittedLumped,
                Self::Consistent => Divisor::FittedMatrix { constrained: false },
                Self::Constrained => Divisor::FittedMatrix { constrained: true },
            }
        }
    }
}
