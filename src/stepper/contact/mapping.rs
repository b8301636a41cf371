//! The impulses of walls under any other mapping: fits of densities, consistent masses.
//!
//! Their `W` couples DOFs at any distance, but falls off fast with it. Impulses at DOFs so far apart that
//! their responses hardly meet give all columns within [`reach`] in a few mappings; what lies beyond, and
//! where responses meet, is made good by correction with the mapping itself, which is linear in the impulses.

use nalgebra::SVector;

use super::saturated::respond_with_both;
use super::solve::Problem;
use super::wall::coordinates;
use super::{WallAction, WallContact};
use crate::law::LawSweep;
use crate::phase::Phase;
use crate::scalar::Scalar;
use crate::stepper::Forcing;
use crate::stepper::acceleration::Walls;
use crate::stepper::critical::at_rest;
use crate::stepper::inner::Inner;
use crate::stepper::matrix::Unknown;
use crate::stepper::sweeps::Sweeps;
use crate::stepper::velocity::{divide, divide_by_mass};
use crate::transfer::Transfer;

/// Share of the walls' greatest relative velocity within which the contact law is to hold.
const TOLERANCE: f64 = 1e-9;
/// Corrections after which the impulses are taken as they are.
const MOST_CORRECTIONS: usize = 80;
/// By so much the operator is made larger when impulses were too large: one that is larger than the mapping's
/// own gives smaller steps, which never overshoot.
const LARGER: f64 = 2.0;
/// By so much a correction may be larger than the one before.
const GROWTH: f64 = 2.0;
/// Share of the energy that impulses take by which it may rise again: bounds of friction move with what
/// presses.
const RISE: f64 = 1e-3;

/// How far apart along each axis two DOFs may be whose coupling is asked for. The response to an impulse
/// falls by 0.27 (linear) to 0.54 (cubic) from DOF to DOF of a consistent mass; in space, where their number
/// is squared, fewer are asked for and more corrections made.
pub(super) const fn reach<const D: usize>() -> usize {
    match D {
        1 | 2 => 3,
        _ => 2,
    }
}

/// Any stepper.
type Any<'s, T, const D: usize, L, P, X> = &'s mut dyn Sweeps<T, D, L, P, X>;

/// Solves for the impulses and passes them on. `shape` is that of the lattice of DOFs.
#[inline(never)]
pub(super) fn push_by_mapping<T, const D: usize, L, P, X>(
    stepper: Any<'_, T, D, L, P, X>,
    shape: [usize; D],
    [dt, scale]: [T; 2],
    forcing: &Forcing<T, D>,
) -> WallAction<T, D>
where
    T: Scalar,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
    X: Transfer<T, D>,
{
    let rest = at_rest(forcing);
    let mut action = WallAction {
        solved: false,
        ..WallAction::none()
    };
    let inner = stepper.inner();
    let least = (scale * T::lit(TOLERANCE)).max(inner.contact.round_off());
    inner.contact.reached.copy_from_slice(&inner.dofs.velocity);
    if const { P::FLOWS } {
        inner.contact.liquid.begin(&inner.liquid.velocity);
    }
    if const { P::FLOWS } && inner.walls_by_sums() {
        inner.contact.estimate_columns();
    } else {
        probe_columns(stepper, &shape, dt, &rest);
    }
    let contact = &mut stepper.inner().contact;
    contact.impulse.fill(SVector::zeros());
    contact.read_reached();
    contact.begin_corrections();
    let (mut energy, mut last, mut failures) = (T::zero(), T::lit(f64::INFINITY), 0);
    for _ in 0..MOST_CORRECTIONS {
        let inner = stepper.inner();
        let (symmetric, in_acceleration) = (inner.is_symmetric(), inner.in_acceleration());
        let contact = &mut inner.contact;
        contact.read_reached();
        contact.tried.clone_from(&contact.dofs.contacts);
        let mut problem = Problem {
            dofs: &mut contact.dofs,
            delassus: &contact.delassus,
            velocity: &mut contact.velocity,
            closed: &contact.closed,
            subspace: symmetric.then_some(&mut contact.subspace),
        };
        let solved = problem.solve(least);
        if !solved.changed {
            // What the last sweep changed is too little to be passed on.
            contact.dofs.contacts.clone_from(&contact.tried);
            action.solved = true;
            break;
        }
        let size = contact.correction();
        if !(solved.settled && size <= last * T::lit(GROWTH)) {
            failures += 1;
            last = T::lit(f64::INFINITY);
            contact.take_back(failures);
            continue;
        }
        last = size;
        contact.lay_new_impulses();
        respond(stepper, dt, &rest);
        let inner = stepper.inner();
        let after = inner.contact.energy_with(&inner.dofs.velocity);
        // Only where the particles' matrix makes the operator symmetric is this their energy.
        if in_acceleration && !P::FLOWS && after - energy > energy.abs() * T::lit(RISE) {
            failures += 1;
            inner.contact.take_back(failures);
            continue;
        }
        energy = after;
        inner.take_response(&mut action);
    }
    let inner = stepper.inner();
    inner.dofs.velocity.copy_from_slice(&inner.contact.reached);
    if const { P::FLOWS } {
        let velocities = &mut inner.liquid.velocity;
        inner.contact.end_with_liquid(velocities, &mut action);
    }
    action
}

