//! Finds room for labels beside points.

use super::frame::Frame;
use super::svg::Point;
use super::text;

/// An upright rectangle (px).
#[derive(Clone, Copy)]
struct Area {
    left: f64,
    top: f64,
    right: f64,
    bottom: f64,
}

impl Area {
    fn around((x, y): Point, half_width: f64, half_height: f64) -> Area {
        Area {
            left: x - half_width,
            top: y - half_height,
            right: x + half_width,
            bottom: y + half_height,
        }
    }

    fn overlap(&self, other: &Area) -> f64 {
        let width = self.right.min(other.right) - self.left.max(other.left);
        let height = self.bottom.min(other.bottom) - self.top.max(other.top);
        width.max(0.0) * height.max(0.0)
    }

    fn size(&self) -> f64 {
        (self.right - self.left) * (self.bottom - self.top)
    }
}

/// What labels must not cover.
pub(super) struct Obstacles {
    plot: Area,
    areas: Vec<Area>,
}

impl Obstacles {
    /// None yet; labels stay inside the frame.
    pub fn new(frame: &Frame) -> Obstacles {
        let centre = (frame.left + 0.5 * frame.width, frame.top + 0.5 * frame.height);
        Obstacles {
            plot: Area::around(centre, 0.5 * frame.width, 0.5 * frame.height),
            areas: Vec::new(),
        }
    }

    /// A marker of this reach (px).
    pub fn marker(&mut self, at: Point, reach: f64) {
        self.areas.push(Area::around(at, reach, reach));
    }

    /// A line, as a chain of small squares.
    pub fn line(&mut self, points: &[Point]) {
        for pair in points.windows(2) {
            let &[(x0, y0), (x1, y1)] = pair else { continue };
            let steps = ((x1 - x0).hypot(y1 - y0) / 4.0).ceil().clamp(1.0, 1000.0);
            for i in 0..=steps as usize {
                let t = i as f64 / steps;
                self.areas
                    .push(Area::around((x0 + t * (x1 - x0), y0 + t * (y1 - y0)), 2.0, 2.0));
            }
        }
    }

    /// The centre of the best place for a label beside a point; from then on it is an obstacle itself.
    pub fn place(&mut self, beside: Point, label: &str, size: f64) -> Point {
        self.place_at(beside, label, size, &[11.0, 18.0])
    }

    /// The same where points crowd: the label may stand a few lines away.
    pub fn place_far(&mut self, beside: Point, label: &str, size: f64) -> Point {
        self.place_at(beside, label, size, &[11.0, 18.0, 28.0, 38.0, 48.0, 58.0])
    }

    fn place_at(&mut self, beside: Point, label: &str, size: f64, gaps: &[f64]) -> Point {
        let (half_width, half_height) = (0.5 * text::width(label, size) + 1.0, 0.55 * size);
        let mut best = (beside, f64::INFINITY);
        for (rank, at) in candidates(beside, half_width, half_height, gaps).enumerate() {
            // Between equals the earlier candidate wins.
            let cost = self.cost(&Area::around(at, half_width, half_height)) + 0.5 * rank as f64;
            if cost < best.1 {
                best = (at, cost);
            }
        }
        self.areas.push(Area::around(best.0, half_width, half_height));
        best.0
    }

    /// Covered area (px²); leaving the plot counts more.
    fn cost(&self, label: &Area) -> f64 {
        let covered: f64 = self.areas.iter().map(|area| area.overlap(label)).sum();
        covered + 10.0 * (label.size() - label.overlap(&self.plot))
    }
}

/// Near before far, and the side towards the origin first: no data lie on that side of the best points.
fn candidates((x, y): Point, half_width: f64, half_height: f64, gaps: &[f64]) -> impl Iterator<Item = Point> {
    const SIDES: [Point; 8] = [
        (-0.8, 0.8),
        (-1.0, 0.0),
        (0.0, 1.0),
        (0.0, -1.0),
        (1.0, 0.0),
        (-0.8, -0.8),
        (0.8, 0.8),
        (0.8, -0.8),
    ];
    gaps.iter().flat_map(move |gap| {
        SIDES.map(|(dx, dy)| (x + dx * (half_width + gap), y + dy * (half_height + gap)))
    })
}
