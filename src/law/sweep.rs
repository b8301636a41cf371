//! A law over the states of many particles: what a step asks, written once for laws that are types and for
//! laws that are chosen at run time.

use nalgebra::SMatrix;

use super::ConstitutiveLaw;
use crate::scalar::Scalar;
use crate::simd::with_features;

mod sealed {
    /// Only what is here says how states lie in memory.
    pub trait Sealed<T, const D: usize> {}
}
pub(super) use sealed::Sealed;

/// What a law asks of the particles of a stepper, all of them.
#[derive(Clone, Copy, Debug)]
pub struct Bodies<'a, T, const D: usize, N> {
    /// Masses.
    pub mass: &'a [T],
    /// Volumes.
    pub volume: &'a [T],
    /// Cauchy stresses (Pa).
    pub stress: &'a [SMatrix<T, D, D>],
    /// States.
    pub state: &'a [N],
}

/// A law as a [`Stepper`](crate::stepper::Stepper) meets it: every [`ConstitutiveLaw`] is one, and so is
/// [`AnyLaw`](super::AnyLaw). There is nothing to implement.
///
/// The states of all particles lie in one array of [`LawSweep::Number`]s, [`LawSweep::numbers`] of them for
/// each particle, one after the other: a law that is a type has one number a particle, its `State`, and a law
/// that is chosen at run time as many scalars as it remembers. What is asked in every step is asked for a run
/// of particles at once, so that a choice at run time costs one call for all of them.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is no constitutive law for scalar `{T}` in `{D}` dimensions"
)]
pub trait LawSweep<T: Scalar, const D: usize>: Sealed<T, D> + Send + Sync {
    /// What states are made of.
    type Number: Copy + Default + Send + Sync;

    /// How many of them the state of a particle is.
    fn numbers(&self) -> usize;

    /// See [`ConstitutiveLaw::limits`].
    fn limits(&self) -> &'static str;

    /// See [`ConstitutiveLaw::large_strain`].
    fn large_strain(&self) -> bool;

    /// [`ConstitutiveLaw::update_over`] for particles that follow each other.
    fn carry(
        &self,
        dt: T,
        increments: &[SMatrix<T, D, D>],
        stresses: &mut [SMatrix<T, D, D>],
        states: &mut [Self::Number],
    );

    /// Whether [`ConstitutiveLaw::knows`] holds for all of them.
    fn are_known(&self, stresses: &[SMatrix<T, D, D>], states: &[Self::Number]) -> bool;

    /// See [`ConstitutiveLaw::knows`].
    fn knows(&self, stress: &SMatrix<T, D, D>, state: &[Self::Number]) -> bool;

    /// See [`ConstitutiveLaw::update`].
    fn update(&self, increment: &SMatrix<T, D, D>, stress: &mut SMatrix<T, D, D>, state: &mut [Self::Number]);

    /// See [`ConstitutiveLaw::start`]; whether there is such a state.
    fn start(&self, stress: &SMatrix<T, D, D>, off_plane: Option<T>, state: &mut [Self::Number]) -> bool;

    /// See [`ConstitutiveLaw::strain_for`].
    fn strain_for(
        &self,
        change: &SMatrix<T, D, D>,
        density: T,
        stress: &SMatrix<T, D, D>,
        state: &[Self::Number],
    ) -> Option<SMatrix<T, D, D>>;

    /// See [`ConstitutiveLaw::wave_speed`].
    fn wave_speed(&self, density: T, stress: &SMatrix<T, D, D>, state: &[Self::Number]) -> T;

    /// [`ConstitutiveLaw::wave_speed`] of those of the particles that have the numbers `which`.
    fn wave_speeds(&self, which: &[u32], bodies: &Bodies<'_, T, D, Self::Number>, speeds: &mut [T]);

    /// See [`ConstitutiveLaw::off_plane_stress`].
    fn off_plane_stress(&self, stress: &SMatrix<T, D, D>, state: &[Self::Number]) -> Option<T>;

    /// See [`ConstitutiveLaw::plastic_strain`].
    fn plastic_strain(&self, state: &[Self::Number]) -> Option<T>;

    /// [`ConstitutiveLaw::energy_density`] of particles that follow each other.
    fn energy_densities(&self, stresses: &[SMatrix<T, D, D>], states: &[Self::Number], densities: &mut [T]);

    /// Whether the law remembers anything of a particle besides its stress.
    #[inline(always)]
    fn remembers(&self) -> bool {
        self.numbers() * size_of::<Self::Number>() > 0
    }

    /// The state of particle `p` among those of all.
    #[inline(always)]
    fn of<'a>(&self, states: &'a [Self::Number], p: usize) -> &'a [Self::Number] {
        let each = self.numbers();
        &states[p * each..(p + 1) * each]
    }

    /// The same to be changed.
    #[inline(always)]
    fn of_mut<'a>(&self, states: &'a mut [Self::Number], p: usize) -> &'a mut [Self::Number] {
        let each = self.numbers();
        &mut states[p * each..(p + 1) * each]
    }
}

