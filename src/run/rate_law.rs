//! The laws that remember nothing but the stress, chosen at run time: a branch per particle (a percent of a step's
//! instructions) for a third of the steppers to compile.

use crate::law::one_of::one_of_laws;
use crate::law::{Hill, LinearElastic, Logarithmic};

one_of_laws!(
    /// One of those in one dimension.
    pub(super) enum UniaxialRateLaw {
        LinearElastic,
        Hill,
        Logarithmic,
    }
    impl [] in 1 with ()
);

one_of_laws!(
    /// One of those in two and three dimensions.
    pub(super) enum RateLaw {
        LinearElastic,
        Hill,
    }
    impl [const D: usize] in D with ()
);
