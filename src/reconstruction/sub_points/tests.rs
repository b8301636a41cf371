//! Where sub-points lie and what they weigh.

use nalgebra::{SVector, vector};

use super::*;
use crate::particles::Bins;

/// Cells, positions and weighted values of the stream of the field that is one.
fn stream<const D: usize>(
    per_axis: usize,
    grid: &Grid<f64, D>,
    positions: &[SVector<f64, D>],
    volumes: &[f64],
) -> Vec<(Cell<D>, SVector<f64, D>, f64)> {
    let bins = Bins::new(grid, positions).unwrap();
    let cloud = Cloud::new(grid, &bins, positions, volumes).unwrap();
    let mut points = Vec::new();
    SubPoints::new(per_axis).unwrap().integrate(
        &cloud,
        |_| 1.0,
        |point, weighted| points.push((point.cell, point.position, weighted)),
    );
    points
}

fn line(cells: usize) -> Grid<f64, 1> {
    Grid::new(vector![0.0], vector![cells as f64], [cells]).unwrap()
}

#[test]
fn the_midpoints_of_equal_parts_carry_equal_shares() {
    let points = stream(4, &line(2), &[vector![0.5]], &[0.8]);
    let expected = [0.2, 0.4, 0.6, 0.8];
    assert_eq!(points.len(), expected.len());
    for ((cell, x, weight), expected) in points.into_iter().zip(expected) {
        assert_eq!(cell, [0]);
        assert!((x[0] - expected).abs() < 1e-15, "{x}");
        assert_eq!(weight, 0.8 / 4.0);
    }
}

#[test]
fn a_sub_point_beyond_an_edge_counts_in_the_cell_that_holds_it() {
    let positions = [vector![0.9], vector![1.5]];
    let cells: Vec<_> = stream(2, &line(2), &positions, &[0.4, 0.1])
        .iter()
        .map(|point| point.0[0])
        .collect();
    assert_eq!(cells, [0, 1, 1, 1], "0.8 and 1.0, and the second particle's two");
}

/// The right neighbour is empty, the left one does not exist.
#[test]
fn where_there_is_no_material_the_nearest_point_of_the_own_cell_serves() {
    for (x, side) in [(0.1, 0.0), (0.9, 1.0)] {
        let points = stream(4, &line(3), &[vector![x], vector![2.5]], &[0.8, 0.1]);
        let (own, _) = points.split_at(4);
        assert!(own.iter().all(|point| point.0 == [0]));
        let drawn = own
            .iter()
            .filter(|point| (point.1[0] - side).abs() < 1e-13)
            .count();
        // 0.1 -+ 0.1 and -+ 0.3: one is outside, and one on the very edge.
        assert_eq!(drawn, 2, "{own:?}");
        let total: f64 = own.iter().map(|point| point.2).sum();
        assert!((total - 0.8).abs() < 1e-15);
    }
}

#[test]
fn a_box_in_the_plane_has_the_shape_of_a_cell_and_the_particles_volume() {
    let grid = Grid::new(vector![0.0, 0.0], vector![4.0, 1.0], [2, 1]).unwrap();
    let points = stream(2, &grid, &[vector![1.0, 0.5]], &[0.5]);
    // Half the cell's sides: 1.0 and 0.5.
    let expected = [[0.75, 0.375], [1.25, 0.375], [0.75, 0.625], [1.25, 0.625]];
    assert_eq!(points.len(), 4);
    for ((_, x, weight), [a, b]) in points.into_iter().zip(expected) {
        assert!((x - vector![a, b]).norm() < 1e-15, "{x}");
        assert_eq!(weight, 0.125);
    }
}

#[test]
fn none_and_too_many_are_refused() {
    assert_eq!(SubPoints::new(1), Ok(SubPoints::default()));
    assert_eq!(
        SubPoints::new(SubPoints::MOST.into()).map(|s| s.per_axis()),
        Ok(128)
    );
    for bad in [0, 129, usize::MAX] {
        let message = SubPoints::new(bad).unwrap_err().to_string();
        assert!(
            message.starts_with(&format!("sub-points = {bad}")) || bad == usize::MAX,
            "{message}"
        );
        assert!(message.ends_with("from 1 to 128 per axis"), "{message}");
    }
}
