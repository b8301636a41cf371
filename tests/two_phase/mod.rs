//! Two phases: a saturated solid on the same stepper, all nine methods.

pub mod column;
mod consolidation;
mod critical_step;
mod dimensions;
mod drag;
mod equilibrium;
mod large;
mod random;
mod standing_wave;
