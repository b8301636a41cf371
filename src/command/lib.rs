//! Scenes of the material point method: what the command `materialpoint` is made of, for programs that read,
//! run and compare scenes themselves.
//!
//! [`scene`] reads TOML, [`run`] runs it, [`study`] compares methods on it, [`output`] writes files and
//! pictures. The method itself is the crate [`materialpoint`]; the steppers of all methods that scenes can
//! name are compiled in a crate of their own, once for everybody.

#![forbid(unsafe_code)]

pub mod output;
pub mod run;
pub mod scene;
pub mod study;
