//! The semi-discrete equations on spectral elements.

use super::super::{Soil, TwoPhaseState};
use super::fields::{Fields, Rates};
use super::mesh::Mesh;
use super::{SoilEnd, SoilProblem};
use crate::reference::lagrangian_bar::HIGHEST_DEGREE;
use crate::reference::{ReferenceError, Resolution, UniaxialLaw, check};

/// Mesh, constants and all else that does not change in time.
#[derive(Clone, Debug)]
pub(super) struct Operator {
    pub(super) mesh: Mesh,
    soil: Soil,
    small_strain: bool,
    ends: [SoilEnd; 2],
    pore_load: f64,
    /// Mass of the solid at each node, kg/m2.
    solid_mass: Vec<f64>,
    /// Initial effective stress at each point, Pa.
    initial_stress: Vec<f64>,
}

/// Total stress of drained ends, Pa, and body force, N/kg, at one time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Loads {
    pub(super) time: f64,
    pub(super) load: f64,
    pub(super) body_force: f64,
}

impl Operator {
    /// The equations of `problem` on the mesh of `resolution`, both of them checked.
    pub(super) fn new<L>(
        problem: &SoilProblem<L>,
        resolution: Resolution,
        level: usize,
    ) -> Result<Self, ReferenceError> {
        let refined = problem.ends.map(|end| end == SoilEnd::Drained);
        let mesh = Mesh::new(problem.height, resolution, refined, level);
        let soil = problem.soil;
        let mut solid_mass = vec![0.0; mesh.node_count()];
        for (element, first) in mesh.first_nodes().enumerate() {
            for (mass, weight) in solid_mass[first..].iter_mut().zip(mesh.weights(element)) {
                *mass += weight * soil.solid_fraction() * soil.solid_density;
            }
        }
        let [effective, _] = &problem.stresses;
        let initial_stress = (0..mesh.point_count())
            .map(|point| check::finite("initial effective stress", effective(mesh.point(point))))
            .collect::<Result<_, _>>()?;
        Ok(Self {
            mesh,
            soil,
            small_strain: problem.small_strain,
            ends: problem.ends,
            pore_load: problem.pore_load,
            solid_mass,
            initial_stress,
        })
    }

    /// Sets nodal values at fixed ends to 0.
    pub(super) fn hold(&self, values: &mut [f64]) {
        for (end, value) in self.end_nodes() {
            if end == SoilEnd::Fixed {
                values[value] = 0.0;
            }
        }
    }

    fn end_nodes(&self) -> [(SoilEnd, usize); 2] {
        let [base, top] = self.ends;
        [(base, 0), (top, self.solid_mass.len() - 1)]
    }

    /// Writes the rates of `fields`.
    pub(super) fn rates(
        &self,
        law: &impl UniaxialLaw,
        loads: Loads,
        fields: &Fields,
        out: &mut Rates,
    ) -> Result<(), ReferenceError> {
        let (n, width) = (self.soil.porosity, self.mesh.width());
        let [mixed, effective, pore] = &mut [[0.0; HIGHEST_DEGREE + 1]; 3];
        let (mixed, effective, pore) = (&mut mixed[..width], &mut effective[..width], &mut pore[..width]);
        let resistance = n * n * self.soil.unit_weight() / self.soil.permeability;
        for values in [
            &mut out.fields.solid,
            &mut out.fields.liquid,
            &mut out.drag,
            &mut out.share,
        ] {
            values.fill(0.0);
        }
        for (index, first) in self.mesh.first_nodes().enumerate() {
            let nodes = first..first + width;
            let points = index * width..(index + 1) * width;
            for ((mixed, solid), liquid) in mixed
                .iter_mut()
                .zip(&fields.solid[nodes.clone()])
                .zip(&fields.liquid[nodes.clone()])
            {
                *mixed = (1.0 - n) * solid + n * liquid;
            }
            let strains = self.mesh.derivatives(index, &fields.displacement[nodes.clone()]);
            let inflows = self.mesh.derivatives(index, mixed);
            for (q, ((strain, inflow), weight)) in
                strains.zip(inflows).zip(self.mesh.weights(index)).enumerate()
            {
                let (stretch, point) = (1.0 + strain, points.start + q);
                if !is_valid_volume(stretch) {
                    return Err(self.invalid_stretch(point, stretch, loads.time));
                }
                let geometry = self.geometry(stretch);
                let pressure = fields.pressure[point];
                out.fields.pressure[point] = self.soil.locked_stiffness() / geometry * inflow;
                effective[q] = law.stress(stretch) + self.initial_stress[point] + (1.0 - n) * pressure;
                pore[q] = n * pressure;
                out.share[first + q] += weight * n * self.soil.liquid_density * geometry;
                out.drag[first + q] += weight * resistance * self.drag_factor(geometry);
            }
            self.mesh
                .subtract_forces(effective, &mut out.fields.solid[nodes.clone()]);
            self.mesh.subtract_forces(pore, &mut out.fields.liquid[nodes]);
        }
        self.accelerate(loads, fields, out);
        Ok(())
    }

