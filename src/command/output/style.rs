//! Colours, dashes, markers and font sizes, the same in every picture.

use super::svg::{Canvas, Point, Stroke};

/// Fonts in order of preference.
pub(super) const FONT: &str = "Helvetica, Arial, 'DejaVu Sans', sans-serif";
/// Font size of a picture's title (px).
pub(super) const TITLE: f64 = 18.0;
/// Font size of axis labels, panel names and legends (px).
pub(super) const LABEL: f64 = 14.0;
/// Font size of tick labels and notes (px).
pub(super) const TICK: f64 = 13.0;

/// Text and axes.
pub(super) const INK: &str = "#222222";
/// Secondary text.
pub(super) const GREY: &str = "#555555";
/// Lines at the ticks.
pub(super) const RULE: &str = "#e4e4e4";
/// Lines between the ticks of a logarithmic axis.
pub(super) const FAINT_RULE: &str = "#f3f3f3";
/// The line through the best points of a study.
pub(super) const FRONT: &str = "#c8c8c8";
/// Particles: dark, above the light and broad line of the reference.
pub(super) const PARTICLE: &str = "#0072B2";
/// The reference behind the particles.
pub(super) const REFERENCE: &str = "#E69F00";
/// Width of the line of the reference (px).
pub(super) const REFERENCE_WIDTH: f64 = 6.0;
/// Areas behind lines.
pub(super) const SHADE: &str = "#d9d9d9";
/// Points that lie outside a panel.
pub(super) const OUTSIDE: &str = "#D55E00";

const FAMILIES: [&str; 6] = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#000000", "#56B4E9"];
const DASHES: [&str; 4] = ["", "8 4", "2 4", "10 3 2 3"];
/// Reach of a marker from its centre (px).
pub(super) const MARKER: f64 = 5.5;

/// Colour of a family; after the last the first comes again.
pub(super) fn colour(family: usize) -> &'static str {
    FAMILIES.get(family % FAMILIES.len()).copied().unwrap_or(INK)
}

/// Line of a method: colour by family, dash by variant.
pub(super) fn stroke(family: usize, variant: usize) -> Stroke {
    let dash = DASHES.get(variant % DASHES.len()).copied().unwrap_or("");
    Stroke {
        colour: colour(family),
        width: 2.0,
        dash,
    }
}

/// Marker of a method: shape by variant; colour and filling (full, hollow, dotted) by family, so that
/// families differ in grey too.
pub(super) fn marker(canvas: &mut Canvas, at: Point, family: usize, variant: usize) {
    let rim = Stroke::full(colour(family), 2.0);
    let fill = if family.is_multiple_of(3) {
        rim.colour
    } else {
        "white"
    };
    match shape(variant) {
        None => canvas.circle(at, MARKER - 0.5, fill, rim),
        Some(corners) => canvas.polygon(&corners.map(|(dx, dy)| (at.0 + dx, at.1 + dy)), fill, rim),
    }
    if family % 3 == 2 {
        canvas.discs(&[at], 2.0, rim.colour);
    }
}

/// Corners of a marker around its centre (px); none for a circle.
fn shape(variant: usize) -> Option<[Point; 4]> {
    match variant % 4 {
        0 => None,
        1 => Some([(-4.8, -4.8), (4.8, -4.8), (4.8, 4.8), (-4.8, 4.8)]),
        // A triangle whose last corner lies on its base.
        2 => Some([(0.0, -6.8), (6.2, 4.6), (0.0, 4.6), (-6.2, 4.6)]),
        _ => Some([(0.0, -7.0), (6.0, 0.0), (0.0, 7.0), (-6.0, 0.0)]),
    }
}
