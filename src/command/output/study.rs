//! Error against cost, both logarithmic: which method buys the most accuracy.

use super::frame::{Frame, GAP, Labelled, widest, x_ticks, y_ticks};
use super::labels::Obstacles;
use super::legend;
use super::panel::no_data;
use super::scale::{Scale, positive};
use super::style::{FRONT, GREY, INK, LABEL, MARKER, TICK, TITLE, marker, stroke};
use super::svg::{Anchor, Canvas, Font, Point, Stroke};
use super::text;

const PLOT_WIDTH: f64 = 620.0;
const PLOT_HEIGHT: f64 = 480.0;
const TOP: f64 = 56.0;
const BELOW: f64 = 62.0;
const EDGE: f64 = 24.0;

/// One method of a study.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Curve {
    /// Name of the method, such as `linear + Taylor`.
    pub label: String,
    /// Number of its basis: colour, and filling of the marker.
    pub family: usize,
    /// Number of its reconstruction: shape of the marker, and dash.
    pub variant: usize,
    /// Its results, in the order in which they are joined.
    pub points: Vec<CurvePoint>,
}

/// One run of a study.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CurvePoint {
    /// Cost, such as the time of the run (unit of the x axis).
    pub x: f64,
    /// Error (unit of the y axis).
    pub y: f64,
    /// What stands beside the point if it is on the front, such as `20 cells`; empty for nothing.
    pub label: String,
    /// No other run is both cheaper and more accurate.
    pub on_front: bool,
}

/// A picture (SVG text) of a study: error against cost, both axes logarithmic, one curve a method, the legend
/// to the right; the best points are ringed, labelled and joined by a stair.
///
/// Without a best point it is a picture of curves and nothing more: no stair, and no word on which way is
/// better.
///
/// The labels bear their units in brackets. Points that are not positive and finite (a run that
/// stopped may be not a number) are left out and counted.
pub fn draw_study(title: &str, x_label: &str, y_label: &str, curves: &[Curve]) -> String {
    let frame = frame(curves);
    let legend_left = frame.right() + EDGE;
    let width = legend_left + legend::width(curves) + EDGE;
    let mut canvas = Canvas::new(width, frame.bottom() + BELOW, title);
    let (short, size) = text::fit(title, TITLE, width - frame.left - EDGE);
    canvas.text(
        (frame.left, 32.0),
        &short,
        Font::new(size, INK, Anchor::Start).bold(),
    );
    draw_axis_labels(&mut canvas, &frame, x_label, y_label);
    let lost = draw_curves(&mut canvas, &frame, curves);
    legend::draw(&mut canvas, (legend_left, TOP), curves, lost);
    canvas.finish()
}

fn frame(curves: &[Curve]) -> Frame {
    let all = || {
        curves
            .iter()
            .flat_map(|curve| &curve.points)
            .filter(|p| positive(p.x) && positive(p.y))
    };
    let x = Scale::log(all().map(|p| p.x), 0.06);
    let y = Scale::log(all().map(|p| p.y), 0.06);
    let height = PLOT_HEIGHT.max(legend::height(curves));
    let left = EDGE + LABEL + GAP + widest(&y_ticks(&y, height)) + GAP;
    Frame {
        left,
        top: TOP,
        width: PLOT_WIDTH,
        height,
        x,
        y,
    }
}

fn draw_axis_labels(canvas: &mut Canvas, frame: &Frame, x_label: &str, y_label: &str) {
    let label = |label, exponent| {
        let (name, unit) = text::split_unit(label);
        text::with_unit(name, unit, exponent)
    };
    let font = Font::new(LABEL, INK, Anchor::Middle);
    let x_label = label(x_label, x_ticks(&frame.x, frame.width).exponent);
    canvas.text(
        (frame.left + 0.5 * frame.width, frame.bottom() + 46.0),
        &x_label,
        font,
    );
    let y_label = label(y_label, y_ticks(&frame.y, frame.height).exponent);
    canvas.text(
        (EDGE + 0.3 * LABEL, frame.top + 0.5 * frame.height),
        &y_label,
        font.upright(),
    );
}

