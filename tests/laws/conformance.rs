//! The library's own checks on each law, in double and single precision.

use materialpoint::law::{
    ConeMatch, ConstitutiveLaw, DruckerPrager, Hencky, Moduli, NewtonianFluid, StVenantKirchhoff, Strength,
    VonMises,
};
use materialpoint::scalar::Scalar;
use materialpoint::testing::{Failure, LawClaims, LawSample, check_law};

const ELASTIC: LawClaims = LawClaims {
    energy_is_work: true,
    wave_speed_is_sharp: true,
    objective: true,
    stable: true,
};

/// Sharp only before it yields; what it dissipates is no energy.
const PLASTIC: LawClaims = LawClaims {
    energy_is_work: false,
    wave_speed_is_sharp: false,
    objective: true,
    stable: true,
};

fn check<T: Scalar, const D: usize, L: ConstitutiveLaw<T, D>>(
    law: &L,
    claims: &LawClaims,
) -> Result<(), Failure> {
    check_to(0.05, law, claims)
}

/// Up to a strain.
fn check_to<T: Scalar, const D: usize, L: ConstitutiveLaw<T, D>>(
    strain: f64,
    law: &L,
    claims: &LawClaims,
) -> Result<(), Failure> {
    let sample = LawSample {
        density: T::lit(2e3),
        strain: T::lit(strain),
    };
    check_law(law, &sample, claims)
}

/// Yielding at a strain of about `strain`.
fn plastic<T: Scalar>(moduli: Moduli<T>, strain: f64) -> (VonMises<T>, DruckerPrager<T>) {
    let cohesion = moduli.mu * T::lit(strain);
    let strength = Strength {
        cohesion,
        friction_angle: T::lit(0.4),
        dilation_angle: T::lit(0.2),
    };
    let metal = VonMises::new(moduli, cohesion, moduli.mu / T::lit(10.0));
    let soil = DruckerPrager::new(moduli, &strength, ConeMatch::TriaxialCompression);
    (metal.unwrap(), soil.unwrap())
}

fn laws<T: Scalar, const D: usize>() -> Result<(), Failure> {
    let moduli = Moduli::from_young(T::lit(4e4), T::lit(0.3)).unwrap();
    check::<T, D, _>(&StVenantKirchhoff { moduli }, &ELASTIC)?;
    check::<T, D, _>(&Hencky { moduli }, &ELASTIC)?;
    // Of the exponent 7 a strain of 5 % is beyond what the check takes for small.
    for (gamma, strain) in [(1.0, 0.05), (7.0, 0.01)] {
        let fluid = NewtonianFluid::new(T::lit(4e4), T::lit(gamma), T::one()).unwrap();
        check_to::<T, D, _>(strain, &fluid.bearing_tension(), &ELASTIC)?;
    }
    let (metal, soil) = plastic(moduli, 10.0);
    check::<T, D, _>(&metal, &ELASTIC)?;
    check::<T, D, _>(&soil, &ELASTIC)?;
    let (metal, soil) = plastic(moduli, 0.02);
    check::<T, D, _>(&metal, &PLASTIC)?;
    check::<T, D, _>(&soil, &PLASTIC)
}

#[test]
fn the_laws_keep_their_claims() -> Result<(), Failure> {
    laws::<f64, 1>()?;
    laws::<f64, 2>()?;
    laws::<f64, 3>()
}

#[test]
fn the_laws_keep_their_claims_in_single_precision() -> Result<(), Failure> {
    laws::<f32, 1>()?;
    laws::<f32, 2>()
}

/// Numbers per particle besides the stress, as `docs/theory/laws.md` tells them.
#[test]
fn states_are_as_small_as_told() {
    fn numbers<const D: usize, L: ConstitutiveLaw<f64, D>>(_: &L) -> usize {
        size_of::<L::State>() / size_of::<f64>()
    }
    fn of<L: ConstitutiveLaw<f64, 1> + ConstitutiveLaw<f64, 2> + ConstitutiveLaw<f64, 3>>(
        law: &L,
    ) -> [usize; 3] {
        [numbers::<1, L>(law), numbers::<2, L>(law), numbers::<3, L>(law)]
    }
    let moduli = Moduli::from_young(1.0, 0.3).unwrap();
    let (metal, soil) = plastic(moduli, 0.1);
    assert_eq!(of(&StVenantKirchhoff { moduli }), [1, 4, 9]);
    assert_eq!(of(&Hencky { moduli }), [2, 5, 10]);
    assert_eq!(of(&metal), [3, 6, 11]);
    assert_eq!(of(&soil), [5, 8, 13]);
    assert_eq!(of(&NewtonianFluid::new(1.0, 7.0, 0.0).unwrap()), [1, 1, 1]);
}
