//! How far material fills a cell at the side of a body.

use crate::reconstruction::{Cloud, Patch};
use crate::scalar::Scalar;

/// Share from which on a cell counts as full: of the way from its middle to a side that is a wall, or the end of the only axis,
/// where the outermost particle decides and need not reach it to the last digit; of its volume where it borders on an empty
/// cell, because a side on a slant leaves corners empty that the outermost particle does not see.
pub(super) const FULL: f64 = 0.9;

/// Along each axis, below and above, whether no particles are beyond.
pub(super) type OpenSides<const D: usize> = [[bool; 2]; D];

/// Whether one of the open sides of a cell is no wall.
pub(super) fn borders_on_nothing<T: Scalar, const D: usize>(
    cloud: &Cloud<'_, T, D>,
    cell: &Patch<T, D>,
    open: &OpenSides<D>,
) -> bool {
    open.iter().enumerate().any(|(axis, sides)| {
        let index = cell.cell[axis] as usize;
        let is_last = index + 1 == cloud.grid.cells()[axis];
        sides[0] && index > 0 || sides[1] && !is_last
    })
}

/// Whether the volumes of its particles fill a cell.
pub(super) fn is_full<T: Scalar, const D: usize>(cloud: &Cloud<'_, T, D>, cell: &Patch<T, D>) -> bool {
    let volumes = particles(cloud, cell).map(|p| cloud.volumes[p]);
    let filled = volumes.fold(T::zero(), |sum, volume| sum + volume);
    filled >= cloud.grid.cell_volume() * T::lit(FULL)
}

/// How far particles reach from the middle of a cell towards a side, the outermost one and half its size: one at the side.
pub(super) fn reach<T: Scalar, const D: usize>(
    cloud: &Cloud<'_, T, D>,
    cell: &Patch<T, D>,
    axis: usize,
    above: bool,
) -> T {
    let sign = if above { T::one() } else { -T::one() };
    let ends = particles(cloud, cell).map(|p| {
        let size = side(cloud.volumes[p], D);
        (cloud.positions[p][axis] - cell.centre[axis]) * sign + size / T::lit(2.0)
    });
    ends.fold(-cell.half[axis], T::max) * cell.inverse_half[axis]
}

fn particles<'a, T: Scalar, const D: usize>(
    cloud: &Cloud<'a, T, D>,
    cell: &Patch<T, D>,
) -> impl Iterator<Item = usize> + 'a {
    let number = cloud.grid.linear(&cell.cell);
    cloud.bins.particles_in(number).iter().map(|&p| p as usize)
}

/// Side of a cube of the given volume.
fn side<T: Scalar>(volume: T, dimensions: usize) -> T {
    match dimensions {
        1 => volume,
        2 => volume.sqrt(),
        _ => volume.cbrt(),
    }
}
