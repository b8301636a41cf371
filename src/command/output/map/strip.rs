//! One field at several times.

use super::super::scale::Scale;
use super::super::style::{INK, LABEL};
use super::super::svg::{Anchor, Canvas, Font};
use super::super::text;
use super::bar::{ASIDE, Bar, LEAST_HEIGHT};
use super::cloud::Cloud;
use super::sheet::{Sheet, Wanted, aspect, axes};

/// Width for all maps (px).
const ROOM: f64 = 1050.0;
/// Height for all maps (px) of a square region, and the most for a high one.
const HEIGHTS: (f64, f64) = (320.0, 620.0);

/// One moment of a strip.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StripFrame {
    /// What stands above, such as `t = 0.25 s`.
    pub caption: String,
    /// Where the particles are (m).
    pub points: Vec<[f64; 2]>,
    /// What they carry, one a point.
    pub values: Vec<f64>,
}

/// A picture (SVG text) of one field at several times, with one colour bar for all.
///
/// `bounds` are the grid's corner with the lowest coordinates and its opposite (m); `unit` is that of the
/// values, such as `Pa`, empty for none. Particles are drawn and counted as in
/// [`draw_maps`](super::draw_maps).
pub fn draw_strip(
    title: &str,
    frames: &[StripFrame],
    bounds: [[f64; 2]; 2],
    name: &str,
    unit: &str,
) -> String {
    let points: Vec<_> = frames.iter().map(|frame| frame.points.as_slice()).collect();
    let (x, y) = axes(&[bounds], &points);
    let values = frames.iter().flat_map(|frame| frame.cloud().seen(&x, &y));
    let mut bar = Bar {
        scale: Scale::linear(values, 0.0),
        height: LEAST_HEIGHT,
    };
    let aspect = aspect(&x, &y);
    bar.height = Sheet::new(&wanted(&bar, frames, aspect), x, y)
        .frame(0)
        .height
        .max(LEAST_HEIGHT);
    let sheet = Sheet::new(&wanted(&bar, frames, aspect), x, y);
    let field = text::with_unit(name, unit, bar.exponent());
    let mut canvas = sheet.canvas(&headline(title, &field));
    for (i, frame) in frames.iter().enumerate() {
        frame.draw(&mut canvas, &sheet, i, &bar.scale);
    }
    if frames.is_empty() {
        sheet.draw_none(&mut canvas);
    }
    bar.draw(&mut canvas, (sheet.beside(), sheet.frame(0).top));
    canvas.finish()
}

/// The field stands in the title, since its bar is shared.
fn headline(title: &str, field: &str) -> String {
    match (title, field) {
        ("", only) | (only, "") => only.to_owned(),
        (title, field) => format!("{title}: {field}"),
    }
}

impl StripFrame {
    fn cloud(&self) -> Cloud<'_> {
        Cloud {
            points: &self.points,
            values: &self.values,
        }
    }

    fn draw(&self, canvas: &mut Canvas, sheet: &Sheet, i: usize, colours: &Scale) {
        let frame = sheet.frame(i);
        sheet.draw_axes(canvas, i);
        self.cloud().draw(canvas, &frame, colours, sheet.cell());
        let (caption, size) = text::fit(&self.caption, LABEL, sheet.cell());
        let font = Font::new(size, INK, Anchor::Start).bold();
        canvas.text((frame.left, frame.top - 10.0), &caption, font);
    }
}

fn wanted(bar: &Bar, frames: &[StripFrame], aspect: f64) -> Wanted {
    let captions = frames.iter().map(|frame| text::width(&frame.caption, LABEL));
    let (square, most) = HEIGHTS;
    Wanted {
        maps: frames.len(),
        beside: 0.0,
        beside_all: ASIDE + bar.width(),
        name: captions.fold(0.0, f64::max),
        row: 0.0,
        room: (ROOM, (square / aspect.min(1.0).sqrt()).min(most)),
    }
}
