//! Hard cases: partly filled cells, free surfaces, gaps, extreme input.
//!
//! What is exact stays exact there, to round-off; what a method does not bear is asserted with its measured figure.

mod body;
mod extreme;
mod partly_filled;
mod weak_dof;
