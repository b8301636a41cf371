//! Check of a phase.

use nalgebra::{SMatrix, SVector};

use super::failure::{Failure, Place, Property, at_least, near};
use crate::phase::{Phase, PhaseStep, PoreLiquid};
use crate::scalar::Scalar;

/// Where a phase is looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhaseSample<T> {
    /// Effective stress of usual size (Pa).
    pub stress: T,
    /// Largest strain to try; about 0.01.
    pub strain: T,
    /// Density of the undeformed dry solid (kg/m3).
    pub density: T,
}

/// Increments of a path.
const STEPS: usize = 16;

/// Angle of the rotation.
const ANGLE: f64 = 0.5;

/// Checks that the parts of `phase` agree with each other.
///
/// Of each phase: one that says `COUPLED = false` does nothing; without data the total stress is the
/// effective one, and with data it is affine in that; an increment of zero changes nothing; a rotated
/// increment on rotated stress gives the rotated stress, and a spin none (phases are isotropic).
///
/// Of one that `FLOWS` also: a porosity between 0 and 1; `liquid` gives what `set_liquid` took;
/// `accelerate_liquid` adds to the velocity alone, which strain leaves as it is; mass and drag of the liquid
/// are proportional to the volume and not negative; `update` takes the volumes of both by the porosity;
/// `liquid_stiffness` is pressure over change of volume; the energy of the liquid is the work of its
/// pressure, and what the liquid adds to the stress does the same work.
///
/// Of one that `DIFFUSES` also, with values from one below that of no data to one above: a capacity that is
/// positive and proportional to mass and volume; `add_to_value` adds to the value, what was taken in over the
/// capacity; an increment of zero leaves the value; no flux without a gradient, and none towards higher
/// values, so that entropy does not fall; flux over gradient within `diffusivity`, which the stable step
/// trusts.
///
/// A phase that says `COUPLED = true` and does nothing passes: it is slow only.
///
/// # Errors
/// The first property that does not hold.
pub fn check_phase<T: Scalar, const D: usize, P: Phase<T, D>>(
    phase: &P,
    sample: &PhaseSample<T>,
) -> Result<(), Failure> {
    if !P::COUPLED {
        return does_nothing(phase, sample);
    }
    without_data(phase, sample)?;
    affine(phase, sample)?;
    zero_increment(phase, sample)?;
    if D > 1 {
        rotation(phase, sample)?;
    }
    if P::FLOWS {
        porosity(phase)?;
        round_trip(phase, sample)?;
        acceleration(phase, sample)?;
        in_proportion(phase, sample)?;
        flow(phase, sample)?;
        work(phase, sample)?;
    }
    if P::DIFFUSES {
        let particles = warmed(phase, sample);
        capacity(phase, sample, &particles)?;
        adds_to_value(phase, &particles)?;
        flux(phase, sample, &particles)?;
    }
    Ok(())
}

/// A stress without symmetry of its axes, of norm one or so; `seed` makes others.
fn uneven<T: Scalar, const D: usize>(seed: usize) -> SMatrix<T, D, D> {
    SMatrix::from_fn(|i, j| {
        // Symmetric in `i` and `j`, of either sign.
        let number = 3 * (i + j) + 5 * i * j + 2 * seed + 2;
        T::lit((number % 7) as f64 - 3.0) / T::lit(3.0)
    })
}

/// Displacement gradients of size one or so: along each axis, all of a shear, all mixed.
fn increments<T: Scalar, const D: usize>() -> Vec<SMatrix<T, D, D>> {
    let single = (0..D * D).map(|k| {
        let mut gradient = SMatrix::zeros();
        gradient[k] = T::one();
        gradient
    });
    let mixed = SMatrix::from_fn(|i, j| T::lit(((3 * i + 5 * j + 2) % 7) as f64 - 2.0) / T::lit(4.0));
    single.chain([mixed]).collect()
}

/// Some operations on numbers of size one.
fn round_off<T: Scalar>() -> T {
    T::lit(64.0) * T::default_epsilon()
}

/// Data after `total` in equal increments.
fn strained<T: Scalar, const D: usize, P: Phase<T, D>>(
    phase: &P,
    total: &SMatrix<T, D, D>,
    steps: usize,
) -> P::Particle {
    let mut particle = P::Particle::default();
    let increment = total / T::count(steps);
    for _ in 0..steps {
        phase.update(&PhaseStep::strain(&increment, &SMatrix::zeros()), &mut particle);
    }
    particle
}

