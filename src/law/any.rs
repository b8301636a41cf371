//! A law that is chosen at run time.

use std::fmt;
use std::sync::Arc;

use nalgebra::SMatrix;

use super::sweep::{Bodies, Sealed};
use super::{ConstitutiveLaw, LawSweep};
use crate::record::Record;
use crate::scalar::Scalar;
use crate::simd::with_features;

/// Any law whose states are numbers, behind one type: a stepper of it is compiled once for all laws. A step
/// asks it once for some hundred particles, which cannot be measured; the states take the room that the
/// chosen law needs, none for a law that remembers nothing.
///
/// ```
/// use materialpoint::law::{AnyLaw, LinearElastic, Moduli, VonMises};
///
/// let moduli = Moduli::from_young(1e6, 0.3)?;
/// let elastic: AnyLaw<f64, 2> = AnyLaw::new(LinearElastic { moduli });
/// let plastic: AnyLaw<f64, 2> = AnyLaw::new(VonMises::new(moduli, 1e3, 0.0)?);
/// assert!(elastic.at_rest(100).is_empty() && !plastic.at_rest(100).is_empty());
/// # Ok::<(), materialpoint::error::SetupError>(())
/// ```
#[derive(Clone)]
pub struct AnyLaw<T, const D: usize>(Arc<dyn OfNumbers<T, D>>);

impl<T, const D: usize> fmt::Debug for AnyLaw<T, D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("AnyLaw").finish_non_exhaustive()
    }
}

impl<T: Scalar, const D: usize> AnyLaw<T, D> {
    /// Forgets which law it is.
    pub fn new<L>(law: L) -> Self
    where
        L: ConstitutiveLaw<T, D> + 'static,
        L::State: Record<T>,
    {
        Self(Arc::new(law))
    }

    /// States of `count` undeformed particles, for [`Particles::state`](crate::particles::Particles::state).
    pub fn at_rest(&self, count: usize) -> Vec<T> {
        let state = self.0.at_rest();
        state.iter().copied().cycle().take(count * state.len()).collect()
    }
}

/// A law over states that are told as numbers.
trait OfNumbers<T, const D: usize>: Send + Sync {
    fn at_rest(&self) -> Vec<T>;
    fn numbers(&self) -> usize;
    fn limits(&self) -> &'static str;
    fn large_strain(&self) -> bool;
    fn carry(
        &self,
        dt: T,
        increments: &[SMatrix<T, D, D>],
        stresses: &mut [SMatrix<T, D, D>],
        states: &mut [T],
    );
    fn are_known(&self, stresses: &[SMatrix<T, D, D>], states: &[T]) -> bool;
    fn update(&self, increment: &SMatrix<T, D, D>, stress: &mut SMatrix<T, D, D>, state: &mut [T]);
    fn start(&self, stress: &SMatrix<T, D, D>, off_plane: Option<T>, state: &mut [T]) -> bool;
    fn strain_for(
        &self,
        change: &SMatrix<T, D, D>,
        density: T,
        stress: &SMatrix<T, D, D>,
        state: &[T],
    ) -> Option<SMatrix<T, D, D>>;
    fn wave_speed(&self, density: T, stress: &SMatrix<T, D, D>, state: &[T]) -> T;
    fn wave_speeds(&self, which: &[u32], bodies: &Bodies<'_, T, D, T>, speeds: &mut [T]);
    fn off_plane_stress(&self, stress: &SMatrix<T, D, D>, state: &[T]) -> Option<T>;
    fn plastic_strain(&self, state: &[T]) -> Option<T>;
    fn energy_densities(&self, stresses: &[SMatrix<T, D, D>], states: &[T], densities: &mut [T]);
}

/// The state that the numbers tell. They were told by such a state, or read from a file that was checked.
#[inline(always)]
fn state_of<T: Scalar, S: Record<T> + Default>(numbers: &[T]) -> S {
    let mut next = numbers.iter().copied();
    S::take(&mut || next.next().unwrap_or_else(T::zero)).unwrap_or_default()
}

/// Writes the numbers of a state over those that are there.
#[inline(always)]
fn put_state<T: Scalar, S: Record<T>>(state: &S, numbers: &mut [T]) {
    let mut places = numbers.iter_mut();
    state.put(&mut |number| {
        if let Some(place) = places.next() {
            *place = number;
        }
    });
}

/// How many numbers tell a state of the law.
#[inline(always)]
fn count<T: Scalar, S: Record<T> + Default>() -> usize {
    let mut count = 0;
    S::default().put(&mut |_| count += 1);
    count
}

impl<T: Scalar, const D: usize, L> OfNumbers<T, D> for L
where
    L: ConstitutiveLaw<T, D>,
    L::State: Record<T>,
{
    fn at_rest(&self) -> Vec<T> {
        let mut numbers = Vec::new();
        L::State::default().put(&mut |number| numbers.push(number));
        numbers
    }

    fn numbers(&self) -> usize {
        count::<T, L::State>()
    }

    fn limits(&self) -> &'static str {
        ConstitutiveLaw::limits(self)
    }

