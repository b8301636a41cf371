//! Nothing is allocated by a step, also while particles cross cells; what a stepper says it takes is what it
//! takes.

mod memory;
mod nodal;

use materialpoint::grid::{Face, Grid, Side};
use materialpoint::law::{Hill, Moduli};
use materialpoint::mass::VelocityMass;
use materialpoint::method::{Method, ReconstructionKind};
use materialpoint::particles::{Particles, lattice};
use materialpoint::phase::Drag;
use materialpoint::stepper::{FaceCondition, Forcing, Simulation};
use materialpoint_command::run::simulation_in;
use materialpoint_command::scene::Scene;
use nalgebra::vector;

use crate::compiled::{self, parts};
use crate::two_phase::column::{AT_REST, Column, loaded, table_6};

fn large_bar(method: Method, mass: VelocityMass) -> Box<dyn Simulation<1>> {
    let grid = Grid::new(vector![0.0], vector![1.0], [20]).unwrap();
    let points = lattice(&grid, grid.min(), grid.max(), [8]);
    let mut particles = Particles::at_rest(&points, 2e3);
    for (v, x) in particles.velocity.iter_mut().zip(&particles.position) {
        v[0] = 0.8 * (std::f64::consts::PI * x[0]).sin();
    }
    let law = Hill {
        moduli: Moduli::uniaxial(4e4).unwrap(),
    };
    compiled::simulation(method, mass, parts(grid, law, particles))
}

#[test]
fn no_two_phase_step_allocates() {
    let (soil, law) = table_6(1e-4);
    for method in Method::ALL.into_iter().chain([Method::sub_points(4)]) {
        for mass in [
            VelocityMass::Consistent,
            VelocityMass::Constrained,
            VelocityMass::Lumped,
        ] {
            let column = Column {
                cells: 20,
                per_cell: 8,
                soil,
                law,
                drag: Drag::Implicit,
                mass,
                surface: true,
            };
            let mut simulation = column.build(method, |_| AT_REST);
            let steps = allocation_counter::measure(|| {
                for _ in 0..100 {
                    simulation.step(1e-6, &loaded(-1e4)).unwrap();
                }
            });
            assert_eq!(steps.count_total, 0, "{method} {mass:?}");
        }
    }
}

#[test]
fn no_step_allocates() {
    let ends = [Side::Min, Side::Max].map(|side| Face { axis: 0, side });
    let forcing = ends
        .into_iter()
        .fold(Forcing::none(), |f, end| f.with_face(end, FaceCondition::fixed()));
    for method in Method::ALL.into_iter().chain([Method::sub_points(4)]) {
        for mass in [
            VelocityMass::Consistent,
            VelocityMass::Constrained,
            VelocityMass::Lumped,
        ] {
            let mut simulation = large_bar(method, mass);
            let steps = allocation_counter::measure(|| {
                for _ in 0..1000 {
                    simulation.step(1e-4, &forcing).unwrap();
                }
            });
            assert!(simulation.diagnostics().grid_crossings > 100, "{method}");
            assert_eq!(steps.count_total, 0, "{method} {mass:?}");
            // The counter does count.
            let copy = allocation_counter::measure(|| drop(simulation.particles()));
            assert!(copy.count_total >= 7);
        }
    }
}

/// Nor where cells borrow virtual points.
#[test]
fn no_step_with_virtual_points_allocates() {
    let set = ["method.virtual_points=true", "body.0.particles_per_cell=[3]"].map(String::from);
    let scene = Scene::from_toml(Scene::builtin("vibrating-bar-large").unwrap(), &set).unwrap();
    let ends = [Side::Min, Side::Max].map(|side| Face { axis: 0, side });
    let forcing = ends
        .into_iter()
        .fold(Forcing::none(), |f, end| f.with_face(end, FaceCondition::fixed()));
    let mut simulation = simulation_in::<1>(&scene).unwrap();
    let steps = allocation_counter::measure(|| {
        for _ in 0..1000 {
            simulation.step(1e-4, &forcing).unwrap();
        }
    });
    assert!(simulation.diagnostics().virtual_cells > 0);
    assert_eq!(steps.count_total, 0);
}

/// In the plane windows and the particles' order change too; 9216 particles make several spans. On one
/// thread: a pool of several has a queue of its own, which takes memory now and then.
#[test]
fn no_step_in_the_plane_allocates() {
    let one_thread = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    for (cells, steps) in [(8, 200), (32, 40)] {
        for method in Method::all_in(2, 1) {
            // Its matrix makes many cells slow.
            if cells == 8 || method.reconstruction != ReconstructionKind::RelaxedTaylor {
                let count = one_thread.install(|| allocations_in_the_plane(method, cells, steps));
                assert_eq!(count, 0, "{method} {cells}");
            }
        }
    }
}

fn allocations_in_the_plane(method: Method, cells: usize, steps: usize) -> u64 {
    let scene = Scene::from_toml(Scene::builtin("manufactured").unwrap(), &[]).unwrap();
    let mut scene = scene.with_cells(cells).with_method(method);
    if method.reconstruction != ReconstructionKind::RelaxedTaylor {
        scene.method.velocity_mass = VelocityMass::Lumped;
    }
    let forcing = Face::all::<2>().fold(Forcing::none(), |forcing, face| {
        forcing.with_face(face, FaceCondition::roller(face.axis))
    });
    let mut simulation = simulation_in::<2>(&scene).unwrap();
    let counted = allocation_counter::measure(|| {
        for _ in 0..steps {
            simulation.step(2e-5, &forcing).unwrap();
        }
    });
    assert!(simulation.diagnostics().grid_crossings > 50, "{method} {cells}");
    counted.count_total
}
