//! Particles as a table.

use nalgebra::{SMatrix, SVector};

use crate::output::Table;
use crate::particles::Particles;
use crate::phase::PoreLiquid;
use crate::scene::{Phases, Scene};

/// Columns of `particles.csv`.
pub(super) fn particle_table<const D: usize>(
    scene: &Scene,
    particles: &Particles<f64, D>,
    liquid: &[PoreLiquid<f64, D>],
) -> Table {
    let mut columns = Columns::default();
    match scene.material.phases {
        Phases::One { .. } => columns.one_phase(particles),
        Phases::Two(soil) => columns.two_phases(particles, liquid, soil.porosity),
    }
    columns.0
}

/// Axes by name.
const AXES: [&str; 3] = ["x", "y", "z"];

fn axis(a: usize) -> &'static str {
    AXES.get(a).copied().unwrap_or("?")
}

#[derive(Default)]
struct Columns(Table);

impl Columns {
    fn one_phase<const D: usize>(&mut self, particles: &Particles<f64, D>) {
        self.positions(particles);
        self.vectors("u", "m", particles.displacement.iter());
        self.vectors("v", "m/s", particles.velocity.iter());
        self.tensors("stress", "Pa", &particles.stress);
        let density = (0..particles.len()).map(|p| particles.density(p)).collect();
        self.add("density[kg/m3]".to_owned(), density);
        let volume = ["volume[m]", "volume[m2]"].get(D - 1).unwrap_or(&"volume[m3]");
        self.add((*volume).to_owned(), particles.volume.clone());
    }

    fn two_phases<const D: usize>(
        &mut self,
        particles: &Particles<f64, D>,
        liquid: &[PoreLiquid<f64, D>],
        porosity: f64,
    ) {
        self.positions(particles);
        self.vectors("u_solid", "m", particles.displacement.iter());
        self.vectors("v_solid", "m/s", particles.velocity.iter());
        self.vectors("v_liquid", "m/s", liquid.iter().map(|l| &l.velocity));
        self.tensors("effective_stress", "Pa", &particles.stress);
        let pressure = liquid.iter().map(|l| l.pressure).collect();
        self.add("pore_pressure[Pa]".to_owned(), pressure);
        // A constant of the model, but a column that others read.
        self.add("porosity[-]".to_owned(), vec![porosity; particles.len()]);
    }

    /// Named by their axes alone.
    fn positions<const D: usize>(&mut self, particles: &Particles<f64, D>) {
        for a in 0..D {
            let values = particles.initial_position.iter().map(|x| x[a]).collect();
            self.add(format!("{}0[m]", axis(a)), values);
        }
        for a in 0..D {
            let values = particles.position.iter().map(|x| x[a]).collect();
            self.add(format!("{}[m]", axis(a)), values);
        }
    }

    fn vectors<'a, const D: usize>(
        &mut self,
        name: &str,
        unit: &str,
        vectors: impl Iterator<Item = &'a SVector<f64, D>> + Clone,
    ) {
        for a in 0..D {
            let suffix = if D == 1 {
                String::new()
            } else {
                format!("_{}", axis(a))
            };
            self.add(
                format!("{name}{suffix}[{unit}]"),
                vectors.clone().map(|v| v[a]).collect(),
            );
        }
    }

    /// The diagonal, then the rest.
    fn tensors<const D: usize>(&mut self, name: &str, unit: &str, tensors: &[SMatrix<f64, D, D>]) {
        let off = (0..D).flat_map(|a| (a + 1..D).map(move |b| (a, b)));
        for (a, b) in (0..D).map(|a| (a, a)).chain(off) {
            let suffix = if D == 1 {
                String::new()
            } else {
                format!("_{}{}", axis(a), axis(b))
            };
            let values = tensors.iter().map(|s| s[(a, b)]).collect();
            self.add(format!("{name}{suffix}[{unit}]"), values);
        }
    }

    fn add(&mut self, name: String, values: Vec<f64>) {
        self.0.header.push(name);
        self.0.columns.push(values);
    }
}
