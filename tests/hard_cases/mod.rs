//! Cases chosen to hurt: layouts on which a fit is barely defined, partly filled cells, free surfaces and
//! gaps, extreme input, arithmetic with more and with fewer digits than usual, random and damaged scenes, and
//! the time step on layouts that fit no grid.
//!
//! What a case must give is known from exact solutions and from a scalar of twice the digits
//! ([`double_double`]), not from the code it judges in its own arithmetic. What a method does not bear is
//! asserted with its measured figure.

mod body;
mod critical_step;
mod degenerate;
mod double_double;
mod extreme;
mod generated;
mod long_runs;
mod partly_filled;
mod positive_density;
mod precision;
mod step_bound;
mod through_scenes;
mod weak_dof;
