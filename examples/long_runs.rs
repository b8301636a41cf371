//! Who keeps, gains and loses energy in long runs: the bar for 8 and for 10 seconds, written into
//! `docs/verification/long-runs.md`.
//!
//! `cargo run --release --example long_runs` measures all anew, in some minutes: the pictures in
//! `docs/pictures/` and what stands between the markers of the page. The prose around them is not touched.

use std::error::Error;
use std::fmt::Write;
use std::fs;
use std::path::Path;

use materialpoint::error::StepError;
use materialpoint::grid::{Face, Side};
use materialpoint::method::{Basis, Method, ReconstructionKind};
use materialpoint::reference::{EntropyBar, Hill, Reference};
use materialpoint::stepper::{FaceCondition, Forcing};
use materialpoint_command::output::{Folder, Line, LineAxis, LineCaptions, LinePanel, draw_lines, fill_in};
use materialpoint_command::run::simulation;
use materialpoint_command::scene::Scene;

/// Size of a step (s), as in the scene.
const STEP: f64 = 1e-4;
/// Energy is looked at after this many steps.
const STRIDE: usize = 200;
/// Cells of the entropy solution.
const EXACT_CELLS: usize = 2000;

/// A long run of the bar.
pub struct Case {
    /// Its part of the page.
    pub name: &'static str,
    /// Title of its picture.
    pub title: &'static str,
    /// Velocity in the middle at the start (m/s).
    pub velocity: f64,
    /// Number of cells.
    pub cells: usize,
    /// Times of its table (s); the last one is its end.
    pub times: &'static [f64],
    /// The energies that its picture shows.
    pub axis: LineAxis,
}

/// It breaks at 7.96 s: until then nothing dissipates.
pub const SMOOTH: Case = Case {
    name: "smooth",
    title: "A smooth long run: energy over the initial one",
    velocity: 0.08,
    cells: 80,
    times: &[0.5, 1.0, 2.0, 4.0, 6.0, 8.0],
    axis: LineAxis {
        range: (0.95, 1.25),
        log: false,
    },
};

/// It breaks at 0.79 s: from then on shocks dissipate.
pub const SHOCKS: Case = Case {
    name: "shocks",
    title: "A long run with shocks: energy over the initial one",
    velocity: 0.8,
    cells: 20,
    times: &[0.5, 1.0, 2.0, 5.0, 10.0],
    axis: LineAxis {
        range: (0.03, 4.0),
        log: true,
    },
};

impl Case {
    fn end(&self) -> f64 {
        self.times.last().copied().unwrap_or(0.0)
    }
}

/// A method with the mass behind its velocities.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Variant {
    /// Basis and reconstruction.
    pub method: Method,
    /// Whether a lumped mass takes the place of the default one.
    pub lumped: bool,
}

impl Variant {
    /// With the default mass.
    pub fn new(basis: Basis, reconstruction: ReconstructionKind) -> Self {
        Self {
            method: Method::new(basis, reconstruction),
            lumped: false,
        }
    }

    /// With a lumped mass.
    pub fn lumped(self) -> Self {
        Self { lumped: true, ..self }
    }

    /// The twelve methods; TLS and spline with either mass.
    pub fn all() -> Vec<Self> {
        use ReconstructionKind::{Spline, Taylor};
        let both = |method: Method| {
            let default = Self {
                method,
                lumped: false,
            };
            match method.reconstruction {
                Taylor | Spline => vec![default, default.lumped()],
                _ => vec![default],
            }
        };
        Method::ALL.into_iter().flat_map(both).collect()
    }

