//! Walls that rub, with a liquid that flows through the pores: effective stress rubs.
//!
#![doc = include_str!("../../../docs/formulas.html")]
//!
//! A wall acts on the whole of both phases by one impulse $R$ at each of its DOFs. Where the liquid does not
//! pass it, liquid and solid have one velocity along the normal there, as at every sealed surface
//! (`liquid/seal`): a closed contact is one more equation of the slip, part of every mapping of the step. The
//! normal impulse $R_n \ge 0$ of the whole keeps both from passing and lets both go, so that a wall does not
//! suck. The pressure by which it keeps the liquid from flowing out of the body, the multiplier of that
//! equation, is what the liquid bears of it: with the impulse $L$ on the liquid of DOF (mass $\bar m_w = n
//! m_w$) the pressure times area and time is $L/n$, and the grains press with what is left (Terzaghi),
//!
//! $$R' = R_n - L/n,\qquad |R_t| \le \mu\max(R', 0).$$
//!
//! From the balance of the liquid at the DOF, $L = \bar m_w\Delta v - \Delta t\,(n f_w + \bar m_w b)$, and of
//! the whole, $R_n = m\Delta v - \Delta t\,(f + m b)$, follows $R' = (m - m_w)(\Delta v - \Delta t\,b) -
//! \Delta t\,(f - f_w)$: the force of the effective stress, and the weight under buoyancy. While both move as
//! one $L$ is $\bar m_w/m$ of $R_n$ and something besides, so that the bound of friction is linear in $R_n$
//! where it is not zero.
//!
//! Along the wall the liquid slides without friction; what the solid gains there the drag of the step shares
//! with it, as at a held face: otherwise the liquid of a body that sticks would creep by $g\,\Delta t$ in
//! every step, whatever the permeability. Where the liquid passes the wall freely the impulse is the solid's
//! alone, all of it effective, and the pressure outside loads the surface of the body
//! (`liquid/surface`).

use nalgebra::SVector;

use super::{WallAction, WallContact};
use crate::basis::BasisFamily;
use crate::grid::{Face, Side};
use crate::law::LawSweep;
use crate::phase::{Drag, Phase, PoreLiquid};
use crate::reconstruction::Reconstruction;
use crate::scalar::Scalar;
use crate::stepper::acceleration::Walls;
use crate::stepper::inner::Inner;
use crate::stepper::sweeps::Sweeps;
use crate::stepper::{Forcing, PoreCondition, Stepper};
use crate::transfer::Transfer;

/// What a wall that rubs did in a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallImpulse<T, const D: usize> {
    /// Change of the momentum (N s) of all that touches it, its liquid included.
    pub whole: SVector<T, D>,
    /// Normal impulse (N s) by which the solid presses: that of the whole less what the liquid's pressure
    /// bears. Friction is at most the coefficient times this.
    pub effective: T,
}

/// The liquid at walls that rub; nothing where none flows.
#[derive(Clone, Debug)]
pub(super) struct LiquidAtWalls<T, const D: usize> {
    /// Of all DOFs and particles: velocities so far, and changes of velocity.
    reached: Vec<SVector<T, D>>,
    kicks: Vec<SVector<T, D>>,
    /// Of each contact: the impulse (N s) that its pressure bears, and by how much the last response changes
    /// it.
    borne: Vec<T>,
    answer: Vec<T>,
}

impl<T: Scalar, const D: usize> LiquidAtWalls<T, D> {
    pub(super) fn none() -> Self {
        Self {
            reached: Vec::new(),
            kicks: Vec::new(),
            borne: Vec::new(),
            answer: Vec::new(),
        }
    }

    pub(super) fn lay(&mut self, dofs: usize, particles: usize, contacts: usize) {
        self.reached = vec![SVector::zeros(); dofs];
        self.kicks = vec![SVector::zeros(); particles];
        self.borne = vec![T::zero(); contacts];
        self.answer = vec![T::zero(); contacts];
    }

    /// The velocities that no impulse has changed yet.
    pub(super) fn begin(&mut self, velocities: &[SVector<T, D>]) {
        self.reached.copy_from_slice(velocities);
    }

    pub(super) fn bytes(&self) -> usize {
        size_of::<SVector<T, D>>() * (self.reached.capacity() + self.kicks.capacity())
            + size_of::<T>() * (self.borne.capacity() + self.answer.capacity())
    }
}

impl<T: Scalar, const D: usize> WallContact<T, D> {
    /// Whether a DOF on a face touches a wall that rubs there.
    pub(in super::super) fn touches(&self, dof: usize, face: Face) -> bool {
        self.dofs.is_closed(dof, face)
    }

