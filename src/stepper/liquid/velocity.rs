//! Velocities of both phases: of the particles, and of the DOFs from them.

use nalgebra::SVector;

use super::super::acceleration::Walls;
use super::super::cell_sums::CellSums;
use super::super::diagnostics::Totals;
use super::super::matrix::Unknown;
use super::super::velocity::{divide, sum};
use super::super::{Dofs, Forcing, Stepper, cloud};
use crate::basis::BasisFamily;
use crate::field::{MassMomentum, Pair};
use crate::law::LawSweep;
use crate::mass::VelocityMass;
use crate::particles::Particles;
use crate::phase::Phase;
use crate::reconstruction::Reconstruction;
use crate::scalar::Scalar;

impl<T, const D: usize, B, R, L, P> Stepper<T, D, B, R, L, P>
where
    T: Scalar,
    B: BasisFamily<T, D>,
    R: Reconstruction<T, D>,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
{
    /// DOF velocities of both phases at the step's start. The masses of the mapping serve again after the update: nothing has
    /// moved by then.
    pub(in super::super) fn map_both_before(&mut self, dt: T, forcing: &Forcing<T, D>) {
        if !R::AMOUNTS_AT_PARTICLES {
            self.clear_momenta();
            match self.velocity_mass {
                VelocityMass::Lumped => self.integrate_lumped(),
                VelocityMass::Consistent | VelocityMass::Constrained => self.integrate_consistent(),
            }
        }
        self.divide_both(dt, forcing, true);
    }

    /// `v_p += dt sum_i phi_i(x_p) a_i` for both phases, and the DOF velocities from the updated particles.
    pub(in super::super) fn update_both_velocities(&mut self, dt: T, forcing: &Forcing<T, D>) {
        self.lay_accelerations();
        let totals = if R::PARTICLE_MATRIX {
            let totals = self.accelerate_particles(dt);
            self.relax_both(dt);
            self.map_particles_of_both();
            totals
        } else if R::AMOUNTS_AT_PARTICLES {
            self.accelerate_and_sum_particles(dt)
        } else {
            let totals = self.accelerate_particles(dt);
            self.clear_momenta();
            self.integrate_momenta();
            totals
        };
        let mapped = [&self.dofs, &self.liquid].map(|dofs| MassMomentum {
            mass: mapped_mass::<T, D, R>(dofs, self.velocity_mass),
            momentum: dofs.velocity.iter().fold(SVector::zeros(), |s, q| s + q),
        });
        self.diagnostics.record_both(&totals, mapped);
        self.divide_both(dt, forcing, false);
        self.lay_velocities();
    }

    #[inline(never)]
    fn accelerate_particles(&mut self, dt: T) -> Totals<T, D> {
        let (basis, grid, phase, motion) = (&self.basis, &self.grid, &self.phase, &self.motion[..]);
        let particles = &mut self.particles;
        let mut totals = Totals::zero();
        let places = particles.position.iter().zip(self.bins.cells());
        let bodies = particles.mass.iter().zip(&particles.volume);
        let moving = particles.velocity.iter_mut().zip(&mut particles.phase);
        for (((x, cell), (&mass, &volume)), (velocity, data)) in places.zip(bodies).zip(moving) {
            let (mut a_s, mut a_w) = (SVector::zeros(), SVector::zeros());
            basis.for_each(grid, cell, x, |i, phi, _| {
                let [solid, liquid] = &motion[i];
                a_s += solid * phi;
                a_w += liquid * phi;
            });
            *velocity += a_s * dt;
            phase.accelerate_liquid(a_w * dt, data);
            let m_w = phase.liquid_mass(volume);
            totals.add(*velocity * mass, phase.liquid(data).velocity * m_w, m_w);
        }
        totals
    }

    /// The same where the particles are the points of the mapping: their new momenta are summed in the same pass.
    #[inline(never)]
    fn accelerate_and_sum_particles(&mut self, dt: T) -> Totals<T, D> {
        let (basis, grid, phase, motion) = (&self.basis, &self.grid, &self.phase, &self.motion[..]);
        let (solid, liquid) = (&mut self.dofs.velocity[..], &mut self.liquid.velocity[..]);
        solid.fill(SVector::zeros());
        liquid.fill(SVector::zeros());
        let particles = &mut self.particles;
        let mut totals = Totals::zero();
        let mut momenta = CellSums::new(basis, grid);
        let mut sink = |i: usize, Pair(q_s, q_w)| {
            solid[i] += q_s;
            liquid[i] += q_w;
        };
        let places = particles.position.iter().zip(self.bins.cells());
        let bodies = particles.mass.iter().zip(&particles.volume);
        let moving = particles.velocity.iter_mut().zip(&mut particles.phase);
        for (((x, cell), (&mass, &volume)), (velocity, data)) in places.zip(bodies).zip(moving) {
            let (mut a_s, mut a_w) = (SVector::zeros(), SVector::zeros());
            basis.for_each(grid, cell, x, |i, phi, _| {
                let [solid, liquid] = &motion[i];
                a_s += solid * phi;
                a_w += liquid * phi;
            });
            *velocity += a_s * dt;
            phase.accelerate_liquid(a_w * dt, data);
            let m_w = phase.liquid_mass(volume);
            let (q_s, q_w) = (*velocity * mass, phase.liquid(data).velocity * m_w);
            totals.add(q_s, q_w, m_w);
            momenta.add(cell, x, |phi, _| Pair(q_s * phi, q_w * phi), &mut sink);
        }
        momenta.flush(&mut sink);
        totals
    }

    fn clear_momenta(&mut self) {
        self.dofs.velocity.fill(SVector::zeros());
        self.liquid.velocity.fill(SVector::zeros());
    }

    /// Momenta from the reconstructed densities. Where a mass had to be kept positive its momentum was drawn towards the mean with
    /// it, and must be again.
    fn integrate_momenta(&mut self) {
        if self.reconstruction.limited_cells() > 0 {
            return self.integrate_momenta_of_masses();
        }
        let (basis, grid, phase) = (&self.basis, &self.grid, &self.phase);
        let (solid, liquid) = (&mut self.dofs.velocity, &mut self.liquid.velocity);
        let cloud = cloud(grid, &self.bins, &self.particles, &self.cuts);
        let momenta = momenta(phase, &self.particles);
        self.reconstruction
            .integrate_conserved(&cloud, momenta, |point, Pair(q_s, q_w)| {
                basis.for_each_at_fixed_point(grid, &point.cell, &point.position, |i, phi, _| {
                    solid[i] += q_s * phi;
                    liquid[i] += q_w * phi;
                });
            });
    }

    #[cold]
    fn integrate_momenta_of_masses(&mut self) {
        let (basis, grid, phase) = (&self.basis, &self.grid, &self.phase);
        let (solid, liquid) = (&mut self.dofs.velocity, &mut self.liquid.velocity);
        let cloud = cloud(grid, &self.bins, &self.particles, &self.cuts);
        let amounts = amounts(phase, &self.particles);
        self.reconstruction
            .integrate_conserved(&cloud, amounts, |point, Pair(of_solid, of_liquid)| {
                basis.for_each_at_fixed_point(grid, &point.cell, &point.position, |i, phi, _| {
                    solid[i] += of_solid.momentum * phi;
                    liquid[i] += of_liquid.momentum * phi;
                });
            });
    }

    /// Momenta and row sums of both masses from the reconstructed densities.
    fn integrate_lumped(&mut self) {
        let (basis, grid, phase) = (&self.basis, &self.grid, &self.phase);
        let (solid, liquid) = (&mut self.dofs, &mut self.liquid);
        solid.lumped.fill(T::zero());
        liquid.lumped.fill(T::zero());
        let cloud = cloud(grid, &self.bins, &self.particles, &self.cuts);
        let amounts = amounts(phase, &self.particles);
        self.reconstruction
            .integrate_conserved(&cloud, amounts, |point, Pair(of_solid, of_liquid)| {
                basis.for_each_at_fixed_point(grid, &point.cell, &point.position, |i, phi, _| {
                    solid.lumped[i] += of_solid.mass * phi;
                    liquid.lumped[i] += of_liquid.mass * phi;
                    solid.velocity[i] += of_solid.momentum * phi;
                    liquid.velocity[i] += of_liquid.momentum * phi;
                });
            });
    }

    /// Momenta and matrices of both masses from the reconstructed densities.
    fn integrate_consistent(&mut self) {
        let (basis, grid, phase) = (&self.basis, &self.grid, &self.phase);
        let (solid, liquid) = (&mut self.dofs, &mut self.liquid);
        solid.matrix.clear();
        liquid.matrix.clear();
        let cloud = cloud(grid, &self.bins, &self.particles, &self.cuts);
        let amounts = amounts(phase, &self.particles);
        self.reconstruction
            .integrate_conserved(&cloud, amounts, |point, Pair(of_solid, of_liquid)| {
                let (cell, x) = (&point.cell, &point.position);
                basis.for_each_at_fixed_point(grid, cell, x, |i, phi_i, _| {
                    solid.velocity[i] += of_solid.momentum * phi_i;
                    liquid.velocity[i] += of_liquid.momentum * phi_i;
                    let (m_s, m_w) = (of_solid.mass * phi_i, of_liquid.mass * phi_i);
                    basis.for_each_at_fixed_point(grid, cell, x, |j, phi_j, _| {
                        solid.matrix.add(i, j, m_s * phi_j);
                        liquid.matrix.add(i, j, m_w * phi_j);
                    });
                });
            });
        solid.matrix.complete(None);
        liquid.matrix.complete(None);
    }

    /// Momenta to velocities, with the told values at held DOFs and no slip through sealed surfaces.
    fn divide_both(&mut self, dt: T, forcing: &Forcing<T, D>, fresh: bool) {
        let walls = [
            Walls::of_solid(&self.face_dofs, forcing),
            Walls::of_liquid(&self.face_dofs, forcing),
        ];
        for (dofs, walls) in [&mut self.dofs, &mut self.liquid].into_iter().zip(walls) {
            let mass = self.velocity_mass;
            if R::PARTICLE_MATRIX {
                dofs.solve(Unknown::Velocity, mass, &walls, fresh, &|velocity, _| velocity);
            } else if R::AMOUNTS_AT_PARTICLES {
                divide(&mut dofs.velocity, &dofs.mass);
            } else if mass == VelocityMass::Lumped {
                divide(&mut dofs.velocity, &dofs.lumped);
            } else {
                dofs.solve(Unknown::Velocity, mass, &walls, fresh, &|velocity, _| velocity);
            }
        }
        self.hold_velocities(dt, forcing);
        if R::PARTICLE_MATRIX {
            self.seal_mapped_jointly();
        } else {
            self.seal_velocities(dt);
        }
    }

    /// Told velocities at held DOFs. Where the liquid passes, the drag that the solid's change makes in a
    /// step moves it along, as it does with the accelerations: held otherwise in one than in the other, kick
    /// and drift are not adjoint, and where the drag is strong the energy grows at any step near the wave's.
    fn hold_velocities(&mut self, dt: T, forcing: &Forcing<T, D>) {
        let share = self.share_of_drag(dt);
        let (solid, liquid) = (&mut self.dofs.velocity, &mut self.liquid.velocity);
        let (mass, drag) = (&self.liquid.mass, &self.drag);
        Walls::of_solid(&self.face_dofs, forcing).for_each_held(|dof, axis, velocity, _| {
            liquid[dof][axis] += share(mass[dof], drag[dof]) * (velocity - solid[dof][axis]);
            solid[dof][axis] = velocity;
        });
        Walls::of_liquid(&self.face_dofs, forcing).for_each_held(|dof, axis, velocity, _| {
            liquid[dof][axis] = velocity;
        });
    }
}

