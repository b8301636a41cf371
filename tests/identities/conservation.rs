//! What streams keep, on nasty layouts.

use materialpoint::field::{Field, MassMomentum};
use materialpoint::reconstruction::{CubicSpline, Reconstruction, Shepard, Taylor};
use materialpoint::scalar::Scalar;
use nalgebra::SVector;
use proptest::prelude::*;

use super::layout::{Body, Layout, layouts, uneven};
use super::{config, epsilon};

/// Mass of particle `p`, with densities between 1 and 3, and a momentum of either sign.
fn amount<T: Scalar, const D: usize>(body: &Body<T, D>, p: usize) -> MassMomentum<T, D> {
    let mass = body.volumes[p] * (uneven::<T>(p) + T::lit(2.0));
    MassMomentum {
        mass,
        momentum: SVector::from_fn(|a, _| mass * uneven(p + 11 * (a + 1))),
    }
}

/// Sums of one cell: what particles hold, what the stream brings, and the sizes of both.
#[derive(Clone, Copy, Debug)]
struct Balance<T> {
    held: T,
    streamed: T,
    held_size: T,
    streamed_size: T,
}

/// The balance of component `i` in each cell.
fn balances<T: Scalar, const D: usize, R: Reconstruction<T, D>>(
    reconstruction: &mut R,
    body: &Body<T, D>,
    i: usize,
) -> Vec<Balance<T>> {
    let zero = T::zero();
    let mut cells = vec![
        Balance {
            held: zero,
            streamed: zero,
            held_size: zero,
            streamed_size: zero
        };
        body.grid.cell_count()
    ];
    for p in 0..body.positions.len() {
        let value = amount(body, p).component(i);
        let cell = &mut cells[body.grid.linear(body.bins.cell_of(p))];
        cell.held += value;
        cell.held_size += value.abs();
    }
    reconstruction.prepare(&body.cloud());
    reconstruction.integrate_conserved(
        &body.cloud(),
        |p| amount(body, p),
        |point, weighted| {
            let cell = &mut cells[body.grid.linear(&point.cell)];
            cell.streamed += weighted.component(i);
            cell.streamed_size += weighted.component(i).abs();
        },
    );
    cells
}

/// Round-off of a cell's balance: summing its `n` particles and its `g` Gauss points; each of these adds `nb`
/// products of coefficients with functions of size one at most, whose sizes the streamed size misses where
/// they cancel at a point, but not by more than the condition of the `g` values for the coefficients: `2 nb`.
fn allowed<T: Scalar>(balance: &Balance<T>, n: usize, g: usize, nb: usize) -> T {
    epsilon::<T>()
        * (balance.held_size * T::count(n + 4) + balance.streamed_size * T::count(g + 2 * nb * nb + 4))
}

fn keeps_every_cell<T: Scalar, const D: usize, R: Reconstruction<T, D>>(
    reconstruction: &mut R,
    layout: &Layout<D>,
    gauss_points: usize,
    functions: usize,
) -> Result<(), TestCaseError> {
    let body = layout.body::<T>().unwrap();
    for i in 0..=D {
        for (number, balance) in balances(reconstruction, &body, i).iter().enumerate() {
            let n = body.bins.particles_in(number).len();
            let error = (balance.held - balance.streamed).abs();
            prop_assert!(
                error <= allowed(balance, n, gauss_points, functions),
                "component {i} in cell {number}: {balance:?}"
            );
        }
    }
    Ok(())
}

fn taylor_and_shepard<T: Scalar, const D: usize, const NB: usize>(
    layout: &Layout<D>,
) -> Result<(), TestCaseError> {
    for n in 2..4_usize {
        let mut taylor = Taylor::<T, D, NB>::with_gauss_points(n);
        keeps_every_cell(&mut taylor, layout, n.pow(D as u32), NB)?;
    }
    keeps_every_cell::<T, D, _>(&mut Shepard, layout, 0, 0)
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn taylor_and_shepard_keep_the_amounts_of_every_cell_1d(layout in layouts::<1>(12, 8)) {
        taylor_and_shepard::<f64, 1, 3>(&layout)?;
        taylor_and_shepard::<f32, 1, 3>(&layout)?;
    }

    #[test]
    fn taylor_and_shepard_keep_the_amounts_of_every_cell_2d(layout in layouts::<2>(4, 12)) {
        taylor_and_shepard::<f64, 2, 6>(&layout)?;
        taylor_and_shepard::<f32, 2, 6>(&layout)?;
        taylor_and_shepard::<f64, 2, 3>(&layout)?;
    }

    #[test]
    fn taylor_and_shepard_keep_the_amounts_of_every_cell_3d(layout in layouts::<3>(2, 16)) {
        taylor_and_shepard::<f64, 3, 10>(&layout)?;
        taylor_and_shepard::<f32, 3, 10>(&layout)?;
    }
}

