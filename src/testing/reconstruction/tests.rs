//! Mistakes in fits of four cells at once, which only the library can make.

use std::ops::Range;

use nalgebra::vector;

use super::{Measure, ReconstructionClaims, check_reconstruction};
use crate::field::Field;
use crate::grid::Grid;
use crate::mass::VelocityMass;
use crate::reconstruction::{
    BatchStatus, CellStream, Cloud, InFours, Kept, NoFilter, Point, Reconstruction, Streams, Taylor, Values,
};
use crate::simd::{LANES, Packs};
use crate::taylor::MOST_COMPONENTS;
use crate::testing::failure::Property;

/// What is wrong with four cells at once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Door {
    Right,
    /// They have the other sign.
    Four,
    /// They put the second cell's values into the first.
    Lane,
    /// Only the cells that they give up are wrong.
    Hard,
    /// Every cell is given up, which is no mistake.
    AllHard,
}

/// Taylor least squares through wrong doors.
#[derive(Clone, Debug)]
struct Doors(Taylor<f64, 1, 3>, Door);

impl Reconstruction<f64, 1> for Doors {
    type Points = InFours;
    type Mass = VelocityMass;
    type Filter = NoFilter;

    fn prepare(&mut self, cloud: &Cloud<'_, f64, 1>) {
        self.0.prepare(cloud);
    }

    fn integrate<Q: Field<f64>>(
        &mut self,
        cloud: &Cloud<'_, f64, 1>,
        value: impl Fn(usize) -> Q,
        sink: impl FnMut(&Point<f64, 1>, Q),
    ) {
        self.0.integrate(cloud, value, sink);
    }

    fn integrate_conserved<Q: Field<f64>>(
        &mut self,
        cloud: &Cloud<'_, f64, 1>,
        amount: impl Fn(usize) -> Q,
        sink: impl FnMut(&Point<f64, 1>, Q),
    ) {
        self.0.integrate_conserved(cloud, amount, sink);
    }
}

impl CellStream<f64, 1> for Doors {
    fn integrate_cells<Q: Field<f64>>(
        &self,
        cloud: &Cloud<'_, f64, 1>,
        cells: Range<usize>,
        value: impl Fn(usize) -> Q,
        sink: impl FnMut(&Point<f64, 1>, Q),
    ) {
        self.0.integrate_cells(cloud, cells, value, sink);
    }

    fn integrate_conserved_cells<Q: Field<f64>>(
        &self,
        cloud: &Cloud<'_, f64, 1>,
        cells: Range<usize>,
        amount: impl Fn(usize) -> Q,
        sink: impl FnMut(&Point<f64, 1>, Q),
    ) {
        self.0.integrate_conserved_cells(cloud, cells, amount, sink);
    }
}

impl Streams<f64, 1, Doors> for InFours {
    const IN_CELLS: bool = true;
    const IN_FOURS: bool = true;

    #[inline(always)]
    fn cells<Q: Field<f64>>(
        doors: &Doors,
        cloud: &Cloud<'_, f64, 1>,
        cells: Range<usize>,
        value: impl Fn(usize) -> Q,
        sink: impl FnMut(&Point<f64, 1>, Q),
    ) {
        doors.integrate_cells(cloud, cells, value, sink);
    }

    #[inline(always)]
    fn conserved_cells<Q: Field<f64>>(
        doors: &Doors,
        cloud: &Cloud<'_, f64, 1>,
        cells: Range<usize>,
        amount: impl Fn(usize) -> Q,
        sink: impl FnMut(&Point<f64, 1>, Q),
    ) {
        doors.integrate_conserved_cells(cloud, cells, amount, sink);
    }

    fn line(doors: &Doors) -> impl Iterator<Item = f64> {
        InFours::line(&doors.0)
    }

    fn weighted_line(doors: &Doors) -> impl Iterator<Item = (f64, f64)> {
        InFours::weighted_line(&doors.0)
    }

    fn integrate_batch<K: Packs<f64>, Q: Field<f64>>(
        doors: &Doors,
        k: K,
        batch: (&Cloud<'_, f64, 1>, Range<usize>),
        conserve: bool,
        kept: Kept<'_, f64>,
        value: &impl Values<f64, Q>,
        mut sink: impl FnMut(usize, &[K::V; MOST_COMPONENTS]),
    ) -> BatchStatus {
        let taylor = &doors.0;
        let mut four =
            InFours::integrate_batch::<K, Q>(taylor, k, batch, conserve, kept, value, |number, values| {
                let mut values = *values;
                let [a, b, c, d] = k.array(values[0]);
                match doors.1 {
                    Door::Four => values[0] = k.splat(0.0) - values[0],
                    Door::Lane => values[0] = k.pack([b, b, c, d]),
                    _ => values[0] = k.pack([a, b, c, d]),
                }
                sink(number, &values);
            });
        if matches!(doors.1, Door::Hard | Door::AllHard) {
            four.hard = [true; LANES];
        }
        four
    }

    fn fit_batch<K: Packs<f64>, Q: Field<f64>>(
        doors: &Doors,
        k: K,
        batch: (&Cloud<'_, f64, 1>, Range<usize>),
        conserve: bool,
        kept: Kept<'_, f64>,
        value: &impl Values<f64, Q>,
        sink: impl FnMut(usize, &[K::V; MOST_COMPONENTS]),
    ) -> BatchStatus {
        InFours::fit_batch::<K, Q>(&doors.0, k, batch, conserve, kept, value, sink)
    }

    fn integrate_single<Q: Field<f64>>(
        doors: &Doors,
        cloud: &Cloud<'_, f64, 1>,
        cell: usize,
        conserve: bool,
        value: &dyn Fn(usize) -> Q,
        sink: &mut dyn FnMut(&Point<f64, 1>, Q),
    ) -> bool {
        let factor = if doors.1 == Door::Hard { 1.0 + 1e-9 } else { 1.0 };
        let value = |p| value(p).scaled(factor);
        InFours::integrate_single(&doors.0, cloud, cell, conserve, &value, sink)
    }
}

/// Five cells, so that four are followed by one.
fn found(door: Door) -> Option<Property> {
    let grid = Grid::new(vector![-0.4], vector![2.1], [5]).unwrap();
    let units = [0.06, 0.37, 0.58, 0.97];
    let shares = [1.0, 2.0, 3.0, 1.0];
    let in_cell = |cell| units.map(|unit| vector![grid.edge(0, cell) + unit * grid.cell_size()[0]]);
    let positions: Vec<_> = (0..5).flat_map(in_cell).collect();
    let volumes: Vec<_> = (0..5)
        .flat_map(|_| shares.map(|share| share / 7.0 * grid.cell_volume()))
        .collect();
    let claims = ReconstructionClaims {
        conserves_amounts: true,
        measure: Measure::OccupiedCells,
        reproduces: 2,
        integrates: Some(2),
    };
    let mut doors = Doors(Taylor::new(), door);
    let outcome = check_reconstruction(&mut doors, &grid, &positions, &volumes, &claims);
    outcome.err().map(|failure| failure.property)
}

#[test]
fn mistakes_in_four_cells_at_once_are_found() {
    for door in [Door::Right, Door::AllHard] {
        assert_eq!(found(door), None, "{door:?}");
    }
    for door in [Door::Four, Door::Lane, Door::Hard] {
        assert_eq!(found(door), Some(Property::FourStreamTheSame), "{door:?}");
    }
}
