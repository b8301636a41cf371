//! Virtual points: the journal's Figures 4 and 5, drawn anew for `docs/verification/stability.md`.
//!
//! `cargo run --release --example virtual_points` draws `docs/pictures/virtual-points.svg` and prints the
//! errors.
//!
//! Source: Wobbes, Moeller, Galavi & Vuik, Int. J. Numer. Methods Eng. 117 (2019), section 5.3: `sin x + 2`
//! on `[0, 4 pi]` in four cells from eleven points. The second cell holds two, at `pi` and `5 pi/3`, where
//! the quadratic function is -1/3 of the linear one. Nine places are not published and chosen here; the three
//! of the third cell are uniform, as the journal says.

use std::error::Error;
use std::f64::consts::PI;
use std::path::Path;

use materialpoint::field::Pair;
use materialpoint::grid::Grid;
use materialpoint::particles::Bins;
use materialpoint::reconstruction::{Cloud, CubicSpline, Reconstruction, Taylor};
use materialpoint_command::output::{Folder, Line, LineAxis, LineCaptions, LinePanel, draw_lines};
use nalgebra::vector;

/// The eleven places, in units of pi.
const PLACES: [f64; 11] = [0.0, 0.35, 0.7, 1.0, 5.0 / 3.0, 2.25, 2.5, 2.75, 3.15, 3.5, 3.9];

/// Gauss points per cell at which errors are taken, as in the journal.
const GAUSS_POINTS: usize = 100;

fn field(x: f64) -> f64 {
    x.sin() + 2.0
}

/// Its mean over the cell with number `cell`: the integral that the reconstruction is told to keep.
fn mean(cell: u32) -> f64 {
    let low = f64::from(cell) * PI;
    2.0 + (low.cos() - (low + PI).cos()) / PI
}

/// A reconstruction of the field and what it is worth.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Places and values of the reconstruction.
    pub curve: Vec<(f64, f64)>,
    /// Root mean square error over all cells.
    pub rms: f64,
    /// The same over the second cell.
    pub rms_of_cell: f64,
    /// Error of the integral, relative.
    pub integral: f64,
}

impl Outcome {
    /// Of values at places with weights, cell by cell.
    fn of(points: &[(f64, f64, f64)]) -> Self {
        let square = |points: &[(f64, f64, f64)]| {
            let sum = |f: &dyn Fn(&(f64, f64, f64)) -> f64| points.iter().map(f).sum::<f64>();
            let errors = sum(&|&(x, value, weight)| weight * (value - field(x)).powi(2));
            (errors / sum(&|&(.., weight)| weight)).sqrt()
        };
        let integral: f64 = points.iter().map(|&(_, value, weight)| value * weight).sum();
        let count = points.len() / 4;
        Self {
            curve: points.iter().map(|&(x, value, _)| (x, value)).collect(),
            rms: square(points),
            rms_of_cell: square(&points[count..2 * count]),
            integral: (integral / (8.0 * PI) - 1.0).abs(),
        }
    }
}

/// All that the picture shows.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// Taylor least squares with fewer functions in the second cell.
    pub without: Outcome,
    /// With virtual points at its edges.
    pub with: Outcome,
    /// The cubic spline.
    pub spline: Outcome,
    /// Cells with virtual points.
    pub virtual_cells: usize,
}

