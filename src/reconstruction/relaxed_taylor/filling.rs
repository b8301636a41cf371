//! How far material fills a cell at the side of a body.

use crate::reconstruction::{Cloud, Patch};
use crate::scalar::Scalar;

/// Share from which on a cell counts as full: of the way from its middle to the end of the only axis, where
/// the outermost particle decides and need not reach it to the last digit; of its volume where it borders on
/// an empty cell, because a side on a slant leaves corners empty that the outermost particle does not see.
const FULL: f64 = 0.9;

/// Gap between material and a wall, in cells, that does not count beyond one axis: as much as two rows of
/// particles a cell leave in doubt.
const GAP: f64 = 0.1;

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

/// How far material reaches from the middle of a cell towards both of its sides along an axis, 1 at the side.
/// It ends at the sides that are `open`, and there only where the cell is clearly not full.
pub(super) fn reaches<T: Scalar, const D: usize>(
    cloud: &Cloud<'_, T, D>,
    cell: &Patch<T, D>,
    axis: usize,
    open: [bool; 2],
) -> [T; 2] {
    if const { D == 1 } {
        return [false, true].map(|above| {
            let reach = outermost(cloud, cell, above);
            let ends = open[usize::from(above)] && reach < T::lit(FULL);
            if ends { reach } else { T::one() }
        });
    }
    gaps(cloud, cell, axis, open).map(|gap| {
        let counts = gap > T::lit(GAP);
        T::one() - if counts { gap + gap } else { T::zero() }
    })
}

/// How far particles reach from the middle of a cell of the only axis towards a side, the outermost one and
/// half its size.
fn outermost<T: Scalar, const D: usize>(cloud: &Cloud<'_, T, D>, cell: &Patch<T, D>, above: bool) -> T {
    let sign = if above { T::one() } else { -T::one() };
    let ends = particles(cloud, cell)
        .map(|p| (cloud.positions[p][0] - cell.centre[0]) * sign + cloud.volumes[p] / T::lit(2.0));
    ends.fold(-cell.half[0], T::max) * cell.inverse_half[0]
}

/// Gaps between the material and the `open` sides of a cell along an axis, in cells.
///
/// Particles have a volume and no shape: how long one is along an axis depends on how many lie side by side,
/// on the shape of the cell and on how the body was pressed. So the gaps follow from moments of the volumes,
/// which know nothing of shapes. With `u` the way from the side, 0 to 1 in the cell, and an even filling from
/// the gap `g` on,
///
/// `sum_p V_p (1 - u) / V = (1 - g)^2 / 2`,  `sum_p V_p u (1 - u) / sum_p V_p (1 - u) = (1 + 2 g) / 3`.
///
/// Weights that vanish at the far side feel no particle that crosses it. The first is exact for whole rows,
/// and feels particles that cross the other sides; the second does not feel those, and is off by a quarter of
/// the square of the distance between rows. The smaller one counts.
fn gaps<T: Scalar, const D: usize>(
    cloud: &Cloud<'_, T, D>,
    cell: &Patch<T, D>,
    axis: usize,
    open: [bool; 2],
) -> [T; 2] {
    let [none, one, two, three] = [0.0, 1.0, 2.0, 3.0].map(T::lit);
    let own = Moments::of(cloud, cell, axis);
    let beside = Moments::beside(cloud, cell, axis);
    // Of rows that run along the wall now more, now fewer lie in a cell.
    let volume = own.volume.max(beside.volume);
    if open == [true; 2] {
        let mean = own.first / own.volume;
        let square = (own.second / own.volume - mean * mean).max(none);
        let half = (volume / two).max((three * square).sqrt());
        return [mean - half, one - mean - half].map(|gap| gap.max(none));
    }
    [false, true].map(|above| {
        let (own, beside) = (own.towards(above), beside.towards(above));
        if !open[usize::from(above)] || own[0] <= none {
            return none;
        }
        let from_volume = one - (two * own[0].max(beside[0])).min(one).sqrt();
        let from_middle = (three * own[1] / own[0] - one) / two;
        from_volume.min(from_middle).max(none)
    })
}

/// Sums of volumes, in cells, times powers of the way along an axis.
#[derive(Clone, Copy)]
struct Moments<T> {
    volume: T,
    first: T,
    second: T,
}

impl<T: Scalar> Moments<T> {
    fn none() -> Self {
        Self {
            volume: T::zero(),
            first: T::zero(),
            second: T::zero(),
        }
    }

    /// Of the particles of a cell.
    fn of<const D: usize>(cloud: &Cloud<'_, T, D>, cell: &Patch<T, D>, axis: usize) -> Self {
        let (whole, two) = (cloud.grid.cell_volume(), T::lit(2.0));
        particles(cloud, cell).fold(Self::none(), |sums, p| {
            let volume = cloud.volumes[p] / whole;
            let s = (cloud.positions[p][axis] - cell.centre[axis]) * cell.inverse_half[axis];
            let way = (s + T::one()) / two;
            Self {
                volume: sums.volume + volume,
                first: sums.first + volume * way,
                second: sums.second + volume * way * way,
            }
        })
    }

