//! The integrals of the Taylor functions, on which conservation rests.

use materialpoint::quadrature::gauss_legendre;
use materialpoint::scalar::Scalar;
use materialpoint::taylor::taylor_functions;
use nalgebra::SVector;

use super::epsilon;

/// Integrals over the reference cell `[-1, 1]^D`, as shares of its volume, by `n` Gauss points per axis.
fn integrals<T: Scalar, const D: usize, const NB: usize>(n: usize) -> SVector<T, NB> {
    let line = gauss_legendre::<T>(n);
    let mut sum = SVector::zeros();
    for mut index in 0..n.pow(D as u32) {
        let mut share = T::one();
        let s = SVector::<T, D>::from_fn(|_, _| {
            let (x, w) = line[index % n];
            index /= n;
            share *= w / T::lit(2.0);
            x
        });
        sum += taylor_functions::<T, D, NB>(&s) * share;
    }
    sum
}

fn check<T: Scalar, const D: usize, const NB: usize>() {
    for n in 2..6_usize {
        let found = integrals::<T, D, NB>(n);
        // Shares sum to one, functions are at most one: a rounding for each point, few for each value, and
        // for points and weights of the rule itself (Newton's last step; the weight squares a slope of n^2).
        let allowed = epsilon::<T>() * T::count(n.pow(D as u32) + 8 * D * n * n);
        for k in 0..NB {
            let exact = if k == 0 { T::one() } else { T::zero() };
            assert!(
                (found[k] - exact).abs() <= allowed,
                "{NB} functions, {n} points, function {k}: {found}"
            );
        }
    }
    // One point is too few for the quadratic functions, so the test can tell.
    if NB > D + 1 {
        let short = integrals::<T, D, NB>(1);
        assert!((short[D + 1] + T::one() / T::lit(6.0)).abs() <= epsilon::<T>());
    }
}

#[test]
fn only_the_first_function_has_an_integral() {
    check::<f64, 1, 3>();
    check::<f64, 2, 6>();
    check::<f64, 3, 10>();
    check::<f32, 1, 3>();
    check::<f32, 2, 6>();
    check::<f32, 3, 10>();
    check::<f64, 1, 2>();
    check::<f64, 2, 3>();
    check::<f32, 3, 4>();
}

/// The functions are those of the papers, in their order: value by value at one point.
#[test]
fn the_functions_are_those_printed() {
    let s = nalgebra::vector![0.5, -0.25, 0.75];
    let sixth = 1.0_f64 / 6.0;
    let expected = [
        1.0,
        0.5,
        -0.25,
        0.75,
        0.125 - sixth,
        0.03125 - sixth,
        0.28125 - sixth,
        -0.125,
        0.375,
        -0.1875,
    ];
    let found = taylor_functions::<f64, 3, 10>(&s);
    for k in 0..10 {
        assert!((found[k] - expected[k]).abs() <= f64::EPSILON, "function {k}");
    }
}
