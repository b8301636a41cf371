//! Particles as a table.

use crate::output::Table;
use crate::particles::Particles;

/// Columns of `particles.csv` in one dimension.
pub(super) fn particle_table(particles: &Particles<f64, 1>) -> Table {
    let n = particles.len();
    let columns: [(&str, Vec<f64>); 7] = [
        ("x0[m]", particles.initial_position.iter().map(|x| x[0]).collect()),
        ("x[m]", particles.position.iter().map(|x| x[0]).collect()),
        ("u[m]", particles.displacement.iter().map(|u| u[0]).collect()),
        ("v[m/s]", particles.velocity.iter().map(|v| v[0]).collect()),
        ("stress[Pa]", particles.stress.iter().map(|s| s[(0, 0)]).collect()),
        ("density[kg/m3]", (0..n).map(|p| particles.density(p)).collect()),
        ("volume[m]", particles.volume.clone()),
    ];
    let (header, columns) = columns
        .into_iter()
        .map(|(name, values)| (name.to_owned(), values))
        .unzip();
    Table { header, columns }
}
