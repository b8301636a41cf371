//! The steppers of all methods that scenes can name, in the dimensions and scalars that they have there.
//!
//! What reads scenes, the command and the tests know steppers as
//! [`Simulation`](materialpoint::stepper::Simulation)s, and each is compiled once for all. That takes most of
//! the time of a build; so there is a crate for each dimension and scalar, which shares next to nothing with
//! the others: several compilers make them at a time, none of them with much memory.

#![forbid(unsafe_code)]

use materialpoint::method::Method;
pub use materialpoint_steppers_parts::{BuildError, Built, Parts};

/// Parts of which a stepper is compiled here.
pub trait Build<const D: usize> {
    /// The stepper of a method.
    ///
    /// # Errors
    /// If there is no such method, or the parts do not serve.
    fn stepper(self, method: Method) -> Built<D>;
}

macro_rules! build {
    ($($scalar:ty, $dimension:literal, $compiled:ident);+) => {$(
        impl Build<$dimension> for Parts<$scalar, $dimension> {
            fn stepper(self, method: Method) -> Built<$dimension> {
                $compiled::stepper(self, method)
            }
        }
    )+};
}

build! {
    f64, 1, materialpoint_steppers_line;
    f32, 1, materialpoint_steppers_line_f32;
    f64, 2, materialpoint_steppers_plane;
    f64, 3, materialpoint_steppers_space
}
