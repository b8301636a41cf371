//! Material points: what they carry, how a body is filled with them, which cell holds them.

mod bearable;
mod bins;
mod cast;
mod domains;
mod lattice;
mod movable;
mod start;

pub(crate) use bins::settle;
pub use bins::{Bins, Outside};
pub(crate) use domains::DomainViews;
pub use domains::Domains;
pub use lattice::{Lattice, lattice};
pub(crate) use movable::{Material, ParticleViews, Places};

use nalgebra::{SMatrix, SVector};

use crate::error::SetupError;
use crate::scalar::Scalar;

/// Bytes allocated; none for values without a size, however many.
fn allocated<A>(values: &Vec<A>) -> usize {
    values.capacity().saturating_mul(size_of::<A>())
}

/// Particle data, one array per quantity. `S` is the law's state and `P` the second phase's data per
/// particle; both are `()` where nothing is needed and then take no memory.
#[derive(Clone, Debug, Default)]
pub struct Particles<T, const D: usize, S = (), P = ()> {
    /// Position at the start (m).
    pub initial_position: Vec<SVector<T, D>>,
    /// Position (m).
    pub position: Vec<SVector<T, D>>,
    /// Displacement (m). Carried beside the position because `x - x0` loses the digits of a small one.
    pub displacement: Vec<SVector<T, D>>,
    /// Velocity (m/s); it lives half a step before the position (Euler-Cromer).
    pub velocity: Vec<SVector<T, D>>,
    /// Cauchy stress, tension positive (Pa).
    pub stress: Vec<SMatrix<T, D, D>>,
    /// Mass (1-D: kg/m2, 2-D: kg/m, 3-D: kg), constant.
    pub mass: Vec<T>,
    /// Volume (1-D: m, 2-D: m2, 3-D: m3).
    pub volume: Vec<T>,
    /// State of the constitutive law: one of each particle, or as many numbers as an
    /// [`AnyLaw`](crate::law::AnyLaw) remembers.
    pub state: Vec<S>,
    /// Data of the second phase.
    pub phase: Vec<P>,
    /// Domains, for a basis that asks for them: empty before the start if they are to be found from the
    /// layout, and always where the basis asks for none.
    pub domains: Domains<T, D>,
}

impl<T: Scalar, const D: usize, S: Copy + Default, P: Copy + Default> Particles<T, D, S, P> {
    /// Particles at rest and free of stress.
    ///
    /// `points` gives position (m) and volume of each, `density` is the common mass density (kg/m3).
    pub fn at_rest(points: &[(SVector<T, D>, T)], density: T) -> Self {
        Self::from_points(points.iter().copied(), density)
    }

    /// The same from points that come one by one.
    pub fn from_points(points: impl Iterator<Item = (SVector<T, D>, T)>, density: T) -> Self {
        let (position, volume): (Vec<_>, Vec<_>) = points.unzip();
        let n = position.len();
        Self {
            initial_position: position.clone(),
            position,
            displacement: vec![SVector::zeros(); n],
            velocity: vec![SVector::zeros(); n],
            stress: vec![SMatrix::zeros(); n],
            mass: volume.iter().map(|&v| v * density).collect(),
            volume,
            state: vec![S::default(); n],
            phase: vec![P::default(); n],
            domains: Domains::none(),
        }
    }

    /// Number of particles.
    pub fn len(&self) -> usize {
        self.position.len()
    }

    /// Whether there is no particle.
    pub fn is_empty(&self) -> bool {
        self.position.is_empty()
    }

    /// Mass density of a particle (kg/m3).
    #[inline(always)]
    pub fn density(&self, p: usize) -> T {
        self.mass[p] / self.volume[p]
    }

    /// Those of the given numbers, in that order; their states take so many numbers each.
    pub(crate) fn picked(&self, numbers: &[usize], numbers_each: usize) -> Self {
        fn pick<A: Copy>(values: &[A], numbers: &[usize]) -> Vec<A> {
            numbers.iter().map(|&p| values[p]).collect()
        }
        let state_of = |p: usize| &self.state[p * numbers_each..(p + 1) * numbers_each];
        Self {
            initial_position: pick(&self.initial_position, numbers),
            position: pick(&self.position, numbers),
            displacement: pick(&self.displacement, numbers),
            velocity: pick(&self.velocity, numbers),
            stress: pick(&self.stress, numbers),
            mass: pick(&self.mass, numbers),
            volume: pick(&self.volume, numbers),
            state: numbers.iter().flat_map(|&p| state_of(p)).copied().collect(),
            phase: pick(&self.phase, numbers),
            domains: self.domains.picked(numbers),
        }
    }

