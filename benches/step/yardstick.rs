//! The yardstick: one step of plain MPM as a C programmer would write it, arrays and loops, nothing general.
//!
//! One dimension, Hill's law, both ends fixed, Shepard: the same work as the stepper's, without its checks
//! and diagnostics.

/// Particles and DOFs.
pub struct Bar {
    cells: usize,
    inverse_h: f64,
    modulus: f64,
    pub x: Vec<f64>,
    u: Vec<f64>,
    v: Vec<f64>,
    stress: Vec<f64>,
    mass: Vec<f64>,
    volume: Vec<f64>,
    dof_mass: Vec<f64>,
    force: Vec<f64>,
    momentum: Vec<f64>,
}

impl Bar {
    /// A bar from 0 to 1 with the given initial positions and velocities.
    pub fn new(cells: usize, x: Vec<f64>, v: Vec<f64>, density: f64, modulus: f64) -> Self {
        let n = x.len();
        let dofs = cells + 2;
        Self {
            cells,
            inverse_h: cells as f64,
            modulus,
            x,
            u: vec![0.0; n],
            v,
            stress: vec![0.0; n],
            mass: vec![density / n as f64; n],
            volume: vec![1.0 / n as f64; n],
            dof_mass: vec![0.0; dofs],
            force: vec![0.0; dofs],
            momentum: vec![0.0; dofs],
        }
    }

    /// One step with linear functions.
    #[inline(never)]
    pub fn step_linear(&mut self, dt: f64) {
        let (n, dofs, ih) = (self.x.len(), self.cells + 1, self.inverse_h);
        self.clear();
        for p in 0..n {
            let s = self.x[p] * ih;
            let i = s as usize;
            let w = s - i as f64;
            let f = self.stress[p] * self.volume[p] * ih;
            self.dof_mass[i] += self.mass[p] * (1.0 - w);
            self.dof_mass[i + 1] += self.mass[p] * w;
            self.force[i] += f;
            self.force[i + 1] -= f;
        }
        divide(&mut self.force, &self.dof_mass, dofs);
        for p in 0..n {
            let s = self.x[p] * ih;
            let i = s as usize;
            let w = s - i as f64;
            self.v[p] += dt * (self.force[i] * (1.0 - w) + self.force[i + 1] * w);
            let q = self.mass[p] * self.v[p];
            self.momentum[i] += q * (1.0 - w);
            self.momentum[i + 1] += q * w;
        }
        divide(&mut self.momentum, &self.dof_mass, dofs);
        for p in 0..n {
            let s = self.x[p] * ih;
            let i = s as usize;
            let w = s - i as f64;
            let dx = dt * (self.momentum[i] * (1.0 - w) + self.momentum[i + 1] * w);
            let strain = dt * ih * (self.momentum[i + 1] - self.momentum[i]);
            self.advance(p, dx, strain);
        }
    }

    /// One step with quadratic B-splines.
    #[inline(never)]
    pub fn step_quadratic(&mut self, dt: f64) {
        let (n, dofs, ih) = (self.x.len(), self.cells + 2, self.inverse_h);
        self.clear();
        for p in 0..n {
            let (i, phi, slope) = quadratic(self.x[p] * ih, self.cells);
            let f = self.stress[p] * self.volume[p] * ih;
            for k in 0..3 {
                self.dof_mass[i + k] += self.mass[p] * phi[k];
                self.force[i + k] -= f * slope[k];
            }
        }
        divide(&mut self.force, &self.dof_mass, dofs);
        for p in 0..n {
            let (i, phi, _) = quadratic(self.x[p] * ih, self.cells);
            let a = self.force[i] * phi[0] + self.force[i + 1] * phi[1] + self.force[i + 2] * phi[2];
            self.v[p] += dt * a;
            let q = self.mass[p] * self.v[p];
            for k in 0..3 {
                self.momentum[i + k] += q * phi[k];
            }
        }
        divide(&mut self.momentum, &self.dof_mass, dofs);
        for p in 0..n {
            let (i, phi, slope) = quadratic(self.x[p] * ih, self.cells);
            let (mut v, mut gradient) = (0.0, 0.0);
            for k in 0..3 {
                v += self.momentum[i + k] * phi[k];
                gradient += self.momentum[i + k] * slope[k];
            }
            self.advance(p, dt * v, dt * ih * gradient);
        }
    }

    fn clear(&mut self) {
        self.dof_mass.fill(0.0);
        self.force.fill(0.0);
        self.momentum.fill(0.0);
    }

    #[inline(always)]
    fn advance(&mut self, p: usize, dx: f64, strain: f64) {
        self.x[p] += dx;
        self.u[p] += dx;
        self.stress[p] += strain * (self.modulus - self.stress[p]);
        self.volume[p] *= 1.0 + strain;
    }
}

/// Values of the DOFs from sums and masses, zero at the fixed ends.
fn divide(sums: &mut [f64], mass: &[f64], dofs: usize) {
    for i in 0..dofs {
        sums[i] = if mass[i] > 0.0 { sums[i] / mass[i] } else { 0.0 };
    }
    sums[0] = 0.0;
    sums[dofs - 1] = 0.0;
}

/// First DOF, values and slopes (per cell) of the quadratic B-splines on open knots at `s` cells from the
/// left end.
#[inline(always)]
fn quadratic(s: f64, cells: usize) -> (usize, [f64; 3], [f64; 3]) {
    let i = s as usize;
    let w = s - i as f64;
    let z = 1.0 - w;
    if i == 0 {
        let phi = [z * z, w * (2.0 - 1.5 * w), 0.5 * w * w];
        (i, phi, [-2.0 * z, 2.0 - 3.0 * w, w])
    } else if i == cells - 1 {
        let phi = [0.5 * z * z, z * (2.0 - 1.5 * z), w * w];
        (i, phi, [-z, 3.0 * z - 2.0, 2.0 * w])
    } else {
        let phi = [0.5 * z * z, 0.5 + w * z, 0.5 * w * w];
        (i, phi, [-z, 1.0 - 2.0 * w, w])
    }
}
