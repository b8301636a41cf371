//! Files and pictures, with good and degenerate data.

mod files;
mod full_disk;
mod maps;
mod pictures;
pub(crate) mod scratch;
mod series;
mod vtu;
