//! Functions and constants of expressions.

use std::f64::consts;

/// Constants by name.
pub(super) const CONSTANTS: [(&str, f64); 2] = [("pi", consts::PI), ("e", consts::E)];

/// A function of one argument.
pub(super) type Unary = fn(f64) -> f64;
/// A function of two arguments.
pub(super) type Binary = fn(f64, f64) -> f64;

/// Functions of one argument by name.
pub(super) const UNARY: [(&str, Unary); 18] = [
    ("abs", f64::abs),
    ("sign", sign),
    ("floor", f64::floor),
    ("ceil", f64::ceil),
    ("sqrt", f64::sqrt),
    ("cbrt", f64::cbrt),
    ("exp", f64::exp),
    ("ln", f64::ln),
    ("log10", f64::log10),
    ("sin", f64::sin),
    ("cos", f64::cos),
    ("tan", f64::tan),
    ("asin", f64::asin),
    ("acos", f64::acos),
    ("atan", f64::atan),
    ("sinh", f64::sinh),
    ("cosh", f64::cosh),
    ("tanh", f64::tanh),
];

/// Functions of two arguments by name.
pub(super) const BINARY: [(&str, Binary); 3] = [("min", min), ("max", max), ("atan2", f64::atan2)];

/// -1, 0 or 1 (`f64::signum` gives 1 for 0).
fn sign(x: f64) -> f64 {
    if x == 0.0 { 0.0 } else { x.signum() }
}

/// The lesser one; not a number if either is not (`f64::min` would hide it).
fn min(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() {
        f64::NAN
    } else {
        a.min(b)
    }
}

/// The greater one; not a number if either is not.
fn max(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() {
        f64::NAN
    } else {
        a.max(b)
    }
}

/// The entry of that name.
pub(super) fn entry<T: Copy>(table: &[(&'static str, T)], name: &str) -> Option<(&'static str, T)> {
    table.iter().find(|entry| entry.0 == name).copied()
}

/// What belongs to that name.
pub(super) fn find<T: Copy>(table: &[(&'static str, T)], name: &str) -> Option<T> {
    entry(table, name).map(|entry| entry.1)
}

/// Names of all functions.
pub(super) fn names() -> String {
    let unary = UNARY.iter().map(|entry| entry.0);
    let all: Vec<_> = unary.chain(BINARY.iter().map(|entry| entry.0)).collect();
    all.join(", ")
}
