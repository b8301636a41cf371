//! An SVG picture, built from a few primitives: lines, polygons, discs, rectangles and text.

use super::style::FONT;
use super::text::escape;

/// A point of the picture (px), y downwards.
pub(super) type Point = (f64, f64);

/// How a line is drawn.
#[derive(Clone, Copy)]
pub(super) struct Stroke {
    pub colour: &'static str,
    /// Width (px).
    pub width: f64,
    /// Lengths of dashes and gaps (px); empty for a full line.
    pub dash: &'static str,
}

impl Stroke {
    pub fn full(colour: &'static str, width: f64) -> Stroke {
        Stroke {
            colour,
            width,
            dash: "",
        }
    }

    fn attributes(self) -> String {
        let Stroke { colour, width, dash } = self;
        let dash = if dash.is_empty() {
            String::new()
        } else {
            format!(" stroke-dasharray=\"{dash}\"")
        };
        format!("stroke=\"{colour}\" stroke-width=\"{width}\"{dash} stroke-linejoin=\"round\"")
    }
}

/// Which part of a text stands at its point.
#[derive(Clone, Copy)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

/// How a text is drawn.
#[derive(Clone, Copy)]
pub(super) struct Font {
    /// Height (px).
    pub size: f64,
    pub colour: &'static str,
    pub anchor: Anchor,
    pub bold: bool,
    /// White rim that keeps the text legible above lines.
    pub halo: bool,
    /// Upwards, for the label of a vertical axis.
    pub upright: bool,
}

impl Font {
    pub fn new(size: f64, colour: &'static str, anchor: Anchor) -> Font {
        Font {
            size,
            colour,
            anchor,
            bold: false,
            halo: false,
            upright: false,
        }
    }

    pub fn bold(self) -> Font {
        Font { bold: true, ..self }
    }

    pub fn halo(self) -> Font {
        Font { halo: true, ..self }
    }

    pub fn upright(self) -> Font {
        Font {
            upright: true,
            ..self
        }
    }
}

/// A picture in the making.
pub(super) struct Canvas {
    width: f64,
    height: f64,
    title: String,
    body: String,
}

impl Canvas {
    /// An empty white picture; the title is for readers who cannot see it.
    pub fn new(width: f64, height: f64, title: &str) -> Canvas {
        Canvas {
            width,
            height,
            title: escape(title),
            body: String::new(),
        }
    }

    /// An open line through points.
    pub fn line(&mut self, points: &[Point], stroke: Stroke) {
        if points.len() > 1 {
            let (points, attributes) = (joined(points), stroke.attributes());
            self.add(&format!(
                "<polyline points=\"{points}\" fill=\"none\" {attributes}/>"
            ));
        }
    }

    /// A closed, filled line through points.
    pub fn polygon(&mut self, points: &[Point], fill: &str, stroke: Stroke) {
        let (points, attributes) = (joined(points), stroke.attributes());
        self.add(&format!(
            "<polygon points=\"{points}\" fill=\"{fill}\" {attributes}/>"
        ));
    }

    /// A circle with a rim.
    pub fn circle(&mut self, (x, y): Point, radius: f64, fill: &str, stroke: Stroke) {
        let attributes = stroke.attributes();
        self.add(&format!(
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius}\" fill=\"{fill}\" {attributes}/>"
        ));
    }

    /// Many discs of one colour.
    pub fn discs(&mut self, centres: &[Point], radius: f64, fill: &str) {
        self.add(&format!("<g fill=\"{fill}\">"));
        for (x, y) in centres {
            self.add(&format!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius}\"/>"));
        }
        self.add("</g>");
    }

    /// Many small discs of one colour, as ends of lines without length: a third of the text that circles
    /// take.
    pub fn dots(&mut self, centres: &[Point], radius: f64, colour: &str) {
        let path: String = centres.iter().map(|(x, y)| format!("M{x:.1} {y:.1}h0")).collect();
        let width = 2.0 * radius;
        self.add(&format!(
            "<path d=\"{path}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width:.1}\" stroke-linecap=\"round\"/>"
        ));
    }

    /// Many rectangles of one colour, upper left corner and size (px); neighbours meet without a seam.
    pub fn tiles(&mut self, tiles: &[(Point, Point)], colour: &str) {
        let tile = |((x, y), (w, h)): &(Point, Point)| format!("M{x:.2} {y:.2}h{w:.2}v{h:.2}h-{w:.2}z");
        let path: String = tiles.iter().map(tile).collect();
        self.add(&format!(
            "<path d=\"{path}\" fill=\"{colour}\" shape-rendering=\"crispEdges\"/>"
        ));
    }

    /// A line of text.
    pub fn text(&mut self, (x, y): Point, text: &str, font: Font) {
        let (text, Font { size, colour, .. }) = (escape(text), font);
        let anchor = match font.anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let bold = if font.bold { " font-weight=\"bold\"" } else { "" };
        let turn = if font.upright {
            format!(" transform=\"rotate(-90 {x:.1} {y:.1})\"")
        } else {
            String::new()
        };
        let place =
            format!("x=\"{x:.1}\" y=\"{y:.1}\" font-size=\"{size:.1}\" text-anchor=\"{anchor}\"{bold}{turn}");
        if font.halo {
            // An element of its own: not every viewer paints a stroke behind its filling when asked to.
            let rim = "fill=\"white\" stroke=\"white\" stroke-width=\"4\" aria-hidden=\"true\"";
            self.add(&format!("<text {place} {rim}>{text}</text>"));
        }
        self.add(&format!("<text {place} fill=\"{colour}\">{text}</text>"));
    }

    /// The whole picture as text.
    pub fn finish(self) -> String {
        let Canvas {
            width,
            height,
            title,
            body,
        } = self;
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width:.0}\" height=\"{height:.0}\" \
             viewBox=\"0 0 {width:.0} {height:.0}\" role=\"img\" font-family=\"{FONT}\">\n\
             <title>{title}</title>\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n{body}</svg>\n"
        )
    }

    fn add(&mut self, element: &str) {
        self.body.push_str(element);
        self.body.push('\n');
    }
}

fn joined(points: &[Point]) -> String {
    let points: Vec<String> = points.iter().map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
    points.join(" ")
}
