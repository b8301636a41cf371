//! Constitutive laws.

use materialpoint::law::{ConstitutiveLaw, Hill, LinearElastic, Logarithmic, Moduli, NeoHookean};
use materialpoint::scalar::Scalar;
use materialpoint::testing::{Failure, LawClaims, LawSample, Property, check_law};
use nalgebra::SMatrix;

fn moduli<T: Scalar>() -> Moduli<T> {
    Moduli::from_young(T::lit(4e4), T::lit(0.3)).unwrap()
}

fn sample<T: Scalar>() -> LawSample<T> {
    LawSample {
        density: T::lit(2e3),
        strain: T::lit(0.05),
    }
}

const SMALL_STRAIN: LawClaims = LawClaims {
    energy_is_work: true,
    wave_speed_is_sharp: true,
    objective: false,
};

/// Hill's rate has a potential in 1-D only.
fn hill<const D: usize>() -> LawClaims {
    LawClaims {
        energy_is_work: D == 1,
        wave_speed_is_sharp: true,
        objective: true,
    }
}

/// The neo-Hookean solid keeps everything, and so does the logarithmic law in its one dimension.
fn hyperelastic() -> LawClaims {
    LawClaims {
        energy_is_work: true,
        wave_speed_is_sharp: true,
        objective: true,
    }
}

fn laws<const D: usize>() -> Result<(), Failure> {
    let moduli = moduli::<f64>();
    check_law::<f64, D, _>(&LinearElastic { moduli }, &sample(), &SMALL_STRAIN)?;
    check_law::<f64, D, _>(&Hill { moduli }, &sample(), &hill::<D>())?;
    check_law::<f64, D, _>(&NeoHookean { moduli }, &sample(), &hyperelastic())
}

#[test]
fn our_laws_keep_their_claims() -> Result<(), Failure> {
    laws::<1>()?;
    laws::<2>()?;
    laws::<3>()?;
    let moduli = moduli::<f64>();
    check_law::<f64, 1, _>(&Logarithmic { moduli }, &sample(), &hyperelastic())
}

#[test]
fn our_laws_keep_their_claims_in_single_precision() -> Result<(), Failure> {
    let moduli = moduli::<f32>();
    check_law::<f32, 1, _>(&LinearElastic { moduli }, &sample(), &SMALL_STRAIN)?;
    check_law::<f32, 1, _>(&Hill { moduli }, &sample(), &hill::<1>())?;
    check_law::<f32, 1, _>(&NeoHookean { moduli }, &sample(), &hyperelastic())?;
    check_law::<f32, 1, _>(&Logarithmic { moduli }, &sample(), &hyperelastic())
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Mistake {
    None,
    /// Young's modulus instead of that of uniaxial strain.
    Slow,
    /// Twice the speed: safe, but not sharp.
    Fast,
    /// The half is forgotten.
    Energy,
    /// A stress before any strain.
    Prestressed,
    /// Stress decays a little with each call.
    Leaks,
    /// Stress jumps with the sign of the strain.
    Jump,
    /// The increment is not made symmetric.
    SpinIsStrain,
}

/// Linear elasticity with one mistake.
#[derive(Clone, Copy, Debug)]
struct Faulty(Mistake);

impl<const D: usize> ConstitutiveLaw<f64, D> for Faulty {
    type State = ();

    fn large_strain(&self) -> bool {
        false
    }

    fn update(&self, increment: &SMatrix<f64, D, D>, stress: &mut SMatrix<f64, D, D>, _state: &mut ()) {
        let elastic = LinearElastic { moduli: moduli() };
        elastic.update(increment, stress, &mut ());
        match self.0 {
            Mistake::Prestressed if increment.norm() == 0.0 => stress[(0, 0)] += 1e-6,
            Mistake::Leaks => *stress *= 1.0 - 1e-9,
            Mistake::Jump if increment.norm() > 0.0 => stress[(0, 0)] += 1e-3,
            Mistake::SpinIsStrain => *stress += (increment - increment.transpose()) * 1e4,
            _ => {}
        }
    }

    fn wave_speed(&self, density: f64, _stress: &SMatrix<f64, D, D>, _state: &()) -> f64 {
        match self.0 {
            Mistake::Slow => (4e4 / density).sqrt(),
            Mistake::Fast => 2.0 * (moduli::<f64>().p_wave() / density).sqrt(),
            _ => (moduli::<f64>().p_wave() / density).sqrt(),
        }
    }

    fn energy_density(&self, stress: &SMatrix<f64, D, D>, _state: &()) -> f64 {
        let elastic = LinearElastic { moduli: moduli() };
        let factor = if self.0 == Mistake::Energy { 2.0 } else { 1.0 };
        factor * elastic.energy_density(stress, &())
    }
}

fn verdict(mistake: Mistake) -> Option<Property> {
    // A shear is half a rotation: the energy's claim must be withdrawn for the rotation alone to show.
    let claims = LawClaims {
        energy_is_work: mistake != Mistake::SpinIsStrain,
        ..SMALL_STRAIN
    };
    let outcome = check_law::<f64, 2, _>(&Faulty(mistake), &sample(), &claims);
    outcome.err().map(|failure| failure.property)
}

#[test]
fn mistakes_are_found_and_named() {
    assert_eq!(verdict(Mistake::None), None);
    assert_eq!(verdict(Mistake::Slow), Some(Property::WaveSpeed));
    assert_eq!(verdict(Mistake::Fast), Some(Property::WaveSpeed));
    assert_eq!(verdict(Mistake::Energy), Some(Property::EnergyIsWork));
    assert_eq!(verdict(Mistake::Prestressed), Some(Property::Unstressed));
    assert_eq!(verdict(Mistake::Leaks), Some(Property::ZeroIncrement));
    assert_eq!(verdict(Mistake::Jump), Some(Property::LinearForSmallIncrements));
    assert_eq!(
        verdict(Mistake::SpinIsStrain),
        Some(Property::RotationKeepsEnergy)
    );
}

#[test]
fn claims_that_are_too_bold_or_too_shy_are_found() {
    let law = Hill { moduli: moduli() };
    let verdict = |claims| {
        check_law::<f64, 2, _>(&law, &sample(), &claims)
            .err()
            .map(|f| f.property)
    };
    let honest = hill::<2>();
    assert_eq!(verdict(honest), None);
    let energy_is_work = !honest.energy_is_work;
    assert_eq!(
        verdict(LawClaims {
            energy_is_work,
            ..honest
        }),
        Some(Property::EnergyIsWork)
    );
    let objective = !honest.objective;
    assert_eq!(
        verdict(LawClaims { objective, ..honest }),
        Some(Property::Objective)
    );
    let wave_speed_is_sharp = !honest.wave_speed_is_sharp;
    assert_eq!(
        verdict(LawClaims {
            wave_speed_is_sharp,
            ..honest
        }),
        Some(Property::WaveSpeed)
    );
    let elastic = |claims| {
        let law = LinearElastic { moduli: moduli() };
        check_law::<f64, 3, _>(&law, &sample(), &claims)
            .unwrap_err()
            .property
    };
    let (bold, shy) = (true, false);
    assert_eq!(
        elastic(LawClaims {
            objective: bold,
            ..SMALL_STRAIN
        }),
        Property::Objective
    );
    assert_eq!(
        elastic(LawClaims {
            wave_speed_is_sharp: shy,
            ..SMALL_STRAIN
        }),
        Property::WaveSpeed
    );
    assert_eq!(
        elastic(LawClaims {
            energy_is_work: shy,
            ..SMALL_STRAIN
        }),
        Property::EnergyIsWork
    );
}
