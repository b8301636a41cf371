//! The state at a face between two cells.

use super::super::{End, ReferenceError, UniaxialLaw};

/// Velocity, m/s, and stretch on one side of a face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Side {
    pub(super) velocity: f64,
    pub(super) stretch: f64,
}

/// What passes through a face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Flux {
    /// Velocity of the face, m/s.
    pub(super) velocity: f64,
    /// Stress in it, Pa.
    pub(super) stress: f64,
    /// Speed of its waves, m/s in the reference configuration.
    pub(super) speed: f64,
}

/// Speed of waves at a stretch, m/s in the reference configuration.
fn speed<L: UniaxialLaw>(law: &L, density: f64, stretch: f64) -> Result<f64, ReferenceError> {
    let stiffness = law.stiffness(stretch);
    if stiffness > 0.0 && stiffness.is_finite() {
        Ok((stiffness / density).sqrt())
    } else {
        Err(ReferenceError::NotHyperbolic { stretch, stiffness })
    }
}

/// Between two sides: two waves of one speed, the largest of either side and of what lies between them. A
/// shock is never faster than the waves behind it, so none is faster than that.
pub(super) fn between<L: UniaxialLaw>(
    law: &L,
    density: f64,
    left: Side,
    right: Side,
) -> Result<Flux, ReferenceError> {
    let sides = speed(law, density, left.stretch)?.max(speed(law, density, right.stretch)?);
    let jump = right.velocity - left.velocity;
    let middle = 0.5 * (left.stretch + right.stretch) + 0.5 * jump / sides;
    // What is pressed to less than half in one step is pressed over several faces.
    let middle = middle.max(0.5 * left.stretch.min(right.stretch));
    let speed = sides.max(speed(law, density, middle)?);
    let (below, above) = (law.stress(left.stretch), law.stress(right.stretch));
    Ok(Flux {
        velocity: 0.5 * (left.velocity + right.velocity) + 0.5 * (above - below) / (density * speed),
        stress: 0.5 * (below + above) + 0.5 * density * speed * jump,
        speed,
    })
}

/// At an end: between the bar's side and its mirror image, which has the opposite velocity beyond a fixed end
/// and the opposite stress beyond a free one. `outwards` is 1 at the right end, -1 at the left one.
pub(super) fn end<L: UniaxialLaw>(
    law: &L,
    density: f64,
    end: End,
    inside: Side,
    outwards: f64,
) -> Result<Flux, ReferenceError> {
    let speed = speed(law, density, inside.stretch)?;
    let stress = law.stress(inside.stretch);
    Ok(match end {
        End::Fixed => Flux {
            velocity: 0.0,
            stress: stress - outwards * density * speed * inside.velocity,
            speed,
        },
        End::Free => Flux {
            velocity: inside.velocity - outwards * stress / (density * speed),
            stress: 0.0,
            speed,
        },
    })
}