    /// Turns forces, masses of the liquid and drag coefficients into accelerations, shares and rates.
    fn accelerate(&self, loads: Loads, fields: &Fields, out: &mut Rates) {
        let rates = &mut out.fields;
        let liquid_load = self.soil.porosity * self.pore_load;
        for ((end, node), outward) in self.end_nodes().into_iter().zip([-1.0, 1.0]) {
            if end == SoilEnd::Drained {
                rates.solid[node] += outward * (loads.load - liquid_load);
                rates.liquid[node] += outward * liquid_load;
            }
        }
        for (node, &solid) in self.solid_mass.iter().enumerate() {
            let (liquid, coefficient) = (out.share[node], out.drag[node]);
            let drag = coefficient * fields.relative(node);
            rates.solid[node] = (rates.solid[node] + drag) / solid + loads.body_force;
            rates.liquid[node] = (rates.liquid[node] - drag) / liquid + loads.body_force;
            out.drag[node] = coefficient * (1.0 / solid + 1.0 / liquid);
            out.share[node] = liquid / (solid + liquid);
        }
        self.hold(&mut rates.solid);
        self.hold(&mut rates.liquid);
        rates.displacement.copy_from_slice(&fields.solid);
    }

    /// Bound, rad/s, of the largest frequency of small motions without drag about `displacement`.
    pub(super) fn largest_frequency(
        &self,
        law: &impl UniaxialLaw,
        time: f64,
        displacement: &[f64],
    ) -> Result<f64, ReferenceError> {
        let mut largest = 0.0_f64;
        for (index, first) in self.mesh.first_nodes().enumerate() {
            let mut fastest = 0.0_f64;
            let strains = self
                .mesh
                .derivatives(index, &displacement[first..first + self.mesh.width()]);
            for (q, strain) in strains.enumerate() {
                let stretch = 1.0 + strain;
                if !is_valid_volume(stretch) {
                    return Err(self.invalid_stretch(index * self.mesh.width() + q, stretch, time));
                }
                let stiffness = law.stiffness(stretch);
                if !is_valid_volume(stiffness) {
                    return Err(ReferenceError::NotHyperbolic { stretch, stiffness });
                }
                fastest = fastest.max(self.fast_speed_squared(stretch, stiffness));
            }
            largest = largest.max(self.mesh.largest_wave_number(index) * fastest.sqrt());
        }
        Ok(largest)
    }

    /// Square of the speed of the faster wave without drag, m2/s2: the larger root of `det(C - c^2 M)` with
    /// the masses and stiffnesses of both phases per reference volume.
    fn fast_speed_squared(&self, stretch: f64, stiffness: f64) -> f64 {
        let (n, geometry) = (self.soil.porosity, self.geometry(stretch));
        let liquid = n * self.soil.liquid_density * geometry;
        let solid = self.soil.solid_fraction() * self.soil.solid_density;
        let locked = self.soil.locked_stiffness() / geometry;
        let half = 0.5 * (locked * n * n / liquid + (locked * (1.0 - n).powi(2) + stiffness) / solid);
        let product = locked * n * n * stiffness / (liquid * solid);
        half + (half * half - product).max(0.0).sqrt()
    }

