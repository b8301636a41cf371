//! How cost grows: time per particle and step, and memory per particle, from a thousand to ten million
//! particles, with few and many of them per cell, for every method.
//!
//! `cargo bench --bench growth` prints the tables and writes them into `docs/verification/speed-and-error.md`
//! with the picture `docs/pictures/growth.svg`; `cargo bench --bench growth -- 1e6` stops at a million
//! particles and writes nothing.
//!
//! Each measurement is a process of its own, so that memory is what this one stepper made resident and
//! nothing freed before. Where the system tells it (Linux), the time that the process was given counts, if
//! that is less than the time on the wall: whatever else the machine does can only add. All bodies move
//! smoothly and nowhere rest (decayed noise would be denormal numbers); particles lie at random within their
//! shares of a cell, so that some cross an edge in nearly every step, as they do in a run.

use std::error::Error;
use std::f64::consts::PI;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use materialpoint::basis::BasisFamily;
use materialpoint::grid::{Face, Grid, Side};
use materialpoint::law::{Hill, Moduli};
use materialpoint::mass::{MassModel, VelocityMass};
use materialpoint::method::{Basis, Method, MethodVisitor, ReconstructionKind};
use materialpoint::particles::{Particles, lattice};
use materialpoint::phase::OnePhase;
use materialpoint::reconstruction::Reconstruction;
use materialpoint::stepper::{FaceCondition, Forcing, Setup, Simulation, Stepper};
use materialpoint_command::output::{Curve, CurvePoint, Folder, draw_study, fill_in};
use nalgebra::vector;

/// Tells a child process what to measure: method, particles per cell, particles.
const ONE: &str = "--one";
const PER_CELL: [usize; 3] = [2, 8, 64];
/// Particles; the picture's, at [`DRAWN`] per cell.
const SIZES: [usize; 9] = [
    1_000, 3_000, 10_000, 30_000, 100_000, 300_000, 1_000_000, 3_000_000, 10_000_000,
];
const DRAWN: usize = 8;
/// A measurement steps at least so long (s).
const LEAST_SECONDS: f64 = 0.25;
/// Steps from one fresh start to the next: the smallest bodies must not swing until published TLS has made
/// them unstable.
const MOST_STEPS: usize = 64;
/// Below this the kilobytes of a process are too coarse for the bytes of a particle.
const LEAST_RESIDENT: usize = 300_000;
/// Wave speed (m/s) and density (kg/m3) of the bar; its cells are 1 m long.
const WAVE_SPEED: f64 = 1.0;
const DENSITY: f64 = 1.0;
/// Share of a cell that a wave crosses in a step, and the largest velocity over that of the wave.
const COURANT: f64 = 0.1;
const VELOCITY: f64 = 0.02;

/// What one process found.
#[derive(Clone, Copy)]
struct Found {
    /// Time (ns) per particle and step.
    nanoseconds: f64,
    /// Bytes per particle by [`Stepper::bytes_per_particle`].
    said: f64,
    /// Bytes per particle that became resident; not a number where that is not measured.
    resident: f64,
}

struct Build {
    per_cell: usize,
    particles: usize,
}

impl MethodVisitor<f64> for Build {
    type Output = Box<dyn Simulation<1>>;

    fn visit<B, R>(self, basis: B, reconstruction: R) -> Self::Output
    where
        B: BasisFamily<f64, 1> + Send + 'static,
        R: Reconstruction<f64, 1> + Clone + Send + 'static,
    {
        let cells = self.particles / self.per_cell;
        let length = cells as f64;
        let grid = Grid::new(vector![0.0], vector![length], [cells]).expect("a valid grid");
        let mut points = lattice(&grid, grid.min(), grid.max(), [self.per_cell]);
        let mut seed = 1_u32;
        for (x, spacing) in &mut points {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            x[0] += 0.9 * *spacing * (f64::from(seed >> 8) / f64::from(1 << 24) - 0.5);
        }
        let mut particles = Particles::at_rest(&points, DENSITY);
        drop(points);
        for (v, x) in particles.velocity.iter_mut().zip(&particles.position) {
            v[0] = VELOCITY * WAVE_SPEED * (PI * x[0] / length).sin();
        }
        let moduli = Moduli::uniaxial(DENSITY * WAVE_SPEED * WAVE_SPEED).expect("a positive modulus");
        let stepper = Stepper::new(
            Setup::new(grid, basis, reconstruction, Hill { moduli }, OnePhase, particles)
                .with_velocity_mass(MassModel::preferring(VelocityMass::Consistent)),
        );
        Box::new(stepper.expect("a valid setup"))
    }
}

/// Memory (bytes) of this process that is resident; `None` where the system does not say.
fn resident() -> Option<f64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"))?;
    let kilobytes: f64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(1024.0 * kilobytes)
}

/// Time (s) that this process was given so far; `None` where the system does not say.
fn given() -> Option<f64> {
    let text = fs::read_to_string("/proc/self/schedstat").ok()?;
    let nanoseconds: f64 = text.split_whitespace().next()?.parse().ok()?;
    Some(1e-9 * nanoseconds)
}

