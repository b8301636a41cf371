//! Two phases: a saturated solid.

use nalgebra::{SMatrix, SVector};

use super::{Phase, PhaseStep};
use crate::error::SetupError;
use crate::scalar::Scalar;

/// When the drag between the phases is felt.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Drag {
    /// By the velocities at the end of the step, DOF by DOF: no limit on the step.
    #[default]
    Implicit,
    /// By the velocities at its start, as published: the step is limited by the drag where the permeability
    /// is small.
    Explicit,
}

impl Drag {
    /// Name in scenes.
    pub fn name(self) -> &'static str {
        match self {
            Self::Implicit => "implicit",
            Self::Explicit => "explicit",
        }
    }
}

/// What a particle carries of its liquid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoreLiquid<T, const D: usize> {
    /// Velocity (m/s), half a step before the position like the solid's.
    pub velocity: SVector<T, D>,
    /// Pressure (Pa), tension positive like every stress here: negative where the liquid is compressed.
    pub pressure: T,
}

impl<T: Scalar, const D: usize> Default for PoreLiquid<T, D> {
    fn default() -> Self {
        Self {
            velocity: SVector::zeros(),
            pressure: T::zero(),
        }
    }
}

/// A saturated solid in the formulation of two velocities (v-w; report 18-2, equations 5 to 11, as mended in
/// `docs/verification/two-phase.md`). With porosity $n$, unit weight $\gamma_w = \rho_w g$ and the derivative
/// that follows the solid,
///
/// $$\rho_w\dot v_w = \nabla p - \frac{n\gamma_w}{k}(v_w - v_s) + \rho_w b,$$
/// $$(1-n)\rho_s\dot v_s + n\rho_w\dot v_w = \nabla\cdot(\sigma' + p) + ((1-n)\rho_s + n\rho_w) b,$$
/// $$\dot p = \frac{K_w}{n}\left((1-n)\operatorname{tr}\nabla v_s + n\operatorname{tr}\nabla v_w\right).$$
///
/// The particles' own mass is the solid's, $(1-n)\rho_s V_0$, constant; the liquid's is $n\rho_w V$: liquid
/// flows through. The porosity is a constant: carried along with the strain it would amplify noise by
/// $K_w/n$.
#[doc = include_str!("../../docs/formulas.html")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwoPhase<T> {
    /// Porosity `n`, between 0 and 1.
    pub porosity: T,
    /// Density of the grains (kg/m3).
    pub solid_density: T,
    /// Density of the liquid (kg/m3).
    pub liquid_density: T,
    /// Bulk modulus of the liquid (Pa).
    pub liquid_bulk_modulus: T,
    /// Permeability (hydraulic conductivity, m/s) of the undeformed solid.
    pub permeability: T,
    /// Permeability changes with the volume ratio `lambda = V / V_0` as `k = k_0 lambda^exponent`.
    pub permeability_exponent: T,
    /// Gravity (m/s2) in the liquid's unit weight; it loads nothing.
    pub gravity: T,
    /// When the drag is felt.
    pub drag: Drag,
}

impl<T: Scalar> TwoPhase<T> {
    /// The same phases in another scalar.
    pub fn cast<U: Scalar>(&self) -> TwoPhase<U> {
        let cast = |value: T| U::lit(value.primal());
        TwoPhase {
            porosity: cast(self.porosity),
            solid_density: cast(self.solid_density),
            liquid_density: cast(self.liquid_density),
            liquid_bulk_modulus: cast(self.liquid_bulk_modulus),
            permeability: cast(self.permeability),
            permeability_exponent: cast(self.permeability_exponent),
            gravity: cast(self.gravity),
            drag: self.drag,
        }
    }

    /// Mass density (kg/m3) of the dry solid, pores included: that of the particles' mass.
    pub fn dry_density(&self) -> T {
        (T::one() - self.porosity) * self.solid_density
    }

