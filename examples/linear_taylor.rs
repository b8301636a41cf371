//! A reconstruction of your own: Taylor least squares with two functions along one axis, in one file.
//!
//! `cargo run --release --example linear_taylor`

use std::error::Error;
use std::f64::consts::PI;
use std::ops::Range;

use materialpoint::basis::BSpline;
use materialpoint::field::Field;
use materialpoint::grid::{Face, Grid, Side};
use materialpoint::law::{Logarithmic, Moduli};
use materialpoint::mass::{MassModel, VelocityMass};
use materialpoint::particles::{Particles, lattice};
use materialpoint::phase::OnePhase;
use materialpoint::quadrature::gauss_legendre;
use materialpoint::reconstruction::{
    CellStream, Cloud, InCells, NoFilter, Patch, Point, Reconstruction, Shepard, Taylor,
};
use materialpoint::reference::{self, LagrangianBar, Reference};
use materialpoint::scalar::Scalar;
use materialpoint::stepper::{FaceCondition, Forcing, Setup, Stepper};
use nalgebra::vector;

/// In each cell a line through the particles' values, `a + b s` with `s` from -1 to 1 across the cell,
/// integrated by Gauss quadrature: the constant and the linear Taylor function of Wobbes, Moeller, Galavi &
/// Vuik (2019).
///
/// It is for bodies that fill their cells. In a cell of which the particles fill less than about half, from
/// one end, the line of the mass density falls below zero at the far Gauss point; the library's `Taylor`
/// limits it there.
#[derive(Clone, Debug)]
pub struct LinearTaylor<T> {
    /// Gauss points and weights on `[-1, 1]`. Two integrate the line times a quadratic shape function
    /// exactly.
    rule: Vec<(T, T)>,
    /// The layout of the particles in each occupied cell, in the order of the list of those.
    layouts: Vec<Layout<T>>,
}

/// What the fits of one cell ask of its particles' local coordinates, whatever field is fitted.
#[derive(Clone, Copy, Debug)]
struct Layout<T> {
    /// The part of the cell that is fitted and integrated: all of it, or what the surface of a body leaves.
    patch: Patch<T, 1>,
    /// One over the number of particles.
    share: T,
    /// Mean of `s`.
    mean: T,
    /// One over the sum of `(s - mean)^2`, or zero where the particles do not tell a line from a constant.
    inverse_spread: T,
    /// The same of `s^2`, for the fit whose mean is given: its line turns about the centre.
    inverse_square: T,
}

impl<T: Scalar> Layout<T> {
    fn new(cloud: &Cloud<'_, T, 1>, cell: usize) -> Self {
        let (patch, particles) = (cloud.patch(cell), cloud.bins.particles_in(cell));
        let local = |&p: &u32| patch.local(&cloud.positions[p as usize])[0];
        let sum = |f: &dyn Fn(T) -> T| particles.iter().map(local).fold(T::zero(), |sum, s| sum + f(s));
        let count = T::count(particles.len());
        let mean = sum(&|s| s) / count;
        let spread = sum(&|s| (s - mean) * (s - mean));
        // A single particle fixes no slope, nor do several within a fiftieth of the cell: there a line would
        // carry the noise of their values across the whole cell, and the mean has to do.
        let least = count * T::lit(4e-4);
        let determined = |square: T| {
            if particles.len() > 1 && spread > least {
                T::one() / square
            } else {
                T::zero()
            }
        };
        Self {
            patch,
            share: T::one() / count,
            mean,
            inverse_spread: determined(spread),
            inverse_square: determined(sum(&|s| s * s)),
        }
    }
}

impl<T: Scalar> LinearTaylor<T> {
    /// With two Gauss points a cell.
    pub fn new() -> Self {
        Self {
            rule: gauss_legendre(2),
            layouts: Vec::new(),
        }
    }

    /// Streams the line that `fit` finds in each of the given occupied cells, from its layout and its
    /// particles with their local coordinates.
    fn stream<Q: Field<T>>(
        &self,
        cloud: &Cloud<'_, T, 1>,
        cells: Range<usize>,
        fit: impl Fn(&Layout<T>, &[u32]) -> [Q; 2],
        mut sink: impl FnMut(&Point<T, 1>, Q),
    ) {
        let occupied = &cloud.bins.occupied()[cells.clone()];
        for (&cell, layout) in occupied.iter().zip(&self.layouts[cells]) {
            let patch = &layout.patch;
            let [a, b] = fit(layout, cloud.bins.particles_in(cell as usize));
            for &(s, weight) in &self.rule {
                let mut value = a;
                value.add_scaled(s, b);
                // A Gauss point stands still in its cell; the rule's weights sum to 2, the length of [-1, 1].
                let point = Point::fixed(patch.cell, patch.position(&vector![s]));
                sink(&point, value.scaled(patch.half[0] * weight));
            }
        }
    }
}

impl<T: Scalar> Default for LinearTaylor<T> {
    fn default() -> Self {
        Self::new()
    }
}

