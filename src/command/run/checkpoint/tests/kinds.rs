//! Every law with every method, in every dimension, both scalars, one phase and two.

use super::{BAR, assert_same, resume, scene, with_checkpoint};
use crate::run::{InSpace, run_in};
use crate::scene::Scene;
use materialpoint::method::{Method, ReconstructionKind};

/// A block that swirls through cells and slides over a rough floor, and ends before published TLS loses its
/// free sides; what changes with the dimension is set.
const BLOCK: &str = r#"
    title = "Block"
    [grid]
    min = [0, 0]
    max = [6, 6]
    cells = [6, 6]
    [time]
    step = 0.02
    end = 0.3
    [method]
    basis = "linear"
    reconstruction = "shepard"
    [material]
    strain = "large"
    law.linear-elastic = { youngs_modulus = 30, poissons_ratio = 0.3 }
    density = 1
    [[body]]
    min = [1, 0]
    max = [4, 3]
    particles_per_cell = [2, 2]
    jitter = 0.3
    velocity = ["1.5 + 0.2*sin(y)", "0.1*y*sin(x)"]
    [[boundary]]
    face = "y-min"
    friction = 0.2
    [output]
    particles = "none"
"#;

const IN_SPACE: [&str; 3] = [
    "time={step=0.02, end=0.32}",
    "grid={min=[0, 0, 0], max=[6, 6, 5], cells=[6, 6, 5]}",
    "body=[{min=[1, 0, 1], max=[4, 2, 3], particles_per_cell=[2, 2, 2], velocity=['1.5', '0.02*y', '0.05*y']}]",
];

const LAWS: [&str; 8] = [
    "material={strain='small', density=1, law={linear-elastic={youngs_modulus=30, poissons_ratio=0.3}}}",
    "material.law={linear-elastic={youngs_modulus=30, poissons_ratio=0.3}}",
    "material.law={neo-hookean={youngs_modulus=30, poissons_ratio=0.3}}",
    "material.law={st-venant-kirchhoff={youngs_modulus=30, poissons_ratio=0.3}}",
    "material.law={logarithmic={youngs_modulus=30, poissons_ratio=0.3}}",
    "material.law={von-mises={youngs_modulus=30, poissons_ratio=0.3, yield_stress=0.3, hardening=0.1}}",
    "material.law={drucker-prager={youngs_modulus=30, poissons_ratio=0.3, friction_angle=30, cohesion=0.2}}",
    "material.law={newtonian-fluid={bulk_modulus=30, gamma=7, viscosity=0.01}}",
];

/// A bar between walls in whose middle particles fly through two cells; set on the smaller one.
const SWING: [&str; 4] = [
    "grid={min=[0], max=[6], cells=[24]}",
    "body=[{min=[0], max=[6], particles_per_cell=[4], velocity=['sin(pi*x/6)']}]",
    "boundary=[{face='x-min', fixed=true}, {face='x-max', fixed=true}]",
    "time={step=0.02, end=0.48}",
];

/// Interrupts the run after 13 steps of 24, in the plane of 15, in space of 16.
fn check<const D: usize>(name: &str, text: &str, method: Method, set: &[&str])
where
    Scene: InSpace<D>,
{
    let with = |key: &str| scene(text, &[set, &[key]].concat()).with_method(method);
    let (_scratch, path, whole) = with_checkpoint::<D>(name, &with("output.checkpoint_every=13"));
    let what = format!("{method}, {set:?}");
    assert!(
        whole.summary.grid_crossings > 0 || whole.summary.steps == 20,
        "{what}"
    );
    let resumed = resume::<D>(&with("output.checkpoint_every=0"), &path).unwrap();
    assert_same(&resumed, &whole, &what);
}

#[test]
fn every_law_and_method_of_the_plane_is_resumed() {
    for method in Method::all_in(2, 1) {
        for law in LAWS {
            check::<2>("resume-plane", BLOCK, method, &[law]);
        }
    }
}

#[test]
fn every_method_of_space_is_resumed() {
    for method in Method::all_in(3, 1) {
        // A wall that rubs asks fits in space for dozens of mappings a step: minutes. It carries nothing from
        // step to step.
        let floor = match method.reconstruction {
            ReconstructionKind::Shepard => "boundary=[{face='y-min', friction=0.2}]",
            _ => "boundary=[{face='y-min', roller=true}]",
        };
        for law in [LAWS[1], LAWS[6]] {
            check::<3>(
                "resume-space",
                BLOCK,
                method,
                &[&IN_SPACE[..], &[law, floor]].concat(),
            );
        }
    }
}

