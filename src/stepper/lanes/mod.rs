//! The passes over particles, four or eight particles of a cell at a time.
//!
//! Everything is computed in [`Lanes`], one for each of as many particles that follow each other in a cell ([`Group`]) as a vector
//! register holds.
//! Functions are products along the axes, so sums run along axis 0 first, for each *row* of a cell's DOFs, and then over the
//! rows. What a group adds to DOFs stays in lanes while particles of its cell come, and longer where the next cell is the
//! neighbour along axis 0 ([`sums`]). One file per pass: `mass_and_force`, `velocity`, `advance`; `fits` has
//! four cells in the lanes.
//!
//! A group that is not full repeats its last particle without mass and volume. Groups depend on the particles' order and on
//! where spans begin, not on threads.

mod advance;
mod fits;
mod lines;
mod mass_and_force;
mod pairs;
mod rows;
mod sums;
mod velocity;

pub(super) use fits::{Fits, MOST_POINTS};
pub(super) use mass_and_force::Bodies;
pub(super) use velocity::Acceleration;

use nalgebra::{SMatrix, SVector};

use crate::basis::{BasisFamily, Factors, FixedPoints};
use crate::grid::{Cell, Grid};
use crate::lanes::{Lanes, SideBySide};
use crate::reconstruction::Reconstruction;
use crate::scalar::Scalar;

/// Whether the passes go this way.
pub(super) const fn apply<T: Scalar, const D: usize, B: BasisFamily<T, D>>() -> bool {
    B::WIDTH > 0
}

/// Whether those go this way that want no gradients.
pub(super) const fn apply_to_values<T: Scalar, const D: usize, B: BasisFamily<T, D>>() -> bool {
    apply::<T, D, B>() || matches!(B::AT_FIXED_POINTS, FixedPoints::Linear)
}

/// Whether fits can be integrated over four cells at a time.
pub(super) const fn fit<T: Scalar, const D: usize, B: BasisFamily<T, D>, R: Reconstruction<T, D>>() -> bool {
    R::BY_FOUR
        && match B::AT_FIXED_POINTS {
            FixedPoints::Alike => apply::<T, D, B>(),
            FixedPoints::Linear => true,
            FixedPoints::Other => false,
        }
}

/// Particles of one cell that follow each other, at most `N`: one for each lane.
#[derive(Clone, Copy)]
struct Group<const N: usize> {
    first: usize,
    count: usize,
}

impl<const N: usize> Group<N> {
    /// The one that begins with particle `first`.
    #[inline(always)]
    fn at<const D: usize>(first: usize, cells: &[Cell<D>]) -> Self {
        let rest = &cells[first..];
        let count = match rest.first_chunk() {
            Some(all) if are_alike::<D, N>(all) => N,
            _ => {
                let alike = |cell: &&Cell<D>| **cell == rest[0];
                rest.iter().take(N).take_while(alike).count()
            }
        };
        Self { first, count }
    }

    /// `N` particles of one cell, the first of which is `first`, if there are so many.
    #[inline(always)]
    fn full_at<const D: usize>(first: usize, cells: &[Cell<D>]) -> Option<Self> {
        let all = cells.get(first..)?.first_chunk::<N>()?;
        are_alike(all).then_some(Self { first, count: N })
    }

    /// `make` of what an array says of the particle of each lane; the group must be full if `FULL`. It is asked in both branches,
    /// and not once of what they find: numbers that follow each other are then one load.
    #[inline(always)]
    fn with<const FULL: bool, A: Copy, R>(self, values: &[A], make: impl Fn([A; N]) -> R) -> R {
        match values[self.first..].first_chunk() {
            Some(&lanes) if FULL || self.count == N => make(lanes),
            // Never: a full group is within its arrays.
            _ if FULL => make([values[self.first]; N]),
            _ => make(std::array::from_fn(|l| {
                values[self.first + l.min(self.count - 1)]
            })),
        }
    }

    /// A number of each particle, zero in spare lanes.
    #[inline(always)]
    fn amounts<const FULL: bool, T: Scalar, V: Lanes<T, N>>(self, values: &[T]) -> V {
        if FULL || self.count == N {
            return self.with::<FULL, _, _>(values, V::new);
        }
        V::new(std::array::from_fn(|l| {
            if l < self.count {
                values[self.first + l]
            } else {
                T::zero()
            }
        }))
    }

    /// The components of a vector.
    #[inline(always)]
    fn vectors<const FULL: bool, T: Scalar, V: Lanes<T, N>, const D: usize>(
        self,
        values: &[SVector<T, D>],
    ) -> [V; D] {
        self.with::<FULL, _, _>(values, |lanes| {
            std::array::from_fn(|a| V::new(std::array::from_fn(|l| lanes[l][a])))
        })
    }

