//! The fields of a run, by name.

use nalgebra::{SMatrix, SVector};

use super::norms::Exact;
use materialpoint::particles::Particles;
use materialpoint::phase::PoreLiquid;

/// One field at the particles, in their order.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldValues {
    /// Name, as in the summary.
    pub name: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// Components of each value: 1 for a scalar, `D` for a vector, `D D` for a stress (column by column).
    pub components: usize,
    /// Values, the components of each particle together.
    pub values: Vec<f64>,
    /// Reference, likewise; empty without one.
    pub exact: Vec<f64>,
}

/// Displacement, velocity and stress, and those of the liquid if there is one.
pub(super) fn fields<const D: usize>(
    particles: &Particles<f64, D>,
    liquid: &[PoreLiquid<f64, D>],
    exact: &Exact,
) -> Vec<FieldValues> {
    let mut all = Vec::new();
    for_each_field(particles, liquid, exact, |field| all.push(field));
    all
}

/// The same one by one, so that no more than one need be in memory.
pub(super) fn for_each_field<const D: usize>(
    particles: &Particles<f64, D>,
    liquid: &[PoreLiquid<f64, D>],
    exact: &Exact,
    mut f: impl FnMut(FieldValues),
) {
    let mut field = |name, unit, components, values, exact: &[f64]| {
        f(FieldValues {
            name,
            unit,
            components,
            values,
            exact: exact.to_vec(),
        });
    };
    let names = match liquid.is_empty() {
        true => ["displacement", "velocity", "stress"],
        false => ["solid_displacement", "solid_velocity", "effective_stress"],
    };
    field(
        names[0],
        "m",
        D,
        vectors(particles.displacement.iter()),
        &exact.displacement,
    );
    field(
        names[1],
        "m/s",
        D,
        vectors(particles.velocity.iter()),
        &exact.velocity,
    );
    if !liquid.is_empty() {
        let velocities = vectors(liquid.iter().map(|l| &l.velocity));
        field("liquid_velocity", "m/s", D, velocities, &exact.liquid_velocity);
    }
    field(names[2], "Pa", D * D, matrices(&particles.stress), &exact.stress);
    if !liquid.is_empty() {
        let pressure = liquid.iter().map(|l| l.pressure).collect();
        field("pore_pressure", "Pa", 1, pressure, &exact.pore_pressure);
    }
}

/// Components one after the other.
pub(super) fn vectors<'a, const D: usize>(values: impl Iterator<Item = &'a SVector<f64, D>>) -> Vec<f64> {
    values.flat_map(|v| v.iter().copied()).collect()
}

/// Components one after the other, column by column.
pub(super) fn matrices<const D: usize>(values: &[SMatrix<f64, D, D>]) -> Vec<f64> {
    values.iter().flat_map(|m| m.iter().copied()).collect()
}
