//! `materialpoint check`.

use materialpoint::stepper::{CriticalStep, Mechanism, Simulation};
use materialpoint_command::run::{
    MethodSummary, critical_step, mechanism, simulation, simulation_in, stable_step, warnings,
};
use materialpoint_command::scene::{Scene, StepSize};
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

/// Most steps of a run, as of a fixed step: years of computing.
const MOST_STEPS: f64 = 1e12;

/// What a check tells of the time step.
struct Steps {
    /// Largest stable step, if anything resists a motion.
    limit: Option<CriticalStep<f64>>,
    /// How it was found.
    by: By,
    /// What the scene takes (s).
    asked: f64,
    stable: bool,
    /// How many.
    count: f64,
}

/// How a stable step is found.
#[derive(Clone, Copy)]
enum By {
    /// Proved, from two passes over the particles.
    Bound,
    /// Power iteration on a sample of the particles.
    Sample,
    /// Power iteration on all.
    Iteration,
}

impl By {
    /// In JSON.
    fn name(self) -> &'static str {
        match self {
            Self::Bound => "bound",
            Self::Sample => "sample",
            Self::Iteration => "iteration",
        }
    }

    /// For people.
    fn words(self) -> &'static str {
        match self {
            Self::Bound => "by a bound (--sharp iterates)",
            Self::Sample => "by iteration on a sample of the particles (--sharp takes all)",
            Self::Iteration => "by iteration on all particles",
        }
    }
}

impl Steps {
    fn of(scene: &Scene, sharp: bool) -> Result<Self, Failure> {
        let bound = stable_step(scene)?;
        let asked = match scene.time.step {
            StepSize::Fixed(step) => step,
            StepSize::Auto { .. } => bound.map_or(f64::NAN, |bound| scene.safety() * bound.limit.step),
        };
        // Beyond the bound only the iteration can tell.
        let sharp = sharp || bound.is_some_and(|bound| asked > bound.limit.step);
        let (limit, by) = match bound {
            _ if sharp => (critical_step(scene)?, By::Iteration),
            Some(bound) if !bound.proved => (Some(bound.limit), By::Sample),
            _ => (bound.map(|bound| bound.limit), By::Bound),
        };
        Ok(Self {
            limit,
            by,
            asked,
            stable: limit.is_none_or(|limit| asked <= limit.step),
            count: (scene.time.end / asked * (1.0 - 1e-9)).ceil().max(1.0),
        })
    }

    /// Why this scene cannot be run.
    fn fault(&self, mechanism: &str) -> Option<String> {
        let Self {
            limit, asked, count, ..
        } = self;
        match limit {
            None if asked.is_nan() => Some(
                "time.step = \"auto\": nothing resists a motion of these particles, so no step is critical; give a number".to_owned(),
            ),
            Some(limit) if !self.stable => Some(format!(
                "time.step = {asked:.3e} s is above the largest stable step, {:.3e} s, limited by {mechanism}; take a smaller one \
                 or \"auto\"",
                limit.step
            )),
            _ if *count > MOST_STEPS => Some(format!(
                "time.end takes {count:.1e} steps of {asked:.3e} s; expected at most {MOST_STEPS:e}, so an earlier end, larger \
                 cells or a softer material"
            )),
            _ => None,
        }
    }
}

/// Prints what the check found, and fails if the scene cannot be run to its end.
pub(super) fn check_scene(name: &str, sharp: bool, shared: &Shared) -> Result<(), Failure> {
    let scene = load(name, &shared.set)?;
    // One after the other: both need a simulation.
    let steps = Steps::of(&scene, sharp)?;
    let limit = steps.limit;
    let built = match scene.dimension() {
        1 => Built::of(simulation(&scene)?.as_ref()),
        2 => Built::of(simulation_in::<2>(&scene)?.as_ref()),
        _ => Built::of(simulation_in::<3>(&scene)?.as_ref()),
    };
    let warnings = warnings(&scene)?;
    warn(&warnings);
    let critical = limit.map(|limit| limit.step);
    let method = MethodSummary::of(&scene);
    let mechanism = mechanism(&scene, limit.map_or(Mechanism::Wave, |limit| limit.mechanism));
    let phases = scene.material.phases.count();
    let unknowns = scene.dimension() * phases;
    let fields = match phases {
        1 => &ONE_PHASE[..],
        _ => &TWO_PHASES,
    };
    let (asked, stable, count) = (steps.asked, steps.stable, steps.count);
    let verdict = steps
        .fault(&mechanism)
        .map_or(Ok(()), |fault| Err(Failure::Input(fault)));
    if shared.json {
        print_json(&json!({
            "title": scene.title,
            "method": method,
            "particles": built.particles,
            "dofs": built.dofs,
            "unknowns_per_dof": unknowns,
            "fields_per_particle": fields,
            "bytes_per_particle": built.bytes_per_particle,
            "time_step": asked,
            "steps": count,
            "critical_time_step": critical,
            "critical_by": steps.by.name(),
            "mechanism": mechanism,
            "stable": stable,
            "warnings": warnings,
        }))?;
        return verdict;
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
            let by = steps.by.words();
            lines.push(format!(
                "  stable step   up to {limit:.4e} s at the start, {by}, limited by {mechanism}"
            ));
            let verdict = if stable { "stable" } else { "UNSTABLE" };
            let renewed = match scene.time.step {
                StepSize::Auto { .. } => "; renewed as the run goes",
                StepSize::Fixed(_) => "",
            };
            lines.push(format!(
                "  time.step     {asked:.4e} s, {:.2} of that: {verdict}{renewed}",
                asked / limit
            ));
            lines.push(format!(
                "  steps         {} to {} s",
                in_digits(count),
                scene.time.end
            ));
        }
        None => lines.push("  stable step   any: nothing resists a motion of these particles".to_owned()),
    }
    print(&(lines.join("\n") + "\n"))?;
    verdict
}

/// A whole number, short where it is long.
fn in_digits(count: f64) -> String {
    match count < 1e7 {
        true => format!("{count:.0}"),
        false => format!("{count:.2e}"),
    }
}
