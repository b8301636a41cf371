//! Domains of particles: what the basis asks for, from the layout at the start.

use nalgebra::{SMatrix, SVector};

use super::contact::shapes;
use crate::basis::{BasisFamily, Domain};
use crate::error::SetupError;
use crate::grid::Grid;
use crate::particles::{Domains, Particles};
use crate::scalar::Scalar;

/// By so much, relatively, a half length may exceed what the basis allows: round-off of the layout.
const TOLERANCE: f64 = 1e-6;

/// Finds the domains that the basis asks for where the particles bring none: boxes of the particles' volumes,
/// as wide along each axis as the spacing in the layout at the start tells.
pub(super) fn lay<T: Scalar, const D: usize, B: BasisFamily<T, D>, S, P>(
    grid: &Grid<T, D>,
    particles: &mut Particles<T, D, S, P>,
) {
    if const { B::DOMAIN.is_asked_for() } && particles.domains == Domains::none() {
        particles.domains = boxes(B::DOMAIN, grid, &particles.initial_position, &particles.volume);
    }
}

/// Boxes of these volumes: compiled for no basis.
#[inline(never)]
fn boxes<T: Scalar, const D: usize>(
    kind: Domain,
    grid: &Grid<T, D>,
    initial: &[SVector<T, D>],
    volumes: &[T],
) -> Domains<T, D> {
    let shapes = shapes(grid, initial).into_iter();
    let half_lengths = shapes.zip(volumes).map(|(shape, volume)| {
        let root = volume.powf(T::one() / T::count(D));
        shape * (root / T::lit(2.0))
    });
    let mut domains = Domains::none();
    match kind {
        Domain::Edges => {
            let edges = half_lengths.map(|half| SMatrix::from_diagonal(&half));
            domains.half_edges = edges.collect();
        }
        _ => domains.half_lengths = half_lengths.collect(),
    }
    domains
}

/// Checks that particles have the domains that the basis asks for, and no others.
pub(super) fn validate<T: Scalar, const D: usize, B: BasisFamily<T, D>, S, P>(
    grid: &Grid<T, D>,
    particles: &Particles<T, D, S, P>,
) -> Result<(), SetupError> {
    validate_kind(B::DOMAIN, grid, &particles.domains, particles.position.len())
}

/// The same for the domains that a basis asks for: compiled for no basis.
#[inline(never)]
fn validate_kind<T: Scalar, const D: usize>(
    kind: Domain,
    grid: &Grid<T, D>,
    domains: &Domains<T, D>,
    count: usize,
) -> Result<(), SetupError> {
    let (sizes, edges) = match kind {
        Domain::Point => (0, 0),
        Domain::Size { .. } => (count, 0),
        Domain::Edges => (0, count),
    };
    for ((name, found), expected) in domains.lengths().zip([sizes, edges]) {
        if found > expected {
            return Err(SetupError::UnwantedDomains { name });
        }
        if found < expected {
            return Err(SetupError::Lengths {
                name,
                found,
                expected,
            });
        }
    }
    let most = match kind {
        Domain::Size { most } => T::lit(most * (1.0 + TOLERANCE)),
        _ => return validate_edges(&domains.half_edges),
    };
    for (p, half) in domains.half_lengths.iter().enumerate() {
        let in_cells = half.component_mul(grid.inverse_cell_size());
        // What is not a number is not within the limits either.
        let fits = |length: &T| *length >= T::zero() && *length <= most;
        if let Some(length) = in_cells.iter().find(|length| !fits(length)) {
            return Err(SetupError::Value {
                particle: p,
                name: "half length in cell sizes",
                value: length.primal(),
                allowed: "it must not be negative, nor greater than the basis allows (Domain::Size)",
            });
        }
    }
    Ok(())
}

fn validate_edges<T: Scalar, const D: usize>(half_edges: &[SMatrix<T, D, D>]) -> Result<(), SetupError> {
    for (p, edges) in half_edges.iter().enumerate() {
        if let Some(bad) = edges.iter().find(|component| !component.is_finite()) {
            return Err(SetupError::Value {
                particle: p,
                name: "half edge vector",
                value: bad.primal(),
                allowed: "it must be finite",
            });
        }
    }
    Ok(())
}
