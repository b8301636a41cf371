//! The stepper: one time step of the material point method, for every basis, reconstruction, law and phase.
//!
#![doc = include_str!("../../docs/formulas.html")]
//!
//! Euler-Cromer with modified update stress last (MUSL, Sulsky, Zhou & Schreyer 1995). The list of stages is
//! in `step`, and each stage in the file of its name:
//!
//! 1. `sums`, `fitted`: P2G of $m_i = \sum_p m_p\phi_i(x_p)$ and $f_i = -\int\sigma\nabla\phi_i +
//!    \text{traction}$;
//! 2. `acceleration`: $a_i = f_i/m_i + b$, the prescribed (Dirichlet) value on constrained DOFs;
//! 3. `kick`: G2P of $v_p \mathrel{+}= \Delta t\sum_i\phi_i(x_p) a_i$, the FLIP update, then P2G of the
//!    particles' new momenta;
//! 4. `velocity`: DOF velocities from these, and the impulses of walls that rub (`contact`);
//! 5. `diffusion`, for phases that exchange a scalar: P2G of capacities, contents and fluxes, G2P of rates;
//! 6. `drift`: G2P of position, displacement, $\Delta\varepsilon = \Delta t\sum_i v_i\otimes\nabla\phi_i$,
//!    stress by the law, volume by $\det(1+\Delta\varepsilon)$ at large strain.
//!
//! A transfer from the grid ([`crate::transfer`]) takes other ways in 3 and 4: momenta to the DOFs, the kick
//! there, velocities back to the particles (`from_grid`).
//!
//! With a liquid that flows through the pores the same stages take both phases together (`liquid` has the
//! second balance).
//!
//! Basis values of all stages are taken at the positions at the start of the step. Velocity lives half a step
//! early: started from $v(0)$, after $n$ steps it approximates $v(n\Delta t - \Delta t/2)$, to first order
//! because the first kick is a whole step, or to second order if that is half a step
//! ([`Stepper::step_with_kick`]).

mod acceleration;
mod balance;
mod body_forces;
mod bound;
mod checkpoint;
mod contact;
mod critical;
mod deflation;
mod diagnostics;
mod diffusion;
mod dofs;
mod domain;
mod drift;
mod faces;
mod fitted;
mod forces;
mod forcing;
mod from_grid;
mod ghost;
mod inner;
mod kick;
mod liquid;
mod material_fields;
mod matrix;
mod order;
mod pairs;
mod parts;
mod polynomial;
mod relax;
mod series;
mod setup;
mod simulation;
mod spans;
mod stages;
mod step;
mod sums;
mod sweeps;
mod velocity;
mod waves;
mod window;

pub use contact::WallImpulse;
pub use critical::{CriticalStep, Mechanism};
pub use diagnostics::{Conservation, Diagnostics, Energy};
pub use forcing::{DiffusionCondition, FaceCondition, Forcing, PoreCondition, SurfacePoint};
pub use material_fields::MaterialFields;
pub use setup::Setup;
pub use simulation::Simulation;

use std::fmt;

use nalgebra::SVector;

use crate::basis::{BasisFamily, FixedPoints};
use crate::error::{SetupError, StepError};
use crate::grid::Grid;
use crate::law::LawSweep;
use crate::mass::{Divides, MassModel};
use crate::particles::{Bins, Outside, Particles};
use crate::phase::Phase;
use crate::reconstruction::{Cloud, Cut, Filters, Reconstruction, Streams};
use crate::scalar::Scalar;
use crate::simd::packs_serve;
use crate::transfer::{self, Flip, Transfer};
use inner::{Given, Inner, Kind};
use step::send_step;

/// Steps particles through time. See the [module](self) for the algorithm.
#[derive(Clone)]
pub struct Stepper<T, const D: usize, B, R, L: LawSweep<T, D>, P: Phase<T, D>, X: Transfer<T, D> = Flip>
where
    T: Scalar,
    R: Reconstruction<T, D>,
{
    basis: B,
    reconstruction: R,
    /// As the setup said it.
    velocity_mass: R::Mass,
    /// All else, of which most stages are.
    inner: Inner<T, D, L, P, X>,
}

