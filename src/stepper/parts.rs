//! The parts of a stepper, handed out between steps and back at the end.

use super::diffusion::refuse_without_capacity;
use super::inner::{Given, Inner};
use super::order::permute;
use super::{Setup, Stepper, domain, refuse_unknown_stress, values};
use crate::basis::BasisFamily;
use crate::error::SetupError;
use crate::grid::Window;
use crate::law::LawSweep;
use crate::particles::{Bins, Outside, Particles};
use crate::phase::Phase;
use crate::reconstruction::Reconstruction;
use crate::scalar::Scalar;
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
    /// The basis.
    pub fn basis(&self) -> &B {
        &self.basis
    }

    /// The reconstruction.
    pub fn reconstruction(&self) -> &R {
        &self.reconstruction
    }

    /// The phase.
    pub fn phase(&self) -> &P {
        &self.inner.phase
    }

    /// The transfer.
    pub fn transfer(&self) -> &X {
        &self.inner.transfer
    }

    /// What the transfer remembers of each of [`Stepper::particles`].
    pub fn memory(&self) -> &[X::Particle] {
        &self.inner.memory
    }

    /// Lets `edit` write particle data between two steps, in the order of [`Stepper::particles`]: velocities
    /// that a controller sets, a wall that heats. Their number stays, and so does what the transfer remembers
    /// of them ([`Stepper::edit_memory`]). Costs a copy of the particles.
    ///
    /// # Errors
    /// As those of [`Stepper::new`] for particles; they are then as they were.
    pub fn edit_particles(
        &mut self,
        edit: impl FnOnce(&mut Particles<T, D, L::Number, P::Particle>),
    ) -> Result<(), SetupError> {
        let before = self.inner.particles.clone();
        edit(&mut self.inner.particles);
        let taken_in = self.inner.take_in_edited(&self.basis);
        if taken_in.is_err() {
            self.inner.particles = before;
        }
        // Checks know particles by their places; the caller, by the numbers in which they were given.
        taken_in.map_err(|error| error.renumbered(|place| self.inner.order.number(place)))
    }

    /// Lets `edit` write what the transfer remembers of each of [`Stepper::particles`]: to be forgotten where
    /// velocities were written that it does not belong to.
    pub fn edit_memory(&mut self, edit: impl FnOnce(&mut [X::Particle])) {
        edit(&mut self.inner.memory);
    }

    /// What a new stepper can be made of that goes on from here, with the particles in the order in which
    /// they were given. Time, steps and diagnostics begin anew.
    pub fn into_setup(self) -> Setup<T, D, B, R, L, P, X> {
        let Self {
            basis,
            reconstruction,
            velocity_mass,
            inner,
        } = self;
        let Given {
            grid,
            law,
            phase,
            transfer,
            particles,
            memory,
            surface,
        } = inner.into_given();
        Setup {
            grid,
            basis,
            reconstruction,
            law,
            phase,
            transfer,
            velocity_mass,
            particles,
            memory,
            surface,
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
    fn take_in_edited<B: BasisFamily<T, D>>(&mut self, basis: &B) -> Result<(), SetupError> {
        let (found, expected) = (self.particles.len(), self.bins.len());
        if found != expected {
            let name = "position";
            return Err(SetupError::Lengths {
                name,
                found,
                expected,
            });
        }
        self.particles.validate_with(self.law.numbers())?;
        refuse_unknown_stress(&self.law, &self.particles)?;
        refuse_without_capacity(&self.phase, &self.particles)?;
        domain::validate::<T, D, B, _, _>(&self.grid, &self.particles)?;
        let positions = &self.particles.position;
        self.bins =
            Bins::without_lists(&self.grid, positions).map_err(|Outside(place)| SetupError::Outside {
                particle: place,
                position: values(&positions[place]),
            })?;
        for (cell, x) in self.bins.cells().iter().zip(&mut self.particles.position) {
            self.grid.nudge_off_edges(cell, x);
        }
        self.order.note_crossings(expected);
        self.spans.forget();
        if B::FOLLOWS_WINDOW {
            self.follow_particles(basis);
        }
        // Momentum and mass may be others than the last step left.
        self.balance.momentum = None;
        let masses = self.particles.mass.iter();
        self.diagnostics.total_mass = masses.fold(T::zero(), |sum, &mass| sum + mass);
        Ok(())
    }

    /// What a setup holds of it, with the particles in the order in which they were given.
    #[inline(never)]
    fn into_given(self) -> Given<T, D, L, P, X> {
        let Self {
            grid,
            law,
            phase,
            transfer,
            mut particles,
            mut memory,
            mut surface,
            order,
            ..
        } = self;
        for point in &mut surface {
            point.particle = order.number(point.particle);
        }
        let numbers_each = law.numbers();
        let mut numbers = order.into_numbers().unwrap_or_default();
        permute(&mut numbers, |a, b| {
            particles.swap(a, b, numbers_each);
            memory.swap(a, b);
        });
        let whole = Window::whole(grid.cells());
        Given {
            grid: grid.with_window(whole),
            law,
            phase,
            transfer,
            particles,
            memory,
            surface,
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::vector;

    use super::*;
    use crate::basis::BSpline;
    use crate::grid::Grid;
    use crate::law::{Moduli, NeoHookean};
    use crate::particles::lattice;
    use crate::phase::OnePhase;
    use crate::reconstruction::Taylor;
    use crate::stepper::Forcing;

    type Disc = Stepper<f64, 2, BSpline<2>, Taylor<f64, 2, 6>, NeoHookean<f64>, OnePhase>;

    /// Particles in no order that fly across cells.
    fn disc() -> Disc {
        let grid = Grid::new(vector![0.0, 0.0], vector![20.0, 20.0], [20, 20]).unwrap();
        let mut points = lattice(&grid, &vector![3.0, 3.0], &vector![7.0, 7.0], [2, 2]);
        let count = points.len();
        points = (0..count).map(|p| points[p * 7 % count]).collect();
        let mut particles = Particles::at_rest(&points, 1.0);
        particles.velocity.fill(vector![1.0, 2.0]);
        let moduli = Moduli::from_young(100.0, 0.3).unwrap();
        Stepper::new(Setup::new(
            grid,
            BSpline::<2>,
            Taylor::new(),
            NeoHookean { moduli },
            OnePhase,
            particles,
        ))
        .unwrap()
    }

    #[test]
    fn a_setup_that_was_handed_back_goes_on_as_the_stepper_would() {
        let (mut stepper, none) = (disc(), Forcing::none());
        let start = stepper.clone().into_setup().particles;
        assert_eq!(start.position, start.initial_position);
        (0..40).for_each(|_| stepper.step(0.02, &none).unwrap());
        assert!(stepper.numbers().is_some());
        let setup = stepper.clone().into_setup();
        assert_eq!(setup.particles.initial_position, start.initial_position);
        let mut again = Stepper::new(setup).unwrap();
        (0..40).for_each(|_| {
            stepper.step(0.02, &none).unwrap();
            again.step(0.02, &none).unwrap();
        });
        let [a, b] = [stepper, again].map(|stepper| stepper.into_setup().particles);
        for (a, b) in a.position.iter().zip(&b.position) {
            assert!((a - b).norm() < 1e-12);
        }
    }

    #[test]
    fn particles_can_be_written_between_steps_and_mistakes_change_nothing() {
        let (mut stepper, none) = (disc(), Forcing::none());
        (0..5).for_each(|_| stepper.step(0.02, &none).unwrap());
        stepper
            .edit_particles(|particles| {
                particles.velocity.fill(vector![0.0, 0.0]);
                particles.position.iter_mut().for_each(|x| x[0] += 9.0);
            })
            .unwrap();
        let before = stepper.particles().clone();
        (0..5).for_each(|_| stepper.step(0.02, &none).unwrap());
        for (now, before) in stepper.particles().position.iter().zip(&before.position) {
            assert!((now - before).norm() < 1e-9);
        }
        let kept = stepper.particles().clone();
        let outside = stepper.edit_particles(|particles| particles.position[3][1] = 99.0);
        assert!(matches!(outside, Err(SetupError::Outside { .. })), "{outside:?}");
        let less = stepper.edit_particles(|particles| {
            particles.mass.pop();
        });
        assert!(matches!(less, Err(SetupError::Lengths { .. })), "{less:?}");
        assert_eq!(stepper.particles().position, kept.position);
        stepper.step(0.02, &none).unwrap();
    }

    /// Errors name particles by the numbers in which they were given, whatever their order in memory is.
    #[test]
    fn mistakes_in_edited_particles_are_named_by_first_numbers() {
        let (mut stepper, none) = (disc(), Forcing::none());
        (0..40).for_each(|_| stepper.step(0.02, &none).unwrap());
        let numbers = stepper.numbers().map(<[u32]>::to_vec).unwrap();
        let place = (0..numbers.len()).find(|&p| numbers[p] as usize != p).unwrap();
        let named = |edited: Result<(), SetupError>| match edited {
            Err(SetupError::Value { particle, .. } | SetupError::Outside { particle, .. }) => particle,
            other => panic!("{other:?}"),
        };
        let number = numbers[place] as usize;
        type Number = <NeoHookean<f64> as LawSweep<f64, 2>>::Number;
        type Edit = fn(&mut Particles<f64, 2, Number>, usize);
        let edits: [Edit; 4] = [
            |all, p| all.stress[p][0] = f64::NAN,
            |all, p| all.volume[p] = 0.0,
            |all, p| all.velocity[p][1] = f64::INFINITY,
            |all, p| all.position[p][1] = 99.0,
        ];
        for edit in edits {
            assert_eq!(named(stepper.edit_particles(|all| edit(all, place))), number);
        }
    }
}
