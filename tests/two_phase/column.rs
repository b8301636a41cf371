//! A saturated column through the API: what the gates of this folder step.

use materialpoint::grid::{Face, Grid, Side};
use materialpoint::law::{ConstitutiveLaw, LinearElastic, Moduli};
use materialpoint::mass::VelocityMass;
use materialpoint::method::Method;
use materialpoint::particles::{Particles, lattice};
use materialpoint::phase::{Drag, PoreLiquid, TwoPhase};
use materialpoint::record::Record;
use materialpoint::reference::two_phase::{Soil, TwoPhaseReference, TwoPhaseState};
use materialpoint::stepper::{FaceCondition, Forcing, PoreCondition, Simulation, SurfacePoint};
use materialpoint_steppers::Parts;
use nalgebra::vector;

use crate::compiled::{self, parts};

pub const BASE: Face = Face {
    axis: 0,
    side: Side::Min,
};
pub const TOP: Face = Face {
    axis: 0,
    side: Side::Max,
};

/// A column of height 1 m on `cells` cells.
#[derive(Clone, Copy, Debug)]
pub struct Column<L> {
    pub cells: usize,
    pub per_cell: usize,
    pub soil: Soil,
    pub law: L,
    pub drag: Drag,
    pub mass: VelocityMass,
    /// Whether the top is a surface (loaded, drained, sealed) or a wall.
    pub surface: bool,
}

impl<L: ConstitutiveLaw<f64, 1, State: Record<f64>> + Clone + 'static> Column<L> {
    pub fn phase(&self) -> TwoPhase<f64> {
        TwoPhase {
            porosity: self.soil.porosity,
            solid_density: self.soil.solid_density,
            liquid_density: self.soil.liquid_density,
            liquid_bulk_modulus: self.soil.liquid_bulk_modulus,
            permeability: self.soil.permeability,
            permeability_exponent: self.soil.permeability_exponent,
            gravity: self.soil.gravity,
            drag: self.drag,
        }
    }

    /// The column in `method`, with the initial state of each particle.
    pub fn build(&self, method: Method, initial: impl Fn(f64) -> TwoPhaseState) -> Box<dyn Simulation<1>> {
        self.build_with_base(method, false, initial)
    }

    /// The same with a base that is a surface too, where liquid may pass.
    pub fn build_with_base(
        &self,
        method: Method,
        base_is_surface: bool,
        initial: impl Fn(f64) -> TwoPhaseState,
    ) -> Box<dyn Simulation<1>> {
        let phase = self.phase();
        let grid = Grid::new(vector![0.0], vector![1.0], [self.cells]).unwrap();
        let points = lattice(&grid, grid.min(), grid.max(), [self.per_cell]);
        let mut particles: Particles<f64, 1> = Particles::at_rest(&points, phase.dry_density());
        let mut pores = vec![PoreLiquid::default(); particles.len()];
        for p in 0..particles.len() {
            let state = initial(particles.position[p][0]);
            particles.displacement[p][0] = state.solid_displacement;
            particles.velocity[p][0] = state.solid_velocity;
            particles.stress[p][(0, 0)] = state.effective_stress;
            pores[p].velocity[0] = state.liquid_velocity;
            pores[p].pressure = state.pore_pressure;
        }
        let ends = [
            (base_is_surface, 0, BASE),
            (self.surface, particles.len() - 1, TOP),
        ];
        let there = ends.into_iter().filter(|end| end.0);
        let surface = there
            .map(|(_, particle, face)| SurfacePoint {
                particle,
                face,
                area: 1.0,
                reach: 0.5,
                loaded: true,
            })
            .collect();
        let parts = Parts {
            liquid: Some(phase),
            pores,
            surface,
            ..parts(grid, self.law.clone(), particles)
        };
        compiled::simulation(method, self.mass, parts)
    }
}

/// Base fixed and impermeable, top loaded and drained.
pub fn loaded(load: f64) -> Forcing<f64, 1> {
    Forcing::none()
        .with_face(BASE, FaceCondition::fixed())
        .with_face(TOP, FaceCondition::Traction(vector![load]))
        .with_pores(TOP, PoreCondition::Pressure(0.0))
}

/// Base fixed and impermeable, top free and drained.
pub fn drained() -> Forcing<f64, 1> {
    loaded(0.0)
}

/// Report 18-2, Table 6: H = 1 m, E = 1e7 Pa, K_w = 3e8 Pa, n = 0.4.
pub fn table_6(permeability: f64) -> (Soil, LinearElastic<f64>) {
    let soil = Soil {
        porosity: 0.4,
        solid_density: 2.6e3,
        liquid_density: 1e3,
        liquid_bulk_modulus: 3e8,
        permeability,
        permeability_exponent: 0.0,
        gravity: 9.81,
    };
    let moduli = Moduli::uniaxial(1e7).unwrap();
    (soil, LinearElastic { moduli })
}

/// At rest, nothing strained.
pub const AT_REST: TwoPhaseState = TwoPhaseState {
    solid_displacement: 0.0,
    solid_velocity: 0.0,
    liquid_velocity: 0.0,
    effective_stress: 0.0,
    pore_pressure: 0.0,
};

/// Fields of the particles in the order of [`TwoPhaseState`]'s fields.
pub fn fields(simulation: &dyn Simulation<1>) -> Vec<TwoPhaseState> {
    let particles = simulation.particles();
    let liquid = simulation.liquid();
    (0..particles.len())
        .map(|p| TwoPhaseState {
            solid_displacement: particles.displacement[p][0],
            solid_velocity: particles.velocity[p][0],
            liquid_velocity: liquid[p].velocity[0],
            effective_stress: particles.stress[p][(0, 0)],
            pore_pressure: liquid[p].pressure,
        })
        .collect()
}

/// Picks a field.
pub type Field = fn(&TwoPhaseState) -> f64;

pub const FIELDS: [(&str, Field); 5] = [
    ("u_s", |s| s.solid_displacement),
    ("v_s", |s| s.solid_velocity),
    ("v_w", |s| s.liquid_velocity),
    ("sigma'", |s| s.effective_stress),
    ("p", |s| s.pore_pressure),
];

/// RMS and relative L2 errors of the five fields: displacement and stresses at `end`, velocities at
/// `velocity_time`.
pub fn errors(
    simulation: &dyn Simulation<1>,
    reference: &mut dyn TwoPhaseReference,
    end: f64,
    velocity_time: f64,
) -> [(f64, f64); 5] {
    let x0: Vec<f64> = simulation
        .particles()
        .initial_position
        .iter()
        .map(|x| x[0])
        .collect();
    let found = fields(simulation);
    let mut at = |time: f64| -> Vec<TwoPhaseState> {
        reference.advance(time).unwrap();
        x0.iter().map(|&x| reference.at(x)).collect()
    };
    let (late, early) = (at(end), at(velocity_time));
    FIELDS.map(|(name, field)| {
        let exact = if name.starts_with('v') { &early } else { &late };
        let (mut error, mut square) = (0.0, 0.0);
        for (f, e) in found.iter().zip(exact) {
            error += (field(f) - field(e)).powi(2);
            square += field(e).powi(2);
        }
        ((error / x0.len() as f64).sqrt(), (error / square).sqrt())
    })
}
