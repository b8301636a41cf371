//! Combinations of method and model that cannot be relied on: each with the keys at fault and what to take
//! instead.

use crate::scene::{Basis, Body, Phases, ReconstructionKind, Scene};
use materialpoint::grid::{Face, Side};

/// What a user should know of the method of a scene: sentences that name the keys at fault; none where it can
/// be relied on.
pub fn method_warnings(scene: &Scene) -> Vec<String> {
    let all = [
        spline_on_a_moving_surface(scene),
        published_fits_on_a_free_side(scene),
        few_particles(scene),
    ];
    all.into_iter().flatten().collect()
}

/// `docs/verification/two-phase.md` has the figures.
fn spline_on_a_moving_surface(scene: &Scene) -> Option<String> {
    let Phases::Two(_) = scene.material.phases else {
        return None;
    };
    let method = &scene.method;
    let spline = method.reconstruction == ReconstructionKind::Spline;
    let unusable = spline && method.basis == Basis::Linear && scene.material.law.large_strain();
    unusable.then(|| {
        "method: the cubic spline with linear functions does not bear the load of a surface that moves through cells; take \
         shepard or taylor, or another basis"
            .to_owned()
    })
}

/// Beyond one axis published fits go on to the end of a cell that material ends in.
fn published_fits_on_a_free_side(scene: &Scene) -> Option<String> {
    if scene.method.reconstruction != ReconstructionKind::Taylor || scene.dimension() == 1 {
        return None;
    }
    let (index, body) = first_body(scene, |body| free_side(scene, body).is_some())?;
    let face = free_side(scene, body)?;
    Some(format!(
        "method.reconstruction = \"taylor\" does not bear a free side beyond one axis, and body {index} has one (towards {face}): \
         stresses there are noise that grows; take relaxed-taylor or shepard"
    ))
}

fn first_body(scene: &Scene, is_at_fault: impl Fn(&Body) -> bool) -> Option<(usize, &Body)> {
    let mut bodies = scene.bodies.iter().enumerate();
    bodies.find(|(_, body)| is_at_fault(body))
}

/// The first side of a body that no held face of the grid covers.
fn free_side(scene: &Scene, body: &Body) -> Option<Face> {
    let faces =
        (0..scene.dimension()).flat_map(|axis| [Side::Min, Side::Max].map(|side| Face { axis, side }));
    faces.into_iter().find(|&face| {
        body.inside.is_some() || !is_at_a_wall(scene, body, face) && !is_at_another(scene, body, face)
    })
}

fn end(body: &Body, face: Face) -> Option<f64> {
    let corner = match face.side {
        Side::Min => &body.min,
        Side::Max => &body.max,
    };
    corner.get(face.axis).copied()
}

fn is_at_a_wall(scene: &Scene, body: &Body, face: Face) -> bool {
    let grid_end = match face.side {
        Side::Min => scene.grid.min.get(face.axis),
        Side::Max => scene.grid.max.get(face.axis),
    };
    let mut there = scene.boundaries.iter().filter(|boundary| boundary.face == face);
    end(body, face) == grid_end.copied() && there.any(|boundary| boundary.is_held())
}

/// Whether another body covers the whole side.
fn is_at_another(scene: &Scene, body: &Body, face: Face) -> bool {
    let opposite = Face {
        side: match face.side {
            Side::Min => Side::Max,
            Side::Max => Side::Min,
        },
        ..face
    };
    scene.bodies.iter().any(|other| {
        let meets = end(other, opposite) == end(body, face);
        let mut across = (0..scene.dimension()).filter(|&axis| axis != face.axis);
        let covers = |axis: usize| {
            other.min.get(axis) <= body.min.get(axis) && body.max.get(axis) <= other.max.get(axis)
        };
        other.inside.is_none() && meets && across.all(covers)
    })
}

/// Relaxed fits want two particles along each axis of a cell: cells with less are stepped as by particle
/// sums.
fn few_particles(scene: &Scene) -> Option<String> {
    if scene.method.reconstruction != ReconstructionKind::RelaxedTaylor {
        return None;
    }
    let few = |body: &Body| body.particles_per_cell.iter().any(|&count| count < 2);
    let (index, body) = first_body(scene, few)?;
    Some(format!(
        "body {index}: particles_per_cell = {:?} is less than the two along each axis that method.reconstruction = \
         \"relaxed-taylor\" wants; its cells are stepped with lumped masses and particle sums, as by shepard",
        body.particles_per_cell
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    const COLUMN: &str = r#"
        title = "Column"
        [grid]
        min = [0, 0]
        max = [1, 6]
        cells = [2, 12]
        [time]
        step = 1e-4
        end = 1
        [method]
        basis = "linear"
        reconstruction = "taylor"
        [material]
        strain = "small"
        law.linear-elastic = { youngs_modulus = 1e7, poissons_ratio = 0.3 }
        density = 1800
        [[body]]
        min = [0, 0]
        max = [1, 5]
        particles_per_cell = [2, 2]
        [[boundary]]
        face = "x-min"
        roller = true
        [[boundary]]
        face = "x-max"
        roller = true
        [[boundary]]
        face = "y-min"
        fixed = true
    "#;

    fn warned(set: &[&str]) -> Vec<String> {
        let set: Vec<_> = set.iter().map(ToString::to_string).collect();
        method_warnings(&Scene::from_toml(COLUMN, &set).unwrap())
    }

    #[test]
    fn published_fits_are_warned_of_a_free_side_and_of_no_other() {
        let found = warned(&[]);
        assert!(
            matches!(&found[..], [one] if one.contains("method.reconstruction") && one.contains("body 0") && one.contains("y-max")),
            "{found:?}"
        );
        for set in [
            "method.reconstruction='shepard'",
            "method.reconstruction='relaxed-taylor'",
        ] {
            assert_eq!(warned(&[set]), [""; 0]);
        }
        let roof = "boundary=[{face='x-min', roller=true}, {face='x-max', roller=true}, {face='y-min', fixed=true}, \
                    {face='y-max', roller=true}]";
        assert_eq!(warned(&[roof, "grid.max=[1, 5]"]), [""; 0]);
        // Half of the column upon the other half.
        let halves = "body=[{min=[0, 0], max=[1, 3], particles_per_cell=[2, 2]}, {min=[0, 3], max=[1, 5], particles_per_cell=[2, 2]}]";
        assert_eq!(warned(&[roof, "grid.max=[1, 5]", halves]), [""; 0]);
        assert!(warned(&[halves])[0].contains("body 1"));
        assert_eq!(
            warned(&[roof, "grid.max=[1, 5]", "body.0.inside='y - x'"]).len(),
            1
        );
    }

    #[test]
    fn relaxed_fits_are_warned_of_less_than_two_particles_along_an_axis() {
        let relaxed = "method.reconstruction='relaxed-taylor'";
        for few in ["[1, 1]", "[1, 4]", "[4, 1]"] {
            let found = warned(&[relaxed, &format!("body.0.particles_per_cell={few}")]);
            assert!(
                matches!(&found[..], [one] if one.contains("particles_per_cell") && one.contains(few)),
                "{found:?}"
            );
        }
        assert_eq!(warned(&[relaxed, "body.0.particles_per_cell=[2, 4]"]), [""; 0]);
    }
}