impl<T: Scalar> Reconstruction<T, 1> for LinearTaylor<T> {
    /// Cells are streamed one by one (`CellStream`), so that threads may share them.
    type Points = InCells;
    /// Densities are fitted too: momenta may be divided by any mass of these fits.
    type Mass = VelocityMass;
    type Filter = NoFilter;

    /// The step asks for it once; stress, mass and momentum then share the layouts.
    fn prepare(&mut self, cloud: &Cloud<'_, T, 1>) {
        let cells = cloud.bins.occupied().iter();
        self.layouts.clear();
        self.layouts
            .extend(cells.map(|&cell| Layout::new(cloud, cell as usize)));
    }

    fn integrate<Q: Field<T>>(
        &mut self,
        cloud: &Cloud<'_, T, 1>,
        value: impl Fn(usize) -> Q,
        sink: impl FnMut(&Point<T, 1>, Q),
    ) {
        self.integrate_cells(cloud, 0..self.layouts.len(), value, sink);
    }

    fn integrate_conserved<Q: Field<T>>(
        &mut self,
        cloud: &Cloud<'_, T, 1>,
        amount: impl Fn(usize) -> Q,
        sink: impl FnMut(&Point<T, 1>, Q),
    ) {
        self.integrate_conserved_cells(cloud, 0..self.layouts.len(), amount, sink);
    }
}

impl<T: Scalar> CellStream<T, 1> for LinearTaylor<T> {
    /// The free fit (stress): the line of least squares through the values, which goes through their mean at
    /// the mean of `s`.
    fn integrate_cells<Q: Field<T>>(
        &self,
        cloud: &Cloud<'_, T, 1>,
        cells: Range<usize>,
        value: impl Fn(usize) -> Q,
        sink: impl FnMut(&Point<T, 1>, Q),
    ) {
        let fit = |layout: &Layout<T>, particles: &[u32]| {
            let (mut mean, mut slope) = (Q::zero(), Q::zero());
            for &p in particles {
                let (p, value) = (p as usize, value(p as usize));
                let s = layout.patch.local(&cloud.positions[p])[0];
                mean.add_scaled(layout.share, value);
                slope.add_scaled((s - layout.mean) * layout.inverse_spread, value);
            }
            mean.add_scaled(-layout.mean, slope);
            [mean, slope]
        };
        self.stream(cloud, cells, fit, sink);
    }

    /// The conservative fit (mass, momentum): the first coefficient is what the cell holds over its volume,
    /// and the second function integrates to zero. So every cell keeps its amount, whatever the slope is.
    fn integrate_conserved_cells<Q: Field<T>>(
        &self,
        cloud: &Cloud<'_, T, 1>,
        cells: Range<usize>,
        amount: impl Fn(usize) -> Q,
        sink: impl FnMut(&Point<T, 1>, Q),
    ) {
        let fit = |layout: &Layout<T>, particles: &[u32]| {
            let total = particles
                .iter()
                .fold(Q::zero(), |sum, &p| sum + amount(p as usize));
            let mean = total.scaled(T::one() / layout.patch.volume());
            let mut slope = Q::zero();
            for p in particles.iter().map(|&p| p as usize) {
                let s = layout.patch.local(&cloud.positions[p])[0] * layout.inverse_square;
                // Least squares through the densities, less their given mean.
                slope.add_scaled(s / cloud.volumes[p], amount(p));
                slope.add_scaled(-s, mean);
            }
            [mean, slope]
        };
        self.stream(cloud, cells, fit, sink);
    }
}

/// A bar of 1 m between two walls, swinging in its first mode `velocity sin(pi x / L)`.
type Bar<R> = Stepper<f64, 1, BSpline<2>, R, Logarithmic<f64>, OnePhase>;

const LENGTH: f64 = 1.0;
const DENSITY: f64 = 2e3;
const MODULUS: f64 = 4e4;

/// What a bar does with a reconstruction.
#[derive(Clone, Copy, Debug)]
pub struct Outcome {
    /// The reconstruction.
    pub name: &'static str,
    /// Period of a swing of 0.002 % strain over the exact one, less one.
    pub period: f64,
    /// Relative L2 error of the stress after a quarter of a period, at 20 % strain.
    pub stress: f64,
    /// Largest error of the mapped mass in a step of that swing, relative to the mass.
    pub mass: f64,
    /// The same of the momentum, relative to the sum of the sizes of the particles' momenta.
    pub momentum: f64,
    /// How often a particle changed its cell there.
    pub crossings: usize,
}

