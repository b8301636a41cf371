//! What a body starts with: expressions of the scene, or the state of a reference; at the particles or
//! interpolated.

use nalgebra::{SMatrix, SVector};

use super::error::RunError;
use super::reference::{Solution, solution};
use crate::scene::{Body, Expression, Initialise, Scene};
use materialpoint::basis::{BasisFamily, Interpolant};
use materialpoint::grid::Grid;
use materialpoint::method::MethodVisitor;
use materialpoint::particles::Particles;
use materialpoint::phase::PoreLiquid;
use materialpoint::reconstruction::Reconstruction;
use materialpoint::reference::two_phase::{TwoPhaseReference, TwoPhaseState};

/// Fields at one place; one phase has no liquid.
#[derive(Clone, Copy, Debug)]
pub struct Values<const D: usize> {
    pub(super) displacement: SVector<f64, D>,
    pub(super) velocity: SVector<f64, D>,
    pub(super) stress: SMatrix<f64, D, D>,
    pub(super) liquid_velocity: SVector<f64, D>,
    pub(super) pore_pressure: f64,
}

impl<const D: usize> Values<D> {
    pub(super) fn liquid(&self) -> PoreLiquid<f64, D> {
        PoreLiquid {
            velocity: self.liquid_velocity,
            pressure: self.pore_pressure,
        }
    }
}

impl Values<1> {
    fn to_vector(self) -> SVector<f64, 5> {
        SVector::from([
            self.displacement[0],
            self.velocity[0],
            self.stress[(0, 0)],
            self.liquid_velocity[0],
            self.pore_pressure,
        ])
    }
}

impl From<SVector<f64, 5>> for Values<1> {
    fn from(values: SVector<f64, 5>) -> Self {
        let [displacement, velocity, stress, liquid_velocity, pore_pressure] = values.into();
        Self {
            displacement: [displacement].into(),
            velocity: [velocity].into(),
            stress: [stress].into(),
            liquid_velocity: [liquid_velocity].into(),
            pore_pressure,
        }
    }
}

impl From<TwoPhaseState> for Values<1> {
    fn from(state: TwoPhaseState) -> Self {
        Self {
            displacement: [state.solid_displacement].into(),
            velocity: [state.solid_velocity].into(),
            stress: [state.effective_stress].into(),
            liquid_velocity: [state.liquid_velocity].into(),
            pore_pressure: state.pore_pressure,
        }
    }
}

/// Gives particle `p` its values. A displacement that it starts with is only remembered: it stays at its
/// material point, as small strain has it.
pub(super) fn set<const D: usize>(particles: &mut Particles<f64, D>, p: usize, values: &Values<D>) {
    particles.displacement[p] = values.displacement;
    particles.velocity[p] = values.velocity;
    particles.stress[p] = values.stress;
}

/// The initial state of a body as a function of position.
pub type InitialState<'a, const D: usize> = Box<dyn Fn(&SVector<f64, D>) -> Result<Values<D>, RunError> + 'a>;

/// That of one dimension.
pub(super) fn on_one_axis<'a>(
    scene: &Scene,
    body: &'a Body,
    grid: &Grid<f64, 1>,
) -> Result<InitialState<'a, 1>, RunError> {
    let source = Source::new(scene, body)?;
    if body.initialise == Initialise::Exact {
        return Ok(Box::new(move |x| source.at(x)));
    }
    let method = scene.method.method();
    let field = method.dispatch(AtDofs { grid, source });
    field.unwrap_or(Err(RunError::NoSuchMethod(method)))
}

/// The values that the expressions of `body` have at `x` (m).
pub(super) fn by_expressions<const D: usize>(
    body: &Body,
    x: &SVector<f64, D>,
) -> Result<Values<D>, RunError> {
    let point = x.as_slice();
    let vector = |expressions: &Option<Vec<Expression>>| -> Result<Option<SVector<f64, D>>, RunError> {
        let Some(expressions) = expressions else {
            return Ok(None);
        };
        let mut value = SVector::<f64, D>::zeros();
        for (component, expression) in value.iter_mut().zip(expressions) {
            *component = expression.eval_at(point)?;
        }
        Ok(Some(value))
    };
    let velocity = vector(&body.velocity)?.unwrap_or_else(SVector::zeros);
    let mut stress = SMatrix::<f64, D, D>::zeros();
    for (place, expression) in body.stress.iter().flat_map(|stress| &stress.components) {
        let value = expression.eval_at(point)?;
        for place in [(place[0], place[1]), (place[1], place[0])] {
            if let Some(component) = stress.get_mut(place) {
                *component = value;
            }
        }
    }
    Ok(Values {
        displacement: SVector::zeros(),
        velocity,
        stress,
        liquid_velocity: vector(&body.liquid_velocity)?.unwrap_or(velocity),
        pore_pressure: match &body.pore_pressure {
            Some(expression) => expression.eval_at(point)?,
            None => 0.0,
        },
    })
}

/// Where the values come from.
enum Source<'a> {
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

    fn at(&self, x: &SVector<f64, 1>) -> Result<Values<1>, RunError> {
        match self {
            Self::Reference(solution) => Ok(solution.at(x[0]).into()),
            Self::Expressions(body) => by_expressions(body, x),
        }
    }
}

/// Interpolates once the basis is a type.
struct AtDofs<'a, 'g> {
    grid: &'g Grid<f64, 1>,
    source: Source<'a>,
}

impl<'a> MethodVisitor<f64> for AtDofs<'a, '_> {
    type Output = Result<InitialState<'a, 1>, RunError>;

    fn visit<B, R>(self, basis: B, _reconstruction: R) -> Self::Output
    where
        B: BasisFamily<f64, 1> + Send + 'static,
        R: Reconstruction<f64, 1> + Clone + Send + 'static,
    {
        let grid = self.grid.clone();
        let field = Interpolant::<f64, 5>::new(&basis, &grid, |x| self.source.at(x).map(Values::to_vector))?;
        Ok(Box::new(move |x| Ok(field.at(&basis, &grid, x).into())))
    }
}
