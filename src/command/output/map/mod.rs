//! Fields over the plane: particles as coloured dots where they are.

mod bar;
mod cloud;
mod colours;
mod sheet;
mod strip;

use super::scale::Scale;
use super::style::{INK, LABEL};
use super::svg::{Anchor, Canvas, Font};
use super::text;
use bar::{ASIDE, Bar, LEAST_HEIGHT};
use cloud::Cloud;
use sheet::{Sheet, Wanted, axes};

pub use strip::{StripFrame, draw_strip};

/// Width and height for all maps of a page (px).
const ROOM: (f64, f64) = (1000.0, 860.0);

/// One field of all particles in the plane.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MapPanel {
    /// Name of the field.
    pub name: String,
    /// Unit of the values, such as `Pa`; empty for none.
    pub unit: String,
    /// Names of the axes to the right and upwards; `x` and `y` where they are empty. All maps of a page have
    /// those of the first.
    pub axes: [&'static str; 2],
    /// The grid's corner with the lowest coordinates and its opposite (m).
    pub bounds: [[f64; 2]; 2],
    /// Where the particles are (m).
    pub points: Vec<[f64; 2]>,
    /// What they carry (`unit`), one a point.
    pub values: Vec<f64>,
}

/// A picture (SVG text) of fields over the plane: one map a field, each with a colour bar of its own, all of
/// one region (that of all bounds) and with equal scales.
///
/// Particles are dots; where they are more than 20 000, means over at most 200 x 200 tiles. Particles outside
/// and values that are not finite are counted in the map.
pub fn draw_maps(title: &str, panels: &[MapPanel]) -> String {
    let bounds: Vec<_> = panels.iter().map(|panel| panel.bounds).collect();
    let points: Vec<_> = panels.iter().map(|panel| panel.points.as_slice()).collect();
    let (x, y) = axes(&bounds, &points);
    // The labels of a bar may change with its height: once to know the size of the maps, once for good.
    let rough = Sheet::new(&wanted(&bars(panels, (&x, &y), LEAST_HEIGHT), panels), x, y);
    let bars = bars(panels, (&x, &y), rough.frame(0).height.max(LEAST_HEIGHT));
    let names = panels.first().map(|panel| panel.axes).unwrap_or_default();
    let sheet = Sheet::new(&wanted(&bars, panels), x, y).with_names(names);
    let mut canvas = sheet.canvas(title);
    for (i, (panel, bar)) in panels.iter().zip(&bars).enumerate() {
        panel.draw(&mut canvas, &sheet, i, bar);
    }
    if panels.is_empty() {
        sheet.draw_none(&mut canvas);
    }
    canvas.finish()
}

impl MapPanel {
    fn draw(&self, canvas: &mut Canvas, sheet: &Sheet, i: usize, bar: &Bar) {
        let frame = sheet.frame(i);
        sheet.draw_axes(canvas, i);
        self.cloud().draw(canvas, &frame, &bar.scale, sheet.cell());
        bar.draw(canvas, (frame.right() + ASIDE, frame.top));
        let title = self.title(bar);
        let (name, size) = text::fit(&title, LABEL, sheet.cell());
        let font = Font::new(size, INK, Anchor::Start).bold();
        canvas.text((frame.left, frame.top - 10.0), &name, font);
    }

    fn cloud(&self) -> Cloud<'_> {
        Cloud {
            points: &self.points,
            values: &self.values,
        }
    }

    fn title(&self, bar: &Bar) -> String {
        text::with_unit(&self.name, &self.unit, bar.exponent())
    }
}

fn bars(panels: &[MapPanel], (x, y): (&Scale, &Scale), height: f64) -> Vec<Bar> {
    let bar = |panel: &MapPanel| Bar {
        scale: Scale::linear(panel.cloud().seen(x, y), 0.0),
        height,
    };
    panels.iter().map(bar).collect()
}

fn wanted(bars: &[Bar], panels: &[MapPanel]) -> Wanted {
    let names = panels.iter().zip(bars).map(|(panel, bar)| panel.title(bar));
    let widths = bars.iter().map(Bar::width);
    Wanted {
        maps: panels.len(),
        beside: ASIDE + widths.fold(0.0, f64::max),
        beside_all: 0.0,
        name: names.map(|name| text::width(&name, LABEL)).fold(0.0, f64::max),
        row: LEAST_HEIGHT,
        room: ROOM,
    }
}
