//! One binary for all integration tests: shared helpers compile once.

mod allocation;
mod architecture;
mod boundaries;
mod cases;
mod command;
mod compiled;
mod conservation;
mod convergence;
mod domains;
mod examples;
mod golden;
mod hard_cases;
mod identities;
mod laws;
mod nodal;
mod phase;
mod scenes;
mod space;
mod transfer;
mod two_phase;
