//! Banded solves against dense ones.

use materialpoint::mass::Banded;
use materialpoint::scalar::Scalar;
use nalgebra::{DMatrix, DVector, SVector};
use proptest::collection::vec;
use proptest::prelude::*;

use super::{config, epsilon};

#[derive(Clone, Debug)]
struct System {
    order: usize,
    half_band: usize,
    /// Off-diagonal entries, taken in turn; zeros are likely.
    entries: Vec<f64>,
    right: Vec<f64>,
    /// Whether the diagonal is negative in places: a fitted density may be.
    indefinite: bool,
}

fn systems() -> impl Strategy<Value = System> {
    let entry = prop_oneof![Just(0.0), -1.0..1.0_f64];
    (1..14_usize, 0..6_usize, any::<bool>()).prop_flat_map(move |(order, half_band, indefinite)| {
        (vec(entry.clone(), order * 6), vec(-1.0..1.0_f64, order)).prop_map(move |(entries, right)| System {
            order,
            half_band,
            entries,
            right,
            indefinite,
        })
    })
}

/// The same matrix banded and dense. Each row's diagonal exceeds the sum of its other entries by one, so the
/// inverse's largest row sum is at most one (Varah) and the condition number at most the row sum.
fn matrices<T: Scalar>(system: &System) -> (Banded<T>, DMatrix<T>) {
    let (n, w) = (system.order, system.half_band);
    let mut dense = DMatrix::<T>::zeros(n, n);
    for i in 0..n {
        for j in i.saturating_sub(w)..i {
            let entry = T::lit(system.entries[i * 6 + i - j]);
            dense[(i, j)] = entry;
            dense[(j, i)] = entry;
        }
    }
    for i in 0..n {
        let others = dense.row(i).iter().fold(T::zero(), |sum, v| sum + v.abs());
        let sign = if system.indefinite && i % 3 == 1 {
            -T::one()
        } else {
            T::one()
        };
        dense[(i, i)] = sign * (others + T::one());
    }
    let mut banded = Banded::zeros(n, w);
    for i in 0..n {
        for j in 0..n {
            if i.abs_diff(j) <= w {
                banded.add(i, j, dense[(i, j)]);
            }
        }
    }
    (banded, dense)
}

/// Backward error of the factorisation: `w + 1` operations an entry, growth of entries at most 2 for a
/// diagonally dominant matrix; times the condition number, at most the largest row sum, `4 w + 1`. Twice that
/// for two solvers.
fn allowed<T: Scalar>(system: &System) -> T {
    let w = system.half_band;
    epsilon::<T>() * T::count(8 * (w + 1) * (4 * w + 1))
}

fn agrees_with_a_dense_solve<T: Scalar>(system: &System) -> Result<(), TestCaseError> {
    let (mut banded, dense) = matrices::<T>(system);
    let right: Vec<_> = system
        .right
        .iter()
        .map(|&b| SVector::<T, 2>::new(T::one(), T::lit(b)))
        .collect();
    let product = banded.multiply(&right);
    banded.factorise();
    let mut x = right.clone();
    banded.solve(&mut x, 1);
    let b = DVector::from_fn(system.order, |i, _| right[i][1]);
    let exact = dense.clone().lu().solve(&b).unwrap();
    let multiplied = &dense * &b;
    let size = T::count(4 * system.half_band + 1);
    for i in 0..system.order {
        prop_assert!(
            (x[i][1] - exact[i]).abs() <= allowed(system),
            "unknown {i}: {} {}",
            x[i][1],
            exact[i]
        );
        prop_assert_eq!(x[i][0], T::one(), "the other component is left alone");
        prop_assert!((product[i][1] - multiplied[i]).abs() <= size * size * epsilon::<T>());
    }
    Ok(())
}

/// With one unknown prescribed it has its value, and the other equations hold.
fn prescribes<T: Scalar>(system: &System, c: usize) -> Result<(), TestCaseError> {
    let (mut banded, dense) = matrices::<T>(system);
    let c = c % system.order;
    let value = T::lit(0.5);
    let mut x: Vec<_> = system
        .right
        .iter()
        .map(|&b| SVector::<T, 1>::new(T::lit(b)))
        .collect();
    banded.prescribe(c, 0, value, &mut x);
    banded.factorise();
    banded.solve(&mut x, 0);
    prop_assert_eq!(x[c][0], value);
    let solution = DVector::from_fn(system.order, |i, _| x[i][0]);
    let found = &dense * solution;
    let size = T::count(8 * system.half_band + 2);
    for i in (0..system.order).filter(|&i| i != c) {
        let residual = found[i] - T::lit(system.right[i]);
        prop_assert!(
            residual.abs() <= allowed::<T>(system) * size,
            "equation {i}: {residual}"
        );
    }
    Ok(())
}

fn total_is_the_sum<T: Scalar>(system: &System) -> Result<(), TestCaseError> {
    let (banded, dense) = matrices::<T>(system);
    let size = dense.iter().fold(T::zero(), |sum, v| sum + v.abs());
    let count = T::count(dense.len());
    prop_assert!((banded.total() - dense.sum()).abs() <= size * count * epsilon::<T>());
    Ok(())
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn banded_solves_are_dense_solves(system in systems(), c in 0..14_usize) {
        agrees_with_a_dense_solve::<f64>(&system)?;
        agrees_with_a_dense_solve::<f32>(&system)?;
        total_is_the_sum::<f64>(&system)?;
        total_is_the_sum::<f32>(&system)?;
        prescribes::<f64>(&system, c)?;
        prescribes::<f32>(&system, c)?;
    }
}
