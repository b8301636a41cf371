//! Contact with walls that let go and rub: Signorini's conditions and Coulomb's friction at the DOFs on a
//! face of the grid.
//!
//! A step maps particle velocities to the DOFs by `v = P v_p`, for particle sums `P = N Phi^T M` with the
//! particle masses `M`, the shape functions `Phi` and the inverse mass `N` of the DOFs. The wall acts
//! by *one* impulse `R` at its DOFs, which changes the particles by `Phi N R` and so the mapped velocities by
//! `W R`, `W = P Phi N`. It is solved for such that the velocity which then moves and strains the particles
//! obeys the contact law, and nothing is corrected after that.
//!
//! For particle sums, and for the consistent mass of the particles, `Phi N = M^-1 P^T`, so that the
//! particles' kinetic energy changes by `R . v - R . W R / 2` with `v` the velocity after it. There
//! `R_n v_n = 0`, `R_t . v_t <= 0`, and `W` has no negative eigenvalue: a wall at rest never does positive
//! work, whatever the step, the basis and the motion, and since strains come from that same `v` no strain
//! energy passes it either. (Asked twice, before and after the particles' update, a wall may hold a DOF in
//! the first pass and let it go in the second; it then does the work of the force that it cancelled.)
//!
//! A DOF is in contact where a particle that it sees has its surface within [`CLOSED`] of a cell from the
//! wall. Otherwise material would stop as soon as it enters the cell at the wall.
//!
//! Particle sums give `W = N S N`, `S_ij = sum_p m_p phi_i phi_j` ([`sums`]). Any other mapping (fits of
//! densities, a consistent mass) is asked for its own `W` by impulses at DOFs far enough apart, and the
//! solution is corrected with the mapping itself until the law holds ([`mapping`]). With published TLS, whose
//! forces are not adjoint to its mapping, the proof above does not hold, although the law is obeyed as
//! exactly.
//!
//! Where a liquid flows through the pores a wall acts on the whole of both phases ([`saturated`]).

mod delassus;
mod mapping;
mod saturated;
mod shape;
mod solve;
mod subspace;
mod sums;
mod wall;

use nalgebra::SVector;

use super::acceleration::Walls;
use super::order::Order;
use super::{Forcing, Stepper};
use crate::basis::BasisFamily;
use crate::grid::{Cell, Grid};
use crate::law::LawSweep;
use crate::mass::{Divisor, MassModel};
use crate::particles::Particles;
use crate::phase::Phase;
use crate::reconstruction::Reconstruction;
use crate::scalar::Scalar;
use crate::stepper::inner::Inner;
use crate::transfer::Transfer;
use delassus::Delassus;
use saturated::LiquidAtWalls;
pub use saturated::WallImpulse;
pub(super) use shape::shapes;
use subspace::Subspace;
use wall::{Contact, Wall, WallDofs};

/// Distance of a particle's surface from a wall, in cells, below which they touch.
const CLOSED: f64 = 0.02;
/// Round-offs of a velocity that no tolerance is below.
const ROUND_OFF: f64 = 16.0;

/// What contact with walls needs; nothing where none rubs.
#[derive(Clone, Debug)]
pub(super) struct WallContact<T, const D: usize> {
    dofs: WallDofs<T, D>,
    delassus: Delassus<T, D>,
    subspace: Subspace<T, D>,
    /// Of each particle, in the order in which they were given, its size along each axis over the root of its
    /// volume.
    shapes: Vec<SVector<T, D>>,
    /// Particles that see a DOF on a wall.
    near: Vec<u32>,
    /// Contacts that are closed.
    closed: Vec<u32>,
    /// Of the DOFs on walls: inverse masses by component, velocities (m/s), impulses (N s).
    inverse: Vec<SVector<T, D>>,
    velocity: Vec<SVector<T, D>>,
    impulse: Vec<SVector<T, D>>,
    /// Of all DOFs: what is to be added to them.
    gain: Vec<SVector<T, D>>,
    /// Of all DOFs and particles, where the mapping is no particle sum: velocities so far, and changes of
    /// velocity.
    reached: Vec<SVector<T, D>>,
    kicks: Vec<SVector<T, D>>,
    /// Of the DOFs on walls: velocities without any impulse; and the contacts before a correction.
    free: Vec<SVector<T, D>>,
    tried: Vec<Contact<T, D>>,
    /// What there is of the liquid where one flows.
    liquid: LiquidAtWalls<T, D>,
}

