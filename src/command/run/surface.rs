//! The surfaces of a scene's bodies that the stepper must know.

use std::collections::BTreeSet;

use nalgebra::SVector;

use super::error::RunError;
use super::initial::Filling;
use crate::scene::{Body, Boundary, BoundaryKind, FORGIVEN, ReconstructionKind, Scene};
use materialpoint::grid::{Face, Side};
use materialpoint::stepper::SurfacePoint;

/// The surfaces of `body`, whose particles are those of `filling` and are numbered from `first` on: those
/// that bear a traction, where its boundary says so, and those that the method must know whatever acts on
/// them ([`must_be_known`]), that is, all but the held and, in two phases, sealed ones. Beyond one dimension
/// each row of the lattice has a point wherever it ends, also at a hole.
pub(super) fn surfaces<const D: usize>(
    scene: &Scene,
    body: &Body,
    filling: &Filling<D>,
    first: usize,
) -> Result<Vec<SurfacePoint<f64>>, RunError> {
    let mut points = Vec::new();
    for face in Face::all::<D>().filter(|&face| is_needed::<D>(scene, face)) {
        let area = filling.lattice.volume() / filling.lattice.spacing()[face.axis];
        for end in ends(filling, face) {
            let particle = end.particle;
            if end.of_box && is_sealed_wall(scene, body, face) {
                continue;
            }
            let loaded = acts_at(scene, face, &filling.particles.position[particle])?;
            let needed = loaded || must_be_known::<D>(scene);
            if needed && !touches_another(scene, body, filling, particle, face)? {
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
pub(super) fn acts_at<const D: usize>(
    scene: &Scene,
    face: Face,
    x: &SVector<f64, D>,
) -> Result<bool, RunError> {
    let mut there = scene.boundaries.iter().filter(|boundary| boundary.face == face);
    match there.find_map(|boundary| boundary.inside.as_ref()) {
        Some(inside) => Ok(inside.eval_at(x.as_slice())? > 0.0),
        None => Ok(true),
    }
}

/// Whether the method must know where bodies end also where no traction acts: the liquid meets a surface in
/// any case, and along one axis fits end there. Beyond, fits find out from the particles.
fn must_be_known<const D: usize>(scene: &Scene) -> bool {
    let fits_end = D == 1 && scene.method.reconstruction != ReconstructionKind::Shepard;
    scene.material.phases.count() > 1 || fits_end
}

fn is_needed<const D: usize>(scene: &Scene, face: Face) -> bool {
    let boundary = scene.boundaries.iter().find(|boundary| boundary.face == face);
    must_be_known::<D>(scene) || boundary.is_some_and(|b| matches!(b.kind, BoundaryKind::Traction(_)))
}

/// Whether the end of the body's box meets a wall of the grid that holds the solid and lets no liquid pass.
fn is_sealed_wall(scene: &Scene, body: &Body, face: Face) -> bool {
    let boundary = scene.boundaries.iter().find(|boundary| boundary.face == face);
    let sealed_wall = |boundary: &Boundary| boundary.is_held() && !boundary.is_open();
    let same = |a: &[f64], b: &[f64]| a.get(face.axis) == b.get(face.axis);
    let at_face = match face.side {
        Side::Min => same(&body.min, &scene.grid.min),
        Side::Max => same(&body.max, &scene.grid.max),
    };
    at_face && boundary.is_some_and(sealed_wall)
}

/// A particle beyond which, towards a face, its body has no other.
#[derive(Clone, Copy, Debug)]
pub(super) struct End {
    pub(super) particle: usize,
    /// Whether the body's box ends there too, and not the shape alone.
    of_box: bool,
}

/// Where the rows of the lattice along the face's axis end towards it, ascending: at the last particle, and
/// at every hole before it.
pub(super) fn ends<const D: usize>(filling: &Filling<D>, face: Face) -> Vec<End> {
    let (lattice, upwards) = (&filling.lattice, face.side == Side::Max);
    let mut there = vec![false; lattice.len()];
    for &k in &filling.kept {
        if let Some(there) = there.get_mut(k) {
            *there = true;
        }
    }
    let end = |(particle, &k): (usize, &usize)| {
        let next = lattice.neighbour(k, face.axis, upwards);
        let goes_on = next.is_some_and(|next| there.get(next).copied().unwrap_or(false));
        (!goes_on).then(|| End {
            particle,
            of_box: next.is_none(),
        })
    };
    filling.kept.iter().enumerate().filter_map(end).collect()
}

/// Rows of the lattice along the face's axis that hold particles.
pub(super) fn rows<const D: usize>(filling: &Filling<D>, face: Face) -> usize {
    let row = |&k: &usize| {
        let mut row = filling.lattice.place(k);
        row[face.axis] = 0;
        row
    };
    filling.kept.iter().map(row).collect::<BTreeSet<_>>().len()
}

/// Whether another body begins where this one ends, next to the particle.
///
/// A box ends half a particle beyond the last one, and round-off is forgiven; where shapes say where bodies
/// are, their ends are known to a particle.
fn touches_another<const D: usize>(
    scene: &Scene,
    body: &Body,
    filling: &Filling<D>,
    particle: usize,
    face: Face,
) -> Result<bool, RunError> {
    let (lattice, axis) = (&filling.lattice, face.axis);
    let Some(&k) = filling.kept.get(particle) else {
        return Ok(false);
    };
    for other in scene.bodies.iter().filter(|&other| !std::ptr::eq(other, body)) {
        let shaped = body.inside.is_some() || other.inside.is_some();
        let reach = if shaped { 1.0 } else { 0.5 + FORGIVEN } * lattice.spacing()[axis];
        let mut place = lattice.position(k);
        place[axis] += match face.side {
            Side::Min => -reach,
            Side::Max => reach,
        };
        if other.holds(place.as_slice())? {
            return Ok(true);
        }
    }
    Ok(false)
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
    use materialpoint::grid::Grid;
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

    /// A square ring of 8 x 8 particles with a hole of 4 x 4: eight rows end at its right side, and four at
    /// the hole before it.
    #[test]
    fn a_hole_has_surfaces_too() {
        let plane = "grid={min=[0,0], max=[2,2], cells=[4,4]}";
        let law = "material.law={linear-elastic={youngs_modulus=1, poissons_ratio=0}}";
        let body =
            "body=[{min=[0,0], max=[2,2], particles_per_cell=[2,2], inside='max(abs(x-1), abs(y-1)) - 0.5'}]";
        let loaded = "boundary=[{face='x-max', traction=['1','0']}]";
        let set = [plane, ONE_PHASE, law, body, loaded].map(String::from);
        let scene = Scene::from_toml(SCENE, &set).unwrap();
        let grid = Grid::new(vector![0.0, 0.0], vector![2.0, 2.0], [4, 4]).unwrap();
        let points = initial(&scene, &grid, 0.0).unwrap();
        let x = |p: &SurfacePoint<f64>| points.particles.position[p.particle][0];
        let at = |place: f64| {
            points
                .surface
                .iter()
                .filter(|p| (x(p) - place).abs() < 1e-12)
                .count()
        };
        assert_eq!((points.surface.len(), at(1.875), at(0.375)), (12, 8, 4));
        // A plug in the hole leaves none there.
        let plug = "body=[{min=[0,0], max=[2,2], particles_per_cell=[2,2], inside='max(abs(x-1), abs(y-1)) - \
        0.5'}, \
                    {min=[0.5,0.5], max=[1.5,1.5], particles_per_cell=[2,2]}]";
        let set = [plane, ONE_PHASE, law, plug, loaded].map(String::from);
        let scene = Scene::from_toml(SCENE, &set).unwrap();
        assert_eq!(initial(&scene, &grid, 0.0).unwrap().surface.len(), 8);
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
        // Both ends of both bodies; nothing is said of where a traction acts on those that look the other
        // way.
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
