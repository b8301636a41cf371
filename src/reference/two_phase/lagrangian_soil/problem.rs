//! What is to be solved.

use std::fmt;
use std::sync::Arc;

use super::super::Soil;
use crate::reference::{ReferenceError, UniaxialLaw, check};

/// A function of position or time that a column can keep and share with its coarser copy.
pub(super) type Function = Arc<dyn Fn(f64) -> f64 + Send + Sync>;

/// What holds one end of the column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SoilEnd {
    /// Neither solid nor liquid moves.
    Fixed,
    /// The end drains at the pore pressure $\hat p$ and bears the total stress $q$.
    Drained,
}

/// A column of saturated soil, undeformed at time 0.
///
/// Begins with its base, at 0, fixed and its top drained, at rest, without stress, load or weight, at large
/// strain; the methods change that.
///
/// ```
/// # use materialpoint::reference::{Hill, two_phase::{Soil, SoilProblem}};
/// # let soil = Soil { porosity: 0.4, solid_density: 2.6e3, liquid_density: 1e3, liquid_bulk_modulus: 3e7,
/// #     permeability: 1e-3, permeability_exponent: 2.0, gravity: 9.81 };
/// // Weight that grows for a tenth of a second.
/// let problem = SoilProblem::new(1.0, soil, Hill { youngs_modulus: 1e6 })
///     .body_force(|t| -9.81 * (t / 0.1).min(1.0))
///     .kinks(&[0.1]);
/// ```
#[derive(Clone)]
pub struct SoilProblem<L> {
    pub(super) height: f64,
    pub(super) soil: Soil,
    pub(super) law: L,
    pub(super) origin: f64,
    pub(super) small_strain: bool,
    pub(super) ends: [SoilEnd; 2],
    pub(super) load: Function,
    pub(super) pore_load: f64,
    pub(super) body_force: Function,
    /// Times at which load or body force is not smooth, s, in rising order.
    pub(super) kinks: Vec<f64>,
    pub(super) levels: usize,
    /// Velocities of solid and liquid, m/s.
    pub(super) velocities: [Function; 2],
    /// Effective stress and pore pressure, Pa.
    pub(super) stresses: [Function; 2],
}

impl<L> SoilProblem<L> {
    /// A column of `height`, m, with the `law` of its skeleton.
    pub fn new(height: f64, soil: Soil, law: L) -> Self {
        let zero = || -> Function { Arc::new(|_| 0.0) };
        Self {
            height,
            soil,
            law,
            origin: 0.0,
            small_strain: false,
            ends: [SoilEnd::Fixed, SoilEnd::Drained],
            load: zero(),
            pore_load: 0.0,
            body_force: zero(),
            kinks: Vec::new(),
            levels: 0,
            velocities: [zero(), zero()],
            stresses: [zero(), zero()],
        }
    }

    /// Puts the base at `x`, m; default 0.
    pub fn origin(self, x: f64) -> Self {
        Self { origin: x, ..self }
    }

    /// Sets $\lambda = 1$ everywhere but in the law: the geometry does not change.
    pub fn small_strain(self) -> Self {
        Self {
            small_strain: true,
            ..self
        }
    }

    /// Holds the ends; default base fixed, top drained.
    pub fn ends(self, base: SoilEnd, top: SoilEnd) -> Self {
        Self {
            ends: [base, top],
            ..self
        }
    }

    /// Gives the total stress $q$, Pa, of drained ends, as a continuous function of time, s; default 0.
    pub fn load(self, load: impl Fn(f64) -> f64 + Send + Sync + 'static) -> Self {
        Self {
            load: Arc::new(load),
            ..self
        }
    }

    /// Gives the pore pressure $\hat p$, Pa, of drained ends; default 0.
    pub fn pore_load(self, pressure: f64) -> Self {
        Self {
            pore_load: pressure,
            ..self
        }
    }

    /// Gives the body force $b$ on both phases, N/kg (weight is $-g$), as a continuous function of time, s;
    /// default 0.
    pub fn body_force(self, force: impl Fn(f64) -> f64 + Send + Sync + 'static) -> Self {
        Self {
            body_force: Arc::new(force),
            ..self
        }
    }

    /// Names the times, s, at which load or body force is not smooth. The march makes each of them the end of
    /// a step and so keeps its order.
    pub fn kinks(self, times: &[f64]) -> Self {
        let mut kinks = times.to_vec();
        kinks.sort_by(f64::total_cmp);
        Self { kinks, ..self }
    }

    /// Halves the elements at drained ends `levels` times, 0 to 30; default 0.
    ///
    /// For a pore pressure that jumps at a drained end at time 0: the finest elements resolve its first
    /// spreading. They merge one by one when it has spread over the next coarser one, so that they cost
    /// little.
    pub fn levels(self, levels: usize) -> Self {
        Self { levels, ..self }
    }

    /// Gives the initial velocities, m/s, as functions of the height above the base, m; default 0. A fixed
    /// end does not move, whatever they say there.
    pub fn initial_velocities(
        self,
        solid: impl Fn(f64) -> f64 + Send + Sync + 'static,
        liquid: impl Fn(f64) -> f64 + Send + Sync + 'static,
    ) -> Self {
        Self {
            velocities: [Arc::new(solid), Arc::new(liquid)],
            ..self
        }
    }

    /// Gives initial effective stress and pore pressure, Pa, as functions of the height above the base, m;
    /// default 0.
    ///
    /// What the law says is added to the initial effective stress. That is what the rates of the linear and
    /// the logarithmic law say too; Hill's rate depends on the stress.
    pub fn initial_stresses(
        self,
        effective: impl Fn(f64) -> f64 + Send + Sync + 'static,
        pore: impl Fn(f64) -> f64 + Send + Sync + 'static,
    ) -> Self {
        Self {
            stresses: [Arc::new(effective), Arc::new(pore)],
            ..self
        }
    }
}

impl<L: UniaxialLaw> SoilProblem<L> {
    /// Refuses what cannot be marched from time 0.
    pub(super) fn check(&self) -> Result<(), ReferenceError> {
        self.soil.check()?;
        check::positive("height", self.height)?;
        check::finite("origin", self.origin)?;
        check::finite("pore load", self.pore_load)?;
        check::within("levels", self.levels, 0, 30)?;
        for &kink in &self.kinks {
            check::time(kink)?;
        }
        Ok(())
    }
}

impl<L: fmt::Debug> fmt::Debug for SoilProblem<L> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("SoilProblem")
            .field("height", &self.height)
            .field("soil", &self.soil)
            .field("law", &self.law)
            .field("origin", &self.origin)
            .field("small_strain", &self.small_strain)
            .field("ends", &self.ends)
            .field("pore_load", &self.pore_load)
            .field("kinks", &self.kinks)
            .finish_non_exhaustive()
    }
}