    /// Density (kg/m3) of the whole.
    pub fn saturated_density(&self) -> T {
        self.dry_density() + self.porosity * self.liquid_density
    }

    /// Permeability (m/s) at the volume ratio `stretch`.
    #[inline(always)]
    pub fn permeability_at(&self, stretch: T) -> T {
        if self.permeability_exponent == T::zero() {
            self.permeability
        } else if self.permeability_exponent == T::lit(2.0) {
            self.permeability * stretch * stretch
        } else {
            self.permeability * stretch.powf(self.permeability_exponent)
        }
    }
}

impl<T: Scalar, const D: usize> Phase<T, D> for TwoPhase<T> {
    const COUPLED: bool = true;
    const FLOWS: bool = true;
    type Particle = PoreLiquid<T, D>;

    #[inline(always)]
    fn total_stress(&self, effective: &SMatrix<T, D, D>, particle: &PoreLiquid<T, D>) -> SMatrix<T, D, D> {
        let mut total = *effective;
        for a in 0..D {
            total[(a, a)] += particle.pressure;
        }
        total
    }

    #[inline(always)]
    fn update(&self, step: &PhaseStep<'_, T, D>, particle: &mut PoreLiquid<T, D>) {
        let n = self.porosity;
        let volume_rate = (T::one() - n) * step.solid.trace() + n * step.liquid.trace();
        particle.pressure += self.liquid_bulk_modulus / n * volume_rate;
    }

    fn validate(&self) -> Result<(), SetupError> {
        let refuse = |name, value: T, allowed| {
            let value = value.primal();
            Err(SetupError::Constant { name, value, allowed })
        };
        if !(self.porosity > T::zero() && self.porosity < T::one()) {
            return refuse("porosity", self.porosity, "it must lie between 0 and 1");
        }
        let positive = [
            ("solid_density", self.solid_density),
            ("liquid_density", self.liquid_density),
            ("liquid_bulk_modulus", self.liquid_bulk_modulus),
            ("permeability", self.permeability),
            ("gravity", self.gravity),
        ];
        if let Some(&(name, value)) = positive
            .iter()
            .find(|(_, value)| !value.is_finite() || *value <= T::zero())
        {
            return refuse(name, value, "it must be positive and finite");
        }
        if !self.permeability_exponent.is_finite() {
            return refuse(
                "permeability_exponent",
                self.permeability_exponent,
                "it must be finite",
            );
        }
        Ok(())
    }

    #[inline(always)]
    fn liquid(&self, particle: &PoreLiquid<T, D>) -> PoreLiquid<T, D> {
        *particle
    }

    #[inline(always)]
    fn accelerate_liquid(&self, change: SVector<T, D>, particle: &mut PoreLiquid<T, D>) {
        particle.velocity += change;
    }

    #[inline(always)]
    fn set_liquid(&self, liquid: PoreLiquid<T, D>, particle: &mut PoreLiquid<T, D>) {
        *particle = liquid;
    }

    #[inline(always)]
    fn porosity(&self) -> T {
        self.porosity
    }

    #[inline(always)]
    fn liquid_mass(&self, volume: T) -> T {
        self.porosity * self.liquid_density * volume
    }

    #[inline(always)]
    fn drag(&self, solid_mass: T, volume: T) -> T {
        let unit = self.porosity * self.liquid_density * self.gravity;
        if self.permeability_exponent == T::zero() {
            return unit / self.permeability * volume;
        }
        unit * volume / self.permeability_at(volume * self.dry_density() / solid_mass)
    }

    #[inline(always)]
    fn drag_treatment(&self) -> Drag {
        self.drag
    }

    fn liquid_stiffness(&self) -> T {
        self.liquid_bulk_modulus / self.porosity
    }

    fn energy_density(&self, particle: &PoreLiquid<T, D>) -> T {
        let two = T::lit(2.0);
        particle.pressure * particle.pressure * self.porosity / (two * self.liquid_bulk_modulus)
    }
}
