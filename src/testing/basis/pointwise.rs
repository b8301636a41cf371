//! What every basis family promises at every point.

use nalgebra::SVector;

use super::sample::{Sample, Visitor, slope_bound, value_error};
use super::{cell_of, doors};
use crate::basis::BasisFamily;
use crate::grid::{Cell, Face, Grid, Side};
use crate::scalar::Scalar;
use crate::testing::failure::{Failure, Place, Property, at_least, near};

pub(super) fn check<T: Scalar, const D: usize, B: BasisFamily<T, D>>(
    basis: &B,
    grid: &Grid<T, D>,
    x: &SVector<T, D>,
) -> Result<(), Failure> {
    let cell = cell_of(grid, x)?;
    let moving = Sample::new(basis, grid, &cell, x, Visitor::Moving)?;
    let fixed = Sample::new(basis, grid, &cell, x, Visitor::Fixed)?;
    same_dofs(basis, grid, &cell, x)?;
    let error = value_error(basis, grid);
    unity(&moving, x, error)?;
    non_negative(&moving, x, error)?;
    for sample in [&moving, &fixed] {
        gradient_sum::<T, D, B>(basis, grid, sample, x, error)?;
    }
    half_band(&moving, x, basis.half_band(grid))?;
    same_values(&moving, &fixed, x, error)?;
    doors::check(basis, grid, &cell, x)?;
    if B::HOLDS_ABOUT {
        return Ok(());
    }
    Face::all::<D>().try_for_each(|face| on_face(basis, grid, face, x, error))
}

/// The DOFs at `x` are those at the cell's centre, one by one, and in the window of every span of cells with
/// this one at an end.
fn same_dofs<T: Scalar, const D: usize, B: BasisFamily<T, D>>(
    basis: &B,
    grid: &Grid<T, D>,
    cell: &Cell<D>,
    x: &SVector<T, D>,
) -> Result<(), Failure> {
    let seen_from = |x: &SVector<T, D>| {
        let mut dofs = Vec::new();
        basis.for_each(grid, cell, x, |dof, _, _| dofs.push(dof));
        dofs
    };
    let (here, centre) = (seen_from(x), seen_from(&grid.centre(cell)));
    let place = || Place::cell(cell);
    near(
        Property::SameDofsInCell,
        place,
        T::count(centre.len()),
        T::count(here.len()),
        T::zero(),
    )?;
    for (&a, &b) in here.iter().zip(&centre) {
        near(
            Property::SameDofsInCell,
            place,
            T::count(b),
            T::count(a),
            T::zero(),
        )?;
    }
    let (first, last) = (grid.cell(0), grid.cell(grid.cell_count() - 1));
    for window in [
        basis.dof_window(grid, cell, cell),
        basis.dof_window(grid, &first, cell),
        basis.dof_window(grid, cell, &last),
    ] {
        for &dof in &here {
            at_least(Property::DofWindow, place, T::count(window.start), T::count(dof))?;
            at_least(
                Property::DofWindow,
                place,
                T::count(dof + 1),
                T::count(window.end),
            )?;
        }
    }
    Ok(())
}

pub(super) fn unity<T: Scalar, const D: usize>(
    s: &Sample<T, D>,
    x: &SVector<T, D>,
    error: T,
) -> Result<(), Failure> {
    let sum = s.value.iter().fold(T::zero(), |sum, &v| sum + v);
    let allowed = error * T::count(s.calls);
    near(
        Property::PartitionOfUnity,
        || Place::point(x),
        T::one(),
        sum,
        allowed,
    )
}

pub(super) fn non_negative<T: Scalar, const D: usize>(
    s: &Sample<T, D>,
    x: &SVector<T, D>,
    error: T,
) -> Result<(), Failure> {
    s.value
        .iter()
        .enumerate()
        .try_for_each(|(dof, &v)| at_least(Property::NonNegative, || Place::dof(dof, x), -error, v))
}

/// The gradients carry the error of the values times the slope that goes with it.
pub(super) fn gradient_sum<T: Scalar, const D: usize, B: BasisFamily<T, D>>(
    basis: &B,
    grid: &Grid<T, D>,
    s: &Sample<T, D>,
    x: &SVector<T, D>,
    error: T,
) -> Result<(), Failure> {
    let sum = s.gradient.iter().fold(SVector::zeros(), |sum, g| sum + g);
    let relative = error * T::count(s.calls) * slope_bound::<T, D, B>(basis);
    (0..D).try_for_each(|axis| {
        let allowed = relative * grid.inverse_cell_size()[axis];
        near(
            Property::GradientSum,
            || Place::point(x),
            T::zero(),
            sum[axis],
            allowed,
        )
    })
}

fn same_values<T: Scalar, const D: usize>(
    a: &Sample<T, D>,
    b: &Sample<T, D>,
    x: &SVector<T, D>,
    error: T,
) -> Result<(), Failure> {
    (0..a.value.len()).try_for_each(|dof| {
        let place = || Place::dof(dof, x);
        near(
            Property::FixedPointValues,
            place,
            a.value[dof],
            b.value[dof],
            error,
        )
    })
}

pub(super) fn half_band<T: Scalar, const D: usize>(
    s: &Sample<T, D>,
    x: &SVector<T, D>,
    band: usize,
) -> Result<(), Failure> {
    let with_value = |v: &T| *v != T::zero();
    let first = s.value.iter().position(with_value).unwrap_or(0);
    let last = s.value.iter().rposition(with_value).unwrap_or(0);
    // A smaller reach than the band is welcome.
    let place = || Place::dof(last, x);
    at_least(Property::HalfBand, place, T::count(last - first), T::count(band))
}

/// Moves `x` onto the face and looks for values of other DOFs.
fn on_face<T: Scalar, const D: usize, B: BasisFamily<T, D>>(
    basis: &B,
    grid: &Grid<T, D>,
    face: Face,
    x: &SVector<T, D>,
    error: T,
) -> Result<(), Failure> {
    let mut x = *x;
    x[face.axis] = match face.side {
        Side::Min => grid.min()[face.axis],
        Side::Max => grid.max()[face.axis],
    };
    let cell = cell_of(grid, &x)?;
    let mut sample = Sample::new(basis, grid, &cell, &x, Visitor::Moving)?;
    let mut outside = None;
    basis.for_each_on_face(grid, face, |dof| match sample.value.get_mut(dof) {
        Some(value) => *value = T::zero(),
        None => outside = Some(dof),
    });
    if let Some(dof) = outside {
        let count = T::count(sample.value.len());
        at_least(
            Property::DofInRange,
            || Place::dof(dof, &x),
            T::count(dof + 1),
            count,
        )?;
    }
    sample
        .value
        .iter()
        .enumerate()
        .try_for_each(|(dof, &v)| near(Property::FaceValues, || Place::dof(dof, &x), T::zero(), v, error))
}
