//! Check of a reconstruction.

mod amounts;
mod doors;
mod fields;
mod stream;
#[cfg(test)]
mod tests;

use nalgebra::SVector;

use super::failure::{Expected, Failure, Place, Property};
use crate::grid::Grid;
use crate::particles::{Bins, Outside};
use crate::reconstruction::{Cloud, Reconstruction};
use crate::scalar::Scalar;

/// What the weights of a reconstruction's stream sum to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// In each cell that holds a particle, the cell's volume.
    OccupiedCells,
    /// In each cell, the volume of its particles.
    Particles,
    /// In all cells together, the volume of all particles: the stream of a particle may reach into other
    /// cells.
    AllParticles,
}

/// What a reconstruction claims *on the particles given to the check*.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReconstructionClaims {
    /// `integrate_conserved` keeps the amounts, cell by cell; if so, also where the check leaves a cell one
    /// of the particles alone.
    pub conserves_amounts: bool,
    /// What the weights sum to.
    pub measure: Measure,
    /// Largest degree of polynomials that `integrate` streams exactly at points which are not the particles;
    /// one degree more it must not. Without meaning where the particles are streamed, which is exact for any
    /// field.
    pub reproduces: usize,
    /// Largest degree of polynomials whose integral over each occupied cell `integrate` gives exactly; one
    /// degree more it must not. `None` if not even the constant's, as where particles do not fill their
    /// cells.
    pub integrates: Option<usize>,
}

/// Checks `reconstruction` on the particles at `positions` with `volumes`, which should be well spread (a fit
/// through almost coincident points loses digits that this check would count as errors): stream points lie in
/// their cells and are the same for every field; the particles are streamed where the points
/// ([`AtParticles`]) and the mass ([`ParticleMass`], [`ParticleMatrix`]) say so; streaming is linear;
/// `prepare` forgets; cells streamed alone ([`InCells`]) stream the same; weights, conservation, reproduction
/// and integrals as claimed.
///
/// [`AtParticles`]: crate::reconstruction::AtParticles
/// [`InCells`]: crate::reconstruction::InCells
/// [`ParticleMass`]: crate::mass::ParticleMass
/// [`ParticleMatrix`]: crate::mass::ParticleMatrix
///
/// The cost grows with the square of the number of particles.
///
/// # Errors
/// The first property that does not hold, or holds although it is claimed not to.
///
/// # Panics
/// If there are fewer volumes than positions.
pub fn check_reconstruction<T: Scalar, const D: usize, R: Reconstruction<T, D>>(
    reconstruction: &mut R,
    grid: &Grid<T, D>,
    positions: &[SVector<T, D>],
    volumes: &[T],
    claims: &ReconstructionClaims,
) -> Result<(), Failure> {
    let bins = Bins::new(grid, positions).map_err(|Outside(p)| Failure {
        property: Property::PointsInGrid,
        place: Place::point(&positions[p]),
        expected: Expected::AtLeast(1.0),
        found: 0.0,
    })?;
    let cloud = Cloud {
        grid,
        bins: &bins,
        positions,
        volumes: &volumes[..positions.len()],
        cuts: &[],
    };
    reconstruction.prepare(&cloud);
    stream::check(reconstruction, &cloud, claims.measure)?;
    amounts::check(reconstruction, &cloud, claims.conserves_amounts)?;
    doors::check(reconstruction, &cloud)?;
    fields::check(reconstruction, &cloud, claims)?;
    stream::forgets(reconstruction, &cloud)?;
    amounts::thinned(reconstruction, &cloud, claims.conserves_amounts)
}
