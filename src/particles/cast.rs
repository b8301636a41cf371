//! Particles from one scalar to another.

use nalgebra::SMatrix;

use super::{Domains, Particles};
use crate::scalar::Scalar;

impl<T: Scalar, const D: usize, S: Clone, P: Clone> Particles<T, D, S, P> {
    /// The same particles in another scalar, with fresh states of a law and data of a phase.
    pub fn cast<U: Scalar, S2: Copy + Default, P2: Copy + Default>(&self) -> Particles<U, D, S2, P2> {
        self.clone().into_cast()
    }
}

impl<T: Scalar, const D: usize, S, P> Particles<T, D, S, P> {
    /// [`Particles::cast`] without a second copy: array by array, and into a scalar of the same size in
    /// place.
    pub fn into_cast<U: Scalar, S2: Copy + Default, P2: Copy + Default>(self) -> Particles<U, D, S2, P2> {
        let n = self.position.len();
        Particles {
            initial_position: vectors(self.initial_position),
            position: vectors(self.position),
            displacement: vectors(self.displacement),
            velocity: vectors(self.velocity),
            stress: vectors(self.stress),
            mass: self.mass.into_iter().map(|m| U::lit(m.primal())).collect(),
            volume: self.volume.into_iter().map(|v| U::lit(v.primal())).collect(),
            state: vec![S2::default(); n],
            phase: vec![P2::default(); n],
            domains: Domains {
                half_lengths: vectors(self.domains.half_lengths),
                half_edges: vectors(self.domains.half_edges),
            },
        }
    }
}

impl<T, const D: usize, S, P> Particles<T, D, S, P> {
    /// The same particles with the states of a law: one each, or those that
    /// [`AnyLaw::at_rest`](crate::law::AnyLaw::at_rest) gives.
    #[must_use]
    pub fn with_states<S2>(self, state: Vec<S2>) -> Particles<T, D, S2, P> {
        Particles {
            initial_position: self.initial_position,
            position: self.position,
            displacement: self.displacement,
            velocity: self.velocity,
            stress: self.stress,
            mass: self.mass,
            volume: self.volume,
            state,
            phase: self.phase,
            domains: self.domains,
        }
    }
}

fn vectors<T: Scalar, U: Scalar, const R: usize, const C: usize>(
    values: Vec<SMatrix<T, R, C>>,
) -> Vec<SMatrix<U, R, C>> {
    values
        .into_iter()
        .map(|v| v.map(|x| U::lit(x.primal())))
        .collect()
}
