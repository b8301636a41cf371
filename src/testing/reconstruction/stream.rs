//! The stream itself: where its points are, what they weigh, and that it is linear.

use nalgebra::SVector;

use super::Measure;
use crate::grid::Cell;
use crate::particles::Bins;
use crate::reconstruction::{Cloud, Reconstruction, Streams};
use crate::scalar::Scalar;
use crate::testing::failure::{Failure, Place, Property, near};

/// A stream point with its weighted value.
#[derive(Clone, Copy, Debug)]
pub(super) struct Streamed<T, const D: usize> {
    pub(super) cell: Cell<D>,
    pub(super) position: SVector<T, D>,
    pub(super) weighted: T,
}

/// What `integrate` streams of a scalar field.
pub(super) fn collect<T: Scalar, const D: usize, R: Reconstruction<T, D>>(
    reconstruction: &mut R,
    cloud: &Cloud<'_, T, D>,
    value: impl Fn(usize) -> T,
) -> Vec<Streamed<T, D>> {
    let mut points = Vec::new();
    reconstruction.integrate(cloud, value, |point, weighted| {
        points.push(Streamed {
            cell: point.cell,
            position: point.position,
            weighted,
        });
    });
    points
}

/// A value for each particle, of size one at most and without pattern.
pub(super) fn uneven<T: Scalar>(p: usize) -> T {
    T::lit(((p * p * 7 + p * 3 + 5) % 31) as f64) / T::lit(15.0) - T::one()
}

/// Round-off of a stream point's value over the largest particle value, if no digits cancel: the particles of
/// a cell are summed, and each enters with a local coordinate rounded like the number of cells, or like its
/// distance from the origin in cells, at which positions themselves are rounded.
pub(super) fn relative_error<T: Scalar, const D: usize>(cloud: &Cloud<'_, T, D>) -> T {
    let fullest = (0..cloud.grid.cell_count()).map(|c| cloud.bins.particles_in(c).len());
    let cells = cloud.grid.cells().into_iter().max().unwrap_or(1);
    let farthest = (0..D)
        .map(|a| {
            let (low, high) = (cloud.grid.min()[a].abs(), cloud.grid.max()[a].abs());
            low.max(high) * cloud.grid.inverse_cell_size()[a]
        })
        .fold(T::zero(), T::max);
    let operations = T::count(fullest.max().unwrap_or(0) + cells + 8) + farthest;
    T::count(4 * D) * operations * T::default_epsilon()
}

pub(super) fn check<T: Scalar, const D: usize, R: Reconstruction<T, D>>(
    reconstruction: &mut R,
    cloud: &Cloud<'_, T, D>,
    measure: Measure,
) -> Result<(), Failure> {
    let weights = collect(reconstruction, cloud, |_| T::one());
    in_cells(cloud, &weights)?;
    let field = collect(reconstruction, cloud, uneven);
    same_points(&weights, &field)?;
    if R::Points::AT_PARTICLES {
        are_particles(cloud, &weights, |p| cloud.volumes[p])?;
        are_particles(cloud, &field, |p| uneven::<T>(p) * cloud.volumes[p])?;
    }
    total_weights(cloud, &weights, measure)?;
    linear(reconstruction, cloud, &weights, &field)
}

pub(super) fn in_cells<T: Scalar, const D: usize>(
    cloud: &Cloud<'_, T, D>,
    stream: &[Streamed<T, D>],
) -> Result<(), Failure> {
    stream.iter().try_for_each(|point| {
        // Also the position on an inner edge must name the cell that `locate` names.
        let inside = cloud.grid.locate(&point.position) == Some(point.cell);
        let found = if inside { T::one() } else { T::zero() };
        let place = || Place::point(&point.position);
        near(Property::StreamInCell, place, T::one(), found, T::zero())
    })
}

fn same_points<T: Scalar, const D: usize>(a: &[Streamed<T, D>], b: &[Streamed<T, D>]) -> Result<(), Failure> {
    let count = |n: usize| T::count(n);
    let everywhere = || Place::Everywhere;
    near(
        Property::SamePoints,
        everywhere,
        count(a.len()),
        count(b.len()),
        T::zero(),
    )?;
    a.iter().zip(b).try_for_each(|(a, b)| {
        let distance = (a.position - b.position).norm();
        near(
            Property::SamePoints,
            || Place::point(&a.position),
            T::zero(),
            distance,
            T::zero(),
        )
    })
}

/// The stream consists of the particles, in their order, with the given `weighted` values.
pub(super) fn are_particles<T: Scalar, const D: usize>(
    cloud: &Cloud<'_, T, D>,
    stream: &[Streamed<T, D>],
    weighted: impl Fn(usize) -> T,
) -> Result<(), Failure> {
    let property = Property::StreamsParticles;
    let expected = T::count(cloud.positions.len());
    near(
        property,
        || Place::Everywhere,
        expected,
        T::count(stream.len()),
        T::zero(),
    )?;
    stream
        .iter()
        .zip(cloud.positions)
        .enumerate()
        .try_for_each(|(p, (point, x))| {
            let place = || Place::point(x);
            near(property, place, T::zero(), (point.position - x).norm(), T::zero())?;
            // A product or two.
            let allowed = weighted(p).abs() * T::default_epsilon() * T::lit(2.0);
            near(property, place, weighted(p), point.weighted, allowed)
        })
}

