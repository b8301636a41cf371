//! Taylor least squares on nodal patches, through the library: what they are exact for, how accurate waves
//! are, what free bodies keep, and what they refuse.

mod free;
mod refusals;
mod waves;

use materialpoint::basis::{BSpline, BasisFamily, DualDomain, Linear};
use materialpoint::grid::{Face, Grid};
use materialpoint::law::{Moduli, NeoHookean};
use materialpoint::mass::ParticleSeries;
use materialpoint::particles::{Particles, lattice};
use materialpoint::phase::OnePhase;
use materialpoint::reconstruction::NodalTaylor;
use materialpoint::stepper::{FaceCondition, Forcing, Setup, Stepper};
use nalgebra::SVector;
