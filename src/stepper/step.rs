//! One step, as a list of stages.
//!
//! Every method, phase, transfer and dimension takes the stages of this list and no other way; what a stage
//! is for the types of a stepper stands in `stages`, and the work in the file of its name. A stage that has
//! nothing to do for a type compiles to nothing.

use super::forcing::Forcing;
use super::{Energy, Stepper};
use crate::basis::BasisFamily;
use crate::error::StepError;
use crate::law::LawSweep;
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
    /// The step on this thread, which others of its pool may help.
    pub(super) fn step_here(
        &mut self,
        [kick, dt]: [T; 2],
        forcing: &Forcing<T, D>,
        measure: bool,
    ) -> Result<Energy<T>, StepError> {
        self.prepare();
        let before = measure.then(|| (self.strain_energy(), self.velocities()));
        self.kick(kick, forcing);
        let energy = before.map_or_else(Energy::none, |(strain, velocities)| Energy {
            kinetic: self.kinetic_energy_across(&velocities),
            strain,
        });
        self.diffuse(dt, forcing)?;
        self.drift(dt)?;
        Ok(energy)
    }

    /// Velocities of particles and DOFs.
    fn kick(&mut self, dt: T, forcing: &Forcing<T, D>) {
        self.begin_balance();
        self.p2g(dt, forcing);
        self.add_loads(forcing);
        self.accelerate(dt, forcing);
        self.kick_dofs(dt, forcing);
        let totals = self.update_velocities(dt);
        self.filter(dt);
        self.map_momenta_of(&totals);
        self.close_balance(dt, forcing, &totals);
        self.solve_velocities(dt, forcing);
        self.apply_wall_contact(dt, forcing);
    }
}
