//! Material point method, with basis, reconstruction, law and phase as types.

pub mod basis;
pub mod error;
pub mod field;
pub mod grid;
pub mod law;
pub mod mass;
pub mod method;
pub mod particles;
pub mod phase;
pub mod quadrature;
pub mod reconstruction;
pub mod reference;
pub mod scalar;
pub mod stepper;
pub mod taylor;
pub mod tensor;
pub mod testing;

#[cfg(feature = "scene")]
pub mod output;
#[cfg(feature = "scene")]
pub mod scene;
#[cfg(feature = "scene")]
pub mod study;
