//! Values at the particles.

use nalgebra::SVector;

use crate::field::{Field, MassMomentum};
use crate::lanes::{LANES, Lanes};
use crate::scalar::Scalar;

/// A field at the particles, by their numbers: any function of those, or what knows more ways to be asked.
pub trait Values<T: Scalar, Q: Field<T>> {
    /// The value at one particle.
    fn at(&self, particle: usize) -> Q;

    /// The components, `C` at most, of the values at four particles that follow each other, one particle in each lane.
    #[inline(always)]
    fn four<V: Lanes<T>, const C: usize>(&self, first: usize) -> [V; C] {
        lanes_of(|l| self.at(first + l))
    }
}

impl<T: Scalar, Q: Field<T>, F: Fn(usize) -> Q> Values<T, Q> for F {
    #[inline(always)]
    fn at(&self, particle: usize) -> Q {
        self(particle)
    }
}

/// Values that lie end to end in memory: four of a scalar are one load.
#[derive(Clone, Copy, Debug)]
pub struct Stored<'a, Q>(pub &'a [Q]);

impl<T: Scalar, Q: Field<T>> Values<T, Q> for Stored<'_, Q> {
    #[inline(always)]
    fn at(&self, particle: usize) -> Q {
        self.0[particle]
    }

    #[inline(always)]
    fn four<V: Lanes<T>, const C: usize>(&self, first: usize) -> [V; C] {
        let mut components = [V::splat(T::zero()); C];
        for q in 0..Q::COMPONENTS.min(C) {
            components[q] = four_of(self.0, first, components[q], |four| {
                V::new(std::array::from_fn(|l| four[l].component(q)))
            });
        }
        components
    }
}

/// Densities of mass and momentum.
#[derive(Clone, Copy, Debug)]
pub struct Densities<'a, T, const D: usize> {
    /// Masses of the particles.
    pub masses: &'a [T],
    /// Their velocities.
    pub velocities: &'a [SVector<T, D>],
    /// Their volumes.
    pub volumes: &'a [T],
}

impl<T: Scalar, const D: usize> Values<T, MassMomentum<T, D>> for Densities<'_, T, D> {
    #[inline(always)]
    fn at(&self, particle: usize) -> MassMomentum<T, D> {
        let density = self.masses[particle] / self.volumes[particle];
        MassMomentum {
            mass: density,
            momentum: self.velocities[particle] * density,
        }
    }

    #[inline(always)]
    fn four<V: Lanes<T>, const C: usize>(&self, first: usize) -> [V; C] {
        let density: V = four_numbers::<T, V>(self.masses, first) / four_numbers(self.volumes, first);
        let mut components = [density; C];
        for a in 0..D.min(C - 1) {
            components[1 + a] = four_components::<T, V, D>(self.velocities, first, a) * density;
        }
        components
    }
}

/// What `make` makes of four values that follow each other, `nothing` where there are not so many. It is asked in one branch
/// alone: four numbers are then one load.
#[inline(always)]
pub(super) fn four_of<A, V>(values: &[A], first: usize, nothing: V, make: impl Fn(&[A; LANES]) -> V) -> V {
    match values[first..first + LANES].first_chunk() {
        Some(four) => make(four),
        // Never.
        None => nothing,
    }
}

/// Four numbers that follow each other.
#[inline(always)]
pub(super) fn four_numbers<T: Scalar, V: Lanes<T>>(values: &[T], first: usize) -> V {
    four_of(values, first, V::splat(T::zero()), |&four| V::new(four))
}

/// A component of four vectors that follow each other.
#[inline(always)]
pub(super) fn four_components<T: Scalar, V: Lanes<T>, const D: usize>(
    vectors: &[SVector<T, D>],
    first: usize,
    component: usize,
) -> V {
    four_of(vectors, first, V::splat(T::zero()), |four| {
        V::new(std::array::from_fn(|l| four[l][component]))
    })
}

/// The components of four values, the `l`-th of which is `value(l)`.
#[inline(always)]
pub(super) fn lanes_of<T: Scalar, V: Lanes<T>, Q: Field<T>, const C: usize>(
    value: impl Fn(usize) -> Q,
) -> [V; C] {
    let values: [Q; LANES] = std::array::from_fn(value);
    let mut components = [V::splat(T::zero()); C];
    for q in 0..Q::COMPONENTS {
        components[q] = V::new(std::array::from_fn(|l| values[l].component(q)));
    }
    components
}
