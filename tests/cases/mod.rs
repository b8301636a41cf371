//! Scenes with the values that theory expects of them, each in a file of its own as a user would write it.

mod careless;
mod contact;
mod drainage;
mod frames;
mod strength;
mod weight;

use materialpoint_command::run::{InSpace, Outcome, run_in};
use materialpoint_command::scene::Scene;
use nalgebra::SMatrix;

use crate::space::scene;

const BASES: [&str; 3] = ["linear", "dual-domain", "bspline"];

/// Runs a scene with overrides.
#[track_caller]
fn solved<const D: usize>(text: &str, set: &[&str]) -> Outcome<D>
where
    Scene: InSpace<D>,
{
    run_in::<D>(&scene(text, set), None, &mut |_| {}).unwrap()
}

/// The same with a method.
#[track_caller]
fn solved_by(text: &str, [basis, reconstruction]: [&str; 2], set: &[&str]) -> Outcome<2> {
    let basis = format!("method.basis={basis}");
    let reconstruction = format!("method.reconstruction={reconstruction}");
    let all: Vec<&str> = [&*basis, &*reconstruction]
        .into_iter()
        .chain(set.iter().copied())
        .collect();
    solved(text, &all)
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.map(f64::abs).fold(0.0, f64::max)
}

fn root_mean_square(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0), |(sum, count), value| (sum + value * value, count + 1));
    (sum / f64::from(count)).sqrt()
}

/// Product of two symmetric tensors, summed over all components.
fn double_dot(a: &SMatrix<f64, 2, 2>, b: &SMatrix<f64, 2, 2>) -> f64 {
    a.component_mul(b).sum()
}
