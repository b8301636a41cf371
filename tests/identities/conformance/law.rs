//! Constitutive laws.

use materialpoint::law::{ConstitutiveLaw, Hill, LinearElastic, Logarithmic, Moduli, NeoHookean};
use materialpoint::scalar::Scalar;
use materialpoint::testing::{Failure, LawClaims, LawSample, Property, check_law};
use nalgebra::SMatrix;

use super::{Planted, planted};

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
    /// One of the two shears of the increment is taken for both.
    UpperShear,
    /// The shear of engineers, twice that of the tensor, is taken for it.
    EngineeringShear,
    /// Shear stress leads the other way.
    ShearSign,
    /// The energy counts one of the two shear stresses.
    OneShearInEnergy,
    /// Waves at the speed of plane stress, with `1 - nu^2`.
    PlaneStressWave,
    /// Poisson's ratio enters the wave's speed with the wrong sign.
    PoissonSign,
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
            Mistake::UpperShear => {
                let wrong = moduli::<f64>().mu * (increment[(0, 1)] - increment[(1, 0)]);
                stress[(0, 1)] += wrong;
                stress[(1, 0)] += wrong;
            }
            Mistake::EngineeringShear | Mistake::ShearSign => {
                let right = moduli::<f64>().mu * (increment[(0, 1)] + increment[(1, 0)]);
                let more = if self.0 == Mistake::ShearSign { -2.0 } else { 1.0 };
                stress[(0, 1)] += more * right;
                stress[(1, 0)] += more * right;
            }
            _ => {}
        }
    }

    fn wave_speed(&self, density: f64, _stress: &SMatrix<f64, D, D>, _state: &()) -> f64 {
        match self.0 {
            Mistake::Slow => (4e4 / density).sqrt(),
            Mistake::Fast => 2.0 * (moduli::<f64>().p_wave() / density).sqrt(),
            Mistake::PlaneStressWave => (4e4 / (1.0 - 0.3 * 0.3) / density).sqrt(),
            Mistake::PoissonSign => (4e4 * 1.3 / (0.7 * 1.6) / density).sqrt(),
            _ => (moduli::<f64>().p_wave() / density).sqrt(),
        }
    }

    fn energy_density(&self, stress: &SMatrix<f64, D, D>, _state: &()) -> f64 {
        let elastic = LinearElastic { moduli: moduli() };
        let energy = elastic.energy_density(stress, &());
        match self.0 {
            Mistake::Energy => 2.0 * energy,
            Mistake::OneShearInEnergy => energy - stress[(0, 1)].powi(2) / (4.0 * moduli::<f64>().mu),
            _ => energy,
        }
    }
}

fn verdict(mistake: Mistake) -> Option<Property> {
    // A shear is half a rotation: the energy's claim must be withdrawn for the rotation alone to show.
    let claims = LawClaims {
        energy_is_work: mistake != Mistake::UpperShear,
        ..SMALL_STRAIN
    };
    let outcome = check_law::<f64, 2, _>(&Faulty(mistake), &sample(), &claims);
    outcome.err().map(|failure| failure.property)
}

const MISTAKES: [(Mistake, Property); 13] = [
    (Mistake::Slow, Property::WaveSpeed),
    (Mistake::Fast, Property::WaveSpeed),
    (Mistake::Energy, Property::EnergyIsWork),
    (Mistake::Prestressed, Property::Unstressed),
    (Mistake::Leaks, Property::ZeroIncrement),
    (Mistake::Jump, Property::LinearForSmallIncrements),
    (Mistake::SpinIsStrain, Property::SymmetricStress),
    (Mistake::UpperShear, Property::RotationKeepsEnergy),
    (Mistake::EngineeringShear, Property::EnergyIsWork),
    (Mistake::ShearSign, Property::EnergyIsWork),
    (Mistake::OneShearInEnergy, Property::EnergyIsWork),
    (Mistake::PlaneStressWave, Property::WaveSpeed),
    (Mistake::PoissonSign, Property::WaveSpeed),
];

/// All mistakes of this file.
pub(super) fn mistakes() -> Vec<Planted> {
    let mut all = planted("elastic", MISTAKES, verdict);
    all.extend(planted("plastic", FAULTS, found));
    all.extend(planted("rate", TURNS, turned));
    all.extend(planted("stored", STORES, stored));
    all
}

