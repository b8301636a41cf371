//! What a basis that asks for domains promises over them.

use nalgebra::{SMatrix, SVector};

use super::sample::{Sample, Visitor, slope_bound, value_error};
use super::{BasisClaims, cell_of, derivative, pointwise};
use crate::basis::{BasisFamily, Domain, Factors};
use crate::grid::{Cell, Grid};
use crate::scalar::Scalar;
use crate::simd::{Four, LANES, Plain};
use crate::testing::failure::{Failure, Place, Property, near};
use crate::testing::worst::Worst;

/// Sizes along the axes as shares of the greatest, each domain in turn with another one along an axis.
const SHARES: [f64; 3] = [1.0, 0.6, 0.3];
/// Greatest reach of edge vectors to each side, in cells: less than a half, so that no two corners of a
/// domain are on edges at once, where slopes jump.
const REACH: f64 = 0.45;
/// Share to which a domain shrinks that is to be almost a point.
const SMALL: f64 = 1.0 / 1024.0;
/// Means over domains divide by their lengths, the least of which is seven to a cell: round-off grows so.
const CARRIED: f64 = 16.0;

/// Over several domains at each point: the DOFs of a point in the same order, partition of unity, values that
/// are not negative, gradients that sum to zero, the half band, linear fields, the same values from both
/// sides of an edge, the factors; over one that vanishes what a point sees; and gradients that are the
/// derivatives of the values where that is claimed.
pub(super) fn check<T: Scalar, const D: usize, B: BasisFamily<T, D>>(
    basis: &B,
    grid: &Grid<T, D>,
    points: &[SVector<T, D>],
    claims: &BasisClaims,
) -> Result<(), Failure> {
    if !B::DOMAIN.is_asked_for() {
        return Ok(());
    }
    let error = value_error(basis, grid) * T::lit(CARRIED);
    for x in points {
        let cell = cell_of(grid, x)?;
        for turn in 0..SHARES.len() {
            let domain = domain::<T, D, B>(grid, turn);
            let sample = Sample::new(basis, grid, &cell, x, Visitor::Over(domain))?;
            same_dofs(basis, grid, &cell, x, &domain)?;
            pointwise::unity(&sample, x, error)?;
            pointwise::non_negative(&sample, x, error)?;
            pointwise::gradient_sum::<T, D, B>(basis, grid, &sample, x, error)?;
            pointwise::half_band(&sample, x, basis.half_band(grid))?;
            linear_field(basis, grid, &sample, x, error, claims)?;
            continuous(basis, grid, &cell, x, domain, error)?;
            if B::WIDTH > 0 && basis.dofs(grid).iter().all(|&dofs| dofs >= B::WIDTH) {
                factors(basis, grid, &cell, x, &domain, error)?;
            }
        }
        vanishing(basis, grid, &cell, x, error)?;
    }
    if claims.gradients_are_derivatives {
        derivatives(basis, grid, points)?;
    }
    Ok(())
}

/// The domain of a turn: a box where sizes are asked for, one that is sheared and turned otherwise.
fn domain<T: Scalar, const D: usize, B: BasisFamily<T, D>>(
    grid: &Grid<T, D>,
    turn: usize,
) -> SMatrix<T, D, D> {
    let share = |axis: usize| SHARES[(turn + axis) % SHARES.len()];
    SMatrix::from_fn(|axis, edge| {
        let in_cells = match B::DOMAIN {
            Domain::Size { most } if axis == edge => most * share(axis),
            Domain::Edges if axis <= edge => REACH * share(edge) / D as f64,
            Domain::Edges => -REACH * share(edge) / (2 * D) as f64,
            _ => 0.0,
        };
        grid.cell_size()[axis] * T::lit(in_cells)
    })
}

fn same_dofs<T: Scalar, const D: usize, B: BasisFamily<T, D>>(
    basis: &B,
    grid: &Grid<T, D>,
    cell: &Cell<D>,
    x: &SVector<T, D>,
    domain: &SMatrix<T, D, D>,
) -> Result<(), Failure> {
    let (mut of_point, mut over) = (Vec::new(), Vec::new());
    basis.for_each(grid, cell, x, |dof, _, _| of_point.push(dof));
    basis.for_each_over(grid, cell, x, domain, |dof, _, _| over.push(dof));
    let same = |expected: usize, found: usize| {
        let place = || Place::cell(cell);
        near(
            Property::SameDofsInCell,
            place,
            T::count(expected),
            T::count(found),
            T::zero(),
        )
    };
    same(of_point.len(), over.len())?;
    of_point.iter().zip(&over).try_for_each(|(&a, &b)| same(a, b))
}

