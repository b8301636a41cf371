//! What a second phase costs: the time of a two-phase step over that of a one-phase step of the same method,
//! and of implicit over explicit drag. Medians of alternating runs, smooth motion everywhere (decayed noise
//! would be denormal numbers).
//!
//! `cargo bench --bench phases`

use std::time::Instant;

use materialpoint::basis::BasisFamily;
use materialpoint::grid::{Face, Grid, Side};
use materialpoint::law::{LinearElastic, Moduli};
use materialpoint::mass::{MassModel, VelocityMass};
use materialpoint::method::{Method, MethodVisitor};
use materialpoint::particles::{Particles, lattice};
use materialpoint::phase::{Drag, OnePhase, Phase, PoreLiquid, TwoPhase};
use materialpoint::reconstruction::Reconstruction;
use materialpoint::record::Record;
use materialpoint::stepper::{
    FaceCondition, Forcing, PoreCondition, Setup, Simulation, Stepper, SurfacePoint,
};
use nalgebra::vector;

const CELLS: usize = 500;
const PER_CELL: usize = 8;
const STEPS: usize = 200;
const REPEATS: usize = 9;
const BASE: Face = Face {
    axis: 0,
    side: Side::Min,
};
const TOP: Face = Face {
    axis: 0,
    side: Side::Max,
};

/// Builds the column with one phase, or with two and the given drag.
#[derive(Clone, Copy)]
struct Build(Option<Drag>);

impl MethodVisitor<f64> for Build {
    type Output = Box<dyn Simulation<1>>;

    fn visit<B, R>(self, basis: B, reconstruction: R) -> Self::Output
    where
        B: BasisFamily<f64, 1> + Send + 'static,
        R: Reconstruction<f64, 1> + Clone + Send + 'static,
    {
        match self.0 {
            Some(drag) => {
                let phase = TwoPhase {
                    porosity: 0.4,
                    solid_density: 2.6e3,
                    liquid_density: 1e3,
                    liquid_bulk_modulus: 3e8,
                    permeability: 1e-4,
                    permeability_exponent: 0.0,
                    gravity: 9.81,
                    drag,
                };
                stepper(basis, reconstruction, phase, |x| PoreLiquid {
                    velocity: vector![0.02 * (1.0 + x).sin()],
                    pressure: -1e4,
                })
            }
            None => stepper(basis, reconstruction, OnePhase, |_| ()),
        }
    }
}

fn stepper<B, R, P>(
    basis: B,
    reconstruction: R,
    phase: P,
    liquid: impl Fn(f64) -> P::Particle,
) -> Box<dyn Simulation<1>>
where
    B: BasisFamily<f64, 1> + 'static,
    R: Reconstruction<f64, 1> + Clone + 'static,
    P: Phase<f64, 1, Particle: Record<f64>> + Clone + 'static,
{
    let grid = Grid::new(vector![0.0], vector![1.0], [CELLS]).expect("a valid grid");
    let points = lattice(&grid, grid.min(), grid.max(), [PER_CELL]);
    let mut particles: Particles<f64, 1, (), P::Particle> = Particles::at_rest(&points, 1560.0);
    for p in 0..particles.len() {
        let x: f64 = particles.position[p][0];
        particles.velocity[p][0] = 0.01 * (1.0 + x).sin();
        particles.phase[p] = liquid(x);
    }
    let surface = SurfacePoint {
        particle: particles.len() - 1,
        face: TOP,
        area: 1.0,
        reach: 0.5,
        loaded: true,
    };
    let moduli = Moduli::uniaxial(1e7).expect("a positive modulus");
    let stepper = Stepper::new(
        Setup::new(
            grid,
            basis,
            reconstruction,
            LinearElastic { moduli },
            phase,
            particles,
        )
        .with_velocity_mass(MassModel::preferring(VelocityMass::Consistent))
        .with_surface(vec![surface]),
    );
    Box::new(stepper.expect("a valid setup"))
}

/// Nanoseconds per particle and step.
fn time(simulation: &mut dyn Simulation<1>) -> f64 {
    let forcing = Forcing::none()
        .with_face(BASE, FaceCondition::fixed())
        .with_face(TOP, FaceCondition::Traction(vector![-1e4]))
        .with_pores(TOP, PoreCondition::Pressure(0.0));
    let mut step = || simulation.step(1e-7, &forcing).expect("a stable step");
    (0..STEPS / 10).for_each(|_| step());
    let begun = Instant::now();
    (0..STEPS).for_each(|_| step());
    begun.elapsed().as_secs_f64() * 1e9 / (STEPS * CELLS * PER_CELL) as f64
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn main() {
    println!(
        "method                 one phase  two/one  implicit/explicit drag   (ns per particle and step; ratios)"
    );
    for method in Method::ALL {
        let (mut one, mut two, mut drag) = (Vec::new(), Vec::new(), Vec::new());
        for _ in 0..REPEATS {
            let variants = [None, Some(Drag::Implicit), Some(Drag::Explicit)];
            let [dry, implicit, explicit] = variants.map(|variant| {
                let built = method.dispatch(Build(variant));
                time(built.expect("a known method").as_mut())
            });
            one.push(dry);
            two.push(implicit / dry);
            drag.push(implicit / explicit);
        }
        println!(
            "{:<22} {:9.1}  {:7.2}  {:22.3}",
            method.to_string(),
            median(one),
            median(two),
            median(drag)
        );
    }
}
