//! Particles as a table.

use crate::output::Table;
use crate::particles::Particles;
use crate::phase::PoreLiquid;
use crate::scene::{Phases, Scene};

/// Columns of `particles.csv` in one dimension.
pub(super) fn particle_table(
    scene: &Scene,
    particles: &Particles<f64, 1>,
    liquid: &[PoreLiquid<f64, 1>],
) -> Table {
    let columns = match scene.material.phases {
        Phases::One { .. } => one_phase(particles),
        Phases::Two(soil) => two_phases(particles, liquid, soil.porosity),
    };
    let (header, columns) = columns
        .into_iter()
        .map(|(name, values)| (name.to_owned(), values))
        .unzip();
    Table { header, columns }
}

type Columns = Vec<(&'static str, Vec<f64>)>;

fn one_phase(particles: &Particles<f64, 1>) -> Columns {
    let n = particles.len();
    vec![
        ("x0[m]", particles.initial_position.iter().map(|x| x[0]).collect()),
        ("x[m]", particles.position.iter().map(|x| x[0]).collect()),
        ("u[m]", particles.displacement.iter().map(|u| u[0]).collect()),
        ("v[m/s]", particles.velocity.iter().map(|v| v[0]).collect()),
        ("stress[Pa]", particles.stress.iter().map(|s| s[(0, 0)]).collect()),
        ("density[kg/m3]", (0..n).map(|p| particles.density(p)).collect()),
        ("volume[m]", particles.volume.clone()),
    ]
}

fn two_phases(particles: &Particles<f64, 1>, liquid: &[PoreLiquid<f64, 1>], porosity: f64) -> Columns {
    let stress = particles.stress.iter().map(|s| s[(0, 0)]).collect();
    vec![
        ("x0[m]", particles.initial_position.iter().map(|x| x[0]).collect()),
        ("x[m]", particles.position.iter().map(|x| x[0]).collect()),
        (
            "u_solid[m]",
            particles.displacement.iter().map(|u| u[0]).collect(),
        ),
        ("v_solid[m/s]", particles.velocity.iter().map(|v| v[0]).collect()),
        ("v_liquid[m/s]", liquid.iter().map(|l| l.velocity[0]).collect()),
        ("effective_stress[Pa]", stress),
        ("pore_pressure[Pa]", liquid.iter().map(|l| l.pressure).collect()),
        // A constant of the model, but a column that others read.
        ("porosity[-]", vec![porosity; particles.len()]),
    ]
}
