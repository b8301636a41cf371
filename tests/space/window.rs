//! Source: our own. Goal: a body in a grid that is much larger than itself takes work and memory in
//! proportion to the body, and does exactly what it does where all of the grid has numbers. Parameters: a
//! disc that spins and flies through some 40 cells, all bases; a ball in a grid of 1e9 cells. Expected: equal
//! bits, but for what a consistent mass is solved to; less than 1 kB for each particle.

use materialpoint::basis::{BSpline, BasisFamily, DualDomain, FixedPoints, Linear};
use materialpoint::grid::{Cell, Grid};
use materialpoint::law::{Moduli, NeoHookean};
use materialpoint::particles::{Bins, Particles, lattice};
use materialpoint::phase::OnePhase;
use materialpoint::reconstruction::{Reconstruction, RelaxedTaylor, Shepard, Taylor};
use materialpoint::stepper::{Forcing, Setup, Stepper};
use nalgebra::SVector;

/// The same functions, but those of all of the grid have numbers.
#[derive(Clone)]
struct Everywhere<B>(B);

impl<const D: usize, B: BasisFamily<f64, D>> BasisFamily<f64, D> for Everywhere<B> {
    const TAKES_IN_CELLS: bool = B::TAKES_IN_CELLS;
    const WIDTH: usize = B::WIDTH;
    const AT_FIXED_POINTS: FixedPoints = B::AT_FIXED_POINTS;

    fn take_in(&mut self, grid: &Grid<f64, D>, bins: &Bins<D>) {
        self.0.take_in(grid, bins);
    }

    fn factors<K: materialpoint::simd::Lanes<f64>>(
        &self,
        k: K,
        grid: &Grid<f64, D>,
        cell: &Cell<D>,
        unit: &[K::V; D],
    ) -> materialpoint::basis::Factors<K::V, D> {
        self.0.factors(k, grid, cell, unit)
    }

    fn first_dofs(&self, grid: &Grid<f64, D>, cell: &Cell<D>) -> [usize; D] {
        self.0.first_dofs(grid, cell)
    }

