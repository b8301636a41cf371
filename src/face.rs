//! The faces of the grid's box.

use std::fmt;

/// Which end of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Side {
    /// The lower end.
    Min,
    /// The upper end.
    Max,
}

/// One face of the box: an axis and its end, written `x-min`, `y-max`, ...
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Face {
    /// Axis the face is perpendicular to.
    pub axis: usize,
    /// End of that axis.
    pub side: Side,
}

impl Face {
    /// Every face of a `D`-dimensional box.
    pub fn all<const D: usize>() -> impl Iterator<Item = Self> {
        (0..D).flat_map(|axis| [Side::Min, Side::Max].map(|side| Self { axis, side }))
    }
}

impl fmt::Display for Face {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let axis = ["x", "y", "z"].get(self.axis).unwrap_or(&"?");
        let side = match self.side {
            Side::Min => "min",
            Side::Max => "max",
        };
        write!(f, "{axis}-{side}")
    }
}
