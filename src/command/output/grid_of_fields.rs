//! One field of several methods, side by side on the same axes.

use super::frame::{Frame, GAP, Labelled, widest, x_ticks, y_ticks};
use super::panel::{FieldPanel, draw_key, no_data};
use super::scale::{Scale, drawable, range};
use super::style::{GREY, INK, LABEL, TICK, TITLE};
use super::svg::{Anchor, Canvas, Font};
use super::text;

const PLOT_WIDTH: f64 = 270.0;
const PLOT_HEIGHT: f64 = 150.0;
const STRIDE_X: f64 = PLOT_WIDTH + 22.0;
const STRIDE_Y: f64 = PLOT_HEIGHT + 54.0;
const TOP: f64 = 114.0;
const BELOW: f64 = 58.0;
const EDGE: f64 = 24.0;

/// A picture (SVG text) of one field of several methods: small panels in `columns` columns on common axes,
/// each with its name and remark above.
///
/// The labels bear their units in brackets. So that one unstable method does not flatten the others, the axis
/// reaches at most half a span of the reference beyond it; particles outside are drawn as arrowheads and
/// counted.
pub fn draw_grid_of_fields(
    title: &str,
    x_label: &str,
    y_label: &str,
    panels: &[FieldPanel],
    columns: usize,
) -> String {
    let columns = columns.clamp(1, panels.len().max(1));
    let rows = panels.len().div_ceil(columns).max(1);
    let layout = Layout::new(panels, columns);
    let width = layout.left + STRIDE_X * (columns - 1) as f64 + PLOT_WIDTH + EDGE;
    let height = TOP + STRIDE_Y * (rows - 1) as f64 + PLOT_HEIGHT + BELOW;
    let mut canvas = Canvas::new(width, height, title);
    layout.draw_head(&mut canvas, title, width, panels);
    layout.draw_labels(&mut canvas, x_label, y_label, (width, height));
    for (i, panel) in panels.iter().enumerate() {
        let frame = layout.frame(i);
        // The lowest panel of each column bears the labels of the column.
        frame.draw(
            &mut canvas,
            Labelled {
                x: i + columns >= panels.len(),
                y: i % columns == 0,
            },
        );
        panel.draw(&mut canvas, &frame);
        draw_name(&mut canvas, &frame, panel);
    }
    if panels.is_empty() {
        layout.frame(0).outline(&mut canvas);
        no_data(&mut canvas, &layout.frame(0));
    }
    canvas.finish()
}

struct Layout {
    left: f64,
    columns: usize,
    x: Scale,
    y: Scale,
}

impl Layout {
    fn new(panels: &[FieldPanel], columns: usize) -> Layout {
        let all = || {
            panels
                .iter()
                .flat_map(|panel| panel.particles.iter().chain(&panel.reference))
        };
        let x = Scale::linear(all().map(|(x, _)| *x), 0.02);
        let y = values(panels);
        let left = EDGE + LABEL + GAP + widest(&y_ticks(&y, PLOT_HEIGHT)) + GAP;
        Layout { left, columns, x, y }
    }

    fn frame(&self, i: usize) -> Frame {
        let (row, column) = (i / self.columns, i % self.columns);
        let (left, top) = (self.left + STRIDE_X * column as f64, TOP + STRIDE_Y * row as f64);
        Frame {
            left,
            top,
            width: PLOT_WIDTH,
            height: PLOT_HEIGHT,
            x: self.x,
            y: self.y,
        }
    }

    fn draw_head(&self, canvas: &mut Canvas, title: &str, width: f64, panels: &[FieldPanel]) {
        let (title, size) = text::fit(title, TITLE, width - self.left - EDGE);
        canvas.text(
            (self.left, 32.0),
            &title,
            Font::new(size, INK, Anchor::Start).bold(),
        );
        if !panels.is_empty() {
            draw_key(canvas, (self.left, 54.0), panels);
        }
    }

    fn draw_labels(&self, canvas: &mut Canvas, x_label: &str, y_label: &str, (width, height): (f64, f64)) {
        let label = |label, exponent| {
            let (name, unit) = text::split_unit(label);
            text::with_unit(name, unit, exponent)
        };
        let x_label = label(x_label, x_ticks(&self.x, PLOT_WIDTH).exponent);
        let y_label = label(y_label, y_ticks(&self.y, PLOT_HEIGHT).exponent);
        let font = Font::new(LABEL, INK, Anchor::Middle);
        canvas.text((0.5 * (self.left + width - EDGE), height - 14.0), &x_label, font);
        let middle = 0.5 * (TOP + height - BELOW);
        canvas.text((EDGE + 0.3 * LABEL, middle), &y_label, font.upright());
    }
}

/// The common axis of values.
fn values(panels: &[FieldPanel]) -> Scale {
    let reference = || {
        panels
            .iter()
            .flat_map(|panel| &panel.reference)
            .map(|(_, value)| *value)
    };
    let particles = panels
        .iter()
        .flat_map(|panel| &panel.particles)
        .map(|(_, value)| *value);
    let limits = match range(reference().filter(|value| drawable(*value))) {
        Some((low, high)) if high > low => (low - 0.5 * (high - low), high + 0.5 * (high - low)),
        _ => (f64::NEG_INFINITY, f64::INFINITY),
    };
    let shown = particles
        .filter(|value| drawable(*value))
        .map(|value| value.clamp(limits.0, limits.1));
    Scale::linear(reference().chain(shown), 0.06)
}

/// The method's name above its panel, the remark below the name; in the panel, how much it cannot show.
fn draw_name(canvas: &mut Canvas, frame: &Frame, panel: &FieldPanel) {
    let (name, size) = text::fit(&panel.name, LABEL, PLOT_WIDTH);
    canvas.text(
        (frame.left, frame.top - 24.0),
        &name,
        Font::new(size, INK, Anchor::Start).bold(),
    );
    let (remark, size) = text::fit(&panel.note, TICK, PLOT_WIDTH);
    canvas.text(
        (frame.left, frame.top - 8.0),
        &remark,
        Font::new(size, GREY, Anchor::Start),
    );
    let losses = panel.losses(&frame.y);
    if !losses.is_empty() {
        let at = (frame.left + GAP, frame.bottom() - 14.0);
        canvas.text(at, &losses, Font::new(TICK, INK, Anchor::Start).halo());
    }
}
