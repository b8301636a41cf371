//! Expressions of a scene, such as `0.8*sin(pi*x)`.

mod error;
mod functions;
mod parser;

pub use error::{ExpressionError, ExpressionProblem};

use parser::{Operation, compile};

use super::text::{quote, shorten};

/// Names of the coordinates.
pub(super) const COORDINATES: [&str; 3] = ["x", "y", "z"];

/// A formula read once and evaluated often.
///
/// Numbers (`2`, `0.5`, `1e-4`), the variables it was read with, the constants `pi` and `e`, `+ - * / ^`,
/// parentheses and the functions `abs sign floor ceil sqrt cbrt exp ln log10 sin cos tan asin acos atan sinh
/// cosh tanh`, `min max atan2` (two arguments each). As in mathematics `-x^2` is `-(x^2)` and `2^3^2` is
/// `2^(3^2)`.
#[derive(Clone, Debug)]
pub struct Expression {
    origin: String,
    variables: Vec<String>,
    program: Vec<Operation>,
}

impl Expression {
    /// Reads `text`, which may use the given variables.
    ///
    /// # Errors
    /// If it is not a formula or uses another name.
    pub fn parse(text: &str, variables: &[&str]) -> Result<Self, ExpressionError> {
        Self::read(format!("expression {}", quote(text)), text, variables)
    }

    /// As [`Expression::parse`]; errors name the key of the scene.
    ///
    /// # Errors
    /// As [`Expression::parse`].
    pub fn parse_key(key: &str, text: &str, variables: &[&str]) -> Result<Self, ExpressionError> {
        Self::read(format!("{} = {}", shorten(key), quote(text)), text, variables)
    }

    /// Where it was written, and how: `KEY = "TEXT"`.
    pub(crate) fn origin(&self) -> &str {
        &self.origin
    }

    fn read(origin: String, text: &str, variables: &[&str]) -> Result<Self, ExpressionError> {
        match compile(text, variables) {
            Ok(program) => Ok(Self {
                origin,
                variables: variables.iter().map(ToString::to_string).collect(),
                program,
            }),
            Err(problem) => Err(ExpressionError { origin, problem }),
        }
    }

    /// The value where the variables, in the order of [`Expression::parse`], have the given values. A
    /// variable without a value counts as not a number.
    ///
    /// # Errors
    /// If the result is infinite or not a number.
    pub fn eval(&self, values: &[f64]) -> Result<f64, ExpressionError> {
        let value = self.compute(values);
        if value.is_finite() {
            return Ok(value);
        }
        Err(ExpressionError {
            origin: self.origin.clone(),
            problem: ExpressionProblem::NotFinite {
                value,
                at: self.describe(values),
            },
        })
    }

    /// The value at the position `x` (m), for an expression in `x`, `y`, `z`.
    ///
    /// # Errors
    /// As [`Expression::eval`].
    pub fn eval_at(&self, x: &[f64]) -> Result<f64, ExpressionError> {
        self.eval(x)
    }

    /// The value at the time `t` (s), for an expression in `t`.
    ///
    /// # Errors
    /// As [`Expression::eval`].
    pub fn eval_time(&self, t: f64) -> Result<f64, ExpressionError> {
        self.eval(&[t])
    }

    /// The value of a formula without variables; `None` of any other.
    pub fn constant(&self) -> Option<f64> {
        let varies = |operation: &Operation| matches!(operation, Operation::Variable(_));
        (!self.program.iter().any(varies)).then(|| self.compute(&[]))
    }

    /// Whether it is zero whatever the variables are, as `0` and `-2 * 0` are.
    pub(crate) fn is_zero(&self) -> bool {
        self.constant() == Some(0.0)
    }

    /// Runs the program on a stack. The compiler leaves no operation without its operands; a missing one
    /// would count as not a number.
    fn compute(&self, values: &[f64]) -> f64 {
        let mut stack = Vec::with_capacity(8);
        for operation in &self.program {
            let result = match *operation {
                Operation::Number(number) => number,
                Operation::Variable(index) => values.get(index).copied().unwrap_or(f64::NAN),
                Operation::Unary(_, function) => function(pop(&mut stack)),
                Operation::Binary(_, function) => {
                    let right = pop(&mut stack);
                    function(pop(&mut stack), right)
                }
            };
            stack.push(result);
        }
        pop(&mut stack)
    }

    fn describe(&self, values: &[f64]) -> String {
        let pairs = self.variables.iter().zip(values);
        let pairs: Vec<_> = pairs.map(|(name, value)| format!("{name} = {value:?}")).collect();
        pairs.join(", ")
    }
}

fn pop(stack: &mut Vec<f64>) -> f64 {
    stack.pop().unwrap_or(f64::NAN)
}

/// The coordinates of a space: `x`; `x`, `y`; or `x`, `y`, `z`.
pub(super) fn coordinates(dimension: usize) -> &'static [&'static str] {
    COORDINATES.get(..dimension).unwrap_or(&COORDINATES)
}

#[cfg(test)]
mod tests;