    /// The `fields` of the mesh of `other` on this one.
    pub(super) fn transfer(&self, other: &Self, fields: &Fields) -> Fields {
        let mut out = Fields::zeros(self.mesh.node_count(), self.mesh.point_count());
        for node in 0..self.mesh.node_count() {
            let [displacement, solid, liquid] = other.nodal(fields, self.mesh.node(node));
            out.displacement[node] = displacement;
            out.solid[node] = solid;
            out.liquid[node] = liquid;
        }
        for (point, pressure) in out.pressure.iter_mut().enumerate() {
            let (element, xi) = other.mesh.locate(self.mesh.point(point));
            let first = element * self.mesh.width();
            *pressure = other
                .mesh
                .interpolate(xi, &fields.pressure[first..first + self.mesh.width()]);
        }
        out
    }

    /// Displacement and velocities of solid and liquid at the height `x`.
    fn nodal(&self, fields: &Fields, x: f64) -> [f64; 3] {
        let (element, xi) = self.mesh.locate(x);
        let first = element * (self.mesh.width() - 1);
        [&fields.displacement, &fields.solid, &fields.liquid].map(|values| {
            self.mesh
                .interpolate(xi, &values[first..first + self.mesh.width()])
        })
    }

    /// Relative L2 norm of the difference to the state `other` of each of these `fields`, of effective stress
    /// and pore pressure together.
    pub(super) fn difference(
        &self,
        law: &impl UniaxialLaw,
        fields: &Fields,
        other: impl Fn(f64) -> TwoPhaseState,
    ) -> f64 {
        let (mut difference, mut norm) = (0.0, 0.0);
        for (x, weight) in self.mesh.quadrature() {
            let (this, other) = (self.state(law, fields, x), other(x));
            difference += weight * (this.effective_stress - other.effective_stress).powi(2);
            difference += weight * (this.pore_pressure - other.pore_pressure).powi(2);
            norm += weight * (this.effective_stress.powi(2) + this.pore_pressure.powi(2));
        }
        if difference == 0.0 {
            0.0
        } else {
            (difference / norm).sqrt()
        }
    }

    /// State at the height `x`, m, above the base; beyond the ends, the state of the end.
    pub(super) fn state(&self, law: &impl UniaxialLaw, fields: &Fields, x: f64) -> TwoPhaseState {
        let (element, xi) = self.mesh.locate(x);
        let width = self.mesh.width();
        let (first, point) = (element * (width - 1), element * width);
        let (nodes, points) = (first..first + width, point..point + width);
        let displacement = &fields.displacement[nodes.clone()];
        let strain = &mut [0.0; HIGHEST_DEGREE + 1];
        for (slot, value) in strain
            .iter_mut()
            .zip(self.mesh.derivatives(element, displacement))
        {
            *slot = value;
        }
        let value = |values: &[f64]| self.mesh.interpolate(xi, values);
        TwoPhaseState {
            solid_displacement: value(displacement),
            solid_velocity: value(&fields.solid[nodes.clone()]),
            liquid_velocity: value(&fields.liquid[nodes]),
            effective_stress: law.stress(1.0 + value(&strain[..width]))
                + value(&self.initial_stress[points.clone()]),
            pore_pressure: value(&fields.pressure[points]),
        }
    }

    /// The stretch that the geometry sees.
    fn geometry(&self, stretch: f64) -> f64 {
        if self.small_strain { 1.0 } else { stretch }
    }

    /// `lambda k0 / k`.
    fn drag_factor(&self, geometry: f64) -> f64 {
        let power = 1.0 - self.soil.permeability_exponent;
        // The usual exponents, without the cost of a power.
        if power == 1.0 {
            geometry
        } else if power == 0.0 {
            1.0
        } else if power == -1.0 {
            1.0 / geometry
        } else {
            geometry.powf(power)
        }
    }

    fn invalid_stretch(&self, point: usize, stretch: f64, time: f64) -> ReferenceError {
        ReferenceError::InvalidStretch {
            time,
            position: self.mesh.point(point),
            stretch,
        }
    }
}

/// Whether a stretch or a stiffness is one that the equations can go on with.
fn is_valid_volume(value: f64) -> bool {
    value > 0.0 && value < f64::INFINITY
}
