//! Sub-points on every layout, in one, two and three dimensions: one is Shepard, weights sum to the volume,
//! and no force reaches beyond the material.

use materialpoint::basis::{BasisFamily, DualDomain};
use materialpoint::field::Field;
use materialpoint::grid::Cell;
use materialpoint::reconstruction::{Reconstruction, Shepard, SubPoints};
use materialpoint::scalar::Scalar;
use nalgebra::SVector;
use proptest::prelude::*;

use super::layout::{Body, Layout, layouts, uneven};
use super::{config, epsilon};

type Streamed<T, Q, const D: usize> = (Cell<D>, SVector<T, D>, Q);

fn stream<T: Scalar, const D: usize, Q: Field<T>>(
    mut reconstruction: impl Reconstruction<T, D>,
    body: &Body<T, D>,
    value: impl Fn(usize) -> Q,
) -> Vec<Streamed<T, Q, D>> {
    let mut points = Vec::new();
    reconstruction.prepare(&body.cloud());
    reconstruction.integrate(&body.cloud(), value, |point, weighted| {
        points.push((point.cell, point.position, weighted));
    });
    points
}

fn one_is_shepard<T: Scalar, const D: usize>(layout: &Layout<D>) -> Result<(), TestCaseError> {
    let body = layout.body::<T>().unwrap();
    let plain = stream(Shepard, &body, uneven::<T>);
    let single = stream(SubPoints::default(), &body, uneven::<T>);
    prop_assert_eq!(plain, single);
    Ok(())
}

/// Points lie in the cells that they name, those hold particles, no point is farther from its particle than
/// the domain reaches along each axis, and the weights sum to the volume.
fn spread_over_the_domain<T: Scalar, const D: usize>(
    per_axis: usize,
    layout: &Layout<D>,
) -> Result<(), TestCaseError> {
    let body = layout.body::<T>().unwrap();
    let grid = &body.grid;
    let points = stream(SubPoints::new(per_axis).unwrap(), &body, |_| T::one());
    let each = per_axis.pow(D as u32);
    prop_assert_eq!(points.len(), each * body.positions.len());
    for (p, points) in points.chunks(each).enumerate() {
        let (x, volume) = (body.positions[p], body.volumes[p]);
        let side = (volume / grid.cell_volume()).powf(T::one() / T::count(D));
        for (cell, position, _) in points {
            prop_assert_eq!(grid.locate(position), Some(*cell));
            prop_assert!(!body.bins.particles_in(grid.linear(cell)).is_empty());
            for a in 0..D {
                let reach = side * grid.cell_size()[a] / T::lit(2.0);
                let rounding = epsilon::<T>() * T::lit(8.0) * (x[a].abs() + reach);
                prop_assert!(
                    (position[a] - x[a]).abs() <= reach + rounding,
                    "{position} of {x}"
                );
            }
        }
        let sum = points.iter().fold(T::zero(), |sum, point| sum + point.2);
        prop_assert!((sum - volume).abs() <= volume * epsilon::<T>() * T::count(each));
    }
    Ok(())
}

/// Forces of a stress without pattern: their sum over the DOFs is round-off of their sizes, and a DOF of no
/// occupied cell has none.
fn forces_stay_in_the_material<const D: usize>(
    per_axis: usize,
    layout: &Layout<D>,
) -> Result<(), TestCaseError> {
    let body = layout.body::<f64>().unwrap();
    let grid = &body.grid;
    let mut basis = DualDomain::new();
    basis.take_in(grid, &body.bins);
    let count = BasisFamily::<f64, D>::dof_count(&basis, grid);
    let (mut force, mut inside) = (vec![SVector::<f64, D>::zeros(); count], vec![false; count]);
    for &number in body.bins.occupied() {
        let cell = grid.cell(number as usize);
        let centre = grid.centre(&cell);
        basis.for_each(grid, &cell, &centre, |i, phi, _| inside[i] |= phi > 0.0);
    }
    let mut size = 0.0;
    let points = stream(SubPoints::new(per_axis).unwrap(), &body, uneven::<f64>);
    for (cell, position, weighted) in &points {
        basis.for_each(grid, cell, position, |i, _, gradient| {
            force[i] -= gradient * *weighted;
            size += gradient.norm() * weighted.abs();
        });
    }
    let sum = force
        .iter()
        .fold(SVector::zeros(), |sum: SVector<f64, D>, f| sum + f);
    prop_assert!(
        sum.norm() <= f64::EPSILON * size * (points.len() + 8) as f64,
        "{sum}"
    );
    for (i, force) in force.iter().enumerate() {
        prop_assert!(inside[i] || force.norm() == 0.0, "DOF {i}: {force}");
    }
    Ok(())
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn one_sub_point_streams_what_shepard_streams(
        line in layouts::<1>(12, 8),
        plane in layouts::<2>(4, 12),
        space in layouts::<3>(2, 16),
    ) {
        one_is_shepard::<f64, 1>(&line)?;
        one_is_shepard::<f32, 1>(&line)?;
        one_is_shepard::<f64, 2>(&plane)?;
        one_is_shepard::<f64, 3>(&space)?;
    }

    #[test]
    fn sub_points_spread_the_volume_over_the_domain(
        per_axis in 1..=9_usize,
        line in layouts::<1>(12, 8),
        plane in layouts::<2>(4, 12),
        space in layouts::<3>(2, 16),
    ) {
        spread_over_the_domain::<f64, 1>(per_axis, &line)?;
        spread_over_the_domain::<f32, 1>(per_axis, &line)?;
        spread_over_the_domain::<f64, 1>(SubPoints::MOST.into(), &line)?;
        spread_over_the_domain::<f64, 2>(per_axis, &plane)?;
        spread_over_the_domain::<f64, 3>(1 + per_axis / 3, &space)?;
    }

    #[test]
    fn the_forces_of_sub_points_sum_to_zero_and_stay_in_the_material(
        per_axis in 1..=9_usize,
        line in layouts::<1>(12, 8),
        plane in layouts::<2>(4, 12),
    ) {
        forces_stay_in_the_material(per_axis, &line)?;
        forces_stay_in_the_material(per_axis, &plane)?;
    }
}