    /// Reconstruction and mass, as in the legend.
    fn label(self) -> &'static str {
        use ReconstructionKind::{RelaxedTaylor, Shepard, Spline, Taylor};
        match (self.method.reconstruction, self.lumped) {
            (Shepard, _) => "plain",
            (RelaxedTaylor, _) => "relaxed TLS",
            (Taylor, false) => "TLS, consistent",
            (Taylor, true) => "TLS, lumped",
            (Spline, false) => "spline, consistent",
            (Spline, true) => "spline, lumped",
        }
    }

    /// Colour by reconstruction, dash by mass.
    fn look(self) -> (usize, usize) {
        let family = match self.method.reconstruction {
            ReconstructionKind::Shepard => 4,
            ReconstructionKind::Taylor => 1,
            ReconstructionKind::Spline => 3,
            ReconstructionKind::RelaxedTaylor => 0,
        };
        (family, usize::from(self.lumped))
    }

    fn mass(self) -> &'static str {
        match (self.method.reconstruction, self.lumped) {
            (ReconstructionKind::Shepard, _) | (_, true) => "lumped",
            (ReconstructionKind::RelaxedTaylor, _) => "constrained",
            _ => "consistent",
        }
    }
}

/// Particles of a run: how many in a cell, and how far from even.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layout {
    /// Particles per cell.
    pub per_cell: usize,
    /// Share of their distance by which they are shifted at random.
    pub jitter: f64,
    /// Of the random numbers.
    pub seed: u64,
}

impl Layout {
    /// Evenly spread.
    pub fn even(per_cell: usize) -> Self {
        Self {
            per_cell,
            jitter: 0.0,
            seed: 0,
        }
    }
}

/// Energy over time.
#[derive(Clone, Debug, Default)]
pub struct Trace {
    /// Times (s) and energies over the initial one, from the start to the end or to where the run stopped.
    pub energy: Vec<(f64, f64)>,
    /// Where it stopped (s), and why.
    pub stopped: Option<(f64, String)>,
}

impl Trace {
    /// Energy at a time that was looked at; `None` after a stop.
    pub fn at(&self, time: f64) -> Option<f64> {
        let near = |(t, _): &&(f64, f64)| (t - time).abs() < 0.5 * STEP;
        self.energy.iter().find(near).map(|(_, energy)| *energy)
    }

    /// Highest energy before `time`.
    pub fn highest(&self, time: f64) -> f64 {
        let until = self.energy.iter().take_while(|(t, _)| *t <= time + STEP);
        until.map(|(_, energy)| *energy).fold(0.0, f64::max)
    }

    /// Lowest energy before `time`.
    pub fn lowest(&self, time: f64) -> f64 {
        let until = self.energy.iter().take_while(|(t, _)| *t <= time + STEP);
        until.map(|(_, energy)| *energy).fold(f64::INFINITY, f64::min)
    }
}

fn scene(case: &Case, variant: Variant, layout: Layout) -> Result<Scene, Box<dyn Error>> {
    let Layout {
        per_cell,
        jitter,
        seed,
    } = layout;
    let mut set = vec![
        format!("body.0.velocity=[\"{:?}*sin(pi*x)\"]", case.velocity),
        format!("reference.vibrating-bar.velocity={:?}", case.velocity),
        format!("body.0.particles_per_cell=[{per_cell}]"),
        format!("body.0.jitter={jitter:?}"),
        format!("body.0.seed={seed}"),
        format!("grid.cells=[{}]", case.cells),
        format!("method.basis={}", variant.method.basis.name()),
        format!("method.reconstruction={}", variant.method.reconstruction.name()),
    ];
    if variant.lumped {
        set.push("method.velocity_mass=lumped".into());
    }
    let text = Scene::builtin("vibrating-bar-large").ok_or("no such scene")?;
    Ok(Scene::from_toml(text, &set)?)
}