#[test]
fn laws_without_their_mistakes_pass() {
    assert_eq!(verdict(Mistake::None), None);
    assert_eq!(found(Fault::None), None);
    assert_eq!(turned(Turn::Right), None);
    assert_eq!(stored(Store::Right), None);
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

const FAULTS: [(Fault, Property); 8] = [
    (Fault::Energy, Property::EnergyAtSmallStrain),
    (Fault::OffPlane, Property::ElasticConstants),
    (Fault::Softening, Property::Stable),
    (Fault::Grows, Property::NoEnergyFromNothing),
    (Fault::Stiffer, Property::UpdateIsALimit),
    (Fault::Start, Property::StartKeepsStress),
    (Fault::Away, Property::StrainForChange),
    (Fault::Unknown, Property::KnowsItsStress),
];

/// What a rate at large strain can get wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Turn {
    Right,
    /// Nothing turns the stress.
    NoSpin,
    /// It turns the other way.
    WrongWay,
    /// The half is forgotten in the spin.
    WholeSpin,
    /// One side of the stress is turned.
    OneSide,
    /// The change of volume is forgotten, and the wave's speed knows of it.
    NoVolume,
}

const TURNS: [(Turn, Property); 5] = [
    (Turn::NoSpin, Property::Objective),
    (Turn::WrongWay, Property::Objective),
    (Turn::WholeSpin, Property::Objective),
    (Turn::OneSide, Property::SymmetricStress),
    (Turn::NoVolume, Property::WaveSpeed),
];

/// Hill's rate in the plane.
#[derive(Clone, Copy, Debug)]
struct Turning(Turn);

impl ConstitutiveLaw<f64, 2> for Turning {
    type State = ();

    fn large_strain(&self) -> bool {
        true
    }

    fn update(&self, increment: &SMatrix<f64, 2, 2>, stress: &mut SMatrix<f64, 2, 2>, _state: &mut ()) {
        let strain = (increment + increment.transpose()) / 2.0;
        let spin = increment - strain;
        let old = *stress;
        let turn = match self.0 {
            Turn::NoSpin => SMatrix::zeros(),
            Turn::WrongWay => old * spin - spin * old,
            Turn::WholeSpin => (spin * old - old * spin) * 2.0,
            Turn::OneSide => spin * old,
            Turn::Right | Turn::NoVolume => spin * old - old * spin,
        };
        LinearElastic { moduli: moduli() }.update(increment, stress, &mut ());
        *stress += turn;
        if self.0 != Turn::NoVolume {
            *stress -= old * strain.trace();
        }
    }

    fn wave_speed(&self, density: f64, stress: &SMatrix<f64, 2, 2>, _state: &()) -> f64 {
        Hill { moduli: moduli() }.wave_speed(density, stress, &())
    }

    fn energy_density(&self, stress: &SMatrix<f64, 2, 2>, _state: &()) -> f64 {
        Hill { moduli: moduli() }.energy_density(stress, &())
    }
}

fn turned(turn: Turn) -> Option<Property> {
    check_law::<f64, 2, _>(&Turning(turn), &sample(), &hill::<2>())
        .err()
        .map(|failure| failure.property)
}

/// What a law that keeps its energy beside its stress can get wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Store {
    Right,
    /// The energy is that of the last increment, whatever came before.
    LastIncrement,
    /// The work of the stress that the increment began with.
    OldStress,
    /// Work that is taken away.
    Sign,
    /// A strain that is large where only the small one is meant: energy per volume and volume go apart.
    LargeStrain,
}

const STORES: [(Store, Property); 4] = [
    (Store::LastIncrement, Property::ZeroIncrement),
    (Store::OldStress, Property::EnergyIsWork),
    (Store::Sign, Property::EnergyIsWork),
    (Store::LargeStrain, Property::EnergyIsWork),
];

/// Hooke's law at small strain whose state is the energy.
#[derive(Clone, Copy, Debug)]
struct Storing(Store);

impl ConstitutiveLaw<f64, 2> for Storing {
    type State = f64;

    fn large_strain(&self) -> bool {
        self.0 == Store::LargeStrain
    }

    fn update(&self, increment: &SMatrix<f64, 2, 2>, stress: &mut SMatrix<f64, 2, 2>, energy: &mut f64) {
        let strain = (increment + increment.transpose()) / 2.0;
        let old = *stress;
        LinearElastic { moduli: moduli() }.update(increment, stress, &mut ());
        let work = (old + *stress).dot(&strain) / 2.0;
        match self.0 {
            Store::LastIncrement => *energy = work,
            Store::OldStress => *energy += old.dot(&strain),
            Store::Sign => *energy -= work,
            Store::Right | Store::LargeStrain => *energy += work,
        }
    }

    fn wave_speed(&self, density: f64, _stress: &SMatrix<f64, 2, 2>, _energy: &f64) -> f64 {
        (moduli::<f64>().p_wave() / density).sqrt()
    }

    fn energy_density(&self, _stress: &SMatrix<f64, 2, 2>, energy: &f64) -> f64 {
        *energy
    }
}

fn stored(store: Store) -> Option<Property> {
    check_law::<f64, 2, _>(&Storing(store), &sample(), &SMALL_STRAIN)
        .err()
        .map(|failure| failure.property)
}
