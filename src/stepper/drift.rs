//! G2P of velocities and their gradients: particles move, and their law, phase and volume follow.

use nalgebra::SMatrix;

use super::spans::{Fault, InvalidState, Moved, Spans};
use crate::basis::BasisFamily;
use crate::grid::Grid;
use crate::law::LawSweep;
use crate::parallel::{PARTICLES, PerSpan, each_span, worth_sharing};
use crate::particles::{Bins, Material, Particles};
use crate::phase::{Phase, PhaseStep};
use crate::scalar::Scalar;
use crate::simd::with_features;
use crate::tensor::determinant;
use crate::transfer::{Drift, Outcome, drift};

/// What particles are made of.
pub(super) struct Matter<'a, L, P> {
    pub(super) law: &'a L,
    pub(super) phase: &'a P,
}

/// Moves and deforms every particle, by the velocities of one phase or of both, and looks its new cell up.
#[inline(never)]
pub(super) fn move_particles<T, const D: usize, B, L, P, const C: usize>(
    (basis, grid, bins): (&B, &Grid<T, D>, &mut Bins<D>),
    particles: &mut Particles<T, D, L::Number, P::Particle>,
    matter: &Matter<'_, L, P>,
    motion: &Drift<'_, T, D, C>,
    spans: &mut Spans<T, D>,
) where
    T: Scalar,
    B: BasisFamily<T, D>,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
{
    let parallel = worth_sharing::<D>(particles.position.len(), PARTICLES);
    let work = (
        particles.movable(matter.law.numbers()),
        bins.cells_mut(),
        PerSpan(&mut spans.moved),
        PerSpan(&mut spans.bounds),
    );
    each_span(parallel, PARTICLES, work, &|first,
                                           (
        mut particles,
        cells,
        found,
        bounds,
    )| {
        let mut flaw = None;
        let (places, mut material) = particles.places_and_material(cells);
        let outcome = drift(basis, grid, motion, places, &mut |p, increments| {
            let some = material.some(p, increments[0].len());
            flaw = deform(matter, motion.dt, increments, some).map(|(k, flaw)| (p + k, flaw));
            flaw.is_none()
        });
        bounds.set(outcome.bounds);
        found.set(moved(first, &outcome, flaw));
    });
}

/// What became of a span's particles, the first of which has the number `first`. Of particles at fault the
/// first one is told.
fn moved<T>(first: usize, outcome: &Outcome, flaw: Option<(usize, InvalidState<T>)>) -> Moved<T> {
    let fault = match (flaw, outcome.left) {
        (Some((p, flaw)), left) if left.is_none_or(|left| p <= left) => {
            Some(Fault::Material(first + p, flaw))
        }
        (_, left) => left.map(|p| Fault::Left(first + p)),
    };
    Moved {
        crossings: outcome.crossings,
        strayed: outcome.strayed,
        fault,
    }
}

/// Deforms particles; returns the first one whose volume is no longer a positive number, whose stress the law
/// does not know or whose liquid has no pressure any more.
fn deform<T: Scalar, const D: usize, L: LawSweep<T, D>, P: Phase<T, D>, const C: usize>(
    matter: &Matter<'_, L, P>,
    dt: T,
    increments: [&[SMatrix<T, D, D>]; C],
    material: Material<'_, T, D, L::Number, P::Particle>,
) -> Option<(usize, InvalidState<T>)> {
    let Matter { law, phase } = *matter;
    law.carry(dt, increments[0], material.stress, material.state);
    let known = law.are_known(material.stress, material.state);
    let sound = !law.large_strain() || stretch(increments[0], material.volume);
    if P::COUPLED {
        // Without flow there is one field of increments, that of the solid.
        let of_both = increments[0].iter().zip(increments[C - 1]);
        let bodies = material.stress.iter().zip(&*material.volume);
        for (((solid, liquid), (stress, &volume)), data) in of_both.zip(bodies).zip(&mut *material.phase) {
            let step = PhaseStep {
                dt,
                solid,
                liquid,
                stress,
                volume,
            };
            phase.update(&step, data);
        }
    }
    let finite = !P::FLOWS || have_pressures(phase, material.phase);
    if known && sound && finite {
        return None;
    }
    first_invalid_state(law, phase, &material)
}

// A function of its own, because a compiler knows of what a function is given that slices are apart from each
// other.

/// Lets volumes follow the increments; whether all are still sound.
fn stretch<T: Scalar, const D: usize>(increments: &[SMatrix<T, D, D>], volumes: &mut [T]) -> bool {
    with_features(
        #[inline(always)]
        move || stretch_all(increments, volumes),
    )
}

#[inline(always)]
fn stretch_all<T: Scalar, const D: usize>(increments: &[SMatrix<T, D, D>], volumes: &mut [T]) -> bool {
    let mut sound = true;
    for (increment, volume) in increments.iter().zip(volumes) {
        *volume *= determinant(&(SMatrix::identity() + increment));
        sound &= is_valid_volume(*volume);
    }
    sound
}

/// Whether the liquid of all has a pressure that is a number.
fn have_pressures<T: Scalar, const D: usize, P: Phase<T, D>>(phase: &P, data: &[P::Particle]) -> bool {
    data.iter().all(|data| phase.liquid(data).pressure.is_finite())
}

/// Whether a volume is a positive number, and finite.
#[inline(always)]
fn is_valid_volume<T: Scalar>(volume: T) -> bool {
    (volume > T::zero()) & (volume * T::zero()).is_zero()
}

/// What is wrong with the first particle with which something is.
#[cold]
#[inline(never)]
fn first_invalid_state<T: Scalar, const D: usize, L: LawSweep<T, D>, P: Phase<T, D>>(
    law: &L,
    phase: &P,
    material: &Material<'_, T, D, L::Number, P::Particle>,
) -> Option<(usize, InvalidState<T>)> {
    let bodies = material.stress.iter().zip(&*material.volume);
    bodies.enumerate().find_map(|(k, (stress, &volume))| {
        if P::FLOWS {
            let pressure = material
                .phase
                .get(k)
                .map_or_else(T::zero, |data| phase.liquid(data).pressure);
            if !pressure.is_finite() {
                return Some((k, InvalidState::Pressure(pressure)));
            }
        }
        if !law.knows(stress, law.of(material.state, k)) {
            return Some((k, InvalidState::Stress(stress[(0, 0)])));
        }
        let unsound = law.large_strain() && !is_valid_volume(volume);
        unsound.then_some((k, InvalidState::Volume(volume)))
    })
}

#[cfg(test)]
mod tests;
