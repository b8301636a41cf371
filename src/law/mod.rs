//! Constitutive laws. Equations, states and verified figures of all: `docs/theory/laws.md`.

mod any;
mod constant;
mod drucker_prager;
mod elastic_stretch;
mod hencky;
mod hill;
mod linear_elastic;
mod logarithmic;
mod moduli;
mod neo_hookean;
mod newtonian_fluid;
mod record;
mod st_venant_kirchhoff;
mod sweep;
mod von_mises;

pub use any::AnyLaw;
pub use drucker_prager::{ConeMatch, DruckerPrager, DruckerPragerState, Strength};
pub use elastic_stretch::{ElasticStretch, PrincipalStretch, length, stored_energy, wave_modulus};
pub use hencky::Hencky;
pub use hill::Hill;
pub use linear_elastic::{LinearElastic, hooke_strain};
pub use logarithmic::Logarithmic;
pub use moduli::Moduli;
pub use neo_hookean::{DeformationGradient, NeoHookean};
pub use newtonian_fluid::{NewtonianFluid, VolumeRatio};
pub use st_venant_kirchhoff::StVenantKirchhoff;
pub use sweep::{Bodies, LawSweep};
pub use von_mises::{VonMises, VonMisesState, deviator};

use nalgebra::SMatrix;

use crate::scalar::Scalar;

/// How stress follows the deformation.
///
/// Implement it for a law of your own (see `examples/own_law.rs`); [`crate::testing::check_law`] checks that
/// the parts agree with each other.
///
/// # What an increment holds
/// `increment` is $\Delta t\,\nabla v$, all of it: its symmetric part strains the material, its antisymmetric
/// part turns it. The deformation gradient after the step is $F_{n+1} = (1 + \text{increment}) F_n$. Below
/// three dimensions nothing moves along the axes that the grid does not have (plane strain, uniaxial strain).
///
/// The step turns no stress and no state: **objectivity is the law's own care**. A law of small strain takes
/// the symmetric part and leaves rotations alone; a rate at large strain adds what turns the stress,
/// $W\sigma - \sigma W$ with the antisymmetric part $W$ ([`Hill`]); a law that keeps $F$ or $b = F F^T$
/// carries that by $1 + \text{increment}$ and needs no more ([`NeoHookean`], [`ElasticStretch`]).
///
/// # When it is asked
/// Once a step and particle, after the particle has moved and before its volume follows:
/// [`ConstitutiveLaw::update_over`], then [`ConstitutiveLaw::knows`]. Stress and state come as the last step
/// left them, or as a reconstruction that relaxes has moved them by [`ConstitutiveLaw::strain_for`] and an
/// `update` over it. [`crate::stepper::Stepper::critical_step`] and the checks call `update` on copies, so it
/// must change nothing but its arguments. `Default` of the state knows no constants of the law: keep what
/// scales with them as a ratio to them.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is no constitutive law for scalar `{T}` in `{D}` dimensions"
)]
pub trait ConstitutiveLaw<T: Scalar, const D: usize>: Send + Sync {
    /// What the law remembers of each particle besides its stress; `()` for an elastic rate law.
    /// `Default` is the undeformed state.
    type State: Copy + Default + Send + Sync;

