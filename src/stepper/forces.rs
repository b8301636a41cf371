//! Stage 1: lumped mass and forces of the DOFs.

use nalgebra::{SMatrix, SVector};

use super::{FaceCondition, Forcing, Stepper, cloud};
use crate::basis::BasisFamily;
use crate::law::ConstitutiveLaw;
use crate::phase::Phase;
use crate::reconstruction::{Cloud, Reconstruction};
use crate::scalar::Scalar;

impl<T, const D: usize, B, R, L, P> Stepper<T, D, B, R, L, P>
where
    T: Scalar,
    B: BasisFamily<T, D>,
    R: Reconstruction<T, D>,
    L: ConstitutiveLaw<T, D>,
    P: Phase<T, D>,
{
    pub(super) fn assemble_forces(&mut self, forcing: &Forcing<T, D>) {
        let cloud = cloud(&self.grid, &self.bins, &self.particles, &self.cuts);
        let effective = &self.particles.stress;
        let (basis, force) = (&self.basis, &mut self.dofs.force);
        // Two closures rather than one with a branch: what a closure holds costs instructions even where it is not used.
        if P::COUPLED {
            let (phase, data) = (&self.phase, &self.particles.phase);
            let total = |p: usize| phase.total_stress(&effective[p], &data[p]);
            internal_force(basis, &mut self.reconstruction, &cloud, total, force);
        } else {
            internal_force(basis, &mut self.reconstruction, &cloud, |p| effective[p], force);
        }
        self.add_tractions(forcing);
    }

    /// `m_i = sum_p m_p phi_i`, and `M_ij = sum_p m_p phi_i phi_j` where the reconstruction wants it.
    pub(super) fn lump_mass(&mut self) {
        if R::PARTICLE_MATRIX {
            self.assemble_particle_matrix();
        }
        if P::FLOWS {
            return self.sum_masses(false);
        }
        let mass = &mut self.dofs.mass;
        mass.fill(T::zero());
        for (p, x) in self.particles.position.iter().enumerate() {
            let m = self.particles.mass[p];
            let cell = self.bins.cell_of(p);
            self.basis
                .for_each(&self.grid, cell, x, |i, phi, _| mass[i] += m * phi);
        }
    }

    fn assemble_particle_matrix(&mut self) {
        let (basis, grid, matrix) = (&self.basis, &self.grid, &mut self.dofs.matrix);
        matrix.clear();
        let particles = self.particles.position.iter().zip(&self.particles.mass);
        for (p, (x, &mass)) in particles.enumerate() {
            let cell = self.bins.cell_of(p);
            basis.for_each(grid, cell, x, |i, phi_i, _| {
                let m = mass * phi_i;
                basis.for_each(grid, cell, x, |j, phi_j, _| matrix.add(i, j, m * phi_j));
            });
        }
    }

    fn add_tractions(&mut self, forcing: &Forcing<T, D>) {
        for k in 0..self.surface.len() {
            let point = &self.surface[k];
            let FaceCondition::Traction(traction) = forcing.face(point.face) else {
                continue;
            };
            let x = self.surface_position(point);
            let cell = self.bins.cell_of(point.particle);
            let load = traction * point.area;
            let force = &mut self.dofs.force;
            self.basis
                .for_each(&self.grid, cell, &x, |i, phi, _| force[i] += load * phi);
        }
    }
}

/// `f_i = -integral(sigma grad phi_i)`, the stress given per particle.
pub(super) fn internal_force<T, const D: usize, B, R>(
    basis: &B,
    reconstruction: &mut R,
    cloud: &Cloud<'_, T, D>,
    stress: impl Fn(usize) -> SMatrix<T, D, D>,
    force: &mut [SVector<T, D>],
) where
    T: Scalar,
    B: BasisFamily<T, D>,
    R: Reconstruction<T, D>,
{
    force.fill(SVector::zeros());
    reconstruction.integrate(cloud, stress, |point, weighted| {
        let add = |i: usize, _, gradient| force[i] -= weighted * gradient;
        if R::FIELDS_MOVE {
            basis.for_each(cloud.grid, &point.cell, &point.position, add);
        } else {
            basis.for_each_at_fixed_point(cloud.grid, &point.cell, &point.position, add);
        }
    });
}
