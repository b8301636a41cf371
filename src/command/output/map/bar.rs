//! The bar that says which colour is which value.

use std::iter;

use super::super::frame::{GAP, widest, y_ticks};
use super::super::scale::Scale;
use super::super::style::{INK, TICK};
use super::super::svg::{Anchor, Canvas, Font, Point, Stroke};
use super::super::ticks::{Ticks, ticks};
use super::colours::{LEVELS, colour};

/// Width of the coloured part (px).
const WIDTH: f64 = 14.0;
const TICK_LENGTH: f64 = 4.0;
/// From a map to its bar (px): half the last label below the map fits in.
pub(super) const ASIDE: f64 = 16.0;
/// Below this height (px) a bar cannot bear its labels.
pub(super) const LEAST_HEIGHT: f64 = 90.0;

/// A colour bar of a height (px).
pub(super) struct Bar {
    pub scale: Scale,
    pub height: f64,
}

impl Bar {
    /// Width (px) with its labels.
    pub fn width(&self) -> f64 {
        WIDTH + TICK_LENGTH + 0.5 * GAP + widest(&self.ticks())
    }

    /// Power of ten that the labels leave out.
    pub fn exponent(&self) -> i32 {
        self.ticks().exponent
    }

    /// Draws the bar with its upper left corner at a point.
    pub fn draw(&self, canvas: &mut Canvas, (left, top): Point) {
        let step = self.height / LEVELS as f64;
        for level in 0..LEVELS {
            let from = top + self.height - (level + 1) as f64 * step;
            canvas.tiles(&[((left, from), (WIDTH, step))], &colour(level));
        }
        let (right, bottom) = (left + WIDTH, top + self.height);
        let corners = [(left, top), (right, top), (right, bottom), (left, bottom)];
        canvas.polygon(&corners, "none", Stroke::full(INK, 1.0));
        for (fraction, label) in self.ticks().labelled {
            let y = bottom - fraction * self.height;
            canvas.line(&[(right, y), (right + TICK_LENGTH, y)], Stroke::full(INK, 1.0));
            let at = (right + TICK_LENGTH + 0.5 * GAP, y + 0.35 * TICK);
            canvas.text(at, &label, Font::new(TICK, INK, Anchor::Start));
        }
    }

    /// At least two labels, or nobody could read a value between them.
    fn ticks(&self) -> Ticks {
        let fits = |ticks: &Ticks| {
            let labels = ticks.labelled.len();
            labels > 1 && TICK * labels as f64 <= self.height
        };
        let usual = y_ticks(&self.scale, self.height);
        let more = (3..10).map(|wanted| ticks(&self.scale, wanted));
        iter::once(usual).chain(more).find(fits).unwrap_or_default()
    }
}
