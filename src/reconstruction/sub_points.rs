//! Sub-points: the stress of a particle spread over its current domain.

use nalgebra::SVector;

use super::{Anywhere, Cloud, NoFilter, Point, Reconstruction};
use crate::basis::tensor::advance;
use crate::error::SetupError;
use crate::field::Field;
use crate::grid::{Cell, Grid};
use crate::mass::ParticleMass;
use crate::scalar::Scalar;

/// Streams a field at `S` sub-points per axis of each particle's current domain, each with the weight
/// `V_p / S^D`, and the amounts (mass, momentum) at the particles as [`Shepard`](super::Shepard) does: the
/// dual domain method with sub-points of Dhakal & Zhang (J. Comput. Phys. 325, 2016; journal Table 8), made
/// for [`DualDomain`](crate::basis::DualDomain) and usable with any family.
///
/// * **Domain.** A box of volume `V_p` around the particle, in the shape of a cell: in 1-D
///   `[x_p - V_p/2, x_p + V_p/2]`. It grows and shrinks with the volume and does not turn or shear.
/// * **Sub-points.** The midpoints of `S` equal parts of the box along each axis, so that one sub-point is
///   the particle, to the bit [`Shepard`](super::Shepard). The field is constant over the domain.
/// * **Gradients.** The family's gradients for moving points ([`Point::moves`]), since sub-points cross cell
///   edges.
/// * **Where there is no material.** A sub-point outside the grid (beyond a wall), or in a cell that holds no
///   particle, is drawn to the nearest point of its particle's cell. The weight stays, and no force is put on
///   a DOF beyond the material, which has no mass to take it and would lose its momentum.
///
/// Sub-points serve the force alone. The strain of a particle is taken at the particle itself, not averaged
/// over its domain, so that the work of the force and that of the stress differ: with one particle per cell
/// enough to gain energy.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SubPoints {
    per_axis: usize,
}

impl SubPoints {
    /// Most sub-points along an axis.
    pub const MOST: u8 = 128;

    /// `per_axis` sub-points along each axis of a domain, 1 to [`SubPoints::MOST`].
    ///
    /// # Errors
    /// If there are fewer or more.
    pub fn new(per_axis: usize) -> Result<Self, SetupError> {
        if (1..=usize::from(Self::MOST)).contains(&per_axis) {
            return Ok(Self { per_axis });
        }
        Err(SetupError::Constant {
            name: "sub-points",
            value: per_axis as f64,
            allowed: "a whole number from 1 to 128 per axis",
        })
    }

    /// Sub-points along each axis.
    pub fn per_axis(&self) -> usize {
        self.per_axis
    }

    /// Place of sub-point `k` along an axis, in domain sizes from the particle: `-1/2` to `1/2`.
    #[inline(always)]
    fn place<T: Scalar>(&self, k: usize) -> T {
        let odd = T::count(2 * k + 1) - T::count(self.per_axis);
        odd / T::count(2 * self.per_axis)
    }
}

impl Default for SubPoints {
    /// One: the particle itself.
    fn default() -> Self {
        Self { per_axis: 1 }
    }
}

/// Extents of a box of `volume` in the shape of a cell.
#[inline(always)]
fn domain<T: Scalar, const D: usize>(grid: &Grid<T, D>, volume: T) -> SVector<T, D> {
    let share = volume / grid.cell_volume();
    let side = match D {
        1 => share,
        2 => share.sqrt(),
        3 => share.cbrt(),
        _ => share.powf(T::one() / T::count(D)),
    };
    *grid.cell_size() * side
}

/// The cell that `position` counts in, for a particle in the cell `own`; draws the position there if no other
/// holds it.
#[inline]
fn settle<T: Scalar, const D: usize>(
    cloud: &Cloud<'_, T, D>,
    own: &Cell<D>,
    position: &mut SVector<T, D>,
) -> Cell<D> {
    match cloud.grid.locate(position) {
        Some(cell) if holds_particles(cloud, &cell) => cell,
        _ => {
            *position = cloud.grid.nearest_within(own, position);
            *own
        }
    }
}

fn holds_particles<T: Scalar, const D: usize>(cloud: &Cloud<'_, T, D>, cell: &Cell<D>) -> bool {
    let Cloud { grid, bins, .. } = cloud;
    grid.has_numbers(cell, 0) && !bins.particles_in(grid.linear(cell)).is_empty()
}

impl<T: Scalar, const D: usize> Reconstruction<T, D> for SubPoints {
    type Points = Anywhere;
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
        let count = (0..D).fold(T::one(), |n, _| n * T::count(self.per_axis));
        let half = T::one() / T::lit(2.0);
        for (p, x) in cloud.positions.iter().enumerate() {
            let own = *cloud.bins.cell_of(p);
            let volume = cloud.volumes[p];
            let weighted = value(p).scaled(volume / count);
            let extents = domain(cloud.grid, volume);
            // Most domains lie within one cell: then no sub-point need be looked up.
            let within = [-half, half]
                .iter()
                .all(|&end| cloud.grid.strictly_contains(&own, &(x + extents * end)));
            let mut k = [0; D];
            loop {
                let mut position = SVector::from_fn(|a, _| x[a] + self.place::<T>(k[a]) * extents[a]);
                let cell = if within {
                    own
                } else {
                    settle(cloud, &own, &mut position)
                };
                let point = Point {
                    cell,
                    position,
                    moves: true,
                    particle: None,
                };
                sink(&point, weighted);
                if !advance(&mut k, self.per_axis) {
                    break;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests;
