//! Values at the particles.

use nalgebra::{SMatrix, SVector};

use crate::field::{Field, MassMomentum, Symmetric, symmetric_place};
use crate::scalar::Scalar;
use crate::simd::{LANES, Packs, each, in_lanes, inlined};

/// A field at the particles, by their numbers: any function of those, or what knows more ways to be asked.
pub trait Values<T: Scalar, Q: Field<T>> {
    /// The value at one particle.
    fn at(&self, particle: usize) -> Q;

    /// The components, `C` at most, of the values at four particles that follow each other, one particle in
    /// each lane.
    #[inline(always)]
    fn four<K: Packs<T>, const C: usize>(&self, k: K, first: usize) -> [K::V; C] {
        lanes_of(
            k,
            #[inline(always)]
            |l| self.at(first + l),
        )
    }

    /// The same of any four particles.
    #[inline(always)]
    fn lanes<K: Packs<T>, const C: usize>(&self, k: K, particles: &[usize; LANES]) -> [K::V; C] {
        lanes_of(
            k,
            #[inline(always)]
            |l| self.at(particles[l]),
        )
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
    fn four<K: Packs<T>, const C: usize>(&self, k: K, first: usize) -> [K::V; C] {
        let mut components = [k.splat(T::zero()); C];
        for q in 0..Q::COMPONENTS.min(C) {
            components[q] = four_of(
                self.0,
                first,
                components[q],
                #[inline(always)]
                |four| {
                    k.pack(in_lanes(
                        #[inline(always)]
                        |l| four[l].component(q),
                    ))
                },
            );
        }
        components
    }

    #[inline(always)]
    fn lanes<K: Packs<T>, const C: usize>(&self, k: K, particles: &[usize; LANES]) -> [K::V; C] {
        components_of::<T, K, Q, C>(
            k,
            #[inline(always)]
            |l, q| self.0[particles[l]].component(q),
        )
    }
}

/// Symmetric tensors that lie end to end in memory.
#[derive(Clone, Copy, Debug)]
pub struct Stresses<'a, T, const D: usize>(pub &'a [SMatrix<T, D, D>]);

impl<T: Scalar, const D: usize> Values<T, Symmetric<T, D>> for Stresses<'_, T, D> {
    #[inline(always)]
    fn at(&self, particle: usize) -> Symmetric<T, D> {
        Symmetric(self.0[particle])
    }

    #[inline(always)]
    fn four<K: Packs<T>, const C: usize>(&self, k: K, first: usize) -> [K::V; C] {
        let mut components = [k.splat(T::zero()); C];
        for q in 0..Symmetric::<T, D>::COMPONENTS.min(C) {
            components[q] = four_of(
                self.0,
                first,
                components[q],
                #[inline(always)]
                |four| {
                    k.pack(in_lanes(
                        #[inline(always)]
                        |l| Symmetric(four[l]).component(q),
                    ))
                },
            );
        }
        components
    }

    #[inline(always)]
    fn lanes<K: Packs<T>, const C: usize>(&self, k: K, particles: &[usize; LANES]) -> [K::V; C] {
        components_of::<T, K, Symmetric<T, D>, C>(
            k,
            #[inline(always)]
            |l, q| self.0[particles[l]][symmetric_place::<D>(q)],
        )
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
    fn four<K: Packs<T>, const C: usize>(&self, k: K, first: usize) -> [K::V; C] {
        let density =
            four_numbers::<T, K>(k, self.masses, first) / four_numbers::<T, K>(k, self.volumes, first);
        let mut components = [density; C];
        for a in 0..D.min(C - 1) {
            components[1 + a] = four_components::<T, K, D>(k, self.velocities, first, a) * density;
        }
        components
    }

    #[inline(always)]
    fn lanes<K: Packs<T>, const C: usize>(&self, k: K, particles: &[usize; LANES]) -> [K::V; C] {
        let numbers = inlined(
            #[inline(always)]
            |of: &[T]| {
                k.pack(in_lanes(
                    #[inline(always)]
                    |l| of[particles[l]],
                ))
            },
        );
        let density = numbers(self.masses) / numbers(self.volumes);
        let mut components = [density; C];
        for a in 0..D.min(C - 1) {
            let velocity = k.pack(in_lanes(
                #[inline(always)]
                |l| self.velocities[particles[l]][a],
            ));
            components[1 + a] = velocity * density;
        }
        components
    }
}

/// What `make` makes of four values that follow each other, `nothing` where there are not so many. It is
/// asked in one branch alone: four numbers are then one load.
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
pub(super) fn four_numbers<T: Scalar, K: Packs<T>>(k: K, values: &[T], first: usize) -> K::V {
    four_of(
        values,
        first,
        k.splat(T::zero()),
        #[inline(always)]
        |&four| k.pack(four),
    )
}

/// A component of four vectors that follow each other.
#[inline(always)]
pub(super) fn four_components<T: Scalar, K: Packs<T>, const D: usize>(
    k: K,
    vectors: &[SVector<T, D>],
    first: usize,
    component: usize,
) -> K::V {
    four_of(
        vectors,
        first,
        k.splat(T::zero()),
        #[inline(always)]
        |four| {
            k.pack(in_lanes(
                #[inline(always)]
                |l| four[l][component],
            ))
        },
    )
}

/// The components of four values, the `q`-th of the `l`-th of which is `component(l, q)`: copies of whole
/// values would be read before they are written.
#[inline(always)]
fn components_of<T: Scalar, K: Packs<T>, Q: Field<T>, const C: usize>(
    k: K,
    component: impl Fn(usize, usize) -> T,
) -> [K::V; C] {
    let mut components = [k.splat(T::zero()); C];
    for q in 0..Q::COMPONENTS.min(C) {
        components[q] = k.pack(in_lanes(
            #[inline(always)]
            |l| component(l, q),
        ));
    }
    components
}

/// The components of four values, the `l`-th of which is `value(l)`.
#[inline(always)]
pub(super) fn lanes_of<T: Scalar, K: Packs<T>, Q: Field<T>, const C: usize>(
    k: K,
    value: impl Fn(usize) -> Q,
) -> [K::V; C] {
    let values: [Q; LANES] = each(value);
    let mut components = [k.splat(T::zero()); C];
    for q in 0..Q::COMPONENTS {
        components[q] = k.pack(in_lanes(
            #[inline(always)]
            |l| values[l].component(q),
        ));
    }
    components
}
