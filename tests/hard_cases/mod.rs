//! Cases chosen to hurt: layouts on which a fit is barely defined, arithmetic with more and with fewer digits than usual,
//! random and damaged scenes, and the time step on layouts that fit no grid.
//!
//! What a case must give is known from exact solutions and from a scalar of twice the digits ([`double_double`]), not from
//! the code it judges in its own arithmetic.

mod critical_step;
mod degenerate;
mod double_double;
mod generated;
mod precision;
