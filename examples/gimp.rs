//! Uniform GIMP (Bardenhagen & Kober 2004) as a basis of your own: linear functions averaged over particles.
//!
//! `cargo run --release --example gimp`

use std::error::Error;

use materialpoint::basis::{AxisBasis, AxisCell, BasisFamily, Domain, Functions, Linear};
use materialpoint::grid::{Face, Grid, Side};
use materialpoint::law::{LinearElastic, Moduli};
use materialpoint::particles::Particles;
use materialpoint::phase::OnePhase;
use materialpoint::reconstruction::Shepard;
use materialpoint::scalar::Scalar;
use materialpoint::simd::{Lanes, Number};
use materialpoint::stepper::{FaceCondition, Forcing, Setup, Stepper, SurfacePoint};
use nalgebra::vector;

/// Linear functions averaged over the undeformed box of a particle, which is no larger than a cell: `phi_ip =
/// integral of N_i over the box / its volume`, and the gradient likewise.
///
/// Along an axis a box of half length `l` about `u` sees the nodes of its cell and, where it sticks out by
/// `t`, one more. In its own cell the hats are `1 - u` and `u`; beyond an edge they bend by so much times the
/// distance from it (1, -2 and 1 for the three nodes about the edge), whose mean over the box is `t^2 / (4
/// l)`, with the derivative `t / (2 l)` by the box's place.
///
/// At the ends of the grid nothing bends: there are no cells beyond, and the functions of the end cell go on.
/// This is a box that shrinks towards its centre as it meets the wall. Values stay a partition of unity and
/// not negative, linear fields are exact up to the wall, and only the end's own node has a value there, so
/// that a wall holds the material exactly. A box that is cut off would have its centre elsewhere than the
/// particle, and a linear field another value there than at the particle.
#[derive(Clone, Copy, Debug)]
pub struct Gimp;

impl Gimp {
    /// The first of the four nodes: the one before the cell's own two, or the first or fourth last of the
    /// grid.
    fn first_node(at: AxisCell) -> usize {
        at.cell.min((at.cells + 1).saturating_sub(3)).saturating_sub(1)
    }

    /// The cell's own functions, bent by the means of what sticks out below and above, and those means'
    /// derivatives by the place.
    #[inline(always)]
    fn bent<T: Scalar, K: Lanes<T>>(
        k: K,
        at: AxisCell,
        u: K::V,
        [below, above]: [K::V; 2],
        [falls, grows]: [K::V; 2],
    ) -> Functions<K::V, 4> {
        let (zero, one) = (k.splat(T::zero()), k.splat(T::one()));
        let value = [
            below,
            one - u - below - below + above,
            u + below - above - above,
            above,
        ];
        let slope = [
            zero - falls,
            falls + falls + grows - one,
            one - falls - grows - grows,
            grows,
        ];
        // At an end of the grid the four nodes begin at another place, and those left over have a zero.
        match at.cell - Self::first_node(at) {
            0 => Functions {
                value: [value[1], value[2], value[3], zero],
                slope: [slope[1], slope[2], slope[3], zero],
            },
            1 => Functions { value, slope },
            _ => Functions {
                value: [zero, value[0], value[1], value[2]],
                slope: [zero, slope[0], slope[1], slope[2]],
            },
        }
    }
}

impl<T: Scalar> AxisBasis<T, 4> for Gimp {
    const DOMAIN: Domain = Domain::Size { most: 0.5 };

    fn dofs_on_axis(&self, cells: usize) -> usize {
        cells + 1
    }

    fn first_dof(&self, at: AxisCell) -> usize {
        Self::first_node(at)
    }

    /// Points are boxes that have vanished: nothing sticks out.
    #[inline(always)]
    fn evaluate<K: Lanes<T>>(&self, k: K, at: AxisCell, u: K::V) -> Functions<K::V, 4> {
        let nothing = [k.splat(T::zero()); 2];
        Self::bent(k, at, u, nothing, nothing)
    }

    #[inline(always)]
    fn evaluate_over<K: Lanes<T>>(&self, k: K, at: AxisCell, u: K::V, l: K::V) -> Functions<K::V, 4> {
        let (zero, one) = (k.splat(T::zero()), k.splat(T::one()));
        let half = k.splat(T::lit(0.5));
        // What sticks out below and above, where there is a cell.
        let stick_out = |by: K::V, is_end: bool| if is_end { zero } else { by * by.above(zero) };
        let out = [
            stick_out(l - u, at.cell == 0),
            stick_out(u + l - one, at.cell + 1 == at.cells),
        ];
        // Of a box without length nothing sticks out, whatever that is divided by.
        let length = l + l + (one - l.above(zero));
        let slopes = out.map(|t| t / length);
        let means = [out[0] * slopes[0] * half, out[1] * slopes[1] * half];
        Self::bent(k, at, u, means, slopes)
    }
}

// In every dimension: the product of the one-axis functions.
materialpoint::tensor_product_family!(Gimp, width = 4, degree = 1);

/// A bar under even tension that flies through the grid, in balance with the tractions at its ends: its
/// stress stays what it is. Returns the largest relative error of the stress of a flight across four cells.
///
/// There are 3 1/3 particles a cell, so that with functions at points a node feels now more of them on one
/// side, now on the other (grid crossing noise). Boxes that fill the bar leave no force between them.
pub fn run<B: BasisFamily<f64, 1>>(basis: B) -> Result<f64, Box<dyn Error>> {
    let (count, spacing, density, modulus, tension, speed) = (30, 0.3, 1e3, 1e6, 1e3, 1.0);
    let grid = Grid::new(vector![0.0], vector![20.0], [20])?;
    let points: Vec<_> = (0..count)
        .map(|p| (vector![2.05 + spacing * (f64::from(p) + 0.5)], spacing))
        .collect();
    let mut particles = Particles::at_rest(&points, density);
    particles.velocity.fill(vector![speed]);
    particles.stress.iter_mut().for_each(|stress| stress[0] = tension);
    let (low, high) = (
        Face {
            axis: 0,
            side: Side::Min,
        },
        Face {
            axis: 0,
            side: Side::Max,
        },
    );
    let end = |particle, face| SurfacePoint {
        particle,
        face,
        area: 1.0,
        reach: 0.5,
        loaded: true,
    };
    let surface = vec![end(0, low), end(points.len() - 1, high)];
    let mut stepper = Stepper::new(
        Setup::new(
            grid,
            basis,
            Shepard,
            LinearElastic {
                moduli: Moduli::uniaxial(modulus)?,
            },
            OnePhase,
            particles,
        )
        .with_surface(surface),
    )?;
    let mut forcing = Forcing::none();
    forcing.set_face(low, FaceCondition::Traction(vector![-tension]));
    forcing.set_face(high, FaceCondition::Traction(vector![tension]));
    let (mut worst, dt) = (0.0_f64, 5e-3);
    for _ in 0..800 {
        stepper.step(dt, &forcing)?;
        for stress in &stepper.particles().stress {
            worst = worst.max((stress[0] / tension - 1.0).abs());
        }
    }
    Ok(worst)
}

// The tests include this file as a module and call `run` themselves.
#[allow(dead_code)]
fn main() -> Result<(), Box<dyn Error>> {
    println!("error of the stress of a bar that flies, relative to the stress:");
    println!("  linear functions at points: {:.1e}", run(Linear)?);
    println!("  the same over particles (uGIMP): {:.1e}", run(Gimp)?);
    Ok(())
}
