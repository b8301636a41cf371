//! The rectangle of a plot: axes, rules, tick labels, and where data go.

use super::scale::Scale;
use super::style::{FAINT_RULE, INK, RULE, TICK};
use super::svg::{Anchor, Canvas, Font, Point, Stroke};
use super::text;
use super::ticks::{Ticks, ticks};

/// Space between tick labels and the plot (px).
pub(super) const GAP: f64 = 8.0;

/// A plot's rectangle (px) and its two axes.
#[derive(Clone, Copy)]
pub(super) struct Frame {
    pub left: f64,
    pub top: f64,
    pub width: f64,
    pub height: f64,
    pub x: Scale,
    pub y: Scale,
}

/// Which tick labels a plot bears; neighbours on common axes share them.
#[derive(Clone, Copy)]
pub(super) struct Labelled {
    pub x: bool,
    pub y: bool,
}

impl Frame {
    /// Lower end of the rectangle (px).
    pub fn bottom(&self) -> f64 {
        self.top + self.height
    }

    /// Right end of the rectangle (px).
    pub fn right(&self) -> f64 {
        self.left + self.width
    }

    /// Where a pair of values lies in the picture, possibly outside the rectangle; `None` if it cannot be
    /// drawn.
    pub fn place(&self, (x, y): (f64, f64)) -> Option<Point> {
        let (x, y) = (self.x.fraction(x)?, self.y.fraction(y)?);
        Some((self.left + x * self.width, self.bottom() - y * self.height))
    }

    /// Draws rules, frame and tick labels: everything that lies behind the data.
    pub fn draw(&self, canvas: &mut Canvas, labelled: Labelled) {
        let (x, y) = (x_ticks(&self.x, self.width), y_ticks(&self.y, self.height));
        self.rules(canvas, &x.minor, &y.minor, Stroke::full(FAINT_RULE, 1.0));
        let (x_places, y_places) = (places(&x), places(&y));
        self.rules(canvas, &x_places, &y_places, Stroke::full(RULE, 1.0));
        self.outline(canvas);
        if labelled.x {
            self.x_labels(canvas, &x);
        }
        if labelled.y {
            self.y_labels(canvas, &y);
        }
    }

    /// Draws the rectangle alone.
    pub fn outline(&self, canvas: &mut Canvas) {
        let (left, top, right, bottom) = (self.left, self.top, self.right(), self.bottom());
        let corners = [(left, top), (right, top), (right, bottom), (left, bottom)];
        canvas.polygon(&corners, "none", Stroke::full(INK, 1.0));
    }

    fn rules(&self, canvas: &mut Canvas, x: &[f64], y: &[f64], stroke: Stroke) {
        for fraction in x {
            let x = self.left + fraction * self.width;
            canvas.line(&[(x, self.top), (x, self.bottom())], stroke);
        }
        for fraction in y {
            let y = self.bottom() - fraction * self.height;
            canvas.line(&[(self.left, y), (self.right(), y)], stroke);
        }
    }

    /// A label that would touch the one before is left out.
    fn x_labels(&self, canvas: &mut Canvas, ticks: &Ticks) {
        let mut free = f64::NEG_INFINITY;
        for (fraction, label) in &ticks.labelled {
            let (middle, half) = (fraction * self.width, 0.5 * text::width(label, TICK));
            if middle - half < free {
                continue;
            }
            free = middle + half + 2.0;
            let at = (
                self.left + fraction * self.width,
                self.bottom() + GAP + 0.8 * TICK,
            );
            canvas.text(at, label, Font::new(TICK, INK, Anchor::Middle));
        }
    }

    /// A label that would touch the one below is left out.
    fn y_labels(&self, canvas: &mut Canvas, ticks: &Ticks) {
        let mut free = f64::NEG_INFINITY;
        for (fraction, label) in &ticks.labelled {
            if fraction * self.height < free {
                continue;
            }
            free = fraction * self.height + TICK;
            let at = (
                self.left - GAP,
                self.bottom() - fraction * self.height + 0.35 * TICK,
            );
            canvas.text(at, label, Font::new(TICK, INK, Anchor::End));
        }
    }
}

/// As many ticks as their labels leave room for on a horizontal axis of this width (px).
pub(super) fn x_ticks(scale: &Scale, width: f64) -> Ticks {
    let most = (width / 80.0).clamp(2.0, 10.0) as usize;
    let fits = |ticks: &Ticks| 1.3 * widest(ticks) * ticks.labelled.len() as f64 <= width;
    let fewer = (3..=most).rev().map(|wanted| ticks(scale, wanted));
    fewer.into_iter().find(fits).unwrap_or_else(|| ticks(scale, 2))
}

/// As many ticks as stay well apart on a vertical axis of this height (px).
pub(super) fn y_ticks(scale: &Scale, height: f64) -> Ticks {
    let most = (height / 26.0).clamp(2.0, 8.0) as usize;
    ticks(scale, most)
}

/// Width of the widest label (px).
pub(super) fn widest(ticks: &Ticks) -> f64 {
    ticks
        .labelled
        .iter()
        .map(|(_, label)| text::width(label, TICK))
        .fold(0.0, f64::max)
}

fn places(ticks: &Ticks) -> Vec<f64> {
    ticks.labelled.iter().map(|(at, _)| *at).collect()
}
