//! The command on one thread and on two: what a user gets who says nothing of threads, beside `--threads 1`.
//!
//! `cargo bench --bench command [FILTER ...]`: only the cases whose names contain every FILTER.
//!
//! Each measurement is a run of the built command. One thread and two take turns, so that a machine that is
//! busy for a while slows both; the median and the best time of its step loop per particle and step are
//! printed. Two threads need two processors: on a busy machine the best times alone say something, and two
//! cores that share no cache are slower together than two that do.

use std::error::Error;
use std::path::Path;
use std::process::Command;

const RUNS: usize = 7;
const THREADS: [usize; 2] = [1, 2];
/// Particles times steps of a run, over what a step of the method takes (ns).
const WORK: f64 = 5e8;

/// A full box on rollers in smooth motion.
struct Case {
    method: [&'static str; 2],
    /// Time (ns) that a particle roughly takes in a step.
    roughly: f64,
    cells: usize,
    axes: usize,
    /// Particles of a cell along an axis.
    per_cell: usize,
}

impl Case {
    fn name(&self) -> String {
        let [basis, reconstruction] = self.method;
        format!("{}d {basis}+{reconstruction} {}", self.axes, self.particles())
    }

    fn particles(&self) -> usize {
        (self.cells * self.per_cell).pow(self.axes as u32)
    }

    /// As TOML. Nothing rests for long: tiny numbers would be denormal and slow. A wave takes ten steps
    /// through a cell.
    fn scene(&self) -> String {
        let each = |entry: &str| vec![entry; self.axes].join(", ");
        let [cells, per_cell] = [self.cells, self.per_cell].map(|n| each(&n.to_string()));
        let [basis, reconstruction] = self.method;
        let axes = ["x", "y", "z"].into_iter().take(self.axes);
        let velocity: Vec<String> = axes
            .clone()
            .map(|x| format!("\"0.01*sin(pi*{x}) + 0.001\""))
            .collect();
        let walls = axes.flat_map(|x| ["min", "max"].map(|side| format!("{x}-{side}")));
        let walls: String = walls
            .map(|face| format!("[[boundary]]\nface = \"{face}\"\nroller = true\n"))
            .collect();
        let step = 0.1 / self.cells as f64;
        let steps = (WORK / self.roughly / self.particles() as f64).ceil();
        format!(
            "title = \"Speed\"\n\
             [grid]\nmin = [{zeros}]\nmax = [{ones}]\ncells = [{cells}]\n\
             [time]\nstep = {step:e}\nend = {end:e}\n\
             [method]\nbasis = \"{basis}\"\nreconstruction = \"{reconstruction}\"\n\
             [material]\nstrain = \"large\"\ndensity = 1.0\n\
             law.linear-elastic = {{ youngs_modulus = 0.9{poisson} }}\n\
             [[body]]\nmin = [{zeros}]\nmax = [{ones}]\n\
             particles_per_cell = [{per_cell}]\nvelocity = [{velocity}]\n\
             {walls}",
            poisson = if self.axes > 1 {
                ", poissons_ratio = 0.2"
            } else {
                ""
            },
            zeros = each("0.0"),
            ones = each("1.0"),
            velocity = velocity.join(", "),
            end = step * steps,
        )
    }

    /// Times (ns) per particle and step on so many threads.
    fn run(&self, threads: usize) -> Result<f64, Box<dyn Error>> {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("bench-command");
        std::fs::create_dir_all(&folder)?;
        let scene = folder.join("scene.toml");
        std::fs::write(&scene, self.scene())?;
        let output = Command::new(env!("CARGO_BIN_EXE_materialpoint"))
            .arg("run")
            .arg(&scene)
            .arg("--out")
            .arg(&folder)
            .args(["--json", "--quiet", "--threads", &threads.to_string()])
            .output()?;
        if !output.status.success() {
            return Err(String::from_utf8_lossy(&output.stderr).into());
        }
        let summary: serde_json::Value = serde_json::from_slice(&output.stdout)?;
        let speed = summary["particle_steps_per_second"].as_f64();
        Ok(1e9 / speed.ok_or("no speed in the summary")?)
    }
}

fn cases() -> Vec<Case> {
    let case = |method, roughly, cells, axes, per_cell| Case {
        method,
        roughly,
        cells,
        axes,
        per_cell,
    };
    let mut cases = Vec::new();
    for cells in [500, 1000, 2000, 4000, 12_500, 125_000] {
        cases.push(case(["linear", "shepard"], 4.0, cells, 1, 8));
        cases.push(case(["linear", "relaxed-taylor"], 20.0, cells, 1, 8));
    }
    for cells in [32, 40, 45, 64, 160, 500] {
        cases.push(case(["bspline", "shepard"], 25.0, cells, 2, 2));
    }
    for cells in [24, 30, 105] {
        cases.push(case(["bspline", "relaxed-taylor"], 200.0, cells, 2, 3));
    }
    for cells in [8, 10, 23, 50] {
        cases.push(case(["bspline", "shepard"], 90.0, cells, 3, 2));
    }
    cases
}

fn main() -> Result<(), Box<dyn Error>> {
    let filters: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    println!(
        "{:40} ns a particle and step on 1 and 2 threads: median, best, gain of the best",
        ""
    );
    for case in cases() {
        let name = case.name();
        if !filters.iter().all(|filter| name.contains(filter.as_str())) {
            continue;
        }
        let mut times = THREADS.map(|_| Vec::new());
        for _ in 0..RUNS {
            for (times, threads) in times.iter_mut().zip(THREADS) {
                times.push(case.run(threads)?);
            }
        }
        let [one, two] = times.map(|mut times| {
            times.sort_by(f64::total_cmp);
            [times[RUNS / 2], times[0]]
        });
        let gain = one[1] / two[1];
        println!(
            "{name:40} {:7.2} {:7.2}   {:7.2} {:7.2}   {gain:5.2}",
            one[0], two[0], one[1], two[1]
        );
    }
    Ok(())
}
