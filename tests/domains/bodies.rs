//! Bodies, and steppers of them.

use std::array::from_fn;

use materialpoint::basis::{BasisFamily, Domain, FixedPoints};
use materialpoint::grid::{Cell, Face, Grid};
use materialpoint::law::{Moduli, NeoHookean};
use materialpoint::particles::{Particles, lattice};
use materialpoint::phase::OnePhase;
use materialpoint::reconstruction::Reconstruction;
use materialpoint::stepper::{Setup, Stepper};
use nalgebra::{SMatrix, SVector};

pub type Body<const D: usize, B, R> = Stepper<f64, D, B, R, NeoHookean<f64>, OnePhase>;

/// The same functions over the same domains, of which nobody says that they are products: they are computed
/// point by point.
#[derive(Clone, Debug)]
pub struct OneByOne<B>(pub B);

impl<const D: usize, B: BasisFamily<f64, D>> BasisFamily<f64, D> for OneByOne<B> {
    const DOMAIN: Domain = B::DOMAIN;
    const AT_FIXED_POINTS: FixedPoints = FixedPoints::Alike;

    fn degree(&self) -> usize {
        self.0.degree()
    }

    fn reach(&self) -> usize {
        self.0.reach()
    }

    fn dofs(&self, grid: &Grid<f64, D>) -> [usize; D] {
        self.0.dofs(grid)
    }

    fn for_each(
        &self,
        grid: &Grid<f64, D>,
        cell: &Cell<D>,
        x: &SVector<f64, D>,
        f: impl FnMut(usize, f64, SVector<f64, D>),
    ) {
        self.0.for_each(grid, cell, x, f);
    }

    fn for_each_over(
        &self,
        grid: &Grid<f64, D>,
        cell: &Cell<D>,
        x: &SVector<f64, D>,
        domain: &SMatrix<f64, D, D>,
        f: impl FnMut(usize, f64, SVector<f64, D>),
    ) {
        self.0.for_each_over(grid, cell, x, domain, f);
    }

    fn for_each_on_face(&self, grid: &Grid<f64, D>, face: Face, f: impl FnMut(usize)) {
        self.0.for_each_on_face(grid, face, f);
    }
}

/// Particles of a body with so many along each axis of a cell, which turns, swings and flies across cells.
pub fn particles<const D: usize>(cells: usize, per_cell: usize) -> (Grid<f64, D>, Particles<f64, D>) {
    let side = cells as f64;
    let grid = Grid::new(SVector::zeros(), SVector::repeat(side), [cells; D]).unwrap();
    let (low, high) = (SVector::repeat(1.0), SVector::repeat(side - 2.0));
    let points = lattice(&grid, &low, &high, [per_cell; D]);
    let mut particles = Particles::at_rest(&points, 2.0);
    for (v, x) in particles.velocity.iter_mut().zip(&particles.position) {
        *v = SVector::from_fn(|a, _| {
            let beside = x[(a + 1) % D];
            1.0 + 0.1 * (a as f64) + 0.2 * (beside - 0.5 * side) / side + 0.1 * (2.0 * x[a]).sin()
        });
    }
    (grid, particles)
}

/// A stepper of particles that remember what their law asks for.
pub fn stepper<const D: usize, B, R>(
    basis: B,
    reconstruction: R,
    (grid, particles): (Grid<f64, D>, Particles<f64, D>),
) -> Body<D, B, R>
where
    B: BasisFamily<f64, D>,
    R: Reconstruction<f64, D>,
{
    let states = vec![Default::default(); particles.len()];
    Stepper::new(Setup::new(
        grid,
        basis,
        reconstruction,
        NeoHookean {
            moduli: Moduli::from_young(20.0, 0.3).unwrap(),
        },
        OnePhase,
        particles.with_states(states),
    ))
    .unwrap()
}

/// Positions, velocities, stresses and volumes in the order in which the particles were given.
pub fn state<const D: usize, B, R>(stepper: Body<D, B, R>) -> Vec<Vec<f64>>
where
    B: BasisFamily<f64, D>,
    R: Reconstruction<f64, D>,
{
    let all = stepper.into_setup().particles;
    let of = |p: usize| {
        let mut numbers = vec![all.volume[p]];
        numbers.extend(all.position[p].iter());
        numbers.extend(all.velocity[p].iter());
        numbers.extend(all.stress[p].iter());
        numbers
    };
    (0..all.len()).map(of).collect()
}

/// Whether all numbers agree, but for so much.
pub fn assert_near(a: &[Vec<f64>], b: &[Vec<f64>], allowed: f64, what: &str) {
    assert_eq!(a.len(), b.len());
    for (p, (a, b)) in a.iter().zip(b).enumerate() {
        for (a, b) in a.iter().zip(b) {
            assert!(
                (a - b).abs() <= allowed * (1.0 + a.abs()),
                "{what}, particle {p}: {a} {b}"
            );
        }
    }
}

/// The corner of a box.
pub fn corner<const D: usize>(number: usize) -> [f64; D] {
    from_fn(|axis| if number >> axis & 1 == 1 { 1.0 } else { -1.0 })
}