/// Fills the columns of the Delassus operator.
fn probe_columns<T, const D: usize, L, P, X>(
    stepper: Any<'_, T, D, L, P, X>,
    shape: &[usize; D],
    dt: T,
    rest: &Forcing<T, D>,
) where
    T: Scalar,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
    X: Transfer<T, D>,
{
    let stride = 2 * reach::<D>() + 1;
    for colour in 0..stride.pow(D as u32) {
        let colour = coordinates(colour, &[stride; D]);
        let contact = &mut stepper.inner().contact;
        if contact.lay_unit_impulses(&colour, shape, stride) {
            respond(stepper, dt, rest);
            let inner = stepper.inner();
            let responses = &inner.dofs.velocity;
            inner.contact.note_columns(&colour, shape, stride, responses);
        }
    }
    let WallContact { dofs, delassus, .. } = &mut stepper.inner().contact;
    delassus.complete(dofs);
}

/// Changes of velocity of particles and DOFs by the impulses laid at the DOFs; the latter's take the place of
/// the velocities.
fn respond<T, const D: usize, L, P, X>(stepper: Any<'_, T, D, L, P, X>, dt: T, rest: &Forcing<T, D>)
where
    T: Scalar,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
    X: Transfer<T, D>,
{
    if const { P::FLOWS } {
        return respond_with_both(stepper, dt, rest);
    }
    stepper.inner().accelerate_by_impulses(rest);
    stepper.kick_particles(T::one());
    stepper.map_momenta();
    let inner = stepper.inner();
    // The particles' matrix is the one that the accelerations were solved with.
    let walls = Walls::of_solid(&inner.face_dofs, rest);
    let fresh = !inner.in_acceleration();
    divide_by_mass(&mut inner.dofs, inner.mass, &walls, fresh);
    std::mem::swap(&mut inner.particles.velocity, &mut inner.contact.kicks);
}

impl<T, const D: usize, L, P, X> Inner<T, D, L, P, X>
where
    T: Scalar,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
    X: Transfer<T, D>,
{
    /// Whether the operator at hand is symmetric: in one phase the particles' own matrix is what
    /// accelerations are solved with too, and the estimate for two is made so.
    fn is_symmetric(&self) -> bool {
        match const { P::FLOWS } {
            true => self.walls_by_sums(),
            false => self.in_acceleration(),
        }
    }

    /// Accelerations of the DOFs by the impulses laid at them, and particles without velocities.
    fn accelerate_by_impulses(&mut self, rest: &Forcing<T, D>) {
        let walls = Walls::of_solid(&self.face_dofs, rest);
        self.dofs.force.copy_from_slice(&self.contact.gain);
        if self.in_acceleration() {
            let pick = |_, acceleration| acceleration;
            self.dofs
                .solve(Unknown::Acceleration, self.mass, &walls, true, &pick);
        } else {
            divide(&mut self.dofs.force, &self.dofs.mass);
        }
        let force = &mut self.dofs.force;
        walls.for_each_held(|dof, axis, _, _| force[dof][axis] = T::zero());
        std::mem::swap(&mut self.particles.velocity, &mut self.contact.kicks);
        self.particles.velocity.fill(SVector::zeros());
    }

    /// Adds the response to velocities of particles and DOFs.
    fn take_response(&mut self, action: &mut WallAction<T, D>) {
        let WallContact { reached, kicks, .. } = &mut self.contact;
        for (velocity, by) in reached.iter_mut().zip(&self.dofs.velocity) {
            *velocity += by;
        }
        let particles = self.particles.velocity.iter_mut().zip(&self.particles.mass);
        for ((velocity, &mass), by) in particles.zip(kicks.iter()) {
            action.impulse += by * mass;
            *velocity += by;
        }
        if const { P::FLOWS } {
            self.take_response_of_liquid();
        }
    }
}

impl<T: Scalar, const D: usize> WallContact<T, D> {
    /// Keeps the velocities that no impulse has changed yet.
    fn begin_corrections(&mut self) {
        self.free.clone_from(&self.velocity);
    }

    /// Change of the kinetic energy by the impulses so far, `R . (v* + v) / 2` relative to the walls, where
    /// `responses` are added to the velocities reached.
    fn energy_with(&self, responses: &[SVector<T, D>]) -> T {
        let half = T::one() / T::lit(2.0);
        self.dofs.contacts.iter().fold(T::zero(), |sum, contact| {
            let dof = self.dofs.dofs[contact.place] as usize;
            let mean = (self.reached[dof] + responses[dof] + self.free[contact.place]) * half;
            sum + contact.impulse().dot(&(mean - contact.wall.velocity))
        })
    }

    /// Takes the last correction back; the next one will be smaller, and sure to be found.
    fn take_back(&mut self, failures: usize) {
        self.dofs.contacts.clone_from(&self.tried);
        self.add_up_impulses();
        match failures {
            1 => self.delassus.dominate(&self.dofs),
            _ => self.delassus.enlarge(T::lit(LARGER)),
        }
    }

    /// Greatest change of velocity (m/s) at its own DOF by which a contact's impulse was corrected; no number
    /// if it is none.
    fn correction(&self) -> T {
        let mut most = T::zero();
        for (now, before) in self.dofs.contacts.iter().zip(&self.tried) {
            let change = now.impulse() - before.impulse();
            let size = change.component_mul(&self.delassus.diagonal[now.place]).norm();
            if !size.is_finite() {
                return T::lit(f64::NAN);
            }
            most = most.max(size);
        }
        most
    }

    fn read_reached(&mut self) {
        let Self {
            velocity,
            dofs,
            reached,
            ..
        } = self;
        for (own, &dof) in velocity.iter_mut().zip(&dofs.dofs) {
            *own = reached[dof as usize];
        }
    }

    /// Lays what was added to the impulses since the last time.
    fn lay_new_impulses(&mut self) {
        self.gain.fill(SVector::zeros());
        for (&dof, before) in self.dofs.dofs.iter().zip(&self.impulse) {
            self.gain[dof as usize] = -before;
        }
        self.add_up_impulses();
        for (&dof, now) in self.dofs.dofs.iter().zip(&self.impulse) {
            self.gain[dof as usize] += now;
        }
    }

    /// Lays an impulse of one along every axis at each closed contact of a colour; returns whether there is
    /// any.
    fn lay_unit_impulses(&mut self, colour: &[usize; D], shape: &[usize; D], stride: usize) -> bool {
        self.gain.fill(SVector::zeros());
        let mut any = false;
        for &k in &self.closed {
            let place = self.dofs.contacts[k as usize].place;
            let dof = self.dofs.dofs[place] as usize;
            if coordinates(dof, shape).map(|index| index % stride) == *colour {
                self.gain[dof] = SVector::from_element(T::one());
                any = true;
            }
        }
        any
    }

    /// Notes the responses of a colour's DOFs, and of those beside them.
    fn note_columns(
        &mut self,
        colour: &[usize; D],
        shape: &[usize; D],
        stride: usize,
        responses: &[SVector<T, D>],
    ) {
        for (place, &dof) in self.dofs.dofs.iter().enumerate() {
            if coordinates(dof as usize, shape).map(|index| index % stride) != *colour {
                continue;
            }
            for k in self.dofs.row(place) {
                let there = self.dofs.dofs[self.dofs.neighbours()[k] as usize];
                self.delassus.entries[k] = responses[there as usize];
            }
        }
    }
}
