//! One step, as a list of stages.
//!
//! Every method, phase, transfer and dimension takes the stages of this list and no other way; what a stage
//! is for the types of a stepper stands in `stages`, and the work in the file of its name. A stage that has
//! nothing to do for a type compiles to nothing.

use super::forcing::Forcing;
use super::sweeps::Sweeps;
use super::{Energy, Stepper, refuse_bad_step};
use crate::basis::BasisFamily;
use crate::error::StepError;
use crate::law::LawSweep;
use crate::parallel::within_pool;
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
    /// Velocities of particles and DOFs.
    pub(super) fn kick(&mut self, dt: T, forcing: &Forcing<T, D>) {
        self.inner.begin_balance();
        self.p2g(dt, forcing);
        self.inner.add_loads(&self.basis, forcing);
        self.inner.accelerate(dt, forcing);
        self.kick_dofs(dt, forcing);
        let totals = self.update_velocities(dt);
        self.filter(dt);
        self.map_momenta_of(&totals);
        self.inner.close_balance(dt, forcing, &totals);
        self.solve_velocities(dt, forcing);
        self.apply_wall_contact(dt, forcing);
    }
}

/// Takes a step in the pool of threads if it is worth that; the energy means nothing unless it is to be
/// measured.
#[inline(never)]
pub(super) fn send_step<T, const D: usize, L, P, X>(
    stepper: &mut dyn Sweeps<T, D, L, P, X>,
    sizes: [T; 2],
    forcing: &Forcing<T, D>,
    measure: bool,
) -> Result<Energy<T>, StepError>
where
    T: Scalar,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
    X: Transfer<T, D>,
{
    let kinds = [P::FLOWS, P::DIFFUSES, X::FROM_GRID];
    refuse_bad_step(sizes, forcing, kinds, &stepper.inner().left_out)?;
    let mut outcome = Ok(Energy::none());
    within_pool(stepper.is_worth_sending(), &mut || {
        outcome = step_here(stepper, sizes, forcing, measure);
    });
    outcome
}

/// The step on this thread, which others of its pool may help.
fn step_here<T, const D: usize, L, P, X>(
    stepper: &mut dyn Sweeps<T, D, L, P, X>,
    [kick, dt]: [T; 2],
    forcing: &Forcing<T, D>,
    measure: bool,
) -> Result<Energy<T>, StepError>
where
    T: Scalar,
    L: LawSweep<T, D>,
    P: Phase<T, D>,
    X: Transfer<T, D>,
{
    stepper.prepare();
    let inner = stepper.inner();
    let before = measure.then(|| (inner.strain_energy(), inner.velocities()));
    stepper.kick(kick, forcing);
    let inner = stepper.inner();
    let energy = before.map_or_else(Energy::none, |(strain, velocities)| Energy {
        kinetic: inner.kinetic_energy_across(&velocities),
        strain,
    });
    stepper.drift(dt, forcing)?;
    Ok(energy)
}
