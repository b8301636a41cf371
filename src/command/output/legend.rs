//! The legend of a study, outside its plot.

use super::study::Curve;
use super::style::{FRONT, GREY, INK, LABEL, MARKER, TICK, marker, stroke};
use super::svg::{Anchor, Canvas, Font, Point, Stroke};
use super::text;

/// From one entry to the next (px).
const ROW: f64 = 25.0;
/// Length of the sample of a line (px).
const SAMPLE: f64 = 46.0;
const WIDEST: f64 = 330.0;
const FRONT_NOTE: [&str; 3] = ["best at its cost:", "no other point is", "better on both axes"];

/// Width (px) that a legend of these curves takes.
pub(super) fn width(curves: &[Curve]) -> f64 {
    let labels = curves.iter().map(|curve| text::width(&curve.label, LABEL));
    let notes = FRONT_NOTE.iter().map(|line| text::width(line, TICK));
    SAMPLE + 12.0 + labels.chain(notes).fold(0.0, f64::max).min(WIDEST)
}

/// Height (px) that a legend of these curves takes.
pub(super) fn height(curves: &[Curve]) -> f64 {
    ROW * curves.len() as f64 + 125.0
}

/// Draws the legend with its upper left corner at a point; `lost` points could not be drawn.
pub(super) fn draw(canvas: &mut Canvas, (left, top): Point, curves: &[Curve], lost: usize) {
    let mut y = top + 0.5 * ROW;
    for curve in curves {
        canvas.line(
            &[(left, y), (left + SAMPLE, y)],
            stroke(curve.family, curve.variant),
        );
        marker(canvas, (left + 0.5 * SAMPLE, y), curve.family, curve.variant);
        let (label, size) = text::fit(&curve.label, LABEL, WIDEST);
        canvas.text(
            (left + SAMPLE + 12.0, y + 0.35 * LABEL),
            &label,
            Font::new(size, INK, Anchor::Start),
        );
        y += ROW;
    }
    if curves
        .iter()
        .flat_map(|curve| &curve.points)
        .any(|point| point.on_front)
    {
        y = draw_front(canvas, (left, y + 10.0));
    }
    if lost > 0 {
        draw_lost(canvas, (left, y + 16.0), lost);
    }
}

fn draw_lost(canvas: &mut Canvas, (left, y): Point, lost: usize) {
    let font = Font::new(TICK, GREY, Anchor::Start);
    let noun = if lost == 1 { "point" } else { "points" };
    canvas.text((left, y), &format!("{lost} {noun} not drawn:"), font);
    canvas.text((left, y + 17.0), "stopped, or not", font);
    canvas.text((left, y + 34.0), "positive and finite", font);
}

fn draw_front(canvas: &mut Canvas, (left, y): Point) -> f64 {
    canvas.line(&[(left, y), (left + SAMPLE, y)], Stroke::full(FRONT, 7.0));
    ring(canvas, (left + 0.5 * SAMPLE, y));
    let mut below = y;
    for line in FRONT_NOTE {
        let at = (left + SAMPLE + 12.0, below + 0.35 * TICK);
        canvas.text(at, line, Font::new(TICK, INK, Anchor::Start));
        below += 17.0;
    }
    below
}

/// The sign of a point on the front, around its marker.
pub(super) fn ring(canvas: &mut Canvas, at: Point) {
    canvas.circle(at, MARKER + 4.0, "none", Stroke::full(INK, 1.6));
}
