//! Shepard: the mapping of the plain material point method.

use super::{AtParticles, Cloud, NoFilter, Point, Reconstruction};
use crate::basis::BasisFamily;
use crate::field::Field;
use crate::mass::ParticleMass;
use crate::scalar::Scalar;

/// Streams the particles themselves with their volumes as weights: plain MPM (Sulsky, Chen & Schreyer
/// 1994), which Sulsky & Gong (2016) recognised as Shepard interpolation. Keeps mass and momentum.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Shepard;

impl Shepard {
    /// The same for every basis, as the other reconstructions have it.
    pub fn for_basis<T: Scalar, const D: usize, B: BasisFamily<T, D>>(_basis: &B) -> Self {
        Self
    }
}

impl<T: Scalar, const D: usize> Reconstruction<T, D> for Shepard {
    type Points = AtParticles;
    type Mass = ParticleMass;
    type Filter = NoFilter;

    fn prepare(&mut self, _cloud: &Cloud<'_, T, D>) {}

    #[inline(always)]
    fn integrate<Q: Field<T>>(
        &mut self,
        cloud: &Cloud<'_, T, D>,
        value: impl Fn(usize) -> Q,
        mut sink: impl FnMut(&Point<T, D>, Q),
    ) {
        for p in 0..cloud.positions.len() {
            sink(&Point::of_particle(cloud, p), value(p).scaled(cloud.volumes[p]));
        }
    }
}
