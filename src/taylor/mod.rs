//! Taylor basis functions of one cell and the least-squares fit in them.
//!
#![doc = include_str!("../../docs/formulas.html")]
//!
//! In a cell with centre $c$ and half sizes $d_a$ let $s_a = (x_a - c_a)/d_a$. The basis (journal section
//! 5.2) is
//!
//! $$\psi_0 = 1,\quad \psi_{1+a} = s_a,\quad \tfrac12 s_a^2 - \tfrac16,\quad s_a s_b \quad (a \lt b),$$
//!
//! so $\int\psi_0 = |\text{cell}|$ and every other integral vanishes: a fit whose first coefficient is fixed
//! to the cell's mean keeps the integral exactly, whatever the other coefficients are.

mod basis;
mod fit;
mod four;
mod shared;
mod shift;

pub use basis::taylor_functions;
pub use fit::{CellFit, DEFAULT_TOLERANCE, DEFAULT_TOLERANCE_IN_SPACE, Gram, default_tolerance};
pub use four::MOST_COMPONENTS;
pub(crate) use four::{
    BatchSums, FEW_COMPONENTS, Factor, FourFits, Products, Rights, are_few, factorise, taylor_lanes,
};
pub(crate) use shared::{SharedFactor, keep_products, kept, kept_products};
pub(crate) use shift::{shift_lanes, shift_sums};
