//! Cases chosen to hurt: layouts on which a fit is barely defined, and arithmetic with more and with fewer digits
//! than usual.
//!
//! What a case must give is known from a scalar of twice the digits ([`double_double`]), not from the code it judges
//! in its own arithmetic.

mod degenerate;
mod double_double;
mod precision;
