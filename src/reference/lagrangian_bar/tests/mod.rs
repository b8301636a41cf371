//! Tests of the converged solution against closed forms, invariants and itself.

mod bar;
mod column;
mod refusals;

use super::*;

/// Advances and returns the states at 101 equal distances.
fn sample(reference: &mut impl Reference, length: f64, time: f64) -> Vec<State> {
    reference.advance(time).unwrap();
    (0..=100)
        .map(|i| reference.at(length * f64::from(i) / 100.0))
        .collect()
}

/// L2 norm of the difference of one field, relative to the second argument's.
fn relative_l2(a: &[State], b: &[State], field: impl Fn(&State) -> f64) -> f64 {
    let difference: f64 = a.iter().zip(b).map(|(a, b)| (field(a) - field(b)).powi(2)).sum();
    let norm: f64 = b.iter().map(|b| field(b).powi(2)).sum();
    (difference / norm).sqrt()
}
