//! Lines over a common axis, such as energy over time, of several cases side by side.

use super::frame::{Frame, GAP, Labelled, widest, x_ticks, y_ticks};
use super::labels::Obstacles;
use super::panel::no_data;
use super::scale::Scale;
use super::style::{INK, LABEL, REFERENCE, REFERENCE_WIDTH, SHADE, TICK, TITLE, stroke};
use super::svg::{Anchor, Canvas, Font, Point, Stroke};
use super::text;

const PLOT_WIDTH: f64 = 400.0;
const PLOT_HEIGHT: f64 = 210.0;
const STRIDE_X: f64 = PLOT_WIDTH + 26.0;
const STRIDE_Y: f64 = PLOT_HEIGHT + 44.0;
const BELOW: f64 = 58.0;
const EDGE: f64 = 24.0;
/// Length of the sample of a line in the legend (px).
const SAMPLE: f64 = 40.0;
/// From one row of the legend to the next (px).
const ROW: f64 = 22.0;

/// One line.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Line {
    /// What it is; lines of one label look alike and share an entry of the legend.
    pub label: String,
    /// Number of its colour.
    pub family: usize,
    /// Number of its dash.
    pub variant: usize,
    /// Where it goes, in drawing order; a point that cannot be drawn breaks it.
    pub points: Vec<(f64, f64)>,
    /// What stands beside a cross at its last point, such as `5.2 s` where a run stopped; empty for neither.
    /// If the point lies above or below the axis, the cross is at its edge.
    pub stopped: String,
}

/// Lines on one pair of axes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LinePanel {
    /// Name of the case.
    pub name: String,
    /// Its lines, the last one on top.
    pub lines: Vec<Line>,
    /// What they should be, drawn behind them; empty if nothing.
    pub reference: Vec<(f64, f64)>,
    /// Shaded rectangles behind all: left, right, lower and upper value.
    pub shaded: Vec<[f64; 4]>,
}

/// What a picture of lines says around them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LineCaptions<'a> {
    /// Title.
    pub title: &'a str,
    /// Of the horizontal axis, with its unit in brackets.
    pub x: &'a str,
    /// Of the vertical axis, with its unit in brackets.
    pub y: &'a str,
    /// Name of the references; empty if there are none.
    pub reference: &'a str,
    /// What a cross at the end of a line means; empty if none ends early.
    pub stopped: &'a str,
    /// What shade means; empty if there is none.
    pub shaded: &'a str,
}

/// The vertical axis of a picture of lines; what lies outside is cut off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineAxis {
    /// Lowest and highest value; positive if logarithmic, and the first below the second.
    pub range: (f64, f64),
    /// Whether it is logarithmic.
    pub log: bool,
}

/// A picture (SVG text) of lines: panels in `columns` columns on common axes, one legend above them.
pub fn draw_lines(captions: &LineCaptions, axis: LineAxis, panels: &[LinePanel], columns: usize) -> String {
    let columns = columns.clamp(1, panels.len().max(1));
    let rows = panels.len().div_ceil(columns).max(1);
    let layout = Layout::new(captions, axis, panels, columns);
    let height = layout.top + STRIDE_Y * (rows - 1) as f64 + PLOT_HEIGHT + BELOW;
    let mut canvas = Canvas::new(layout.width, height, captions.title);
    layout.draw_labels(&mut canvas, captions, height);
    layout.draw_legend(&mut canvas);
    for (i, panel) in panels.iter().enumerate() {
        panel.draw(
            &mut canvas,
            &layout.frame(i),
            Labelled {
                x: i + columns >= panels.len(),
                y: i % columns == 0,
            },
        );
    }
    if panels.is_empty() {
        layout.frame(0).outline(&mut canvas);
        no_data(&mut canvas, &layout.frame(0));
    }
    canvas.finish()
}

/// One entry of the legend.
enum Sign {
    Line(Stroke),
    Cross,
    Shade,
}

struct Layout {
    left: f64,
    top: f64,
    width: f64,
    columns: usize,
    x: Scale,
    y: Scale,
    legend: Vec<(Point, Sign, String)>,
}

impl Layout {
    fn new(captions: &LineCaptions, axis: LineAxis, panels: &[LinePanel], columns: usize) -> Layout {
        let places = |panel: &LinePanel| {
            let lines = panel.lines.iter().flat_map(|line| &line.points);
            let points = lines.chain(&panel.reference).map(|(x, _)| *x);
            points
                .chain(panel.shaded.iter().flat_map(|area| [area[0], area[1]]))
                .collect::<Vec<_>>()
        };
        let x = Scale::linear(panels.iter().flat_map(places), 0.0);
        let ends = [axis.range.0, axis.range.1].into_iter();
        let y = if axis.log {
            Scale::log(ends, 0.0)
        } else {
            Scale::linear(ends, 0.0)
        };
        let left = EDGE + LABEL + GAP + widest(&y_ticks(&y, PLOT_HEIGHT)) + GAP;
        let width = left + STRIDE_X * (columns - 1) as f64 + PLOT_WIDTH + EDGE;
        let (legend, rows) = flow(signs(captions, panels), (left, 56.0), width - EDGE);
        Layout {
            left,
            top: 56.0 + ROW * rows as f64 + 20.0,
            width,
            columns,
            x,
            y,
            legend,
        }
    }

