//! The fast ways by which a step asks a basis: they must say what [`BasisFamily::for_each`] says.

use nalgebra::SVector;

use super::sample::{Sample, Visitor, slope_bound, value_error};
use crate::basis::{BasisFamily, Factors, FixedPoints, Linear};
use crate::grid::{Cell, Grid};
use crate::scalar::Scalar;
use crate::simd::{Four, LANES, Plain};
use crate::testing::failure::{Failure, Place, Property, near};

pub(super) fn check<T: Scalar, const D: usize, B: BasisFamily<T, D>>(
    basis: &B,
    grid: &Grid<T, D>,
    cell: &Cell<D>,
    x: &SVector<T, D>,
) -> Result<(), Failure> {
    let moving = Sample::new(basis, grid, cell, x, Visitor::Moving)?;
    if B::WIDTH > 0 && basis.dofs(grid).iter().all(|&dofs| dofs >= B::WIDTH) {
        same(
            Property::Factors,
            &by_factors(basis, grid, cell, x),
            &moving,
            basis,
            grid,
            x,
        )?;
    }
    let fixed = Sample::new(basis, grid, cell, x, Visitor::Fixed)?;
    match B::AT_FIXED_POINTS {
        FixedPoints::Alike => same(Property::FixedPointsAsSaid, &fixed, &moving, basis, grid, x)?,
        FixedPoints::Linear => {
            let linear = Sample::new(&Linear, grid, cell, x, Visitor::Moving)?;
            same(Property::FixedPointsAsSaid, &fixed, &linear, basis, grid, x)?;
        }
        FixedPoints::Other => {}
    }
    if B::CONSTANT_GRADIENT {
        let mut centre = Sample::new(basis, grid, cell, &grid.centre(cell), Visitor::Moving)?;
        // Its values are elsewhere.
        centre.value.clone_from(&moving.value);
        same(Property::ConstantGradient, &moving, &centre, basis, grid, x)?;
    }
    Ok(())
}

/// What the factors make of a point. The other lanes hold other points of the cell: a lane must not see its
/// neighbours.
fn by_factors<T: Scalar, const D: usize, B: BasisFamily<T, D>>(
    basis: &B,
    grid: &Grid<T, D>,
    cell: &Cell<D>,
    x: &SVector<T, D>,
) -> Sample<T, D> {
    let unit = std::array::from_fn(|axis| {
        let unit = grid.unit_coordinate(axis, cell[axis], x[axis]);
        let others = [0.0, 0.75, 0.5, 0.25].map(T::lit);
        Four(std::array::from_fn(
            |l| if l == LANES - 1 { unit } else { others[l] },
        ))
    });
    let Factors { value, slope } = basis.factors::<Plain>(Plain, grid, cell, &unit);
    let last = |pack: Four<T>| pack.0[LANES - 1];
    let (shape, first) = (basis.dofs(grid), grid.window().first());
    let starts = basis.first_dofs(grid, cell);
    let count = basis.dof_count(grid);
    let mut sample = Sample {
        value: vec![T::zero(); count],
        gradient: vec![SVector::zeros(); count],
        calls: 0,
    };
    for number in 0..B::WIDTH.pow(D as u32) {
        let place: [usize; D] = std::array::from_fn(|axis| number / B::WIDTH.pow(axis as u32) % B::WIDTH);
        let dof = (0..D).rev().fold(0, |dof, axis| {
            dof * shape[axis] + starts[axis] - first[axis] as usize + place[axis]
        });
        let along = |axis: usize, slopes: bool| {
            let of = if slopes { &slope } else { &value };
            last(of[axis][place[axis]])
        };
        // A DOF beyond the last one shows as a value that is missed.
        if let (Some(value), Some(gradient)) = (sample.value.get_mut(dof), sample.gradient.get_mut(dof)) {
            *value = (0..D).fold(T::one(), |product, axis| product * along(axis, false));
            *gradient = SVector::from_fn(|a, _| {
                (0..D).fold(grid.inverse_cell_size()[a], |product, axis| {
                    product * along(axis, axis == a)
                })
            });
        }
    }
    sample
}

/// Values to their round-off, gradients to that times the slope that goes with it.
fn same<T: Scalar, const D: usize, B: BasisFamily<T, D>>(
    property: Property,
    found: &Sample<T, D>,
    expected: &Sample<T, D>,
    basis: &B,
    grid: &Grid<T, D>,
    x: &SVector<T, D>,
) -> Result<(), Failure> {
    let error = value_error(basis, grid);
    for dof in 0..expected.value.len() {
        let place = || Place::dof(dof, x);
        near(property, place, expected.value[dof], found.value[dof], error)?;
        for a in 0..D {
            let allowed = error * slope_bound::<T, D, B>(basis) * grid.inverse_cell_size()[a];
            near(
                property,
                place,
                expected.gradient[dof][a],
                found.gradient[dof][a],
                allowed,
            )?;
        }
    }
    Ok(())
}