/// The state of a law that is a type.
#[inline(always)]
fn own<S: Copy + Default>(state: &[S]) -> S {
    state.first().copied().unwrap_or_default()
}

// Both loops are functions of their own, because a compiler knows of what a function is given, and not of
// what a structure holds, that slices are apart from each other and from the law: it need not read the
// law's constants anew after each stress.

#[inline(always)]
pub(super) fn carry_all<T: Scalar, const D: usize, L: ConstitutiveLaw<T, D> + ?Sized>(
    law: &L,
    dt: T,
    increments: &[SMatrix<T, D, D>],
    stresses: &mut [SMatrix<T, D, D>],
    states: &mut [L::State],
) {
    for ((increment, stress), state) in increments.iter().zip(stresses).zip(states) {
        law.update_over(dt, increment, stress, state);
    }
}

#[inline(always)]
fn all_known<T: Scalar, const D: usize, L: ConstitutiveLaw<T, D> + ?Sized>(
    law: &L,
    stresses: &[SMatrix<T, D, D>],
    states: &[L::State],
) -> bool {
    let mut known = true;
    for (stress, state) in stresses.iter().zip(states) {
        known &= ConstitutiveLaw::knows(law, stress, state);
    }
    known
}

impl<T: Scalar, const D: usize, L: ConstitutiveLaw<T, D>> Sealed<T, D> for L {}

impl<T: Scalar, const D: usize, L: ConstitutiveLaw<T, D>> LawSweep<T, D> for L {
    type Number = L::State;

    #[inline(always)]
    fn numbers(&self) -> usize {
        1
    }

    fn limits(&self) -> &'static str {
        ConstitutiveLaw::limits(self)
    }

    #[inline(always)]
    fn large_strain(&self) -> bool {
        ConstitutiveLaw::large_strain(self)
    }

    #[inline(never)]
    fn carry(
        &self,
        dt: T,
        increments: &[SMatrix<T, D, D>],
        stresses: &mut [SMatrix<T, D, D>],
        states: &mut [L::State],
    ) {
        with_features(
            #[inline(always)]
            move || carry_all(self, dt, increments, stresses, states),
        );
    }

    #[inline(never)]
    fn are_known(&self, stresses: &[SMatrix<T, D, D>], states: &[L::State]) -> bool {
        with_features(
            #[inline(always)]
            move || all_known(self, stresses, states),
        )
    }

    #[inline(always)]
    fn knows(&self, stress: &SMatrix<T, D, D>, state: &[L::State]) -> bool {
        ConstitutiveLaw::knows(self, stress, &own(state))
    }

    #[inline(always)]
    fn update(&self, increment: &SMatrix<T, D, D>, stress: &mut SMatrix<T, D, D>, state: &mut [L::State]) {
        if let Some(state) = state.first_mut() {
            ConstitutiveLaw::update(self, increment, stress, state);
        }
    }

    fn start(&self, stress: &SMatrix<T, D, D>, off_plane: Option<T>, state: &mut [L::State]) -> bool {
        match (ConstitutiveLaw::start(self, stress, off_plane), state.first_mut()) {
            (Some(started), Some(state)) => {
                *state = started;
                true
            }
            _ => false,
        }
    }

    #[inline(always)]
    fn strain_for(
        &self,
        change: &SMatrix<T, D, D>,
        density: T,
        stress: &SMatrix<T, D, D>,
        state: &[L::State],
    ) -> Option<SMatrix<T, D, D>> {
        ConstitutiveLaw::strain_for(self, change, density, stress, &own(state))
    }

    #[inline(always)]
    fn wave_speed(&self, density: T, stress: &SMatrix<T, D, D>, state: &[L::State]) -> T {
        ConstitutiveLaw::wave_speed(self, density, stress, &own(state))
    }

    #[inline]
    fn wave_speeds(&self, which: &[u32], bodies: &Bodies<'_, T, D, L::State>, speeds: &mut [T]) {
        for (speed, &p) in speeds.iter_mut().zip(which) {
            let p = p as usize;
            let (density, state) = (bodies.mass[p] / bodies.volume[p], &bodies.state[p]);
            *speed = ConstitutiveLaw::wave_speed(self, density, &bodies.stress[p], state);
        }
    }

    fn off_plane_stress(&self, stress: &SMatrix<T, D, D>, state: &[L::State]) -> Option<T> {
        ConstitutiveLaw::off_plane_stress(self, stress, &own(state))
    }

    fn plastic_strain(&self, state: &[L::State]) -> Option<T> {
        ConstitutiveLaw::plastic_strain(self, &own(state))
    }

    #[inline]
    fn energy_densities(&self, stresses: &[SMatrix<T, D, D>], states: &[L::State], densities: &mut [T]) {
        for ((density, stress), state) in densities.iter_mut().zip(stresses).zip(states) {
            *density = ConstitutiveLaw::energy_density(self, stress, state);
        }
    }
}
