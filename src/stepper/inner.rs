//! What a stepper holds besides its basis and its reconstruction.
//!
//! Along one axis 17 methods are pairs of four bases and five reconstructions. What is a function of
//! [`Inner`] alone is compiled once for them all, what is given the basis too once for each of these, and
//! only what needs both types once for each stepper. That is least of a step: sweeps know no reconstruction,
//! and fits are functions of their own.

use nalgebra::{SMatrix, SVector};

use super::dofs::Dofs;
use super::order::Order;
use super::pairs::Pairs;
use super::spans::{SCALARS, Spans, VECTORS};
use super::{
    Diagnostics, SurfacePoint, balance, check_material, contact, diffusion, domain, faces, find_cells,
    from_grid, liquid, polynomial, window,
};
use crate::basis::BasisFamily;
use crate::error::SetupError;
use crate::grid::{Cell, Grid};
use crate::law::LawSweep;
use crate::mass::Divisor;
use crate::particles::{Bins, Particles};
use crate::phase::Phase;
use crate::reconstruction::{CourantNumbers, Cut};
use crate::scalar::Scalar;
use crate::simd::LANES;
use crate::transfer::{DofPlaces, Transfer};

/// A stepper but for its basis and its reconstruction.
#[derive(Clone, Debug)]
pub(super) struct Inner<T, const D: usize, L: LawSweep<T, D>, P: Phase<T, D>, X: Transfer<T, D>>
where
    T: Scalar,
{
    pub(super) grid: Grid<T, D>,
    pub(super) law: L,
    pub(super) phase: P,
    pub(super) transfer: X,
    pub(super) particles: Particles<T, D, L::Number, P::Particle>,
    /// What the transfer remembers of each particle.
    pub(super) memory: Vec<X::Particle>,
    pub(super) surface: Vec<SurfacePoint<T>>,
    pub(super) bins: Bins<D>,
    pub(super) order: Order,
    /// Where the surfaces cut cells.
    pub(super) cuts: Vec<Cut<T>>,
    /// The solid's DOFs; in one phase the only ones.
    pub(super) dofs: Dofs<T, D>,
    /// The liquid's, empty where none flows.
    pub(super) liquid: Dofs<T, D>,
    /// Drag of the DOFs (kg/s in 3-D), empty where no liquid flows.
    pub(super) drag: Vec<T>,
    /// What diffuses, of no DOF where nothing does.
    pub(super) diffusion: diffusion::Diffusion<T>,
    /// Of no DOF but for a liquid that flows with the particles' consistent matrices.
    pub(super) joint: liquid::Joint<T, D>,
    /// What surfaces demand that the liquid does not pass.
    pub(super) seal: liquid::Seal<T>,
    /// Where DOFs lie; of none but for a transfer from the grid.
    pub(super) places: DofPlaces<T, D>,
    pub(super) spans: Spans<T, D>,
    /// Whether a particle came near the border of the grid's window.
    pub(super) strayed: bool,
    /// Part of each occupied cell that a wave crosses in this step; empty where nothing relaxes.
    pub(super) crossed: Vec<CourantNumbers<T>>,
    /// Stresses as the relaxation would have them; empty but for laws that remember.
    pub(super) relaxed: Vec<SMatrix<T, D, D>>,
    pub(super) balance: balance::Balance<T, D>,
    /// Contact with walls that rub.
    pub(super) contact: contact::WallContact<T, D>,
    /// What the particles of a cell add to their matrix.
    pub(super) pairs: Pairs<T, D>,
    /// Force per mass of each particle; empty where there is none but the uniform one.
    pub(super) body_forces: Vec<SVector<T, D>>,
    /// DOFs of each face, in the order of [`Face::all`].
    pub(super) face_dofs: Vec<Vec<u32>>,
    /// Of each a DOF that has a value there and is not among them.
    pub(super) left_out: Vec<Option<usize>>,
    /// What momenta of the DOFs are divided by.
    pub(super) mass: Divisor,
    pub(super) time: T,
    pub(super) steps: usize,
    pub(super) diagnostics: Diagnostics<T>,
}

