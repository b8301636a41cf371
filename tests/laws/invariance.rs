//! Frame indifference: an observer who rotates sees the rotated stress and the same state variables.
//!
//! Random paths of ten increments of up to 10 % with a random rotation of the observer in each. The path that
//! the observer sees has the increments R_k (1 + D_k) R_(k-1)^T. Expected: sigma* = R sigma R^T to round-off,
//! through yielding, separation and closing.

use super::{Specimen, config, moduli, random};
use materialpoint::law::{
    ConeMatch, ConstitutiveLaw, DruckerPrager, Hencky, NeoHookean, NewtonianFluid, StVenantKirchhoff,
    Strength, VonMises,
};
use nalgebra::{Rotation2, Rotation3, SMatrix};
use proptest::prelude::*;

const STEPS: u32 = 10;

/// Largest difference of the rotated stresses over the modulus.
fn difference<const D: usize, L: ConstitutiveLaw<f64, D>>(
    law: &L,
    seed: u32,
    rotation: impl Fn(u32) -> SMatrix<f64, D, D>,
) -> f64 {
    let (mut still, mut turned) = (Specimen::new(law), Specimen::new(law));
    let (mut before, mut worst) = (SMatrix::<f64, D, D>::identity(), 0.0_f64);
    for k in 0..STEPS {
        let increment = random::<D>(seed + k) * 0.1;
        let after = rotation(seed + 100 + k);
        let seen =
            after * (SMatrix::identity() + increment) * before.transpose() - SMatrix::<f64, D, D>::identity();
        still.update(&increment);
        turned.update(&seen);
        let expected = after * still.stress * after.transpose();
        worst = worst.max((turned.stress - expected).norm());
        assert!((turned.energy() - still.energy()).abs() < 1e-11 * moduli().p_wave());
        before = after;
    }
    worst / moduli().p_wave()
}

fn turn_2d(seed: u32) -> SMatrix<f64, 2, 2> {
    Rotation2::new(random::<1>(seed)[0] * 3.0).into_inner()
}

fn turn_3d(seed: u32) -> SMatrix<f64, 3, 3> {
    let angles = random::<3>(seed) * 3.0;
    Rotation3::from_euler_angles(angles[0], angles[1], angles[2]).into_inner()
}

fn worst<L: ConstitutiveLaw<f64, 2> + ConstitutiveLaw<f64, 3>>(law: &L, seed: u32) -> f64 {
    difference::<2, L>(law, seed, turn_2d).max(difference::<3, L>(law, seed, turn_3d))
}

fn strength(cohesion: f64) -> Strength<f64> {
    Strength {
        cohesion,
        friction_angle: 0.6,
        dilation_angle: 0.2,
    }
}

proptest! {
    #![proptest_config(config())]

    #[test]
    fn stress_turns_with_the_observer(seed in 0..1_000_000_u32) {
        let moduli = moduli();
        let metal = VonMises::new(moduli, 1e5, 1e6).unwrap();
        let clay = DruckerPrager::new(moduli, &strength(1e5), ConeMatch::PlaneStrain).unwrap();
        let sand = DruckerPrager::new(moduli, &strength(0.0), ConeMatch::TriaxialCompression).unwrap();
        let water = NewtonianFluid::new(1e7, 7.0, 1e-3).unwrap();
        let found = [
            worst(&NeoHookean { moduli }, seed),
            worst(&StVenantKirchhoff { moduli }, seed),
            worst(&Hencky { moduli }, seed),
            worst(&metal, seed),
            worst(&clay, seed),
            worst(&sand, seed),
            worst(&water, seed),
        ];
        prop_assert!(found.iter().all(|&e| e < 1e-11), "{found:?}");
    }
}
