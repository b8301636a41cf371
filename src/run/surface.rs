//! The surfaces of a scene's bodies that the stepper must know.

use std::collections::BTreeMap;

use nalgebra::SVector;

use super::error::RunError;
use super::initial::Filling;
use crate::grid::{Face, Side};
use crate::scene::{Body, Boundary, BoundaryKind, ReconstructionKind, Scene};
use crate::stepper::SurfacePoint;

/// The surfaces of `body`, whose particles are those of `filling` and are numbered from `first` on: those that bear a traction, where
/// its boundary says so, and those that the method must know whatever acts on them ([`must_be_known`]), that is, all but the held and,
/// in two phases, sealed ones. Beyond one dimension each row of the lattice that ends there has a point.
pub(super) fn surfaces<const D: usize>(
    scene: &Scene,
    body: &Body,
    filling: &Filling<D>,
    first: usize,
) -> Result<Vec<SurfacePoint<f64>>, RunError> {
    let mut points = Vec::new();
    for face in Face::all::<D>().filter(|&face| is_needed::<D>(scene, body, face)) {
        let area = filling.lattice.volume() / filling.lattice.spacing()[face.axis];
        for particle in ends(filling, face) {
            let loaded = acts_at(scene, face, &filling.particles.position[particle])?;
            let needed = loaded || must_be_known::<D>(scene);
            if needed && !touches_another(scene, body, filling, particle, face) {
                points.push(SurfacePoint {
                    particle: first + particle,
                    face,
                    area,
                    reach: reach(body, filling, particle, face),
                    loaded,
                });
            }
        }
    }
    Ok(points)
}

/// Whether the boundary at `face` says that its traction acts at `x` (m).
fn acts_at<const D: usize>(scene: &Scene, face: Face, x: &SVector<f64, D>) -> Result<bool, RunError> {
    let mut there = scene.boundaries.iter().filter(|boundary| boundary.face == face);
    match there.find_map(|boundary| boundary.inside.as_ref()) {
        Some(inside) => Ok(inside.eval_at(x.as_slice())? > 0.0),
        None => Ok(true),
    }
}

/// Whether the method must know where bodies end also where no traction acts: the liquid meets a surface in any case, and along one
/// axis fits end there. Beyond, fits find out from the particles.
fn must_be_known<const D: usize>(scene: &Scene) -> bool {
    let fits_end = D == 1 && scene.method.reconstruction != ReconstructionKind::Shepard;
    scene.material.phases.count() > 1 || fits_end
}

fn is_needed<const D: usize>(scene: &Scene, body: &Body, face: Face) -> bool {
    let boundary = scene.boundaries.iter().find(|boundary| boundary.face == face);
    let bears_traction = boundary.is_some_and(|b| matches!(b.kind, BoundaryKind::Traction(_)));
    if !must_be_known::<D>(scene) {
        return bears_traction;
    }
    let sealed_wall = |boundary: &Boundary| boundary.is_held() && !boundary.is_open();
    let same = |a: &[f64], b: &[f64]| a.get(face.axis) == b.get(face.axis);
    let at_face = match face.side {
        Side::Min => same(&body.min, &scene.grid.min),
        Side::Max => same(&body.max, &scene.grid.max),
    };
    !(at_face && boundary.is_some_and(sealed_wall))
}

/// The last particle towards the face of each row of the lattice along its axis, ascending.
fn ends<const D: usize>(filling: &Filling<D>, face: Face) -> Vec<usize> {
    let mut last: BTreeMap<[usize; D], (usize, usize)> = BTreeMap::new();
    for (particle, &k) in filling.kept.iter().enumerate() {
        let mut row = filling.lattice.place(k);
        let along = std::mem::take(&mut row[face.axis]);
        let end = last.entry(row).or_insert((along, particle));
        let further = match face.side {
            Side::Min => along < end.0,
            Side::Max => along > end.0,
        };
        if further {
            *end = (along, particle);
        }
    }
    let mut particles: Vec<_> = last.into_values().map(|(_, particle)| particle).collect();
    particles.sort_unstable();
    particles
}

