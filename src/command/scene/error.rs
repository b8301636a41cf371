//! What is wrong with a scene: the key, the value, and what is allowed.

use thiserror::Error;

use super::ExpressionError;

/// Why a scene cannot be used. Every message is one line and names the full key, as `--set` takes it
/// (`body.0.jitter`; the first body is 0).
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum SceneError {
    /// The file cannot be read.
    #[error("cannot read the scene {path}: {reason}")]
    File {
        /// The file.
        path: String,
        /// What the operating system says.
        reason: String,
    },
    /// The text is not TOML.
    #[error("line {line}, column {column}: {reason}, in the line {excerpt:?}")]
    Syntax {
        /// Line, from 1.
        line: usize,
        /// Column in characters, from 1.
        column: usize,
        /// What the TOML parser says.
        reason: String,
        /// The line at fault.
        excerpt: String,
    },
    /// A `KEY=VALUE` that cannot be applied.
    #[error("--set {text}: {reason}")]
    Override {
        /// What was given.
        text: String,
        /// What is wrong with it.
        reason: String,
    },
    /// A key that no scene has.
    #[error("{key} is not a key of a scene; allowed here: {allowed}")]
    UnknownKey {
        /// The key.
        key: String,
        /// The keys of the same table.
        allowed: String,
    },
    /// A key that every scene needs.
    #[error("{key} is missing; expected {expected}")]
    Missing {
        /// The key.
        key: String,
        /// What it takes.
        expected: String,
    },
    /// A value of the wrong type.
    #[error("{key} = {value} is {found}; expected {expected}")]
    WrongType {
        /// The key.
        key: String,
        /// Its value.
        value: String,
        /// Type of the value.
        found: &'static str,
        /// What the key takes.
        expected: String,
    },
    /// A value out of range, or a name that does not exist.
    #[error("{key} = {value} is not allowed; expected {expected}")]
    NotAllowed {
        /// The key.
        key: String,
        /// Its value.
        value: String,
        /// What the key takes.
        expected: String,
    },
    /// Part of the scene language, but not of this version.
    #[error("{key} = {value} is not possible in this version; expected {expected}")]
    NotInThisVersion {
        /// The key.
        key: String,
        /// Its value.
        value: String,
        /// What this version takes.
        expected: String,
    },
    /// A value that does not go together with the rest of the scene.
    #[error("{key} = {value}: {problem}")]
    Conflict {
        /// The key.
        key: String,
        /// Its value.
        value: String,
        /// What it does not go with, and what is allowed.
        problem: String,
    },
    /// An expression that cannot be read or has no finite value.
    #[error(transparent)]
    Expression(#[from] ExpressionError),
}
