//! What each stage of a step is for the types of a stepper, but where the file of the stage itself asks them
//! (`diffusion`, `contact`). The list is in `step`.
//!
//! Each choice is an `if const { .. }`: what its other branch calls is then not even compiled. A `match` on
//! constants, or a condition made of constants at run time, compiles the sweeps of all branches for every
//! stepper.

use super::acceleration::{Walls, accelerate};
use super::drift::{Matter, move_particles};
use super::fitted::{DensitiesOfBoth, Fitted, StressesAndPressures, densities};
use super::forcing::Forcing;
use super::inner::Inner;
use super::kick::kick_particles;
use super::liquid::UniformLoad;
use super::spans::{Fault, Totals};
use super::sums::{Targets, first, sum_particles};
use super::velocity::divide_by_mass;
use super::{Stepper, cloud, left};
use crate::basis::BasisFamily;
use crate::error::StepError;
use crate::field::{MassMomentum, Symmetric};
use crate::law::LawSweep;
use crate::mass::{Divisor, MassModel};
use crate::phase::Phase;
use crate::reconstruction::{Filters, Reconstruction, Streams, Stresses};
use crate::scalar::Scalar;
use crate::transfer::Drift;
use crate::transfer::Transfer;

impl<T, const D: usize, B, R, L, P, X> Stepper<T, D, B, R, L, P, X>
where
    T: Scalar,
    B: BasisFamily<T, D>,
    R: Reconstruction<T, D>,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
    X: Transfer<T, D>,
{
    /// Velocities of the DOFs, kicked, where particles take theirs from the grid.
    pub(super) fn kick_dofs(&mut self, dt: T, forcing: &Forcing<T, D>) {
        if const { X::FROM_GRID } {
            self.map_and_kick_dofs(dt, forcing);
        }
    }

    /// Momenta and masses of the DOFs, compared with what the particles have; where these took theirs from
    /// the grid the DOFs have them.
    pub(super) fn map_momenta_of(&mut self, totals: &Totals<T, D>) {
        if const { !X::FROM_GRID } {
            let mapped = self.map_momenta();
            self.inner.record(totals, mapped);
        }
    }

    /// Velocities of the particles: by the accelerations, or from the grid.
    pub(super) fn update_velocities(&mut self, dt: T) -> Totals<T, D> {
        if const { X::FROM_GRID } {
            self.inner.take_from_grid(&self.basis, dt)
        } else {
            self.kick_particles(dt)
        }
    }

    /// Masses and forces of the DOFs; with a liquid that flows drag and velocities at the step's start too.
    pub(super) fn p2g(&mut self, dt: T, forcing: &Forcing<T, D>) {
        let even = self.inner.uniform_load(forcing);
        if const { P::FLOWS } {
            self.inner.find_seals(&self.basis, forcing);
        }
        if const { R::Points::AT_PARTICLES && P::FLOWS } {
            self.inner.sum::<_, 3, 2, 2>(&self.basis, even);
        } else if const { R::Points::AT_PARTICLES } {
            self.inner.sum::<_, 1, 0, 1>(&self.basis, even);
        } else if const { P::FLOWS && R::Mass::OF_PARTICLES } {
            self.inner.sum::<_, 3, 2, 0>(&self.basis, even);
        } else if const { P::FLOWS } {
            self.inner.sum::<_, 3, 0, 0>(&self.basis, even);
        } else {
            self.inner.sum::<_, 1, 0, 0>(&self.basis, even);
        }
        if const { R::Mass::IN_ACCELERATION } {
            self.assemble_matrices();
        }
        if const { !R::Points::AT_PARTICLES } {
            self.integrate_forces(even);
        }
        if const { P::FLOWS } {
            self.map_both_before(dt, forcing);
        }
    }

    /// Forces from fits of the stress.
    #[inline(never)]
    fn integrate_forces(&mut self, even: UniformLoad<T>) {
        let (effective, data, phase) = (
            &self.inner.particles.stress[..],
            &self.inner.particles.phase[..],
            &self.inner.phase,
        );
        let batched = self.batched();
        let fitted = Fitted {
            basis: &self.basis,
            cloud: cloud(
                &self.inner.grid,
                &self.inner.bins,
                &self.inner.particles,
                &self.inner.cuts,
            ),
            domains: self.inner.particles.domains.views(),
            reconstruction: &mut self.reconstruction,
            spans: &mut self.inner.spans,
            batched,
        };
        let forces = [&mut self.inner.dofs.force[..], &mut self.inner.liquid.force[..]];
        // Three kinds of values rather than one with branches: what a closure holds costs instructions even
        // where it is not used. And none that is a closure of this function, for which all fits would be
        // compiled once more: it is generic in all that a stepper is made of.
        if const { P::FLOWS } {
            let rest = StressesAndPressures {
                even,
                phase,
                effective,
                data,
            };
            fitted.forces::<2>(rest, Targets::<T, D, 0, 0, 2>::of_forces(forces));
        } else if const { P::COUPLED } {
            let total = |p: usize| Symmetric(phase.total_stress(&effective[p], &data[p]));
            fitted.forces::<1>(total, Targets::<T, D, 0, 0, 1>::of_forces(first(forces)));
        } else {
            fitted.forces::<1>(
                Stresses(effective),
                Targets::<T, D, 0, 0, 1>::of_forces(first(forces)),
            );
        }
        if batched && !R::Points::NON_LOCAL {
            let reduced = self.inner.spans.reduced.iter().sum();
            self.inner.diagnostics.record_reduced(reduced);
        }
    }

    /// Velocities of the particles, and the momenta of the DOFs where those of the particles are simply
    /// summed.
    pub(super) fn kick_particles(&mut self, dt: T) -> Totals<T, D> {
        if const { P::FLOWS && R::Mass::OF_PARTICLES && !R::Filter::FILTERS } {
            self.inner.kick_phases::<_, 2, 2>(&self.basis, dt)
        } else if const { P::FLOWS } {
            self.inner.kick_phases::<_, 2, 0>(&self.basis, dt)
        } else if const { R::Mass::OF_PARTICLES && !R::Filter::FILTERS } {
            self.inner.kick_phases::<_, 1, 1>(&self.basis, dt)
        } else {
            self.inner.kick_phases::<_, 1, 0>(&self.basis, dt)
        }
    }

    /// Takes from the particles what no fit sees.
    pub(super) fn filter(&mut self, dt: T) {
        if const { R::Filter::FILTERS && P::FLOWS } {
            self.relax_both(dt);
        } else if const { R::Filter::FILTERS } {
            self.relax(dt);
        }
    }

    /// Momenta and masses of the DOFs; returns their totals, of both phases.
    pub(super) fn map_momenta(&mut self) -> [MassMomentum<T, D>; 2] {
        if const { !R::Mass::OF_PARTICLES } {
            self.fit_momenta(!P::FLOWS);
        } else if const { R::Filter::FILTERS && P::FLOWS } {
            self.inner.sum_momenta::<_, 2>(&self.basis);
        } else if const { R::Filter::FILTERS } {
            self.inner.sum_momenta::<_, 1>(&self.basis);
        }
        self.inner.mapped_totals()
    }

    /// Masses of the DOFs of the solid alone.
    pub(super) fn sum_solid_masses(&mut self) {
        if const { R::Mass::IN_ACCELERATION } {
            self.assemble_particle_matrix();
        }
        self.inner.sum::<_, 1, 0, 0>(&self.basis, UniformLoad::none());
    }

    /// Momenta and masses of the DOFs of the solid alone, from the velocities as they are.
    pub(super) fn map_solid(&mut self) {
        if const { R::Mass::OF_PARTICLES } {
            self.inner.sum_momenta::<_, 1>(&self.basis);
        } else {
            self.fit_momenta(true);
        }
    }

    /// Momenta of the DOFs from fits of densities and, if `masses`, what divides them.
    pub(super) fn fit_momenta(&mut self, masses: bool) {
        let lumped = self.inner.mass == Divisor::FittedLumped;
        let batched = self.batched();
        let fitted = Fitted {
            basis: &self.basis,
            cloud: cloud(
                &self.inner.grid,
                &self.inner.bins,
                &self.inner.particles,
                &self.inner.cuts,
            ),
            domains: self.inner.particles.domains.views(),
            reconstruction: &mut self.reconstruction,
            spans: &mut self.inner.spans,
            batched,
        };
        let (solid, liquid) = (&mut self.inner.dofs, &mut self.inner.liquid);
        if const { P::FLOWS } {
            let both = DensitiesOfBoth {
                solid: densities(&self.inner.particles),
                data: &self.inner.particles.phase,
                phase: &self.inner.phase,
            };
            match (masses, lumped) {
                (false, _) => fitted.lumped::<_, 0, 2>(both, Targets::fitted(solid, liquid)),
                (true, true) => fitted.lumped::<_, 2, 2>(both, Targets::fitted(solid, liquid)),
                (true, false) => fitted.matrices(both, [solid, liquid]),
            }
        } else if lumped {
            fitted.lumped::<_, 1, 1>(densities(&self.inner.particles), Targets::fitted(solid, liquid));
        } else {
            fitted.matrices(densities(&self.inner.particles), [solid]);
        }
        if masses && !lumped {
            self.inner.dofs.matrix.complete(None);
            if const { P::FLOWS } {
                self.inner.liquid.matrix.complete(None);
            }
        }
    }

    /// Momenta to velocities of the DOFs.
    pub(super) fn solve_velocities(&mut self, dt: T, forcing: &Forcing<T, D>) {
        if const { X::FROM_GRID } {
            return;
        }
        if const { P::FLOWS } {
            self.inner.divide_both(dt, forcing, false);
        } else {
            let walls = Walls::of_solid(&self.inner.face_dofs, forcing);
            // The particles' matrix is the one that the accelerations were solved with.
            divide_by_mass(
                &mut self.inner.dofs,
                self.inner.mass,
                &walls,
                !R::Mass::IN_ACCELERATION,
            );
        }
    }
}

