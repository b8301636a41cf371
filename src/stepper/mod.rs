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

use nalgebra::{SMatrix, SVector};

use crate::basis::{BasisFamily, FixedPoints};
use crate::error::{SetupError, StepError};
use crate::grid::{Cell, Grid};
use crate::law::LawSweep;
use crate::mass::{Divides, Divisor, MassModel};
use crate::parallel::{CELLS, PARTICLES, are_many, within_pool};
use crate::particles::{Bins, Outside, Particles};
use crate::phase::Phase;
use crate::reconstruction::{Cloud, CourantNumbers, Cut, Filters, Reconstruction, Streams};
use crate::scalar::Scalar;
use crate::simd::{LANES, packs_serve};
use crate::transfer::{self, DofPlaces, Flip, Transfer};
use dofs::Dofs;
use order::Order;
use pairs::Pairs;
use spans::{SCALARS, Spans, VECTORS};

/// Steps particles through time. See the [module](self) for the algorithm.
#[derive(Clone, Debug)]
pub struct Stepper<T, const D: usize, B, R, L: LawSweep<T, D>, P: Phase<T, D>, X: Transfer<T, D> = Flip>
where
    T: Scalar,
    R: Reconstruction<T, D>,
{
    grid: Grid<T, D>,
    basis: B,
    reconstruction: R,
    law: L,
    phase: P,
    transfer: X,
    particles: Particles<T, D, L::Number, P::Particle>,
    /// What the transfer remembers of each particle.
    memory: Vec<X::Particle>,
    surface: Vec<SurfacePoint<T>>,
    bins: Bins<D>,
    order: Order,
    /// Where the surfaces cut cells.
    cuts: Vec<Cut<T>>,
    /// The solid's DOFs; in one phase the only ones.
    dofs: Dofs<T, D>,
    /// The liquid's, empty where none flows.
    liquid: Dofs<T, D>,
    /// Drag of the DOFs (kg/s in 3-D), empty where no liquid flows.
    drag: Vec<T>,
    /// What diffuses, of no DOF where nothing does.
    diffusion: diffusion::Diffusion<T>,
    /// Of no DOF but for a liquid that flows with the particles' consistent matrices.
    joint: liquid::Joint<T, D>,
    /// What surfaces demand that the liquid does not pass.
    seal: liquid::Seal<T>,
    /// Where DOFs lie; of none but for a transfer from the grid.
    places: DofPlaces<T, D>,
    spans: Spans<T, D>,
    /// Whether a particle came near the border of the grid's window.
    strayed: bool,
    /// Part of each occupied cell that a wave crosses in this step; empty where nothing relaxes.
    crossed: Vec<CourantNumbers<T>>,
    /// Stresses as the relaxation would have them; empty but for laws that remember.
    relaxed: Vec<SMatrix<T, D, D>>,
    balance: balance::Balance<T, D>,
    /// Contact with walls that rub.
    contact: contact::WallContact<T, D>,
    /// What the particles of a cell add to their matrix.
    pairs: Pairs<T, D>,
    /// Force per mass of each particle; empty where there is none but the uniform one.
    body_forces: Vec<SVector<T, D>>,
    /// DOFs of each face, in the order of [`Face::all`].
    face_dofs: Vec<Vec<u32>>,
    /// Of each a DOF that has a value there and is not among them.
    left_out: Vec<Option<usize>>,
    /// As the setup said it.
    velocity_mass: R::Mass,
    mass: Divisor,
    time: T,
    steps: usize,
    diagnostics: Diagnostics<T>,
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
    pub fn new(mut setup: Setup<T, D, B, R, L, P, X>) -> Result<Self, SetupError> {
        const {
            crate::basis::constants_agree::<T, D, B>();
            crate::reconstruction::constants_agree::<T, D, R>();
            crate::phase::constants_agree::<T, D, P>();
            transfer::constants_agree::<T, D, X>();
        };
        // While the setup is whole: what frees its parts one by one, where one of many tests fails, is else
        // compiled for every stepper.
        let (bins, places) = take_in(&mut setup)?;
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
        let along = basis.degree() + 1;
        let parts = Parts::new(
            &grid,
            bins,
            &particles.mass,
            Counts {
                surface: surface.len(),
                crossed: if R::Filter::FILTERS { grid.cell_count() } else { 0 },
                relaxed: match R::Filter::FILTERS && law.remembers() {
                    true => particles.len(),
                    false => 0,
                },
                functions: [along, along.pow(D as u32 - 1)],
                flows: P::FLOWS,
                pairs: R::Mass::IN_ACCELERATION,
            },
        );
        let mut stepper = Self {
            grid,
            basis,
            reconstruction,
            law,
            phase,
            transfer,
            particles,
            memory,
            surface,
            bins: parts.bins,
            order: parts.order,
            cuts: parts.cuts,
            dofs: parts.dofs,
            liquid: parts.liquid,
            drag: Vec::new(),
            diffusion: diffusion::Diffusion::none(),
            joint: parts.joint,
            seal: parts.seal,
            places,
            spans: parts.spans,
            strayed: false,
            crossed: parts.crossed,
            relaxed: parts.relaxed,
            balance: parts.balance,
            contact: parts.contact,
            pairs: parts.pairs,
            body_forces: Vec::new(),
            face_dofs: Vec::new(),
            left_out: Vec::new(),
            velocity_mass,
            mass: velocity_mass.divisor(),
            time: T::zero(),
            steps: 0,
            diagnostics: parts.diagnostics,
        };
        if P::FLOWS {
            R::Filter::suit_liquid(&mut stepper.reconstruction);
        }
        stepper.allocate_dofs();
        stepper.allocate();
        Ok(stepper)
    }

    /// Makes the DOFs of the grid's window.
    fn allocate_dofs(&mut self) {
        self.contact.forget();
        let (basis, grid) = (&self.basis, &self.grid);
        self.dofs = Dofs::new(basis, grid, self.mass);
        if P::FLOWS {
            self.liquid = Dofs::new(basis, grid, self.mass);
            let count = basis.dof_count(grid);
            self.drag = vec![T::zero(); count];
            if R::Mass::IN_ACCELERATION {
                self.joint = liquid::Joint::new(basis, grid, self.particles.len());
            }
        }
        if X::FROM_GRID || (R::Mass::SERIES && D > 1) {
            self.places.follow(basis, grid);
        }
        if P::DIFFUSES {
            self.diffusion = diffusion::Diffusion::new(basis.dof_count(grid));
        }
        (self.face_dofs, self.left_out) = faces::face_dofs(basis, grid);
    }

    /// Lets reconstruction and basis see the particles and stream the widest values once, so that all they
    /// allocate is there before the first step: [`Stepper::bytes`] is right from the start.
    fn allocate(&mut self) {
        self.prepare();
        let dofs = self.dofs.mass.len();
        let each = match (P::FLOWS, P::DIFFUSES) {
            (true, _) => [SCALARS, VECTORS],
            (false, true) => [diffusion::SCALARS, 1],
            (false, false) => [1, 1],
        };
        self.spans.allocate(each, R::Points::IN_CELLS, dofs);
        if self.batched() {
            let cells = self.particles.len().min(self.grid.cell_count());
            let numbers = cells.div_ceil(LANES) * R::Points::KEPT;
            self.spans.kept.reserve_exact(numbers);
        }
        if const { R::Mass::OF_PARTICLES } {
            return;
        }
        if const { P::FLOWS } {
            self.map_both_before(T::zero(), &Forcing::none());
            self.liquid.velocity.fill(SVector::zeros());
        } else {
            self.map_momenta();
        }
        self.dofs.velocity.fill(SVector::zeros());
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
        self.send_step([kick, dt], forcing, false).map(|_| ())
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
        self.send_step([kick, dt], forcing, true)
    }

    /// Takes a step in the pool of threads if it is worth that; the energy means nothing unless it is to be
    /// measured.
    fn send_step(
        &mut self,
        [kick, dt]: [T; 2],
        forcing: &Forcing<T, D>,
        measure: bool,
    ) -> Result<Energy<T>, StepError> {
        let kinds = [P::FLOWS, P::DIFFUSES, X::FROM_GRID];
        refuse_bad_step([kick, dt], forcing, kinds, &self.left_out)?;
        let mut outcome = Ok(Energy::none());
        within_pool(self.is_worth_sending(), &mut || {
            outcome = self.step_here([kick, dt], forcing, measure);
        });
        outcome
    }

    /// Whether a step is worth being sent to a pool of threads.
    fn is_worth_sending(&self) -> bool {
        let cells = match R::Points::AT_PARTICLES {
            true => 0,
            false => self.bins.occupied().len(),
        };
        are_many::<D>(self.particles.len(), PARTICLES) || are_many::<D>(cells, CELLS)
    }

    /// Takes in where the particles are.
    #[inline(never)]
    fn prepare(&mut self) {
        self.spans.fresh = false;
        if self.strayed {
            self.follow_particles();
        }
        if self.order.is_lost() {
            self.restore_order();
        }
        let fits = !R::Points::AT_PARTICLES;
        if fits || B::TAKES_IN_CELLS {
            self.bins.list(&self.grid);
        }
        if const { B::TAKES_IN_CELLS } {
            self.basis.take_in(&self.grid, &self.bins);
        }
        self.spans.refresh(&self.basis, &self.grid, &self.bins, fits);
        if fits {
            self.cut_cells();
        }
        if self.batched() && !R::Points::NON_LOCAL {
            return;
        }
        let cloud = cloud(&self.grid, &self.bins, &self.particles, &self.cuts);
        self.reconstruction.prepare(&cloud);
        let reduced = self.reconstruction.reduced_cells();
        self.diagnostics.record_reduced(reduced);
        self.diagnostics
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
        linear || self.basis.dofs(&self.grid).iter().all(|&count| count >= B::WIDTH)
    }

    /// Puts the particles in the order of their cells.
    #[inline(never)]
    fn restore_order(&mut self) {
        let (surface, numbers_each) = (&mut self.surface, self.law.numbers());
        let cells = self.bins.cells_mut();
        let moved = self.order.restore(
            &self.grid,
            cells,
            (&mut self.particles, &mut self.memory),
            numbers_each,
            &mut |targets| {
                for point in surface.iter_mut() {
                    point.particle = targets[point.particle] as usize;
                }
            },
        );
        if moved {
            self.bins.note_crossings(1);
            self.spans.forget();
        }
    }

    /// Finds where surfaces cut cells, in one dimension.
    fn cut_cells(&mut self) {
        self.cuts.clear();
        if const { D > 1 } {
            return;
        }
        for point in &self.surface {
            let cell = self.bins.cell_of(point.particle);
            self.cuts.push(Cut {
                cell: cell[0],
                side: point.face.side,
                position: self.surface_position(point)[0],
            });
        }
    }

    fn surface_position(&self, point: &SurfacePoint<T>) -> SVector<T, D> {
        let p = point.particle;
        let (x, volume) = (&self.particles.position[p], self.particles.volume[p]);
        point.position(&self.grid, self.bins.cell_of(p), x, volume)
    }

    /// Where loads of a surface act, with the cell.
    fn loaded_place(&self, point: &SurfacePoint<T>) -> (Cell<D>, SVector<T, D>) {
        let p = point.particle;
        let extent = self.particles.domains.half_extent(p, point.face.axis);
        if const { B::DOMAIN.is_asked_for() }
            && let Some(half_length) = extent
        {
            let x = point.end_of_domain(&self.particles.position[p], half_length);
            if let Some(cell) = self.grid.locate(&x)
                && self.grid.has_numbers(&cell, 0)
            {
                return (cell, x);
            }
        }
        (*self.bins.cell_of(p), self.surface_position(point))
    }

    /// The particles, in the order in which they are kept: see [`Stepper::numbers`].
    pub fn particles(&self) -> &Particles<T, D, L::Number, P::Particle> {
        &self.particles
    }

    /// For each of [`Stepper::particles`] its number in the order in which the [`Setup`] gave them; `None`
    /// while that is the order. In two and three dimensions particles are put in the order of their cells, at
    /// the start and again as they move, in one dimension only where they start without any.
    /// [`Simulation::particles`] gives them back in their first order, and errors name their first numbers.
    pub fn numbers(&self) -> Option<&[u32]> {
        self.order.numbers()
    }

    /// The grid.
    pub fn grid(&self) -> &Grid<T, D> {
        &self.grid
    }

    /// The constitutive law.
    pub fn law(&self) -> &L {
        &self.law
    }

    /// Time reached (s).
    pub fn time(&self) -> T {
        self.time
    }

    /// Steps taken.
    pub fn steps(&self) -> usize {
        self.steps
    }

    /// Number of DOFs.
    pub fn dof_count(&self) -> usize {
        self.dofs.mass.len()
    }

    /// Velocities of the DOFs in the last step (m/s).
    pub fn dof_velocities(&self) -> &[SVector<T, D>] {
        &self.dofs.velocity
    }

    /// What was counted and measured so far.
    pub fn diagnostics(&self) -> &Diagnostics<T> {
        &self.diagnostics
    }

    /// Bytes of the stepper and of all that it allocates: particles, their cells, what basis and
    /// reconstruction hold, DOFs. Steps allocate nothing beyond, but the first one in which walls rub that
    /// did not before, and where particles move so far through a large grid that its
    /// [`Window`](crate::grid::Window) moves with them.
    pub fn bytes(&self) -> usize {
        size_of::<Self>()
            + self.particles.bytes()
            + size_of::<X::Particle>() * self.memory.capacity()
            + self.places.bytes()
            + self.bins.bytes()
            + self.order.bytes()
            + self.basis.bytes()
            + self.reconstruction.bytes()
            + self.dofs.bytes()
            + self.liquid.bytes()
            + self.spans.bytes()
            + self.pairs.bytes()
            + self.contact.bytes()
            + size_of::<SurfacePoint<T>>() * self.surface.capacity()
            + size_of::<Cut<T>>() * self.cuts.capacity()
            + size_of::<CourantNumbers<T>>() * self.crossed.capacity()
            + size_of::<SMatrix<T, D, D>>() * self.relaxed.capacity()
            + size_of::<SVector<T, D>>() * self.body_forces.capacity()
            + self.joint.bytes()
            + self.seal.bytes()
            + self.diffusion.bytes()
            + size_of::<T>() * self.drag.len()
    }

    /// [`Stepper::bytes`] over the number of particles.
    pub fn bytes_per_particle(&self) -> f64 {
        self.bytes() as f64 / self.particles.len() as f64
    }
}

