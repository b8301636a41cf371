//! The stages of a step with a liquid that flows through the pores: a second balance of momentum beside the
//! solid's.
//!
#![doc = include_str!("../../../docs/formulas.html")]
//!
//! The same stages as in one phase, each with both phases in one pass, and one more before them: the DOF
//! velocities at the step's start, which the drag needs. Per DOF, with $m_s$, $\bar m_w$ and $d$ the lumped
//! solid mass, liquid mass and drag, and $m_w = \bar m_w/n$ ([`mod@crate::phase`]),
//!
//! $$m_w a_w = f_w + d(v_s - v_w) + m_w b,\qquad m_s a_s + \bar m_w a_w = f + (m_s + \bar m_w) b.$$
//!
//! A reconstruction with the particles' consistent matrices
//! ([`crate::mass::ParticleMatrix`]) solves the same two balances with these
//! (`joint`), in one dimension so far.

mod acceleration;
mod consistent;
mod critical;
mod joint;
mod relax;
mod seal;
mod surface;
mod velocity;

pub(super) use critical::Coupled;
pub(super) use joint::Joint;
pub(super) use seal::Seal;
pub(super) use surface::UniformLoad;
