//! A reconstruction used alone: fit a 2-D field with six Taylor functions per cell, no time stepping.
//!
//! `cargo run --release --example fit_field`

use std::error::Error;

use materialpoint::grid::Grid;
use materialpoint::particles::Bins;
use materialpoint::reconstruction::{Cloud, Reconstruction, Taylor};
use nalgebra::{SVector, vector};

/// The field, its integral over a cell `[x, x + 1] x [y, y + 1]`.
fn field(x: &SVector<f64, 2>) -> f64 {
    x[0].sin() * x[1].cos()
}

fn cell_integral(x: f64, y: f64) -> f64 {
    (x.cos() - (x + 1.0).cos()) * ((y + 1.0).sin() - y.sin())
}

/// What the fit is worth.
#[derive(Clone, Copy, Debug)]
pub struct Quality {
    /// Root mean square error over the Gauss points.
    pub rms: f64,
    /// Error of the integral over the whole domain.
    pub integral: f64,
}

/// Fits `sin x cos y` on 25 unit cells from six points each, keeping every cell's integral.
pub fn run() -> Result<Quality, Box<dyn Error>> {
    let grid = Grid::new(vector![0.0, 0.0], vector![5.0, 5.0], [5, 5])?;
    let mut positions = Vec::new();
    for cell in 0..grid.cell_count() {
        let [i, j] = grid.cell(cell).map(f64::from);
        for x in [1.0 / 3.0, 2.0 / 3.0] {
            for y in [0.25, 0.5, 0.75] {
                positions.push(vector![i + x, j + y]);
            }
        }
    }
    let volumes = vec![1.0 / 6.0; positions.len()];
    let bins = Bins::new(&grid, &positions).map_err(|outside| format!("point {} is outside", outside.0))?;
    let cloud = Cloud::new(&grid, &bins, &positions, &volumes)?;

    let mut fit = Taylor::<f64, 2, 6>::new();
    fit.prepare(&cloud);
    let value = |p: usize| field(&positions[p]);
    let mean = |cell: &[u32; 2]| cell_integral(f64::from(cell[0]), f64::from(cell[1]));
    let (mut squares, mut count, mut integral) = (0.0, 0.0, 0.0);
    fit.integrate_with_mean(&cloud, value, mean, |point, weighted: f64| {
        // Four Gauss points share a cell of volume 1.
        squares += (4.0 * weighted - field(&point.position)).powi(2);
        count += 1.0;
        integral += weighted;
    });
    let exact = (1.0 - 5.0_f64.cos()) * 5.0_f64.sin();
    Ok(Quality {
        rms: (squares / count).sqrt(),
        integral: (integral - exact).abs(),
    })
}

// The tests include this file as a module and call `run` themselves.
#[allow(dead_code)]
fn main() -> Result<(), Box<dyn Error>> {
    let Quality { rms, integral } = run()?;
    println!("sin x cos y with six functions: RMS error {rms:.6e}, error of the integral {integral:.1e}");
    Ok(())
}
