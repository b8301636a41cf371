//! Cases that nobody would think of: random scenes, damaged scenes, and the time step on layouts that fit no grid.

mod critical_step;
mod generated;
