//! Phases.

use materialpoint::phase::{Drag, OnePhase, Phase, PhaseStep, PoreLiquid, TwoPhase};
use materialpoint::scalar::Scalar;
use materialpoint::testing::{Failure, PhaseSample, Property, check_phase};
use nalgebra::{SMatrix, SVector};

use super::{Planted, planted};

fn sample<T: Scalar>() -> PhaseSample<T> {
    PhaseSample {
        stress: T::lit(1e5),
        strain: T::lit(0.01),
        density: T::lit(1.6e3),
    }
}

/// Sand full of water.
fn saturated<T: Scalar>(permeability_exponent: f64, drag: Drag) -> TwoPhase<T> {
    TwoPhase {
        porosity: T::lit(0.4),
        solid_density: T::lit(2650.0),
        liquid_density: T::lit(1000.0),
        liquid_bulk_modulus: T::lit(2e9),
        permeability: T::lit(1e-4),
        permeability_exponent: T::lit(permeability_exponent),
        gravity: T::lit(10.0),
        drag,
    }
}

fn phases<T: Scalar, const D: usize>() -> Result<(), Failure> {
    check_phase::<T, D, _>(&OnePhase, &sample())?;
    for drag in [Drag::Implicit, Drag::Explicit] {
        for exponent in [0.0, 2.0, 3.5] {
            check_phase::<T, D, _>(&saturated::<T>(exponent, drag), &sample())?;
        }
    }
    Ok(())
}

#[test]
fn our_phases_pass() -> Result<(), Failure> {
    phases::<f64, 1>()?;
    phases::<f64, 2>()?;
    phases::<f64, 3>()
}

#[test]
fn our_phases_pass_in_single_precision() -> Result<(), Failure> {
    phases::<f32, 1>()?;
    phases::<f32, 2>()?;
    phases::<f32, 3>()
}

/// Slips in a phase.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Slip {
    Right,
    /// The phase works, and says that it does nothing.
    Unsaid,
    /// A pressure before any strain.
    Prestressed,
    /// Tension is cut off where there is pressure.
    TensionCut,
    /// The pressure decays a little with each call.
    Decays,
    /// The first axis stands for the trace.
    FirstAxis,
    /// The pressure acts in shear too.
    PressureInShear,
    /// The norm of the increment stands for its trace: a spin compresses.
    Norm,
    /// The porosity in percent.
    Percent,
    /// Pressure is taken positive in compression when it is set.
    SignWhenSet,
    /// Only the velocity is set.
    ForgetsPressure,
    /// The change replaces the velocity.
    Replaces,
    /// The strain stops the liquid.
    Stops,
    /// The mass of a particle of volume one, whatever the volume.
    MassOfOne,
    /// The density of what is not pore.
    NegativeMass,
    /// The drag per volume.
    DragPerVolume,
    /// The drag with the sign of the force on the solid.
    DragSign,
    /// The porosity is forgotten where the liquid moves with the solid.
    NoPorosity,
    /// The volumes of solid and liquid change places.
    SharesSwapped,
    /// Solid that comes closer does not press.
    LiquidAlone,
    /// `K` instead of `K / n`.
    Stiffness,
    /// The half is forgotten.
    Energy,
    /// The energy per volume of liquid.
    EnergyPerLiquid,
    /// The pressure is taken away from the stress.
    PressureSign,
    /// The pores' share of the pressure.
    PressureTimesPorosity,
}