/// Draws axes, front, curves and labels; returns how many points could not be drawn.
fn draw_curves(canvas: &mut Canvas, frame: &Frame, curves: &[Curve]) -> usize {
    let placed: Vec<Vec<Point>> = curves.iter().map(|curve| placed(frame, curve)).collect();
    let front = front(frame, curves);
    let given: usize = curves.iter().map(|curve| curve.points.len()).sum();
    let drawn: usize = placed.iter().map(Vec::len).sum();
    if drawn == 0 {
        frame.outline(canvas);
        no_data(canvas, frame);
        return given;
    }
    frame.draw(canvas, Labelled { x: true, y: true });
    canvas.line(&stair(&front), Stroke::full(FRONT, 7.0));
    for (curve, points) in curves.iter().zip(&placed) {
        canvas.line(points, stroke(curve.family, curve.variant));
    }
    for (curve, points) in curves.iter().zip(&placed) {
        points
            .iter()
            .for_each(|at| marker(canvas, *at, curve.family, curve.variant));
    }
    front.iter().for_each(|(at, _)| legend::ring(canvas, *at));
    draw_labels(canvas, frame, &placed, &front);
    given - drawn
}

fn placed(frame: &Frame, curve: &Curve) -> Vec<Point> {
    curve
        .points
        .iter()
        .filter_map(|point| frame.place((point.x, point.y)))
        .collect()
}

/// The best points from cheap to accurate, with their labels.
fn front<'a>(frame: &Frame, curves: &'a [Curve]) -> Vec<(Point, &'a str)> {
    let best = curves
        .iter()
        .flat_map(|curve| &curve.points)
        .filter(|point| point.on_front);
    let mut front: Vec<(Point, &str)> = best
        .filter_map(|p| Some((frame.place((p.x, p.y))?, p.label.as_str())))
        .collect();
    front.sort_by(|(a, _), (b, _)| a.0.total_cmp(&b.0));
    front
}

/// From each best point the error stays until the next one is affordable.
fn stair(front: &[(Point, &str)]) -> Vec<Point> {
    let mut stair: Vec<Point> = Vec::new();
    for ((x, y), _) in front {
        stair.extend(stair.last().map(|before| (*x, before.1)));
        stair.push((*x, *y));
    }
    stair
}

fn draw_labels(canvas: &mut Canvas, frame: &Frame, placed: &[Vec<Point>], front: &[(Point, &str)]) {
    let mut obstacles = Obstacles::new(frame);
    for points in placed {
        obstacles.line(points);
        points.iter().for_each(|at| obstacles.marker(*at, MARKER + 1.5));
    }
    front
        .iter()
        .for_each(|(at, _)| obstacles.marker(*at, MARKER + 6.0));
    if !front.is_empty() {
        draw_hint(canvas, frame, &mut obstacles);
    }
    for (at, label) in front.iter().filter(|(_, label)| !label.is_empty()) {
        let (x, y) = obstacles.place(*at, label, TICK);
        canvas.text(
            (x, y + 0.35 * TICK),
            label,
            Font::new(TICK, INK, Anchor::Middle).halo(),
        );
    }
}

/// Which way is better, in the corner that the best points point to.
fn draw_hint(canvas: &mut Canvas, frame: &Frame, obstacles: &mut Obstacles) {
    let (x, y) = (frame.left + 14.0, frame.bottom() - 14.0);
    let pen = Stroke::full(GREY, 1.6);
    canvas.line(&[(x + 20.0, y - 20.0), (x, y)], pen);
    canvas.line(&[(x, y - 9.0), (x, y), (x + 9.0, y)], pen);
    canvas.text(
        (x + 26.0, y - 14.0),
        "better",
        Font::new(TICK, GREY, Anchor::Start).halo(),
    );
    obstacles.marker((x + 36.0, y - 14.0), 30.0);
}
