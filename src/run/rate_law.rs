//! The laws that remember nothing but the stress, chosen at run time: a branch per particle (a percent of a step's
//! instructions) for a third of the steppers to compile.

use nalgebra::SMatrix;

use crate::law::{ConstitutiveLaw, Hill, LinearElastic, Logarithmic};
use crate::scalar::Scalar;

/// An enum of laws, and the law that it is in each of the given dimensions.
macro_rules! one_of_laws {
    ($(#[$doc:meta])* $name:ident in $dimensions:tt, $laws:tt) => {
        one_of_laws!(@enum $(#[$doc])* $name, $laws);
        one_of_laws!(@each $name, $dimensions, $laws);
    };
    (@enum $(#[$doc:meta])* $name:ident, [$($law:ident),+]) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug)]
        pub(super) enum $name<T> {
            $($law($law<T>)),+
        }
    };
    (@each $name:ident, [$($dimension:literal),+], $laws:tt) => {
        $(one_of_laws!(@law $name, $dimension, $laws);)+
    };
    (@law $name:ident, $dimension:literal, [$($law:ident),+]) => {
        impl<T: Scalar> ConstitutiveLaw<T, $dimension> for $name<T> {
            type State = ();

            #[inline(always)]
            fn large_strain(&self) -> bool {
                !matches!(self, Self::LinearElastic(_))
            }

            #[inline(always)]
            fn update(
                &self,
                increment: &SMatrix<T, $dimension, $dimension>,
                stress: &mut SMatrix<T, $dimension, $dimension>,
                state: &mut (),
            ) {
                match self {
                    $(Self::$law(law) => law.update(increment, stress, state)),+
                }
            }

            fn wave_speed(&self, density: T, stress: &SMatrix<T, $dimension, $dimension>, state: &()) -> T {
                match self {
                    $(Self::$law(law) => law.wave_speed(density, stress, state)),+
                }
            }

            fn off_plane_stress(
                &self,
                stress: &SMatrix<T, $dimension, $dimension>,
                state: &(),
            ) -> Option<T> {
                match self {
                    $(Self::$law(law) => law.off_plane_stress(stress, state)),+
                }
            }

            fn energy_density(&self, stress: &SMatrix<T, $dimension, $dimension>, state: &()) -> T {
                match self {
                    $(Self::$law(law) => law.energy_density(stress, state)),+
                }
            }
        }
    };
}

one_of_laws!(
    /// One of those in one dimension.
    UniaxialRateLaw in [1], [LinearElastic, Hill, Logarithmic]
);
one_of_laws!(
    /// One of those in two and three dimensions.
    RateLaw in [2, 3], [LinearElastic, Hill]
);