/// Slips that show in a phase that flows.
const FLOWING: [(Slip, Property); 23] = [
    (Slip::Prestressed, Property::EffectiveStress),
    (Slip::TensionCut, Property::AffineStress),
    (Slip::Decays, Property::ZeroIncrement),
    (Slip::FirstAxis, Property::Objective),
    (Slip::PressureInShear, Property::Objective),
    (Slip::Norm, Property::Objective),
    (Slip::Percent, Property::Porosity),
    (Slip::SignWhenSet, Property::LiquidRoundTrip),
    (Slip::ForgetsPressure, Property::LiquidRoundTrip),
    (Slip::Replaces, Property::AcceleratesLiquid),
    (Slip::Stops, Property::StrainKeepsVelocity),
    (Slip::MassOfOne, Property::LiquidMass),
    (Slip::NegativeMass, Property::LiquidMass),
    (Slip::DragPerVolume, Property::Drag),
    (Slip::DragSign, Property::Drag),
    (Slip::NoPorosity, Property::LiquidStiffness),
    (Slip::SharesSwapped, Property::FlowShares),
    (Slip::LiquidAlone, Property::FlowShares),
    (Slip::Stiffness, Property::LiquidStiffness),
    (Slip::Energy, Property::LiquidEnergy),
    (Slip::EnergyPerLiquid, Property::LiquidEnergy),
    (Slip::PressureSign, Property::PoreStressIsWork),
    (Slip::PressureTimesPorosity, Property::PoreStressIsWork),
];

/// Slips that show in one that does not.
const STANDING: [(Slip, Property); 6] = [
    (Slip::Prestressed, Property::EffectiveStress),
    (Slip::TensionCut, Property::AffineStress),
    (Slip::Decays, Property::ZeroIncrement),
    (Slip::FirstAxis, Property::Objective),
    (Slip::PressureInShear, Property::Objective),
    (Slip::Norm, Property::Objective),
];

/// What a phase does that says `COUPLED = false`: with a pressure from strain, and with one from nothing.
const SILENT: [(Slip, Property); 2] = [
    (Slip::Unsaid, Property::CoupledAsSaid),
    (Slip::Prestressed, Property::CoupledAsSaid),
];

/// A saturated solid with what it says of itself, and a slip.
#[derive(Clone, Copy, Debug)]
struct Faulty<const COUPLED: bool, const FLOWS: bool>(Slip);

const POROSITY: f64 = 0.4;
const BULK: f64 = 2e9;

impl<const COUPLED: bool, const FLOWS: bool> Faulty<COUPLED, FLOWS> {
    /// What stands for the change of volume.
    fn volume<const D: usize>(self, increment: &SMatrix<f64, D, D>) -> f64 {
        match self.0 {
            Slip::FirstAxis => increment[(0, 0)],
            Slip::Norm => increment.norm(),
            _ => increment.trace(),
        }
    }

    fn decays<const D: usize>(self, particle: &mut PoreLiquid<f64, D>) {
        if self.0 == Slip::Decays {
            particle.pressure *= 1.0 - 1e-9;
        }
    }
}

impl<const D: usize, const COUPLED: bool, const FLOWS: bool> Phase<f64, D> for Faulty<COUPLED, FLOWS> {
    const COUPLED: bool = COUPLED;
    const FLOWS: bool = FLOWS;
    type Particle = PoreLiquid<f64, D>;

    fn total_stress(
        &self,
        effective: &SMatrix<f64, D, D>,
        particle: &PoreLiquid<f64, D>,
    ) -> SMatrix<f64, D, D> {
        let pressure = match self.0 {
            Slip::Prestressed => particle.pressure - 100.0,
            Slip::PressureSign => -particle.pressure,
            Slip::PressureTimesPorosity => POROSITY * particle.pressure,
            _ => particle.pressure,
        };
        let mut total = *effective;
        for a in 0..D {
            if self.0 == Slip::TensionCut && pressure != 0.0 {
                total[(a, a)] = total[(a, a)].min(0.0);
            }
            total[(a, a)] += pressure;
        }
        if self.0 == Slip::PressureInShear {
            total = effective.add_scalar(pressure);
        }
        total
    }

    fn update(&self, step: &PhaseStep<'_, f64, D>, particle: &mut PoreLiquid<f64, D>) {
        self.decays(particle);
        let share = match self.0 {
            Slip::SharesSwapped => 1.0 - POROSITY,
            Slip::LiquidAlone => 1.0,
            _ => POROSITY,
        };
        let volume = (1.0 - share) * self.volume(step.solid) + share * self.volume(step.liquid);
        let n = if self.0 == Slip::NoPorosity { 1.0 } else { POROSITY };
        particle.pressure += BULK / n * volume;
        if self.0 == Slip::Stops {
            particle.velocity = SVector::zeros();
        }
    }