/// Runs a case to `end` (s), or until the run stops.
pub fn trace(case: &Case, variant: Variant, layout: Layout, end: f64) -> Result<Trace, Box<dyn Error>> {
    let mut simulation = simulation(&scene(case, variant, layout)?)?;
    let face = |side| Face { axis: 0, side };
    let held = Forcing::none()
        .with_face(face(Side::Min), FaceCondition::fixed())
        .with_face(face(Side::Max), FaceCondition::fixed());
    let initial = simulation.energy().total();
    let mut trace = Trace {
        energy: vec![(0.0, 1.0)],
        stopped: None,
    };
    for step in 1..=(end / STEP).round() as usize {
        let time = step as f64 * STEP;
        if let Err(error) = simulation.step(STEP, &held) {
            trace.stopped = Some((time, reason(&error)));
            break;
        }
        if step % STRIDE == 0 {
            let energy = simulation.energy().total() / initial;
            if !energy.is_finite() {
                trace.stopped = Some((time, "energy is no number".into()));
                break;
            }
            trace.energy.push((time, energy));
        }
    }
    Ok(trace)
}

/// What stopped a run, in few words.
fn reason(error: &StepError) -> String {
    match error {
        StepError::LeftGrid { .. } => "left the grid".into(),
        StepError::Stress { .. } => "stress beyond E".into(),
        StepError::Invalid { name, value, .. } => format!("{name} {value:.1e}"),
        StepError::StepSize { .. } => "step".into(),
        StepError::DiffusingValue { .. }
        | StepError::Friction { .. }
        | StepError::FrictionWithFlow { .. }
        | StepError::PressureWithoutFlow { .. }
        | StepError::RubbingAcross { .. }
        | StepError::ValueWithoutDiffusion { .. }
        | StepError::WallNotHeld { .. } => "wall".into(),
    }
}

/// The entropy solution, and how far it is from that on half the cells at the end.
pub fn exact(case: &Case, cells: usize) -> Result<(Trace, f64), Box<dyn Error>> {
    let law = Hill { youngs_modulus: 4e4 };
    let mut bar = EntropyBar::vibrating_bar(1.0, 2e3, case.velocity, law)?.with_cells(cells)?;
    let mut trace = Trace::default();
    let samples = (case.end() / (STEP * STRIDE as f64)).round() as usize;
    for sample in 0..=samples {
        let time = (sample * STRIDE) as f64 * STEP;
        bar.advance(time)?;
        trace.energy.push((time, bar.energy_ratio()));
    }
    let mut worst = 0.0_f64;
    let mut coarse = bar.clone().with_cells(cells / 2)?;
    for &time in case.times {
        coarse.advance(time)?;
        let fine = trace.at(time).ok_or("time is no sample")?;
        worst = worst.max((fine - coarse.energy_ratio()).abs());
    }
    Ok((trace, worst))
}

/// All runs of a case with one number of particles per cell.
pub type Runs = Vec<(Variant, Trace)>;

/// Runs every variant.
pub fn runs(case: &Case, per_cell: usize, variants: &[Variant]) -> Result<Runs, Box<dyn Error>> {
    let run = |variant: &Variant| {
        let trace = trace(case, *variant, Layout::even(per_cell), case.end())?;
        eprintln!(
            "{}, {per_cell} per cell: {} {}",
            case.name,
            variant.method,
            variant.mass()
        );
        Ok((*variant, trace))
    };
    variants.iter().map(run).collect()
}

fn number(energy: f64) -> String {
    match energy {
        e if e < 10.0 => format!("{e:.4}"),
        e if e < 1e4 => format!("{e:.1}"),
        e => format!("{e:.0e}"),
    }
}

fn row(names: &str, case: &Case, trace: &Trace) -> String {
    let mut row = format!("| {names} |");
    for &time in case.times {
        let energy = trace.at(time).map_or_else(|| "-".into(), number);
        let _ = write!(row, " {energy} |");
    }
    let stopped = trace.stopped.as_ref();
    let stopped = stopped.map_or_else(String::new, |(time, why)| format!("{time:.2} s: {why}"));
    format!("{row} {} | {stopped} |", number(trace.highest(case.end())))
}