/// The largest stress that the phase adds within the sample's strain, and that of the solid: what round-off
/// is measured by.
fn size<T: Scalar, const D: usize, P: Phase<T, D>>(phase: &P, sample: &PhaseSample<T>) -> T {
    increments::<T, D>()
        .into_iter()
        .map(|direction| {
            let particle = strained(phase, &(direction * sample.strain), STEPS);
            phase.total_stress(&SMatrix::zeros(), &particle).norm()
        })
        .fold(sample.stress.abs(), T::max)
}

fn same_stress<T: Scalar, const D: usize>(
    property: Property,
    expected: &SMatrix<T, D, D>,
    found: &SMatrix<T, D, D>,
    allowed: T,
) -> Result<(), Failure> {
    for i in 0..D {
        for j in 0..D {
            let place = || Place::Component(i, j);
            near(property, place, expected[(i, j)], found[(i, j)], allowed)?;
        }
    }
    Ok(())
}

/// What no stepper asks for must not be there.
fn does_nothing<T: Scalar, const D: usize, P: Phase<T, D>>(
    phase: &P,
    sample: &PhaseSample<T>,
) -> Result<(), Failure> {
    let effective = uneven::<T, D>(0) * sample.stress;
    let rest = SMatrix::zeros();
    for direction in [rest].into_iter().chain(increments()) {
        let particle = strained(phase, &(direction * sample.strain), STEPS);
        let total = phase.total_stress(&effective, &particle);
        same_stress(Property::CoupledAsSaid, &effective, &total, T::zero())?;
    }
    Ok(())
}

fn without_data<T: Scalar, const D: usize, P: Phase<T, D>>(
    phase: &P,
    sample: &PhaseSample<T>,
) -> Result<(), Failure> {
    let (fresh, allowed) = (P::Particle::default(), sample.stress.abs() * round_off());
    let stresses = [SMatrix::zeros(), uneven(0), -uneven::<T, D>(1)];
    stresses.into_iter().try_for_each(|unit| {
        let effective = unit * sample.stress;
        let total = phase.total_stress(&effective, &fresh);
        same_stress(Property::EffectiveStress, &effective, &total, allowed)
    })
}

/// `total(a + b) + total(0) = total(a) + total(b)`, also where `b` has the other signs.
fn affine<T: Scalar, const D: usize, P: Phase<T, D>>(
    phase: &P,
    sample: &PhaseSample<T>,
) -> Result<(), Failure> {
    let allowed = size(phase, sample) * round_off();
    let a = uneven::<T, D>(0) * sample.stress;
    let others = [uneven::<T, D>(3) * sample.stress, -a / T::lit(2.0)];
    for direction in increments() {
        for strain in [sample.strain, -sample.strain] {
            let particle = strained(phase, &(direction * strain), STEPS);
            let total = |effective| phase.total_stress(&effective, &particle);
            for b in others {
                let (whole, none) = (total(a + b), total(SMatrix::zeros()));
                let parts = total(a) + total(b);
                same_stress(Property::AffineStress, &parts, &(whole + none), allowed)?;
            }
        }
    }
    Ok(())
}

fn zero_increment<T: Scalar, const D: usize, P: Phase<T, D>>(
    phase: &P,
    sample: &PhaseSample<T>,
) -> Result<(), Failure> {
    let (property, zero) = (Property::ZeroIncrement, SMatrix::zeros());
    let allowed = size(phase, sample) * round_off();
    for direction in increments() {
        let before = strained(phase, &(direction * sample.strain), STEPS);
        let stress = phase.total_stress(&zero, &before);
        let mut after = before;
        phase.update(&PhaseStep::strain(&zero, &zero), &mut after);
        same_stress(property, &stress, &phase.total_stress(&zero, &after), allowed)?;
        if P::FLOWS {
            let (old, new) = (phase.liquid(&before), phase.liquid(&after));
            near(
                property,
                || Place::Everywhere,
                old.pressure,
                new.pressure,
                allowed,
            )?;
        }
        if P::DIFFUSES {
            let (old, new) = (phase.value(&before), phase.value(&after));
            near(property, || Place::Everywhere, old, new, old.abs() * round_off())?;
        }
    }
    Ok(())
}