/// Reconstructs the field in three ways.
pub fn run() -> Result<Comparison, Box<dyn Error>> {
    let grid = Grid::new(vector![0.0], vector![4.0 * PI], [4])?;
    let positions = PLACES.map(|place| vector![place * PI]);
    let volumes = [1.0; PLACES.len()];
    let bins = Bins::new(&grid, &positions).map_err(|outside| format!("point {} is outside", outside.0))?;
    let cloud = Cloud::new(&grid, &bins, &positions, &volumes)?;
    let value = |p: usize| field(positions[p][0]);
    let taylor = |lent: bool| {
        let mut fit = Taylor::<f64, 1, 3>::with_gauss_points(GAUSS_POINTS).with_virtual_points(lent);
        fit.prepare(&cloud);
        let mut points = Vec::new();
        // Beside the value a one, which brings the weight.
        fit.integrate_with_mean(
            &cloud,
            |p| Pair(value(p), 1.0),
            |cell: &[u32; 1]| Pair(mean(cell[0]), 1.0),
            |point, Pair(weighted, weight): Pair<f64, f64>| {
                points.push((point.position[0], weighted / weight, weight));
            },
        );
        (Outcome::of(&points), fit.virtual_cells(), points)
    };
    let (without, ..) = taylor(false);
    let (with, virtual_cells, mut points) = taylor(true);
    let mut spline = CubicSpline::for_degree(1);
    spline.prepare(&cloud);
    let weights: Vec<f64> = points.iter().map(|point| point.2).collect();
    let places: Vec<f64> = points.drain(..).map(|point| point.0).collect();
    let mut weights = weights.into_iter();
    spline.at_points(value, places.into_iter(), |x, found| {
        points.extend(weights.next().map(|weight| (x, found, weight)));
    });
    Ok(Comparison {
        without,
        with,
        spline: Outcome::of(&points),
        virtual_cells,
    })
}

/// One of the two figures: the cell in shade, the data as crosses, and what is `lent` to the cell.
fn panel(name: &str, taylor: &Outcome, spline: &Outcome, lent: &[(f64, f64)]) -> LinePanel {
    let line = |label: &str, family, variant, points| Line {
        label: label.into(),
        family,
        variant,
        points,
        stopped: String::new(),
    };
    let mut lines = vec![
        line("cubic spline", 1, 1, spline.curve.clone()),
        line("Taylor least squares", 0, 0, taylor.curve.clone()),
    ];
    let data = PLACES.map(|place| place * PI);
    let crosses = data.iter().map(|&x| Line {
        stopped: " ".into(),
        ..line("Taylor least squares", 0, 0, vec![(x, field(x))])
    });
    lines.extend(crosses);
    lines.extend(lent.iter().map(|&point| Line {
        stopped: "virtual".into(),
        ..line("Taylor least squares", 0, 0, vec![point])
    }));
    let exact = (0..=200).map(|k| f64::from(k) * PI / 50.0);
    LinePanel {
        name: name.into(),
        lines,
        reference: exact.map(|x| (x, field(x))).collect(),
        shaded: vec![[PI, 2.0 * PI, 0.0, 4.0]],
    }
}

/// The picture.
pub fn picture(found: &Comparison) -> String {
    let captions = LineCaptions {
        title: "A cell with points at pi and 5 pi/3 only",
        x: "x [-]",
        y: "sin x + 2 [-]",
        reference: "exact",
        stopped: "data point",
        shaded: "the cell",
    };
    let axis = LineAxis {
        range: (0.0, 4.0),
        log: false,
    };
    // What the neighbours say at their Gauss points next to the edges is what they say there, as far as one
    // can see.
    let lent = [
        (PI, found.with.curve[GAUSS_POINTS - 1].1),
        (2.0 * PI, found.with.curve[2 * GAUSS_POINTS].1),
    ];
    let panels = [
        panel("fewer functions (figure 4)", &found.without, &found.spline, &[]),
        panel("virtual points (figure 5)", &found.with, &found.spline, &lent),
    ];
    draw_lines(&captions, axis, &panels, 2)
}

// The tests include this file as a module and call `run` and `picture` themselves.
#[allow(dead_code)]
fn main() -> Result<(), Box<dyn Error>> {
    let found = run()?;
    for (name, outcome) in [
        ("fewer functions", &found.without),
        ("virtual points", &found.with),
        ("cubic spline", &found.spline),
    ] {
        let Outcome {
            rms,
            rms_of_cell,
            integral,
            ..
        } = outcome;
        println!(
            "{name}: RMS error {rms:.4e}, of the cell {rms_of_cell:.4e}; of the integral {integral:.1e}"
        );
    }
    Folder::create(Path::new("docs/pictures"))?.write("virtual-points.svg", &picture(&found))?;
    Ok(())
}