/// A linear field, whose coefficients are its values at the interpolation points, is itself at the centre.
fn linear_field<T: Scalar, const D: usize, B: BasisFamily<T, D>>(
    basis: &B,
    grid: &Grid<T, D>,
    sample: &Sample<T, D>,
    x: &SVector<T, D>,
    error: T,
    claims: &BasisClaims,
) -> Result<(), Failure> {
    let place = || Place::point(x);
    let nodes: Vec<_> = (0..sample.value.len())
        .map(|dof| basis.interpolation_point(grid, dof))
        .collect();
    for axis in 0..D {
        let of = |node: &SVector<T, D>| (node[axis] - x[axis]) * grid.inverse_cell_size()[axis];
        let allowed = error * T::count(sample.calls * grid.cells()[axis]);
        if claims.reproduces > 0 {
            let values = nodes.iter().zip(&sample.value);
            let found = values.fold(T::zero(), |sum, (node, &value)| sum + of(node) * value);
            near(Property::Reproduces(1), place, T::zero(), found, allowed)?;
        }
        for along in 0..D {
            let gradients = nodes.iter().zip(&sample.gradient);
            let slope = gradients.fold(T::zero(), |sum, (node, gradient)| {
                sum + of(node) * gradient[along] * grid.cell_size()[along]
            });
            let expected = if along == axis { T::one() } else { T::zero() };
            let allowed = allowed * slope_bound::<T, D, B>(basis);
            if claims.gradient_reproduces_linear {
                near(Property::GradientOfLinearField, place, expected, slope, allowed)?;
            }
        }
    }
    Ok(())
}

/// A particle on the edge between two cells has the same values from both.
fn continuous<T: Scalar, const D: usize, B: BasisFamily<T, D>>(
    basis: &B,
    grid: &Grid<T, D>,
    cell: &Cell<D>,
    x: &SVector<T, D>,
    domain: SMatrix<T, D, D>,
    error: T,
) -> Result<(), Failure> {
    for axis in 0..D {
        let mut next = *cell;
        next[axis] += 1;
        if grid.locate(&grid.centre(&next)) != Some(next) {
            continue;
        }
        let mut x = *x;
        x[axis] = grid.edge(axis, next[axis] as usize);
        let below = Sample::new(basis, grid, cell, &x, Visitor::Over(domain))?.value;
        let above = Sample::new(basis, grid, &next, &x, Visitor::Over(domain))?.value;
        for (dof, (&below, &above)) in below.iter().zip(&above).enumerate() {
            let place = || Place::dof(dof, &x);
            near(Property::Continuous, place, below, above, error + error)?;
        }
    }
    Ok(())
}

/// Over no domain a particle is a point, and over a small one almost: values change by no more than the
/// slopes times the reach.
fn vanishing<T: Scalar, const D: usize, B: BasisFamily<T, D>>(
    basis: &B,
    grid: &Grid<T, D>,
    cell: &Cell<D>,
    x: &SVector<T, D>,
    error: T,
) -> Result<(), Failure> {
    let small = domain::<T, D, B>(grid, 0) * T::lit(SMALL);
    let point = Sample::new(basis, grid, cell, x, Visitor::Moving)?;
    let nothing = Sample::new(basis, grid, cell, x, Visitor::Over(SMatrix::zeros()))?;
    let almost = Sample::new(basis, grid, cell, x, Visitor::Over(small))?;
    let steepest = slope_bound::<T, D, B>(basis) * T::count(D);
    for dof in 0..point.value.len() {
        let place = || Place::dof(dof, x);
        let same =
            |expected, found, allowed| near(Property::VanishingDomain, place, expected, found, allowed);
        same(point.value[dof], nothing.value[dof], error)?;
        same(
            point.value[dof],
            almost.value[dof],
            error * T::lit(1.0 / SMALL) + T::lit(SMALL) * steepest,
        )?;
        for a in 0..D {
            let allowed = error * steepest * grid.inverse_cell_size()[a];
            same(point.gradient[dof][a], nothing.gradient[dof][a], allowed)?;
        }
    }
    Ok(())
}

