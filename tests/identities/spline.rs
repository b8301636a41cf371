//! The not-a-knot spline on uneven particles.

use materialpoint::grid::Grid;
use materialpoint::particles::Bins;
use materialpoint::reconstruction::{Cloud, CubicSpline, Reconstruction};
use materialpoint::scalar::Scalar;
use nalgebra::SVector;
use proptest::collection::vec;
use proptest::prelude::*;

use super::layout::uneven;
use super::{config, epsilon};

/// Distances between neighbours, from a twentieth up to one: their largest ratio is known.
const SMALLEST: f64 = 0.05;

/// Particles from left to right, then dealt out in another order (any step coprime to their number).
fn positions<T: Scalar>(gaps: &[f64]) -> Vec<SVector<T, 1>> {
    let mut x = T::lit(0.25);
    let mut line = vec![SVector::from([x])];
    for &gap in gaps {
        x += T::lit(gap);
        line.push(SVector::from([x]));
    }
    let n = line.len();
    let step = [7, 5, 3, 2, 1]
        .into_iter()
        .find(|step| n % step != 0)
        .unwrap_or(1);
    (0..n).map(|k| line[k * step % n]).collect()
}

/// The spline of particle values at `at`, on a grid that holds all particles.
fn spline<T: Scalar>(x: &[SVector<T, 1>], value: impl Fn(usize) -> T, at: &[T]) -> Vec<T> {
    let last = x.iter().fold(T::one(), |m, x| m.max(x[0]));
    let grid = Grid::new(SVector::from([T::zero()]), SVector::from([last + T::one()]), [4]).unwrap();
    let bins = Bins::new(&grid, x).unwrap();
    let volumes = vec![T::one(); x.len()];
    let mut spline = CubicSpline::for_degree(1);
    spline.prepare(&Cloud::new(&grid, &bins, x, &volumes).unwrap());
    let mut values = Vec::new();
    spline.at_points(value, at.iter().copied(), |_, v| values.push(v));
    values
}

/// Second derivatives are second differences of values of size one, over a gap squared: so many roundings of
/// `1/smallest^2`, each solved for in a diagonally dominant system; they enter with a gap squared, at most
/// one. The end conditions continue them by a ratio of gaps.
fn allowed<T: Scalar>(particles: usize) -> T {
    let ratio = T::one() / T::lit(SMALLEST);
    epsilon::<T>() * ratio * ratio * T::count(particles + 16)
}

/// Ascending points at, between and halfway between the particles.
fn points<T: Scalar>(x: &[SVector<T, 1>]) -> Vec<T> {
    let mut sorted: Vec<T> = x.iter().map(|x| x[0]).collect();
    sorted.sort_by(|a, b| a.primal().total_cmp(&b.primal()));
    let middle = |pair: &[T]| (pair[0] + pair[1]) / T::lit(2.0);
    let between: Vec<T> = sorted.windows(2).map(middle).collect();
    let mut all: Vec<T> = sorted.into_iter().chain(between).collect();
    all.sort_by(|a, b| a.primal().total_cmp(&b.primal()));
    all
}

/// A cubic comes back between any four particles or more, a parabola from three, a line from two.
fn reproduces_cubics<T: Scalar>(gaps: &[f64]) -> Result<(), TestCaseError> {
    let x = positions::<T>(gaps);
    let length = x.iter().fold(T::one(), |m, x| m.max(x[0]));
    let degree = (x.len() - 1).min(3);
    let field = |x: T| (0..degree).fold(T::one(), |f, _| T::one() - f * (x / length));
    let at = points(&x);
    for (&p, &found) in at.iter().zip(&spline(&x, |p| field(x[p][0]), &at)) {
        prop_assert!(
            (found - field(p)).abs() <= allowed(x.len()),
            "{found} at {p}, not {}",
            field(p)
        );
    }
    Ok(())
}

/// The spline takes every particle's value at the particle; of two at one place, the mean.
fn interpolates<T: Scalar>(gaps: &[f64], twice: usize) -> Result<(), TestCaseError> {
    let mut x = positions::<T>(gaps);
    let n = x.len();
    x.push(x[twice % n]);
    let two = T::lit(2.0);
    for p in 0..n {
        let found = spline(&x, uneven, &[x[p][0]])[0];
        let expected = if p == twice % n {
            (uneven::<T>(p) + uneven(n)) / two
        } else {
            uneven(p)
        };
        prop_assert!(
            (found - expected).abs() <= allowed(n),
            "particle {p}: {found}, not {expected}"
        );
    }
    Ok(())
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn cubics_come_back(gaps in vec(SMALLEST..1.0, 1..20)) {
        reproduces_cubics::<f64>(&gaps)?;
        reproduces_cubics::<f32>(&gaps)?;
    }

    #[test]
    fn particles_keep_their_values(gaps in vec(SMALLEST..1.0, 1..20), twice in 0..20_usize) {
        interpolates::<f64>(&gaps, twice)?;
        interpolates::<f32>(&gaps, twice)?;
    }
}
