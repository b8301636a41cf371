//! Scenes stepped by hand, so that a test sees what happens on the way.

use materialpoint::error::StepError;
use materialpoint::stepper::{FaceCondition, Forcing, Simulation};
use materialpoint_command::run::{InSpace, simulation_in};
use materialpoint_command::scene::{BoundaryKind, Expression, Scene, StepSize};
use nalgebra::SVector;

fn vector<const D: usize>(expressions: &[Expression], time: f64) -> SVector<f64, D> {
    SVector::from_fn(|axis, _| expressions[axis].eval_time(time).unwrap())
}

fn forcing<const D: usize>(scene: &Scene, time: f64) -> Forcing<f64, D> {
    let mut forcing = Forcing::none();
    if let Some(force) = &scene.body_force {
        forcing.body_force = vector(force, time);
    }
    for boundary in &scene.boundaries {
        let condition = match &boundary.kind {
            BoundaryKind::Fixed => FaceCondition::fixed(),
            BoundaryKind::Roller => FaceCondition::roller(boundary.face.axis),
            BoundaryKind::Traction(traction) => FaceCondition::Traction(vector(traction, time)),
            other => panic!("{other:?} is not known here"),
        };
        forcing.set_face(boundary.face, condition);
    }
    forcing
}

/// Steps `scene` to its end and calls `each` with the time (s) before the first step and after every one.
pub fn watch<const D: usize>(
    scene: &Scene,
    mut each: impl FnMut(f64, &dyn Simulation<D>),
) -> Result<Box<dyn Simulation<D>>, StepError>
where
    Scene: InSpace<D>,
{
    let StepSize::Fixed(dt) = scene.time.step else {
        panic!("a step in s");
    };
    let mut simulation = simulation_in::<D>(scene).unwrap();
    each(0.0, &*simulation);
    for step in 0..(scene.time.end / dt).round() as usize {
        simulation.step(dt, &forcing(scene, dt * step as f64))?;
        each(dt * (step + 1) as f64, &*simulation);
    }
    Ok(simulation)
}

/// Total momentum (kg m/s) and angular momentum (kg m2/s) about the origin, and their scales `sum m |v|` and
/// `sum m |x| |v|`.
#[derive(Clone, Copy, Debug)]
pub struct Momenta {
    pub linear: SVector<f64, 2>,
    pub angular: f64,
    pub linear_scale: f64,
    pub angular_scale: f64,
}

pub fn momenta(simulation: &dyn Simulation<2>) -> Momenta {
    let particles = simulation.particles();
    let mut sums = Momenta {
        linear: SVector::zeros(),
        angular: 0.0,
        linear_scale: 0.0,
        angular_scale: 0.0,
    };
    for ((x, v), m) in particles
        .position
        .iter()
        .zip(&particles.velocity)
        .zip(&particles.mass)
    {
        sums.linear += v * *m;
        sums.angular += m * x.perp(v);
        sums.linear_scale += m * v.norm();
        sums.angular_scale += m * x.norm() * v.norm();
    }
    sums
}
