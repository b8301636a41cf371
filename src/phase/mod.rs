//! Phases: what shares the pores with the solid.

mod one;
mod record;
mod two;

pub use one::OnePhase;
pub use two::{Drag, PoreLiquid, TwoPhase};

use nalgebra::{SMatrix, SVector};

use crate::error::SetupError;
use crate::scalar::Scalar;

/// What a [`Phase`] is told of one step of a particle.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct PhaseStep<'a, T, const D: usize> {
    /// Length of the step (s); zero where it is asked how stiff the phase is.
    pub dt: T,
    /// Displacement gradient of the solid over the step.
    pub solid: &'a SMatrix<T, D, D>,
    /// That of the liquid; the solid's, where none flows.
    pub liquid: &'a SMatrix<T, D, D>,
    /// Effective stress (Pa) of the solid at the end of the step.
    pub stress: &'a SMatrix<T, D, D>,
    /// Volume (m3) of the particle at the end of the step.
    pub volume: T,
}

impl<'a, T: Scalar, const D: usize> PhaseStep<'a, T, D> {
    /// A step of no time of a particle of volume one.
    pub fn strain(solid: &'a SMatrix<T, D, D>, stress: &'a SMatrix<T, D, D>) -> Self {
        Self {
            dt: T::zero(),
            solid,
            liquid: solid,
            stress,
            volume: T::one(),
        }
    }

    /// With another displacement gradient of the liquid.
    #[must_use]
    pub fn with_liquid(self, liquid: &'a SMatrix<T, D, D>) -> Self {
        Self { liquid, ..self }
    }

    /// With the length of the step (s).
    #[must_use]
    pub fn with_time(self, dt: T) -> Self {
        Self { dt, ..self }
    }

    /// With a volume (m3).
    #[must_use]
    pub fn with_volume(self, volume: T) -> Self {
        Self { volume, ..self }
    }
}

/// What a particle carries besides its solid, and how that enters the balance of momentum.
///
/// [`OnePhase`] is the dry solid: no data, no work. [`TwoPhase`] is a solid whose pores are full of a liquid
/// that moves with a velocity of its own. Everything a phase adds to the step stands under `if P::COUPLED`,
/// `if P::FLOWS` or `if P::DIFFUSES`, since zero-sized data alone leave empty loops behind.
///
/// The hooks from [`Phase::liquid`] to [`Phase::liquid_stiffness`] are asked only of a phase that
/// [`Phase::FLOWS`], which must write each of them: one that it forgets is an error at compile time, as soon
/// as a stepper is made of it. Masses and forces of the liquid are those of [`mod@crate::stepper`]'s second
/// balance of momentum. In the same way the hooks from [`Phase::capacity`] on belong to a phase that
/// [`Phase::DIFFUSES`].
///
/// [`crate::testing::check_phase`] checks that the parts agree with each other.
pub trait Phase<T: Scalar, const D: usize>: Send + Sync {
    /// Whether there is anything but the solid.
    const COUPLED: bool;

    /// Whether a liquid moves through the pores with a velocity of its own. Implies [`Phase::COUPLED`].
    const FLOWS: bool = false;

    /// Whether particles exchange a scalar with their neighbours, as heat goes from the warm to the cold.
    /// Implies [`Phase::COUPLED`]; a phase that [`Phase::FLOWS`] cannot, since nothing carries along what its
    /// liquid holds. `docs/theory/diffusion.md` has the scheme.
    const DIFFUSES: bool = false;

    /// Data per particle; `()` takes no memory.
    type Particle: Copy + Default + Send + Sync;

    /// Stress (Pa) that the momentum balance of the whole feels, given the solid's effective stress.
    fn total_stress(&self, effective: &SMatrix<T, D, D>, particle: &Self::Particle) -> SMatrix<T, D, D>;