/// What the walls did to the particles in a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct WallAction<T, const D: usize> {
    /// Change of their momentum (N s).
    pub(super) impulse: SVector<T, D>,
    /// Work on them (J): of each impulse with the velocity of its DOF after it.
    pub(super) work: T,
    /// The same with the velocity relative to the wall (J), what friction takes: never positive.
    pub(super) rubbing: T,
    /// Whether the impulses were found within the tolerance.
    pub(super) solved: bool,
}

impl<T: Scalar, const D: usize> WallAction<T, D> {
    fn none() -> Self {
        Self {
            impulse: SVector::zeros(),
            work: T::zero(),
            rubbing: T::zero(),
            solved: true,
        }
    }
}

impl<T: Scalar, const D: usize> WallContact<T, D> {
    pub(super) fn none() -> Self {
        Self {
            dofs: WallDofs::none(),
            delassus: Delassus::none(),
            subspace: Subspace::none(),
            shapes: Vec::new(),
            near: Vec::new(),
            closed: Vec::new(),
            inverse: Vec::new(),
            velocity: Vec::new(),
            impulse: Vec::new(),
            gain: Vec::new(),
            reached: Vec::new(),
            kicks: Vec::new(),
            free: Vec::new(),
            tried: Vec::new(),
            liquid: LiquidAtWalls::none(),
        }
    }

    /// DOFs have other numbers now.
    pub(super) fn forget(&mut self) {
        self.dofs.forget();
    }

    pub(super) fn bytes(&self) -> usize {
        let vectors = [
            &self.shapes,
            &self.inverse,
            &self.velocity,
            &self.impulse,
            &self.gain,
            &self.reached,
            &self.kicks,
            &self.free,
        ];
        size_of::<SVector<T, D>>() * vectors.map(Vec::capacity).iter().sum::<usize>()
            + size_of::<u32>() * (self.near.capacity() + self.closed.capacity())
            + size_of::<Contact<T, D>>() * self.tried.capacity()
            + self.dofs.bytes()
            + self.delassus.bytes()
            + self.subspace.bytes()
            + self.liquid.bytes()
    }

    /// Greatest velocity (m/s) of a closed contact relative to its wall.
    fn scale(&self) -> T {
        let contacts = self.closed.iter().map(|&k| &self.dofs.contacts[k as usize]);
        contacts
            .map(|contact| (self.velocity[contact.place] - contact.wall.velocity).norm())
            .fold(T::zero(), T::max)
    }

    /// Round-off (m/s) of velocities at the walls.
    fn round_off(&self) -> T {
        let contacts = self.closed.iter().map(|&k| &self.dofs.contacts[k as usize]);
        let largest = contacts
            .map(|contact| {
                self.velocity[contact.place]
                    .norm()
                    .max(contact.wall.velocity.norm())
            })
            .fold(T::zero(), T::max);
        largest * T::default_epsilon() * T::lit(ROUND_OFF)
    }

    /// Takes in the velocities of all DOFs.
    fn read(&mut self, velocities: &[SVector<T, D>]) {
        for (own, &dof) in self.velocity.iter_mut().zip(&self.dofs.dofs) {
            *own = velocities[dof as usize];
        }
    }

    /// Adds up the impulses of the contacts of each DOF.
    fn add_up_impulses(&mut self) {
        self.impulse.fill(SVector::zeros());
        for contact in &self.dofs.contacts {
            self.impulse[contact.place] += contact.impulse();
        }
    }

