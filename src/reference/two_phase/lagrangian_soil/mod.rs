//! Converged solutions of saturated soil in the reference configuration.

mod error_estimate;
mod exponential;
mod fields;
mod mesh;
mod operator;
mod phi;
mod problem;
#[cfg(test)]
mod tests;

use super::{Soil, TwoPhaseReference, TwoPhaseState};
use crate::reference::{ReferenceError, Resolution, UniaxialLaw, check};
use exponential::{Exponential, STABILITY_LIMIT};
use fields::Fields;
use operator::{Loads, Operator};
pub use problem::{SoilEnd, SoilProblem};

/// Part of the stable step of the waves that is taken. The frequency is bounded for the state at the start of
/// the step, and the drag of the nodes is not the only thing that couples the phases, so something must be
/// left.
const STEP_FRACTION: f64 = 0.7;

/// Elements merge when the pore pressure has spread over this many of the merged ones, squared.
const MERGER: f64 = 1.0;

/// Resolution of the consolidation. In report 18-2's large-strain benchmark the settlement then changes by
/// 1e-5 under refinement.
const CONSOLIDATION: Resolution = Resolution {
    elements: 16,
    degree: 6,
};
/// With it, the finest element is 1/512 of the height.
const CONSOLIDATION_LEVELS: usize = 5;

/// A converged solution of saturated soil with inertia of both phases, in the reference configuration.
///
/// With the material coordinate $X$ of the solid, its stretch $\lambda = 1 + u'$, a prime for the derivative
/// to $X$ and a body force $b$,
///
/// $$\begin{aligned} \rho_w \dot v_w &= \frac{p'}{\lambda} - \frac{n \gamma_w}{k} (v_w - v_s) + \rho_w b, & k
/// &= k_0 \lambda^m, \\\\ (1-n) \rho_s \dot v_s + n \rho_w \lambda \dot v_w &= (\sigma' + p)' + ((1-n)
/// \rho_s + n \rho_w \lambda) b, &
///     \sigma' &= \sigma'(\lambda), \\\\
/// \dot p &= \frac{K_w}{n \lambda} ((1-n) v_s' + n v_w'), & \dot u &= v_s.
/// \end{aligned}$$
///
/// These are the equations of the [module](super) as the method solves them: the porosity is constant, and
/// the liquid is not advected relative to the solid. At small strain $\lambda = 1$ outside the law. Ends are
/// fixed and impermeable, or drained with $\sigma' + p = q(t)$ and $p = \hat p$, both natural.
///
/// Displacement and velocities are continuous on spectral elements, Lagrange polynomials on
/// Gauss-Lobatto-Legendre nodes with quadrature on the same nodes, so all masses are diagonal; the pore
/// pressure belongs to the nodes of each element. Source: C. Canuto, M. Y. Hussaini, A. Quarteroni, T. A.
/// Zang, *Spectral Methods*, Springer 2006. Time is marched by an exponential Runge-Kutta method (M.
/// Hochbruck and A. Ostermann, SIAM J. Numer. Anal. 43, 2005) that is exact in the drag: the step follows
/// from the waves alone, at any permeability.
///
/// How good a solution is, [`error_estimate`](LagrangianSoil::error_estimate) says. Where a pore pressure
/// jumps at a drained end at time 0, [`levels`](SoilProblem::levels) of finer elements resolve its first
/// spreading.
#[doc = include_str!("../../../../docs/formulas.html")]
///
/// ```
/// # use materialpoint::reference::{Logarithmic, ReferenceError};
/// # use materialpoint::reference::two_phase::{LagrangianSoil, Soil, TwoPhaseReference};
/// let soil = Soil {
///     porosity: 0.4,
///     solid_density: 2.6e3,
///     liquid_density: 1e3,
///     liquid_bulk_modulus: 3e7,
///     permeability: 3.68e-4,
///     permeability_exponent: 2.0,
///     gravity: 9.81,
/// };
/// let mut layer = LagrangianSoil::consolidation(1.0, -5e5, soil, Logarithmic { youngs_modulus: 1e6 })?;
/// layer.advance(1e-3)?;
/// assert!(layer.at(1.0).solid_displacement < 0.0);
/// # Ok::<(), ReferenceError>(())
/// ```
#[derive(Clone, Debug)]
pub struct LagrangianSoil<L> {
    problem: SoilProblem<L>,
    resolution: Resolution,
    operator: Operator,
    integrator: Exponential,
    /// How often the elements at drained ends are halved now.
    level: usize,
    time: f64,
    fields: Fields,
    /// The same problem with half the elements, once an estimate was asked for.
    coarse: Option<Box<LagrangianSoil<L>>>,
}