/// In the plane of the first two axes.
fn rotation<T: Scalar, const D: usize, P: Phase<T, D>>(
    phase: &P,
    sample: &PhaseSample<T>,
) -> Result<(), Failure> {
    let angle = T::lit(ANGLE);
    let mut turn = SMatrix::<T, D, D>::identity();
    turn[(0, 0)] = angle.cos();
    turn[(1, 1)] = angle.cos();
    turn[(1, 0)] = angle.sin();
    turn[(0, 1)] = -angle.sin();
    let turned = |tensor: &SMatrix<T, D, D>| turn * tensor * turn.transpose();
    let effective = uneven::<T, D>(0) * sample.stress;
    let allowed = size(phase, sample) * round_off();
    for direction in increments() {
        let strain = direction * sample.strain;
        let here = phase.total_stress(&effective, &strained(phase, &strain, STEPS));
        let there = strained(phase, &turned(&strain), STEPS);
        let there = phase.total_stress(&turned(&effective), &there);
        same_stress(Property::Objective, &turned(&here), &there, allowed)?;
    }
    // An increment of spin stretches by half its square where gradients are multiplied.
    let mut spin = SMatrix::<T, D, D>::zeros();
    spin[(1, 0)] = sample.strain;
    spin[(0, 1)] = -sample.strain;
    let total = phase.total_stress(&effective, &strained(phase, &spin, STEPS));
    let stretch = sample.strain / T::count(STEPS);
    let allowed = allowed + size(phase, sample) * (stretch + stretch);
    same_stress(Property::Objective, &effective, &total, allowed)
}

fn porosity<T: Scalar, const D: usize, P: Phase<T, D>>(phase: &P) -> Result<(), Failure> {
    let (n, tiny, everywhere) = (phase.porosity(), T::default_epsilon(), || Place::Everywhere);
    at_least(Property::Porosity, everywhere, tiny, n)?;
    at_least(Property::Porosity, everywhere, tiny, T::one() - n)
}

/// A liquid that moves and is compressed.
fn some_liquid<T: Scalar, const D: usize, P: Phase<T, D>>(
    phase: &P,
    sample: &PhaseSample<T>,
) -> PoreLiquid<T, D> {
    PoreLiquid {
        velocity: SVector::from_fn(|a, _| T::count(a + 1) / T::lit(3.0)),
        pressure: -phase.liquid_stiffness() * sample.strain,
    }
}

/// Velocities of size one to round-off, the pressure to its own.
fn same_liquid<T: Scalar, const D: usize>(
    property: Property,
    expected: &PoreLiquid<T, D>,
    found: &PoreLiquid<T, D>,
) -> Result<(), Failure> {
    let few = T::lit(4.0) * T::default_epsilon();
    for a in 0..D {
        let place = || Place::Component(a, a);
        near(
            property,
            place,
            expected.velocity[a],
            found.velocity[a],
            few * T::count(D + 2),
        )?;
    }
    let (expected, found) = (expected.pressure, found.pressure);
    near(
        property,
        || Place::Everywhere,
        expected,
        found,
        few * expected.abs(),
    )
}

fn round_trip<T: Scalar, const D: usize, P: Phase<T, D>>(
    phase: &P,
    sample: &PhaseSample<T>,
) -> Result<(), Failure> {
    let given = some_liquid(phase, sample);
    let mut particle = P::Particle::default();
    phase.set_liquid(given, &mut particle);
    same_liquid(Property::LiquidRoundTrip, &given, &phase.liquid(&particle))
}

fn acceleration<T: Scalar, const D: usize, P: Phase<T, D>>(
    phase: &P,
    sample: &PhaseSample<T>,
) -> Result<(), Failure> {
    let given = some_liquid(phase, sample);
    let mut particle = P::Particle::default();
    phase.set_liquid(given, &mut particle);
    let change = SVector::from_fn(|a, _| T::one() / T::count(a + 7));
    phase.accelerate_liquid(change, &mut particle);
    let faster = PoreLiquid {
        velocity: given.velocity + change,
        ..given
    };
    same_liquid(Property::AcceleratesLiquid, &faster, &phase.liquid(&particle))?;
    let strain = increments::<T, D>()[0] * sample.strain;
    let opposite = -strain;
    let step = PhaseStep::strain(&strain, &strain).with_liquid(&opposite);
    phase.update(&step, &mut particle);
    let strained = PoreLiquid {
        pressure: phase.liquid(&particle).pressure,
        ..faster
    };
    same_liquid(Property::StrainKeepsVelocity, &strained, &phase.liquid(&particle))
}

