//! Goal: particles written for ParaView read back to the bit with another program.

use std::fs;
use std::path::Path;

use vtkio::Vtk;
use vtkio::model::{Attribute, CellType, DataSet, Piece, UnstructuredGridPiece, VertexNumbers};

use super::scratch::Scratch;
use crate::output::Components::{Scalar, Symmetric, Tensor, Vector};
use crate::output::{Components, OutputError, PointCloud, PointField};

/// Numbers that a decimal or a shorter type would change.
const HARD: [f64; 7] = [
    0.1,
    -0.0,
    5e-324,
    f64::MAX,
    f64::NEG_INFINITY,
    f64::NAN,
    -1.0 / 3.0,
];

fn field(name: &str, components: Components, particles: usize) -> PointField {
    let values = HARD.into_iter().cycle().take(particles * components.count());
    PointField {
        name: name.into(),
        components,
        values: values.collect(),
    }
}

/// So many particles with a field of every kind.
pub(super) fn cloud(particles: usize) -> PointCloud {
    let position = |i: usize| [i as f64 / 3.0, -1e-300 * i as f64, 0.0];
    PointCloud {
        positions: (0..particles).map(position).collect(),
        fields: vec![
            field("density[kg/m3]", Scalar, particles),
            field("v <liquid> & \"co\"[m/s]", Vector, particles),
            field("stress[Pa]", Symmetric, particles),
            field("gradient[-]", Tensor, particles),
        ],
        field_data: vec![("TimeValue".into(), 0.1), ("velocity_time[s]".into(), -1.0 / 3.0)],
    }
}

fn read(path: &Path) -> UnstructuredGridPiece {
    match Vtk::import(path).unwrap().data {
        DataSet::UnstructuredGrid { mut pieces, .. } => match pieces.pop() {
            Some(Piece::Inline(piece)) if pieces.is_empty() => *piece,
            other => panic!("not one piece: {other:?}"),
        },
        other => panic!("not an unstructured grid: {other:?}"),
    }
}

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|v| v.to_bits()).collect()
}

fn check_reads_back(particles: usize) {
    let scratch = Scratch::new(&format!("vtu-{particles}"));
    let cloud = cloud(particles);
    let piece = read(&cloud.write_vtu(&scratch.folder(), "p.vtu").unwrap());
    let points = piece.points.cast_into::<f64>().unwrap();
    assert_eq!(bits(&points), bits(cloud.positions.as_flattened()));
    assert_eq!(piece.cells.types, vec![CellType::Vertex; particles]);
    let n = particles as u64;
    let expected = VertexNumbers::XML {
        connectivity: (0..n).collect(),
        offsets: (1..=n).collect(),
    };
    assert_eq!(piece.cells.cell_verts, expected);
    assert_eq!(piece.data.point.len(), cloud.fields.len());
    for (found, expected) in piece.data.point.into_iter().zip(&cloud.fields) {
        let Attribute::DataArray(found) = found else {
            panic!("{found:?}")
        };
        assert_eq!(found.name, expected.name);
        assert_eq!(found.num_comp(), expected.components.count());
        assert_eq!(
            bits(&found.data.cast_into::<f64>().unwrap()),
            bits(&expected.values)
        );
    }
}

#[test]
fn fields_of_every_kind_read_back_to_the_bit() {
    // One, two and three particles end base64 in its three ways; many exceed every buffer.
    for particles in [1, 2, 3, 5000] {
        check_reads_back(particles);
    }
}

#[test]
fn no_particles_make_a_file_that_says_so() {
    let scratch = Scratch::new("vtu-none");
    let path = cloud(0).write_vtu(&scratch.folder(), "p.vtu").unwrap();
    let text = fs::read_to_string(path).unwrap();
    assert!(
        text.contains("NumberOfPoints=\"0\" NumberOfCells=\"0\""),
        "{text}"
    );
}

#[test]
fn components_have_names() {
    let scratch = Scratch::new("vtu-names");
    let path = cloud(1).write_vtu(&scratch.folder(), "p.vtu").unwrap();
    let text = fs::read_to_string(path).unwrap();
    let stress = text.lines().find(|line| line.contains("stress[Pa]")).unwrap();
    for name in ["3=\"xy\"", "4=\"yz\"", "5=\"xz\""] {
        assert!(stress.contains(&format!("ComponentName{name}")), "{stress}");
    }
}

#[test]
fn fields_that_do_not_fit_the_particles_are_refused_and_nothing_is_written() {
    let scratch = Scratch::new("vtu-refused");
    let folder = scratch.folder();
    let mut short = cloud(4);
    short.fields[1].values.pop();
    let error = short.write_vtu(&folder, "p.vtu").unwrap_err();
    let sized = matches!(
        &error,
        OutputError::Field {
            found: 11,
            expected: 12,
            ..
        }
    );
    assert!(sized && error.to_string().contains("`v <liquid>"), "{error}");
    for name in ["", "stress[Pa]"] {
        let mut taken = cloud(4);
        taken.fields[0].name = name.into();
        let error = taken.write_vtu(&folder, "p.vtu").unwrap_err();
        assert!(
            matches!(&error, OutputError::FieldName { field, .. } if field == name),
            "{error}"
        );
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}