/// A density of mass is the fit of the mass as any amount is fitted, but where that would be less than 1 % of
/// the cell's mean at a Gauss point: there it is drawn towards the mean, no further than it must, and a
/// momentum of one velocity with it.
fn stays_positive<T: Scalar, const D: usize, const NB: usize>(
    layout: &Layout<D>,
) -> Result<(), TestCaseError> {
    let body = layout.body::<T>().unwrap();
    let mut taylor = Taylor::<T, D, NB>::new();
    taylor.prepare(&body.cloud());
    let velocity = SVector::from_fn(|a, _| uneven::<T>(a + 5));
    let mass = |p: usize| amount(&body, p).mass;
    let together = |p: usize| MassMomentum {
        mass: mass(p),
        momentum: velocity * mass(p),
    };
    let (mut drawn, mut plain) = (Vec::<(usize, MassMomentum<T, D>)>::new(), Vec::new());
    taylor.integrate_conserved(&body.cloud(), together, |point, weighted| {
        drawn.push((body.grid.linear(&point.cell), weighted));
    });
    let limited = taylor.limited_cells();
    taylor.integrate_conserved(&body.cloud(), mass, |_, weighted: T| plain.push(weighted));
    let points = 1 << D;
    let mut seen = 0;
    for (drawn, plain) in drawn.chunks(points).zip(plain.chunks(points)) {
        let particles = body.bins.particles_in(drawn[0].0);
        let held = particles.iter().fold(T::zero(), |sum, &p| sum + mass(p as usize));
        let mean = held / T::count(points);
        let size = plain.iter().fold(held, |size, &m| size + m.abs());
        let round_off = epsilon::<T>() * T::count(particles.len() + 4 * NB * NB);
        let least = |values: &mut dyn Iterator<Item = T>| values.fold(T::lit(1e30), T::min);
        let before = least(&mut plain.iter().copied());
        let after = least(&mut drawn.iter().map(|(_, q)| q.mass));
        let bound = mean / T::lit(100.0);
        seen += usize::from(before < bound);
        prop_assert!(
            (after - before.max(bound)).abs() <= round_off * size,
            "{after} {before} {bound}"
        );
        for ((_, found), &plain) in drawn.iter().zip(plain) {
            prop_assert!(found.mass > T::zero(), "{found:?}");
            let apart = (found.momentum - velocity * found.mass).amax();
            prop_assert!(apart <= round_off * size, "{apart} {size}");
            prop_assert!(before < bound || found.mass == plain, "{found:?} {plain}");
        }
    }
    prop_assert!(limited.abs_diff(seen) <= 1, "{limited} {seen}");
    Ok(())
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn a_fitted_density_is_positive(
        line in layouts::<1>(12, 8),
        plane in layouts::<2>(4, 12),
        space in layouts::<3>(2, 16),
    ) {
        stays_positive::<f64, 1, 3>(&line)?;
        stays_positive::<f32, 1, 3>(&line)?;
        stays_positive::<f64, 2, 6>(&plane)?;
        stays_positive::<f64, 3, 10>(&space)?;
    }
}

