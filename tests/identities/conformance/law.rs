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
    stable: true,
};

/// Hill's rate has a potential in 1-D only.
fn hill<const D: usize>() -> LawClaims {
    LawClaims {
        energy_is_work: D == 1,
        wave_speed_is_sharp: true,
        objective: true,
        stable: true,
    }
}

/// The neo-Hookean solid keeps everything, and so does the logarithmic law in its one dimension.
fn hyperelastic() -> LawClaims {
    LawClaims {
        energy_is_work: true,
        wave_speed_is_sharp: true,
        objective: true,
        stable: true,
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

/// What a plastic law can get wrong where its energy is not its work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Fault {
    None,
    /// The energy is twice too large.
    Energy,
    /// The stress off the plane is forgotten: the stiffness is that of plane stress, the constants are told
    /// all the same.
    OffPlane,
    /// Strength falls with plastic strain.
    Softening,
    /// Held material is stressed more and more.
    Grows,
    /// `update_over` is another law.
    Stiffer,
    /// A start forgets half of the stress.
    Start,
    /// The strain for a change leads away from it.
    Away,
    /// The law does not know its own stress.
    Unknown,
}

/// Von Mises plasticity at small strain, in the axes of the grid alone.
#[derive(Clone, Copy, Debug)]
struct Metal(Fault);

impl Metal {
    const YIELD: f64 = 400.0;

    fn hardening(self) -> f64 {
        if self.0 == Fault::Softening { -1e3 } else { 1e3 }
    }

    /// Shear modulus and Lame's other constant.
    fn elastic(self) -> (f64, f64) {
        let Moduli { lambda, mu } = moduli::<f64>();
        match self.0 {
            Fault::OffPlane => (mu, 2.0 * mu * lambda / (lambda + 2.0 * mu)),
            _ => (mu, lambda),
        }
    }
}

/// Elastic strain and accumulated plastic shear.
#[derive(Clone, Copy, Debug)]
struct Strains<const D: usize>(SMatrix<f64, D, D>, f64);

impl<const D: usize> Default for Strains<D> {
    fn default() -> Self {
        Self(SMatrix::zeros(), 0.0)
    }
}

impl<const D: usize> ConstitutiveLaw<f64, D> for Metal {
    type State = Strains<D>;

    fn large_strain(&self) -> bool {
        false
    }

    fn knows(&self, stress: &SMatrix<f64, D, D>, _state: &Strains<D>) -> bool {
        self.0 != Fault::Unknown || stress.norm() == 0.0
    }

    fn update(
        &self,
        increment: &SMatrix<f64, D, D>,
        stress: &mut SMatrix<f64, D, D>,
        state: &mut Strains<D>,
    ) {
        let (mu, lambda) = self.elastic();
        let Strains(elastic, plastic) = state;
        *elastic += (increment + increment.transpose()) / 2.0;
        let mean = SMatrix::identity() * (elastic.trace() / D as f64);
        let deviator = *elastic - mean;
        let trial = 2.0 * mu * deviator.norm();
        let excess = trial - (Self::YIELD + self.hardening() * *plastic);
        if excess > 0.0 {
            let flow = excess / (2.0 * mu + self.hardening());
            *plastic += flow;
            *elastic = mean + deviator * (1.0 - 2.0 * mu * flow / trial);
        }
        *stress = SMatrix::identity() * (lambda * elastic.trace()) + *elastic * (2.0 * mu);
    }

    fn update_over(
        &self,
        dt: f64,
        increment: &SMatrix<f64, D, D>,
        stress: &mut SMatrix<f64, D, D>,
        state: &mut Strains<D>,
    ) {
        match self.0 {
            Fault::Grows => state.0 *= 1.0 + 0.1 * dt / (1.0 + dt),
            Fault::Stiffer => return self.update(&(increment * 1.5), stress, state),
            _ => {}
        }
        self.update(increment, stress, state);
    }

    fn start(&self, stress: &SMatrix<f64, D, D>, _off_plane: Option<f64>) -> Option<Strains<D>> {
        let (mu, lambda) = self.elastic();
        let trace = stress.trace() / (2.0 * mu + lambda * D as f64);
        let elastic = (stress - SMatrix::identity() * (lambda * trace)) / (2.0 * mu);
        let kept = if self.0 == Fault::Start { 0.5 } else { 1.0 };
        Some(Strains(elastic * kept, 0.0))
    }

    fn strain_for(
        &self,
        change: &SMatrix<f64, D, D>,
        _density: f64,
        _stress: &SMatrix<f64, D, D>,
        _state: &Strains<D>,
    ) -> Option<SMatrix<f64, D, D>> {
        let way = if self.0 == Fault::Away { -1.0 } else { 1.0 };
        Some(change * (way / moduli::<f64>().p_wave()))
    }

    fn elastic_constants(&self) -> Option<Moduli<f64>> {
        Some(moduli())
    }

    fn wave_speed(&self, density: f64, _stress: &SMatrix<f64, D, D>, _state: &Strains<D>) -> f64 {
        let (mu, lambda) = self.elastic();
        ((lambda + 2.0 * mu) / density).sqrt()
    }

    fn energy_density(&self, _stress: &SMatrix<f64, D, D>, Strains(elastic, _): &Strains<D>) -> f64 {
        let (mu, lambda) = self.elastic();
        let factor = if self.0 == Fault::Energy { 2.0 } else { 1.0 };
        factor * (lambda * elastic.trace().powi(2) / 2.0 + mu * elastic.norm_squared())
    }
}

fn found(fault: Fault) -> Option<Property> {
    let claims = LawClaims {
        energy_is_work: false,
        wave_speed_is_sharp: false,
        objective: false,
        stable: true,
    };
    let in_plane = check_law::<f64, 2, _>(&Metal(fault), &sample(), &claims);
    let in_space = check_law::<f64, 3, _>(&Metal(fault), &sample(), &claims);
    // Without a plane there is nothing off it, but the constants are wrong there too.
    let both = [in_plane, in_space].map(|outcome| outcome.err().map(|failure| failure.property));
    assert_eq!(both[0], both[1], "{fault:?}");
    both[0]
}

#[test]
fn faults_of_a_law_whose_energy_is_not_its_work_are_found_and_named() {
    assert_eq!(found(Fault::None), None);
    assert_eq!(found(Fault::Energy), Some(Property::EnergyAtSmallStrain));
    assert_eq!(found(Fault::OffPlane), Some(Property::ElasticConstants));
    assert_eq!(found(Fault::Softening), Some(Property::Stable));
    assert_eq!(found(Fault::Grows), Some(Property::NoEnergyFromNothing));
    assert_eq!(found(Fault::Stiffer), Some(Property::UpdateIsALimit));
    assert_eq!(found(Fault::Start), Some(Property::StartKeepsStress));
    assert_eq!(found(Fault::Away), Some(Property::StrainForChange));
    assert_eq!(found(Fault::Unknown), Some(Property::KnowsItsStress));
}
