//! Numbers that are those of another unit, or of another scale than the rest of the scene.

use super::super::dispatch::grid;
use super::super::error::RunError;
use super::super::initial::keep;
use super::range;
use crate::scene::{BoundaryKind, Expression, Law, Phases, Scene, SpaceLaw};

/// A coefficient of friction that is rather an angle in degrees: the wall would hold on a slope of 79
/// degrees, which no dry pair of materials does (rubber on rock reaches 2 or 3), while walls of soil or steel
/// have angles of 5 to 45 degrees.
const MOST_FRICTION: f64 = 5.0;
/// An angle of friction (degrees) that is rather one in radians: no frictional material has less than a
/// degree and a half, and none more than so many radians.
const LEAST_ANGLE: f64 = std::f64::consts::FRAC_PI_2;
/// Part of the particles' spacing over which a pressure must be able to even out within the run where
/// something is drained.
const LEAST_DRAINED: f64 = 1e-2;
/// Times that a wave crosses the bodies in a run that is about more than waves.
const LEAST_CROSSINGS: f64 = 10.0;

pub(super) fn warnings<const D: usize>(scene: &Scene) -> Result<Vec<String>, RunError> {
    let mut found = friction(scene);
    found.extend(friction_angle(scene));
    found.extend(load_over_stiffness(scene)?);
    found.extend(permeability::<D>(scene)?);
    found.extend(single_particles::<D>(scene)?);
    Ok(found)
}

fn friction(scene: &Scene) -> Vec<String> {
    let boundaries = scene.boundaries.iter().enumerate();
    let too_much = boundaries.filter_map(|(index, boundary)| match boundary.kind {
        BoundaryKind::Frictional { coefficient, .. } if coefficient >= MOST_FRICTION => {
            Some((index, coefficient))
        }
        _ => None,
    });
    too_much
        .map(|(index, coefficient)| {
            let angle = match coefficient < 90.0 {
                true => format!(
                    "if it is an angle in degrees write its tangent, {:.4}; ",
                    coefficient.to_radians().tan()
                ),
                false => String::new(),
            };
            format!(
                "boundary.{index}.friction = {coefficient:?} is a coefficient, and nothing dry rubs by \
                 {MOST_FRICTION} or more; {angle}for a \
                 wall that holds all write fixed = true"
            )
        })
        .collect()
}

fn friction_angle(scene: &Scene) -> Option<String> {
    let Law::InSpace(SpaceLaw::DruckerPrager { friction_angle, .. }) = scene.material.law else {
        return None;
    };
    (friction_angle > 0.0 && friction_angle < LEAST_ANGLE).then(|| {
        format!(
            "material.law.drucker-prager.friction_angle = {friction_angle:?} is in degrees, and no \
             frictional material has so little; in \
             radians it would be {:.1} degrees",
            friction_angle.to_degrees()
        )
    })
}

/// The stiffness by its key.
fn stiffness(law: Law) -> (String, f64) {
    let key = match law {
        Law::InSpace(SpaceLaw::NewtonianFluid { .. }) => "bulk_modulus",
        _ => "youngs_modulus",
    };
    (format!("material.law.{}.{key}", law.name()), law.youngs_modulus())
}

/// Loads that the material cannot bear but by strains of its own size: its weight along an axis, or a
/// traction.
fn load_over_stiffness(scene: &Scene) -> Result<Vec<String>, RunError> {
    let (key, stiffness) = stiffness(scene.material.law);
    let density = match scene.material.phases {
        Phases::One { density } => density,
        Phases::Two(soil) => soil.saturated_density(),
    };
    let most = |expression: &Expression| range(scene, expression).map(|[low, high]| high.max(-low));
    let mut found = Vec::new();
    for (axis, force) in scene.body_force.iter().flatten().enumerate() {
        let extents = scene
            .bodies
            .iter()
            .filter_map(|body| Some(body.max.get(axis)? - body.min.get(axis)?));
        let weight = density * most(force)? * extents.fold(0.0, f64::max);
        if weight >= stiffness {
            found.push(format!(
                "{key} = {stiffness:?} Pa is less than what the bodies' own weight presses them with, \
                 {weight:.3e} Pa ({}); strains are \
                 of order 1 or more, so look at the units",
                force.origin()
            ));
        }
    }
    for boundary in &scene.boundaries {
        let BoundaryKind::Traction(traction) = &boundary.kind else {
            continue;
        };
        for component in traction {
            let load = most(component)?;
            if load >= stiffness {
                found.push(format!(
                    "{key} = {stiffness:?} Pa is less than the load {}, {load:.3e} Pa at most; strains are \
                     of order 1 or more, so look \
                     at the units",
                    component.origin()
                ));
            }
        }
    }
    Ok(found)
}

/// A drained surface that drains nothing: within the run a pressure evens out over `sqrt(c_v t)`, `c_v = k E
/// / (rho_w g)`. A run in which waves have hardly crossed the bodies is about waves.
fn permeability<const D: usize>(scene: &Scene) -> Result<Option<String>, RunError> {
    let Phases::Two(soil) = scene.material.phases else {
        return Ok(None);
    };
    if !scene.boundaries.iter().any(crate::scene::Boundary::is_open) {
        return Ok(None);
    }
    let end = scene.time.end;
    let stiffness = scene.material.law.youngs_modulus();
    let unit_weight = soil.liquid_density * soil.gravity;
    let depth = (soil.permeability * stiffness / unit_weight * end).sqrt();
    let modulus = stiffness + soil.liquid_bulk_modulus / soil.porosity;
    let waves = (modulus / soil.saturated_density()).sqrt() * end;
    let grid = grid::<f64, D>(scene)?;
    let (mut least, mut size) = (f64::INFINITY, 0.0_f64);
    for body in &scene.bodies {
        let (lattice, _) = keep(body, &grid)?;
        least = lattice.spacing().iter().fold(least, |least, &s| least.min(s));
        let extents = body.min.iter().zip(&body.max).map(|(low, high)| high - low);
        size = extents.fold(size, f64::max);
    }
    Ok((depth < LEAST_DRAINED * least && waves > LEAST_CROSSINGS * size).then(|| {
        format!(
            "material.permeability = {:?}: until time.end = {end:?} s pressures even out over {depth:.1e} m, \
             of a particle's {least:.1e} m, so that nothing drains; it is the hydraulic conductivity in m/s: \
             an intrinsic permeability in m2 is to be multiplied by the liquid's unit weight over its \
             viscosity, 1e7 /(m s) for water",
            soil.permeability
        )
    }))
}

/// A body that is one particle cannot deform.
fn single_particles<const D: usize>(scene: &Scene) -> Result<Vec<String>, RunError> {
    let grid = grid::<f64, D>(scene)?;
    let mut found = Vec::new();
    for (index, body) in scene.bodies.iter().enumerate() {
        let (_, kept) = keep(body, &grid)?;
        if kept.len() == 1 {
            let cell: Vec<f64> = grid.cell_size().iter().copied().collect();
            found.push(format!(
                "body.{index} is a single particle, which cannot deform: its box is {:.3?} to {:.3?} m in \
                 cells of {cell:.3?} m; look at \
                 the units, grid.cells and body.{index}.particles_per_cell",
                body.min, body.max
            ));
        }
    }
    Ok(found)
}