impl<L: UniaxialLaw + Clone> LagrangianSoil<L> {
    /// The solution of `problem` with the given `resolution`, at time 0.
    ///
    /// # Errors
    /// Where a parameter is out of range, an initial value is not finite, or the stiffness of the undeformed
    /// skeleton is not positive.
    pub fn new(problem: SoilProblem<L>, resolution: Resolution) -> Result<Self, ReferenceError> {
        problem.check()?;
        let level = problem.levels;
        let operator = Operator::new(&problem, resolution.check()?, level)?;
        let fields = initial_fields(&problem, &operator)?;
        operator.largest_frequency(&problem.law, 0.0, &fields.displacement)?;
        let integrator = Exponential::new(operator.mesh.node_count(), operator.mesh.point_count());
        Ok(Self {
            problem,
            resolution,
            operator,
            integrator,
            level,
            time: 0.0,
            fields,
            coarse: None,
        })
    }

    /// Consolidation at large strain: a layer of initial `height`, m, with a fixed base and a drained top,
    /// under `load`, Pa (negative in compression), which the liquid carries at first.
    ///
    /// With the logarithmic law and the permeability $k_0 \lambda^2$, this is the solution that
    /// [`XieLeo`](super::XieLeo) with a compressible liquid has without inertia, and what inertia adds.
    /// Within about $1/\beta$, $\beta = (n g/k) (1 + n \rho_w / ((1-n) \rho_s))$, the jump at the drained end
    /// travels as a shock that nothing but the drag dissipates, and sets off the undrained wave, which may
    /// ring for long. Shock and wave converge slowly: in report 18-2's benchmark, with $k_0$ = 3.68e-4 m/s,
    /// the wave at 0.4 s moves the top by 3e-5 m, 5e-4 of the settlement, and the error estimate is 1e-3. A
    /// load that grows smoothly has none of this.
    ///
    /// # Errors
    /// As [`new`](LagrangianSoil::new).
    pub fn consolidation(height: f64, load: f64, soil: Soil, law: L) -> Result<Self, ReferenceError> {
        check::finite("load", load)?;
        let problem = SoilProblem::new(height, soil, law)
            .load(move |_| load)
            .initial_stresses(|_| 0.0, move |_| load)
            .levels(CONSOLIDATION_LEVELS);
        Self::new(problem, CONSOLIDATION)
    }

    /// The same problem with another `resolution`, at time 0.
    ///
    /// # Errors
    /// As [`new`](LagrangianSoil::new).
    pub fn with_resolution(self, resolution: Resolution) -> Result<Self, ReferenceError> {
        Self::new(self.problem, resolution)
    }

    /// The same problem with its base at `origin`, m, at time 0.
    ///
    /// # Errors
    /// Where `origin` is not finite.
    pub fn with_origin(self, origin: f64) -> Result<Self, ReferenceError> {
        Self::new(self.problem.origin(origin), self.resolution)
    }

    /// Elements and degree.
    pub fn resolution(&self) -> Resolution {
        self.resolution
    }

    /// Marches to `end`, s, through an interval in which load and body force are smooth.
    fn march(&mut self, end: f64) -> Result<(), ReferenceError> {
        while self.time < end {
            let step = self.next_step(end)?;
            let (problem, operator) = (&self.problem, &self.operator);
            self.integrator
                .step(self.time, &mut self.fields, step, |time, fields, out| {
                    let loads = Loads {
                        time,
                        load: check::finite("load", (problem.load)(time))?,
                        body_force: check::finite("body force", (problem.body_force)(time))?,
                    };
                    operator.rates(&problem.law, loads, fields, out)
                })?;
            // Rounding may carry the last step past the end, where asking for it again would mean going back.
            self.time = (self.time + step).min(end);
        }
        Ok(())
    }

    /// The next kink of load or body force, s, or the time to coarsen, or `time` where that comes first.
    fn next_stop(&self, time: f64) -> f64 {
        let ahead = |kink: &f64| *kink > self.time && *kink < time;
        let stop = self.problem.kinks.iter().copied().find(ahead).unwrap_or(time);
        if self.level > 0 {
            stop.min(self.merge_time())
        } else {
            stop
        }
    }