    /// The mean of a cell and of the occupied ones beside it, across the axis.
    fn beside<const D: usize>(cloud: &Cloud<'_, T, D>, cell: &Patch<T, D>, axis: usize) -> Self {
        let (mut sums, mut count) = (Self::of(cloud, cell, axis), T::one());
        let number = cloud.grid.linear(&cell.cell);
        if let Some(place) = cloud.bins.place_of(number, 0) {
            cloud
                .bins
                .for_each_neighbour(cloud.grid, place, |across, _, other| {
                    if across != axis {
                        let other = Patch::whole(cloud.grid, cloud.bins.occupied()[other] as usize);
                        let theirs = Self::of(cloud, &other, axis);
                        sums.volume += theirs.volume;
                        sums.first += theirs.first;
                        sums.second += theirs.second;
                        count += T::one();
                    }
                });
        }
        Self {
            volume: sums.volume / count,
            first: sums.first / count,
            second: sums.second / count,
        }
    }

    /// Sums of volumes times `1 - u` and `u (1 - u)`, `u` the way from the side `above` or below.
    fn towards(&self, above: bool) -> [T; 2] {
        let weight = if above {
            self.first
        } else {
            self.volume - self.first
        };
        [weight, self.first - self.second]
    }
}

fn particles<'a, T: Scalar, const D: usize>(
    cloud: &Cloud<'a, T, D>,
    cell: &Patch<T, D>,
) -> impl Iterator<Item = usize> + 'a {
    let number = cloud.grid.linear(&cell.cell);
    cloud.bins.particles_in(number).iter().map(|&p| p as usize)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::Grid;
    use crate::particles::Bins;
    use nalgebra::{SVector, vector};

    /// How far the cells at the wall `x = 0` of a grid of 3 x 6 are filled towards it, of material from `gap`
    /// on with so many columns and rows of particles over the grid; `cells` are as large as that.
    fn towards_the_wall(gap: f64, [columns, rows]: [usize; 2], size: [f64; 2], shift: f64) -> Vec<f64> {
        let max = vector![3.0 * size[0], 6.0 * size[1]];
        let grid = Grid::<f64, 2>::new(vector![0.0, 0.0], max, [3, 6]).unwrap();
        let spacing = [3.0 / columns as f64, 6.0 / rows as f64];
        let place = |k: usize, spacing: f64, first: f64| first + (k as f64 + 0.5) * spacing;
        let positions: Vec<SVector<f64, 2>> = (0..columns * rows)
            .map(|p| {
                let x = place(p % columns, spacing[0], gap);
                let y = place(p / columns, spacing[1], shift * spacing[1]).min(5.999);
                vector![x * size[0], y * size[1]]
            })
            .filter(|x| x[0] < max[0])
            .collect();
        let volumes = vec![spacing[0] * spacing[1] * size[0] * size[1]; positions.len()];
        let bins = Bins::new(&grid, &positions).unwrap();
        let cloud = Cloud::new(&grid, &bins, &positions, &volumes).unwrap();
        // Not the last row, which is shifted beyond the grid's end.
        let cells = (0..5).map(|j| Patch::whole(&grid, grid.linear(&[0, j])));
        cells
            .map(|cell| reaches(&cloud, &cell, 0, [true, false])[0])
            .collect()
    }

    /// Columns from two to eight a cell, rows from one to eight, cells 8:1 to 1:8, and rows that have run
    /// along the wall.
    fn each_layout(mut f: impl FnMut([usize; 2], [f64; 2], f64)) {
        for columns in [6, 7, 8, 10, 13, 24] {
            for rows in [12, 13, 16, 18, 25, 48] {
                for size in [[1.0, 1.0], [8.0, 1.0], [1.0, 8.0]] {
                    for shift in [0.0, 0.3, 0.5, 0.9] {
                        f([columns, rows], size, shift);
                    }
                }
            }
        }
    }

    #[test]
    fn material_at_a_wall_reaches_it_whatever_the_shape_of_its_particles() {
        each_layout(|counts, size, shift| {
            let found = towards_the_wall(0.0, counts, size, shift);
            assert!(
                found.iter().all(|&reach| reach == 1.0),
                "{counts:?}, {size:?}, {shift}: {found:?}"
            );
        });
    }

    #[test]
    fn material_that_has_left_a_wall_ends_where_it_does() {
        for gap in [0.3, 0.45, 0.6] {
            each_layout(|counts, size, shift| {
                for reach in towards_the_wall(gap, counts, size, shift) {
                    let found = (1.0 - reach) / 2.0;
                    assert!(
                        (found - gap).abs() < 0.15,
                        "{counts:?}, {size:?}, {shift}: {found} for {gap}"
                    );
                }
            });
        }
    }
}
