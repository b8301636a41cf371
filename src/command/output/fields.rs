//! Several fields over one position axis, stacked.

use super::frame::{Frame, GAP, Labelled, widest, x_ticks, y_ticks};
use super::panel::{FieldPanel, draw_key, no_data};
use super::scale::Scale;
use super::style::{GREY, INK, LABEL, TICK, TITLE};
use super::svg::{Anchor, Canvas, Font};
use super::text;

const WIDTH: f64 = 860.0;
const PLOT_HEIGHT: f64 = 150.0;
/// From one panel to the next (px), its name included.
const STRIDE: f64 = PLOT_HEIGHT + 44.0;
const TOP: f64 = 96.0;
const BELOW: f64 = 58.0;
const EDGE: f64 = 24.0;

/// A picture (SVG text) of fields over position: one panel a field, particles as points before the reference.
///
/// `x_label` bears its unit in brackets, such as `position [m]`. Values that are not finite are counted in
/// the panel's remark.
pub fn draw_fields(title: &str, x_label: &str, panels: &[FieldPanel]) -> String {
    let height = TOP + STRIDE * (panels.len().max(1) - 1) as f64 + PLOT_HEIGHT + BELOW;
    let mut canvas = Canvas::new(WIDTH, height, title);
    let frames = frames(panels);
    draw_head(&mut canvas, title, &frames, panels);
    for (i, (frame, panel)) in frames.iter().zip(panels).enumerate() {
        frame.draw(
            &mut canvas,
            Labelled {
                x: i + 1 == panels.len(),
                y: true,
            },
        );
        panel.draw(&mut canvas, frame);
        draw_name(&mut canvas, frame, panel);
    }
    if let Some(frame) = frames.last() {
        if panels.is_empty() {
            frame.outline(&mut canvas);
            no_data(&mut canvas, frame);
        }
        let (name, unit) = text::split_unit(x_label);
        let label = text::with_unit(name, unit, x_ticks(&frame.x, frame.width).exponent);
        let at = (frame.left + 0.5 * frame.width, frame.bottom() + 44.0);
        canvas.text(at, &label, Font::new(LABEL, INK, Anchor::Middle));
    }
    canvas.finish()
}

/// One frame a panel, or a single one for no panel; all as wide as the widest tick labels allow.
fn frames(panels: &[FieldPanel]) -> Vec<Frame> {
    let all = || {
        panels
            .iter()
            .flat_map(|panel| panel.particles.iter().chain(&panel.reference))
    };
    let x = Scale::linear(all().map(|(x, _)| *x), 0.01);
    let values = |panel: &FieldPanel| {
        Scale::linear(
            panel
                .particles
                .iter()
                .chain(&panel.reference)
                .map(|(_, value)| *value),
            0.06,
        )
    };
    let mut scales: Vec<Scale> = panels.iter().map(values).collect();
    if scales.is_empty() {
        scales.push(Scale::linear(std::iter::empty(), 0.0));
    }
    let labels = scales
        .iter()
        .map(|y| widest(&y_ticks(y, PLOT_HEIGHT)))
        .fold(0.0, f64::max);
    let left = EDGE + labels + GAP;
    let top = |i: usize| TOP + STRIDE * i as f64;
    let frame = |(i, y)| Frame {
        left,
        top: top(i),
        width: WIDTH - left - EDGE,
        height: PLOT_HEIGHT,
        x,
        y,
    };
    scales.into_iter().enumerate().map(frame).collect()
}

fn draw_head(canvas: &mut Canvas, title: &str, frames: &[Frame], panels: &[FieldPanel]) {
    let Some(frame) = frames.first() else { return };
    let (title, size) = text::fit(title, TITLE, frame.width);
    canvas.text(
        (frame.left, 32.0),
        &title,
        Font::new(size, INK, Anchor::Start).bold(),
    );
    if !panels.is_empty() {
        draw_key(canvas, (frame.left, 54.0), panels);
    }
}

/// Name and unit above the panel to the left, the remark to the right.
fn draw_name(canvas: &mut Canvas, frame: &Frame, panel: &FieldPanel) {
    let y = frame.top - 9.0;
    let exponent = y_ticks(&frame.y, frame.height).exponent;
    let name = text::with_unit(&panel.name, &panel.unit, exponent);
    let (name, size) = text::fit(&name, LABEL, 0.6 * frame.width);
    canvas.text((frame.left, y), &name, Font::new(size, INK, Anchor::Start).bold());
    let parts = [panel.note.clone(), panel.losses(&frame.y)];
    let remark = parts
        .into_iter()
        .filter(|part| !part.is_empty())
        .collect::<Vec<_>>()
        .join(", ");
    let room = frame.width - 1.1 * text::width(&name, size) - 2.0 * GAP;
    let (remark, size) = text::fit(&remark, TICK, room);
    canvas.text((frame.right(), y), &remark, Font::new(size, GREY, Anchor::End));
}