fn total_weights<T: Scalar, const D: usize>(
    cloud: &Cloud<'_, T, D>,
    weights: &[Streamed<T, D>],
    measure: Measure,
) -> Result<(), Failure> {
    let volume = |particles: &[u32]| {
        let volumes = particles.iter().map(|&p| cloud.volumes[p as usize]);
        volumes.fold(T::zero(), |sum, v| sum + v)
    };
    if measure == Measure::AllParticles {
        let expected = cloud.volumes.iter().fold(T::zero(), |sum, &v| sum + v);
        let error = relative_error(cloud) + T::count(weights.len()) * T::default_epsilon();
        return weigh(weights.iter(), expected, error, || Place::Everywhere);
    }
    let error = relative_error(cloud);
    (0..cloud.grid.cell_count()).try_for_each(|number| {
        let cell = cloud.grid.cell(number);
        let particles = cloud.bins.particles_in(number);
        let expected = match measure {
            Measure::OccupiedCells if !particles.is_empty() => cloud.grid.cell_volume(),
            Measure::OccupiedCells => T::zero(),
            Measure::Particles | Measure::AllParticles => volume(particles),
        };
        let here = weights.iter().filter(|point| point.cell == cell);
        weigh(here, expected, error, || Place::cell(&cell))
    })
}

/// The sum of the weights of `points`, up to `error` of their sizes.
fn weigh<'a, T: Scalar, const D: usize>(
    points: impl Iterator<Item = &'a Streamed<T, D>>,
    expected: T,
    error: T,
    place: impl FnOnce() -> Place,
) -> Result<(), Failure> {
    let (sum, size) = points.fold((T::zero(), expected), |(sum, size), point| {
        (sum + point.weighted, size + point.weighted.abs())
    });
    near(Property::Weights, place, expected, sum, size * error)
}

/// `stream(2 f - 3) = 2 stream(f) - 3 stream(1)`.
fn linear<T: Scalar, const D: usize, R: Reconstruction<T, D>>(
    reconstruction: &mut R,
    cloud: &Cloud<'_, T, D>,
    weights: &[Streamed<T, D>],
    field: &[Streamed<T, D>],
) -> Result<(), Failure> {
    let (two, three) = (T::lit(2.0), T::lit(3.0));
    let mixed = collect(reconstruction, cloud, |p| two * uneven(p) - three);
    let size = largest_response(reconstruction, cloud);
    let error = relative_error(cloud);
    (0..mixed.len()).try_for_each(|k| {
        let expected = two * field[k].weighted - three * weights[k].weighted;
        let place = || Place::point(&mixed[k].position);
        let allowed = error * size[k] * T::lit(5.0);
        near(Property::Linear, place, expected, mixed[k].weighted, allowed)
    })
}

/// For each stream point the largest weighted value that particle values of size one can cause there: the sum
/// of the responses to each particle alone.
pub(super) fn largest_response<T: Scalar, const D: usize, R: Reconstruction<T, D>>(
    reconstruction: &mut R,
    cloud: &Cloud<'_, T, D>,
) -> Vec<T> {
    let mut sum = Vec::new();
    for particle in 0..cloud.positions.len() {
        let one_at = |p: usize| if p == particle { T::one() } else { T::zero() };
        let responses = collect(reconstruction, cloud, one_at);
        sum.resize(responses.len(), T::zero());
        sum.iter_mut()
            .zip(&responses)
            .for_each(|(s, r)| *s += r.weighted.abs());
    }
    sum
}

/// The same stream again after `prepare` saw the particles mirrored.
pub(super) fn forgets<T: Scalar, const D: usize, R: Reconstruction<T, D>>(
    reconstruction: &mut R,
    cloud: &Cloud<'_, T, D>,
) -> Result<(), Failure> {
    let (min, max) = (cloud.grid.min(), cloud.grid.max());
    // Mirroring may round a particle out of the grid.
    let mirror =
        |x: &SVector<T, D>| SVector::from_fn(|a, _| (min[a] + (max[a] - x[a])).max(min[a]).min(max[a]));
    let positions: Vec<_> = cloud.positions.iter().map(mirror).collect();
    let Ok(bins) = Bins::new(cloud.grid, &positions) else {
        return Ok(());
    };
    let before = collect(reconstruction, cloud, uneven);
    reconstruction.prepare(&Cloud {
        bins: &bins,
        positions: &positions,
        ..*cloud
    });
    reconstruction.prepare(cloud);
    let after = collect(reconstruction, cloud, uneven);
    let size = largest_response(reconstruction, cloud);
    let error = relative_error(cloud);
    same_points(&before, &after)?;
    (0..after.len()).try_for_each(|k| {
        let place = || Place::point(&after[k].position);
        near(
            Property::PrepareForgets,
            place,
            before[k].weighted,
            after[k].weighted,
            error * size[k],
        )
    })
}
