//! Two phases: a saturated solid on the same stepper, all twelve methods.

mod body_forces;
pub mod column;
mod consolidation;
mod critical_step;
mod dimensions;
mod drag;
mod equilibrium;
mod large;
mod long_waves;
mod random;
mod remembers;
mod rubbing;
pub mod sealed;
mod slides;
mod space;
mod standing_wave;
mod threads;