    /// The columns of the Delassus operator of particle sums, as if the liquid's mass were everywhere the
    /// same share and no other surface sealed near: what is left is corrected.
    pub(super) fn estimate_columns(&mut self) {
        self.delassus.sum_up(&self.dofs, &self.inverse);
        self.delassus.complete(&self.dofs);
    }

    /// Velocities of the liquid's DOFs at the end, and the momentum that both phases took from the walls.
    pub(super) fn end_with_liquid(&self, velocities: &mut [SVector<T, D>], action: &mut WallAction<T, D>) {
        velocities.copy_from_slice(&self.liquid.reached);
        let impulses = self.dofs.contacts.iter().map(|contact| contact.impulse());
        action.impulse = impulses.fold(SVector::zeros(), |sum, impulse| sum + impulse);
    }

    /// What the liquid bears besides its share, now that it bears so much.
    fn split_pressure(&mut self) {
        for (contact, &borne) in self.dofs.contacts.iter_mut().zip(&self.liquid.borne) {
            contact.pressed = borne - contact.relief * contact.normal;
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
    /// What the wall at a face that rubs did in the last step in which one did.
    pub fn wall_impulse(&self, face: Face) -> WallImpulse<T, D> {
        let contacts = &self.inner.contact.dofs.contacts;
        let there = contacts.iter().filter(|contact| contact.wall.face == face);
        let none = WallImpulse {
            whole: SVector::zeros(),
            effective: T::zero(),
        };
        there.fold(none, |sum, contact| WallImpulse {
            whole: sum.whole + contact.impulse(),
            effective: sum.effective + contact.effective(),
        })
    }
}

impl<T, const D: usize, L, P, X> Inner<T, D, L, P, X>
where
    T: Scalar,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
    X: Transfer<T, D>,
{
    /// Finds the contacts that are closed: positions, and with them what walls seal, are those of the whole
    /// step.
    pub(in super::super) fn find_contacts<B: BasisFamily<T, D>>(
        &mut self,
        basis: &B,
        forcing: &Forcing<T, D>,
    ) {
        self.contact.closed.clear();
        if const { X::FROM_GRID } || !super::rub(forcing) {
            // What touched walls of a step before seals nothing now.
            self.contact
                .dofs
                .contacts
                .iter_mut()
                .for_each(|contact| contact.closed = false);
            return;
        }
        let laid = self.contact.liquid.borne.len();
        self.detect_contacts(basis, forcing);
        let contacts = self.contact.dofs.contacts.len();
        if contacts != laid {
            self.seal.enlarge(contacts);
        }
    }

    /// Adds to the sealed surfaces the contacts that are closed.
    pub(in super::super) fn seal_contacts<B: BasisFamily<T, D>>(
        &mut self,
        basis: &B,
        forcing: &Forcing<T, D>,
    ) {
        let shape = basis.dofs(&self.grid);
        let size = self.grid.cell_size();
        let cell = size.iter().fold(T::one(), |product, &h| product * h);
        for &k in &self.contact.closed {
            let contact = &self.contact.dofs.contacts[k as usize];
            let face = contact.wall.face;
            if forcing.pores(face) == PoreCondition::Sealed {
                let dof = self.contact.dofs.dofs[contact.place] as usize;
                self.seal.add_contact(face, dof, shape, cell / size[face.axis]);
            }
        }
    }

    /// Notes what the liquid's pressure bears at closed contacts in a step of size `dt`, before walls act.
    pub(in super::super) fn note_pressure_on_walls(&mut self, dt: T) {
        if self.contact.closed.is_empty() {
            return;
        }
        self.measure_pressure(dt);
        let liquid = &mut self.contact.liquid;
        liquid.borne.copy_from_slice(&liquid.answer);
    }

    /// Impulse over `dt` of the seal's force at each contact, as it was solved for last.
    fn measure_pressure(&mut self, dt: T) {
        let share = dt / self.phase.porosity();
        let WallContact { dofs, liquid, .. } = &mut self.contact;
        for (contact, answer) in dofs.contacts.iter().zip(&mut liquid.answer) {
            let face = contact.wall.face;
            let dof = dofs.dofs[contact.place] as usize;
            let force = match contact.closed {
                true => self.seal.force::<D>(dof, face.axis).unwrap_or_else(T::zero),
                false => T::zero(),
            };
            *answer = share
                * match face.side {
                    Side::Min => force,
                    Side::Max => -force,
                };
        }
    }

    /// What an impulse at each wall's DOF does to its solid, and what the liquid bears of it.
    pub(super) fn answer_of_both(&mut self, dt: T, forcing: &Forcing<T, D>) {
        let n = self.phase.porosity();
        let dt = match self.phase.drag_treatment() {
            Drag::Implicit => dt,
            Drag::Explicit => T::zero(),
        };
        let WallContact { dofs, inverse, .. } = &mut self.contact;
        for (inverse, &dof) in inverse.iter_mut().zip(&dofs.dofs) {
            let dof = dof as usize;
            let (m_s, m_bar, drag) = (self.dofs.mass[dof], self.liquid.mass[dof], self.drag[dof] * dt);
            *inverse = SVector::from_element(solid_alone([m_s, m_bar], drag, n));
        }
        for contact in &mut dofs.contacts {
            let face = contact.wall.face;
            if !contact.closed || forcing.pores(face) != PoreCondition::Sealed {
                continue;
            }
            let dof = dofs.dofs[contact.place] as usize;
            let (m_s, m_bar) = (self.dofs.mass[dof], self.liquid.mass[dof]);
            if m_s > T::zero() && m_bar > T::zero() {
                inverse[contact.place][face.axis] = T::one() / (m_s * (T::one() + m_bar / m_s).sqrt());
                contact.relief = T::one() / ((T::one() + m_s / m_bar) * n);
            }
        }
        Walls::of_solid(&self.face_dofs, forcing).for_each_held(|dof, axis, _, _| {
            if let Some(place) = dofs.place(dof) {
                inverse[place][axis] = T::zero();
            }
        });
        self.contact.split_pressure();
    }

    /// Puts the particles' liquid velocities aside and lets them be zero, or exchanges them with what was put
    /// aside.
    fn exchange_liquid_kicks(&mut self, zero: bool) {
        let phase = &self.phase;
        for (data, kick) in self
            .particles
            .phase
            .iter_mut()
            .zip(&mut self.contact.liquid.kicks)
        {
            let PoreLiquid { velocity, pressure } = phase.liquid(data);
            let next = std::mem::replace(kick, velocity);
            let velocity = match zero {
                true => SVector::zeros(),
                false => next,
            };
            phase.set_liquid(PoreLiquid { velocity, pressure }, data);
        }
    }

    /// Adds the liquid's response to its velocities, and to what its pressure bears.
    pub(super) fn take_response_of_liquid(&mut self) {
        let liquid = &mut self.contact.liquid;
        for (velocity, by) in liquid.reached.iter_mut().zip(&self.liquid.velocity) {
            *velocity += by;
        }
        for (data, &by) in self.particles.phase.iter_mut().zip(&liquid.kicks) {
            self.phase.accelerate_liquid(by, data);
        }
        for (borne, answer) in liquid.borne.iter_mut().zip(&liquid.answer) {
            *borne += *answer;
        }
        self.contact.split_pressure();
    }
}

/// Changes of velocity of both phases' particles and DOFs by the impulses laid at the DOFs; the latter's take
/// the place of the velocities.
pub(super) fn respond_with_both<T, const D: usize, L, P, X>(
    stepper: &mut dyn Sweeps<T, D, L, P, X>,
    dt: T,
    rest: &Forcing<T, D>,
) where
    T: Scalar,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
    X: Transfer<T, D>,
{
    let inner = stepper.inner();
    for dofs in [&mut inner.dofs, &mut inner.liquid] {
        dofs.velocity.fill(SVector::zeros());
    }
    inner.dofs.force.copy_from_slice(&inner.contact.gain);
    inner.liquid.force.fill(SVector::zeros());
    // Forces of one second for impulses; drag takes the step that it has.
    inner.accelerate_both(dt, rest);
    inner.measure_pressure(T::one());
    std::mem::swap(&mut inner.particles.velocity, &mut inner.contact.kicks);
    inner.particles.velocity.fill(SVector::zeros());
    inner.exchange_liquid_kicks(true);
    stepper.kick_particles(T::one());
    stepper.map_momenta();
    let inner = stepper.inner();
    inner.divide_both(dt, rest, false);
    inner.exchange_liquid_kicks(false);
    std::mem::swap(&mut inner.particles.velocity, &mut inner.contact.kicks);
}

/// Root of what an impulse at a DOF, of the solid's and the liquid's mass, adds to the solid's velocity there
/// and, mapped again, to that of DOFs beside per solid mass between them: where liquid and solid may slip,
/// and `drag` is that of the step.
fn solid_alone<T: Scalar>([m_s, m_bar]: [T; 2], drag: T, n: T) -> T {
    if !(m_s > T::zero() && m_bar > T::zero()) {
        return T::zero();
    }
    let ratio = m_bar / m_s;
    let taken = ratio * drag / (m_bar / n + drag * (T::one() + ratio));
    (T::one() - taken).sqrt() / m_s
}