impl<T, const D: usize, B, R, L, P, X> fmt::Debug for Stepper<T, D, B, R, L, P, X>
where
    T: Scalar,
    B: fmt::Debug,
    R: Reconstruction<T, D> + fmt::Debug,
    L: LawSweep<T, D> + fmt::Debug,
    L::Number: fmt::Debug,
    P: Phase<T, D> + fmt::Debug,
    P::Particle: fmt::Debug,
    X: Transfer<T, D> + fmt::Debug,
    X::Particle: fmt::Debug,
{
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Stepper")
            .field("basis", &self.basis)
            .field("reconstruction", &self.reconstruction)
            .field("velocity_mass", &self.velocity_mass)
            .field("inner", &self.inner)
            .finish()
    }
}

impl<T, const D: usize, B, R, L, P, X> Stepper<T, D, B, R, L, P, X>
where
    T: Scalar,
    B: BasisFamily<T, D>,
    R: Reconstruction<T, D>,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
    X: Transfer<T, D>,
{
    /// Checks particles and phase and allocates all that steps will need.
    ///
    /// # Errors
    /// If particle data are inconsistent or not finite or a stress unknown to the law, a particle is outside
    /// the grid or larger than the basis allows ([`Domain`](crate::basis::Domain)), a constant of the phase
    /// makes no sense, or beyond one axis the reconstruction is of one phase only or wants a basis that is
    /// one polynomial of its degree in each cell ([`ParticleMatrix`](crate::mass::ParticleMatrix)).
    pub fn new(setup: Setup<T, D, B, R, L, P, X>) -> Result<Self, SetupError> {
        const {
            crate::basis::constants_agree::<T, D, B>();
            crate::reconstruction::constants_agree::<T, D, R>();
            crate::phase::constants_agree::<T, D, P>();
            transfer::constants_agree::<T, D, X>();
        };
        let Setup {
            grid,
            basis,
            reconstruction,
            law,
            phase,
            transfer,
            velocity_mass,
            particles,
            memory,
            surface,
        } = setup;
        let given = Given {
            grid,
            law,
            phase,
            transfer,
            particles,
            memory,
            surface,
        };
        Self::of_parts(basis, reconstruction, velocity_mass, given)
    }

    /// The same of a setup taken apart.
    fn of_parts(
        basis: B,
        reconstruction: R,
        velocity_mass: R::Mass,
        given: Given<T, D, L, P, X>,
    ) -> Result<Self, SetupError> {
        let kind = Kind {
            mass: velocity_mass.divisor(),
            filters: R::Filter::FILTERS,
        };
        let mut stepper = Self {
            inner: Inner::new(&basis, given, kind)?,
            basis,
            reconstruction,
            velocity_mass,
        };
        if P::FLOWS {
            R::Filter::suit_liquid(&mut stepper.reconstruction);
        }
        stepper.inner.allocate_dofs(&stepper.basis);
        stepper.allocate();
        Ok(stepper)
    }

    /// Lets reconstruction and basis see the particles and stream the widest values once, so that all they
    /// allocate is there before the first step: [`Stepper::bytes`] is right from the start.
    fn allocate(&mut self) {
        self.prepare();
        let kept = if self.batched() { R::Points::KEPT } else { 0 };
        self.inner.allocate_spans(R::Points::IN_CELLS, kept);
        if const { R::Mass::OF_PARTICLES } {
            return;
        }
        if const { P::FLOWS } {
            self.map_both_before(T::zero(), &Forcing::none());
            self.inner.liquid.velocity.fill(SVector::zeros());
        } else {
            self.map_momenta();
        }
        self.inner.dofs.velocity.fill(SVector::zeros());
    }

    /// One step of size `dt` (s) under `forcing`, the loads and boundary values of this step.
    ///
    /// With the feature `rayon` threads share a step of many particles or cells: those of the caller's pool,
    /// or of the global one, to which a caller that belongs to none sends the whole step. Any number of them
    /// gives the bits of one.
    ///
    /// # Errors
    /// If a particle leaves the grid, its volume is no longer a positive number or its stress unknown to the
    /// law: the particles then hold the state in which that was noticed. If the step's size makes no sense,
    /// or `forcing` has a condition that the phase does not know (a pore pressure where no liquid flows) or a
    /// wall that the basis would let slip: nothing has moved then.
    pub fn step(&mut self, dt: T, forcing: &Forcing<T, D>) -> Result<(), StepError> {
        self.step_with_kick(dt, dt, forcing)
    }

    /// The same with velocities that gain `kick` (s) times their accelerations, while positions and strains
    /// go on by `dt` (s).
    ///
    /// Velocities live in the middle of steps: the kick from the middle of the step before, of size `before`,
    /// to that of this one is `(before + dt) / 2`, of second order also where steps change, and `dt / 2` in
    /// the first step of a run, whose velocities are those of time zero. [`Stepper::step`] takes `dt` always,
    /// as the papers do: then the velocities given at the start count as those of half a step before.
    ///
    /// # Errors
    /// Those of [`Stepper::step`]; the kick too must be positive and finite.
    pub fn step_with_kick(&mut self, kick: T, dt: T, forcing: &Forcing<T, D>) -> Result<(), StepError> {
        send_step(self, [kick, dt], forcing, false).map(|_| ())
    }

    /// The same, and the energy at the step's start: see [`Energy`]. Takes memory for the velocities before
    /// the step.
    ///
    /// # Errors
    /// As those of [`Stepper::step_with_kick`].
    pub fn step_and_measure(
        &mut self,
        kick: T,
        dt: T,
        forcing: &Forcing<T, D>,
    ) -> Result<Energy<T>, StepError> {
        send_step(self, [kick, dt], forcing, true)
    }

    /// Takes in where the particles are.
    #[inline(never)]
    fn prepare(&mut self) {
        self.inner.begin_step(&self.basis);
        let fits = !R::Points::AT_PARTICLES;
        if fits || B::TAKES_IN_CELLS {
            self.inner.bins.list(&self.inner.grid);
        }
        if const { B::TAKES_IN_CELLS } {
            self.basis.take_in(&self.inner.grid, &self.inner.bins);
        }
        self.inner
            .spans
            .refresh(&self.basis, &self.inner.grid, &self.inner.bins, fits);
        if fits {
            self.inner.cut_cells();
        }
        if self.batched() && !R::Points::NON_LOCAL {
            return;
        }
        let cloud = cloud(
            &self.inner.grid,
            &self.inner.bins,
            &self.inner.particles,
            &self.inner.cuts,
        );
        self.reconstruction.prepare(&cloud);
        let reduced = self.reconstruction.reduced_cells();
        self.inner.diagnostics.record_reduced(reduced);
        self.inner
            .diagnostics
            .record_virtual(self.reconstruction.virtual_cells());
    }

    /// Whether fits are made and integrated for four cells at a time, so that nothing of them need be kept.
    fn batched(&self) -> bool {
        let can = const { transfer::fit::<T, D, B, R>() };
        can && self.is_wide_enough()
            && packs_serve::<T>()
            && (1..=transfer::MOST_POINTS).contains(&R::Points::line(&self.reconstruction).count())
    }

    /// Whether the functions that fits are integrated with all are of DOFs that there are: a stencil may be
    /// wider than the grid.
    fn is_wide_enough(&self) -> bool {
        let linear = const { matches!(B::AT_FIXED_POINTS, FixedPoints::Linear) };
        linear
            || self
                .basis
                .dofs(&self.inner.grid)
                .iter()
                .all(|&count| count >= B::WIDTH)
    }

    /// The particles, in the order in which they are kept: see [`Stepper::numbers`].
    pub fn particles(&self) -> &Particles<T, D, L::Number, P::Particle> {
        &self.inner.particles
    }

    /// For each of [`Stepper::particles`] its number in the order in which the [`Setup`] gave them; `None`
    /// while that is the order. In two and three dimensions particles are put in the order of their cells, at
    /// the start and again as they move, in one dimension only where they start without any.
    /// [`Simulation::particles`] gives them back in their first order, and errors name their first numbers.
    pub fn numbers(&self) -> Option<&[u32]> {
        self.inner.order.numbers()
    }

    /// The grid.
    pub fn grid(&self) -> &Grid<T, D> {
        &self.inner.grid
    }

    /// The constitutive law.
    pub fn law(&self) -> &L {
        &self.inner.law
    }

    /// Time reached (s).
    pub fn time(&self) -> T {
        self.inner.time
    }

    /// Steps taken.
    pub fn steps(&self) -> usize {
        self.inner.steps
    }

    /// Number of DOFs.
    pub fn dof_count(&self) -> usize {
        self.inner.dofs.mass.len()
    }

    /// Velocities of the DOFs in the last step (m/s).
    pub fn dof_velocities(&self) -> &[SVector<T, D>] {
        &self.inner.dofs.velocity
    }

    /// What was counted and measured so far.
    pub fn diagnostics(&self) -> &Diagnostics<T> {
        &self.inner.diagnostics
    }

    /// Bytes of the stepper and of all that it allocates: particles, their cells, what basis and
    /// reconstruction hold, DOFs. Steps allocate nothing beyond, but the first one in which walls rub that
    /// did not before, and where particles move so far through a large grid that its
    /// [`Window`](crate::grid::Window) moves with them.
    pub fn bytes(&self) -> usize {
        // What they hold of themselves is in it.
        let own = size_of::<Self>() - size_of_val(&self.inner);
        own + self.inner.bytes() + self.basis.bytes() + self.reconstruction.bytes()
    }

    /// [`Stepper::bytes`] over the number of particles.
    pub fn bytes_per_particle(&self) -> f64 {
        self.bytes() as f64 / self.inner.particles.len() as f64
    }
}