    fn frame(&self, i: usize) -> Frame {
        let (row, column) = (i / self.columns, i % self.columns);
        Frame {
            left: self.left + STRIDE_X * column as f64,
            top: self.top + STRIDE_Y * row as f64,
            width: PLOT_WIDTH,
            height: PLOT_HEIGHT,
            x: self.x,
            y: self.y,
        }
    }

    fn draw_labels(&self, canvas: &mut Canvas, captions: &LineCaptions, height: f64) {
        let (title, size) = text::fit(captions.title, TITLE, self.width - self.left - EDGE);
        canvas.text(
            (self.left, 32.0),
            &title,
            Font::new(size, INK, Anchor::Start).bold(),
        );
        let label = |label, exponent| {
            let (name, unit) = text::split_unit(label);
            text::with_unit(name, unit, exponent)
        };
        let font = Font::new(LABEL, INK, Anchor::Middle);
        let x_label = label(captions.x, x_ticks(&self.x, PLOT_WIDTH).exponent);
        let y_label = label(captions.y, y_ticks(&self.y, PLOT_HEIGHT).exponent);
        let centre = (0.5 * (self.left + self.width - EDGE), height - 14.0);
        canvas.text(centre, &x_label, font);
        let middle = 0.5 * (self.top + height - BELOW);
        canvas.text((EDGE + 0.3 * LABEL, middle), &y_label, font.upright());
    }

    fn draw_legend(&self, canvas: &mut Canvas) {
        for ((x, y), sign, label) in &self.legend {
            let (x, y) = (*x, *y);
            match sign {
                Sign::Line(stroke) => canvas.line(&[(x, y), (x + SAMPLE, y)], *stroke),
                Sign::Cross => cross(canvas, (x + 0.5 * SAMPLE, y), INK),
                Sign::Shade => shade(canvas, [x, y - 7.0, x + SAMPLE, y + 7.0]),
            }
            let at = (x + SAMPLE + 8.0, y + 0.35 * TICK);
            canvas.text(at, label, Font::new(TICK, INK, Anchor::Start));
        }
    }
}

/// What the legend explains, each once.
fn signs(captions: &LineCaptions, panels: &[LinePanel]) -> Vec<(Sign, String)> {
    let mut signs: Vec<(Sign, String)> = Vec::new();
    for line in panels.iter().flat_map(|panel| &panel.lines) {
        if signs.iter().all(|(_, label)| *label != line.label) {
            signs.push((Sign::Line(stroke(line.family, line.variant)), line.label.clone()));
        }
    }
    let others = [
        (
            Sign::Line(Stroke::full(REFERENCE, REFERENCE_WIDTH)),
            captions.reference,
        ),
        (Sign::Cross, captions.stopped),
        (Sign::Shade, captions.shaded),
    ];
    let wanted = others.into_iter().filter(|(_, label)| !label.is_empty());
    signs.extend(wanted.map(|(sign, label)| (sign, label.to_owned())));
    signs
}

/// Sets the entries one after another in as many rows as they need.
fn flow(signs: Vec<(Sign, String)>, (left, top): Point, right: f64) -> (Vec<(Point, Sign, String)>, usize) {
    let (mut x, mut row) = (left, 0);
    let mut placed = Vec::with_capacity(signs.len());
    for (sign, label) in signs {
        let width = SAMPLE + 8.0 + text::width(&label, TICK) + 18.0;
        if x + width > right && x > left {
            (x, row) = (left, row + 1);
        }
        placed.push(((x, top + ROW * row as f64), sign, label));
        x += width;
    }
    (placed, row + 1)
}

