//! One field over position: particles before the reference.

use std::collections::HashSet;

use super::frame::Frame;
use super::scale::{Scale, drawable};
use super::style::{GREY, LABEL, OUTSIDE, PARTICLE, REFERENCE, REFERENCE_WIDTH};
use super::svg::{Anchor, Canvas, Font, Point, Stroke};
use super::text;

/// One field of all particles, and what it should be.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FieldPanel {
    /// Name of the field, or of the method where several methods stand side by side.
    pub name: String,
    /// Unit of the values, such as `Pa`; empty for none.
    pub unit: String,
    /// Position and value of each particle (units of the x axis, `unit`).
    pub particles: Vec<(f64, f64)>,
    /// Position and value along the reference, in drawing order; empty if there is none.
    pub reference: Vec<(f64, f64)>,
    /// A remark, such as `relative L2 error 7.59e-3`; empty for none.
    pub note: String,
}

impl FieldPanel {
    /// How many particles the picture cannot show; empty if it shows all.
    pub(super) fn losses(&self, y: &Scale) -> String {
        let lost = self
            .particles
            .iter()
            .filter(|(x, y)| !(drawable(*x) && drawable(*y)))
            .count();
        let outside = self.particles.iter().filter(|(_, v)| is_outside(y, *v)).count();
        let outside = (outside > 0).then(|| format!("{outside} outside"));
        let lost = (lost > 0).then(|| format!("{lost} not finite"));
        outside.into_iter().chain(lost).collect::<Vec<_>>().join(", ")
    }

    /// Draws reference and particles into a frame.
    pub(super) fn draw(&self, canvas: &mut Canvas, frame: &Frame) {
        let shown: Vec<(f64, f64)> = self
            .particles
            .iter()
            .copied()
            .filter(|(x, y)| drawable(*x) && drawable(*y))
            .collect();
        if shown.is_empty() && self.reference.is_empty() {
            return no_data(canvas, frame);
        }
        self.draw_reference(canvas, frame);
        let (outside, inside): (Vec<_>, Vec<_>) =
            shown.into_iter().partition(|(_, v)| is_outside(&frame.y, *v));
        let centres = distinct(inside.into_iter().filter_map(|pair| frame.place(pair)));
        canvas.discs(&centres, radius(centres.len(), frame.width), PARTICLE);
        for at in distinct(outside.into_iter().filter_map(|pair| at_the_edge(frame, pair))) {
            canvas.polygon(&arrowhead(frame, at), OUTSIDE, Stroke::full(OUTSIDE, 1.0));
        }
    }

    /// A point that cannot be drawn breaks the line.
    fn draw_reference(&self, canvas: &mut Canvas, frame: &Frame) {
        let placed: Vec<Option<Point>> = self.reference.iter().map(|pair| frame.place(*pair)).collect();
        for piece in placed.split(Option::is_none) {
            let mut piece: Vec<Point> = piece.iter().copied().flatten().collect();
            piece.dedup_by_key(|(x, y)| third_of_pixel(*x, *y));
            canvas.line(&piece, Stroke::full(REFERENCE, REFERENCE_WIDTH));
        }
    }
}

/// Draws what the signs mean, in one line.
pub(super) fn draw_key(canvas: &mut Canvas, (x, y): Point, panels: &[FieldPanel]) {
    let font = Font::new(LABEL, GREY, Anchor::Start);
    canvas.discs(&[(x + 4.0, y), (x + 12.0, y), (x + 20.0, y)], 2.4, PARTICLE);
    canvas.text((x + 30.0, y + 0.35 * LABEL), "particles", font);
    if panels.iter().any(|panel| !panel.reference.is_empty()) {
        let x = x + 44.0 + text::width("particles", LABEL);
        canvas.line(&[(x, y), (x + 26.0, y)], Stroke::full(REFERENCE, REFERENCE_WIDTH));
        canvas.text((x + 34.0, y + 0.35 * LABEL), "reference", font);
    }
}

/// Says in a frame that there is nothing to draw.
pub(super) fn no_data(canvas: &mut Canvas, frame: &Frame) {
    let centre = (frame.left + 0.5 * frame.width, frame.top + 0.5 * frame.height);
    canvas.text(centre, "no data", Font::new(LABEL, GREY, Anchor::Middle).halo());
}

fn is_outside(scale: &Scale, value: f64) -> bool {
    scale
        .fraction(value)
        .is_some_and(|fraction| !(-1e-6..=1.000001).contains(&fraction))
}

fn at_the_edge(frame: &Frame, pair: (f64, f64)) -> Option<Point> {
    let (x, y) = frame.place(pair)?;
    Some((x, y.clamp(frame.top, frame.bottom())))
}

/// A triangle inside the frame that points out of it.
fn arrowhead(frame: &Frame, (x, y): Point) -> [Point; 3] {
    let inwards = if y > frame.top { -6.0 } else { 6.0 };
    [(x, y), (x - 3.0, y + inwards), (x + 3.0, y + inwards)]
}

/// Small where many particles share a panel.
fn radius(particles: usize, width: f64) -> f64 {
    let spacing = width / particles.max(1) as f64;
    (0.5 * spacing).clamp(1.4, 2.4)
}

/// One point of each third of a pixel: a million particles still make a picture that opens.
fn distinct(points: impl Iterator<Item = Point>) -> Vec<Point> {
    let mut taken = HashSet::new();
    points
        .filter(|(x, y)| taken.insert(third_of_pixel(*x, *y)))
        .collect()
}

fn third_of_pixel(x: f64, y: f64) -> (i64, i64) {
    ((3.0 * x) as i64, (3.0 * y) as i64)
}
