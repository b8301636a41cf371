//! Where maps of one region lie on a page.

use super::super::frame::{Frame, GAP, Labelled, widest, x_ticks, y_ticks};
use super::super::panel::no_data;
use super::super::scale::{Scale, drawable};
use super::super::style::{INK, LABEL, TITLE};
use super::super::svg::{Anchor, Canvas, Font};
use super::super::text;
use super::bar::LEAST_HEIGHT;

const EDGE: f64 = 24.0;
const TOP: f64 = 82.0;
const BELOW: f64 = 60.0;
/// From one map to the next (px), its name above included.
const GUTTER: (f64, f64) = (30.0, 42.0);
/// No map is wider or higher (px).
const LARGEST: (f64, f64) = (760.0, 460.0);
/// No map is thinner (px), even if its scales then differ.
const THINNEST: f64 = 4.0;

/// A corner with the lowest coordinates and its opposite (m).
pub(super) type Bounds = [[f64; 2]; 2];

/// What is to be placed.
pub(super) struct Wanted {
    pub maps: usize,
    /// Beside each map for its colour bar (px).
    pub beside: f64,
    /// Beside all maps (px).
    pub beside_all: f64,
    /// Widest name above a map (px).
    pub name: f64,
    /// Lowest height of a row (px).
    pub row: f64,
    /// Width and height for all maps (px).
    pub room: (f64, f64),
}

/// The page.
pub(super) struct Sheet {
    maps: usize,
    columns: usize,
    size: (f64, f64),
    stride: (f64, f64),
    left: f64,
    right: f64,
    x: Scale,
    y: Scale,
    /// Names of the axes.
    names: [&'static str; 2],
}

impl Sheet {
    /// Maps as large as they fit, with equal scales, in as many columns as that takes.
    pub fn new(wanted: &Wanted, x: Scale, y: Scale) -> Sheet {
        let aspect = aspect(&x, &y);
        let (columns, width) = arrange(wanted, aspect);
        let size = (width.max(THINNEST), (width / aspect).max(THINNEST));
        let cell = (size.0 + wanted.beside).max(wanted.name) + GUTTER.0;
        let labels = widest(&y_ticks(&y, size.1));
        Sheet {
            maps: wanted.maps.max(1),
            columns,
            size,
            stride: (cell, size.1.max(wanted.row) + GUTTER.1),
            left: EDGE + LABEL + GAP + labels + GAP,
            right: wanted.beside_all + EDGE,
            x,
            y,
            names: ["x", "y"],
        }
    }

    /// Other names of the axes; an empty one changes nothing.
    pub fn with_names(mut self, names: [&'static str; 2]) -> Sheet {
        for (own, name) in self.names.iter_mut().zip(names) {
            if !name.is_empty() {
                *own = name;
            }
        }
        self
    }

    /// Width of a map and what stands beside it (px).
    pub fn cell(&self) -> f64 {
        self.stride.0 - GUTTER.0
    }

    /// The frame of a map.
    pub fn frame(&self, i: usize) -> Frame {
        let (row, column) = (i / self.columns, i % self.columns);
        Frame {
            left: self.left + self.stride.0 * column as f64,
            top: TOP + self.stride.1 * row as f64,
            width: self.size.0,
            height: self.size.1,
            x: self.x,
            y: self.y,
        }
    }

    /// Right of all maps (px).
    pub fn beside(&self) -> f64 {
        self.left + self.stride.0 * self.columns as f64
    }

    /// The page with its title and the names of the axes.
    pub fn canvas(&self, title: &str) -> Canvas {
        let maps = self.beside() + self.right - GUTTER.0;
        let width = maps.max((text::width(title, TITLE) + 2.0 * EDGE).min(LARGEST.0));
        let rows = self.maps.div_ceil(self.columns);
        let maps = self.stride.1 * rows as f64 - GUTTER.1;
        let height = TOP + maps.max(LEAST_HEIGHT) + BELOW;
        let mut canvas = Canvas::new(width, height, title);
        let (title, size) = text::fit(title, TITLE, width - 2.0 * EDGE);
        canvas.text((EDGE, 34.0), &title, Font::new(size, INK, Anchor::Start).bold());
        canvas
    }

    /// Says in the first frame that there is no map.
    pub fn draw_none(&self, canvas: &mut Canvas) {
        self.frame(0).outline(canvas);
        no_data(canvas, &self.frame(0));
    }

    /// Draws what lies behind the particles of a map; the outer maps bear the labels and names of the axes.
    pub fn draw_axes(&self, canvas: &mut Canvas, i: usize) {
        let frame = self.frame(i);
        let labelled = Labelled {
            x: i + self.columns >= self.maps,
            y: i.is_multiple_of(self.columns),
        };
        frame.draw(canvas, labelled);
        let font = Font::new(LABEL, INK, Anchor::Middle);
        if labelled.x {
            let name = text::with_unit(self.names[0], "m", x_ticks(&self.x, frame.width).exponent);
            let at = (frame.left + 0.5 * frame.width, frame.bottom() + 44.0);
            canvas.text(at, &name, font);
        }
        if labelled.y {
            let name = text::with_unit(self.names[1], "m", y_ticks(&self.y, frame.height).exponent);
            let at = (EDGE + 0.3 * LABEL, frame.top + 0.5 * frame.height);
            canvas.text(at, &name, font.upright());
        }
    }
}

/// Both axes of a region; where it has no size, of the points.
pub(super) fn axes(bounds: &[Bounds], points: &[&[[f64; 2]]]) -> (Scale, Scale) {
    let axis = |k: usize| {
        let pick = move |place: &[f64; 2]| place.get(k).copied().unwrap_or(f64::NAN);
        let ends: Vec<f64> = bounds.iter().flatten().map(pick).collect();
        if ends.iter().any(|end| drawable(*end)) {
            return Scale::linear(ends.into_iter(), 0.0);
        }
        Scale::linear(points.iter().copied().flatten().map(pick), 0.02)
    };
    (axis(0), axis(1))
}

/// Width over height of a region.
pub(super) fn aspect(x: &Scale, y: &Scale) -> f64 {
    ((x.high - x.low) / (y.high - y.low)).clamp(1e-6, 1e6)
}

/// The number of columns that gives the widest maps, and their width (px).
fn arrange(wanted: &Wanted, aspect: f64) -> (usize, f64) {
    let mut best = (1, 0.0);
    for columns in 1..=wanted.maps.max(1) {
        let rows = wanted.maps.max(1).div_ceil(columns);
        let cell = wanted.room.0 / columns as f64 - GUTTER.0;
        if columns > 1 && cell < wanted.name {
            break;
        }
        let height = wanted.room.1 / rows as f64 - GUTTER.1;
        let width = (cell - wanted.beside).min(height * aspect);
        let width = width.min(LARGEST.0).min(LARGEST.1 * aspect);
        if width > best.1 {
            best = (columns, width);
        }
    }
    best
}