/// What of a setup is neither basis nor reconstruction.
pub(super) struct Given<T, const D: usize, L: LawSweep<T, D>, P: Phase<T, D>, X: Transfer<T, D>>
where
    T: Scalar,
{
    pub(super) grid: Grid<T, D>,
    pub(super) law: L,
    pub(super) phase: P,
    pub(super) transfer: X,
    pub(super) particles: Particles<T, D, L::Number, P::Particle>,
    pub(super) memory: Vec<X::Particle>,
    pub(super) surface: Vec<SurfacePoint<T>>,
}

/// What all else knows of a reconstruction.
#[derive(Clone, Copy)]
pub(super) struct Kind {
    /// What it wants the momenta of the DOFs to be divided by.
    pub(super) mass: Divisor,
    /// Whether it filters stress and velocity of the particles.
    pub(super) filters: bool,
}

impl<T, const D: usize, L, P, X> Inner<T, D, L, P, X>
where
    T: Scalar,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
    X: Transfer<T, D>,
{
    /// Checks what a stepper is to be made of, and allocates what is known before there are DOFs.
    #[inline(never)]
    pub(super) fn new<B: BasisFamily<T, D>>(
        basis: &B,
        mut given: Given<T, D, L, P, X>,
        kind: Kind,
    ) -> Result<Self, SetupError> {
        // While what is given is whole: what frees its parts one by one, where one of many tests fails, is
        // else compiled again and again.
        let (bins, places) = take_in(basis, &mut given, kind)?;
        Ok(Self::of_checked(given, (bins, places), basis.degree() + 1, kind))
    }

    /// The same of what was checked, with so many functions of a cell along an axis.
    #[inline(never)]
    fn of_checked(
        given: Given<T, D, L, P, X>,
        (bins, places): (Bins<D>, DofPlaces<T, D>),
        along: usize,
        kind: Kind,
    ) -> Self {
        let Given {
            grid,
            law,
            phase,
            transfer,
            particles,
            memory,
            surface,
        } = given;
        let parts = Parts::new(
            &grid,
            bins,
            &particles.mass,
            Counts {
                surface: surface.len(),
                crossed: if kind.filters { grid.cell_count() } else { 0 },
                relaxed: match kind.filters && law.remembers() {
                    true => particles.len(),
                    false => 0,
                },
                functions: [along, along.pow(D as u32 - 1)],
                flows: P::FLOWS,
                pairs: kind.mass.is_in_acceleration(),
            },
        );
        Self {
            grid,
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
            mass: kind.mass,
            time: T::zero(),
            steps: 0,
            diagnostics: parts.diagnostics,
        }
    }

    /// Bytes of it and of all that it allocates.
    #[inline(never)]
    pub(super) fn bytes(&self) -> usize {
        size_of::<Self>()
            + self.particles.bytes()
            + size_of::<X::Particle>() * self.memory.capacity()
            + self.places.bytes()
            + self.bins.bytes()
            + self.order.bytes()
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

    /// Whether accelerations too are solved with a consistent matrix.
    pub(super) fn in_acceleration(&self) -> bool {
        self.mass.is_in_acceleration()
    }

    /// Allocates what sweeps will need; `fits` says whether they pass over cells too, `kept` how many numbers
    /// are kept of each four of these.
    #[inline(never)]
    pub(super) fn allocate_spans(&mut self, fits: bool, kept: usize) {
        let each = match (P::FLOWS, P::DIFFUSES) {
            (true, _) => [SCALARS, VECTORS],
            (false, true) => [diffusion::SCALARS, 1],
            (false, false) => [1, 1],
        };
        self.spans.allocate(each, fits, self.dofs.mass.len());
        let cells = self.particles.len().min(self.grid.cell_count());
        self.spans.kept.reserve_exact(cells.div_ceil(LANES) * kept);
    }

    /// Lays the window anew and puts the particles in order, where that is due.
    #[inline(never)]
    pub(super) fn begin_step<B: BasisFamily<T, D>>(&mut self, basis: &B) {
        self.spans.fresh = false;
        if self.strayed {
            self.follow_particles(basis);
        }
        if self.order.is_lost() {
            self.restore_order();
        }
    }

    /// Makes the DOFs of the grid's window.
    #[inline(never)]
    pub(super) fn allocate_dofs<B: BasisFamily<T, D>>(&mut self, basis: &B) {
        self.contact.forget();
        let grid = &self.grid;
        self.dofs = Dofs::new(basis, grid, self.mass);
        if P::FLOWS {
            self.liquid = Dofs::new(basis, grid, self.mass);
            let count = basis.dof_count(grid);
            self.drag = vec![T::zero(); count];
            if self.in_acceleration() {
                self.joint = liquid::Joint::new(basis, grid, self.particles.len());
            }
        }
        if X::FROM_GRID || const { D > 1 } && self.mass.is_series() {
            self.places.follow(basis, grid);
        }
        if P::DIFFUSES {
            self.diffusion = diffusion::Diffusion::new(basis.dof_count(grid));
        }
        (self.face_dofs, self.left_out) = faces::face_dofs(basis, grid);
    }

    /// Puts the particles in the order of their cells.
    #[inline(never)]
    pub(super) fn restore_order(&mut self) {
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
    #[inline(never)]
    pub(super) fn cut_cells(&mut self) {
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

    pub(super) fn surface_position(&self, point: &SurfacePoint<T>) -> SVector<T, D> {
        let p = point.particle;
        let (x, volume) = (&self.particles.position[p], self.particles.volume[p]);
        point.position(&self.grid, self.bins.cell_of(p), x, volume)
    }

    /// Where loads of a surface act, with the cell.
    #[inline(never)]
    pub(super) fn loaded_place<B: BasisFamily<T, D>>(
        &self,
        _basis: &B,
        point: &SurfacePoint<T>,
    ) -> (Cell<D>, SVector<T, D>) {
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
/// the fields that are there already where the next one fails is else compiled for every law and phase.
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
fn take_in<T, const D: usize, B, L, P, X>(
    basis: &B,
    given: &mut Given<T, D, L, P, X>,
    kind: Kind,
) -> Result<(Bins<D>, DofPlaces<T, D>), SetupError>
where
    T: Scalar,
    B: BasisFamily<T, D>,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
    X: Transfer<T, D>,
{
    let matrix = kind.mass.is_in_acceleration();
    check_material(&given.law, &given.phase, &given.particles)?;
    domain::lay::<T, D, B, _, _>(&given.grid, &mut given.particles);
    domain::validate::<T, D, B, _, _>(&given.grid, &given.particles)?;
    if P::FLOWS && kind.mass.is_series() {
        return Err(SetupError::SeriesWithFlow);
    }
    if P::FLOWS && matrix && D > 1 {
        return Err(SetupError::OnePhaseOnly);
    }
    from_grid::refuse_what_it_cannot::<T, D, P, X>(kind)?;
    fit_memory::<T, D, X>(&mut given.memory, given.particles.len())?;
    if const { D > 1 } && matrix {
        polynomial::refuse_bends_within_cells(basis, &given.grid)?;
    }
    let bins = find_cells(&given.grid, &given.surface, &mut given.particles.position)?;
    if const { B::FOLLOWS_WINDOW } {
        window::lay(&mut given.grid, bins.cells());
    }
    let places = from_grid::dof_places::<T, D, B, X>(basis, &given.grid, kind.mass)?;
    Ok((bins, places))
}

/// Checks what the transfer remembers of so many particles, and allocates it where it is nothing yet.
fn fit_memory<T: Scalar, const D: usize, X: Transfer<T, D>>(
    memory: &mut Vec<X::Particle>,
    particles: usize,
) -> Result<(), SetupError> {
    if memory.is_empty() {
        memory.resize(particles, X::Particle::default());
    }
    if memory.len() == particles {
        return Ok(());
    }
    Err(SetupError::Lengths {
        name: "memory",
        found: memory.len(),
        expected: particles,
    })
}