    fn large_strain(&self) -> bool {
        ConstitutiveLaw::large_strain(self)
    }

    fn carry(
        &self,
        dt: T,
        increments: &[SMatrix<T, D, D>],
        stresses: &mut [SMatrix<T, D, D>],
        states: &mut [T],
    ) {
        with_features(
            #[inline(always)]
            move || carry_all(self, dt, increments, stresses, states),
        );
    }

    fn are_known(&self, stresses: &[SMatrix<T, D, D>], states: &[T]) -> bool {
        with_features(
            #[inline(always)]
            move || all_known(self, stresses, states),
        )
    }

    fn update(&self, increment: &SMatrix<T, D, D>, stress: &mut SMatrix<T, D, D>, numbers: &mut [T]) {
        let mut state: L::State = state_of(numbers);
        ConstitutiveLaw::update(self, increment, stress, &mut state);
        put_state(&state, numbers);
    }

    fn start(&self, stress: &SMatrix<T, D, D>, off_plane: Option<T>, numbers: &mut [T]) -> bool {
        match ConstitutiveLaw::start(self, stress, off_plane) {
            Some(state) => {
                put_state(&state, numbers);
                true
            }
            None => false,
        }
    }

    fn strain_for(
        &self,
        change: &SMatrix<T, D, D>,
        density: T,
        stress: &SMatrix<T, D, D>,
        state: &[T],
    ) -> Option<SMatrix<T, D, D>> {
        ConstitutiveLaw::strain_for(self, change, density, stress, &state_of(state))
    }

    fn wave_speed(&self, density: T, stress: &SMatrix<T, D, D>, state: &[T]) -> T {
        ConstitutiveLaw::wave_speed(self, density, stress, &state_of(state))
    }

    fn wave_speeds(&self, which: &[u32], bodies: &Bodies<'_, T, D, T>, speeds: &mut [T]) {
        let each = count::<T, L::State>();
        for (speed, &p) in speeds.iter_mut().zip(which) {
            let p = p as usize;
            let state = state_of(&bodies.state[p * each..(p + 1) * each]);
            let density = bodies.mass[p] / bodies.volume[p];
            *speed = ConstitutiveLaw::wave_speed(self, density, &bodies.stress[p], &state);
        }
    }

    fn off_plane_stress(&self, stress: &SMatrix<T, D, D>, state: &[T]) -> Option<T> {
        ConstitutiveLaw::off_plane_stress(self, stress, &state_of(state))
    }

    fn plastic_strain(&self, state: &[T]) -> Option<T> {
        ConstitutiveLaw::plastic_strain(self, &state_of(state))
    }

    fn energy_densities(&self, stresses: &[SMatrix<T, D, D>], states: &[T], densities: &mut [T]) {
        let each = count::<T, L::State>();
        for (p, (density, stress)) in densities.iter_mut().zip(stresses).enumerate() {
            let state = state_of(&states[p * each..(p + 1) * each]);
            *density = ConstitutiveLaw::energy_density(self, stress, &state);
        }
    }
}

