//! What a check reports.

use std::fmt;

use nalgebra::SVector;
use thiserror::Error;

use crate::grid::Cell;
use crate::scalar::Scalar;

/// A property that an implementation does not have, or has although it claims not to.
#[derive(Clone, Debug, Error, PartialEq)]
#[error("{property}, {place}: expected {expected}, found {found:e}")]
pub struct Failure {
    /// The property at fault.
    pub property: Property,
    /// Where it was noticed.
    pub place: Place,
    /// What was expected there.
    pub expected: Expected,
    /// What was found there.
    pub found: f64,
}

/// The properties that the checks know.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Property {
    /// The sample points or particles given to the check lie in the grid.
    PointsInGrid,
    /// The number of a DOF is below the number of DOFs.
    DofInRange,
    /// All points of a cell see the same DOFs in the same order.
    SameDofsInCell,
    /// The DOFs of a cell are in its [`dof_window`](crate::basis::BasisFamily::dof_window).
    DofWindow,
    /// Values sum to one.
    PartitionOfUnity,
    /// No value is negative.
    NonNegative,
    /// Gradients sum to zero.
    GradientSum,
    /// On a face of the grid only the face's own DOFs have a value, unless the basis says otherwise.
    FaceValues,
    /// DOFs whose values overlap differ by no more than the half band width.
    HalfBand,
    /// Some point gives the DOF a value.
    EveryDofReached,
    /// Two cells give a DOF the same value on the edge that they share.
    Continuous,
    /// `degree` is the degree that the values are claimed to reproduce.
    DegreeAsSaid,
    /// A point that stands still sees the same values as a moving one.
    FixedPointValues,
    /// Gradients are the derivatives of the values.
    GradientsAreDerivatives,
    /// Gradients at points that stand still are the derivatives of the values.
    FixedPointGradients,
    /// The values reproduce polynomials of this degree.
    Reproduces(usize),
    /// The gradient of a linear field is exact.
    GradientOfLinearField,
    /// Points of the stream lie in the cell that they name.
    StreamInCell,
    /// Every field is streamed at the same points.
    SamePoints,
    /// The points are the particles, as the associated constant says.
    StreamsParticles,
    /// Streaming is linear in the field.
    Linear,
    /// `prepare` forgets the particles it saw before.
    PrepareForgets,
    /// Weights sum to the volume that they integrate.
    Weights,
    /// The amounts of each cell are kept.
    ConservesAmounts,
    /// Integrals over cells are exact for polynomials of this degree.
    Integrates(usize),
    /// The undeformed state has neither stress nor energy.
    Unstressed,
    /// An increment of zero changes nothing.
    ZeroIncrement,
    /// Stress is symmetric.
    SymmetricStress,
    /// Stress increments are linear in small strain increments.
    LinearForSmallIncrements,
    /// `density * wave_speed^2` is the stiffness of uniaxial strain.
    WaveSpeed,
    /// The change of the strain energy is the work of the stress.
    EnergyIsWork,
    /// Rotating the material produces no energy.
    RotationKeepsEnergy,
    /// Stress follows a rotation of the material.
    Objective,
    /// At small strain the energy is the work of the stress, whatever it is further on.
    EnergyAtSmallStrain,
    /// The stiffness at rest is that of the elastic constants.
    ElasticConstants,
    /// The strain for a change of the stress makes about that change.
    StrainForChange,
    /// A state made for a stress keeps it.
    StartKeepsStress,
    /// The law knows the stresses that it gives.
    KnowsItsStress,
    /// Material that is held in its shape gains no energy, and no path gives more than was put in.
    NoEnergyFromNothing,
    /// `update` is the response to slow or to fast strain.
    UpdateIsALimit,
    /// Stress does not fall while strain grows.
    Stable,
    /// `factors` gives what `for_each` does.
    Factors,
    /// `AT_FIXED_POINTS` says what `for_each_at_fixed_point` visits.
    FixedPointsAsSaid,
    /// Over a domain that has vanished a particle is a point.
    VanishingDomain,
    /// A gradient that is said to be constant in a cell is.
    ConstantGradient,
    /// `integrate_cells` and `integrate_conserved_cells` stream what all cells together do.
    CellsStreamTheSame,
    /// The library's fits of four cells at once stream what one cell after another does.
    FourStreamTheSame,
    /// `COUPLED = false` is said only where a phase does nothing.
    CoupledAsSaid,
    /// Without data of a phase the total stress is the effective one.
    EffectiveStress,
    /// The total stress is affine in the effective one.
    AffineStress,
    /// The porosity lies between 0 and 1.
    Porosity,
    /// A particle has the liquid that it was given.
    LiquidRoundTrip,
    /// `accelerate_liquid` adds to the velocity of the liquid, and changes nothing else.
    AcceleratesLiquid,
    /// Strain changes the pressure of the liquid, not its velocity.
    StrainKeepsVelocity,
    /// The mass of the liquid is not negative, and proportional to the volume.
    LiquidMass,
    /// The drag is not negative, and proportional to the volume if the mass is.
    Drag,
    /// Solid and liquid change the pressure by their shares of the volume.
    FlowShares,
    /// Pressure over change of volume is `liquid_stiffness`.
    LiquidStiffness,
    /// The energy of the liquid is the work of its pressure.
    LiquidEnergy,
    /// What the liquid adds to the stress works as much as the energy of the liquid grows.
    PoreStressIsWork,
    /// A uniform motion stays one, and what particles remember of it adds nothing.
    UniformVelocity,
    /// The momentum of the particles is that of the DOFs.
    TransferKeepsMomentum,
    /// A velocity that is a linear function of place comes back as it was.
    LinearVelocity,
    /// The capacity for what diffuses is positive, and proportional to mass and volume.
    Capacity,
    /// `add_to_value` adds to the value of a particle.
    AddsToValue,
    /// There is no flux without a gradient, and none towards higher values: entropy does not fall.
    FluxOpposesGradient,
    /// Flux over gradient is at most `diffusivity` times the capacity per volume.
    Diffusivity,
}

