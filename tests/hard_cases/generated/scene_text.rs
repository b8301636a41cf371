//! Scenes that the language allows, drawn at random and written as text.
//!
//! Lengths, stiffness, densities and velocities run over decades, but keep to the wave's speed: a velocity of
//! at most a fifth of it, loads of at most a fifth of the modulus, steps of up to three times what a wave
//! takes to cross a cell.

use std::fmt::{self, Write};

use proptest::prelude::*;

/// Most steps of a scene with steps of a given size.
pub const MOST_STEPS: f64 = 80.0;

/// A scene; shown as one writes it.
#[derive(Clone)]
pub struct Text(pub String);

impl fmt::Debug for Text {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "\n{}", self.0)
    }
}

pub fn scene_text() -> impl Strategy<Value = Text> {
    let bodies = prop::collection::vec(body(), 1..=2);
    let faces = [face(), face()];
    (
        space(),
        matter(),
        method(),
        bodies,
        gaps(),
        faces,
        load(),
        time(),
        output(),
    )
        .prop_map(
            |(space, matter, method, bodies, gaps, faces, load, time, output)| {
                let mut text = "title = \"Generated\"\n".to_owned();
                let scales = Scales::new(&space, &matter);
                space.write(&mut text);
                time.write(&mut text, &scales);
                method.write(&mut text);
                matter.write(&mut text);
                let ends = ends(&space, &bodies, &gaps);
                for (body, ends) in bodies.iter().zip(ends) {
                    body.write(&mut text, ends, &scales, &matter);
                }
                for (name, face) in ["x-min", "x-max"].into_iter().zip(&faces) {
                    face.write(&mut text, name, &scales, matter.soil.is_some());
                }
                load.write(&mut text, &scales, matter.soil.is_some());
                output.write(&mut text);
                Text(text)
            },
        )
}

/// A line of the text.
macro_rules! line {
    ($text:expr, $($format:tt)*) => {
        writeln!($text, $($format)*).unwrap()
    };
}

fn logarithmic(low: f64, high: f64) -> impl Strategy<Value = f64> {
    (low.ln()..=high.ln()).prop_map(f64::exp)
}

fn one_in(n: u32) -> impl Strategy<Value = bool> {
    prop::bool::weighted(1.0 / f64::from(n))
}

/// What the scene is made of, in units of which everything else is drawn.
struct Scales {
    length: f64,
    cell: f64,
    /// Of a wave (m/s).
    speed: f64,
    /// Of the stiffest constituent (Pa).
    modulus: f64,
    youngs_modulus: f64,
}

impl Scales {
    fn new(space: &Space, matter: &Matter) -> Self {
        let (modulus, density) = match &matter.soil {
            None => (matter.youngs_modulus, matter.density),
            Some(soil) => (
                matter.youngs_modulus + soil.bulk_modulus / soil.porosity,
                (1.0 - soil.porosity) * matter.density,
            ),
        };
        Self {
            length: space.length,
            cell: space.length / space.cells as f64,
            speed: (modulus / density).sqrt(),
            modulus,
            youngs_modulus: matter.youngs_modulus,
        }
    }
}

#[derive(Clone, Debug)]
struct Space {
    min: f64,
    length: f64,
    cells: usize,
}

fn space() -> impl Strategy<Value = Space> {
    let min = prop_oneof![Just(0.0), -5.0..5.0_f64];
    let length = prop_oneof![Just(1.0), logarithmic(0.05, 50.0)];
    (min, length, 1..=20_usize).prop_map(|(min, length, cells)| Space { min, length, cells })
}

impl Space {
    fn max(&self) -> f64 {
        self.min + self.length
    }

    fn write(&self, text: &mut String) {
        let (min, max, cells) = (self.min, self.max(), self.cells);
        line!(
            text,
            "[grid]\nmin = [{min:?}]\nmax = [{max:?}]\ncells = [{cells}]"
        );
    }
}

/// Shares of the grid before, between and behind bodies, and whether bodies begin and end at cell edges.
#[derive(Clone, Debug)]
struct Gaps {
    sizes: [f64; 3],
    at_edges: bool,
}

fn gaps() -> impl Strategy<Value = Gaps> {
    let size = || prop_oneof![Just(0.0), 0.0..1.0_f64];
    ([size(), size(), size()], any::<bool>()).prop_map(|(sizes, at_edges)| Gaps { sizes, at_edges })
}

