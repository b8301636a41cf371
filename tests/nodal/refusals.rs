//! What nodal patches refuse.

use materialpoint::error::SetupError;
use materialpoint::law::LinearElastic;
use materialpoint::phase::{Drag, PoreLiquid, TwoPhase};

use super::*;

#[test]
fn a_liquid_that_flows_is_refused_by_name() {
    let grid = Grid::new(SVector::zeros(), SVector::repeat(1.0), [4]).unwrap();
    let points = lattice(&grid, grid.min(), grid.max(), [4]);
    let law = LinearElastic {
        moduli: Moduli::uniaxial(1e4).unwrap(),
    };
    let mut particles = Particles::<f64, 1, (), PoreLiquid<f64, 1>>::at_rest(&points, 1e3);
    particles.phase.fill(PoreLiquid {
        velocity: SVector::zeros(),
        pressure: 0.0,
    });
    let phase = TwoPhase {
        porosity: 0.4,
        solid_density: 2650.0,
        liquid_density: 1000.0,
        liquid_bulk_modulus: 2e9,
        permeability: 1e-4,
        permeability_exponent: 0.0,
        gravity: 10.0,
        drag: Drag::default(),
    };
    let fits = NodalTaylor::<f64, 1, 3>::for_basis(&BSpline::<2>);
    let setup = Setup::new(grid, BSpline::<2>, fits, law, phase, particles);
    assert_eq!(Stepper::new(setup).err(), Some(SetupError::SeriesWithFlow));
}
