//! Particles as points for ParaView.

use super::frames::Moment;
use super::particle_fields::{ParticleField, Rank, Snapshot};
use crate::output::{Components, PointCloud, PointField};
use crate::scene::Scene;

/// Rows and columns in VTK's order of a symmetric tensor.
const ORDER: [[usize; 2]; 6] = [[0, 0], [1, 1], [2, 2], [0, 1], [1, 2], [0, 2]];

/// The particles with the fields that tables have, under the same names; vectors and tensors have their
/// components in space, and the stress off the plane is part of the stress. Where a law does not know it, it
/// is no number.
pub(super) fn point_cloud<const D: usize>(
    scene: &Scene,
    snapshot: &Snapshot<'_, D>,
    bodies: &[usize],
    moment: Moment,
) -> PointCloud {
    let in_space = |x: &[f64]| std::array::from_fn(|a| x.get(a).copied().unwrap_or(0.0));
    let positions = snapshot.particles.position.iter().map(|x| in_space(x.as_slice()));
    let mut cloud = PointCloud {
        positions: positions.collect(),
        fields: Vec::new(),
        field_data: vec![
            ("TimeValue".to_owned(), moment.time),
            ("velocity_time[s]".to_owned(), moment.velocity_time),
        ],
    };
    let start = super::fields::vectors(snapshot.particles.initial_position.iter());
    let start = ParticleField {
        name: "x0",
        unit: "m",
        rank: Rank::Vector,
        values: start,
    };
    let off_plane = &snapshot.law.off_plane_stress;
    cloud.fields.push(point_field::<D>(start, off_plane));
    snapshot.for_each(scene, bodies, |field| {
        cloud.fields.push(point_field::<D>(field, off_plane));
    });
    cloud
}

/// A field with the components that it has in three dimensions; along one axis all are numbers.
fn point_field<const D: usize>(field: ParticleField, off_plane: &[f64]) -> PointField {
    let ParticleField {
        name,
        unit,
        rank,
        values,
    } = field;
    let (components, values) = match rank {
        Rank::Scalar => (Components::Scalar, values),
        _ if D == 1 => (Components::Scalar, values),
        Rank::Vector => {
            let each = values.chunks(D);
            let padded = each.flat_map(|v| (0..3).map(|a| v.get(a).copied().unwrap_or(0.0)));
            (Components::Vector, padded.collect())
        }
        Rank::Tensor => {
            let component = |m: &[f64], p: usize, [row, column]: [usize; 2]| match row.max(column) < D {
                true => m.get(column * D + row).copied().unwrap_or(f64::NAN),
                false if row == column => off_plane.get(p).copied().unwrap_or(f64::NAN),
                false => 0.0,
            };
            let each = values.chunks(D * D).enumerate();
            let padded = each.flat_map(|(p, m)| ORDER.map(|place| component(m, p, place)));
            (Components::Symmetric, padded.collect())
        }
    };
    PointField {
        name: format!("{name}[{unit}]"),
        components,
        values,
    }
}
