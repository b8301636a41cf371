//! Coloured particles in a map: dots, or tiles where dots would be too many.

use std::collections::HashSet;
use std::iter;

use super::super::frame::{Frame, GAP};
use super::super::panel::no_data;
use super::super::scale::Scale;
use super::super::style::{INK, TICK};
use super::super::svg::{Anchor, Canvas, Font, Point};
use super::super::text;
use super::colours::{LEVELS, colour, level};

/// Beyond this many particles their means over tiles are drawn.
const MOST_DOTS: usize = 20_000;
/// Most tiles along the longer side of a map.
const MOST_TILES: f64 = 200.0;

/// A place in the picture (px) and the value there.
type Sample = (Point, f64);

/// Particles and what they carry, in units of the axes and of the colours.
#[derive(Clone, Copy)]
pub(super) struct Cloud<'a> {
    pub points: &'a [[f64; 2]],
    /// One a point; a missing one counts as no number.
    pub values: &'a [f64],
}

impl<'a> Cloud<'a> {
    /// The values of particles inside both axes: one far away does not flatten the colours of the rest.
    pub fn seen(self, x: &'a Scale, y: &'a Scale) -> impl Iterator<Item = f64> {
        let within = |axis: &Scale, at: f64| axis.fraction(at).is_some_and(|f| (0.0..=1.0).contains(&f));
        let pairs = self.points.iter().zip(self.values);
        let seen = pairs.filter(move |(at, _)| within(x, at[0]) && within(y, at[1]));
        seen.map(|(_, value)| *value)
    }

    /// Draws the particles into a frame and says, in a line no wider than `width` (px), what it cannot show.
    pub fn draw(&self, canvas: &mut Canvas, frame: &Frame, colours: &Scale, width: f64) {
        let (samples, remark) = self.samples(frame);
        if samples.is_empty() {
            no_data(canvas, frame);
        } else if samples.len() <= MOST_DOTS {
            draw_dots(canvas, frame, colours, &samples);
        } else {
            draw_tiles(canvas, frame, colours, &samples);
        }
        frame.outline(canvas);
        let (remark, size) = text::fit(&remark, TICK, width - GAP);
        if !remark.is_empty() {
            let at = (frame.left + 0.5 * GAP, frame.top + TICK + 2.0);
            canvas.text(at, &remark, Font::new(size, INK, Anchor::Start).halo());
        }
    }

    /// What can be drawn, and how many cannot.
    fn samples(&self, frame: &Frame) -> (Vec<Sample>, String) {
        let (mut samples, mut outside, mut lost) = (Vec::new(), 0, 0);
        let values = self.values.iter().copied().chain(iter::repeat(f64::NAN));
        for (&[x, y], value) in self.points.iter().zip(values) {
            match frame.place((x, y)).filter(|_| value.is_finite()) {
                None => lost += 1,
                Some(at) if is_inside(frame, at) => samples.push((at, value)),
                Some(_) => outside += 1,
            }
        }
        let counted = [(outside, "outside"), (lost, "not finite")];
        let said = counted.iter().filter(|(count, _)| *count > 0);
        let said: Vec<String> = said.map(|(count, what)| format!("{count} {what}")).collect();
        (samples, said.join(", "))
    }
}

/// Round-off at the edge is inside.
fn is_inside(frame: &Frame, (x, y): Point) -> bool {
    (frame.left - 0.01..=frame.right() + 0.01).contains(&x)
        && (frame.top - 0.01..=frame.bottom() + 0.01).contains(&y)
}

fn draw_dots(canvas: &mut Canvas, frame: &Frame, colours: &Scale, samples: &[Sample]) {
    let radius = (0.55 * spacing(frame, samples)).clamp(1.2, 6.0);
    let mut groups = vec![Vec::new(); LEVELS];
    for (at, value) in samples {
        let group = level(colours, *value).and_then(|level| groups.get_mut(level));
        group.into_iter().for_each(|group| group.push(*at));
    }
    for (level, group) in groups.iter().enumerate().filter(|(_, group)| !group.is_empty()) {
        canvas.dots(group, radius, &colour(level));
    }
}

/// Typical distance (px) of neighbours: the area of the cells that hold any, shared; the cells are halved
/// until they hold few.
fn spacing(frame: &Frame, samples: &[Sample]) -> f64 {
    let mut side = frame.width.max(frame.height);
    loop {
        let cell = |(at, _): &Sample| tile(frame, side, *at);
        let occupied = samples.iter().map(cell).collect::<HashSet<_>>().len();
        if samples.len() < 8 * occupied || side < 1.0 {
            return side * (occupied as f64 / samples.len().max(1) as f64).sqrt();
        }
        side *= 0.5;
    }
}

/// Column and row of the tile of a place.
fn tile(frame: &Frame, side: f64, (x, y): Point) -> (usize, usize) {
    (
        ((x - frame.left) / side) as usize,
        ((y - frame.top) / side) as usize,
    )
}

/// Tiles wide enough that a body of evenly spread particles has no holes.
fn draw_tiles(canvas: &mut Canvas, frame: &Frame, colours: &Scale, samples: &[Sample]) {
    let longest = frame.width.max(frame.height);
    let side = (1.5 * spacing(frame, samples)).max(longest / MOST_TILES);
    let (columns, rows) = (cells(frame.width, side), cells(frame.height, side));
    let mut means = vec![Mean::default(); columns * rows];
    for (at, value) in samples {
        let (column, row) = tile(frame, side, *at);
        let index = row.min(rows - 1) * columns + column.min(columns - 1);
        means.get_mut(index).into_iter().for_each(|mean| mean.add(*value));
    }
    let mut groups = vec![Vec::new(); LEVELS];
    for (index, mean) in means.iter().enumerate() {
        let level = mean.value().and_then(|value| level(colours, value));
        let Some(group) = level.and_then(|level| groups.get_mut(level)) else {
            continue;
        };
        let x = frame.left + side * (index % columns) as f64;
        let y = frame.top + side * (index / columns) as f64;
        let size = (side.min(frame.right() - x), side.min(frame.bottom() - y));
        join(group, (x, y), size);
    }
    for (level, group) in groups.iter().enumerate().filter(|(_, group)| !group.is_empty()) {
        canvas.tiles(group, &colour(level));
    }
}

/// Adds a tile, or lengthens the last one by it if they are neighbours in a row.
fn join(tiles: &mut Vec<(Point, Point)>, (x, y): Point, size: Point) {
    match tiles.last_mut() {
        Some((corner, last)) if corner.1 == y && (corner.0 + last.0 - x).abs() < 1e-6 => last.0 += size.0,
        _ => tiles.push(((x, y), size)),
    }
}

/// How many tiles cover a length; at least one.
fn cells(length: f64, side: f64) -> usize {
    ((length / side - 1e-9).ceil() as usize).max(1)
}

/// A mean that cannot overflow.
#[derive(Clone, Copy, Default)]
struct Mean {
    count: u32,
    mean: f64,
}

impl Mean {
    fn add(&mut self, value: f64) {
        self.count += 1;
        let count = f64::from(self.count);
        self.mean += value / count - self.mean / count;
    }

    fn value(&self) -> Option<f64> {
        (self.count > 0).then_some(self.mean)
    }
}