    /// The work of the impulses at DOFs that have these velocities now.
    fn measure_work(&self, velocities: &[SVector<T, D>], action: &mut WallAction<T, D>) {
        for contact in &self.dofs.contacts {
            let velocity = &velocities[self.dofs.dofs[contact.place] as usize];
            let impulse = contact.impulse();
            action.work += impulse.dot(velocity);
            action.rubbing += impulse.dot(&(velocity - contact.wall.velocity));
        }
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
    /// Lets the walls act on particles and DOFs, whose velocities are those that the step would have without
    /// them.
    pub(super) fn apply_wall_contact(&mut self, dt: T, forcing: &Forcing<T, D>) {
        if const { !X::FROM_GRID } && rub(forcing) {
            self.apply_contact_with(dt, forcing);
        }
    }

    // Out of line: there is a step for every method, and few runs have walls that rub.
    #[inline(never)]
    fn apply_contact_with(&mut self, dt: T, forcing: &Forcing<T, D>) {
        let Some(scale) = self.inner.begin_contact(&self.basis, dt, forcing) else {
            return;
        };
        let mut action = match const { R::Mass::OF_PARTICLES && !R::Mass::IN_ACCELERATION && !P::FLOWS } {
            true => self.inner.push_by_sums(&self.basis, scale),
            false => {
                let shape = self.basis.dofs(&self.inner.grid);
                mapping::push_by_mapping(self, shape, [dt, scale], forcing)
            }
        };
        self.inner.end_contact(forcing, &mut action);
    }
}

impl<T, const D: usize, L, P, X> Inner<T, D, L, P, X>
where
    T: Scalar,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
    X: Transfer<T, D>,
{
    /// Finds the contacts that are closed and what an impulse at each does to its DOF; returns their greatest
    /// velocity, if they move at all.
    #[inline(never)]
    fn begin_contact<B: BasisFamily<T, D>>(
        &mut self,
        basis: &B,
        dt: T,
        forcing: &Forcing<T, D>,
    ) -> Option<T> {
        if const { P::FLOWS } {
            self.answer_of_both(dt, forcing);
        } else {
            self.detect_contacts(basis, forcing);
            self.contact
                .invert_masses(&self.dofs.mass, &self.face_dofs, forcing);
        }
        self.contact.read(&self.dofs.velocity);
        let scale = self.contact.scale();
        (scale > T::zero()).then_some(scale)
    }

    /// The impulses where momenta are particle sums over lumped masses.
    fn push_by_sums<B: BasisFamily<T, D>>(&mut self, basis: &B, scale: T) -> WallAction<T, D> {
        let space = (basis, &self.grid, self.bins.cells());
        let particles = &mut self.particles;
        sums::push_by_sums(space, particles, scale, &mut self.contact, &mut self.dofs)
    }

    /// Holds what walls hold, and counts what they did.
    #[inline(never)]
    fn end_contact(&mut self, forcing: &Forcing<T, D>, action: &mut WallAction<T, D>) {
        let velocities = &mut self.dofs.velocity;
        Walls::of_solid(&self.face_dofs, forcing).for_each_held(|dof, axis, velocity, _| {
            velocities[dof][axis] = velocity;
        });
        self.contact.measure_work(&self.dofs.velocity, action);
        if let Some(momentum) = &mut self.balance.momentum {
            *momentum += action.impulse;
        }
        self.diagnostics.record_walls(action);
    }

    /// Whether momenta are particle sums over lumped masses.
    fn walls_by_sums(&self) -> bool {
        self.mass == Divisor::Particles
    }

    /// Finds the contacts that are closed.
    #[inline(never)]
    fn detect_contacts<B: BasisFamily<T, D>>(&mut self, basis: &B, forcing: &Forcing<T, D>) {
        let by_sums = self.walls_by_sums();
        if !self.contact.dofs.fit(forcing, self.dofs.mass.len()) {
            let reach = basis.reach();
            let room = Room {
                shape: basis.dofs(&self.grid),
                reach: if by_sums { reach } else { mapping::reach::<D>() },
                seen: (reach + 1).pow(D as u32),
                maps: !by_sums || P::FLOWS,
                flows: P::FLOWS,
            };
            let initial = &self.particles.initial_position;
            self.contact
                .allocate(room, &self.face_dofs, forcing, (&self.grid, initial, &self.order));
        }
        self.contact.dofs.begin(forcing);
        let space = (basis, &self.grid, self.bins.cells());
        detect_contacts(space, &self.particles, &self.order, forcing, &mut self.contact);
    }
}

/// Whether a step has walls that rub.
pub(super) fn rub<T: Scalar, const D: usize>(forcing: &Forcing<T, D>) -> bool {
    Wall::are_there(forcing)
}

/// How much contact needs room for.
struct Room<const D: usize> {
    /// Of the lattice of all DOFs.
    shape: [usize; D],
    /// How far apart along each axis DOFs feel each other.
    reach: usize,
    /// Most DOFs that a particle sees.
    seen: usize,
    /// Whether the mapping itself is asked for what impulses do.
    maps: bool,
    /// Whether a liquid flows.
    flows: bool,
}

impl<T: Scalar, const D: usize> WallContact<T, D> {
    /// Allocates what the walls that rub in this step need.
    #[cold]
    #[inline(never)]
    fn allocate(
        &mut self,
        room: Room<D>,
        face_dofs: &[Vec<u32>],
        forcing: &Forcing<T, D>,
        (grid, initial, order): (&Grid<T, D>, &[SVector<T, D>], &Order),
    ) {
        self.dofs.lay(room.shape, face_dofs, forcing, room.reach);
        self.delassus.lay(&self.dofs, room.seen);
        let (places, dofs) = (self.dofs.dofs.len(), room.shape.iter().product());
        self.subspace.lay(places);
        self.inverse = vec![SVector::zeros(); places];
        self.velocity = vec![SVector::zeros(); places];
        self.impulse = vec![SVector::zeros(); places];
        self.gain = vec![SVector::zeros(); dofs];
        let shapes = shapes(grid, initial);
        self.shapes.resize(shapes.len(), SVector::zeros());
        for (place, shape) in shapes.into_iter().enumerate() {
            self.shapes[order.number(place)] = shape;
        }
        self.near = Vec::with_capacity(initial.len());
        self.closed = Vec::with_capacity(self.dofs.contacts.len());
        if room.maps {
            self.reached = vec![SVector::zeros(); dofs];
            self.kicks = vec![SVector::zeros(); initial.len()];
            self.free = vec![SVector::zeros(); places];
            self.tried.clone_from(&self.dofs.contacts);
        }
        if room.flows {
            self.liquid.lay(dofs, initial.len(), self.dofs.contacts.len());
        }
    }