/// Of how many things a stepper keeps something.
struct Counts {
    surface: usize,
    /// Cells whose Courant numbers are kept.
    crossed: usize,
    /// Particles whose relaxed stress is kept.
    relaxed: usize,
    /// Functions of a cell along an axis, and on a side of it.
    functions: [usize; 2],
    /// Whether a liquid flows.
    flows: bool,
    /// Whether particles are summed in pairs of DOFs.
    pairs: bool,
}

/// What a stepper keeps besides its setup, before there are DOFs. Made in a function of its own: what frees
/// the fields that are there already where the next one fails is else compiled for every stepper.
struct Parts<T: Scalar, const D: usize> {
    bins: Bins<D>,
    order: Order,
    cuts: Vec<Cut<T>>,
    dofs: Dofs<T, D>,
    liquid: Dofs<T, D>,
    joint: liquid::Joint<T, D>,
    seal: liquid::Seal<T>,
    spans: Spans<T, D>,
    crossed: Vec<CourantNumbers<T>>,
    relaxed: Vec<SMatrix<T, D, D>>,
    balance: balance::Balance<T, D>,
    contact: contact::WallContact<T, D>,
    pairs: Pairs<T, D>,
    diagnostics: Diagnostics<T>,
}

impl<T: Scalar, const D: usize> Parts<T, D> {
    #[inline(never)]
    fn new(grid: &Grid<T, D>, bins: Bins<D>, masses: &[T], counts: Counts) -> Self {
        let mass = masses.iter().fold(T::zero(), |sum, &m| sum + m);
        let sealed = if counts.flows { counts.surface } else { 0 };
        let [along, beside] = counts.functions;
        Self {
            order: Order::new(grid, bins.cells()),
            bins,
            cuts: Vec::with_capacity(counts.surface),
            dofs: Dofs::none(),
            liquid: Dofs::none(),
            joint: liquid::Joint::none(),
            seal: liquid::Seal::new(sealed, along * beside, beside),
            spans: Spans::new(masses.len()),
            crossed: Vec::with_capacity(counts.crossed),
            relaxed: vec![SMatrix::zeros(); counts.relaxed],
            balance: balance::Balance::none(),
            contact: contact::WallContact::none(),
            pairs: Pairs::new(counts.pairs),
            diagnostics: Diagnostics::new(mass, counts.flows),
        }
    }
}

