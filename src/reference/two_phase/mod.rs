//! Exact and converged solutions of one-dimensional saturated soil: a solid skeleton and a liquid in its
//! pores.
//!
//! SI units, stresses and pore pressure positive in tension, `f64` throughout. The state belongs to
//! a *material point of the solid*, asked for by its position at time 0; the column stands on its `origin`,
//! and its depth is what is above.
//!
//! With the porosity $n$ (constant), the stretch $\lambda$ and $\gamma_w = \rho_w g$, per volume of liquid,
//! of mixture and of storage,
//!
//! $$\begin{aligned}
//! \rho_w \dot v_w &= \partial_x p - \frac{n \gamma_w}{k} (v_w - v_s) - \rho_w g, \\\\
//! (1-n) \rho_s \dot v_s + n \rho_w \dot v_w &= \partial_x (\sigma' + p) - ((1-n) \rho_s + n \rho_w) g, \\\\
//! \frac{n}{K_w} \dot p &= (1-n) \partial_x v_s + n \partial_x v_w, \qquad k = k_0 \lambda^m,
//! \end{aligned}$$
//!
//! and $\sigma' = E (\lambda - 1)$, $E (1 - 1/\lambda)$ or $E \ln \lambda$. Source: the velocity-velocity
//! formulation of J. van Esch, D. Stolle and I. Jassim 2011 as used by E. Wobbes, M. Möller, V. Galavi and C.
//! Vuik, *Taylor Least Squares reconstruction technique for material point methods*, report 18-2, Delft 2018.
#![doc = include_str!("../../../docs/formulas.html")]

mod consolidation;
mod diffusion;
mod lagrangian_soil;
mod saturated_column;
mod soil;
mod standing_wave;
#[cfg(test)]
mod testing;
mod xie_leo;

use super::ReferenceError;
pub use consolidation::Consolidation;
pub use lagrangian_soil::{LagrangianSoil, SoilEnd, SoilProblem};
pub use saturated_column::SaturatedColumn;
pub use soil::Soil;
pub use standing_wave::StandingWave;
pub use xie_leo::XieLeo;

/// State of a two-phase reference at one material point of the solid.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TwoPhaseState {
    /// Displacement of the solid since time 0, m.
    pub solid_displacement: f64,
    /// Velocity of the solid, m/s.
    pub solid_velocity: f64,
    /// True (not seepage) velocity of the liquid that is there, m/s.
    pub liquid_velocity: f64,
    /// Effective stress, Pa, positive in tension.
    pub effective_stress: f64,
    /// Pore pressure, Pa, positive in tension.
    pub pore_pressure: f64,
}

/// A two-phase solution that material points can be compared with.
pub trait TwoPhaseReference {
    /// Prepares evaluation at `time`, s, at least 0.
    ///
    /// Calling it twice with the same time changes nothing. A closed form only remembers the time; a
    /// converged solution marches its solver, and starts again from 0 where `time` lies before the last one.
    ///
    /// # Errors
    /// [`ReferenceError::InvalidTime`] where `time` is negative or not finite; what else can go wrong is said
    /// by each solution.
    fn advance(&mut self, time: f64) -> Result<(), ReferenceError>;

    /// State, at the time of the last [`advance`](TwoPhaseReference::advance), of the material point of the
    /// solid that was at `x0`, m, at time 0. Before the first `advance` the time is 0.
    fn at(&self, x0: f64) -> TwoPhaseState;
}
