//! Velocity transfers.

use materialpoint::scalar::Scalar;
use materialpoint::testing::{Failure, Property, TransferClaims, check_transfer};
use materialpoint::transfer::{Flip, GridVelocity, Transfer};
use nalgebra::{SMatrix, SVector};

use super::{Planted, planted};
use crate::examples::apic::{Apic, Pic};

const LINEAR: TransferClaims = TransferClaims {
    keeps_linear_velocities: true,
};
const UNIFORM: TransferClaims = TransferClaims {
    keeps_linear_velocities: false,
};

macro_rules! each {
    ($($scalar:ty, $d:literal);+) => {$(
        check_transfer::<$scalar, $d, _>(&Flip, &UNIFORM)?;
        check_transfer::<$scalar, $d, _>(&Pic, &UNIFORM)?;
        check_transfer::<$scalar, $d, _>(&Apic, &LINEAR)?;
        check_transfer::<$scalar, $d, _>(&Planting(Slip::Right), &LINEAR)?;
    )+};
}

#[test]
fn flip_pic_apic_and_a_blend_pass() -> Result<(), Failure> {
    each!(f64, 1; f64, 2; f64, 3; f32, 1; f32, 2; f32, 3);
    Ok(())
}

#[test]
fn claims_are_neither_too_bold_nor_too_shy() {
    let bold = check_transfer::<f64, 2, _>(&Pic, &LINEAR).unwrap_err();
    let shy = check_transfer::<f64, 2, _>(&Apic, &UNIFORM).unwrap_err();
    assert_eq!([bold.property, shy.property], [Property::LinearVelocity; 2]);
}

/// Slips in a transfer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Slip {
    Right,
    KeepsItsVelocity,
    TwiceTheVelocity,
    OneComponent,
    AcceleratesTwice,
    BlendsWithVelocitiesBeforeTheKick,
    BlendsWithoutTime,
    AddsItsGradient,
    MomentAsGradient,
    GradientTurnedAbout,
    GradientTransposed,
    RemembersNothing,
    AddsUpGradients,
}

/// APIC with a share of FLIP in its velocity, with a slip.
#[derive(Clone, Copy, Debug)]
struct Planting(Slip);

impl<T: Scalar, const D: usize> Transfer<T, D> for Planting {
    const FROM_GRID: bool = true;
    const AFFINE: bool = true;
    type Particle = Gradient<T, D>;

    fn gradient(&self, particle: &Gradient<T, D>) -> SMatrix<T, D, D> {
        match self.0 {
            Slip::GradientTurnedAbout => -particle.0,
            Slip::GradientTransposed => particle.0.transpose(),
            _ => particle.0,
        }
    }

    fn take(&self, seen: &GridVelocity<T, D>, velocity: &mut SVector<T, D>, particle: &mut Gradient<T, D>) {
        let half = T::lit(0.5);
        let kicked = match self.0 {
            Slip::BlendsWithVelocitiesBeforeTheKick => *velocity,
            Slip::BlendsWithoutTime => *velocity + seen.acceleration,
            _ => *velocity + seen.acceleration * seen.dt,
        };
        let before = *velocity;
        *velocity = (kicked + seen.velocity) * half;
        match self.0 {
            Slip::KeepsItsVelocity => *velocity = before,
            Slip::TwiceTheVelocity => *velocity *= T::lit(2.0),
            Slip::OneComponent => velocity[0] = before[0],
            Slip::AcceleratesTwice => *velocity += seen.acceleration * seen.dt,
            Slip::AddsItsGradient => *velocity += seen.affine().column(0),
            _ => {}
        }
        match self.0 {
            Slip::MomentAsGradient => particle.0 = seen.moment,
            Slip::RemembersNothing => {}
            Slip::AddsUpGradients => particle.0 += seen.affine(),
            _ => particle.0 = seen.affine(),
        }
    }
}

#[derive(Clone, Copy, Debug)]
struct Gradient<T, const D: usize>(SMatrix<T, D, D>);

impl<T: Scalar, const D: usize> Default for Gradient<T, D> {
    fn default() -> Self {
        Self(SMatrix::zeros())
    }
}

pub(super) fn mistakes() -> Vec<Planted> {
    let table = [
        (Slip::KeepsItsVelocity, Property::UniformVelocity),
        (Slip::TwiceTheVelocity, Property::UniformVelocity),
        (Slip::OneComponent, Property::UniformVelocity),
        (Slip::AcceleratesTwice, Property::UniformVelocity),
        (Slip::BlendsWithVelocitiesBeforeTheKick, Property::UniformVelocity),
        (Slip::BlendsWithoutTime, Property::UniformVelocity),
        (Slip::AddsItsGradient, Property::TransferKeepsMomentum),
        (Slip::MomentAsGradient, Property::LinearVelocity),
        (Slip::GradientTurnedAbout, Property::LinearVelocity),
        (Slip::GradientTransposed, Property::LinearVelocity),
        (Slip::RemembersNothing, Property::LinearVelocity),
        (Slip::AddsUpGradients, Property::LinearVelocity),
    ];
    planted("transfer", table, |slip| {
        let found = check_transfer::<f64, 2, _>(&Planting(slip), &LINEAR);
        found.err().map(|failure| failure.property)
    })
}