/// Particles of the same stretch and other sizes.
fn in_proportion<T: Scalar, const D: usize, P: Phase<T, D>>(
    phase: &P,
    sample: &PhaseSample<T>,
) -> Result<(), Failure> {
    let everywhere = || Place::Everywhere;
    let mass = |volume| phase.liquid_mass(volume);
    let drag = |volume| phase.drag(sample.density * volume, volume);
    let values: [(Property, &dyn Fn(T) -> T); 2] = [(Property::LiquidMass, &mass), (Property::Drag, &drag)];
    for (property, of) in values {
        let whole = of(T::one());
        at_least(property, everywhere, T::zero(), whole)?;
        for volume in [0.001, 0.3, 7.0].map(T::lit) {
            let expected = whole * volume;
            near(
                property,
                everywhere,
                expected,
                of(volume),
                expected.abs() * round_off(),
            )?;
        }
    }
    Ok(())
}

/// What solid and liquid do to the pressure in one small increment; what is of its square is allowed.
fn flow<T: Scalar, const D: usize, P: Phase<T, D>>(
    phase: &P,
    sample: &PhaseSample<T>,
) -> Result<(), Failure> {
    let (zero, n, stiffness) = (SMatrix::zeros(), phase.porosity(), phase.liquid_stiffness());
    let strain = small(sample);
    let allowed = stiffness.abs() * strain * (strain * T::lit(16.0) + round_off());
    for direction in increments::<T, D>() {
        let increment = direction * strain;
        let place = || {
            let (row, column) = direction.iamax_full();
            Place::Component(row, column)
        };
        let pressure = |solid: &SMatrix<T, D, D>, liquid: &SMatrix<T, D, D>| {
            let mut particle = P::Particle::default();
            phase.update(
                &PhaseStep::strain(solid, &zero).with_liquid(liquid),
                &mut particle,
            );
            phase.liquid(&particle).pressure
        };
        let together = pressure(&increment, &increment);
        let (solid, liquid) = (pressure(&increment, &zero), pressure(&zero, &increment));
        let shares = [(T::one() - n, solid), (n, liquid)];
        for (share, found) in shares {
            near(Property::FlowShares, place, together * share, found, allowed)?;
        }
        let expected = stiffness * increment.trace();
        near(Property::LiquidStiffness, place, expected, together, allowed)?;
    }
    Ok(())
}

/// A strain whose square is little against it, and far from round-off.
fn small<T: Scalar>(sample: &PhaseSample<T>) -> T {
    sample.strain.min(T::default_epsilon().cbrt())
}

/// Undrained, by the trapezoidal rule: the leading term in the strain.
fn work<T: Scalar, const D: usize, P: Phase<T, D>>(
    phase: &P,
    sample: &PhaseSample<T>,
) -> Result<(), Failure> {
    let (zero, strain) = (SMatrix::zeros(), small(sample));
    let unit = phase.liquid_stiffness().abs() * strain * strain;
    let allowed = unit * (T::lit(16.0) * strain + T::count(STEPS) * round_off());
    for direction in increments::<T, D>() {
        for strain in [strain, -strain] {
            let increment = direction * (strain / T::count(STEPS));
            let mut particle = P::Particle::default();
            let (mut by_pressure, mut by_stress) = (T::zero(), T::zero());
            let feels = |particle: &P::Particle| {
                let stress = phase.total_stress(&SMatrix::zeros(), particle);
                let work = stress.dot(&increment);
                let pressure = phase.liquid(particle).pressure * increment.trace();
                (pressure / T::lit(2.0), work / T::lit(2.0))
            };
            for _ in 0..STEPS {
                let before = feels(&particle);
                phase.update(&PhaseStep::strain(&increment, &zero), &mut particle);
                let after = feels(&particle);
                by_pressure += before.0 + after.0;
                by_stress += before.1 + after.1;
            }
            let energy = phase.energy_density(&particle);
            let place = || {
                let (row, column) = direction.iamax_full();
                Place::Component(row, column)
            };
            near(Property::LiquidEnergy, place, by_pressure, energy, allowed)?;
            near(Property::PoreStressIsWork, place, energy, by_stress, allowed)?;
        }
    }
    Ok(())
}

