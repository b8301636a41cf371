//! The contact problem: Signorini's conditions along the normal and Coulomb's law along the wall, at every
//! DOF at once.
//!
//! With `v = v* + W R` the impulses `R` are those with `R_n >= 0`, `v_n >= 0`, `R_n v_n = 0`, and
//! `|R_t| <= mu R_n` where `R_t` opposes the sliding wherever it reaches that bound. Projected Gauss-Seidel
//! finds them: normal impulses first, then tangential ones with their bounds frozen. Along one flat wall `W`
//! is a number times the identity for each pair of DOFs, so that neither changes the other, and both problems
//! are convex: a solution cut short only dissipates. Between sweeps conjugate gradients solve for the
//! contacts that are free to change ([`super::subspace`]). Where two walls meet, the normal of one is a
//! tangent of the other; there both are done in turns until neither moves, by sweeps alone.

use nalgebra::SVector;

use super::delassus::Delassus;
use super::subspace::Subspace;
use super::wall::WallDofs;
use crate::scalar::Scalar;

/// Over-relaxation of a sweep.
const RELAXATION: f64 = 1.2;
/// Sweeps and iterations after which the impulses of a kind, normal or tangential, are taken as they are.
const MOST_SWEEPS: usize = 4000;
/// Sweeps between iterations on what they leave free.
const SWEEPS: usize = 8;
/// Iterations between sweeps.
const ITERATIONS: usize = 100;

/// The velocities of the walls' DOFs under the impulses of the contacts.
pub(super) struct Problem<'a, T, const D: usize> {
    pub(super) dofs: &'a mut WallDofs<T, D>,
    pub(super) delassus: &'a Delassus<T, D>,
    /// Of the DOFs on walls (m/s).
    pub(super) velocity: &'a mut [SVector<T, D>],
    /// Which contacts are closed.
    pub(super) closed: &'a [u32],
    /// Room for iterations; none where the operator is not symmetric.
    pub(super) subspace: Option<&'a mut Subspace<T, D>>,
}

/// Normal impulses, or tangential ones.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Normal,
    Tangential,
}

/// What became of a solution.
#[derive(Clone, Copy, Debug)]
pub(super) struct Solved {
    /// Whether impulses had to change at all.
    pub(super) changed: bool,
    /// Whether nothing changes any more.
    pub(super) settled: bool,
}

