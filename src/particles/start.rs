//! States of particles that start under stress.

use nalgebra::SMatrix;

use super::Particles;
use super::bearable::bearable;
use crate::error::SetupError;
use crate::law::LawSweep;
use crate::scalar::Scalar;

impl<T: Scalar, const D: usize, S: Copy, P> Particles<T, D, S, P> {
    /// Gives every particle the state of `law` that belongs to its stress.
    ///
    /// A law whose stress follows from a state forgets [`Particles::stress`] in its first update if that
    /// state is left at rest. `off_plane` gives the stress (Pa) of particle `p` along the axes that the grid
    /// does not have, or `None` for what elastic plane strain brings; see
    /// [`ConstitutiveLaw::start`](crate::law::ConstitutiveLaw::start).
    ///
    /// # Errors
    /// If the law has no state for the stress of a particle; the states before it are set.
    pub fn start_under_stress<L: LawSweep<T, D, Number = S>>(
        &mut self,
        law: &L,
        off_plane: impl Fn(usize, &SMatrix<T, D, D>) -> Option<T>,
    ) -> Result<(), SetupError> {
        for (particle, stress) in self.stress.iter().enumerate() {
            let off_plane = off_plane(particle, stress);
            if !starts(law, stress, off_plane, law.of_mut(&mut self.state, particle)) {
                return Err(SetupError::InitialStress {
                    particle,
                    position: self.position[particle].iter().map(|x| x.primal()).collect(),
                    stress: components(stress),
                    allowed: bearable(law, stress, off_plane),
                });
            }
        }
        Ok(())
    }
}

/// Whether the law has a state that belongs to a stress, and a meaning for it; it is put to `state`.
pub(super) fn starts<T: Scalar, const D: usize, L: LawSweep<T, D>>(
    law: &L,
    stress: &SMatrix<T, D, D>,
    off_plane: Option<T>,
    state: &mut [L::Number],
) -> bool {
    law.start(stress, off_plane, state) && law.knows(stress, state)
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