    fn liquid(&self, particle: &PoreLiquid<f64, D>) -> PoreLiquid<f64, D> {
        *particle
    }

    fn accelerate_liquid(&self, change: SVector<f64, D>, particle: &mut PoreLiquid<f64, D>) {
        if self.0 == Slip::Replaces {
            particle.velocity = change;
        } else {
            particle.velocity += change;
        }
    }

    fn set_liquid(&self, liquid: PoreLiquid<f64, D>, particle: &mut PoreLiquid<f64, D>) {
        particle.velocity = liquid.velocity;
        match self.0 {
            Slip::ForgetsPressure => {}
            Slip::SignWhenSet => particle.pressure = -liquid.pressure,
            _ => particle.pressure = liquid.pressure,
        }
    }

    fn porosity(&self) -> f64 {
        if self.0 == Slip::Percent {
            100.0 * POROSITY
        } else {
            POROSITY
        }
    }

    fn liquid_mass(&self, volume: f64) -> f64 {
        match self.0 {
            Slip::MassOfOne => POROSITY * 1e3,
            Slip::NegativeMass => (POROSITY - 1.0) * 1e3 * volume,
            _ => POROSITY * 1e3 * volume,
        }
    }

    fn drag(&self, _solid_mass: f64, volume: f64) -> f64 {
        let unit = POROSITY * 1e4 / 1e-4;
        match self.0 {
            Slip::DragPerVolume => unit,
            Slip::DragSign => -unit * volume,
            _ => unit * volume,
        }
    }

    fn drag_treatment(&self) -> Drag {
        Drag::Implicit
    }

    fn liquid_stiffness(&self) -> f64 {
        if self.0 == Slip::Stiffness {
            BULK
        } else {
            BULK / POROSITY
        }
    }

    fn energy_density(&self, particle: &PoreLiquid<f64, D>) -> f64 {
        let energy = particle.pressure * particle.pressure * POROSITY / (2.0 * BULK);
        match self.0 {
            Slip::Energy => 2.0 * energy,
            Slip::EnergyPerLiquid => energy / POROSITY,
            _ => energy,
        }
    }
}

/// The same of the plane and of space.
fn verdict<const COUPLED: bool, const FLOWS: bool>(slip: Slip) -> Option<Property> {
    let phase = Faulty::<COUPLED, FLOWS>(slip);
    let plane = check_phase::<f64, 2, _>(&phase, &sample());
    let space = check_phase::<f64, 3, _>(&phase, &sample());
    let both = [plane, space].map(|outcome| outcome.err().map(|failure| failure.property));
    assert_eq!(both[0], both[1], "{slip:?}");
    both[0]
}

/// Slips in a phase that diffuses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Leak {
    None,
    /// The capacity per volume.
    CapacityPerVolume,
    /// A capacity that takes in nothing.
    NoCapacity,
    /// The change replaces the value.
    Replaces,
    /// Twice the change is taken in.
    Twice,
    /// Heat is lost with each call.
    Decays,
    /// The flux along the gradient.
    Sign,
    /// A flux without a gradient.
    Drifts,
    /// The flux runs up the gradient along all axes but the first.
    Skew,
    /// The conductivity where the diffusivity is asked for, which is a part of it.
    DiffusivityPerMass,
    /// Said to be as slow as at the coldest.
    Coldest,
}

const LEAKS: [(Leak, Property); 10] = [
    (Leak::CapacityPerVolume, Property::Capacity),
    (Leak::NoCapacity, Property::Capacity),
    (Leak::Replaces, Property::AddsToValue),
    (Leak::Twice, Property::AddsToValue),
    (Leak::Decays, Property::ZeroIncrement),
    (Leak::Sign, Property::FluxOpposesGradient),
    (Leak::Drifts, Property::FluxOpposesGradient),
    (Leak::Skew, Property::FluxOpposesGradient),
    (Leak::DiffusivityPerMass, Property::Diffusivity),
    (Leak::Coldest, Property::Diffusivity),
];