    /// One over the lumped `masses` of each DOF on a wall, nothing for components that another face holds.
    #[inline(never)]
    fn invert_masses(&mut self, masses: &[T], face_dofs: &[Vec<u32>], forcing: &Forcing<T, D>) {
        let Self { dofs, inverse, .. } = self;
        for (inverse, &dof) in inverse.iter_mut().zip(&dofs.dofs) {
            let mass = masses[dof as usize];
            let value = if mass > T::zero() {
                T::one() / mass
            } else {
                T::zero()
            };
            *inverse = SVector::from_element(value);
        }
        Walls::of_solid(face_dofs, forcing).for_each_held(|dof, axis, _, _| {
            if let Some(place) = dofs.place(dof) {
                inverse[place][axis] = T::zero();
            }
        });
    }
}

/// Finds the particles at the walls, sums their masses in pairs of DOFs, and sees which contacts are closed.
#[inline(never)]
fn detect_contacts<T: Scalar, const D: usize, B: BasisFamily<T, D>, N, Q>(
    (basis, grid, cells): (&B, &Grid<T, D>, &[Cell<D>]),
    particles: &Particles<T, D, N, Q>,
    order: &Order,
    forcing: &Forcing<T, D>,
    contact: &mut WallContact<T, D>,
) {
    let WallContact {
        dofs,
        delassus,
        near,
        closed,
        shapes,
        ..
    } = contact;
    delassus.clear();
    near.clear();
    let sites = particles.sites(cells);
    for (p, (x, cell)) in sites.positions.iter().zip(sites.cells).enumerate() {
        // Functions of further cells have no value at the wall.
        if !Wall::all(forcing).any(|wall| wall.cells_to(grid, cell) <= basis.reach()) {
            continue;
        }
        let root = particles.volume[p].powf(T::one() / T::count(D));
        let half = shapes[order.number(p)] * (root / T::lit(2.0));
        sites.for_each(basis, grid, p, |dof, phi, _| {
            let Some(place) = dofs.place(dof).filter(|_| phi > T::zero()) else {
                return;
            };
            delassus.see(place, phi);
            for contact in dofs.contacts_at(place) {
                let surface = contact.wall.distance(grid, x) - half[contact.wall.face.axis];
                contact.gap = contact.gap.min(surface);
            }
        });
        if delassus.add_particle(dofs, particles.mass[p]) {
            near.push(p as u32);
        }
    }
    closed.clear();
    for (k, contact) in dofs.contacts.iter_mut().enumerate() {
        contact.closed = contact.gap <= grid.cell_size()[contact.wall.face.axis] * T::lit(CLOSED);
        if contact.closed {
            closed.push(k as u32);
        }
    }
}
