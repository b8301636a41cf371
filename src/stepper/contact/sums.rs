//! The impulses of walls where momenta are mapped by particle sums and divided by lumped masses: `W = N S N`.

use nalgebra::SVector;

use super::solve::Problem;
use super::{WallAction, WallContact};
use crate::basis::BasisFamily;
use crate::grid::{Cell, Grid};
use crate::particles::Particles;
use crate::scalar::Scalar;
use crate::stepper::dofs::Dofs;

/// Share of the walls' greatest relative velocity within which the contact law is to hold.
const TOLERANCE: f64 = 1e-11;

/// Solves for the impulses and passes them on.
#[inline(never)]
pub(super) fn push_by_sums<T: Scalar, const D: usize, B: BasisFamily<T, D>, N, Q>(
    space: (&B, &Grid<T, D>, &[Cell<D>]),
    particles: &mut Particles<T, D, N, Q>,
    scale: T,
    contact: &mut WallContact<T, D>,
    dofs: &mut Dofs<T, D>,
) -> WallAction<T, D> {
    let Some(settled) = contact.solve_for_sums(scale) else {
        return WallAction::none();
    };
    let mut action = pass_on(space, particles, contact, dofs);
    action.solved = settled;
    action
}

impl<T: Scalar, const D: usize> WallContact<T, D> {
    /// The velocities that the impulses give to the walls' DOFs; whether they were found within the
    /// tolerance, and nothing where there is no impulse.
    #[inline(never)]
    fn solve_for_sums(&mut self, scale: T) -> Option<bool> {
        let least = (scale * T::lit(TOLERANCE)).max(self.round_off());
        self.delassus.sum_up(&self.dofs, &self.inverse);
        self.delassus.complete(&self.dofs);
        let mut problem = Problem {
            dofs: &mut self.dofs,
            delassus: &self.delassus,
            velocity: &mut self.velocity,
            closed: &self.closed,
            subspace: Some(&mut self.subspace),
        };
        let solved = problem.solve(least);
        if !solved.changed {
            return None;
        }
        self.add_up_impulses();
        for (impulse, inverse) in self.impulse.iter_mut().zip(&self.inverse) {
            impulse.component_mul_assign(inverse);
        }
        Some(solved.settled)
    }
}

/// `v_p += sum_i phi_i N R_i`, and the momentum gained to all DOFs that the particle sees.
fn pass_on<T: Scalar, const D: usize, B: BasisFamily<T, D>, N, Q>(
    (basis, grid, cells): (&B, &Grid<T, D>, &[Cell<D>]),
    particles: &mut Particles<T, D, N, Q>,
    contact: &mut WallContact<T, D>,
    all: &mut Dofs<T, D>,
) -> WallAction<T, D> {
    let WallContact {
        dofs,
        near,
        impulse,
        gain,
        ..
    } = contact;
    let mut action = WallAction::none();
    gain.fill(SVector::zeros());
    for &p in near.iter() {
        let p = p as usize;
        let sites = particles.sites(cells);
        let mut by = SVector::zeros();
        sites.for_each(basis, grid, p, |dof, phi, _| {
            if let Some(place) = dofs.place(dof) {
                by += impulse[place] * phi;
            }
        });
        let momentum = by * particles.mass[p];
        action.impulse += momentum;
        sites.for_each(basis, grid, p, |dof, phi, _| gain[dof] += momentum * phi);
        particles.velocity[p] += by;
    }
    let velocities = all.velocity.iter_mut().zip(&all.mass);
    for ((velocity, &mass), gain) in velocities.zip(gain.iter()) {
        if mass > T::zero() {
            *velocity += gain / mass;
        }
    }
    action
}