    /// Gives each particle its lane of a vector.
    #[inline(always)]
    fn put<const FULL: bool, T: Scalar, V: Lanes<T, N>, const D: usize>(
        self,
        values: &mut [SVector<T, D>],
        vector: &[V; D],
    ) {
        let lanes = vector.map(V::array);
        let of_lane = |l: usize| SVector::from_fn(|c, _| lanes[c][l]);
        if FULL {
            let all = &mut values[self.first..self.first + N];
            for l in 0..N {
                all[l] = of_lane(l);
            }
            return;
        }
        match values[self.first..].first_chunk_mut() {
            Some(all) if self.count == N => *all = std::array::from_fn::<_, N, _>(of_lane),
            _ => {
                for l in 0..self.count {
                    values[self.first + l] = of_lane(l);
                }
            }
        }
    }
}

/// Whether most particles of the given cells come in groups of eight. Asked of the first few: with eight lanes a group that is not
/// full takes longer than two groups of four.
fn come_in_eights<const D: usize>(cells: &[Cell<D>]) -> bool {
    let some = &cells[..cells.len().min(64)];
    let (mut p, mut full) = (0, 0);
    while p < some.len() {
        let Group { count, .. } = Group::<8>::at(p, some);
        full += if count == 8 { count } else { 0 };
        p += count;
    }
    4 * full >= 3 * some.len()
}

/// Calls `$run::<V, N>` with the `N` lanes `V` of the scalar `$scalar` that are best for groups of the given cells' particles.
macro_rules! with_lanes_for {
    ($scalar:ty, $cells:expr, $receiver:ident . $run:ident $([$($more:tt),*])? ( $($argument:expr),* )) => {
        if const { size_of::<$scalar>() == 8 } && $crate::lanes::is::<$scalar, f64>() {
            $receiver.$run::<::wide::f64x4, 4 $(, $($more),*)?>($($argument),*)
        } else if const { size_of::<$scalar>() == 4 } && $crate::lanes::is::<$scalar, f32>() {
            if $crate::stepper::lanes::come_in_eights($cells) {
                $receiver.$run::<::wide::f32x8, 8 $(, $($more),*)?>($($argument),*)
            } else {
                $receiver.$run::<::wide::f32x4, 4 $(, $($more),*)?>($($argument),*)
            }
        } else {
            $receiver.$run::<$crate::lanes::Four<$scalar>, 4 $(, $($more),*)?>($($argument),*)
        }
    };
}
use with_lanes_for;

/// What a pass does with each group.
trait EachGroup<const N: usize> {
    /// Takes in the next one, which is full if `FULL`.
    fn take<const FULL: bool>(&mut self, group: Group<N>);
}

/// Calls [`EachGroup::take`] for the groups of the particles of the given cells. In one dimension, where a group takes as long as
/// the question whether it is full, full ones have a loop of their own that asks once.
#[inline(always)]
fn each_group<const D: usize, const N: usize>(cells: &[Cell<D>], pass: &mut impl EachGroup<N>) {
    let mut p = 0;
    while p < cells.len() {
        if D == 1 {
            while let Some(group) = Group::full_at(p, cells) {
                pass.take::<true>(group);
                p += N;
            }
            if p >= cells.len() {
                return;
            }
        }
        let group = Group::at(p, cells);
        pass.take::<false>(group);
        p += group.count;
    }
}

/// Whether all are the same cell.
#[inline(always)]
fn are_alike<const D: usize, const N: usize>(cells: &[Cell<D>; N]) -> bool {
    let differ = |l: usize| (0..D).fold(0, |bits, axis| bits | (cells[l][axis] ^ cells[0][axis]));
    (1..N).fold(0, |bits, l| bits | differ(l)) == 0
}

/// Component `(c, a)` of the particles' tensors at `[c][a]`.
#[inline(always)]
fn tensors<T: Scalar, V: Lanes<T, N>, const D: usize, const N: usize>(
    lanes: &[SMatrix<T, D, D>; N],
) -> [[V; D]; D] {
    std::array::from_fn(|c| std::array::from_fn(|a| V::new(std::array::from_fn(|l| lanes[l][(c, a)]))))
}

/// What all groups of a pass share.
#[derive(Clone, Copy)]
pub(super) struct Pass<'a, T, const D: usize, B> {
    basis: &'a B,
    grid: &'a Grid<T, D>,
    /// Difference of the numbers of neighbouring DOFs along each axis.
    strides: [usize; D],
    /// What the numbers of the DOFs are less in the grid's window.
    before: usize,
}