/// Times on the wall and times that the process was given, over batches of steps.
struct Clock {
    fastest: f64,
    total: f64,
    given: Option<f64>,
}

impl Clock {
    fn time(&mut self, work: impl FnOnce()) {
        let (before, begun) = (given(), Instant::now());
        work();
        let wall = begun.elapsed().as_secs_f64();
        self.fastest = self.fastest.min(wall);
        self.total += wall;
        let given = before.zip(given()).map(|(before, after)| after - before);
        self.given = self.given.zip(given).map(|(sum, more)| sum + more);
    }

    /// Of one of `batches`: the fastest on the wall, or if that is less what they were given on average. The
    /// one is an accident where a batch is longer than the machine leaves alone, the other coarse where it is
    /// short.
    fn of_a_batch(&self, batches: usize) -> f64 {
        let mean = self.given.map_or(f64::INFINITY, |sum| sum / batches as f64);
        self.fastest.min(mean)
    }
}

fn measure(method: Method, per_cell: usize, particles: usize) -> Found {
    let before = resident();
    let build = || {
        let built = method.dispatch(Build { per_cell, particles });
        built.expect("one of them")
    };
    let mut simulation = build();
    let count = simulation.particle_count() as f64;
    let said = simulation.bytes_per_particle();
    let ends = [Side::Min, Side::Max].map(|side| Face { axis: 0, side });
    let fixed = |forcing: Forcing<f64, 1>, end| forcing.with_face(end, FaceCondition::fixed());
    let forcing = ends.into_iter().fold(Forcing::none(), fixed);
    let dt = COURANT / WAVE_SPEED;
    let step = |simulation: &mut dyn Simulation<1>| {
        simulation.step(dt, &forcing).expect("a stable step");
    };
    step(simulation.as_mut());
    let resident = match (before, resident(), particles >= LEAST_RESIDENT) {
        (Some(before), Some(after), true) => (after - before) / count,
        _ => f64::NAN,
    };
    let steps = (6_000_000 / particles).clamp(1, MOST_STEPS);
    let mut clock = Clock {
        fastest: f64::INFINITY,
        total: 0.0,
        given: Some(0.0),
    };
    let mut batches = 0;
    while clock.given.unwrap_or(clock.total) < LEAST_SECONDS || batches < 3 {
        clock.time(|| (0..steps).for_each(|_| step(simulation.as_mut())));
        batches += 1;
        if steps > 1 {
            simulation = build();
            step(simulation.as_mut());
        }
    }
    Found {
        nanoseconds: 1e9 * clock.of_a_batch(batches) / (count * steps as f64),
        said,
        resident,
    }
}

/// Measures in a process of its own.
fn in_a_child(method: Method, per_cell: usize, particles: usize) -> Result<Found, Box<dyn Error>> {
    let sizes = [per_cell.to_string(), particles.to_string()];
    let child = Command::new(std::env::current_exe()?)
        .args([ONE, &method.to_string()])
        .args(sizes)
        .output()?;
    let text = String::from_utf8(child.stdout)?;
    let numbers: Vec<f64> = text
        .split_whitespace()
        .map(str::parse)
        .collect::<Result<_, _>>()?;
    match numbers[..] {
        [nanoseconds, said, resident] => Ok(Found {
            nanoseconds,
            said,
            resident,
        }),
        _ => Err(String::from_utf8_lossy(&child.stderr).into()),
    }
}

fn child(arguments: &[String]) -> Result<(), Box<dyn Error>> {
    let [method, per_cell, particles] = arguments else {
        return Err("a method and two numbers".into());
    };
    let method = Method::ALL.into_iter().find(|known| known.to_string() == *method);
    let found = measure(
        method.ok_or("no such method")?,
        per_cell.parse()?,
        particles.parse()?,
    );
    println!("{} {} {}", found.nanoseconds, found.said, found.resident);
    Ok(())
}

/// All measurements of one method: by particles per cell, then by size.
struct Growth {
    method: Method,
    found: Vec<Vec<(usize, Found)>>,
}

/// Sizes take turns among the methods, so that a busy minute of the machine does not fall on one method's
/// curve.
fn grow(most: usize) -> Result<Vec<Growth>, Box<dyn Error>> {
    let none = |method| Growth {
        method,
        found: vec![Vec::new(); PER_CELL.len()],
    };
    let mut all: Vec<Growth> = Method::ALL.into_iter().map(none).collect();
    for size in SIZES.into_iter().filter(|&size| size <= most) {
        for (i, per_cell) in PER_CELL.into_iter().enumerate() {
            for growth in &mut all {
                let found = in_a_child(growth.method, per_cell, size)?;
                growth.found[i].push((size, found));
                println!(
                    "{size:>9} particles, {per_cell:>2} per cell, {:<24} {:7.1} ns, {:6.1} bytes said, {} resident",
                    growth.method.to_string(),
                    found.nanoseconds,
                    found.said,
                    bytes(found.resident)
                );
            }
        }
    }
    Ok(all)
}

