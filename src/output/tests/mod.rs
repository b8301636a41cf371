//! Files and pictures, with good and degenerate data.

mod files;
mod pictures;
