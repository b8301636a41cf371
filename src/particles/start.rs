//! States of particles that start under stress.

use nalgebra::SMatrix;

use super::Particles;
use super::bearable::bearable;
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
            let off_plane = off_plane(particle, stress);
            *state = start(law, stress, off_plane).ok_or_else(|| SetupError::InitialStress {
                particle,
                position: self.position[particle].iter().map(|x| x.primal()).collect(),
                stress: components(stress),
                allowed: bearable(law, stress, off_plane),
            })?;
        }
        Ok(())
    }
}

/// The state that belongs to a stress, if the law has one and a meaning for it.
pub(super) fn start<T: Scalar, const D: usize, L: ConstitutiveLaw<T, D>>(
    law: &L,
    stress: &SMatrix<T, D, D>,
    off_plane: Option<T>,
) -> Option<L::State> {
    law.start(stress, off_plane)
        .filter(|state| law.knows(stress, state))
}

/// The components with their names, for messages: `xx`, `xy`, `yy`.
fn components<T: Scalar, const D: usize>(stress: &SMatrix<T, D, D>) -> Vec<(String, f64)> {
    let name = |a: usize| ["x", "y", "z"].get(a).copied().unwrap_or("?");
    let places = (0..D).flat_map(|row| (row..D).map(move |column| (row, column)));
    places
        .map(|place| {
            let value = stress.get(place).map_or(f64::NAN, |s| s.primal());
            (format!("{}{}", name(place.0), name(place.1)), value)
        })
        .collect()
}
