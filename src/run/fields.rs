//! The fields of a run, by name.

use super::norms::Exact;
use crate::particles::Particles;
use crate::phase::PoreLiquid;

/// One field at the particles, in their order.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldValues {
    /// Name, as in the summary.
    pub name: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// Values.
    pub values: Vec<f64>,
    /// Reference; empty without one.
    pub exact: Vec<f64>,
}

/// Displacement, velocity and stress, and those of the liquid if there is one.
pub(super) fn fields(
    particles: &Particles<f64, 1>,
    liquid: &[PoreLiquid<f64, 1>],
    exact: &Exact,
) -> Vec<FieldValues> {
    let mut all = Vec::new();
    for_each_field(particles, liquid, exact, |field| all.push(field));
    all
}

/// The same one by one, so that no more than one need be in memory.
pub(super) fn for_each_field(
    particles: &Particles<f64, 1>,
    liquid: &[PoreLiquid<f64, 1>],
    exact: &Exact,
    mut f: impl FnMut(FieldValues),
) {
    let mut field = |name, unit, values, exact: &[f64]| {
        f(FieldValues {
            name,
            unit,
            values,
            exact: exact.to_vec(),
        });
    };
    let names = match liquid.is_empty() {
        true => ["displacement", "velocity", "stress"],
        false => ["solid_displacement", "solid_velocity", "effective_stress"],
    };
    let displacement = particles.displacement.iter().map(|u| u[0]).collect();
    field(names[0], "m", displacement, &exact.displacement);
    let velocity = particles.velocity.iter().map(|v| v[0]).collect();
    field(names[1], "m/s", velocity, &exact.velocity);
    if !liquid.is_empty() {
        let velocity = liquid.iter().map(|l| l.velocity[0]).collect();
        field("liquid_velocity", "m/s", velocity, &exact.liquid_velocity);
    }
    let stress = particles.stress.iter().map(|s| s[(0, 0)]).collect();
    field(names[2], "Pa", stress, &exact.stress);
    if !liquid.is_empty() {
        let pressure = liquid.iter().map(|l| l.pressure).collect();
        field("pore_pressure", "Pa", pressure, &exact.pore_pressure);
    }
}
