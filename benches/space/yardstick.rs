//! The yardstick: the same step as a C programmer would write it, arrays and loops, nothing general.
//!
//! Two dimensions, quadratic B-splines, Shepard, Hooke's law, MUSL, without the stepper's checks and
//! diagnostics, in the order in which the particles come. The body keeps off the outermost cells, so the
//! repeated knots there are left out.

use super::body::{Body, DENSITY, POISSON, YOUNG, velocity};

/// Particles and DOFs.
pub struct Plain {
    dofs: usize,
    inverse_h: f64,
    lambda: f64,
    mu: f64,
    x: Vec<[f64; 2]>,
    u: Vec<[f64; 2]>,
    v: Vec<[f64; 2]>,
    stress: Vec<[f64; 4]>,
    mass: Vec<f64>,
    volume: Vec<f64>,
    dof_mass: Vec<f64>,
    force: Vec<[f64; 2]>,
    momentum: Vec<[f64; 2]>,
}

impl Plain {
    pub fn new(body: Body) -> Self {
        let points = body.points::<2>();
        let n = points.len();
        // Two cells more on every side, so that no particle meets the grid's end.
        let dofs = body.cells + 6;
        Self {
            dofs,
            inverse_h: body.cells as f64,
            lambda: YOUNG * POISSON / ((1.0 + POISSON) * (1.0 - 2.0 * POISSON)),
            mu: YOUNG / (2.0 * (1.0 + POISSON)),
            x: points.iter().map(|(x, _)| [x[0], x[1]]).collect(),
            u: vec![[0.0; 2]; n],
            v: points.iter().map(|(x, _)| velocity(x).into()).collect(),
            stress: vec![[0.0; 4]; n],
            mass: points.iter().map(|(_, v)| v * DENSITY).collect(),
            volume: points.iter().map(|(_, v)| *v).collect(),
            dof_mass: vec![0.0; dofs * dofs],
            force: vec![[0.0; 2]; dofs * dofs],
            momentum: vec![[0.0; 2]; dofs * dofs],
        }
    }

    pub fn len(&self) -> usize {
        self.x.len()
    }

    /// One step.
    #[inline(never)]
    pub fn step(&mut self, dt: f64) {
        self.dof_mass.fill(0.0);
        self.force.fill([0.0; 2]);
        self.momentum.fill([0.0; 2]);
        for p in 0..self.x.len() {
            self.sum(p);
        }
        divide(&mut self.force, &self.dof_mass);
        for p in 0..self.x.len() {
            self.accelerate(p, dt);
        }
        divide(&mut self.momentum, &self.dof_mass);
        for p in 0..self.x.len() {
            self.advance(p, dt);
        }
    }

    #[inline(always)]
    fn sum(&mut self, p: usize) {
        let (first, [px, py], [gx, gy]) = self.functions(p);
        let (m, w, s) = (self.mass[p], self.volume[p] * self.inverse_h, self.stress[p]);
        for j in 0..3 {
            for i in 0..3 {
                let dof = first + j * self.dofs + i;
                let (dx, dy) = (gx[i] * py[j] * w, px[i] * gy[j] * w);
                self.dof_mass[dof] += m * px[i] * py[j];
                self.force[dof][0] -= s[0] * dx + s[2] * dy;
                self.force[dof][1] -= s[1] * dx + s[3] * dy;
            }
        }
    }

    #[inline(always)]
    fn accelerate(&mut self, p: usize, dt: f64) {
        let (first, [px, py], _) = self.functions(p);
        let mut a = [0.0; 2];
        for j in 0..3 {
            for i in 0..3 {
                let phi = px[i] * py[j];
                let at_dof = self.force[first + j * self.dofs + i];
                a[0] += at_dof[0] * phi;
                a[1] += at_dof[1] * phi;
            }
        }
        let v = &mut self.v[p];
        *v = [v[0] + dt * a[0], v[1] + dt * a[1]];
        let q = [self.mass[p] * v[0], self.mass[p] * v[1]];
        for j in 0..3 {
            for i in 0..3 {
                let phi = px[i] * py[j];
                let momentum = &mut self.momentum[first + j * self.dofs + i];
                momentum[0] += q[0] * phi;
                momentum[1] += q[1] * phi;
            }
        }
    }

    #[inline(always)]
    fn advance(&mut self, p: usize, dt: f64) {
        let (first, [px, py], [gx, gy]) = self.functions(p);
        let (mut v, mut g) = ([0.0; 2], [0.0; 4]);
        for j in 0..3 {
            for i in 0..3 {
                let at_dof = self.momentum[first + j * self.dofs + i];
                let (phi, dx, dy) = (px[i] * py[j], gx[i] * py[j], px[i] * gy[j]);
                v[0] += at_dof[0] * phi;
                v[1] += at_dof[1] * phi;
                g[0] += at_dof[0] * dx;
                g[1] += at_dof[1] * dx;
                g[2] += at_dof[0] * dy;
                g[3] += at_dof[1] * dy;
            }
        }
        for a in 0..2 {
            self.x[p][a] += dt * v[a];
            self.u[p][a] += dt * v[a];
        }
        let s = dt * self.inverse_h;
        let (exx, eyy, exy) = (s * g[0], s * g[3], 0.5 * s * (g[1] + g[2]));
        let pressure = self.lambda * (exx + eyy);
        let stress = &mut self.stress[p];
        stress[0] += pressure + 2.0 * self.mu * exx;
        stress[1] += 2.0 * self.mu * exy;
        stress[2] += 2.0 * self.mu * exy;
        stress[3] += pressure + 2.0 * self.mu * eyy;
    }

    /// First DOF, values and slopes (per cell) along both axes.
    #[inline(always)]
    fn functions(&self, p: usize) -> (usize, [[f64; 3]; 2], [[f64; 3]; 2]) {
        let [x, y] = self.x[p];
        let (i, px, gx) = quadratic(x * self.inverse_h + 2.0);
        let (j, py, gy) = quadratic(y * self.inverse_h + 2.0);
        (j * self.dofs + i, [px, py], [gx, gy])
    }
}

fn divide(sums: &mut [[f64; 2]], mass: &[f64]) {
    for (sum, &m) in sums.iter_mut().zip(mass) {
        *sum = if m > 0.0 {
            [sum[0] / m, sum[1] / m]
        } else {
            [0.0; 2]
        };
    }
}

#[inline(always)]
fn quadratic(s: f64) -> (usize, [f64; 3], [f64; 3]) {
    let i = s as usize;
    let w = s - i as f64;
    let z = 1.0 - w;
    (i, [0.5 * z * z, 0.5 + w * z, 0.5 * w * w], [-z, 1.0 - 2.0 * w, w])
}
