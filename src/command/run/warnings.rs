//! What a scene asks for that is surely not meant, or cannot be had: said before the run, with key and value.
//!
//! Each check compares quantities of one unit, so that none depends on the size of the problem, and speaks
//! only where no sensible scene would be: a warning that is wrong now and then is soon read no more.

mod ends;
mod numbers;
mod strain;
mod walls;

pub(super) use strain::small_strain;

use super::error::RunError;
use super::space::InSpace;
use crate::scene::{Expression, Scene};

/// Warnings of a scene.
pub(super) fn warnings<const D: usize>(scene: &Scene) -> Result<Vec<String>, RunError>
where
    Scene: InSpace<D>,
{
    let mut found = numbers::warnings::<D>(scene)?;
    found.extend(walls::warnings::<D>(scene)?);
    found.extend(ends::warnings::<D>(scene)?);
    Ok(found)
}

/// Times of a run at which expressions are looked at, its start and end among them.
const TIMES: usize = 64;

/// The values of an expression in `t` over the run.
fn over_time<'a>(
    scene: &'a Scene,
    expression: &'a Expression,
) -> impl Iterator<Item = Result<f64, RunError>> + 'a {
    let time = |k: usize| scene.time.end * k as f64 / TIMES as f64;
    (0..=TIMES).map(move |k| Ok(expression.eval_time(time(k))?))
}

/// Its lowest and highest.
fn range(scene: &Scene, expression: &Expression) -> Result<[f64; 2], RunError> {
    let mut range = [f64::INFINITY, f64::NEG_INFINITY];
    for value in over_time(scene, expression) {
        let value = value?;
        range = [range[0].min(value), range[1].max(value)];
    }
    Ok(range)
}
