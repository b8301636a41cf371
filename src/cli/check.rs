//! `materialpoint check`.

use materialpoint::run::{
    MethodSummary, critical_step, mechanism, method_warnings, simulation, simulation_in,
};
use materialpoint::scene::StepSize;
use materialpoint::stepper::{Mechanism, Simulation};
use serde_json::json;

use super::Shared;
use super::failure::Failure;
use super::print::{print, print_json};
use super::run::{load, warn};

/// What a particle carries.
const ONE_PHASE: [&str; 7] = [
    "initial position",
    "position",
    "displacement",
    "velocity",
    "stress",
    "mass",
    "volume",
];

/// The same with a liquid in the pores.
const TWO_PHASES: [&str; 9] = [
    "initial position",
    "position",
    "displacement",
    "velocity of the solid",
    "effective stress",
    "mass of the solid",
    "volume",
    "velocity of the liquid",
    "pore pressure",
];

/// What a check tells of a simulation.
struct Built {
    particles: usize,
    dofs: usize,
    bytes_per_particle: f64,
}

impl Built {
    fn of<const D: usize>(simulation: &dyn Simulation<D>) -> Self {
        Self {
            particles: simulation.particle_count(),
            dofs: simulation.dof_count(),
            bytes_per_particle: simulation.bytes_per_particle(),
        }
    }
}

pub(super) fn check_scene(name: &str, shared: &Shared) -> Result<(), Failure> {
    let scene = load(name, &shared.set)?;
    // One after the other: both need a simulation.
    let limit = critical_step(&scene)?;
    let built = match scene.dimension() {
        1 => Built::of(simulation(&scene)?.as_ref()),
        2 => Built::of(simulation_in::<2>(&scene)?.as_ref()),
        _ => Built::of(simulation_in::<3>(&scene)?.as_ref()),
    };
    let critical = limit.map(|limit| limit.step);
    let method = MethodSummary::of(&scene);
    warn(&method_warnings(&scene));
    let mechanism = mechanism(&scene, limit.map_or(Mechanism::Wave, |limit| limit.mechanism));
    let phases = scene.material.phases.count();
    let unknowns = scene.dimension() * phases;
    let fields = match phases {
        1 => &ONE_PHASE[..],
        _ => &TWO_PHASES,
    };
    let asked = match scene.time.step {
        StepSize::Fixed(step) => step,
        StepSize::Auto { safety } => critical.map_or(f64::NAN, |limit| safety * limit),
    };
    let stable = critical.is_none_or(|limit| asked <= limit);
    if shared.json {
        return print_json(&json!({
            "title": scene.title,
            "method": method,
            "particles": built.particles,
            "dofs": built.dofs,
            "unknowns_per_dof": unknowns,
            "fields_per_particle": fields,
            "bytes_per_particle": built.bytes_per_particle,
            "time_step": asked,
            "critical_time_step": critical,
            "mechanism": mechanism,
            "stable": stable,
        }));
    }
    let mut lines = vec![format!("{}: the scene is valid", scene.title)];
    lines.push(format!(
        "  particles     {}, each with {}",
        built.particles,
        fields.join(", ")
    ));
    if method.subpoints > 1 {
        lines.push(format!(
            "  force         at {} sub-points of each particle",
            method.subpoints
        ));
    }
    lines.push(format!(
        "  DOFs          {}, {unknowns} velocity {} each",
        built.dofs,
        match unknowns {
            1 => "component",
            _ if phases == 1 => "components",
            _ => "components (solid and liquid)",
        }
    ));
    lines.push(format!(
        "  memory        {:.0} bytes per particle while it steps, {:.3} MB in all",
        built.bytes_per_particle,
        built.bytes_per_particle * built.particles as f64 / 1e6
    ));
    match critical {
        Some(limit) => {
            lines.push(format!(
                "  stable step   up to {limit:.4e} s, limited by {mechanism}"
            ));
            let verdict = if stable { "stable" } else { "UNSTABLE" };
            lines.push(format!(
                "  time.step     {asked:.4e} s, {:.2} of that: {verdict}",
                asked / limit
            ));
        }
        None => lines.push("  stable step   any: nothing resists a motion of these particles".to_owned()),
    }
    print(&(lines.join("\n") + "\n"))
}