/// Packs say what single particles see; the other lanes hold others, of other sizes.
fn factors<T: Scalar, const D: usize, B: BasisFamily<T, D>>(
    basis: &B,
    grid: &Grid<T, D>,
    cell: &Cell<D>,
    x: &SVector<T, D>,
    domain: &SMatrix<T, D, D>,
    error: T,
) -> Result<(), Failure> {
    let lanes = |own: T, others: [f64; LANES]| {
        Four(std::array::from_fn(|l| {
            if l == LANES - 1 { own } else { T::lit(others[l]) }
        }))
    };
    let units = std::array::from_fn(|axis| {
        let unit = grid.unit_coordinate(axis, cell[axis], x[axis]);
        lanes(unit, [0.0, 0.75, 0.5, 0.0])
    });
    let halves = std::array::from_fn(|axis| {
        let half = domain[(axis, axis)] * grid.inverse_cell_size()[axis];
        lanes(half, [0.1, 0.0, 0.2, 0.0])
    });
    let Factors { value, slope } = basis.factors_over::<Plain>(Plain, grid, cell, &units, &halves);
    let last = |pack: Four<T>| pack.0[LANES - 1];
    let expected = Sample::new(basis, grid, cell, x, Visitor::Over(*domain))?;
    let (shape, first) = (basis.dofs(grid), grid.window().first());
    let starts = basis.first_dofs(grid, cell);
    for number in 0..B::WIDTH.pow(D as u32) {
        let place: [usize; D] = std::array::from_fn(|axis| number / B::WIDTH.pow(axis as u32) % B::WIDTH);
        let dof = (0..D).rev().fold(0, |dof, axis| {
            dof * shape[axis] + starts[axis] - first[axis] as usize + place[axis]
        });
        let product = |of: &dyn Fn(usize) -> T| (0..D).fold(T::one(), |all, axis| all * of(axis));
        let at = || Place::dof(dof, x);
        let found = product(&|axis| last(value[axis][place[axis]]));
        let right = expected.value.get(dof).copied().unwrap_or_else(T::zero);
        near(Property::Factors, at, right, found, error)?;
        for a in 0..D {
            let found = product(&|axis| {
                let of = if axis == a { &slope } else { &value };
                last(of[axis][place[axis]])
            });
            let right = expected
                .gradient
                .get(dof)
                .map_or_else(T::zero, |gradient| gradient[a]);
            let allowed = error * slope_bound::<T, D, B>(basis);
            near(Property::Factors, at, right * grid.cell_size()[a], found, allowed)?;
        }
    }
    Ok(())
}

/// Gradients lie between the differences to both sides, or beyond by what functions bend in a step: by one
/// over the half length at most, as the mean of a hat does, whose slope changes by 2 across its node. What
/// becomes of a domain that a wall meets is the basis's own affair.
fn derivatives<T: Scalar, const D: usize, B: BasisFamily<T, D>>(
    basis: &B,
    grid: &Grid<T, D>,
    points: &[SVector<T, D>],
) -> Result<(), Failure> {
    let mut worst = Worst::new();
    let step = T::lit(derivative::STEP);
    for (x, turn) in points
        .iter()
        .flat_map(|x| (0..SHARES.len()).map(move |turn| (x, turn)))
    {
        let cell = cell_of(grid, x)?;
        let x = derivative::inside(grid, &cell, x);
        let domain = domain::<T, D, B>(grid, turn);
        if reaches_a_wall(grid, &x, &domain) {
            continue;
        }
        let visitor = Visitor::Over(domain);
        let here = Sample::new(basis, grid, &cell, &x, visitor)?;
        for axis in 0..D {
            let h = grid.cell_size()[axis];
            let side = |shift: T| {
                let mut x = x;
                x[axis] += shift * h;
                Sample::new(basis, grid, &cell, &x, visitor).map(|sample| sample.value)
            };
            let (below, above) = (side(-step)?, side(step)?);
            for dof in 0..below.len() {
                let slopes = [here.value[dof] - below[dof], above[dof] - here.value[dof]].map(|d| d / step);
                let found = here.gradient[dof][axis] * h;
                let beyond = (slopes[0].min(slopes[1]) - found)
                    .max(found - slopes[0].max(slopes[1]))
                    .max(T::zero());
                let bend = step / T::lit(REACH * SHARES[2]);
                let round_off = value_error(basis, grid) * T::lit(CARRIED) / step;
                worst.record(beyond, round_off + bend, || Place::dof(dof, &x));
            }
        }
    }
    worst.judge(Property::GradientsAreDerivatives, true)
}

/// Whether a domain, or one a step beside it, reaches beyond the grid.
fn reaches_a_wall<T: Scalar, const D: usize>(
    grid: &Grid<T, D>,
    x: &SVector<T, D>,
    domain: &SMatrix<T, D, D>,
) -> bool {
    (0..D).any(|a| {
        let margin = grid.cell_size()[a] * T::lit(derivative::STEP);
        let reach = domain.row(a).iter().fold(margin, |sum, edge| sum + edge.abs());
        x[a] - reach < grid.min()[a] || x[a] + reach > grid.max()[a]
    })
}
