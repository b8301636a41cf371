//! Scenes as people write them.

mod malformed;
mod same_as_api;
mod warnings;
