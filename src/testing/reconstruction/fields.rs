//! Which polynomials are streamed exactly, and which are integrated exactly.

use nalgebra::SVector;

use super::ReconstructionClaims;
use super::stream::{Streamed, collect, largest_response, relative_error};
use crate::grid::{Cell, Grid};
use crate::reconstruction::{Cloud, Reconstruction, Streams};
use crate::scalar::Scalar;
use crate::testing::failure::{Failure, Place, Property};
use crate::testing::worst::Worst;

/// Product of powers of the coordinates, each running from -1 to 1 along its axis of the grid.
struct Monomial<'a, T, const D: usize> {
    grid: &'a Grid<T, D>,
    powers: [usize; D],
}

impl<T: Scalar, const D: usize> Monomial<'_, T, D> {
    fn coordinate(&self, axis: usize, x: T) -> T {
        let (min, max) = (self.grid.min()[axis], self.grid.max()[axis]);
        (x - min + (x - max)) / (max - min)
    }

    fn at(&self, x: &SVector<T, D>) -> T {
        (0..D).fold(T::one(), |product, a| {
            product * raise(self.coordinate(a, x[a]), self.powers[a])
        })
    }

    /// Integral over a cell.
    fn integral(&self, cell: &Cell<D>) -> T {
        (0..D).fold(T::one(), |product, a| {
            let i = cell[a] as usize;
            let end = |i| raise(self.coordinate(a, self.grid.edge(a, i)), self.powers[a] + 1);
            let extent = self.grid.max()[a] - self.grid.min()[a];
            product * (end(i + 1) - end(i)) * extent / T::count(2 * (self.powers[a] + 1))
        })
    }
}

fn raise<T: Scalar>(x: T, n: usize) -> T {
    (0..n).fold(T::one(), |product, _| product * x)
}

/// All powers of a total degree.
fn powers<const D: usize>(degree: usize) -> Vec<[usize; D]> {
    let all = (0..(degree + 1).pow(D as u32)).map(|mut index| {
        std::array::from_fn(|_| {
            let power = index % (degree + 1);
            index /= degree + 1;
            power
        })
    });
    all.filter(|p: &[usize; D]| p.iter().sum::<usize>() == degree)
        .collect()
}

pub(super) fn check<T: Scalar, const D: usize, R: Reconstruction<T, D>>(
    reconstruction: &mut R,
    cloud: &Cloud<'_, T, D>,
    claims: &ReconstructionClaims,
) -> Result<(), Failure> {
    let weights = collect(reconstruction, cloud, |_| T::one());
    let response = largest_response(reconstruction, cloud);
    let streams = Responses { weights, response };
    let integrated = claims.integrates.map_or(0, |degree| degree + 1);
    let reproduced = if R::Points::AT_PARTICLES {
        0
    } else {
        claims.reproduces + 1
    };
    for degree in 0..=integrated.max(reproduced) {
        let (mut values, mut integrals) = (Worst::new(), Worst::new());
        for powers in powers::<D>(degree) {
            let field = Monomial {
                grid: cloud.grid,
                powers,
            };
            let stream = collect(reconstruction, cloud, |p| field.at(&cloud.positions[p]));
            streams.compare_values(cloud, &field, &stream, &mut values);
            streams.compare_integrals(cloud, &field, &stream, &mut integrals);
        }
        if degree <= reproduced && !R::Points::AT_PARTICLES {
            values.judge(Property::Reproduces(degree), degree <= claims.reproduces)?;
        }
        if degree <= integrated {
            let claimed = claims.integrates.is_some_and(|d| degree <= d);
            integrals.judge(Property::Integrates(degree), claimed)?;
        }
    }
    Ok(())
}

/// What the stream does to the constant one, and at most to values of size one.
struct Responses<T, const D: usize> {
    weights: Vec<Streamed<T, D>>,
    response: Vec<T>,
}

impl<T: Scalar, const D: usize> Responses<T, D> {
    /// Weighted values against weight times the field. All fields are of size one.
    fn compare_values(
        &self,
        cloud: &Cloud<'_, T, D>,
        field: &Monomial<'_, T, D>,
        stream: &[Streamed<T, D>],
        worst: &mut Worst<T>,
    ) {
        let error = relative_error(cloud);
        for ((point, weight), &response) in stream.iter().zip(&self.weights).zip(&self.response) {
            let exact = weight.weighted * field.at(&point.position);
            let place = || Place::point(&point.position);
            worst.record(point.weighted - exact, error * response, place);
        }
    }

    /// Sums over each occupied cell against the exact integrals.
    fn compare_integrals(
        &self,
        cloud: &Cloud<'_, T, D>,
        field: &Monomial<'_, T, D>,
        stream: &[Streamed<T, D>],
        worst: &mut Worst<T>,
    ) {
        let error = relative_error(cloud);
        for &number in cloud.bins.occupied() {
            let cell = cloud.grid.cell(number as usize);
            let (mut sum, mut size) = (T::zero(), cloud.grid.cell_volume());
            for (point, &response) in stream.iter().zip(&self.response) {
                if point.cell == cell {
                    sum += point.weighted;
                    size += response;
                }
            }
            worst.record(sum - field.integral(&cell), error * size, || Place::cell(&cell));
        }
    }
}
