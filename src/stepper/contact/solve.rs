//! The contact problem: Signorini's conditions along the normal and Coulomb's law along the wall, at every DOF at once.
//!
//! With `v = v* + W R` the impulses `R` are those with `R_n >= 0`, `v_n >= 0`, `R_n v_n = 0`, and `|R_t| <= mu R_n` where `R_t`
//! opposes the sliding wherever it reaches that bound. Projected Gauss-Seidel finds them: normal impulses first, then
//! tangential ones with their bounds frozen. Along one flat wall `W` is a number times the identity for each pair of DOFs,
//! so that neither changes the other, and both problems are convex: a solution cut short only dissipates. Where two
//! walls meet, the normal of one is a tangent of the other; there both are done in turns until neither moves.

use nalgebra::SVector;

use super::delassus::Delassus;
use super::wall::WallDofs;
use crate::scalar::Scalar;

/// Over-relaxation of a sweep.
const RELAXATION: f64 = 1.2;
/// Sweeps after which the impulses are taken as they are.
const MOST_SWEEPS: usize = 4000;

/// The velocities of the walls' DOFs under the impulses of the contacts.
pub(super) struct Problem<'a, T, const D: usize> {
    pub(super) dofs: &'a mut WallDofs<T, D>,
    pub(super) delassus: &'a Delassus<T, D>,
    /// Of the DOFs on walls (m/s).
    pub(super) velocity: &'a mut [SVector<T, D>],
    /// Which contacts are closed.
    pub(super) closed: &'a [u32],
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
        let mut left = MOST_SWEEPS;
        loop {
            let moved = self.sweeps(least, &mut left, Self::press) | self.sweeps(least, &mut left, Self::rub);
            solved.changed |= moved;
            if left == 0 {
                solved.settled = false;
                return solved;
            }
            if !moved || !self.walls_meet() {
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

    /// Sweeps over the contacts until no velocity changes by more than `least`, or none of the sweeps is `left`; returns whether
    /// the first one did change any.
    fn sweeps(&mut self, least: T, left: &mut usize, update: fn(&mut Self, usize) -> T) -> bool {
        let mut moved = false;
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
        }
        moved
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
        let (size, bound) = (wanted.norm(), here.wall.coefficient * here.normal);
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
