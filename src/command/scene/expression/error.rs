//! What is wrong with an expression.

use thiserror::Error;

/// An expression that cannot be read or has no finite value.
#[derive(Clone, Debug, Error, PartialEq)]
#[error("{origin}: {problem}")]
pub struct ExpressionError {
    /// The expression, with the key of the scene where it comes from one.
    pub origin: String,
    /// What is wrong.
    pub problem: ExpressionProblem,
}

/// What can be wrong with an expression. Columns count characters from 1.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum ExpressionProblem {
    /// It ends too early.
    #[error("the expression ends where {expected} is expected")]
    Ends {
        /// What should follow.
        expected: &'static str,
    },
    /// A character that does not belong there.
    #[error("unexpected '{found}' at column {column} where {expected} is expected")]
    Unexpected {
        /// The character.
        found: String,
        /// Where it is.
        column: usize,
        /// What should be there.
        expected: &'static str,
    },
    /// A variable that does not exist there.
    #[error("unknown name '{name}'; allowed: {allowed}")]
    UnknownName {
        /// The name.
        name: String,
        /// Variables and constants.
        allowed: String,
    },
    /// A function that does not exist.
    #[error("unknown function '{name}'; allowed: {allowed}")]
    UnknownFunction {
        /// The name.
        name: String,
        /// All functions.
        allowed: String,
    },
    /// A function without its parentheses.
    #[error("'{name}' is a function; expected {name}(...)")]
    NoArguments {
        /// The name.
        name: String,
    },
    /// A number beyond the range of an `f64`.
    #[error("the number {number} is too large; allowed: up to 1.79e308")]
    TooLarge {
        /// As it was written.
        number: String,
    },
    /// Too long or too deeply nested.
    #[error("the expression is too {what}; allowed: {allowed}")]
    TooMuch {
        /// `long` or `deeply nested`.
        what: &'static str,
        /// The limit.
        allowed: &'static str,
    },
    /// The value is infinite or not a number.
    #[error("the value is {value} at {at}; it must be finite there")]
    NotFinite {
        /// The value.
        value: f64,
        /// Values of the variables.
        at: String,
    },
}
