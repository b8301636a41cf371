//! The laws that remember nothing but the stress, chosen at run time.

use nalgebra::SMatrix;

use crate::law::{ConstitutiveLaw, Hill, LinearElastic, Logarithmic};
use crate::scalar::Scalar;

/// One of the laws without a state of their own. A branch per particle (a percent of a step's instructions) for a third of
/// the steppers to compile.
#[derive(Clone, Copy, Debug)]
pub(super) enum RateLaw<T> {
    LinearElastic(LinearElastic<T>),
    Hill(Hill<T>),
    Logarithmic(Logarithmic<T>),
}

macro_rules! each {
    ($self:ident, $law:ident => $call:expr) => {
        match $self {
            Self::LinearElastic($law) => $call,
            Self::Hill($law) => $call,
            Self::Logarithmic($law) => $call,
        }
    };
}

impl<T: Scalar> ConstitutiveLaw<T, 1> for RateLaw<T> {
    type State = ();

    #[inline(always)]
    fn large_strain(&self) -> bool {
        !matches!(self, Self::LinearElastic(_))
    }

    #[inline(always)]
    fn update(&self, increment: &SMatrix<T, 1, 1>, stress: &mut SMatrix<T, 1, 1>, state: &mut ()) {
        each!(self, law => law.update(increment, stress, state));
    }

    fn wave_speed(&self, density: T, stress: &SMatrix<T, 1, 1>, state: &()) -> T {
        each!(self, law => law.wave_speed(density, stress, state))
    }

    fn energy_density(&self, stress: &SMatrix<T, 1, 1>, state: &()) -> T {
        each!(self, law => law.energy_density(stress, state))
    }
}
