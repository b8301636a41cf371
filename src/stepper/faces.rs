//! The DOFs on the grid's faces, which walls hold.

use nalgebra::SVector;

use super::{DiffusionCondition, FaceCondition, Forcing};
use crate::basis::BasisFamily;
use crate::error::StepError;
use crate::grid::{Cell, Face, Grid, Side};
use crate::scalar::Scalar;

/// Of each face, in the order of [`Face::all`], the DOFs that a wall holds, and one that has a value there
/// all the same.
#[inline(never)]
pub(super) fn face_dofs<T: Scalar, const D: usize, B: BasisFamily<T, D>>(
    basis: &B,
    grid: &Grid<T, D>,
) -> (Vec<Vec<u32>>, Vec<Option<usize>>) {
    let (mut all, mut all_left_out) = (Vec::with_capacity(2 * D), Vec::with_capacity(2 * D));
    for face in Face::all::<D>() {
        let mut held = Vec::new();
        basis.for_each_on_face(grid, face, |dof| held.push(dof as u32));
        all_left_out.push(left_out(basis, grid, face, &held));
        all.push(held);
    }
    (all, all_left_out)
}

/// A DOF that has a value in the middle of a cell's part of the face, and is not held there.
fn left_out<T: Scalar, const D: usize, B: BasisFamily<T, D>>(
    basis: &B,
    grid: &Grid<T, D>,
    face: Face,
    held: &[u32],
) -> Option<usize> {
    let (axis, window) = (face.axis, grid.window());
    // In the middle of the window: functions of some bases reach into cells beside.
    let (first, shape) = (window.first(), window.shape());
    let mut cell: Cell<D> = std::array::from_fn(|a| first[a] + shape[a] as u32 / 2);
    let end = match face.side {
        Side::Min => 0,
        Side::Max => grid.cells()[axis] as u32,
    };
    let reaches = match face.side {
        Side::Min => first[axis] == 0,
        Side::Max => first[axis] as usize + shape[axis] == grid.cells()[axis],
    };
    if B::HOLDS_ABOUT || !reaches {
        return None;
    }
    cell[axis] = end.saturating_sub(u32::from(face.side == Side::Max));
    let mut x: SVector<T, D> = grid.centre(&cell);
    x[axis] = grid.edge(axis, end as usize);
    // Far more than the round-off of a coordinate, far less than a value that counts.
    let least = T::default_epsilon().sqrt();
    let mut found = None;
    basis.for_each(grid, &cell, &x, |dof, phi, _| {
        if phi.abs() > least && held.binary_search(&(dof as u32)).is_err() {
            found = Some(dof);
        }
    });
    found
}

/// Refuses walls that the basis would let slip, given a DOF for each face where it would.
#[inline(never)]
pub(super) fn walls_can_be_held<T: Scalar, const D: usize>(
    forcing: &Forcing<T, D>,
    left_out: &[Option<usize>],
) -> Result<(), StepError> {
    for (face, left_out) in Face::all::<D>().zip(left_out) {
        let wall = match forcing.face(face) {
            FaceCondition::Held { .. } | FaceCondition::Frictional { .. } => true,
            FaceCondition::Free | FaceCondition::Traction(_) => {
                matches!(forcing.diffusion(face), DiffusionCondition::Value(_))
            }
        };
        if let (true, &Some(dof)) = (wall, left_out) {
            return Err(StepError::WallNotHeld { face, dof });
        }
    }
    Ok(())
}