/// For each scalar by name: were it for any, a user's law for a scalar of his own could stand against it.
macro_rules! any_law {
    ($($scalar:ty),+) => {$(
        impl<const D: usize> Sealed<$scalar, D> for AnyLaw<$scalar, D> {}

        impl<const D: usize> LawSweep<$scalar, D> for AnyLaw<$scalar, D> {
            type Number = $scalar;

            #[inline]
            fn numbers(&self) -> usize {
                self.0.numbers()
            }

            fn limits(&self) -> &'static str {
                self.0.limits()
            }

            fn large_strain(&self) -> bool {
                self.0.large_strain()
            }

            #[inline]
            fn carry(
                &self,
                dt: $scalar,
                increments: &[SMatrix<$scalar, D, D>],
                stresses: &mut [SMatrix<$scalar, D, D>],
                states: &mut [$scalar],
            ) {
                self.0.carry(dt, increments, stresses, states);
            }

            #[inline]
            fn are_known(&self, stresses: &[SMatrix<$scalar, D, D>], states: &[$scalar]) -> bool {
                self.0.are_known(stresses, states)
            }

            fn knows(&self, stress: &SMatrix<$scalar, D, D>, state: &[$scalar]) -> bool {
                self.0.are_known(std::slice::from_ref(stress), state)
            }

            fn update(
                &self,
                increment: &SMatrix<$scalar, D, D>,
                stress: &mut SMatrix<$scalar, D, D>,
                state: &mut [$scalar],
            ) {
                self.0.update(increment, stress, state);
            }

            fn start(
                &self,
                stress: &SMatrix<$scalar, D, D>,
                off_plane: Option<$scalar>,
                state: &mut [$scalar],
            ) -> bool {
                self.0.start(stress, off_plane, state)
            }

            fn strain_for(
                &self,
                change: &SMatrix<$scalar, D, D>,
                density: $scalar,
                stress: &SMatrix<$scalar, D, D>,
                state: &[$scalar],
            ) -> Option<SMatrix<$scalar, D, D>> {
                self.0.strain_for(change, density, stress, state)
            }

            fn wave_speed(
                &self,
                density: $scalar,
                stress: &SMatrix<$scalar, D, D>,
                state: &[$scalar],
            ) -> $scalar {
                self.0.wave_speed(density, stress, state)
            }

            #[inline]
            fn wave_speeds(
                &self,
                which: &[u32],
                bodies: &Bodies<'_, $scalar, D, $scalar>,
                speeds: &mut [$scalar],
            ) {
                self.0.wave_speeds(which, bodies, speeds);
            }

            fn off_plane_stress(
                &self,
                stress: &SMatrix<$scalar, D, D>,
                state: &[$scalar],
            ) -> Option<$scalar> {
                self.0.off_plane_stress(stress, state)
            }

            fn plastic_strain(&self, state: &[$scalar]) -> Option<$scalar> {
                self.0.plastic_strain(state)
            }

            #[inline]
            fn energy_densities(
                &self,
                stresses: &[SMatrix<$scalar, D, D>],
                states: &[$scalar],
                densities: &mut [$scalar],
            ) {
                self.0.energy_densities(stresses, states, densities);
            }
        }
    )+};
}

any_law!(f64, f32);

// Functions of their own, because a compiler knows of what a function is given that slices are apart from
// each other.

#[inline(always)]
fn carry_all<T, const D: usize, L>(
    law: &L,
    dt: T,
    increments: &[SMatrix<T, D, D>],
    stresses: &mut [SMatrix<T, D, D>],
    states: &mut [T],
) where
    T: Scalar,
    L: ConstitutiveLaw<T, D, State: Record<T>>,
{
    let each = count::<T, L::State>();
    if each == 0 {
        // Nothing between two particles but the law itself: a compiler makes vectors of that.
        for (increment, stress) in increments.iter().zip(stresses) {
            law.update_over(dt, increment, stress, &mut L::State::default());
        }
        return;
    }
    let bodies = increments.iter().zip(stresses).zip(states.chunks_exact_mut(each));
    for ((increment, stress), numbers) in bodies {
        let mut state: L::State = state_of(numbers);
        law.update_over(dt, increment, stress, &mut state);
        put_state(&state, numbers);
    }
}

#[inline(always)]
fn all_known<T, const D: usize, L>(law: &L, stresses: &[SMatrix<T, D, D>], states: &[T]) -> bool
where
    T: Scalar,
    L: ConstitutiveLaw<T, D, State: Record<T>>,
{
    let each = count::<T, L::State>();
    let mut known = true;
    if each == 0 {
        let nothing = L::State::default();
        for stress in stresses {
            known &= ConstitutiveLaw::knows(law, stress, &nothing);
        }
        return known;
    }
    for (stress, numbers) in stresses.iter().zip(states.chunks_exact(each)) {
        known &= ConstitutiveLaw::knows(law, stress, &state_of(numbers));
    }
    known
}
