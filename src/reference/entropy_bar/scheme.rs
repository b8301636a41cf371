//! The finite-volume scheme.

use super::super::{BarProblem, End, Hyperelastic, ReferenceError, State, UniaxialLaw, check};
use super::face::{Flux, Side, between, end};
use super::slope::limited;

/// Part of the time a wave takes through a cell that a step may last: half, so that the waves of a cell's two
/// faces do not meet.
const STEP_FRACTION: f64 = 0.5;

/// A state of the bar. The stretch of a cell is what its faces make of it, so displacements and stretches
/// agree exactly.
#[derive(Clone, Debug)]
pub(super) struct Motion {
    /// s
    pub(super) time: f64,
    /// Of the faces, m.
    pub(super) displacement: Vec<f64>,
    /// Averages of the cells, m/s.
    pub(super) velocity: Vec<f64>,
}

/// Mesh and working arrays.
#[derive(Clone, Debug)]
pub(super) struct Scheme {
    size: f64,
    /// What the limiter takes for smooth, as squares of relative differences: the cube of a cell's share of
    /// the bar.
    floor: f64,
    stretch: Vec<f64>,
    /// Limited differences of each cell.
    slopes: Vec<Side>,
    fluxes: Vec<Flux>,
    before: Motion,
}

impl Scheme {
    pub(super) fn new<L>(problem: &BarProblem<L>, cells: usize) -> Self {
        let nothing = Flux {
            velocity: 0.0,
            stress: 0.0,
            speed: 0.0,
        };
        let flat = Side {
            velocity: 0.0,
            stretch: 0.0,
        };
        Self {
            size: problem.length / cells as f64,
            floor: (cells as f64).powi(-3),
            stretch: vec![1.0; cells],
            slopes: vec![flat; cells],
            fluxes: vec![nothing; cells + 1],
            before: Motion {
                time: 0.0,
                displacement: vec![0.0; cells + 1],
                velocity: vec![0.0; cells],
            },
        }
    }

    /// The undeformed bar with its initial velocity, averaged by Gauss quadrature.
    pub(super) fn start<L>(&self, problem: &BarProblem<L>) -> Result<Motion, ReferenceError> {
        let mut motion = Motion {
            time: 0.0,
            displacement: vec![0.0; self.fluxes.len()],
            velocity: vec![0.0; self.stretch.len()],
        };
        let half = 0.5 / 3.0_f64.sqrt();
        for (cell, velocity) in motion.velocity.iter_mut().enumerate() {
            let at = |part: f64| (problem.initial_velocity)((cell as f64 + part) * self.size);
            let mean = 0.5 * (at(0.5 - half) + at(0.5 + half));
            *velocity = check::finite("initial velocity", mean)?;
        }
        Ok(motion)
    }

    /// Marches to `stop`, s, through an interval in which the body force is smooth.
    pub(super) fn march<L: UniaxialLaw>(
        &mut self,
        problem: &BarProblem<L>,
        motion: &mut Motion,
        stop: f64,
    ) -> Result<(), ReferenceError> {
        while motion.time < stop {
            self.clone_into_before(motion);
            if let Err(error) = self.step(problem, motion, stop) {
                motion.clone_from(&self.before);
                return Err(error);
            }
        }
        Ok(())
    }

    fn clone_into_before(&mut self, motion: &Motion) {
        self.before.time = motion.time;
        self.before.displacement.copy_from_slice(&motion.displacement);
        self.before.velocity.copy_from_slice(&motion.velocity);
    }

    /// One step of Heun's method: two Euler steps, and the mean of where they lead and where they began.
    fn step<L: UniaxialLaw>(
        &mut self,
        problem: &BarProblem<L>,
        motion: &mut Motion,
        stop: f64,
    ) -> Result<(), ReferenceError> {
        let begin = motion.time;
        self.find_fluxes(problem, motion)?;
        let step = self.step_size(begin, stop)?;
        self.euler(problem, motion, begin, step)?;
        self.find_fluxes(problem, motion)?;
        self.euler(problem, motion, begin + step, step)?;
        let mean = |values: &mut [f64], before: &[f64]| {
            values
                .iter_mut()
                .zip(before)
                .for_each(|(value, b)| *value = 0.5 * (*value + b));
        };
        mean(&mut motion.displacement, &self.before.displacement);
        mean(&mut motion.velocity, &self.before.velocity);
        self.check_state(motion)?;
        // Rounding may carry the last step past the end, where asking for it again would mean going back.
        motion.time = (begin + step).min(stop);
        Ok(())
    }

    /// The next of equal steps that reach `stop`.
    fn step_size(&self, time: f64, stop: f64) -> Result<f64, ReferenceError> {
        let speed = self.fluxes.iter().map(|flux| flux.speed).fold(0.0, f64::max);
        let limit = STEP_FRACTION * self.size / speed;
        if limit > 4.0 * f64::EPSILON * stop {
            Ok((stop - time) / ((stop - time) / limit).ceil())
        } else {
            Err(ReferenceError::StepTooSmall { time, step: limit })
        }
    }

    fn euler<L>(
        &self,
        problem: &BarProblem<L>,
        motion: &mut Motion,
        time: f64,
        step: f64,
    ) -> Result<(), ReferenceError> {
        let force = check::finite("body force", (problem.body_force)(time))?;
        let per_mass = 1.0 / (problem.density * self.size);
        for (velocity, faces) in motion.velocity.iter_mut().zip(self.fluxes.windows(2)) {
            *velocity += step * ((faces[1].stress - faces[0].stress) * per_mass + force);
        }
        for (displacement, flux) in motion.displacement.iter_mut().zip(&self.fluxes) {
            *displacement += step * flux.velocity;
        }
        Ok(())
    }