/// Whether another body begins where this one ends, next to the particle.
fn touches_another<const D: usize>(
    scene: &Scene,
    body: &Body,
    filling: &Filling<D>,
    particle: usize,
    face: Face,
) -> bool {
    let x = &filling.particles.position[particle];
    let meets = |a: &[f64], b: &[f64]| a.get(face.axis) == b.get(face.axis);
    let beside = |other: &Body| {
        let mut bounds = other.min.iter().zip(&other.max).zip(x.iter()).enumerate();
        bounds.all(|(axis, ((low, high), x))| axis == face.axis || (low <= x && x <= high))
    };
    scene.bodies.iter().any(|other| {
        let meets = match face.side {
            Side::Min => meets(&other.max, &body.min),
            Side::Max => meets(&other.min, &body.max),
        };
        meets && beside(other)
    })
}

/// Distance of the body's end from the particle, in lengths of the particle.
fn reach<const D: usize>(body: &Body, filling: &Filling<D>, particle: usize, face: Face) -> f64 {
    // Where an expression says where the body is, its end is half a particle beyond the last one.
    if body.jitter == 0.0 || body.inside.is_some() {
        return 0.5;
    }
    let axis = face.axis;
    let x = filling.particles.position[particle][axis];
    let end = |corner: &[f64]| corner.get(axis).copied().unwrap_or(f64::NAN);
    let distance = match face.side {
        Side::Min => x - end(&body.min),
        Side::Max => end(&body.max) - x,
    };
    // Round-off must not put the surface inside the particle.
    (distance / filling.lattice.spacing()[axis]).max(0.0)
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
        initial(&scene, &grid, 0.0).unwrap().surface
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

    /// Particle sums look at no end that bears nothing; fits end where the body does.
    #[test]
    fn one_phase_knows_the_loaded_ends_and_fits_know_all() {
        assert_eq!(ends(&[ONE_PHASE]), []);
        let loaded = "boundary=[{face='x-max', traction=['1']}]";
        assert_eq!(ends(&[ONE_PHASE, loaded]), [("x-max".to_owned(), 7)]);
        let both = [("x-min".to_owned(), 0), ("x-max".to_owned(), 7)];
        for fit in ["taylor", "relaxed-taylor", "spline"] {
            let fit = format!("method.reconstruction='{fit}'");
            assert_eq!(ends(&[ONE_PHASE, &fit]), both);
            assert_eq!(ends(&[ONE_PHASE, &fit, loaded]), both);
            let held = "boundary=[{face='x-min', fixed=true}]";
            assert_eq!(ends(&[ONE_PHASE, &fit, held]), both[1..]);
        }
    }

    #[test]
    fn a_traction_acts_where_it_is_said_to() {
        let two = "body=[{min=[0], max=[0.5], particles_per_cell=[2]}, {min=[1], max=[1.5], particles_per_cell=[2]}]";
        let loaded = |inside: &str| format!("boundary=[{{face='x-max', traction=['1']{inside}}}]");
        let all = ends(&[ONE_PHASE, two, &loaded("")]);
        assert_eq!(all, [("x-max".to_owned(), 3), ("x-max".to_owned(), 7)]);
        let right = ends(&[ONE_PHASE, two, &loaded(", inside='x - 1'")]);
        assert_eq!(right, [("x-max".to_owned(), 7)]);
        assert_eq!(ends(&[ONE_PHASE, two, &loaded(", inside='-x'")]), []);
    }

    #[test]
    fn the_liquid_meets_a_surface_also_where_no_traction_acts() {
        let two = "body=[{min=[0], max=[0.5], particles_per_cell=[2]}, {min=[1], max=[1.5], particles_per_cell=[2]}]";
        let right = "boundary=[{face='x-max', traction=['1'], inside='x - 1', drained=true}]";
        let found: Vec<_> = points(&[two, right])
            .iter()
            .map(|p| (p.particle, p.loaded))
            .collect();
        // Both ends of both bodies; nothing is said of where a traction acts on those that look the other way.
        assert_eq!(found, [(0, true), (3, false), (4, true), (7, true)]);
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