/// Where each body begins and ends.
fn ends(space: &Space, bodies: &[Body], gaps: &Gaps) -> Vec<[f64; 2]> {
    let lengths = |n: usize| [gaps.sizes[n], bodies[n].size];
    let parts: Vec<f64> = (0..bodies.len())
        .flat_map(lengths)
        .chain([gaps.sizes[2]])
        .collect();
    let total: f64 = parts.iter().sum();
    let mut sum = 0.0;
    let shares = parts[..2 * bodies.len()].iter().map(|part| {
        sum += part / total;
        sum
    });
    let shares: Vec<f64> = shares.collect();
    let cells = space.cells as f64;
    let snapped: Vec<f64> = shares
        .iter()
        .map(|share| (share * cells).round() / cells)
        .collect();
    let none_vanishes = snapped.chunks(2).all(|ends| ends[0] < ends[1]);
    let chosen = if gaps.at_edges && none_vanishes {
        snapped
    } else {
        shares
    };
    // Round-off must not put an end outside.
    let place = |share: &f64| (space.min + share * space.length).min(space.max());
    chosen
        .chunks(2)
        .map(|ends| [place(&ends[0]), place(&ends[1])])
        .collect()
}

#[derive(Clone, Debug)]
struct Soil {
    porosity: f64,
    bulk_modulus: f64,
    permeability: f64,
    exponent: Option<f64>,
    explicit: bool,
}

fn soil() -> impl Strategy<Value = Soil> {
    let exponent = prop::option::of(prop_oneof![Just(2.0), -3.0..5.0_f64]);
    let parts = (
        0.01..0.99_f64,
        logarithmic(1e4, 1e10),
        logarithmic(1e-12, 1.0),
        exponent,
        any::<bool>(),
    );
    parts.prop_map(
        |(porosity, bulk_modulus, permeability, exponent, explicit)| Soil {
            porosity,
            bulk_modulus,
            permeability,
            exponent,
            explicit,
        },
    )
}

#[derive(Clone, Debug)]
struct Matter {
    law: &'static str,
    large: bool,
    youngs_modulus: f64,
    density: f64,
    soil: Option<Soil>,
}

const LAWS: [(&str, bool); 4] = [
    ("linear-elastic", false),
    ("linear-elastic", true),
    ("neo-hookean", true),
    ("logarithmic", true),
];

fn matter() -> impl Strategy<Value = Matter> {
    let parts = (
        prop::sample::select(&LAWS[..]),
        logarithmic(1e2, 1e10),
        logarithmic(1.0, 1e4),
        prop::option::weighted(0.4, soil()),
    );
    parts.prop_map(|((law, large), youngs_modulus, density, soil)| Matter {
        law,
        large,
        youngs_modulus,
        density,
        soil,
    })
}

impl Matter {
    fn write(&self, text: &mut String) {
        let strain = if self.large { "large" } else { "small" };
        line!(text, "[material]\nstrain = \"{strain}\"");
        line!(
            text,
            "law.{} = {{ youngs_modulus = {:?} }}",
            self.law,
            self.youngs_modulus
        );
        let Some(soil) = &self.soil else {
            line!(text, "density = {:?}", self.density);
            return;
        };
        line!(
            text,
            "phases = 2\nporosity = {:?}\nsolid_density = {:?}",
            soil.porosity,
            self.density
        );
        line!(
            text,
            "liquid_density = 1000\nliquid_bulk_modulus = {:?}",
            soil.bulk_modulus
        );
        line!(text, "permeability = {:?}", soil.permeability);
        if let Some(exponent) = soil.exponent {
            line!(text, "permeability_exponent = {exponent:?}");
        }
        if soil.explicit {
            line!(text, "drag = \"explicit\"");
        }
    }
}

#[derive(Clone, Debug)]
struct Method {
    basis: &'static str,
    degree: Option<usize>,
    reconstruction: &'static str,
    velocity_mass: Option<&'static str>,
    subpoints: Option<u8>,
    virtual_points: bool,
    single: bool,
}

fn method() -> impl Strategy<Value = Method> {
    let bases = prop::sample::select(vec!["linear", "dual-domain", "bspline"]);
    let reconstructions = prop::sample::select(vec!["shepard", "taylor", "relaxed-taylor", "spline"]);
    let mass = prop::sample::select(vec!["consistent", "constrained", "lumped"]);
    let parts = (
        bases,
        prop::option::of(1..=3_usize),
        reconstructions,
        prop::option::of(mass),
        prop::option::of(1..=6_u8),
        any::<bool>(),
        one_in(8),
    );
    parts.prop_map(
        |(basis, degree, reconstruction, velocity_mass, subpoints, virtual_points, single)| Method {
            basis,
            degree,
            reconstruction,
            velocity_mass,
            subpoints,
            virtual_points,
            single,
        },
    )
}