    fn find_fluxes<L: UniaxialLaw>(
        &mut self,
        problem: &BarProblem<L>,
        motion: &Motion,
    ) -> Result<(), ReferenceError> {
        self.find_stretches(motion)?;
        self.find_slopes(problem, motion);
        let (law, density, last) = (&problem.law, problem.density, self.stretch.len() - 1);
        self.fluxes[0] = end(law, density, problem.ends[0], self.side(motion, 0, -0.5), -1.0)?;
        self.fluxes[last + 1] = end(law, density, problem.ends[1], self.side(motion, last, 0.5), 1.0)?;
        for cell in 0..last {
            let (left, right) = (self.side(motion, cell, 0.5), self.side(motion, cell + 1, -0.5));
            self.fluxes[cell + 1] = between(law, density, left, right)?;
        }
        Ok(())
    }

    fn find_stretches(&mut self, motion: &Motion) -> Result<(), ReferenceError> {
        for (cell, faces) in motion.displacement.windows(2).enumerate() {
            let stretch = 1.0 + (faces[1] - faces[0]) / self.size;
            if !(stretch > 0.0 && stretch.is_finite()) {
                return Err(ReferenceError::InvalidStretch {
                    time: motion.time,
                    position: (cell as f64 + 0.5) * self.size,
                    stretch,
                });
            }
            self.stretch[cell] = stretch;
        }
        Ok(())
    }

    fn find_slopes<L: UniaxialLaw>(&mut self, problem: &BarProblem<L>, motion: &Motion) {
        let last = self.stretch.len() - 1;
        let value = |cell: usize| Side {
            velocity: motion.velocity[cell],
            stretch: self.stretch[cell],
        };
        let (largest_velocity, largest_strain) = self.largest(motion);
        let [first, second] = [largest_velocity, largest_strain].map(|size| self.floor * size * size);
        let mut left = beyond(problem.ends[0], value(0));
        for cell in 0..=last {
            let here = value(cell);
            let right = if cell < last {
                value(cell + 1)
            } else {
                beyond(problem.ends[1], here)
            };
            self.slopes[cell] = Side {
                velocity: limited(
                    here.velocity - left.velocity,
                    right.velocity - here.velocity,
                    first,
                ),
                stretch: limited(here.stretch - left.stretch, right.stretch - here.stretch, second),
            };
            left = here;
        }
    }

    /// Largest velocity, m/s, and strain of a cell.
    fn largest(&self, motion: &Motion) -> (f64, f64) {
        let velocity = motion.velocity.iter().fold(0.0, |most, v| v.abs().max(most));
        let strain = self.stretch.iter().fold(0.0, |most, j| (j - 1.0).abs().max(most));
        (velocity, strain)
    }

    /// What the slope of a cell makes of its average, `part` of a cell from its centre.
    fn side(&self, motion: &Motion, cell: usize, part: f64) -> Side {
        let slope = self.slopes[cell];
        Side {
            velocity: motion.velocity[cell] + part * slope.velocity,
            stretch: self.stretch[cell] + part * slope.stretch,
        }
    }

    /// Refuses a state that the march would only notice in its next step.
    fn check_state(&mut self, motion: &Motion) -> Result<(), ReferenceError> {
        self.find_stretches(motion)?;
        let bad = motion.velocity.iter().enumerate().find(|(_, v)| !v.is_finite());
        bad.map_or(Ok(()), |(cell, &velocity)| {
            Err(ReferenceError::InvalidVelocity {
                time: motion.time,
                position: (cell as f64 + 0.5) * self.size,
                velocity,
            })
        })
    }

    /// Kinetic and stored energy of the averages, J/m2.
    pub(super) fn energy<L: Hyperelastic>(&self, problem: &BarProblem<L>, motion: &Motion) -> f64 {
        let cells = motion.velocity.iter().zip(motion.displacement.windows(2));
        let density = |(v, faces): (&f64, &[f64])| {
            let stretch = 1.0 + (faces[1] - faces[0]) / self.size;
            0.5 * problem.density * v * v + problem.law.energy(stretch)
        };
        self.size * cells.map(density).sum::<f64>()
    }

    /// State at a `distance`, m, from the left end: between centres of cells, linear; likewise between faces.
    pub(super) fn state<L: UniaxialLaw>(
        &self,
        problem: &BarProblem<L>,
        motion: &Motion,
        distance: f64,
    ) -> State {
        let last = motion.velocity.len() - 1;
        let x = (distance / self.size).clamp(0.0, (last + 1) as f64);
        let value = |cell: usize| Side {
            velocity: motion.velocity[cell],
            stretch: 1.0 + (motion.displacement[cell + 1] - motion.displacement[cell]) / self.size,
        };
        // The right one of the two centres; 0 and last + 1 lie beyond an end.
        let right = ((x + 0.5) as usize).min(last + 1);
        let part = x + 0.5 - right as f64;
        let above = if right > last {
            beyond(problem.ends[1], value(last))
        } else {
            value(right)
        };
        let below = if right == 0 {
            beyond(problem.ends[0], value(0))
        } else {
            value(right - 1)
        };
        let mix = |a: f64, b: f64, part: f64| a + part * (b - a);
        let face = (x as usize).min(last);
        let (u, stretch) = (&motion.displacement, mix(below.stretch, above.stretch, part));
        State {
            displacement: mix(u[face], u[face + 1], x - face as f64),
            velocity: mix(below.velocity, above.velocity, part),
            stress: problem.law.stress(stretch),
        }
    }
}

/// The mirror image of the cell at an end.
fn beyond(end: End, inside: Side) -> Side {
    match end {
        End::Fixed => Side {
            velocity: -inside.velocity,
            ..inside
        },
        End::Free => Side {
            stretch: 2.0 - inside.stretch,
            ..inside
        },
    }
}