    fn degree(&self) -> usize {
        self.0.degree()
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

    fn for_each_at_fixed_point(
        &self,
        grid: &Grid<f64, D>,
        cell: &Cell<D>,
        x: &SVector<f64, D>,
        f: impl FnMut(usize, f64, SVector<f64, D>),
    ) {
        self.0.for_each_at_fixed_point(grid, cell, x, f);
    }

    fn dof_window(&self, grid: &Grid<f64, D>, first: &Cell<D>, last: &Cell<D>) -> std::ops::Range<usize> {
        self.0.dof_window(grid, first, last)
    }
}

type Solid<const D: usize, B, R> = Stepper<f64, D, B, R, NeoHookean<f64>, OnePhase>;

/// A ball about `centre` that flies with the velocity 40 along every axis and spins.
fn ball<const D: usize, B: BasisFamily<f64, D>, R: Reconstruction<f64, D>>(
    basis: B,
    reconstruction: R,
    (cells, per_cell): (usize, usize),
    centre: f64,
) -> Solid<D, B, R> {
    let grid = Grid::new(SVector::zeros(), SVector::repeat(cells as f64), [cells; D]).unwrap();
    let corner = |sign: f64| SVector::repeat(centre + 4.0 * sign);
    let mut points = lattice(&grid, &corner(-1.0), &corner(1.0), [per_cell; D]);
    points.retain(|(x, _)| x.add_scalar(-centre).norm() < 3.3);
    let mut particles = Particles::at_rest(&points, 1.0);
    for (v, x) in particles.velocity.iter_mut().zip(&particles.position) {
        *v = SVector::repeat(40.0);
        v[0] -= 2.0 * (x[1] - centre);
        v[1] += 2.0 * (x[0] - centre);
    }
    let moduli = Moduli::from_young(1e3, 0.3).unwrap();
    let setup = Setup::new(
        grid,
        basis,
        reconstruction,
        NeoHookean { moduli },
        OnePhase,
        particles,
    );
    Stepper::new(setup).unwrap()
}

/// Flies with all of the grid and with a window, and hands both over.
fn fly<B: BasisFamily<f64, 2>, R: Reconstruction<f64, 2> + Clone>(
    basis: B,
    reconstruction: R,
    (per_cell, steps): (usize, u32),
) -> (Solid<2, Everywhere<B>, R>, Solid<2, B, R>) {
    let mut all = ball(
        Everywhere(basis.clone()),
        reconstruction.clone(),
        (70, per_cell),
        10.0,
    );
    let mut part = ball(basis, reconstruction, (70, per_cell), 10.0);
    let first = part.grid().window().first();
    for _ in 0..steps {
        all.step(1.0 / f64::from(steps), &Forcing::none()).unwrap();
        part.step(1.0 / f64::from(steps), &Forcing::none()).unwrap();
    }
    assert!(
        part.grid().window().first()[0] > first[0] + 20,
        "the window has followed"
    );
    assert!(part.dof_count() * 3 < all.dof_count());
    (all, part)
}

#[track_caller]
fn compare<B: BasisFamily<f64, 2>>(basis: B) {
    let (all, part) = fly(basis, Shepard, (2, 200));
    assert_eq!(all.particles().position, part.particles().position);
    assert_eq!(all.particles().stress, part.particles().stress);
}

#[test]
fn where_the_window_lies_changes_no_bit() {
    compare(BSpline::<2>);
    compare(Linear);
    compare(DualDomain::new());
}

/// So many that sums over them are cut into spans, whose DOFs are windows of the window.
#[track_caller]
fn compare_many<B: BasisFamily<f64, 2>>(basis: B) {
    let mut all = ball::<2, _, _>(Everywhere(basis.clone()), Shepard, (70, 24), 10.0);
    let mut part = ball::<2, _, _>(basis, Shepard, (70, 24), 10.0);
    assert!(part.particles().len() > 4 * 4096);
    for _ in 0..30 {
        all.step(5e-3, &Forcing::none()).unwrap();
        part.step(5e-3, &Forcing::none()).unwrap();
    }
    let places = all.particles().position.iter().zip(&part.particles().position);
    let apart = places.map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
    assert!(apart < 1e-11, "{apart:e}");
}

#[test]
fn bodies_of_many_particles_fly_in_a_window_too() {
    compare_many(BSpline::<2>);
    compare_many(DualDomain::new());
}

/// The preconditioner is that of the window: the solutions differ within their tolerance.
#[test]
fn with_a_consistent_mass_it_changes_the_last_digits() {
    let (all, part) = fly(BSpline::<2>, RelaxedTaylor::<f64, 2, 6>::for_degree(2), (3, 400));
    let places = all.particles().position.iter().zip(&part.particles().position);
    let apart = places.map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
    assert!(apart < 1e-8, "{apart:e}");
}

/// The fits' mean density counts four cells side by side, the same four wherever the window lies.
#[test]
fn nor_with_taylor_least_squares_in_a_body_that_stays_whole() {
    let mut all = ball::<2, _, _>(
        Everywhere(BSpline::<2>),
        Taylor::<f64, 2, 6>::new(),
        (70, 2),
        10.0,
    );
    let mut part = ball::<2, _, _>(BSpline::<2>, Taylor::<f64, 2, 6>::new(), (70, 2), 10.0);
    for _ in 0..40 {
        all.step(5e-3, &Forcing::none()).unwrap();
        part.step(5e-3, &Forcing::none()).unwrap();
    }
    assert_eq!(all.particles().velocity, part.particles().velocity);
}

#[test]
fn a_body_in_a_grid_of_a_billion_cells_takes_memory_like_itself() {
    let mut stepper = ball::<3, _, _>(BSpline::<2>, Shepard, (1000, 2), 500.0);
    for _ in 0..20 {
        stepper.step(5e-3, &Forcing::none()).unwrap();
    }
    let bytes = stepper.bytes_per_particle();
    assert!(bytes < 1000.0, "{bytes}");
}