    /// What [`ConstitutiveLaw::knows`] asks for, for messages.
    fn limits(&self) -> &'static str {
        "its law knows no such stress"
    }

    /// Whether the law has a meaning at this stress. A step that leads beyond ends in an error.
    #[inline(always)]
    fn knows(&self, _stress: &SMatrix<T, D, D>, _state: &Self::State) -> bool {
        true
    }

    /// Whether volume and density follow the deformation (large strain) or stay as they were (small strain).
    fn large_strain(&self) -> bool;

    /// Carries stress (Cauchy, Pa, tension positive) and state over the displacement gradient `increment` of
    /// one step, strain and rotation: row = component, column = derivative, taken at the step's start.
    fn update(&self, increment: &SMatrix<T, D, D>, stress: &mut SMatrix<T, D, D>, state: &mut Self::State);

    /// The same over a step that takes `dt` (s), for laws that feel the rate of strain; this is what a step
    /// calls.
    ///
    /// A law that knows no time writes [`ConstitutiveLaw::update`] alone, and the default forwards to it at
    /// no cost. `update` stays free of `dt` because the increment is all that most laws need, and because
    /// checks and the critical step ask for the response to a strain, not to a rate. A law that does feel the
    /// rate gives in `update` its response without it.
    #[inline(always)]
    fn update_over(
        &self,
        _dt: T,
        increment: &SMatrix<T, D, D>,
        stress: &mut SMatrix<T, D, D>,
        state: &mut Self::State,
    ) {
        self.update(increment, stress, state);
    }

    /// The state of material that is under `stress` (Cauchy, Pa) before it moves; `None` if the law has none.
    ///
    /// `off_plane` is the stress (Pa) along every axis that the grid does not have, such as `K_0 sigma_yy` in
    /// plane strain. `None` stands for what elastic material would feel that has been strained in the grid's
    /// axes alone: `nu (sigma_xx + sigma_yy)`. A law that remembers no strain off the plane answers `None` to
    /// any other.
    ///
    /// By default stress is carried by a law without state, and any other law starts from rest only. Laws
    /// whose stress follows from their state must override it to be given an initial stress: the next update
    /// would forget it.
    #[inline]
    fn start(&self, stress: &SMatrix<T, D, D>, _off_plane: Option<T>) -> Option<Self::State> {
        let free = stress.iter().all(|s| s.is_zero());
        (free || size_of::<Self::State>() == 0).then(Self::State::default)
    }

    /// Hooke's constants of the elastic part at rest; `None` if the law has none to tell.
    #[inline]
    fn elastic_constants(&self) -> Option<Moduli<T>> {
        None
    }

    /// Strain that changes the stress by about `change` (Pa), for a reconstruction that moves stresses a
    /// little towards what it sees of them: a stress that follows from a state is moved with it, by an
    /// [`ConstitutiveLaw::update`] over this strain. `None` if it must be left alone, as of material that is
    /// separated.
    ///
    /// Unless told otherwise that of Hooke's law with the [`ConstitutiveLaw::elastic_constants`], scaled to
    /// the modulus of the fastest wave now; without constants the change over that modulus, which moves the
    /// stress of any stable material in the right direction, though not all of it as fast.
    #[inline]
    fn strain_for(
        &self,
        change: &SMatrix<T, D, D>,
        density: T,
        stress: &SMatrix<T, D, D>,
        state: &Self::State,
    ) -> Option<SMatrix<T, D, D>> {
        let speed = self.wave_speed(density, stress, state);
        let modulus = density * speed * speed;
        (modulus > T::zero()).then(|| match self.elastic_constants() {
            Some(moduli) => linear_elastic::hooke_strain_at(&moduli, change, modulus),
            None => change / modulus,
        })
    }

    /// Speed (m/s) of the fastest wave in material of the given current `density` (kg/m3).
    fn wave_speed(&self, density: T, stress: &SMatrix<T, D, D>, state: &Self::State) -> T;

    /// Cauchy stress (Pa) along the axes that the grid does not have, alike if there are two of them; `None`
    /// where there is no such axis, or where the law does not know it.
    ///
    /// It is no part of the motion, so nothing in a step asks for it; files and pictures do, because mean and
    /// von Mises stress are those of all three axes.
    #[inline]
    fn off_plane_stress(&self, _stress: &SMatrix<T, D, D>, _state: &Self::State) -> Option<T> {
        None
    }

    /// Accumulated plastic strain, the integral of `sqrt(2/3 e : e)` with the deviator `e` of the plastic
    /// strain rate; `None` of a law that knows none. Files ask for it, no step does.
    #[inline]
    fn plastic_strain(&self, _state: &Self::State) -> Option<T> {
        None
    }

    /// Strain energy per *current* volume (J/m3); per volume that never changes in small strain.
    fn energy_density(&self, stress: &SMatrix<T, D, D>, state: &Self::State) -> T;
}