/// Neighbours lend what they know: a parabola is seen by every cell that then has all functions, whatever its
/// own particles.
fn reproduces_a_parabola(layout: &Layout<1>) -> Result<(), TestCaseError> {
    let (body, mut taylor) = (
        layout.body::<f64>().unwrap(),
        Taylor::<f64, 1, 3>::new().with_virtual_points(true),
    );
    taylor.prepare(&body.cloud());
    if taylor.reduced_cells() > 0 {
        return Ok(());
    }
    let (min, h) = (layout.min, layout.h);
    // In cells from the grid's lower end.
    let parabola = |x: f64| 1.0 - 2.0 * x + x * x;
    let fits = taylor.free_coefficients(&body.cloud(), |p| parabola((body.positions[p][0] - min) / h));
    for (fit, &cell) in fits.iter().zip(body.bins.occupied()) {
        let centre = f64::from(cell) + 0.5;
        let exact = [parabola(centre) + 1.0 / 12.0, centre - 1.0, 0.5];
        for (found, expected) in fit.iter().zip(exact) {
            // Places are rounded in the size of `min`; a share of 2 % of a function magnifies that by 50,
            // twice.
            prop_assert!((found - expected).abs() < 1e-9, "{cell}: {fit:?} {exact:?}");
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn virtual_points_reproduce_a_parabola(layout in layouts::<1>(3, 5)) {
        reproduces_a_parabola(&layout)?;
    }
}

/// Relative to the amounts themselves, conservation is only as good as the fit's coefficients are small: at
/// most some five roundings of the largest.
fn keeps_cells_relative_to_coefficients<const D: usize, const NB: usize>(
    layout: &Layout<D>,
    mut taylor: Taylor<f64, D, NB>,
) -> Result<(), TestCaseError> {
    let body = layout.body::<f64>().unwrap();
    let balances = balances(&mut taylor, &body, 0);
    let coefficients = taylor.conserved_coefficients(&body.cloud(), |p| amount(&body, p).mass);
    for (k, &number) in body.bins.occupied().iter().enumerate() {
        let balance = balances[number as usize];
        let largest = coefficients[k].iter().fold(0.0_f64, |m, c| m.max(c.abs()));
        let n = body.bins.particles_in(number as usize).len();
        let size = largest * body.grid.cell_volume();
        // Each Gauss value sums NB products; the values sum with weights that add to one.
        let allowed = f64::EPSILON * size * (n + NB + (1 << D)) as f64;
        prop_assert!(
            (balance.held - balance.streamed).abs() <= allowed,
            "{balance:?}, {largest:e}"
        );
    }
    Ok(())
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn what_is_lost_is_round_off_of_the_coefficients(
        line in layouts::<1>(12, 8),
        plane in layouts::<2>(4, 12),
        space in layouts::<3>(2, 16),
    ) {
        keeps_cells_relative_to_coefficients::<1, 3>(&line, Taylor::new())?;
        keeps_cells_relative_to_coefficients::<2, 6>(&plane, Taylor::new())?;
        keeps_cells_relative_to_coefficients::<3, 10>(&space, Taylor::new())?;
    }
}

proptest! {
    #![proptest_config(config())]

    /// A virtual point changes how an amount is spread over its cell, and not the amount. What a neighbour
    /// says at the edge may be as large as its fit is badly determined, and the coefficients with it.
    #[test]
    fn virtual_points_keep_the_amounts_of_every_cell(layout in layouts::<1>(12, 5)) {
        keeps_cells_relative_to_coefficients(&layout, Taylor::<f64, 1, 3>::new().with_virtual_points(true))?;
    }
}

/// Three particles beside the centre of a cell: all that can be known there is a value. The slope's function
/// is small on all of them, so it must not be fitted, with a slope of `1 / distance`.
#[test]
fn a_cluster_beside_the_centre_of_a_cell_does_not_make_a_huge_slope() {
    use super::layout::Place::Near;
    for exponent in [-4, -8, -12, -15] {
        let layout = Layout {
            cells: [1],
            min: 0.0,
            h: 1.0,
            particles: vec![vec![[Near(1, 2, exponent)]; 3]],
        };
        let body = layout.body::<f64>().unwrap();
        let mut taylor = Taylor::<f64, 1, 3>::new();
        let balance = balances(&mut taylor, &body, 0)[0];
        // Densities are 3 at most.
        assert!(balance.streamed_size <= 30.0, "{balance:?}");
        assert!(
            (balance.held - balance.streamed).abs() <= 1e-14 * balance.held,
            "{balance:?}"
        );
    }
}

/// The spline, in contrast, keeps neither the cells' amounts nor the total.
#[test]
fn the_spline_loses_amounts() {
    let places = |n: usize| (0..n).map(move |k| (k as f64 + 0.5) / n as f64);
    let particles = (0..6).map(|c| {
        let shift = 0.04 * f64::from(c);
        places(4)
            .map(|u| [super::layout::Place::Anywhere(u + shift - 0.1)])
            .collect()
    });
    let layout = Layout {
        cells: [6],
        min: 0.0,
        h: 1.0,
        particles: particles.collect(),
    };
    let body = layout.body::<f64>().unwrap();
    let lost = |balances: &[Balance<f64>]| {
        let sum = |f: fn(&Balance<f64>) -> f64| balances.iter().map(f).sum::<f64>();
        (sum(|b| b.held) - sum(|b| b.streamed)).abs() / sum(|b| b.held_size)
    };
    assert!(lost(&balances(&mut CubicSpline::for_degree(1), &body, 0)) > 1e-3);
    assert!(lost(&balances(&mut Taylor::<f64, 1, 3>::new(), &body, 0)) < 1e-15);
    assert!(lost(&balances(&mut Shepard, &body, 0)) < 1e-15);
}
