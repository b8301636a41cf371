//! The fast ways by which a step asks a reconstruction: they must stream what [`Reconstruction::integrate`]
//! and [`Reconstruction::integrate_conserved`] do.

use nalgebra::SVector;

use super::stream::{Streamed, collect, largest_response, relative_error, uneven};
use crate::mass::MassModel;
use crate::reconstruction::{Cloud, Kept, Point, Reconstruction, Streams};
use crate::scalar::Scalar;
use crate::simd::{LANES, Plain};
use crate::testing::failure::{Failure, Place, Property, near};

pub(super) fn check<T: Scalar, const D: usize, R: Reconstruction<T, D>>(
    reconstruction: &mut R,
    cloud: &Cloud<'_, T, D>,
) -> Result<(), Failure> {
    if !R::Points::IN_CELLS {
        return Ok(());
    }
    let size = largest_response(reconstruction, cloud);
    let most = size.iter().fold(T::zero(), |most, &size| most.max(size));
    let places = cloud.bins.occupied().len();
    let whole = collect(reconstruction, cloud, uneven);
    reconstruction.prepare(cloud);
    R::Points::take_in_field(reconstruction, cloud, &uneven::<T>);
    let mut cells = Vec::new();
    // In two parts, the later one first, as threads may take them.
    for part in [places / 2..places, 0..places / 2] {
        R::Points::cells(reconstruction, cloud, part, uneven, keep(&mut cells));
    }
    same(Property::CellsStreamTheSame, cloud, whole.clone(), cells, most)?;
    if R::Points::IN_FOURS {
        let four = batched(reconstruction, cloud, false, &uneven);
        same(Property::FourStreamTheSame, cloud, whole, four, most)?;
    }
    if R::Mass::OF_PARTICLES {
        return Ok(());
    }
    conserved(reconstruction, cloud)
}

/// The same of a density, given as the amount that each particle holds.
fn conserved<T: Scalar, const D: usize, R: Reconstruction<T, D>>(
    reconstruction: &mut R,
    cloud: &Cloud<'_, T, D>,
) -> Result<(), Failure> {
    let density = |p: usize| uneven::<T>(p) + T::lit(2.0);
    let amount = |p: usize| density(p) * cloud.volumes[p];
    let (mut whole, mut cells) = (Vec::new(), Vec::new());
    reconstruction.integrate_conserved(cloud, amount, keep(&mut whole));
    let places = cloud.bins.occupied().len();
    for part in [places / 2..places, 0..places / 2] {
        R::Points::conserved_cells(reconstruction, cloud, part, amount, keep(&mut cells));
    }
    let largest = |most: T, point: &Streamed<T, D>| most.max(point.weighted.abs());
    let most = whole.iter().fold(T::zero(), largest) * T::lit(4.0);
    same(Property::CellsStreamTheSame, cloud, whole.clone(), cells, most)?;
    if R::Points::IN_FOURS {
        let four = batched(reconstruction, cloud, true, &density);
        same(Property::FourStreamTheSame, cloud, whole, four, most)?;
    }
    Ok(())
}

fn keep<T: Scalar, const D: usize>(points: &mut Vec<Streamed<T, D>>) -> impl FnMut(&Point<T, D>, T) {
    |point, weighted| {
        points.push(Streamed {
            cell: point.cell,
            position: point.position,
            weighted,
        });
    }
}

/// What four cells at once stream, and the cells that cannot be one by one; nothing if the reconstruction has
/// no line of points as it is set up, and then a step does not ask for four either.
fn batched<T: Scalar, const D: usize, R: Reconstruction<T, D>>(
    reconstruction: &R,
    cloud: &Cloud<'_, T, D>,
    conserve: bool,
    value: &impl Fn(usize) -> T,
) -> Vec<Streamed<T, D>> {
    let line: Vec<T> = R::Points::line(reconstruction).collect();
    let occupied = cloud.bins.occupied();
    let mut points = Vec::new();
    for first in (0..occupied.len()).step_by(LANES) {
        let places = first..occupied.len().min(first + LANES);
        let mut lanes_of_points: Vec<(usize, [T; LANES])> = Vec::new();
        let outcome = R::Points::integrate_batch::<Plain, T>(
            reconstruction,
            Plain,
            (cloud, places.clone()),
            conserve,
            Kept::nothing(),
            value,
            |number, components| lanes_of_points.push((number, components[0].0)),
        );
        for (lane, place) in places.enumerate() {
            let number = occupied[place] as usize;
            if outcome.hard[lane] {
                R::Points::integrate_single(
                    reconstruction,
                    cloud,
                    number,
                    conserve,
                    value,
                    &mut keep(&mut points),
                );
                continue;
            }
            let cell = cloud.grid.cell(number);
            let centre = cloud.grid.centre(&cell);
            for &(mut point, values) in &lanes_of_points {
                let position = SVector::from_fn(|a, _| {
                    let s = line
                        .get(point % line.len().max(1))
                        .copied()
                        .unwrap_or_else(T::zero);
                    point /= line.len().max(1);
                    centre[a] + s * cloud.grid.cell_size()[a] / T::lit(2.0)
                });
                points.push(Streamed {
                    cell,
                    position,
                    weighted: values[lane],
                });
            }
        }
    }
    points
}

/// Cell by cell the same points in the same order with the same weighted values, to round-off of `most`.
fn same<T: Scalar, const D: usize>(
    property: Property,
    cloud: &Cloud<'_, T, D>,
    mut expected: Vec<Streamed<T, D>>,
    mut found: Vec<Streamed<T, D>>,
    most: T,
) -> Result<(), Failure> {
    // Stable: the order within a cell stays.
    expected.sort_by_key(|point| point.cell);
    found.sort_by_key(|point| point.cell);
    let count = |points: &[Streamed<T, D>]| T::count(points.len());
    near(
        property,
        || Place::Everywhere,
        count(&expected),
        count(&found),
        T::zero(),
    )?;
    let error = relative_error(cloud);
    expected.iter().zip(&found).try_for_each(|(expected, found)| {
        let place = || Place::point(&expected.position);
        let same_cell = if expected.cell == found.cell {
            T::one()
        } else {
            T::zero()
        };
        near(property, place, T::one(), same_cell, T::zero())?;
        for a in 0..D {
            let allowed = error * cloud.grid.cell_size()[a];
            near(property, place, expected.position[a], found.position[a], allowed)?;
        }
        near(property, place, expected.weighted, found.weighted, error * most)
    })
}