impl<'a, T: Scalar, const D: usize, B: BasisFamily<T, D>> Pass<'a, T, D, B> {
    pub(super) fn new(basis: &'a B, grid: &'a Grid<T, D>) -> Self {
        let dofs = basis.dofs(grid);
        let mut strides = [1; D];
        for axis in 1..D {
            strides[axis] = strides[axis - 1] * dofs[axis - 1];
        }
        let first = grid.window().first();
        Self {
            basis,
            grid,
            strides,
            before: (0..D).map(|axis| first[axis] as usize * strides[axis]).sum(),
        }
    }

    /// Coordinates in `cell`, from 0 to 1.
    #[inline(always)]
    fn unit<V: SideBySide<T>>(&self, cell: &Cell<D>, x: &[V; D]) -> [V; D] {
        let inverse = self.grid.inverse_cell_size();
        std::array::from_fn(|a| {
            let index = V::splat(T::lit(f64::from(cell[a])));
            (x[a] - V::splat(self.grid.min()[a])) * V::splat(inverse[a]) - index
        })
    }

    #[inline(always)]
    fn factors<V: SideBySide<T>>(&self, cell: &Cell<D>, x: &[V; D]) -> Factors<V, D> {
        self.basis.factors(self.grid, cell, &self.unit(cell, x))
    }
}

/// Calls `$method` of the pass over the functions that a basis has at fixed points; their values are those at points that move
/// too where [`apply_to_values`].
macro_rules! at_fixed_points {
    ($basis:ty, $value:expr, $grid:expr, $method:ident $(::<$map:literal>)? ( $($argument:expr),* $(,)? )) => {
        if const { matches!(<$basis>::AT_FIXED_POINTS, $crate::basis::FixedPoints::Linear) } {
            $crate::stepper::lanes::Pass::new(&$crate::basis::Linear, $grid).$method $(::<$map>)? ($($argument),*)
        } else {
            $crate::stepper::lanes::Pass::new($value, $grid).$method $(::<$map>)? ($($argument),*)
        }
    };
}
pub(super) use at_fixed_points;

#[cfg(test)]
mod tests {
    use nalgebra::vector;

    use super::*;
    use crate::basis::{BSpline, Linear};

    #[test]
    fn cells_come_in_eights_if_most_of_their_particles_do() {
        let cells = |counts: &[usize]| -> Vec<Cell<1>> {
            let of_cell = |(i, &count): (usize, &usize)| vec![[i as u32]; count];
            counts.iter().enumerate().flat_map(of_cell).collect()
        };
        assert!(come_in_eights(&cells(&[8; 20])) && come_in_eights(&cells(&[64, 64])));
        assert!(come_in_eights(&cells(&[25, 17])) && come_in_eights(&cells(&[8])));
        for few in [vec![4; 30], vec![7; 20], vec![12; 10], vec![8, 4, 4, 3], vec![]] {
            assert!(come_in_eights(&cells(&few)) == few.is_empty(), "{few:?}");
        }
    }

    /// Masses of the DOFs for `counts` particles in the cells of a grid.
    fn masses<T: Scalar, B: BasisFamily<T, 1>>(basis: &B, counts: &[usize]) -> Vec<f64> {
        let grid = Grid::new(
            vector![T::zero()],
            vector![T::count(counts.len())],
            [counts.len()],
        );
        let grid = grid.expect("a grid");
        let mut positions = Vec::new();
        for (i, &count) in counts.iter().enumerate() {
            positions.extend((0..count).map(|k| i as f64 + (k as f64 + 0.3) / count as f64));
        }
        let positions: Vec<_> = positions.into_iter().map(|x| vector![T::lit(x)]).collect();
        let cells: Vec<Cell<1>> = positions.iter().filter_map(|x| grid.locate(x)).collect();
        let masses: Vec<T> = (0..cells.len()).map(|p| T::count(1 + p % 5)).collect();
        let mut sums = vec![0.0; basis.dofs(&grid)[0]];
        let bodies = Bodies {
            positions: &positions,
            cells: &cells,
            masses: &masses,
        };
        Pass::new(basis, &grid).sum_masses(bodies, &mut |i, m: T| sums[i] += m.primal());
        sums
    }

    #[test]
    fn eight_lanes_sum_up_what_four_do() {
        for counts in [[8, 16, 9, 8, 24, 8], [17, 8, 8, 13, 8, 16], [3, 5, 1, 2, 4, 7]] {
            let pairs = [
                (
                    masses::<f32, _>(&Linear, &counts),
                    masses::<f64, _>(&Linear, &counts),
                ),
                (
                    masses::<f32, _>(&BSpline::<2>, &counts),
                    masses::<f64, _>(&BSpline::<2>, &counts),
                ),
            ];
            for (single, double) in pairs {
                for (a, b) in single.into_iter().zip(double) {
                    assert!((a - b).abs() < 1e-4 * b.abs().max(1.0), "{counts:?}: {a} {b}");
                }
            }
        }
    }
}