/// Checks particles and what they are made of.
#[inline(never)]
fn check_material<T: Scalar, const D: usize, L: LawSweep<T, D>, P: Phase<T, D>>(
    law: &L,
    phase: &P,
    particles: &Particles<T, D, L::Number, P::Particle>,
) -> Result<(), SetupError> {
    particles.validate_with(law.numbers())?;
    phase.validate()?;
    refuse_unknown_stress(law, particles)?;
    diffusion::refuse_without_capacity(phase, particles)
}

/// Checks where surfaces and particles are, and moves the latter off the edges of their cells.
#[inline(never)]
fn find_cells<T: Scalar, const D: usize>(
    grid: &Grid<T, D>,
    surface: &[SurfacePoint<T>],
    positions: &mut [SVector<T, D>],
) -> Result<Bins<D>, SetupError> {
    for point in surface {
        point.validate::<D>(positions.len())?;
    }
    let bins = Bins::without_lists(grid, positions).map_err(|Outside(particle)| SetupError::Outside {
        particle,
        position: values(&positions[particle]),
    })?;
    for (cell, x) in bins.cells().iter().zip(positions) {
        grid.nudge_off_edges(cell, x);
    }
    Ok(bins)
}

/// Refuses a particle whose stress has no meaning to the law.
fn refuse_unknown_stress<T: Scalar, const D: usize, L: LawSweep<T, D>, P>(
    law: &L,
    particles: &Particles<T, D, L::Number, P>,
) -> Result<(), SetupError> {
    let mut stresses = particles.stress.iter().enumerate();
    match stresses.position(|(p, stress)| !law.knows(stress, law.of(&particles.state, p))) {
        None => Ok(()),
        Some(particle) => Err(SetupError::Value {
            particle,
            name: "stress",
            value: particles.stress[particle][(0, 0)].primal(),
            allowed: law.limits(),
        }),
    }
}

