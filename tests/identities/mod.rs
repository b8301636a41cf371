//! Identities that must hold for every layout of particles, for `f64` and `f32`, in one, two and three
//! dimensions, and the papers' figures for the reconstruction alone.
//!
//! Layouts are structured values ([`layout`]) that shrink towards few particles at simple fractions of a
//! cell, so that a failure shows the bad layout. Tolerances count roundings; none is chosen for comfort.

mod anchors;
mod banded;
mod bases;
mod conformance;
mod conservation;
mod eleven_points;
mod grid;
mod layout;
mod reproduction;
mod shrinking;
mod spline;
mod sub_points;
mod taylor_functions;

use proptest::test_runner::{Config, RngSeed};

/// 256 layouts or scenes for each property, always the same ones, and no files left behind. `PROPTEST_CASES`
/// and `PROPTEST_RNG_SEED` ask for more and for others.
pub fn config() -> Config {
    let asked = Config::default();
    Config {
        failure_persistence: None,
        rng_seed: match asked.rng_seed {
            RngSeed::Random => RngSeed::Fixed(2019),
            fixed => fixed,
        },
        max_shrink_iters: 20_000,
        ..asked
    }
}

/// The machine epsilon of a scalar.
fn epsilon<T: materialpoint::scalar::Scalar>() -> T {
    T::default_epsilon()
}