/// Of solid and liquid.
type Momenta<T, const D: usize> = Pair<SVector<T, D>, SVector<T, D>>;

/// Momenta of solid and liquid of each particle.
#[inline(always)]
fn momenta<'a, T, const D: usize, S, P>(
    phase: &'a P,
    particles: &'a Particles<T, D, S, P::Particle>,
) -> impl Fn(usize) -> Momenta<T, D> + 'a
where
    T: Scalar,
    P: Phase<T, D>,
{
    move |p| {
        let liquid = phase.liquid(&particles.phase[p]).velocity * phase.liquid_mass(particles.volume[p]);
        Pair(particles.velocity[p] * particles.mass[p], liquid)
    }
}

/// Of solid and liquid.
type Amounts<T, const D: usize> = Pair<MassMomentum<T, D>, MassMomentum<T, D>>;

/// Masses and momenta of solid and liquid of each particle.
#[inline(always)]
fn amounts<'a, T, const D: usize, S, P>(
    phase: &'a P,
    particles: &'a Particles<T, D, S, P::Particle>,
) -> impl Fn(usize) -> Amounts<T, D> + 'a
where
    T: Scalar,
    P: Phase<T, D>,
{
    let momenta = momenta(phase, particles);
    move |p| {
        let Pair(solid, liquid) = momenta(p);
        let (mass, liquid_mass) = (particles.mass[p], phase.liquid_mass(particles.volume[p]));
        let of = |mass, momentum| MassMomentum { mass, momentum };
        Pair(of(mass, solid), of(liquid_mass, liquid))
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