impl LinePanel {
    fn draw(&self, canvas: &mut Canvas, frame: &Frame, labelled: Labelled) {
        for area in &self.shaded {
            if let (Some(low), Some(high)) =
                (frame.place((area[0], area[2])), frame.place((area[1], area[3])))
            {
                let (bottom, top) = (low.1.min(frame.bottom()), high.1.max(frame.top));
                if top < bottom {
                    shade(canvas, [low.0, top, high.0, bottom]);
                }
            }
        }
        frame.draw(canvas, labelled);
        let name = (frame.left, frame.top - 8.0);
        canvas.text(name, &self.name, Font::new(LABEL, INK, Anchor::Start).bold());
        if self.lines.is_empty() && self.reference.is_empty() && self.shaded.is_empty() {
            return no_data(canvas, frame);
        }
        for piece in pieces(frame, &self.reference) {
            canvas.line(&piece, Stroke::full(REFERENCE, REFERENCE_WIDTH));
        }
        let mut obstacles = Obstacles::new(frame);
        let mut ends: Vec<(Point, &Line)> = Vec::new();
        for line in &self.lines {
            let pieces = pieces(frame, &line.points);
            for piece in &pieces {
                canvas.line(piece, stroke(line.family, line.variant));
                obstacles.line(piece);
            }
            let end = line.points.iter().rev().find_map(|pair| frame.place(*pair));
            if let (false, Some((x, y))) = (line.stopped.is_empty(), end) {
                let end = (x, y.clamp(frame.top, frame.bottom()));
                ends.push((end, line));
                obstacles.marker(end, 6.0);
            }
        }
        for (end, line) in ends {
            let colour = stroke(line.family, line.variant).colour;
            cross(canvas, end, colour);
            let (x, y) = obstacles.place_far(end, &line.stopped, TICK);
            let font = Font::new(TICK, colour, Anchor::Middle).halo();
            canvas.text((x, y + 0.35 * TICK), &line.stopped, font);
        }
    }
}

/// The parts of a line that lie within a frame.
fn pieces(frame: &Frame, points: &[(f64, f64)]) -> Vec<Vec<Point>> {
    let mut pieces: Vec<Vec<Point>> = Vec::new();
    let placed: Vec<Option<Point>> = points.iter().map(|pair| frame.place(*pair)).collect();
    for pair in placed.windows(2) {
        let &[Some(from), Some(to)] = pair else { continue };
        let Some((from, to)) = clipped(frame, from, to) else {
            continue;
        };
        match pieces.last_mut() {
            Some(piece) if piece.last() == Some(&from) => piece.push(to),
            _ => pieces.push(vec![from, to]),
        }
    }
    pieces
}

/// The part of a segment between the lower and the upper edge of a frame.
fn clipped(frame: &Frame, from: Point, to: Point) -> Option<(Point, Point)> {
    let (mut begin, mut end) = (0.0, 1.0);
    let rise = to.1 - from.1;
    for (limit, sign) in [(frame.top, -1.0), (frame.bottom(), 1.0)] {
        let (outside, slope) = (sign * (from.1 - limit), sign * rise);
        if slope == 0.0 && outside > 0.0 {
            return None;
        } else if slope > 0.0 {
            end = f64::min(end, -outside / slope);
        } else if slope < 0.0 {
            begin = f64::max(begin, -outside / slope);
        }
    }
    let at = |part: f64| match part {
        0.0 => from,
        1.0 => to,
        _ => (from.0 + part * (to.0 - from.0), from.1 + part * rise),
    };
    (begin < end).then(|| (at(begin), at(end)))
}

fn cross(canvas: &mut Canvas, (x, y): Point, colour: &'static str) {
    let pen = Stroke::full(colour, 2.5);
    canvas.line(&[(x - 5.0, y - 5.0), (x + 5.0, y + 5.0)], pen);
    canvas.line(&[(x - 5.0, y + 5.0), (x + 5.0, y - 5.0)], pen);
}

/// A shaded rectangle: left, top, right, bottom (px).
fn shade(canvas: &mut Canvas, [left, top, right, bottom]: [f64; 4]) {
    let corners = [(left, top), (right, top), (right, bottom), (left, bottom)];
    canvas.polygon(&corners, SHADE, Stroke::full(SHADE, 0.3));
}

#[cfg(test)]
mod tests {
    use super::{Frame, Scale, pieces};

    #[test]
    fn lines_are_cut_at_the_edges_and_broken_where_there_is_no_number() {
        let unit = Scale {
            low: 0.0,
            high: 1.0,
            log: false,
        };
        let frame = Frame {
            left: 0.0,
            top: 0.0,
            width: 100.0,
            height: 100.0,
            x: unit,
            y: unit,
        };
        let found = pieces(
            &frame,
            &[(0.0, 0.5), (0.2, 0.5), (0.4, 1.5), (0.6, 1.5), (0.8, 0.5)],
        );
        assert_eq!(found.len(), 2);
        assert_eq!(
            found[0].last().map(|p| (p.0.round(), p.1.round())),
            Some((30.0, 0.0))
        );
        assert_eq!(
            found[1].first().map(|p| (p.0.round(), p.1.round())),
            Some((70.0, 0.0))
        );
        let broken = [(0.0, 0.5), (0.2, 0.5), (0.3, f64::NAN), (0.4, 0.5), (0.5, 0.6)];
        assert_eq!(pieces(&frame, &broken).len(), 2);
        assert!(pieces(&frame, &[(0.0, 2.0), (1.0, 3.0)]).is_empty());
    }
}
