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
    let field = |name, unit, values, exact: &[f64]| FieldValues {
        name,
        unit,
        values,
        exact: exact.to_vec(),
    };
    let displacement = particles.displacement.iter().map(|u| u[0]).collect();
    let velocity = particles.velocity.iter().map(|v| v[0]).collect();
    let stress = particles.stress.iter().map(|s| s[(0, 0)]).collect();
    if liquid.is_empty() {
        return vec![
            field("displacement", "m", displacement, &exact.displacement),
            field("velocity", "m/s", velocity, &exact.velocity),
            field("stress", "Pa", stress, &exact.stress),
        ];
    }
    let liquid_velocity = liquid.iter().map(|l| l.velocity[0]).collect();
    let pressure = liquid.iter().map(|l| l.pressure).collect();
    vec![
        field("solid_displacement", "m", displacement, &exact.displacement),
        field("solid_velocity", "m/s", velocity, &exact.velocity),
        field("liquid_velocity", "m/s", liquid_velocity, &exact.liquid_velocity),
        field("effective_stress", "Pa", stress, &exact.stress),
        field("pore_pressure", "Pa", pressure, &exact.pore_pressure),
    ]
}