impl fmt::Display for Property {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let words = match self {
            Self::PointsInGrid => "points lie in the grid",
            Self::DofInRange => "DOF numbers are below the number of DOFs",
            Self::SameDofsInCell => "all points of a cell see the same DOFs in the same order",
            Self::DofWindow => "the DOFs of a cell are in its window",
            Self::PartitionOfUnity => "values sum to one",
            Self::NonNegative => "values are not negative",
            Self::GradientSum => "gradients sum to zero",
            Self::FaceValues => "values on a face belong to the face's DOFs",
            Self::HalfBand => "DOFs that overlap are within the half band width",
            Self::EveryDofReached => "every DOF has a value somewhere",
            Self::Continuous => "values are continuous from cell to cell",
            Self::DegreeAsSaid => "`degree` is the degree that is reproduced",
            Self::FixedPointValues => "points that stand still see the same values",
            Self::GradientsAreDerivatives => "gradients are the derivatives of the values",
            Self::FixedPointGradients => "gradients at fixed points are the derivatives of the values",
            Self::Reproduces(degree) => return write!(f, "polynomials of degree {degree} are reproduced"),
            Self::GradientOfLinearField => "the gradient of a linear field is exact",
            Self::StreamInCell => "stream points lie in their cells",
            Self::SamePoints => "every field is streamed at the same points",
            Self::StreamsParticles => "the stream points are the particles where the type says so",
            Self::Linear => "streaming is linear in the field",
            Self::PrepareForgets => "prepare forgets earlier particles",
            Self::Weights => "weights sum to the volume that they integrate",
            Self::ConservesAmounts => "each cell's amounts are kept",
            Self::Integrates(degree) => {
                return write!(
                    f,
                    "integrals over cells are exact for polynomials of degree {degree}"
                );
            }
            Self::Unstressed => "the undeformed state has neither stress nor energy",
            Self::ZeroIncrement => "an increment of zero changes nothing",
            Self::SymmetricStress => "stress is symmetric",
            Self::LinearForSmallIncrements => "stress is linear in small increments",
            Self::WaveSpeed => "density * wave_speed^2 is the stiffness of uniaxial strain",
            Self::EnergyIsWork => "the change of energy is the work of the stress",
            Self::RotationKeepsEnergy => "a rotation produces no energy",
            Self::Objective => "stress follows a rotation",
            Self::EnergyAtSmallStrain => "at small strain the energy is the work of the stress",
            Self::ElasticConstants => "the stiffness at rest is that of the elastic constants",
            Self::StrainForChange => "the strain for a change of stress makes about that change",
            Self::StartKeepsStress => "a state made for a stress keeps it",
            Self::KnowsItsStress => "the law knows the stresses that it gives",
            Self::NoEnergyFromNothing => "no more energy comes out than was put in",
            Self::UpdateIsALimit => "`update` is the response to slow or to fast strain",
            Self::Stable => "stress does not fall while strain grows",
            Self::Factors => "`factors` gives the values and gradients of `for_each`",
            Self::FixedPointsAsSaid => "AT_FIXED_POINTS says what points that stand still see",
            Self::VanishingDomain => "over a domain that vanishes a particle is a point",
            Self::ConstantGradient => "a gradient said to be constant in a cell is",
            Self::CellsStreamTheSame => "cells streamed alone stream what all together do",
            Self::FourStreamTheSame => "four cells at once stream what one after another does",
            Self::CoupledAsSaid => "COUPLED says whether a phase does anything",
            Self::EffectiveStress => "without data the total stress is the effective one",
            Self::AffineStress => "the total stress is affine in the effective one",
            Self::Porosity => "the porosity lies between 0 and 1",
            Self::LiquidRoundTrip => "a particle has the liquid that it was given",
            Self::AcceleratesLiquid => "`accelerate_liquid` adds to the velocity alone",
            Self::StrainKeepsVelocity => "strain keeps the velocity of the liquid",
            Self::LiquidMass => "the liquid's mass is proportional to the volume",
            Self::Drag => "the drag is proportional to the volume",
            Self::FlowShares => "solid and liquid change the pressure by their shares of the volume",
            Self::LiquidStiffness => "pressure over change of volume is `liquid_stiffness`",
            Self::LiquidEnergy => "the liquid's energy is the work of its pressure",
            Self::UniformVelocity => "a uniform motion comes back from the grid as it was",
            Self::TransferKeepsMomentum => "particles have the momentum of the DOFs",
            Self::LinearVelocity => "a linear velocity comes back from the grid as it was",
            Self::PoreStressIsWork => "what the liquid adds to the stress works as its energy grows",
            Self::Capacity => "the capacity is positive and proportional to mass and volume",
            Self::AddsToValue => "`add_to_value` adds to the value",
            Self::FluxOpposesGradient => {
                "what diffuses flows against its gradient, and without one not at all"
            }
            Self::Diffusivity => "flux over gradient is within the diffusivity",
        };
        f.write_str(words)
    }
}

