//! Defaults, and the scenes that are compiled in.

use super::*;
use materialpoint::grid::{Face, Side};
use materialpoint::mass::VelocityMass;
use materialpoint::phase::Drag;

/// The least that a scene may say.
const LEAST: &str = r#"
    title = "Least"
    [grid]
    min = [0]
    max = [2]
    cells = [4]
    [time]
    step = "auto"
    end = 1
    [method]
    basis = "bspline"
    reconstruction = "shepard"
    [material]
    strain = "large"
    law.neo-hookean = { youngs_modulus = 100 }
    density = 10
    [[body]]
    min = [0]
    max = [1]
    particles_per_cell = [2]
"#;

fn read(overrides: &[&str]) -> Result<Scene, SceneError> {
    let overrides: Vec<_> = overrides.iter().map(ToString::to_string).collect();
    Scene::from_toml(LEAST, &overrides)
}

#[test]
fn what_is_not_said_has_its_default() {
    let scene = read(&[]).unwrap();
    assert_eq!(scene.dimension(), 1);
    assert_eq!(scene.time.step, StepSize::Auto { safety: None });
    assert_eq!(scene.method.basis, Basis::BSpline { degree: 2 });
    assert_eq!(scene.method.velocity_mass, VelocityMass::Lumped);
    assert_eq!(scene.method.scalar, ScalarKind::F64);
    assert_eq!(
        scene.material.law,
        Law::NeoHookean {
            youngs_modulus: 100.0,
            poissons_ratio: 0.0,
        }
    );
    let body = &scene.bodies[0];
    assert!(body.velocity.is_none() && body.stress.is_none());
    assert_eq!((body.jitter, body.seed), (0.0, 0));
    assert!(scene.boundaries.is_empty() && scene.body_force.is_none() && scene.reference.is_none());
    assert_eq!(scene.output.particles, ParticleOutput::Csv);
    assert_eq!(scene.output.every, 0);
}

#[test]
fn taylor_and_spline_are_consistent_unless_told() {
    for name in ["taylor", "spline"] {
        let reconstruction = format!("method.reconstruction={name}");
        let scene = read(&[&reconstruction]).unwrap();
        assert_eq!(scene.method.velocity_mass, VelocityMass::Consistent);
        let scene = read(&[&reconstruction, "method.velocity_mass=lumped"]).unwrap();
        assert_eq!(scene.method.velocity_mass, VelocityMass::Lumped);
    }
}

#[test]
fn every_velocity_mass_can_be_named() {
    for mass in [
        VelocityMass::Consistent,
        VelocityMass::Constrained,
        VelocityMass::Lumped,
    ] {
        let told = format!("method.velocity_mass={}", mass.name());
        let scene = read(&["method.reconstruction=taylor", &told]).unwrap();
        assert_eq!(scene.method.velocity_mass, mass);
        let plain = read(&["method.reconstruction=shepard", &told]);
        assert_eq!(plain.is_ok(), mass == VelocityMass::Lumped, "{told}");
    }
}

#[test]
fn method_and_cells_can_be_changed_afterwards() {
    let with = |scene: &Scene, reconstruction| {
        let method = method::Method::new(Basis::Linear, reconstruction);
        scene.with_method(method).method.velocity_mass
    };
    let plain = read(&[]).unwrap();
    assert_eq!(with(&plain, ReconstructionKind::Taylor), VelocityMass::Consistent);
    let told = read(&["method.reconstruction=taylor", "method.velocity_mass=lumped"]).unwrap();
    assert_eq!(with(&told, ReconstructionKind::Spline), VelocityMass::Lumped);
    assert_eq!(with(&told, ReconstructionKind::Shepard), VelocityMass::Lumped);
    assert_eq!(told.with_cells(80).grid.cells, [80]);
    let sub_points = plain.with_method(method::Method::sub_points(4));
    assert_eq!(sub_points.method.subpoints, 4);
    let back = sub_points.with_method(method::Method::new(Basis::Linear, ReconstructionKind::Taylor));
    assert_eq!(back.method.subpoints, 1);
    let lent = read(&["method.reconstruction=taylor", "method.virtual_points=true"]).unwrap();
    assert!(lent.method.virtual_points);
    let plain = method::Method::new(Basis::Linear, ReconstructionKind::Shepard);
    assert!(!lent.with_method(plain).method.virtual_points);
}

#[test]
fn every_basis_and_law_can_be_named() {
    let basis = |overrides: &[&str]| read(overrides).unwrap().method.basis;
    assert_eq!(basis(&["method.basis=linear"]), Basis::Linear);
    assert_eq!(
        basis(&["method.basis=dual-domain", "method.subpoints=1"]),
        Basis::DualDomain
    );
    assert_eq!(basis(&["method.degree=3"]), Basis::BSpline { degree: 3 });
    let sub_points = |n: u8| {
        let told = format!("method.subpoints={n}");
        read(&["method.basis=dual-domain", &told])
            .unwrap()
            .method
            .method()
    };
    for n in [1, 2, 128] {
        assert_eq!(sub_points(n), method::Method::sub_points(n));
    }
    assert_eq!(sub_points(4).to_string(), "dual-domain+shepard4");
    let law = |overrides: &[&str]| read(overrides).unwrap().material.law;
    let linear = "material.law={linear-elastic={youngs_modulus=5}}";
    let youngs_modulus = 5.0;
    assert_eq!(
        law(&[linear]),
        Law::Hill {
            youngs_modulus,
            poissons_ratio: 0.0
        }
    );
    assert_eq!(
        law(&[linear, "material.strain=small", "material.phases=1"]),
        Law::LinearElastic {
            youngs_modulus,
            poissons_ratio: 0.0
        }
    );
}