    /// What moves and deforms of each particle; their states take so many numbers each.
    pub(crate) fn movable(&mut self, numbers_each: usize) -> ParticleViews<'_, T, D, S, P> {
        ParticleViews {
            position: &mut self.position,
            displacement: &mut self.displacement,
            stress: &mut self.stress,
            volume: &mut self.volume,
            state: &mut self.state,
            numbers_each,
            phase: &mut self.phase,
            half_lengths: &self.domains.half_lengths,
            half_edges: &mut self.domains.half_edges,
        }
    }

    /// Bytes that one particle takes in these arrays, without a domain.
    pub fn bytes_per_particle() -> usize {
        4 * size_of::<SVector<T, D>>()
            + size_of::<SMatrix<T, D, D>>()
            + 2 * size_of::<T>()
            + size_of::<S>()
            + size_of::<P>()
    }

    /// Bytes allocated in these arrays.
    pub fn bytes(&self) -> usize {
        let vectors = [
            &self.initial_position,
            &self.position,
            &self.displacement,
            &self.velocity,
        ];
        let vectors: usize = vectors.map(Vec::capacity).iter().sum();
        vectors * size_of::<SVector<T, D>>()
            + self.stress.capacity() * size_of::<SMatrix<T, D, D>>()
            + (self.mass.capacity() + self.volume.capacity()) * size_of::<T>()
            + allocated(&self.state)
            + allocated(&self.phase)
            + self.domains.bytes()
    }

    /// Checks lengths and values.
    ///
    /// # Errors
    /// If there is no particle, an array's length differs, a number is not finite, or a mass or volume is
    /// not positive.
    pub fn validate(&self) -> Result<(), SetupError> {
        self.validate_with(1)
    }

    /// The same of particles whose states take so many numbers each.
    pub(crate) fn validate_with(&self, numbers_each: usize) -> Result<(), SetupError> {
        if self.is_empty() {
            return Err(SetupError::NoParticles);
        }
        self.validate_lengths(numbers_each)?;
        for p in 0..self.len() {
            self.validate_particle(p)?;
        }
        Ok(())
    }

    fn validate_lengths(&self, numbers_each: usize) -> Result<(), SetupError> {
        let count = self.len();
        let lengths = [
            ("initial_position", self.initial_position.len()),
            ("displacement", self.displacement.len()),
            ("velocity", self.velocity.len()),
            ("stress", self.stress.len()),
            ("mass", self.mass.len()),
            ("volume", self.volume.len()),
            ("phase", self.phase.len()),
        ];
        let lengths = lengths.map(|(name, found)| (name, found, count));
        let states = ("state", self.state.len(), count * numbers_each);
        let domains = self.domains.lengths().filter(|&(_, found)| found > 0);
        let domains = domains.map(|(name, found)| (name, found, count));
        let mut lengths = lengths.into_iter().chain([states]).chain(domains);
        match lengths.find(|&(_, found, expected)| found != expected) {
            Some((name, found, expected)) => Err(SetupError::Lengths {
                name,
                found,
                expected,
            }),
            None => Ok(()),
        }
    }

    fn validate_particle(&self, particle: usize) -> Result<(), SetupError> {
        let refuse = |name, value: T, allowed| SetupError::Value {
            particle,
            name,
            value: value.primal(),
            allowed,
        };
        for (name, value) in [("mass", self.mass[particle]), ("volume", self.volume[particle])] {
            if !value.is_finite() || value <= T::zero() {
                return Err(refuse(name, value, "it must be positive and finite"));
            }
        }
        let vectors = [
            ("position", &self.position[particle]),
            ("displacement", &self.displacement[particle]),
            ("velocity", &self.velocity[particle]),
        ];
        for (name, vector) in vectors {
            if let Some(&bad) = vector.iter().find(|v| !v.is_finite()) {
                return Err(refuse(name, bad, "it must be finite"));
            }
        }
        match self.stress[particle].iter().find(|s| !s.is_finite()) {
            Some(&bad) => Err(refuse("stress", bad, "it must be finite")),
            None => Ok(()),
        }
    }
}
