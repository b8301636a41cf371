//! States of particles that start under stress.

use nalgebra::SMatrix;

use super::Particles;
use crate::error::SetupError;
use crate::law::ConstitutiveLaw;
use crate::scalar::Scalar;

impl<T: Scalar, const D: usize, S: Copy, P> Particles<T, D, S, P> {
    /// Gives every particle the state of `law` that belongs to its stress.
    ///
    /// A law whose stress follows from a state forgets [`Particles::stress`] in its first update if that state is left at
    /// rest. `off_plane` gives the stress (Pa) of particle `p` along the axes that the grid does not have, or `None` for what elastic
    /// plane strain brings; see [`ConstitutiveLaw::start`].
    ///
    /// # Errors
    /// If the law has no state for the stress of a particle; the states before it are set.
    pub fn start_under_stress<L: ConstitutiveLaw<T, D, State = S>>(
        &mut self,
        law: &L,
        off_plane: impl Fn(usize, &SMatrix<T, D, D>) -> Option<T>,
    ) -> Result<(), SetupError> {
        for (particle, (state, stress)) in self.state.iter_mut().zip(&self.stress).enumerate() {
            *state = law
                .start(stress, off_plane(particle, stress))
                .ok_or_else(|| SetupError::Value {
                    particle,
                    name: "stress",
                    value: stress[(0, 0)].primal(),
                    allowed: "its law cannot start under such a stress",
                })?;
        }
        Ok(())
    }
}
