//! Cells and points.

use materialpoint::grid::Grid;
use materialpoint::scalar::Scalar;
use nalgebra::{SVector, vector};
use proptest::prelude::*;

use super::config;
use super::layout::{Layout, layouts};

/// Every particle's cell has edges that contain it, lower edge included, upper edge in the last cell only.
fn every_particle_is_between_its_edges<T: Scalar, const D: usize>(
    layout: &Layout<D>,
) -> Result<(), TestCaseError> {
    let body = layout.body::<T>().unwrap();
    for (p, x) in body.positions.iter().enumerate() {
        let cell = *body.bins.cell_of(p);
        prop_assert_eq!(body.grid.locate(x), Some(cell));
        for a in 0..D {
            prop_assert!(
                contains(&body.grid, a, cell[a] as usize, x[a]),
                "{} in {:?}",
                x,
                cell
            );
        }
    }
    Ok(())
}

fn contains<T: Scalar, const D: usize>(grid: &Grid<T, D>, axis: usize, i: usize, x: T) -> bool {
    let (low, high) = (grid.edge(axis, i), grid.edge(axis, i + 1));
    let last = i + 1 == grid.cells()[axis];
    low <= x && (x < high || (last && x == high))
}

/// The lists of the bins hold every particle once, in its own cell, ascending.
fn lists_are_complete<const D: usize>(layout: &Layout<D>) -> Result<(), TestCaseError> {
    let body = layout.body::<f64>().unwrap();
    let mut seen = 0;
    for number in 0..body.grid.cell_count() {
        let list = body.bins.particles_in(number);
        prop_assert!(list.is_sorted() && list.windows(2).all(|pair| pair[0] != pair[1]));
        prop_assert_eq!(body.bins.occupied().contains(&(number as u32)), !list.is_empty());
        for &p in list {
            prop_assert_eq!(body.grid.linear(body.bins.cell_of(p as usize)), number);
        }
        seen += list.len();
    }
    prop_assert_eq!(seen, layout.count());
    Ok(())
}

/// The number next to `x`, up or down.
fn neighbours<T: Scalar>(x: T, scale: T) -> [T; 3] {
    let step = scale * T::default_epsilon();
    [x - step, x, x + step]
}

/// Points on, just below and just above every edge of an axis.
fn edges_of_one_axis<T: Scalar>(cells: usize, min: f64, extent: f64) -> Result<(), TestCaseError> {
    let (min, max) = (T::lit(min), T::lit(min) + T::lit(extent));
    let grid = Grid::new(vector![min], vector![max], [cells]).unwrap();
    for i in 0..=cells {
        let edge = grid.edge(0, i);
        for x in neighbours(edge, min.abs().max(max.abs())) {
            match grid.locate(&SVector::from([x])) {
                Some([cell]) => {
                    prop_assert!(contains(&grid, 0, cell as usize, x), "{x} in {cell} of {cells}")
                }
                None => prop_assert!(x < min || x > max, "{x} in no cell"),
            }
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn particles_lie_between_their_cells_edges_1d(layout in layouts::<1>(12, 6)) {
        every_particle_is_between_its_edges::<f64, 1>(&layout)?;
        every_particle_is_between_its_edges::<f32, 1>(&layout)?;
        lists_are_complete(&layout)?;
    }

    #[test]
    fn particles_lie_between_their_cells_edges_2d(layout in layouts::<2>(5, 6)) {
        every_particle_is_between_its_edges::<f64, 2>(&layout)?;
        every_particle_is_between_its_edges::<f32, 2>(&layout)?;
        lists_are_complete(&layout)?;
    }

    #[test]
    fn particles_lie_between_their_cells_edges_3d(layout in layouts::<3>(3, 6)) {
        every_particle_is_between_its_edges::<f64, 3>(&layout)?;
        every_particle_is_between_its_edges::<f32, 3>(&layout)?;
        lists_are_complete(&layout)?;
    }

    #[test]
    fn edges_and_their_neighbours_are_located_rightly(
        cells in 1..400_usize,
        min in -1000.0..1000.0_f64,
        extent in 1e-2..1e4_f64,
    ) {
        // A cell must be wider than the distance of two numbers, or an edge has no inside.
        edges_of_one_axis::<f64>(cells, min, extent)?;
        if extent / cells as f64 > 1000.0 * f64::from(f32::EPSILON) * 16.0 {
            edges_of_one_axis::<f32>(cells, min, extent)?;
        }
    }
}
