//! Scenes as people write them.

mod malformed;
mod warnings;