/// Heat whose conductivity grows with the temperature, and a slip.
#[derive(Clone, Copy, Debug)]
struct Leaking(Leak);

const SPECIFIC_HEAT: f64 = 500.0;

impl Leaking {
    fn conductivity(temperature: f64) -> f64 {
        40.0 * (1.0 + 0.1 * temperature)
    }
}

impl<const D: usize> Phase<f64, D> for Leaking {
    const COUPLED: bool = true;
    const DIFFUSES: bool = true;
    type Particle = f64;

    fn total_stress(&self, effective: &SMatrix<f64, D, D>, temperature: &f64) -> SMatrix<f64, D, D> {
        effective - SMatrix::identity() * (1e4 * temperature)
    }

    fn update(&self, step: &PhaseStep<'_, f64, D>, temperature: &mut f64) {
        *temperature -= 3.0 * step.solid.trace();
        if self.0 == Leak::Decays {
            *temperature *= 1.0 - 1e-9;
        }
    }

    fn capacity(&self, mass: f64, volume: f64, _temperature: &f64) -> f64 {
        match self.0 {
            Leak::CapacityPerVolume => SPECIFIC_HEAT * mass / volume,
            Leak::NoCapacity => 0.0,
            _ => SPECIFIC_HEAT * mass,
        }
    }

    fn value(&self, temperature: &f64) -> f64 {
        *temperature
    }

    fn add_to_value(&self, change: f64, temperature: &mut f64) {
        match self.0 {
            Leak::Replaces => *temperature = change,
            Leak::Twice => *temperature += 2.0 * change,
            _ => *temperature += change,
        }
    }

    fn flux(&self, gradient: &SVector<f64, D>, temperature: &f64) -> SVector<f64, D> {
        let flux = -gradient * Self::conductivity(*temperature);
        match self.0 {
            Leak::Sign => -flux,
            Leak::Drifts => flux.add_scalar(1e-3),
            Leak::Skew => SVector::from_fn(|a, _| if a == 0 { flux[0] } else { -0.1 * flux[a] }),
            _ => flux,
        }
    }

    fn diffusivity(&self, mass: f64, volume: f64, temperature: &f64) -> f64 {
        match self.0 {
            Leak::DiffusivityPerMass => Self::conductivity(*temperature) / (SPECIFIC_HEAT * mass * mass),
            Leak::Coldest => Self::conductivity(-1.1) * volume / (SPECIFIC_HEAT * mass),
            _ => Self::conductivity(*temperature) * volume / (SPECIFIC_HEAT * mass),
        }
    }
}

/// The same of the plane and of space.
fn leak(slip: Leak) -> Option<Property> {
    let plane = check_phase::<f64, 2, _>(&Leaking(slip), &sample());
    let space = check_phase::<f64, 3, _>(&Leaking(slip), &sample());
    let both = [plane, space].map(|outcome| outcome.err().map(|failure| failure.property));
    assert_eq!(both[0], both[1], "{slip:?}");
    both[0]
}

#[test]
fn a_phase_that_diffuses_without_a_slip_passes() {
    assert_eq!(leak(Leak::None), None);
}

/// All mistakes of this file.
pub(super) fn mistakes() -> Vec<Planted> {
    let mut all = planted("silent phase", SILENT, verdict::<false, false>);
    all.extend(planted("flowing phase", FLOWING, verdict::<true, true>));
    all.extend(planted("diffusing phase", LEAKS, leak));
    all
}

#[test]
fn a_phase_without_a_slip_passes() {
    assert_eq!(verdict::<true, true>(Slip::Right), None);
    assert_eq!(verdict::<true, false>(Slip::Right), None);
}

/// The same slips as in one that flows: they count once.
#[test]
fn slips_in_a_phase_that_does_not_flow_are_found_too() {
    for (slip, expected) in STANDING {
        assert_eq!(verdict::<true, false>(slip), Some(expected), "{slip:?}");
    }
}