/// Data without and with strain, and with more or less of what diffuses.
fn warmed<T: Scalar, const D: usize, P: Phase<T, D>>(phase: &P, sample: &PhaseSample<T>) -> Vec<P::Particle> {
    let strains = [SMatrix::zeros()].into_iter().chain(increments::<T, D>());
    let changes = [0.0, 1.0, -1.0].map(T::lit);
    strains
        .flat_map(|strain| changes.map(|change| (strain * sample.strain, change)))
        .map(|(strain, change)| {
            let mut particle = strained(phase, &strain, STEPS);
            if !change.is_zero() {
                phase.add_to_value(change, &mut particle);
            }
            particle
        })
        .collect()
}

fn capacity<T: Scalar, const D: usize, P: Phase<T, D>>(
    phase: &P,
    sample: &PhaseSample<T>,
    particles: &[P::Particle],
) -> Result<(), Failure> {
    let everywhere = || Place::Everywhere;
    particles.iter().try_for_each(|particle| {
        let of = |volume| phase.capacity(sample.density * volume, volume, particle);
        let whole = of(T::one());
        at_least(Property::Capacity, everywhere, T::default_epsilon(), whole)?;
        [0.001, 0.3, 7.0].map(T::lit).into_iter().try_for_each(|volume| {
            let (expected, found) = (whole * volume, of(volume));
            near(
                Property::Capacity,
                everywhere,
                expected,
                found,
                expected * round_off(),
            )
        })
    })
}

/// What a particle takes in over its capacity is the change of its value, in one go and in two.
fn adds_to_value<T: Scalar, const D: usize, P: Phase<T, D>>(
    phase: &P,
    particles: &[P::Particle],
) -> Result<(), Failure> {
    particles.iter().try_for_each(|particle| {
        let (mut warmer, mut expected) = (*particle, phase.value(particle));
        let mut largest = expected.abs();
        [0.75, -0.5].map(T::lit).into_iter().try_for_each(|change| {
            phase.add_to_value(change, &mut warmer);
            expected += change;
            largest = largest.max(expected.abs()) + change.abs();
            let found = phase.value(&warmer);
            near(
                Property::AddsToValue,
                || Place::Everywhere,
                expected,
                found,
                largest * round_off(),
            )
        })
    })
}

fn flux<T: Scalar, const D: usize, P: Phase<T, D>>(
    phase: &P,
    sample: &PhaseSample<T>,
    particles: &[P::Particle],
) -> Result<(), Failure> {
    let axes = (0..D).map(|axis| SVector::<T, D>::from_fn(|a, _| T::count(usize::from(a == axis))));
    let mixed = SVector::from_fn(|a, _| T::lit([0.5, -1.0, 0.25][a % 3]));
    let directions: Vec<SVector<T, D>> = axes.chain([mixed]).collect();
    let volume = T::one();
    for particle in particles {
        let capacity = phase.capacity(sample.density, volume, particle);
        let conductivity = phase.diffusivity(sample.density, volume, particle) * capacity / volume;
        let at_rest = phase.flux(&SVector::zeros(), particle).norm();
        let (opposes, everywhere) = (Property::FluxOpposesGradient, || Place::Everywhere);
        near(opposes, everywhere, T::zero(), at_rest, T::zero())?;
        for direction in &directions {
            // Of usual size, and of either sign: a flux need not be linear.
            for size in [1.0, -1.0, 1e3].map(T::lit) {
                let gradient = direction * size;
                let place = || Place::Component(direction.iamax(), direction.iamax());
                let flux = phase.flux(&gradient, particle);
                let towards = -flux.dot(&gradient);
                let round_off = gradient.norm() * flux.norm() * round_off();
                at_least(opposes, place, -round_off, towards)?;
                let most = conductivity * gradient.norm() * (T::one() + self::round_off());
                at_least(Property::Diffusivity, place, flux.norm(), most)?;
            }
        }
    }
    Ok(())
}