/// Checks all that a stepper is to be made of and makes it fit: domains, window of the grid, what the
/// transfer remembers. Returns the particles' cells and the places of the DOFs.
fn take_in<T, const D: usize, B, R, L, P, X>(
    setup: &mut Setup<T, D, B, R, L, P, X>,
) -> Result<(Bins<D>, DofPlaces<T, D>), SetupError>
where
    T: Scalar,
    B: BasisFamily<T, D>,
    R: Reconstruction<T, D>,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
    X: Transfer<T, D>,
{
    let (basis, particles, memory) = (&setup.basis, &mut setup.particles, &mut setup.memory);
    check_material(&setup.law, &setup.phase, particles)?;
    domain::lay::<T, D, B, _, _>(&setup.grid, particles);
    domain::validate::<T, D, B, _, _>(&setup.grid, particles)?;
    if P::FLOWS && R::Mass::SERIES {
        return Err(SetupError::SeriesWithFlow);
    }
    if P::FLOWS && R::Mass::IN_ACCELERATION && D > 1 {
        return Err(SetupError::OnePhaseOnly);
    }
    from_grid::refuse_what_it_cannot::<T, D, R, P, X>()?;
    if memory.is_empty() {
        memory.resize(particles.len(), X::Particle::default());
    }
    if memory.len() != particles.len() {
        let (found, expected) = (memory.len(), particles.len());
        let name = "memory";
        return Err(SetupError::Lengths {
            name,
            found,
            expected,
        });
    }
    if const { R::Mass::IN_ACCELERATION && D > 1 } {
        polynomial::refuse_bends_within_cells(basis, &setup.grid)?;
    }
    let bins = find_cells(&setup.grid, &setup.surface, &mut particles.position)?;
    if const { B::FOLLOWS_WINDOW } {
        window::lay(&mut setup.grid, bins.cells());
    }
    let places = from_grid::dof_places::<T, D, B, R::Mass, X>(basis, &setup.grid)?;
    Ok((bins, places))
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
