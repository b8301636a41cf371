//! Stage 3: particle velocities, and DOF velocities from them.

use nalgebra::SVector;
use num_traits::Zero;

use super::acceleration::Walls;
use super::cell_sums::CellSums;
use super::diagnostics::Sums;
use super::lanes::{self, Acceleration, Bodies, at_fixed_points};
use super::matrix::Unknown;
use super::spans::{Spans, share};
use super::{Forcing, Stepper};
use crate::basis::BasisFamily;
use crate::law::LawSweep;
use crate::mass::VelocityMass;
use crate::parallel::{PARTICLES, PerSpan, Windows, add_up, each_span, worth_sharing};
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
    /// Velocities of the particles, and of the DOFs from them.
    pub(super) fn update_velocities(&mut self, dt: T, forcing: &Forcing<T, D>) {
        let (sums, mapped) = if R::PLAIN {
            let sums = self.accelerate_and_map_particles(dt);
            (sums, self.mapped_totals(sum(&self.dofs.mass)))
        } else {
            let sums = self.update_particle_velocities(dt);
            if R::RELAXES {
                self.relax(dt);
            }
            (sums, self.map_momentum())
        };
        self.diagnostics.record(&sums, mapped);
        self.balance_momentum(dt, forcing, &sums);
        // The particles' matrix is the one that the accelerations were solved with.
        self.divide_by_mass(forcing, !R::PARTICLE_MATRIX);
        self.meet_walls(forcing);
    }

    /// `v_p += dt sum_i phi_i(x_p) a_i`; returns the particles' momentum.
    #[inline(never)]
    pub(super) fn update_particle_velocities(&mut self, dt: T) -> Sums<T, D> {
        let (basis, grid) = (&self.basis, &self.grid);
        let acceleration = &self.dofs.force[..];
        let particles = &mut self.particles;
        let parallel = worth_sharing::<D>(particles.len(), PARTICLES);
        let work = (
            &particles.position[..],
            &mut particles.velocity[..],
            &particles.mass[..],
            self.bins.cells(),
            PerSpan(&mut self.spans.sums),
        );
        each_span(parallel, PARTICLES, work, &|_,
                                               (
            positions,
            velocities,
            masses,
            cells,
            found,
        )| {
            if const { lanes::apply_to_values::<T, D, B>() } {
                let bodies = Bodies {
                    positions,
                    cells,
                    masses,
                };
                let acceleration = Acceleration {
                    dofs: acceleration,
                    dt,
                };
                let mut nothing = |_: usize, _| ();
                return found.set(at_fixed_points!(
                    B,
                    basis,
                    grid,
                    accelerate::<false>(bodies, velocities, acceleration, &mut nothing)
                ));
            }
            let mut sums = Sums::zero();
            let bodies = velocities.iter_mut().zip(masses);
            for ((x, cell), (velocity, &mass)) in positions.iter().zip(cells).zip(bodies) {
                let mut a = SVector::zeros();
                basis.for_each(grid, cell, x, |i, phi, _| a += acceleration[i] * phi);
                *velocity += a * dt;
                sums.add(*velocity * mass);
            }
            found.set(sums);
        });
        self.spans.momentum()
    }

    /// The same where the particles are the points of the mapping: their new momenta are summed at the DOFs in the same pass.
    #[inline(never)]
    fn accelerate_and_map_particles(&mut self, dt: T) -> Sums<T, D> {
        let (basis, grid) = (&self.basis, &self.grid);
        let acceleration = &self.dofs.force[..];
        let particles = &mut self.particles;
        let Spans {
            particles: spans,
            lengths,
            vectors,
            sums,
            ..
        } = &mut self.spans;
        let (span, parallel) = share::<D>(spans, particles.len(), lengths[0]);
        sums.fill(Sums::zero());
        let work = (
            &particles.position[..],
            &mut particles.velocity[..],
            &particles.mass[..],
            self.bins.cells(),
            Windows::new(spans, vectors, &mut self.dofs.velocity, 1),
            PerSpan(&mut sums[..]),
        );
        each_span(parallel, span, work, &|_,
                                          (
            positions,
            velocities,
            masses,
            cells,
            momentum,
            found,
        )| {
            let (first, momentum) = momentum.one();
            let mut sink = |i: usize, q| momentum[i - first] += q;
            if const { lanes::apply_to_values::<T, D, B>() } {
                let bodies = Bodies {
                    positions,
                    cells,
                    masses,
                };
                let acceleration = Acceleration {
                    dofs: acceleration,
                    dt,
                };
                return found.set(at_fixed_points!(
                    B,
                    basis,
                    grid,
                    accelerate::<true>(bodies, velocities, acceleration, &mut sink)
                ));
            }
            let mut sums = Sums::zero();
            let mut momenta = CellSums::new(basis, grid);
            let bodies = velocities.iter_mut().zip(masses);
            for ((x, cell), (velocity, &mass)) in positions.iter().zip(cells).zip(bodies) {
                let mut a = SVector::zeros();
                basis.for_each(grid, cell, x, |i, phi, _| a += acceleration[i] * phi);
                *velocity += a * dt;
                let q = *velocity * mass;
                sums.add(q);
                momenta.add(cell, x, |phi, _| q * phi, &mut sink);
            }
            momenta.flush(&mut sink);
            found.set(sums);
        });
        add_up(spans, vectors, &mut self.dofs.velocity, 1);
        self.spans.momentum()
    }

    /// Momentum to velocity, with the told values at held DOFs. DOFs without mass are at rest. Without `fresh` matrix and
    /// held DOFs are those last solved with.
    pub(super) fn divide_by_mass(&mut self, forcing: &Forcing<T, D>, fresh: bool) {
        let own_lumped = !R::AMOUNTS_AT_PARTICLES && self.velocity_mass == VelocityMass::Lumped;
        if own_lumped || R::AMOUNTS_AT_PARTICLES && !R::PARTICLE_MATRIX {
            self.divide_by_lumped_mass();
        } else {
            let pick = |velocity, _| velocity;
            let walls = Walls::of_solid(&self.face_dofs, forcing);
            self.dofs
                .solve(Unknown::Velocity, self.velocity_mass, &walls, fresh, &pick);
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

/// Sum in four parts: otherwise each addition would wait for the one before.
pub(super) fn sum<Q: Copy + Zero>(values: &[Q]) -> Q {
    let (fours, rest) = values.as_chunks::<4>();
    let mut parts = [Q::zero(); 4];
    for four in fours {
        parts = std::array::from_fn(|k| parts[k] + four[k]);
    }
    let [a, b, c, d] = parts;
    rest.iter().fold((a + b) + (c + d), |sum, &value| sum + value)
}