#[test]
fn bodies_boundaries_and_loads_are_read() {
    let scene = read(&[
        "body.0.velocity=['2*x']",
        "body.0.stress='-x'",
        "material.law={linear-elastic={youngs_modulus=5}}",
        "body.0.jitter=0.4",
        "body.0.seed=7",
        "body.0.initialise=exact",
        "boundary=[{face='x-max', traction=['-3*t']}, {face='x-min', velocity=['sin(t)']}]",
        "load.body_force=['-9.81']",
        "output={particles='none', every=5, checkpoint_every=0}",
        "time.safety=1",
    ])
    .unwrap();
    let body = &scene.bodies[0];
    assert_eq!(body.velocity.as_ref().unwrap()[0].eval_at(&[1.5]), Ok(3.0));
    assert_eq!(
        body.stress.as_ref().unwrap().components[0].1.eval_at(&[1.5]),
        Ok(-1.5)
    );
    assert_eq!((body.jitter, body.seed), (0.4, 7));
    let top = Face {
        axis: 0,
        side: Side::Max,
    };
    assert_eq!(scene.boundaries[0].face, top);
    let BoundaryKind::Traction(traction) = &scene.boundaries[0].kind else {
        panic!("no traction");
    };
    assert_eq!(traction[0].eval_time(2.0), Ok(-6.0));
    assert!(matches!(scene.boundaries[1].kind, BoundaryKind::Velocity(_)));
    assert_eq!(scene.body_force.unwrap()[0].eval_time(0.0), Ok(-9.81));
    assert_eq!(
        (scene.output.particles, scene.output.every),
        (ParticleOutput::None, 5)
    );
    assert_eq!(scene.time.step, StepSize::Auto { safety: Some(1.0) });
}

/// Numbers of the journal, section 6.
#[test]
fn compiled_in_scenes_are_the_benchmarks() {
    let scene = |name| Scene::from_toml(Scene::builtin(name).unwrap(), &[]).unwrap();
    let small = scene("vibrating-bar-small");
    assert_eq!(
        small.material.law,
        Law::LinearElastic {
            youngs_modulus: 7e6,
            poissons_ratio: 0.0
        }
    );
    assert_eq!(
        (small.grid.cells[0], small.bodies[0].particles_per_cell[0]),
        (40, 12)
    );
    assert_eq!((small.time.step, small.time.end), (StepSize::Fixed(1e-7), 1.9e-6));
    assert_eq!(
        small.reference,
        Some(ReferenceSpec::VibratingBar { velocity: 0.28 })
    );
    let large = scene("vibrating-bar-large");
    assert_eq!(
        large.material.law,
        Law::Hill {
            youngs_modulus: 4e4,
            poissons_ratio: 0.0
        }
    );
    assert_eq!(
        (large.grid.cells[0], large.bodies[0].particles_per_cell[0]),
        (20, 8)
    );
    assert_eq!((large.time.step, large.time.end), (StepSize::Fixed(1e-4), 0.1));
    let column = scene("column-compaction");
    assert_eq!(column.material.phases, Phases::One { density: 1.0 });
    assert_eq!(
        (column.grid.cells[0], column.bodies[0].particles_per_cell[0]),
        (50, 20)
    );
    assert_eq!(column.body_force.unwrap()[0].eval_time(0.5), Ok(-200.0));
    assert!(Scene::builtin("no such scene").is_none());
    let soil = scene("consolidation-small");
    let Phases::Two(phases) = soil.material.phases else {
        panic!("one phase");
    };
    assert_eq!(
        (phases.porosity, phases.permeability, phases.gravity),
        (0.4, 1e-5, 9.81)
    );
    assert_eq!((phases.drag, soil.time.end), (Drag::Implicit, 2e-9));
    assert_eq!(soil.bodies[0].initialise, Initialise::Dofs);
    assert_eq!(
        soil.reference,
        Some(ReferenceSpec::Consolidation {
            load: -1e4,
            start: 5.0
        })
    );
    for name in Scene::builtin_names() {
        let scene = scene(name);
        // In the plane each scene has the method that serves it.
        if scene.dimension() == 1 {
            assert_eq!(scene.method.method().to_string(), "bspline+taylor", "{name}");
        }
    }
}

#[test]
fn a_scene_is_read_from_a_file() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/scenes/column-compaction.toml");
    let scene = Scene::from_file(&path, &["reference.column-compaction.against=static".into()]).unwrap();
    assert!(matches!(
        scene.reference,
        Some(ReferenceSpec::ColumnCompaction {
            against: Against::Static,
            ..
        })
    ));
    let message = Scene::from_file(Path::new("/no/such.toml"), &[])
        .unwrap_err()
        .to_string();
    assert!(
        message.starts_with("cannot read the scene /no/such.toml: "),
        "{message}"
    );
}