impl<T, const D: usize, L, P, X> Inner<T, D, L, P, X>
where
    T: Scalar,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
    X: Transfer<T, D>,
{
    /// Forces from outside are counted from here on.
    pub(super) fn begin_balance(&mut self) {
        if const { !P::FLOWS } {
            self.balance.begin(&self.particles.velocity, &self.particles.mass);
        }
    }

    /// What particles gained is compared with the impulses of all forces from outside.
    pub(super) fn close_balance(&mut self, dt: T, forcing: &Forcing<T, D>, totals: &Totals<T, D>) {
        if const { !P::FLOWS } {
            let after = &totals.momenta[0];
            self.balance
                .close(dt, &forcing.body_force, after, &mut self.diagnostics);
        }
    }

    /// Positions, strains and stresses of the particles.
    pub(super) fn drift<B: BasisFamily<T, D>>(&mut self, basis: &B, dt: T) -> Result<(), StepError> {
        self.steps += 1;
        self.time += dt;
        let matter = Matter {
            law: &self.law,
            phase: &self.phase,
        };
        let velocities = [&self.dofs.velocity[..], &self.liquid.velocity[..]];
        let space = (basis, &self.grid, &mut self.bins);
        let (particles, spans) = (&mut self.particles, &mut self.spans);
        if const { P::FLOWS } {
            move_particles(space, particles, &matter, &Drift { velocities, dt }, spans);
        } else {
            let velocities = [velocities[0]];
            move_particles(space, particles, &matter, &Drift { velocities, dt }, spans);
        }
        self.account_for_moves()
    }

    /// Sums over the particles.
    #[inline(never)]
    fn sum<B: BasisFamily<T, D>, const S: usize, const C: usize, const G: usize>(
        &mut self,
        basis: &B,
        even: UniformLoad<T>,
    ) {
        let targets: Targets<'_, T, D, S, C, G> =
            Targets::new(&mut self.dofs, &mut self.liquid, &mut self.drag);
        sum_particles(
            (basis, &self.grid, &self.bins),
            &self.particles,
            (&self.phase, even, None),
            &mut self.spans,
            targets,
        );
    }

    /// Counts crossings; the error is that of the first particle at fault.
    #[inline(never)]
    fn account_for_moves(&mut self) -> Result<(), StepError> {
        let (crossings, strayed, fault) = self.spans.sum_moves();
        self.strayed |= strayed;
        self.diagnostics.grid_crossings += crossings;
        self.bins.note_crossings(crossings);
        self.order.note_crossings(crossings);
        match fault {
            None => Ok(()),
            Some(Fault::Material(p, flaw)) => {
                Err(flaw.error(self.steps, self.order.number(p), self.law.limits()))
            }
            Some(Fault::Left(p)) => {
                let position = &self.particles.position[p];
                Err(left(self.steps, self.order.number(p), position))
            }
        }
    }

    /// Loads of surfaces, and body forces that differ from particle to particle.
    #[inline(never)]
    pub(super) fn add_loads<B: BasisFamily<T, D>>(&mut self, basis: &B, forcing: &Forcing<T, D>) {
        if const { P::FLOWS } {
            let even = self.uniform_load(forcing);
            self.add_surface_loads(basis, &even, forcing);
        } else {
            self.add_tractions(basis, forcing);
        }
        if !self.body_forces.is_empty() {
            self.add_body_forces(basis);
        }
    }

    /// Forces to accelerations.
    #[inline(never)]
    pub(super) fn accelerate(&mut self, dt: T, forcing: &Forcing<T, D>) {
        if const { P::FLOWS } {
            self.accelerate_both(dt, forcing);
            self.note_pressure_on_walls(dt);
        } else {
            let walls = Walls::of_solid(&self.face_dofs, forcing);
            accelerate(&mut self.dofs, self.mass, &walls, &mut self.balance);
        }
    }

    #[inline(never)]
    pub(super) fn kick_phases<B: BasisFamily<T, D>, const C: usize, const M: usize>(
        &mut self,
        basis: &B,
        dt: T,
    ) -> Totals<T, D> {
        let (solid, liquid) = (&mut self.dofs, &mut self.liquid);
        let momenta =
            Targets::<T, D, 0, M, 0>::of_momenta(first([&mut solid.velocity[..], &mut liquid.velocity[..]]));
        kick_particles::<_, D, _, _, _, C, M>(
            (basis, &self.grid, &self.bins),
            &mut self.particles,
            (&self.phase, dt),
            first([&solid.force[..], &liquid.force[..]]),
            &mut self.spans,
            momenta,
        )
    }

    /// Momenta of the DOFs straight from the particles, of the first so many phases.
    #[inline(never)]
    fn sum_momenta<B: BasisFamily<T, D>, const C: usize>(&mut self, basis: &B) {
        // Those of the matrices: a volume that was relaxed meanwhile holds another mass.
        let liquid_masses = const { C > 1 }.then_some(self.joint.liquid_masses());
        let (solid, liquid) = (&mut self.dofs, &mut self.liquid);
        let momenta = Targets::<'_, T, D, 0, C, 0>::of_momenta(first([
            &mut solid.velocity[..],
            &mut liquid.velocity[..],
        ]));
        sum_particles(
            (basis, &self.grid, &self.bins),
            &self.particles,
            (&self.phase, UniformLoad::none(), liquid_masses),
            &mut self.spans,
            momenta,
        );
    }

    /// Total mass and momentum of the DOFs, of both phases.
    pub(super) fn mapped_totals(&self) -> [MassMomentum<T, D>; 2] {
        // No `map` of arrays: for a closure of this function it would be compiled for every stepper.
        [
            self.dofs.mapped_totals(self.mass),
            self.liquid.mapped_totals(self.mass),
        ]
    }

    /// Compares what was mapped with what the particles have.
    pub(super) fn record(&mut self, totals: &Totals<T, D>, mapped: [MassMomentum<T, D>; 2]) {
        self.diagnostics.record(totals, mapped);
    }
}
