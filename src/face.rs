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
        // One map of numbers: what walks over faces is compiled hundreds of times.
        (0..2 * D).map(Self::numbered)
    }

    /// The face with a number in the order of [`Face::all`].
    fn numbered(number: usize) -> Self {
        let side = if number.is_multiple_of(2) {
            Side::Min
        } else {
            Side::Max
        };
        Self {
            axis: number / 2,
            side,
        }
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