/// Refuses sizes of a step that make no sense, and conditions that a liquid that flows, a phase that diffuses
/// or a transfer from the grid does not know.
#[inline(never)]
fn refuse_bad_step<T: Scalar, const D: usize>(
    [kick, dt]: [T; 2],
    forcing: &Forcing<T, D>,
    [flows, diffuses, from_grid]: [bool; 3],
    left_out: &[Option<usize>],
) -> Result<(), StepError> {
    for size in [dt, kick] {
        if !size.is_finite() || size <= T::zero() {
            let value = size.primal();
            return Err(StepError::StepSize { value });
        }
    }
    forcing.suits_phase([flows, diffuses])?;
    if from_grid {
        from_grid::refuse_walls_that_rub(forcing)?;
    }
    faces::walls_can_be_held(forcing, left_out)
}

/// The error of a particle that left the grid, of which number and place are known.
#[cold]
#[inline(never)]
fn left<T: Scalar, const D: usize>(step: usize, particle: usize, position: &SVector<T, D>) -> StepError {
    let position = values(position);
    match position.iter().find(|x| !x.is_finite()) {
        Some(&value) => StepError::Invalid {
            step,
            particle,
            name: "position",
            value,
        },
        None => StepError::LeftGrid {
            step,
            particle,
            position,
        },
    }
}

/// The particles as a reconstruction sees them. A function of the parts, so that the rest of a stepper stays
/// free to change.
fn cloud<'a, T: Scalar, const D: usize, S, P>(
    grid: &'a Grid<T, D>,
    bins: &'a Bins<D>,
    particles: &'a Particles<T, D, S, P>,
    cuts: &'a [Cut<T>],
) -> Cloud<'a, T, D> {
    Cloud {
        grid,
        bins,
        positions: &particles.position,
        volumes: &particles.volume,
        cuts,
    }
}

/// A vector as plain numbers, for messages.
fn values<T: Scalar, const D: usize>(x: &SVector<T, D>) -> Vec<f64> {
    x.iter().map(|v| v.primal()).collect()
}
