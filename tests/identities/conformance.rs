//! The crate's own families, reconstructions and laws under the checks of `materialpoint::testing`, and defects
//! that the checks must find.

mod basis;
mod law;
mod reconstruction;