    /// When the pore pressure has spread over the elements that the next merger makes, s.
    fn merge_time(&self) -> f64 {
        let SoilProblem {
            height, soil, law, ..
        } = &self.problem;
        let halvings = i32::try_from(self.level).unwrap_or(i32::MAX) - 1;
        let size = height / self.resolution.elements as f64 / 2.0_f64.powi(halvings);
        MERGER * size * size / soil.consolidation_coefficient(law.stiffness(1.0))
    }

    /// Merges the finest elements, where it is time.
    fn coarsen(&mut self) -> Result<(), ReferenceError> {
        while self.level > 0 && self.time >= self.merge_time() {
            self.level -= 1;
            let coarser = Operator::new(&self.problem, self.resolution, self.level)?;
            self.fields = coarser.transfer(&self.operator, &self.fields);
            self.integrator = Exponential::new(coarser.mesh.node_count(), coarser.mesh.point_count());
            self.operator = coarser;
        }
        Ok(())
    }

    /// The next step, s, of equal ones that reach `end`.
    fn next_step(&self, end: f64) -> Result<f64, ReferenceError> {
        let (law, time) = (&self.problem.law, self.time);
        let frequency = self
            .operator
            .largest_frequency(law, time, &self.fields.displacement)?;
        let limit = STEP_FRACTION * STABILITY_LIMIT / frequency;
        if limit > 4.0 * f64::EPSILON * end {
            Ok((end - time) / ((end - time) / limit).ceil())
        } else {
            Err(ReferenceError::StepTooSmall { time, step: limit })
        }
    }

    /// Refuses a state that the march would only notice in its next step.
    fn check_state(&self) -> Result<(), ReferenceError> {
        let Fields {
            displacement,
            solid,
            liquid,
            pressure,
        } = &self.fields;
        self.operator
            .largest_frequency(&self.problem.law, self.time, displacement)?;
        for values in [solid, liquid] {
            if let Some(node) = values.iter().position(|velocity| !velocity.is_finite()) {
                return Err(ReferenceError::InvalidVelocity {
                    time: self.time,
                    position: self.operator.mesh.node(node),
                    velocity: values[node],
                });
            }
        }
        for &pressure in pressure {
            check::finite("pore pressure", pressure)?;
        }
        Ok(())
    }
}

impl<L: UniaxialLaw + Clone> TwoPhaseReference for LagrangianSoil<L> {
    /// Marches from the last time to `time`.
    ///
    /// # Errors
    /// Where `time` is negative or not finite, load or body force is not finite, or the skeleton is turned
    /// inside out, loses its stiffness or leaves the finite numbers. The state then is that of the last step
    /// that succeeded.
    fn advance(&mut self, time: f64) -> Result<(), ReferenceError> {
        check::time(time)?;
        if time < self.time {
            let coarse = self.coarse.take();
            *self = Self::new(self.problem.clone(), self.resolution)?;
            self.coarse = coarse;
        }
        while self.time < time {
            self.march(self.next_stop(time))?;
            self.coarsen()?;
        }
        self.check_state()
    }

    /// Beyond the ends, the state of the nearer end.
    fn at(&self, x0: f64) -> TwoPhaseState {
        self.operator
            .state(&self.problem.law, &self.fields, x0 - self.problem.origin)
    }
}

/// The undeformed column with its initial velocities and pore pressure.
fn initial_fields<L>(problem: &SoilProblem<L>, operator: &Operator) -> Result<Fields, ReferenceError> {
    let mesh = &operator.mesh;
    let mut fields = Fields::zeros(mesh.node_count(), mesh.point_count());
    let [solid, liquid] = &problem.velocities;
    for (values, given) in [(&mut fields.solid, solid), (&mut fields.liquid, liquid)] {
        for (node, value) in values.iter_mut().enumerate() {
            *value = check::finite("initial velocity", given(mesh.node(node)))?;
        }
        operator.hold(values);
    }
    let [_, pore] = &problem.stresses;
    for (point, value) in fields.pressure.iter_mut().enumerate() {
        *value = check::finite("initial pore pressure", pore(mesh.point(point)))?;
    }
    Ok(fields)
}