/// Lets a bar of so many cells swing with plain MPM, linear Taylor and the library's Taylor of three
/// functions.
///
/// At small strain theory knows the periods: with quadratic B-splines the stiffness of a wave `k = pi/L` is
/// too small by the factor `1 - (k h)^2/4` against the lumped mass behind the acceleration, so that the
/// period is too long by `(k h)^2/8`. Plain MPM lumps the mass behind the velocity as well, which costs as
/// much again. Walls add a third order.
///
/// Both Taylors swing alike: the quadratic function `s^2/2 - 1/6` is zero at both Gauss points of a cell, as
/// Legendre's polynomial is whose roots they are. It is felt only where particles lie so unevenly that
/// fitting it changes the line, as they do at large strain, and little.
pub fn run(cells: usize) -> Result<[Outcome; 3], Box<dyn Error>> {
    Ok([
        swing("Shepard", Shepard, cells)?,
        swing("linear Taylor", LinearTaylor::new(), cells)?,
        swing("Taylor", Taylor::<f64, 1, 3>::new(), cells)?,
    ])
}

fn swing<R>(name: &'static str, reconstruction: R, cells: usize) -> Result<Outcome, Box<dyn Error>>
where
    R: Reconstruction<f64, 1> + Clone,
{
    let ends = [Side::Min, Side::Max].map(|side| Face { axis: 0, side });
    let walls = ends
        .into_iter()
        .fold(Forcing::none(), |f, end| f.with_face(end, FaceCondition::fixed()));
    let exact = 2.0 * LENGTH / (MODULUS / DENSITY).sqrt();
    // Steps so small that what Euler-Cromer adds, (2 pi / steps)^2 / 24 of the period, is nothing beside the
    // grid's.
    let steps = 50 * cells;
    let dt = exact / steps as f64;
    let period = period(bar(reconstruction.clone(), cells, 1e-4)?, dt, steps, &walls)? / exact - 1.0;

    let velocity = 0.8;
    let mut strong = bar(reconstruction, cells, velocity)?;
    // Velocities are given at time zero and live half a step before the positions: the first kick is half of
    // one.
    strong.step_with_kick(dt / 2.0, dt, &walls)?;
    for _ in 1..steps / 4 {
        strong.step(dt, &walls)?;
    }
    let law = reference::Logarithmic {
        youngs_modulus: MODULUS,
    };
    let mut solution = LagrangianBar::vibrating_bar(LENGTH, DENSITY, velocity, law)?;
    solution.advance(strong.time())?;
    let particles = strong.particles();
    let (mut error, mut size) = (0.0, 0.0);
    for (stress, x0) in particles.stress.iter().zip(&particles.initial_position) {
        let expected = solution.at(x0[0]).stress;
        error += (stress[(0, 0)] - expected).powi(2);
        size += expected.powi(2);
    }
    let found = strong.diagnostics();
    Ok(Outcome {
        name,
        period,
        stress: (error / size).sqrt(),
        mass: found.conservation.mass,
        momentum: found.conservation.momentum_scaled,
        crossings: found.grid_crossings,
    })
}

/// The bar with 8 particles in each cell.
fn bar<R>(reconstruction: R, cells: usize, velocity: f64) -> Result<Bar<R>, Box<dyn Error>>
where
    R: Reconstruction<f64, 1>,
{
    let grid = Grid::new(vector![0.0], vector![LENGTH], [cells])?;
    let points = lattice(&grid, grid.min(), grid.max(), [8]);
    let mut particles = Particles::at_rest(&points, DENSITY);
    for (v, x) in particles.velocity.iter_mut().zip(&particles.position) {
        v[0] = velocity * (PI * x[0] / LENGTH).sin();
    }
    Ok(Stepper::new(
        Setup::new(
            grid,
            BSpline::<2>,
            reconstruction,
            Logarithmic {
                moduli: Moduli::uniaxial(MODULUS)?,
            },
            OnePhase,
            particles,
        )
        .with_velocity_mass(MassModel::preferring(VelocityMass::Consistent)),
    )?)
}

/// Twice the time until the bar, started undeformed, comes back, which it should well before the given steps
/// are over.
fn period<R>(mut bar: Bar<R>, dt: f64, steps: usize, walls: &Forcing<f64, 1>) -> Result<f64, Box<dyn Error>>
where
    R: Reconstruction<f64, 1>,
{
    let mut before = 0.0;
    for _ in 0..steps {
        bar.step(dt, walls)?;
        let particles = bar.particles();
        let moved = particles.displacement.iter().zip(&particles.initial_position);
        let now: f64 = moved.map(|(u, x0)| u[0] * (PI * x0[0] / LENGTH).sin()).sum();
        if now < 0.0 {
            return Ok(2.0 * (bar.time() + dt * now / (before - now)));
        }
        before = now;
    }
    Err("the bar does not come back".into())
}

// The tests include this file as a module and call `run` themselves.
#[allow(dead_code)]
fn main() -> Result<(), Box<dyn Error>> {
    println!("reconstruction: period, too long by; error of the stress; of mass and momentum");
    for found in run(20)? {
        println!(
            "{:>14}: {:.2e}; {:.2e}; {:.0e} and {:.0e} in {} crossings",
            found.name, found.period, found.stress, found.mass, found.momentum, found.crossings
        );
    }
    Ok(())
}
