//! `bytes_per_particle`, which `check` prints, against what the allocator was asked for.

use allocation_counter::measure;
use materialpoint::grid::{Face, Side};
use materialpoint::mass::VelocityMass;
use materialpoint::method::{Basis, Method, ReconstructionKind};
use materialpoint::phase::Drag;
use materialpoint::stepper::{FaceCondition, Forcing, Simulation};
use materialpoint_command::run::{run, simulation, simulation_in};
use materialpoint_command::scene::Scene;

use crate::two_phase::column::{AT_REST, Column, loaded, table_6};
use crate::two_phase::sealed::SEALED_BOX;

const CELLS: usize = 2000;

fn scene(method: Method, per_cell: usize) -> Scene {
    let text = Scene::builtin("vibrating-bar-large").unwrap();
    let overrides = [
        format!("grid.cells=[{CELLS}]"),
        format!("body.0.particles_per_cell=[{per_cell}]"),
        "time={ step = 1e-7, end = 2e-7 }".to_owned(),
    ];
    Scene::from_toml(text, &overrides).unwrap().with_method(method)
}

/// What was allocated and not freed by `build`, over what the stepper says; then steps, which must add
/// nothing. On one thread: rayon itself may allocate when it wakes others.
fn actual_over_said<const D: usize>(
    build: impl FnOnce() -> Box<dyn Simulation<D>> + Send,
    forcing: &Forcing<f64, D>,
    dt: f64,
) -> f64 {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    pool.install(|| measured(build, forcing, dt))
}

fn measured<const D: usize>(
    build: impl FnOnce() -> Box<dyn Simulation<D>>,
    forcing: &Forcing<f64, D>,
    dt: f64,
) -> f64 {
    let mut built = None;
    let allocated = measure(|| built = Some(build())).bytes_current as f64;
    let mut simulation = built.unwrap();
    let said = simulation.bytes_per_particle() * simulation.particle_count() as f64;
    let stepping = measure(|| simulation.step(dt, forcing).unwrap());
    assert_eq!(stepping.count_total, 0);
    assert_eq!(
        simulation.bytes_per_particle() * simulation.particle_count() as f64,
        said
    );
    allocated / said
}

#[test]
fn a_stepper_takes_what_it_says() {
    for method in Method::ALL {
        for per_cell in [2, 16] {
            let scene = scene(method, per_cell);
            let ratio = actual_over_said(|| simulation(&scene).unwrap(), &Forcing::none(), 1e-7);
            assert!(
                (ratio - 1.0).abs() < 0.01,
                "{method}, {per_cell} per cell: {ratio}"
            );
        }
    }
}

#[test]
fn a_two_phase_stepper_takes_what_it_says() {
    let (soil, law) = table_6(1e-4);
    for method in Method::ALL {
        for mass in [VelocityMass::Consistent, VelocityMass::Lumped] {
            let column = Column {
                cells: CELLS,
                per_cell: 4,
                soil,
                law,
                drag: Drag::Implicit,
                mass,
                surface: true,
            };
            let ratio = actual_over_said(|| column.build(method, |_| AT_REST), &loaded(-1e4), 1e-9);
            assert!((ratio - 1.0).abs() < 0.01, "{method} {mass:?}: {ratio}");
        }
    }
}

/// The pressure on a sealed surface, here that of a box of 40 by 40 cells on all sides but its base, is
/// solved for in room that was there from the start.
#[test]
fn sealed_surfaces_in_the_plane_take_what_is_said() {
    let room = [
        "grid={min=[0, 0], max=[1, 1], cells=[42, 41]}".to_owned(),
        "body=[{min=[0.0238, 0], max=[0.9762, 0.98], particles_per_cell=[2, 2]}]".to_owned(),
        "time={step=1e-6, end=2e-6}".to_owned(),
        "boundary=[{face='y-min', roller=true}]".to_owned(),
    ];
    for basis in [Basis::Linear, Basis::DualDomain, Basis::BSpline { degree: 2 }] {
        for reconstruction in [ReconstructionKind::Shepard, ReconstructionKind::Taylor] {
            let method = Method::new(basis, reconstruction);
            let scene = Scene::from_toml(SEALED_BOX, &room).unwrap().with_method(method);
            let floor = Face {
                axis: 1,
                side: Side::Min,
            };
            let forcing = Forcing::none().with_face(floor, FaceCondition::roller(1));
            let ratio = actual_over_said(|| simulation_in::<2>(&scene).unwrap(), &forcing, 1e-6);
            assert!((ratio - 1.0).abs() < 0.01, "{method}: {ratio}");
        }
    }
}

/// Seven numbers (two positions, displacement, velocity, stress, mass, volume), the number of the cell, and
/// three numbers a DOF (mass, force, momentum): no lists of cells, no matrix, no liquid. Many particles are
/// passed over in spans of 4096, whose sums take two numbers a DOF and little for each span.
#[test]
fn plain_one_phase_elasticity_carries_nothing_that_it_does_not_use() {
    let method = Method::new(Basis::Linear, ReconstructionKind::Shepard);
    let built = simulation(&scene(method, 8)).unwrap();
    let (particles, dofs) = (8 * CELLS, CELLS + 1);
    assert_eq!((built.particle_count(), built.dof_count()), (particles, dofs));
    let bytes = (particles * (7 * 8 + 4) + dofs * 3 * 8) as f64;
    let spans = particles.div_ceil(4096);
    // And 5 kB for the stepper itself.
    let sums = (2 * 8 * (dofs + 10 * spans) + 100 * spans + 5120) as f64;
    let found = built.bytes_per_particle() * particles as f64;
    assert!((bytes..=bytes + sums).contains(&found), "{found} {bytes} {sums}");
}

/// Setting up needs no more than stepping: particles are moved to the stepper, not copied.
#[test]
fn setting_up_needs_no_second_copy() {
    for method in Method::ALL {
        let scene = scene(method, 8);
        let mut built = None;
        let peak = measure(|| built = Some(simulation(&scene).unwrap())).bytes_max as f64;
        let built = built.unwrap();
        let said = built.bytes_per_particle() * built.particle_count() as f64;
        assert!(peak < 1.1 * said, "{method}: {}", peak / said);
    }
}

/// Nor does a whole run until its errors are computed: then the reference joins the particles, when all else
/// is gone.
#[test]
fn a_run_holds_one_copy_of_its_particles() {
    for method in Method::ALL {
        let scene = scene(method, 8);
        let mut outcome = None;
        let peak = measure(|| outcome = Some(run(&scene, None, &mut |_| {}).unwrap())).bytes_max as f64;
        let summary = outcome.unwrap().summary;
        let stepping = summary.bytes_per_particle * summary.particles as f64;
        // Particles, what the law tells of each, the reference's fields, one field of each at a time.
        let reporting = ((7 + 2 + 3 + 2) * 8 * summary.particles) as f64;
        // Fits are asked for a stable step by a sample of at most 4096 of the particles, which is a stepper
        // of its own.
        let sample = match method.reconstruction {
            ReconstructionKind::Shepard => 0.0,
            _ => summary.bytes_per_particle * summary.particles.min(4096) as f64,
        };
        // Where the energy of a step is measured, the velocities before it.
        let measuring = (8 * summary.particles) as f64;
        assert!(
            peak < 1.1 * (stepping + measuring + 2.0 * sample).max(reporting),
            "{method}: {peak} {stepping} {sample} {reporting}"
        );
    }
}