impl Method {
    /// Keys that the method does not have are left out.
    fn write(&self, text: &mut String) {
        let reconstruction = self.reconstruction;
        line!(
            text,
            "[method]\nbasis = \"{}\"\nreconstruction = \"{reconstruction}\"",
            self.basis
        );
        if let (Some(degree), "bspline") = (self.degree, self.basis) {
            line!(text, "degree = {degree}");
        }
        if let (Some(subpoints), "dual-domain", "shepard") = (self.subpoints, self.basis, reconstruction) {
            line!(text, "subpoints = {subpoints}");
        }
        if self.virtual_points && reconstruction == "taylor" {
            line!(text, "virtual_points = true");
        }
        if let (Some(mass), "taylor" | "spline") = (self.velocity_mass, reconstruction) {
            line!(text, "velocity_mass = \"{mass}\"");
        }
        if self.single {
            line!(text, "scalar = \"f32\"");
        }
    }
}

/// A formula in `x` or `t`, with values up to about 1.
#[derive(Clone, Debug)]
struct Formula {
    kind: usize,
    amplitude: f64,
    wave_number: f64,
}

fn formula() -> impl Strategy<Value = Formula> {
    let amplitude = (logarithmic(1e-9, 0.2), any::<bool>());
    (0..6_usize, amplitude, -40.0..40.0_f64).prop_map(|(kind, (size, negative), wave_number)| Formula {
        kind,
        amplitude: if negative { -size } else { size },
        wave_number,
    })
}

impl Formula {
    /// Values of the given `size`, arguments of the size `extent`.
    fn text(&self, variable: &str, size: f64, extent: f64) -> String {
        let a = self.amplitude * size;
        let (k, s) = (self.wave_number / extent, extent);
        match self.kind {
            0 => format!("{a:?}"),
            1 => format!("{a:?}*{variable}/{s:?}"),
            2 => format!("{a:?}*sin({k:?}*{variable})"),
            3 => format!("{a:?}*sign(cos({k:?}*{variable}))"),
            4 => format!("max(-abs({a:?}), min({a:?}*({k:?}*{variable})^3, abs({a:?})))"),
            _ => format!("{a:?}*exp(-({k:?}*{variable})^2)"),
        }
    }
}

fn maybe() -> impl Strategy<Value = Option<Formula>> {
    prop::option::weighted(0.3, formula())
}

#[derive(Clone, Debug)]
struct Body {
    size: f64,
    per_cell: usize,
    velocity: Option<Formula>,
    stress: Option<Formula>,
    liquid_velocity: Option<Formula>,
    pore_pressure: Option<Formula>,
    jitter: Option<(f64, u32)>,
    dofs: bool,
}

fn body() -> impl Strategy<Value = Body> {
    let jitter = prop::option::of((prop_oneof![Just(1.0), 0.0..1.0_f64], any::<u32>()));
    let velocity = prop::option::weighted(0.8, formula());
    let parts = (
        0.01..1.0_f64,
        1..=12_usize,
        velocity,
        maybe(),
        maybe(),
        maybe(),
        jitter,
        one_in(4),
    );
    parts.prop_map(
        |(size, per_cell, velocity, stress, liquid_velocity, pore_pressure, jitter, dofs)| Body {
            size,
            per_cell,
            velocity,
            stress,
            liquid_velocity,
            pore_pressure,
            jitter,
            dofs,
        },
    )
}

impl Body {
    fn write(&self, text: &mut String, [min, max]: [f64; 2], scales: &Scales, matter: &Matter) {
        line!(
            text,
            "[[body]]\nmin = [{min:?}]\nmax = [{max:?}]\nparticles_per_cell = [{}]",
            self.per_cell
        );
        let of_x = |formula: &Formula, size: f64| formula.text("x", size, scales.length);
        if let Some(velocity) = &self.velocity {
            line!(text, "velocity = [\"{}\"]", of_x(velocity, scales.speed));
        }
        // A neo-hookean body has the stress of its deformation.
        if let (Some(stress), true) = (&self.stress, matter.law != "neo-hookean") {
            line!(text, "stress = \"{}\"", of_x(stress, scales.youngs_modulus));
        }
        if let (Some(velocity), Some(_)) = (&self.liquid_velocity, &matter.soil) {
            line!(text, "liquid_velocity = [\"{}\"]", of_x(velocity, scales.speed));
        }
        if let (Some(pressure), Some(_)) = (&self.pore_pressure, &matter.soil) {
            line!(text, "pore_pressure = \"{}\"", of_x(pressure, scales.modulus));
        }
        if let Some((jitter, seed)) = self.jitter {
            line!(text, "jitter = {jitter:?}\nseed = {seed}");
        }
        if self.dofs {
            line!(text, "initialise = \"dofs\"");
        }
    }
}

