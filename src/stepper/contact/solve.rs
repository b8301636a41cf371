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
/// Round-offs that the tolerance is at least.
const ROUND_OFF: f64 = 16.0;
/// Sweeps after which the impulses are taken as they are.
const MOST_SWEEPS: usize = 2000;
/// Turns of normal and tangential impulses where walls meet.
const MOST_TURNS: usize = 200;

/// The velocities of the walls' DOFs under the impulses of the contacts.
pub(super) struct Problem<'a, T, const D: usize> {
    pub(super) dofs: &'a mut WallDofs<T, D>,
    pub(super) delassus: &'a Delassus<T, D>,
    /// Of the DOFs on walls (m/s).
    pub(super) velocity: &'a mut [SVector<T, D>],
    /// Which contacts are closed.
    pub(super) closed: &'a [u32],
}

impl<T: Scalar, const D: usize> Problem<'_, T, D> {
    /// Changes impulses and velocities until the law holds everywhere within the share `tolerance` of `scale` (m/s), the walls'
    /// greatest relative velocity. Returns whether anything had to be changed by more than that.
    pub(super) fn solve(&mut self, scale: T, tolerance: f64) -> bool {
        let least = T::lit(tolerance).max(T::default_epsilon() * T::lit(ROUND_OFF)) * scale;
        let mut changed = false;
        for _ in 0..MOST_TURNS {
            let moved = self.sweeps(least, Self::press) | self.sweeps(least, Self::rub);
            changed |= moved;
            if !moved || self.dofs.walls() == 1 {
                break;
            }
        }
        changed
    }

    /// Sweeps over the contacts until no velocity changes by more than `least`; returns whether the first one did.
    fn sweeps(&mut self, least: T, update: fn(&mut Self, usize) -> T) -> bool {
        for sweep in 0..MOST_SWEEPS {
            let mut largest = T::zero();
            for &contact in self.closed {
                largest = largest.max(update(self, contact as usize));
            }
            if largest <= least {
                return sweep > 0;
            }
        }
        true
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