impl<T: Scalar, const D: usize> Problem<'_, T, D> {
    /// Changes impulses and velocities until no sweep changes a velocity by more than `least` (m/s).
    pub(super) fn solve(&mut self, least: T) -> Solved {
        let mut solved = Solved {
            changed: false,
            settled: true,
        };
        // Each kind has its own: friction must not end because what presses has not settled to the last
        // digit.
        let mut left = [MOST_SWEEPS; 2];
        let meet = self.walls_meet();
        if meet {
            // There a component may belong to two contacts.
            self.subspace = None;
        }
        loop {
            let [press, rub] = &mut left;
            let moved = self.sweeps(least, press, Kind::Normal) | self.sweeps(least, rub, Kind::Tangential);
            solved.changed |= moved;
            if left.contains(&0) {
                solved.settled = false;
                return solved;
            }
            if !moved || !meet {
                return solved;
            }
        }
    }

    /// Whether contacts with walls along different axes are closed.
    fn walls_meet(&self) -> bool {
        let mut axes = self
            .closed
            .iter()
            .map(|&k| self.dofs.contacts[k as usize].wall.face.axis);
        let first = axes.next();
        axes.any(|axis| Some(axis) != first)
    }

    /// Sweeps over the contacts until no velocity changes by more than `least`, or none of the sweeps is
    /// `left`; returns whether the first one did change any.
    fn sweeps(&mut self, least: T, left: &mut usize, kind: Kind) -> bool {
        let update = match kind {
            Kind::Normal => Self::press,
            Kind::Tangential => Self::rub,
        };
        let (mut moved, mut since) = (false, 0);
        while *left > 0 {
            let mut largest = T::zero();
            for &contact in self.closed {
                largest = largest.max(update(self, contact as usize));
            }
            if largest <= least {
                return moved;
            }
            moved = true;
            *left -= 1;
            since += 1;
            if since == SWEEPS {
                since = 0;
                self.iterate(least, left, kind);
            }
        }
        moved
    }

    /// Solves for the contacts that the last sweep left free, and goes as far towards that as all bounds
    /// allow.
    fn iterate(&mut self, least: T, left: &mut usize, kind: Kind) {
        let Some(subspace) = self.subspace.as_deref_mut() else {
            return;
        };
        subspace.clear();
        // All closed contacts are at walls along one axis, whose velocities may differ from side to side.
        for &k in self.closed {
            let contact = &self.dofs.contacts[k as usize];
            let axis = contact.wall.face.axis;
            let free = &mut subspace.free[contact.place];
            match kind {
                Kind::Normal if contact.normal > T::zero() => free[axis] = T::one(),
                Kind::Tangential if contact.tangential.norm() < contact.bound() => {
                    *free = SVector::repeat(T::one());
                    free[axis] = T::zero();
                }
                Kind::Normal | Kind::Tangential => {}
            }
        }
        let mut iterations = (*left).min(ITERATIONS);
        *left -= iterations;
        let dofs = &*self.dofs;
        let wall = |place: usize| dofs.wall_velocity(place);
        let operator = (dofs, self.delassus);
        subspace.solve(operator, self.velocity, wall, least, &mut iterations);
        *left += iterations;
        let share = self.closed.iter().fold(T::one(), |share, &k| {
            let contact = &dofs.contacts[k as usize];
            let step = &subspace.step[contact.place];
            share.min(match kind {
                Kind::Normal => share_of_pressing(contact.normal, contact.wall.inward(step)),
                Kind::Tangential => share_of_sticking(&contact.tangential, step, contact.bound()),
            })
        });
        for &k in self.closed {
            let contact = &mut self.dofs.contacts[k as usize];
            let step = subspace.step[contact.place] * share;
            match kind {
                Kind::Normal => {
                    contact.normal = (contact.normal + contact.wall.inward(&step)).max(T::zero());
                }
                Kind::Tangential => contact.tangential += step,
            }
        }
        for (velocity, response) in self.velocity.iter_mut().zip(&subspace.response) {
            *velocity += response * share;
        }
    }

    /// The normal impulse of a contact; returns by how much it changed the velocity there.
    fn press(&mut self, contact: usize) -> T {
        let mut here = self.dofs.contacts[contact];
        let axis = here.wall.face.axis;
        let response = self.delassus.diagonal[here.place][axis];
        if response <= T::zero() {
            return T::zero();
        }
        let velocity = here
            .wall
            .inward(&(self.velocity[here.place] - here.wall.velocity));
        let wanted = here.normal - velocity * T::lit(RELAXATION) / response;
        let change = wanted.max(T::zero()) - here.normal;
        here.normal += change;
        self.dofs.contacts[contact] = here;
        self.apply(here.place, here.wall.along_normal(change));
        change.abs() * response
    }

    /// The tangential impulse of a contact, likewise.
    fn rub(&mut self, contact: usize) -> T {
        let mut here = self.dofs.contacts[contact];
        let response = self.delassus.diagonal[here.place];
        let velocity = self.velocity[here.place] - here.wall.velocity;
        let mut wanted = here.tangential;
        for axis in (0..D).filter(|&axis| axis != here.wall.face.axis) {
            if response[axis] > T::zero() {
                wanted[axis] -= velocity[axis] * T::lit(RELAXATION) / response[axis];
            }
        }
        let (size, bound) = (wanted.norm(), here.bound());
        if size > bound {
            wanted *= bound / size;
        }
        let change = wanted - here.tangential;
        here.tangential = wanted;
        self.dofs.contacts[contact] = here;
        self.apply(here.place, change);
        change.component_mul(&response).norm()
    }

    fn apply(&mut self, place: usize, impulse: SVector<T, D>) {
        if impulse.iter().all(|&part| part == T::zero()) {
            return;
        }
        for k in self.dofs.row(place) {
            let there = self.dofs.neighbours()[k] as usize;
            self.velocity[there] += self.delassus.entries[k].component_mul(&impulse);
        }
    }
}

/// How much of a `step` of a normal impulse leaves it one that presses.
fn share_of_pressing<T: Scalar>(normal: T, step: T) -> T {
    if normal + step >= T::zero() {
        T::one()
    } else {
        normal / -step
    }
}

/// How much of a `step` of a tangential impulse leaves it within its `bound`.
fn share_of_sticking<T: Scalar, const D: usize>(from: &SVector<T, D>, step: &SVector<T, D>, bound: T) -> T {
    if (from + step).norm() <= bound {
        return T::one();
    }
    // |from + s step| = bound, written so that nothing cancels.
    let (square, along) = (step.norm_squared(), from.dot(step));
    let room = bound * bound - from.norm_squared();
    if !(square > T::zero() && room > T::zero()) {
        return T::zero();
    }
    let root = (along * along + square * room).sqrt();
    let share = if along > T::zero() {
        room / (root + along)
    } else {
        (root - along) / square
    };
    share.min(T::one())
}