#[derive(Clone, Debug)]
enum Held {
    Free,
    Fixed,
    Velocity(Formula),
    Traction(Formula),
}

#[derive(Clone, Debug)]
enum Pores {
    Sealed,
    Drained,
    Pressure(Formula),
}

#[derive(Clone, Debug)]
struct Face {
    held: Held,
    pores: Pores,
}

fn face() -> impl Strategy<Value = Face> {
    let held = prop_oneof![
        Just(Held::Free),
        Just(Held::Fixed),
        formula().prop_map(Held::Velocity),
        formula().prop_map(Held::Traction),
    ];
    let pores = prop_oneof![
        Just(Pores::Sealed),
        Just(Pores::Drained),
        formula().prop_map(Pores::Pressure)
    ];
    (held, pores).prop_map(|(held, pores)| Face { held, pores })
}

impl Face {
    fn write(&self, text: &mut String, name: &str, scales: &Scales, two_phases: bool) {
        let period = scales.length / scales.speed;
        let held = match &self.held {
            Held::Free => String::new(),
            Held::Fixed => "fixed = true\n".to_owned(),
            Held::Velocity(formula) => {
                format!("velocity = [\"{}\"]\n", formula.text("t", scales.speed, period))
            }
            Held::Traction(formula) => {
                format!(
                    "traction = [\"{}\"]\n",
                    formula.text("t", scales.youngs_modulus, period)
                )
            }
        };
        let pores = match &self.pores {
            _ if !two_phases => String::new(),
            Pores::Sealed => String::new(),
            Pores::Drained => "drained = true\n".to_owned(),
            Pores::Pressure(formula) => {
                format!(
                    "pore_pressure = \"{}\"\n",
                    formula.text("t", scales.youngs_modulus, period)
                )
            }
        };
        if !(held.is_empty() && pores.is_empty()) {
            line!(text, "[[boundary]]\nface = \"{name}\"\n{held}{pores}");
        }
    }
}

#[derive(Clone, Debug)]
struct Load {
    body_force: Option<Formula>,
    gravity: Option<f64>,
}

fn load() -> impl Strategy<Value = Load> {
    (maybe(), prop::option::of(0.1..100.0_f64)).prop_map(|(body_force, gravity)| Load { body_force, gravity })
}

impl Load {
    fn write(&self, text: &mut String, scales: &Scales, two_phases: bool) {
        line!(text, "[load]");
        if let Some(force) = &self.body_force {
            let (period, most) = (scales.length / scales.speed, scales.speed.powi(2) / scales.length);
            line!(text, "body_force = [\"{}\"]", force.text("t", most, period));
        }
        if let (Some(gravity), true) = (self.gravity, two_phases) {
            line!(text, "gravity = {gravity:?}");
        }
    }
}

/// Sizes in units of the time in which a wave crosses a cell.
#[derive(Clone, Debug)]
struct Time {
    step: Option<f64>,
    steps: f64,
    safety: Option<f64>,
}

fn time() -> impl Strategy<Value = Time> {
    let safety = prop::option::of(prop_oneof![Just(1.0), 0.05..1.0_f64]);
    (prop::option::of(logarithmic(1e-3, 3.0)), 1.0..MOST_STEPS, safety)
        .prop_map(|(step, steps, safety)| Time { step, steps, safety })
}

impl Time {
    fn write(&self, text: &mut String, scales: &Scales) {
        let crossing = scales.cell / scales.speed;
        let step = self.step.unwrap_or(0.3) * crossing;
        line!(text, "[time]\nend = {:?}", step * self.steps);
        match (self.step, self.safety) {
            (Some(_), _) => line!(text, "step = {step:?}"),
            (None, Some(safety)) => line!(text, "step = \"auto\"\nsafety = {safety:?}"),
            (None, None) => line!(text, "step = \"auto\""),
        }
    }
}

#[derive(Clone, Debug)]
struct Output {
    csv: Option<bool>,
    every: usize,
}

fn output() -> impl Strategy<Value = Output> {
    (prop::option::of(any::<bool>()), 0..60_usize).prop_map(|(csv, every)| Output { csv, every })
}

impl Output {
    fn write(&self, text: &mut String) {
        line!(text, "[output]\nevery = {}", self.every);
        if let Some(csv) = self.csv {
            line!(text, "particles = \"{}\"", if csv { "csv" } else { "none" });
        }
    }
}
