//! Two phases in two dimensions: the column lying in a strip.
//!
//! Walls on all sides, rollers along the strip, Poisson's ratio 0, a motion along x only: every particle of
//! the strip must do what the column's particle at its x does, to round-off.

use materialpoint::grid::{Face, Grid};
use materialpoint::law::{ConstitutiveLaw, LinearElastic, Moduli, NeoHookean};
use materialpoint::mass::VelocityMass;
use materialpoint::method::{Basis, Method, ReconstructionKind};
use materialpoint::particles::{Particles, lattice};
use materialpoint::phase::{Drag, PoreLiquid, TwoPhase};
use materialpoint::record::Record;
use materialpoint::stepper::{FaceCondition, Forcing};
use materialpoint_steppers::{Build, Parts};
use nalgebra::SVector;

use crate::compiled::{self, parts};

const PHASE: TwoPhase<f64> = TwoPhase {
    porosity: 0.4,
    solid_density: 2.6e3,
    liquid_density: 1e3,
    liquid_bulk_modulus: 3e8,
    permeability: 1e-3,
    permeability_exponent: 0.0,
    gravity: 9.81,
    drag: Drag::Implicit,
};

/// Velocities along x, effective stress, pressure, largest conservation errors of the particles of the lowest
/// row.
fn run<const D: usize>(
    basis: Basis,
    reconstruction: ReconstructionKind,
    mass: VelocityMass,
) -> (Vec<[f64; 4]>, f64)
where
    Parts<f64, D>: Build<D>,
{
    let moduli = Moduli::from_young(1e7, 0.0).unwrap();
    let method = Method::new(basis, reconstruction);
    run_with(LinearElastic { moduli }, method, mass, 1e-3)
}

/// The same with another law and so much velocity (m/s).
fn run_with<const D: usize, L>(
    law: L,
    method: Method,
    mass: VelocityMass,
    velocity: f64,
) -> (Vec<[f64; 4]>, f64)
where
    L: ConstitutiveLaw<f64, D, State: Record<f64>> + 'static,
    Parts<f64, D>: Build<D>,
{
    let max = SVector::from_fn(|a, _| if a == 0 { 1.0 } else { 0.3 });
    let cells = std::array::from_fn(|a| if a == 0 { 10 } else { 3 });
    let grid = Grid::new(SVector::zeros(), max, cells).unwrap();
    let points = lattice(&grid, grid.min(), grid.max(), [4; D]);
    let mut particles: Particles<f64, D> = Particles::at_rest(&points, PHASE.dry_density());
    let mut pores = vec![PoreLiquid::default(); particles.len()];
    for p in 0..particles.len() {
        let s = (std::f64::consts::PI * particles.position[p][0]).sin();
        particles.velocity[p][0] = 1e-3 * s;
        pores[p].velocity[0] = 2.0 * velocity * s;
    }
    let parts = Parts {
        liquid: Some(PHASE),
        pores,
        ..parts(grid, law, particles)
    };
    let mut stepper = compiled::simulation(method, mass, parts);
    let walls = Face::all::<D>().fold(Forcing::none(), |f, face| {
        f.with_face(face, FaceCondition::roller(face.axis))
    });
    for _ in 0..100 {
        stepper.step(1e-5, &walls).unwrap();
    }
    let found = stepper.diagnostics();
    // In the order in which they were given.
    let (particles, liquid) = stepper.into_particles();
    let row = (0..40).map(|p| {
        let liquid = liquid[p];
        [
            particles.velocity[p][0],
            liquid.velocity[0],
            particles.stress[p][(0, 0)],
            liquid.pressure,
        ]
    });
    let kept = [found.conservation, found.liquid_conservation.unwrap()];
    let worst = kept.map(|c| c.mass.max(c.momentum_scaled));
    (row.collect(), worst[0].max(worst[1]))
}

#[track_caller]
fn compare((line, kept_1): (Vec<[f64; 4]>, f64), (strip, kept_2): (Vec<[f64; 4]>, f64)) {
    for k in 0..4 {
        let largest = line.iter().fold(0.0_f64, |m, v| m.max(v[k].abs()));
        assert!(largest > 0.0);
        for (a, b) in line.iter().zip(&strip) {
            assert!((a[k] - b[k]).abs() <= 1e-10 * largest, "{k}: {} {}", a[k], b[k]);
        }
    }
    assert!(kept_1 < 1e-13 && kept_2 < 1e-13, "{kept_1} {kept_2}");
}

const BSPLINE: Basis = Basis::BSpline { degree: 2 };

#[test]
fn a_strip_does_what_the_column_does() {
    let lumped = VelocityMass::Lumped;
    for (basis, reconstruction, mass) in [
        (Basis::Linear, ReconstructionKind::Shepard, lumped),
        (BSPLINE, ReconstructionKind::Shepard, lumped),
        (Basis::Linear, ReconstructionKind::Taylor, lumped),
        (
            Basis::Linear,
            ReconstructionKind::Taylor,
            VelocityMass::Consistent,
        ),
    ] {
        compare(
            run::<1>(basis, reconstruction, mass),
            run::<2>(basis, reconstruction, mass),
        );
    }
}

/// A law that remembers its deformation gradient, under some per cent of strain.
#[test]
fn a_strip_of_a_law_that_remembers_does_too() {
    fn neo_hookean<const D: usize>(basis: Basis) -> (Vec<[f64; 4]>, f64)
    where
        Parts<f64, D>: Build<D>,
        NeoHookean<f64>: ConstitutiveLaw<f64, D, State: Record<f64>>,
    {
        let moduli = Moduli::from_young(1e7, 0.0).unwrap();
        let method = Method::new(basis, ReconstructionKind::Shepard);
        run_with(NeoHookean { moduli }, method, VelocityMass::Lumped, 10.0)
    }
    compare(neo_hookean::<1>(Basis::Linear), neo_hookean::<2>(Basis::Linear));
    compare(neo_hookean::<1>(BSPLINE), neo_hookean::<2>(BSPLINE));
    compare(neo_hookean::<1>(Basis::Linear), neo_hookean::<3>(Basis::Linear));
}
