//! Velocities of both phases: of the particles, and of the DOFs from them.

use nalgebra::SVector;

use super::super::acceleration::Walls;
use super::super::matrix::Unknown;
use super::super::velocity::{divide, sum};
use super::super::{Dofs, Forcing, Stepper, cloud};
use crate::basis::BasisFamily;
use crate::field::{MassMomentum, Pair};
use crate::law::ConstitutiveLaw;
use crate::mass::{Banded, VelocityMass};
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
    /// `v_p += dt sum_i phi_i(x_p) a_i` for both phases.
    pub(in super::super) fn update_both_velocities(&mut self, dt: T) {
        let (solid, liquid) = (&self.dofs.force, &self.liquid.force);
        let particles = &mut self.particles;
        for (p, x) in particles.position.iter().enumerate() {
            let (mut a_s, mut a_w) = (SVector::zeros(), SVector::zeros());
            let cell = self.bins.cell_of(p);
            self.basis.for_each(&self.grid, cell, x, |i, phi, _| {
                a_s += solid[i] * phi;
                a_w += liquid[i] * phi;
            });
            particles.velocity[p] += a_s * dt;
            self.phase.accelerate_liquid(a_w * dt, &mut particles.phase[p]);
        }
    }

    /// DOF velocities of both phases at the step's start. Their masses serve the mapping after the update too: nothing has
    /// moved by then.
    pub(in super::super) fn map_both_before(&mut self, forcing: &Forcing<T, D>) {
        if !R::AMOUNTS_AT_PARTICLES {
            match self.velocity_mass {
                VelocityMass::Lumped => self.lump_fitted_masses(),
                VelocityMass::Consistent | VelocityMass::Constrained => self.assemble_both_matrices(),
            }
        }
        self.map_both_momenta();
        self.divide_both(forcing, true);
    }

    /// DOF velocities of both phases from the updated particles.
    pub(in super::super) fn map_both_after(&mut self, forcing: &Forcing<T, D>) {
        self.map_both_momenta();
        let mapped = [&self.dofs, &self.liquid].map(|dofs| MassMomentum {
            mass: mapped_mass::<T, D, R>(dofs, self.velocity_mass),
            momentum: dofs.velocity.iter().fold(SVector::zeros(), |s, q| s + q),
        });
        self.record_both(mapped);
        self.divide_both(forcing, false);
    }

    fn map_both_momenta(&mut self) {
        let (basis, grid, phase) = (&self.basis, &self.grid, &self.phase);
        let (solid, liquid) = (&mut self.dofs.velocity, &mut self.liquid.velocity);
        solid.fill(SVector::zeros());
        liquid.fill(SVector::zeros());
        let particles = &self.particles;
        let cloud = cloud(grid, &self.bins, particles, &self.cuts);
        let momenta = |p: usize| {
            let liquid = phase.liquid(&particles.phase[p]).velocity * phase.liquid_mass(particles.volume[p]);
            Pair(particles.velocity[p] * particles.mass[p], liquid)
        };
        self.reconstruction
            .integrate_conserved(&cloud, momenta, |point, Pair(q_s, q_w)| {
                let add = |i: usize, phi: T, _| {
                    solid[i] += q_s * phi;
                    liquid[i] += q_w * phi;
                };
                if R::AMOUNTS_AT_PARTICLES {
                    basis.for_each(grid, &point.cell, &point.position, add);
                } else {
                    basis.for_each_at_fixed_point(grid, &point.cell, &point.position, add);
                }
            });
    }

    /// Row sums of both masses from the reconstructed densities.
    fn lump_fitted_masses(&mut self) {
        let (basis, grid, phase) = (&self.basis, &self.grid, &self.phase);
        let (solid, liquid) = (&mut self.dofs.lumped, &mut self.liquid.lumped);
        solid.fill(T::zero());
        liquid.fill(T::zero());
        let particles = &self.particles;
        let cloud = cloud(grid, &self.bins, particles, &self.cuts);
        let masses = |p: usize| Pair(particles.mass[p], phase.liquid_mass(particles.volume[p]));
        self.reconstruction
            .integrate_conserved(&cloud, masses, |point, Pair(m_s, m_w)| {
                basis.for_each_at_fixed_point(grid, &point.cell, &point.position, |i, phi, _| {
                    solid[i] += m_s * phi;
                    liquid[i] += m_w * phi;
                });
            });
    }

    /// Mass matrices of both phases from the reconstructed densities.
    fn assemble_both_matrices(&mut self) {
        let (basis, grid, phase) = (&self.basis, &self.grid, &self.phase);
        let (solid, liquid): (&mut Banded<T>, &mut Banded<T>) =
            (&mut self.dofs.matrix, &mut self.liquid.matrix);
        solid.clear();
        liquid.clear();
        let particles = &self.particles;
        let cloud = cloud(grid, &self.bins, particles, &self.cuts);
        let masses = |p: usize| Pair(particles.mass[p], phase.liquid_mass(particles.volume[p]));
        self.reconstruction
            .integrate_conserved(&cloud, masses, |point, Pair(m_s, m_w)| {
                let (cell, x) = (&point.cell, &point.position);
                basis.for_each_at_fixed_point(grid, cell, x, |i, phi_i, _| {
                    let (m_s, m_w) = (m_s * phi_i, m_w * phi_i);
                    basis.for_each_at_fixed_point(grid, cell, x, |j, phi_j, _| {
                        solid.add(i, j, m_s * phi_j);
                        liquid.add(i, j, m_w * phi_j);
                    });
                });
            });
    }

    /// Momenta to velocities, with the told values at held DOFs.
    fn divide_both(&mut self, forcing: &Forcing<T, D>, fresh: bool) {
        let walls = [
            Walls::of_solid(&self.face_dofs, forcing),
            Walls::of_liquid(&self.face_dofs, forcing),
        ];
        for (dofs, walls) in [&mut self.dofs, &mut self.liquid].into_iter().zip(walls) {
            let mass = self.velocity_mass;
            if R::AMOUNTS_AT_PARTICLES {
                divide(&mut dofs.velocity, &dofs.mass);
            } else if mass == VelocityMass::Lumped {
                divide(&mut dofs.velocity, &dofs.lumped);
            } else {
                dofs.solve(Unknown::Velocity, mass, &walls, fresh, |velocity, _| velocity);
            }
            let velocities = &mut dofs.velocity;
            walls.for_each_held(|dof, axis, velocity, _| velocities[dof][axis] = velocity);
        }
    }
}

/// Total of the mass that turns momentum into velocity.
fn mapped_mass<T: Scalar, const D: usize, R: Reconstruction<T, D>>(
    dofs: &Dofs<T, D>,
    mass: VelocityMass,
) -> T {
    if R::AMOUNTS_AT_PARTICLES {
        sum(&dofs.mass)
    } else if mass == VelocityMass::Lumped {
        sum(&dofs.lumped)
    } else {
        dofs.matrix.total()
    }
}
