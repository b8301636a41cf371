//! The impulses of walls where momenta are mapped by particle sums and divided by lumped masses: `W = N S N`.

use nalgebra::SVector;

use super::solve::Problem;
use super::{WallAction, WallContact};
use crate::basis::BasisFamily;
use crate::law::LawSweep;
use crate::phase::Phase;
use crate::reconstruction::Reconstruction;
use crate::scalar::Scalar;
use crate::stepper::Stepper;
use crate::transfer::Transfer;

/// Share of the walls' greatest relative velocity within which the contact law is to hold.
const TOLERANCE: f64 = 1e-11;

impl<T, const D: usize, B, R, L, P, X> Stepper<T, D, B, R, L, P, X>
where
    T: Scalar,
    B: BasisFamily<T, D>,
    R: Reconstruction<T, D>,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
    X: Transfer<T, D>,
{
    /// Solves for the impulses and passes them on.
    pub(super) fn push_by_sums(&mut self, scale: T) -> WallAction<T, D> {
        let contact = &mut self.contact;
        let least = (scale * T::lit(TOLERANCE)).max(contact.round_off());
        contact.delassus.sum_up(&contact.dofs, &contact.inverse);
        contact.delassus.complete(&contact.dofs);
        let mut problem = Problem {
            dofs: &mut contact.dofs,
            delassus: &contact.delassus,
            velocity: &mut contact.velocity,
            closed: &contact.closed,
            subspace: Some(&mut contact.subspace),
        };
        let solved = problem.solve(least);
        if !solved.changed {
            return WallAction::none();
        }
        contact.add_up_impulses();
        for (impulse, inverse) in contact.impulse.iter_mut().zip(&contact.inverse) {
            impulse.component_mul_assign(inverse);
        }
        let mut action = self.pass_on();
        action.solved = solved.settled;
        action
    }

    /// `v_p += sum_i phi_i N R_i`, and the momentum gained to all DOFs that the particle sees.
    fn pass_on(&mut self) -> WallAction<T, D> {
        let WallContact {
            dofs,
            near,
            impulse,
            gain,
            ..
        } = &mut self.contact;
        let (basis, grid, particles) = (&self.basis, &self.grid, &mut self.particles);
        let mut action = WallAction::none();
        gain.fill(SVector::zeros());
        for &p in near.iter() {
            let p = p as usize;
            let sites = particles.sites(self.bins.cells());
            let mut by = SVector::zeros();
            sites.for_each(basis, grid, p, |dof, phi, _| {
                if let Some(place) = dofs.place(dof) {
                    by += impulse[place] * phi;
                }
            });
            let mass = particles.mass[p];
            let momentum = by * mass;
            action.impulse += momentum;
            sites.for_each(basis, grid, p, |dof, phi, _| gain[dof] += momentum * phi);
            particles.velocity[p] += by;
        }
        let velocities = self.dofs.velocity.iter_mut().zip(&self.dofs.mass);
        for ((velocity, &mass), gain) in velocities.zip(gain.iter()) {
            if mass > T::zero() {
                *velocity += gain / mass;
            }
        }
        action
    }
}
