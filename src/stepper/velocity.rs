//! Stage 3: particle velocities, and DOF velocities from them.

use nalgebra::SVector;

use super::acceleration::Walls;
use super::matrix::Unknown;
use super::{Forcing, Stepper, cloud};
use crate::basis::BasisFamily;
use crate::field::MassMomentum;
use crate::law::ConstitutiveLaw;
use crate::mass::VelocityMass;
use crate::phase::Phase;
use crate::reconstruction::Reconstruction;
use crate::scalar::Scalar;

impl<T, const D: usize, B, R, L, P> Stepper<T, D, B, R, L, P>
where
    T: Scalar,
    B: BasisFamily<T, D>,
    R: Reconstruction<T, D>,
    L: ConstitutiveLaw<T, D>,
    P: Phase<T, D>,
{
    /// `v_p += dt sum_i phi_i(x_p) a_i`.
    pub(super) fn update_particle_velocities(&mut self, dt: T) {
        let acceleration = &self.dofs.force;
        let particles = &mut self.particles;
        for (p, x) in particles.position.iter().enumerate() {
            let mut a = SVector::zeros();
            let cell = self.bins.cell_of(p);
            self.basis
                .for_each(&self.grid, cell, x, |i, phi, _| a += acceleration[i] * phi);
            particles.velocity[p] += a * dt;
        }
    }

    /// DOF velocities by the reconstruction's mass and momentum.
    pub(super) fn map_velocities(&mut self, forcing: &Forcing<T, D>) {
        let mapped = self.map_momentum();
        self.diagnostics.record(&self.particles, mapped);
        self.divide_by_mass(forcing);
    }

    /// Momentum and mass of the DOFs; returns their totals.
    pub(super) fn map_momentum(&mut self) -> MassMomentum<T, D> {
        self.dofs.velocity.fill(SVector::zeros());
        let mass = if R::AMOUNTS_AT_PARTICLES {
            self.map_particles()
        } else if self.velocity_mass == VelocityMass::Lumped {
            self.map_lumped()
        } else {
            self.map_consistent()
        };
        MassMomentum {
            mass,
            momentum: self.dofs.velocity.iter().fold(SVector::zeros(), |s, q| s + q),
        }
    }

    /// Momentum straight from the particles; the masses are those of stage 1 already.
    fn map_particles(&mut self) -> T {
        let (basis, grid, momentum) = (&self.basis, &self.grid, &mut self.dofs.velocity);
        let (mass, velocity) = (&self.particles.mass, &self.particles.velocity);
        let cloud = cloud(grid, &self.bins, &self.particles, &self.cuts);
        self.reconstruction.integrate_conserved(
            &cloud,
            |p| velocity[p] * mass[p],
            |point, amount| {
                basis.for_each(grid, &point.cell, &point.position, |i, phi, _| {
                    momentum[i] += amount * phi;
                });
            },
        );
        if R::PARTICLE_MATRIX {
            self.dofs.matrix.total()
        } else {
            sum(&self.dofs.mass)
        }
    }

    /// Momentum and row sums of the mass from the reconstructed densities.
    fn map_lumped(&mut self) -> T {
        let (basis, grid) = (&self.basis, &self.grid);
        let (momentum, lumped) = (&mut self.dofs.velocity, &mut self.dofs.lumped);
        lumped.fill(T::zero());
        let cloud = cloud(grid, &self.bins, &self.particles, &self.cuts);
        let amounts = amounts(&self.particles.mass, &self.particles.velocity);
        self.reconstruction
            .integrate_conserved(&cloud, amounts, |point, amount| {
                basis.for_each_at_fixed_point(grid, &point.cell, &point.position, |i, phi, _| {
                    lumped[i] += amount.mass * phi;
                    momentum[i] += amount.momentum * phi;
                });
            });
        sum(&self.dofs.lumped)
    }

    /// Momentum and mass matrix from the reconstructed densities.
    fn map_consistent(&mut self) -> T {
        let (basis, grid) = (&self.basis, &self.grid);
        let (momentum, matrix) = (&mut self.dofs.velocity, &mut self.dofs.matrix);
        matrix.clear();
        let cloud = cloud(grid, &self.bins, &self.particles, &self.cuts);
        let amounts = amounts(&self.particles.mass, &self.particles.velocity);
        self.reconstruction
            .integrate_conserved(&cloud, amounts, |point, amount| {
                let (cell, x) = (&point.cell, &point.position);
                basis.for_each_at_fixed_point(grid, cell, x, |i, phi_i, _| {
                    momentum[i] += amount.momentum * phi_i;
                    let m = amount.mass * phi_i;
                    basis.for_each_at_fixed_point(grid, cell, x, |j, phi_j, _| {
                        matrix.add(i, j, m * phi_j);
                    });
                });
            });
        self.dofs.matrix.total()
    }

    /// Momentum to velocity, with the told values at held DOFs. DOFs without mass are at rest.
    pub(super) fn divide_by_mass(&mut self, forcing: &Forcing<T, D>) {
        let own_lumped = !R::AMOUNTS_AT_PARTICLES && self.velocity_mass == VelocityMass::Lumped;
        if own_lumped || R::AMOUNTS_AT_PARTICLES && !R::PARTICLE_MATRIX {
            self.divide_by_lumped_mass();
        } else {
            let pick = |velocity, _| velocity;
            let walls = Walls::of_solid(&self.face_dofs, forcing);
            self.dofs
                .solve(Unknown::Velocity, self.velocity_mass, &walls, true, pick);
        }
        let velocities = &mut self.dofs.velocity;
        Walls::of_solid(&self.face_dofs, forcing).for_each_held(|dof, axis, velocity, _| {
            velocities[dof][axis] = velocity;
        });
    }

    fn divide_by_lumped_mass(&mut self) {
        let dofs = &mut self.dofs;
        let mass = if R::AMOUNTS_AT_PARTICLES {
            &dofs.mass
        } else {
            &dofs.lumped
        };
        divide(&mut dofs.velocity, mass);
    }
}

/// Momentum to velocity, DOF by DOF.
pub(super) fn divide<T: Scalar, const D: usize>(velocity: &mut [SVector<T, D>], mass: &[T]) {
    for (velocity, &mass) in velocity.iter_mut().zip(mass) {
        // A fitted density may be negative somewhere; only a vanishing mass has no velocity.
        *velocity = if mass == T::zero() {
            SVector::zeros()
        } else {
            *velocity / mass
        };
    }
}

/// Mass and momentum of each particle.
fn amounts<'a, T: Scalar, const D: usize>(
    mass: &'a [T],
    velocity: &'a [SVector<T, D>],
) -> impl Fn(usize) -> MassMomentum<T, D> + 'a {
    move |p| MassMomentum {
        mass: mass[p],
        momentum: velocity[p] * mass[p],
    }
}

pub(super) fn sum<T: Scalar>(values: &[T]) -> T {
    values.iter().fold(T::zero(), |sum, &v| sum + v)
}