    /// Carries the data over one step, after the law and the volume. Asked of copies of the data too, with
    /// small increments and no time, to find how stiff the phase is: nothing but the data may change.
    fn update(&self, step: &PhaseStep<'_, T, D>, particle: &mut Self::Particle);

    /// Energy that the phase stores beside the strain energy of the law, per volume (J/m3): heat, a
    /// compressed liquid.
    fn energy_density(&self, _particle: &Self::Particle) -> T {
        const { assert!(!Self::FLOWS, "a phase that FLOWS wants an own `energy_density`") };
        T::zero()
    }

    /// Checks the constants.
    ///
    /// # Errors
    /// If one of them makes no sense.
    fn validate(&self) -> Result<(), SetupError> {
        Ok(())
    }

    /// Velocity (m/s) and pressure (Pa, tension positive) of a particle's liquid.
    fn liquid(&self, _particle: &Self::Particle) -> PoreLiquid<T, D> {
        const { assert!(!Self::FLOWS, "a phase that FLOWS wants an own `liquid`") };
        PoreLiquid::default()
    }

    /// Adds to the velocity (m/s) of a particle's liquid.
    fn accelerate_liquid(&self, _change: SVector<T, D>, _particle: &mut Self::Particle) {
        const {
            assert!(
                !Self::FLOWS,
                "a phase that FLOWS wants an own `accelerate_liquid`"
            )
        };
    }

    /// Gives a particle's liquid another velocity and pressure.
    fn set_liquid(&self, _liquid: PoreLiquid<T, D>, _particle: &mut Self::Particle) {
        const { assert!(!Self::FLOWS, "a phase that FLOWS wants an own `set_liquid`") };
    }

    /// Share of the volume that the liquid fills.
    fn porosity(&self) -> T {
        const { assert!(!Self::FLOWS, "a phase that FLOWS wants an own `porosity`") };
        T::one()
    }

    /// Mass of the liquid in a particle of the given `volume`.
    fn liquid_mass(&self, _volume: T) -> T {
        const { assert!(!Self::FLOWS, "a phase that FLOWS wants an own `liquid_mass`") };
        T::zero()
    }

    /// Drag of a particle (kg/s in 3-D): the force on its liquid, per porosity, for each m/s by which the
    /// solid is faster.
    fn drag(&self, _solid_mass: T, _volume: T) -> T {
        const { assert!(!Self::FLOWS, "a phase that FLOWS wants an own `drag`") };
        T::zero()
    }

    /// Whether the drag of a step is felt by the velocity at the step's start or at its end.
    fn drag_treatment(&self) -> Drag {
        const { assert!(!Self::FLOWS, "a phase that FLOWS wants an own `drag_treatment`") };
        Drag::Implicit
    }

    /// Stiffness (Pa) of the liquid in its pores: pressure rate per volume rate of the liquid's flow,
    /// `K / n`.
    fn liquid_stiffness(&self) -> T {
        const { assert!(!Self::FLOWS, "a phase that FLOWS wants an own `liquid_stiffness`") };
        T::zero()
    }

    /// Capacity of a particle of this `mass` (kg) and `volume` (m3), positive: how much of what diffuses
    /// raises its value by one (J/K of heat).
    fn capacity(&self, _mass: T, _volume: T, _particle: &Self::Particle) -> T {
        const { assert!(!Self::DIFFUSES, "a phase that DIFFUSES wants an own `capacity`") };
        T::one()
    }

    /// Value of a particle that gradients are taken of (K of heat).
    fn value(&self, _particle: &Self::Particle) -> T {
        const { assert!(!Self::DIFFUSES, "a phase that DIFFUSES wants an own `value`") };
        T::zero()
    }

    /// Adds to the value of a particle what it took in, over its capacity (K of heat).
    fn add_to_value(&self, _change: T, _particle: &mut Self::Particle) {
        const {
            assert!(
                !Self::DIFFUSES,
                "a phase that DIFFUSES wants an own `add_to_value`"
            )
        };
    }

    /// Flux per area at a particle (W/m2 of heat) that a gradient of the value (K/m) drives, never towards
    /// higher values: `-k grad theta`.
    fn flux(&self, _gradient: &SVector<T, D>, _particle: &Self::Particle) -> SVector<T, D> {
        const { assert!(!Self::DIFFUSES, "a phase that DIFFUSES wants an own `flux`") };
        SVector::zeros()
    }

    /// Diffusivity (m2/s) of a particle of this `mass` (kg) and `volume` (m3): an upper bound of flux over
    /// gradient and capacity per volume, `k / (rho c)`. The stable step is taken from it.
    fn diffusivity(&self, _mass: T, _volume: T, _particle: &Self::Particle) -> T {
        const {
            assert!(
                !Self::DIFFUSES,
                "a phase that DIFFUSES wants an own `diffusivity`"
            )
        };
        T::zero()
    }
}

/// What constants of a phase ask of each other; evaluated where a stepper is made.
pub(crate) const fn constants_agree<T: Scalar, const D: usize, P: Phase<T, D>>() {
    assert!(!P::FLOWS || P::COUPLED, "FLOWS wants COUPLED");
    assert!(!P::DIFFUSES || P::COUPLED, "DIFFUSES wants COUPLED");
    assert!(
        !P::DIFFUSES || !P::FLOWS,
        "a phase that FLOWS cannot DIFFUSE: nothing carries along what its liquid holds"
    );
}