/// A table in Markdown.
pub fn table(case: &Case, runs: &Runs, exact: &Trace) -> String {
    let mut lines = vec![String::from("| method | mass |"), String::from("|---|---|")];
    for time in case.times {
        let _ = write!(lines[0], " {time} s |");
        lines[1].push_str("---|");
    }
    lines[0].push_str(" highest | stopped at |");
    lines[1].push_str("---|---|");
    lines.push(row("*entropy solution* | ", case, exact));
    for (variant, trace) in runs {
        let names = format!("{} | {}", variant.method.literature_name(), variant.mass());
        lines.push(row(&names, case, trace));
    }
    lines.join("\n")
}

/// Every fifth point and the last one; a run that stopped goes on to its end.
fn thinned(trace: &Trace) -> Vec<(f64, f64)> {
    let mut points: Vec<(f64, f64)> = trace.energy.iter().step_by(5).copied().collect();
    if let (Some((time, _)), Some((_, energy))) = (&trace.stopped, trace.energy.last()) {
        points.push((*time, *energy));
    }
    points
}

/// Panels of one number of particles per cell, one a basis.
fn panels(per_cell: usize, runs: &Runs, exact: &Trace) -> Vec<LinePanel> {
    let bases = [
        (Basis::Linear, "linear"),
        (Basis::DualDomain, "dual domain"),
        (Basis::BSpline { degree: 2 }, "B-splines"),
    ];
    let line = |(variant, trace): &(Variant, Trace)| {
        let (family, dash) = variant.look();
        let stopped = trace.stopped.as_ref();
        Line {
            label: variant.label().into(),
            family,
            variant: dash,
            points: thinned(trace),
            stopped: stopped.map_or_else(String::new, |(time, _)| format!("{time:.1} s")),
        }
    };
    let panel = |(basis, name): (Basis, &str)| LinePanel {
        name: format!("{name}, {per_cell} per cell"),
        lines: runs
            .iter()
            .filter(|run| run.0.method.basis == basis)
            .map(line)
            .collect(),
        reference: thinned(exact),
        shaded: Vec::new(),
    };
    bases.map(panel).to_vec()
}

/// Runs a case; its picture goes to `pictures`, its tables into the `page`.
pub fn report(
    page: &str,
    case: &Case,
    per_cell: [usize; 2],
    variants: &[Variant],
    cells: usize,
    pictures: &Folder,
) -> Result<String, Box<dyn Error>> {
    let (exact, estimate) = exact(case, cells)?;
    let [first, second] = per_cell;
    let both = [runs(case, first, variants)?, runs(case, second, variants)?];
    let [left, right] = [panels(first, &both[0], &exact), panels(second, &both[1], &exact)];
    let side_by_side: Vec<LinePanel> = left.into_iter().zip(right).flat_map(<[_; 2]>::from).collect();
    let captions = LineCaptions {
        title: case.title,
        x: "time [s]",
        y: "energy / initial [-]",
        reference: "entropy solution",
        stopped: "the run stopped, at this time",
        shaded: "",
    };
    let name = format!("long-runs-{}.svg", case.name);
    pictures.write(&name, &draw_lines(&captions, case.axis, &side_by_side, 2))?;
    let mut text = format!("![{}](../pictures/{name})\n", case.title);
    for (per_cell, runs) in per_cell.iter().zip(&both) {
        let _ = write!(
            text,
            "\n{per_cell} particles per cell:\n\n{}\n",
            table(case, runs, &exact)
        );
    }
    let _ = write!(
        text,
        "\nThe entropy solution has {cells} cells; on half of them it differs by {estimate:.1e} at most."
    );
    Ok(fill_in(page, case.name, &text)?)
}

// The tests include this file as a module and call `report` themselves.
#[allow(dead_code)]
fn main() -> Result<(), Box<dyn Error>> {
    let path = Path::new("docs/verification/long-runs.md");
    let pictures = Folder::create(Path::new("docs/pictures"))?;
    for case in [SMOOTH, SHOCKS] {
        let page = fs::read_to_string(path)?;
        let page = report(&page, &case, [8, 4], &Variant::all(), EXACT_CELLS, &pictures)?;
        fs::write(path, page)?;
    }
    Ok(())
}