#[test]
fn every_method_law_and_scalar_of_the_line_is_resumed() {
    let laws = ["linear-elastic", "logarithmic", "neo-hookean"];
    for method in Method::ALL.into_iter().chain([Method::sub_points(4)]) {
        for (law, scalar) in laws.into_iter().flat_map(|law| [(law, "f64"), (law, "f32")]) {
            let law = format!("material.law={{{law}={{youngs_modulus=4}}}}");
            let scalar = format!("method.scalar={scalar}");
            let set = [&SWING[..], &[&law, &scalar]].concat();
            check::<1>("resume-line", BAR, method, &set);
        }
    }
}

#[test]
fn two_phases_are_resumed() {
    for name in ["consolidation-small", "consolidation-large"] {
        for method in Method::all_in(1, 2) {
            for drag in ["implicit", "explicit"] {
                let drag = format!("material.drag={drag}");
                let end = match name {
                    "consolidation-small" => "time={step=1e-7, end=2e-6}",
                    _ => "time={step=1e-6, end=2e-5}",
                };
                let set = [&drag, end, "output.particles=none"];
                check::<1>("resume-soil", Scene::builtin(name).unwrap(), method, &set);
            }
        }
    }
}

/// Water that swings and stiffens: speeds are looked at every 16 steps and the layout every 64, so that
/// checkpoints at an odd number, at a multiple of 16 and at one of 64 are written between two looks and right
/// before one.
#[test]
fn a_run_that_renews_its_step_is_resumed() {
    let text = r#"
        title = "Tube"
        grid = { min = [0, 0], max = [1, 0.1], cells = [20, 2] }
        time = { step = "auto", safety = 0.2, end = 0.12 }
        method = { basis = "linear", reconstruction = "shepard" }
        output = { particles = "none" }
        [material]
        strain = "large"
        law.newtonian-fluid = { bulk_modulus = 1e5, gamma = 7.0, viscosity = 0.0 }
        density = 1000
        [[body]]
        min = [0, 0]
        max = [1, 0.1]
        particles_per_cell = [2, 2]
        velocity = ["-2*sin(2*pi*x)", "0"]
        [[boundary]]
        face = "x-min"
        roller = true
        [[boundary]]
        face = "x-max"
        roller = true
        [[boundary]]
        face = "y-min"
        roller = true
        [[boundary]]
        face = "y-max"
        roller = true
    "#;
    // One checkpoint a run, with looks to come.
    let alone = run_in::<2>(&scene(text, &[]), None, &mut |_| {}).unwrap();
    let late = alone.summary.steps * 6 / 10;
    for every in [late | 1, late / 16 * 16, late / 64 * 64] {
        let scene = scene(text, &[&format!("output.checkpoint_every={every}")]);
        let (_scratch, path, whole) = with_checkpoint::<2>(&format!("resume-renewed-{every}"), &scene);
        assert!(whole.summary.time_step_range.is_some() && every >= 64);
        assert_same(&resume::<2>(&scene, &path).unwrap(), &whole, "renewed");
        // Neither the files nor the checkpoints of a run change its steps.
        assert_same(&alone, &whole, "alone");
    }
}

/// The body force of the driver is set anew in every step; the step is found. The first kick may be half a
/// one.
#[test]
fn a_driven_run_with_a_step_of_its_own_is_resumed() {
    for half_kick in ["false", "true"] {
        let half_kick = format!("time.half_kick={half_kick}");
        let set = [
            "time={step='auto', end=3e-3}",
            "output={particles='none', checkpoint_every=7}",
            &half_kick,
        ];
        let scene = scene(Scene::builtin("manufactured").unwrap(), &set);
        let (_scratch, path, whole) = with_checkpoint::<2>("resume-driven", &scene);
        // Not at the end, where nothing would be left to do.
        assert_ne!(whole.summary.steps % 7, 0);
        assert_same(&resume::<2>(&scene, &path).unwrap(), &whole, &half_kick);
    }
}