/// Where a property was looked at.
#[derive(Clone, Debug, PartialEq)]
pub enum Place {
    /// Over all points together.
    Everywhere,
    /// At a position (m).
    Point(Vec<f64>),
    /// For one DOF, at a position (m).
    Dof {
        /// Number of the DOF.
        dof: usize,
        /// Where (m).
        position: Vec<f64>,
    },
    /// In a cell.
    Cell(Vec<u32>),
    /// In a component of the stress or along an axis of the strain: row and column.
    Component(usize, usize),
}

impl Place {
    pub(super) fn point<T: Scalar, const D: usize>(x: &SVector<T, D>) -> Self {
        Self::Point(x.iter().map(|v| v.primal()).collect())
    }

    pub(super) fn dof<T: Scalar, const D: usize>(dof: usize, x: &SVector<T, D>) -> Self {
        let position = x.iter().map(|v| v.primal()).collect();
        Self::Dof { dof, position }
    }

    pub(super) fn cell<const D: usize>(cell: &Cell<D>) -> Self {
        Self::Cell(cell.to_vec())
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Everywhere => f.write_str("everywhere"),
            Self::Point(position) => write!(f, "at {position:?}"),
            Self::Dof { dof, position } => write!(f, "DOF {dof} at {position:?}"),
            Self::Cell(cell) => write!(f, "in cell {cell:?}"),
            Self::Component(row, column) => write!(f, "component ({row}, {column})"),
        }
    }
}

/// What a check expected.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Expected {
    /// This value, up to a difference that round-off or the size of an increment explains.
    Near {
        /// The value.
        value: f64,
        /// The largest difference.
        allowed: f64,
    },
    /// At least this much.
    AtLeast(f64),
    /// A deviation of at least this many times what round-off explains, because the claim is that the
    /// property does *not* hold; what was found is the largest such multiple.
    Violation {
        /// Multiple of round-off.
        times: f64,
    },
}

impl fmt::Display for Expected {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Near { value, allowed } => write!(f, "{value:e} within {allowed:e}"),
            Self::AtLeast(bound) => write!(f, "at least {bound:e}"),
            Self::Violation { times } => write!(f, "a deviation of at least {times} times round-off"),
        }
    }
}

/// `found = value` within `allowed`; a NaN fails.
pub(super) fn near<T: Scalar>(
    property: Property,
    place: impl FnOnce() -> Place,
    value: T,
    found: T,
    allowed: T,
) -> Result<(), Failure> {
    if (found - value).abs() <= allowed {
        return Ok(());
    }
    Err(Failure {
        property,
        place: place(),
        expected: Expected::Near {
            value: value.primal(),
            allowed: allowed.primal(),
        },
        found: found.primal(),
    })
}

/// `found >= bound`; a NaN fails.
pub(super) fn at_least<T: Scalar>(
    property: Property,
    place: impl FnOnce() -> Place,
    bound: T,
    found: T,
) -> Result<(), Failure> {
    if found >= bound {
        return Ok(());
    }
    Err(Failure {
        property,
        place: place(),
        expected: Expected::AtLeast(bound.primal()),
        found: found.primal(),
    })
}