fn bytes(value: f64) -> String {
    if value.is_nan() {
        return "not measured".into();
    }
    format!("{value:.1}")
}

/// Time at 1e3 ... 1e7 particles, and how it grew over the last half of a decade.
fn table_of_time(all: &[Growth]) -> String {
    let decades: Vec<usize> = SIZES.into_iter().step_by(2).collect();
    let head = |n: &usize| format!("1e{:.0}", (*n as f64).log10());
    let heads: Vec<String> = decades.iter().map(head).collect();
    let mut text = format!(
        "Time per particle and step [ns], {DRAWN} particles per cell; with 2 and with 64 per cell at the largest size; and the\n\
         time at 1e7 particles over that at 3e6, for 2, {DRAWN} and 64 per cell:\n\n\
         | method | {} | 2 per cell | 64 per cell | 1e7 over 3e6 |\n|{}\n",
        heads.join(" | "),
        "---|".repeat(heads.len() + 4)
    );
    let drawn = PER_CELL.iter().position(|&n| n == DRAWN).unwrap_or(0);
    for Growth { method, found } in all {
        let at = |i: usize, size: usize| {
            let same = found[i].iter().find(|(n, _)| *n == size);
            same.map_or(f64::NAN, |(_, found)| found.nanoseconds)
        };
        let last = |i: usize| found[i].last().map_or(f64::NAN, |(_, found)| found.nanoseconds);
        let times: Vec<String> = decades.iter().map(|&n| format!("{:.1}", at(drawn, n))).collect();
        let ratios = [0, 1, 2].map(|i| format!("{:.2}", at(i, 10_000_000) / at(i, 3_000_000)));
        text += &format!(
            "| {} | {} | {:.1} | {:.1} | {} |\n",
            method.literature_name(),
            times.join(" | "),
            last(0),
            last(2),
            ratios.join(", ")
        );
    }
    text
}

/// Said and resident at the largest size.
fn table_of_memory(all: &[Growth]) -> String {
    let heads = PER_CELL.map(|n| format!("{n} per cell"));
    let mut text = format!(
        "Bytes per particle that `check` names / that became resident in a fresh process, at the largest size:\n\n\
         | method | {} |\n|{}\n",
        heads.join(" | "),
        "---|".repeat(heads.len() + 1)
    );
    for Growth { method, found } in all {
        let cells = found.iter().filter_map(|found| found.last());
        let cells: Vec<String> = cells
            .map(|(_, found)| format!("{:.1} / {}", found.said, bytes(found.resident)))
            .collect();
        text += &format!("| {} | {} |\n", method.literature_name(), cells.join(" | "));
    }
    text
}

fn picture(all: &[Growth]) -> String {
    let drawn = PER_CELL.iter().position(|&n| n == DRAWN).unwrap_or(0);
    let curves: Vec<Curve> = all
        .iter()
        .map(|Growth { method, found }| Curve {
            label: method.literature_name(),
            family: match method.basis {
                Basis::Linear => 0,
                Basis::DualDomain => 1,
                Basis::BSpline { .. } => 2,
            },
            variant: match method.reconstruction {
                ReconstructionKind::Shepard => 0,
                ReconstructionKind::Taylor => 1,
                ReconstructionKind::Spline => 2,
                ReconstructionKind::RelaxedTaylor => 3,
            },
            points: found[drawn]
                .iter()
                .map(|(size, found)| CurvePoint {
                    x: *size as f64,
                    y: found.nanoseconds,
                    ..CurvePoint::default()
                })
                .collect(),
        })
        .collect();
    draw_study(
        &format!("Time of a particle's step, {DRAWN} particles per cell"),
        "particles [-]",
        "time per particle and step [ns]",
        &curves,
    )
}

/// The last number among the arguments: the most particles.
fn most(arguments: &[String]) -> Option<usize> {
    let number = |text: &String| text.parse::<f64>().ok();
    arguments.iter().rev().find_map(number).map(|most| most as usize)
}

/// The repository; benches are run in the folder of their package.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if let Some((first, rest)) = arguments.split_first()
        && first == ONE
    {
        return child(rest);
    }
    // Without the flag that `cargo bench` gives, only that it runs is to be seen.
    let benched = arguments.iter().any(|argument| argument == "--bench");
    let asked = most(&arguments);
    let all = grow(asked.unwrap_or(if benched { usize::MAX } else { 1000 }))?;
    let tables = format!("{}\n{}", table_of_time(&all), table_of_memory(&all));
    println!("\n{tables}");
    if benched && asked.is_none() {
        let pictures = Folder::create(&root().join("docs/pictures"))?;
        pictures.write("growth.svg", &picture(&all))?;
        let page = &root().join("docs/verification/speed-and-error.md");
        let text = format!(
            "![Time of a particle's step against the number of particles](../pictures/growth.svg)\n\n{tables}"
        );
        fs::write(page, fill_in(&fs::read_to_string(page)?, "growth", &text)?)?;
    }
    Ok(())
}
