//! The surfaces of a scene's bodies that the stepper must know.

use std::ops::Range;

use super::initial::first;
use crate::grid::{Face, Side};
use crate::particles::Particles;
use crate::scene::{Body, Boundary, BoundaryKind, Scene};
use crate::stepper::SurfacePoint;

/// The surfaces of `body`, whose particles are those in `range`: in one phase those that bear a traction; in two every end at
/// which a load, a pressure outside or the solid's skin acts on the liquid, that is, all but the held and sealed ones.
pub(super) fn surfaces(
    scene: &Scene,
    body: &Body,
    particles: &Particles<f64, 1>,
    range: Range<usize>,
) -> Vec<SurfacePoint<f64>> {
    let faces = Face::all::<1>().filter(|&face| is_needed(scene, body, face));
    let points = faces.filter_map(|face| {
        let particle = outermost(particles, range.clone(), face)?;
        Some(SurfacePoint {
            particle,
            face,
            area: 1.0,
            reach: reach(body, particles, particle, face),
        })
    });
    points.collect()
}

fn is_needed(scene: &Scene, body: &Body, face: Face) -> bool {
    if touches_another(scene, body, face) {
        return false;
    }
    let boundary = scene.boundaries.iter().find(|boundary| boundary.face == face);
    if scene.material.phases.count() == 1 {
        return boundary.is_some_and(|b| matches!(b.kind, BoundaryKind::Traction(_)));
    }
    let sealed_wall = |boundary: &Boundary| boundary.is_held() && !boundary.is_open();
    let at_face = match face.side {
        Side::Min => body.min == scene.grid.min,
        Side::Max => body.max == scene.grid.max,
    };
    !(at_face && boundary.is_some_and(sealed_wall))
}

fn touches_another(scene: &Scene, body: &Body, face: Face) -> bool {
    scene.bodies.iter().any(|other| match face.side {
        Side::Min => other.max == body.min,
        Side::Max => other.min == body.max,
    })
}

/// Distance of the body's end from the particle, in lengths of the particle.
fn reach(body: &Body, particles: &Particles<f64, 1>, particle: usize, face: Face) -> f64 {
    if body.jitter == 0.0 {
        return 0.5;
    }
    let (x, volume) = (particles.position[particle][0], particles.volume[particle]);
    let distance = match face.side {
        Side::Min => x - first(&body.min),
        Side::Max => first(&body.max) - x,
    };
    // Round-off must not put the surface inside the particle.
    (distance / volume).max(0.0)
}

fn outermost(particles: &Particles<f64, 1>, range: Range<usize>, face: Face) -> Option<usize> {
    let position = |p: &usize| particles.position[*p][0];
    let by_position = |a: &usize, b: &usize| position(a).total_cmp(&position(b));
    match face.side {
        Side::Min => range.min_by(by_position),
        Side::Max => range.max_by(by_position),
    }
}

#[cfg(test)]
mod tests {
    use super::super::initial::initial;
    use super::*;
    use crate::grid::Grid;
    use nalgebra::vector;

    const SCENE: &str = r#"
        title = "Surfaces"
        [grid]
        min = [0]
        max = [2]
        cells = [8]
        [time]
        step = 1e-6
        end = 1
        [method]
        basis = "linear"
        reconstruction = "shepard"
        [material]
        phases = 2
        strain = "small"
        law.linear-elastic = { youngs_modulus = 1e6 }
        porosity = 0.4
        solid_density = 2e3
        liquid_density = 1e3
        liquid_bulk_modulus = 1e8
        permeability = 1e-4
        [[body]]
        min = [0]
        max = [1]
        particles_per_cell = [2]
    "#;
    const ONE_PHASE: &str = "material={strain='small', density=1, law={linear-elastic={youngs_modulus=1}}}";

    fn points(overrides: &[&str]) -> Vec<SurfacePoint<f64>> {
        let overrides: Vec<_> = overrides.iter().map(ToString::to_string).collect();
        let scene = Scene::from_toml(SCENE, &overrides).unwrap();
        let grid = Grid::new(vector![0.0], vector![2.0], [8]).unwrap();
        initial(&scene, &grid).unwrap().surface
    }

    fn ends(overrides: &[&str]) -> Vec<(String, usize)> {
        let points = points(overrides);
        points.iter().map(|p| (p.face.to_string(), p.particle)).collect()
    }

    #[test]
    fn every_end_is_a_surface_unless_a_sealed_wall_or_another_body_is_there() {
        let (min, max) = (|p| ("x-min".to_owned(), p), |p| ("x-max".to_owned(), p));
        assert_eq!(ends(&[]), [min(0), max(7)]);
        assert_eq!(ends(&["boundary=[{face='x-min', fixed=true}]"]), [max(7)]);
        let drained = "boundary=[{face='x-min', fixed=true, drained=true}]";
        assert_eq!(ends(&[drained]), [min(0), max(7)]);
        // The wall is at the grid's end, not at the body's.
        assert_eq!(ends(&["boundary=[{face='x-max', fixed=true}]"]), [min(0), max(7)]);
        let two =
            "body=[{min=[0], max=[1], particles_per_cell=[2]}, {min=[1], max=[2], particles_per_cell=[2]}]";
        assert_eq!(ends(&[two]), [min(0), max(15)]);
    }

    #[test]
    fn one_phase_knows_the_loaded_ends_only() {
        assert_eq!(ends(&[ONE_PHASE]), []);
        let loaded = "boundary=[{face='x-max', traction=['1']}]";
        assert_eq!(ends(&[ONE_PHASE, loaded]), [("x-max".to_owned(), 7)]);
    }

    #[test]
    fn a_surface_is_the_body_s_end_however_irregular_the_layout() {
        assert!(points(&[]).iter().all(|point| point.reach == 0.5));
        for seed in 0..20 {
            let seed = format!("body.0.seed={seed}");
            for point in points(&["body.0.jitter=1.0", &seed]) {
                assert!((0.0..=1.0).contains(&point.reach), "{point:?}");
                assert!(point.reach != 0.5);
            }
        }
    }
}
