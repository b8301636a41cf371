//! Particles as a table.

use super::particle_fields::{ParticleField, Rank, Snapshot, stress_name};
use crate::output::Table;
use crate::scene::Scene;

/// Columns of `particles.csv`: positions, then the fields one after the other; in the plane the stress off it
/// is a column of its own, after those that tables began with.
pub(super) fn particle_table<const D: usize>(
    scene: &Scene,
    snapshot: &Snapshot<'_, D>,
    bodies: &[usize],
) -> Table {
    let mut columns = Columns::default();
    columns.positions("0", &snapshot.particles.initial_position);
    columns.positions("", &snapshot.particles.position);
    snapshot.for_each(scene, bodies, |field| {
        if field.name == "mass" && D == 2 && !snapshot.law.off_plane_stress.is_empty() {
            let values = snapshot.law.off_plane_stress.clone();
            columns.add(format!("{}_zz[Pa]", stress_name(scene)), values);
        }
        columns.field::<D>(&field);
    });
    columns.0
}

/// Axes by name.
const AXES: [&str; 3] = ["x", "y", "z"];

fn axis(a: usize) -> &'static str {
    AXES.get(a).copied().unwrap_or("?")
}

#[derive(Default)]
struct Columns(Table);

impl Columns {
    /// Named by their axes alone.
    fn positions<const D: usize>(&mut self, suffix: &str, positions: &[nalgebra::SVector<f64, D>]) {
        for a in 0..D {
            let values = positions.iter().map(|x| x[a]).collect();
            self.add(format!("{}{suffix}[m]", axis(a)), values);
        }
    }

    fn field<const D: usize>(&mut self, field: &ParticleField) {
        let ParticleField {
            name,
            unit,
            rank,
            values,
        } = field;
        let components: Vec<(String, usize)> = match rank {
            _ if D == 1 => vec![(String::new(), 0)],
            Rank::Scalar => vec![(String::new(), 0)],
            Rank::Vector => (0..D).map(|a| (format!("_{}", axis(a)), a)).collect(),
            // The diagonal, then the rest.
            Rank::Tensor => {
                let off = (0..D).flat_map(|a| (a + 1..D).map(move |b| (a, b)));
                let all = (0..D).map(|a| (a, a)).chain(off);
                all.map(|(a, b)| (format!("_{}{}", axis(a), axis(b)), b * D + a))
                    .collect()
            }
        };
        let each = match rank {
            Rank::Scalar => 1,
            Rank::Vector => D,
            Rank::Tensor => D * D,
        };
        for (suffix, component) in components {
            let values = values.iter().skip(component).step_by(each).copied().collect();
            self.add(format!("{name}{suffix}[{unit}]"), values);
        }
    }

    fn add(&mut self, name: String, values: Vec<f64>) {
        self.0.header.push(name);
        self.0.columns.push(values);
    }
}
