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

/// The first terms of the Neumann series of the inverse of the particles' consistent matrix $M$,
/// $\sum_{j \lt k} (1 - L^{-1} M)^j L^{-1}$ with its row sums $L$, in acceleration and velocity: FMPM(k) (Nairn
/// & Hammerquist 2021, CMAME 377, 113681). One term is the lumped mass, many are [`ParticleMatrix`].
///
/// Beyond one axis the linear functions of free bodies are those of the matrix itself, so that angular
/// momentum is kept to round-off.
#[doc = include_str!("../../docs/formulas.html")]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ParticleSeries(u8);

impl ParticleSeries {
    /// With so many terms; at least one is taken. Eight suit elastic bodies; fluids and sand, whose stresses
    /// are rough, two to four. The largest stable step of many terms is smaller: against the lumped mass by
    /// the root of 1.93 with four and of 3.54 with eight.
    pub fn of(terms: u8) -> Self {
        Self(terms.max(1))
    }

    /// Number of terms.
    pub fn terms(self) -> u8 {
        self.0
    }
}

impl Default for ParticleSeries {
    /// Eight terms.
    fn default() -> Self {
        Self(8)
    }
}

/// What the momenta of DOFs are divided by, as a reconstruction has it: [`ParticleMass`],
/// [`ParticleMatrix`], [`ParticleSeries`], or a choice of [`VelocityMass`] where densities are fitted. Nobody
/// else can implement it.
pub trait MassModel: Copy + Debug + Default + PartialEq + Send + Sync + 'static + sealed::Divides {
    /// Whether masses and momenta of DOFs are sums over the particles, and nothing is fitted.
    const OF_PARTICLES: bool;

    /// Whether accelerations too are solved with a consistent matrix.
    const IN_ACCELERATION: bool = false;

    /// Whether they are terms of a series, with the linear functions of free bodies apart.
    const SERIES: bool = false;

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

impl MassModel for ParticleSeries {
    const OF_PARTICLES: bool = true;
    const IN_ACCELERATION: bool = true;
    const SERIES: bool = true;

    /// Held DOFs have what they are told in every term.
    fn named(name: VelocityMass) -> Option<Self> {
        (name == VelocityMass::Constrained).then(Self::default)
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
    /// So many terms of the series of its inverse.
    ParticleSeries(u8),
}

impl Divisor {
    /// Whether accelerations too are solved with it.
    pub fn is_in_acceleration(self) -> bool {
        matches!(self, Self::ParticleMatrix | Self::ParticleSeries(_))
    }

    /// Whether it is a series.
    pub fn is_series(self) -> bool {
        matches!(self, Self::ParticleSeries(_))
    }

    /// Whether there is a matrix.
    pub fn has_matrix(self) -> bool {
        matches!(
            self,
            Self::FittedMatrix { .. } | Self::ParticleMatrix | Self::ParticleSeries(_)
        )
    }

    /// Whether held DOFs are eliminated from the matrix.
    pub fn is_constrained(self) -> bool {
        matches!(
            self,
            Self::FittedMatrix { constrained: true } | Self::ParticleMatrix | Self::ParticleSeries(_)
        )
    }
}

/// Out of reach of other crates.
pub(crate) mod sealed {
    use super::{Divisor, ParticleMass, ParticleMatrix, ParticleSeries, VelocityMass};

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

    impl Divides for ParticleSeries {
        fn divisor(self) -> Divisor {
            Divisor::ParticleSeries(self.terms())
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
