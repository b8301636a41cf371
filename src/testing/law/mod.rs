//! Check of a constitutive law.

mod elastic;
mod energy;
mod path;
mod rate;
mod rotation;
mod stability;
mod stiffness;

use super::failure::Failure;
use crate::law::ConstitutiveLaw;
use crate::scalar::Scalar;

/// Where a law is looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LawSample<T> {
    /// Density of the undeformed material (kg/m3).
    pub density: T,
    /// Largest strain to try, both ways; about 0.05.
    pub strain: T,
}

/// What a law claims beyond what the trait demands of each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LawClaims {
    /// `energy_density` is what the stress has worked, however far the strain goes; otherwise only its
    /// leading term in the strain.
    pub energy_is_work: bool,
    /// `wave_speed` is the speed of the fastest wave along an axis; otherwise more than that.
    pub wave_speed_is_sharp: bool,
    /// Stress follows a rotation of the material. Small-strain laws do not; without meaning in 1-D.
    pub objective: bool,
    /// Stress does not fall while the strain grows: in simple shear, in 1-D in compression. False for what
    /// softens.
    pub stable: bool,
}

/// Checks that the parts of `law` agree with each other: no stress and energy at rest, nothing from a zero
/// increment, a symmetric stress, linear in small increments, wave speed, energy, rotation and stability as
/// claimed; at small strain an energy that is the work in any case; elastic constants, if it has any, that
/// are the stiffness at rest; the strain for a change of stress; a start that keeps its stress; that it
/// knows the stresses that it gives. Over times from 1 us to 1000 s (`update_over`) material that is held
/// gains no energy, no path gives back more than was put in, and `update` is the limit of slow strain (a
/// viscosity) or of fast strain (a relaxation).
///
/// Derivatives are differences from states of their own, paths are cut into many equal increments, and what
/// these allow is of their order: nothing in the law's units needs to be given.
///
/// # Errors
/// The first property that does not hold, or holds although it is claimed not to.
pub fn check_law<T: Scalar, const D: usize, L: ConstitutiveLaw<T, D>>(
    law: &L,
    sample: &LawSample<T>,
    claims: &LawClaims,
) -> Result<(), Failure> {
    stiffness::at_rest(law, sample)?;
    stiffness::zero_increment(law, sample)?;
    stiffness::symmetry(law, sample)?;
    stiffness::small_increments(law, sample)?;
    stiffness::wave_speed(law, sample, claims.wave_speed_is_sharp)?;
    energy::is_work(law, sample, claims.energy_is_work)?;
    if D > 1 {
        rotation::check(law, sample, claims.objective)?;
    }
    energy::at_small_strain(law, sample)?;
    elastic::constants(law, sample)?;
    elastic::strain_for(law, sample)?;
    elastic::start(law, sample)?;
    elastic::knows(law, sample)?;
    rate::update_is_a_limit(law, sample)?;
    rate::no_energy_from_nothing(law, sample, claims.energy_is_work)?;
    stability::check(law, sample, claims.stable)?;
    Ok(())
}
