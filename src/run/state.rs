//! What a body starts with: expressions of the scene, or the state of a reference; at the particles or interpolated.

use nalgebra::SVector;

use super::error::RunError;
use super::reference::{Solution, solution};
use crate::basis::{BasisFamily, Interpolant};
use crate::grid::Grid;
use crate::method::MethodVisitor;
use crate::particles::Particles;
use crate::phase::PoreLiquid;
use crate::reconstruction::Reconstruction;
use crate::reference::two_phase::{TwoPhaseReference, TwoPhaseState};
use crate::scene::{Body, Expression, Initialise, Scene};

/// Fields at one place; one phase has no liquid.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Values {
    displacement: f64,
    velocity: f64,
    stress: f64,
    liquid_velocity: f64,
    pore_pressure: f64,
}

impl Values {
    pub(super) fn liquid(&self) -> PoreLiquid<f64, 1> {
        PoreLiquid {
            velocity: SVector::from([self.liquid_velocity]),
            pressure: self.pore_pressure,
        }
    }

    fn to_vector(self) -> SVector<f64, 5> {
        SVector::from([
            self.displacement,
            self.velocity,
            self.stress,
            self.liquid_velocity,
            self.pore_pressure,
        ])
    }
}

impl From<SVector<f64, 5>> for Values {
    fn from(values: SVector<f64, 5>) -> Self {
        let [displacement, velocity, stress, liquid_velocity, pore_pressure] = values.into();
        Self {
            displacement,
            velocity,
            stress,
            liquid_velocity,
            pore_pressure,
        }
    }
}

impl From<TwoPhaseState> for Values {
    fn from(state: TwoPhaseState) -> Self {
        Self {
            displacement: state.solid_displacement,
            velocity: state.solid_velocity,
            stress: state.effective_stress,
            liquid_velocity: state.liquid_velocity,
            pore_pressure: state.pore_pressure,
        }
    }
}

/// Gives particle `p` its values. A displacement that it starts with is only remembered: it stays at its material point, as
/// small strain has it.
pub(super) fn set(particles: &mut Particles<f64, 1>, p: usize, values: &Values) {
    particles.displacement[p][0] = values.displacement;
    particles.velocity[p][0] = values.velocity;
    particles.stress[p][(0, 0)] = values.stress;
}

/// The initial state of a body as a function of position.
pub(super) enum InitialState<'a> {
    Exact(Source<'a>),
    Interpolated(Box<dyn Fn(f64) -> Values>),
}

impl<'a> InitialState<'a> {
    pub(super) fn new(scene: &Scene, body: &'a Body, grid: &Grid<f64, 1>) -> Result<Self, RunError> {
        let source = Source::new(scene, body)?;
        if body.initialise == Initialise::Exact {
            return Ok(Self::Exact(source));
        }
        let method = scene.method.method();
        let field = method.dispatch(AtDofs { grid, source });
        field
            .unwrap_or(Err(RunError::NoSuchMethod(method)))
            .map(Self::Interpolated)
    }

    /// The state at `x` (m).
    pub(super) fn at(&self, x: f64) -> Result<Values, RunError> {
        match self {
            Self::Exact(source) => source.at(x),
            Self::Interpolated(field) => Ok(field(x)),
        }
    }
}

/// Where the values come from.
pub(super) enum Source<'a> {
    Expressions(&'a Body),
    Reference(Box<dyn TwoPhaseReference>),
}

impl<'a> Source<'a> {
    fn new(scene: &Scene, body: &'a Body) -> Result<Self, RunError> {
        let given = scene
            .reference
            .filter(|reference| reference.gives_initial_state());
        let Some(reference) = given else {
            return Ok(Self::Expressions(body));
        };
        match solution(scene)? {
            Some(Solution::Two(mut solution)) => {
                solution.advance(reference.start())?;
                Ok(Self::Reference(solution))
            }
            _ => Ok(Self::Expressions(body)),
        }
    }

    fn at(&self, x: f64) -> Result<Values, RunError> {
        let body = match self {
            Self::Reference(solution) => return Ok(solution.at(x).into()),
            Self::Expressions(body) => body,
        };
        let value = |expression: Option<&Expression>| match expression {
            Some(expression) => expression.eval_at(&[x]),
            None => Ok(0.0),
        };
        let along = |vector: &'a Option<Vec<Expression>>| vector.as_ref().and_then(|v| v.first());
        let velocity = value(along(&body.velocity))?;
        Ok(Values {
            displacement: 0.0,
            velocity,
            stress: value(body.stress.as_ref())?,
            liquid_velocity: match along(&body.liquid_velocity) {
                Some(expression) => expression.eval_at(&[x])?,
                None => velocity,
            },
            pore_pressure: value(body.pore_pressure.as_ref())?,
        })
    }
}

/// Interpolates once the basis is a type.
struct AtDofs<'a> {
    grid: &'a Grid<f64, 1>,
    source: Source<'a>,
}

impl MethodVisitor<f64> for AtDofs<'_> {
    type Output = Result<Box<dyn Fn(f64) -> Values>, RunError>;

    fn visit<B, R>(self, basis: B, _reconstruction: R) -> Self::Output
    where
        B: BasisFamily<f64, 1> + Send + 'static,
        R: Reconstruction<f64, 1> + Clone + Send + 'static,
    {
        let grid = self.grid.clone();
        let field =
            Interpolant::<f64, 5>::new(&basis, &grid, |x| self.source.at(x[0]).map(Values::to_vector))?;
        Ok(Box::new(move |x| {
            field.at(&basis, &grid, &SVector::from([x])).into()
        }))
    }
}
