//! What a step costs: of every method, dimension, number of phases and number of particles a cell.
//!
//! * `cargo bench --bench cost [FILTER]` prints medians of times, on one thread;
//! * `cargo bench --bench cost -- count [FILTER]` prints instructions, which do not depend on what else the
//!   machine does, and compares them with those on the page: more than 2 % above is an error. It runs itself
//!   under `valgrind`;
//! * `cargo bench --bench cost -- write` counts and times, and writes `docs/verification/cost.md`.
//!
//! Bodies fill a closed box and move smoothly; threads are those of a pool of one.

mod case;
mod table;

use std::error::Error;
use std::process::{Command, ExitCode};
use std::time::Instant;

use case::Case;

/// Steps before anything is measured.
const WARM: usize = 5;
/// Steps whose instructions are the difference of two counts.
const COUNTED: usize = 4;
/// Time (s) of one sample, about, and samples.
const SAMPLE: f64 = 0.04;
const SAMPLES: usize = 9;
/// Growth of a count that is an error.
const MOST_GROWTH: f64 = 0.02;

fn main() -> ExitCode {
    match run() {
        Ok(code) => code,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(2)
        }
    }
}

fn run() -> Result<ExitCode, Box<dyn Error>> {
    let mut words: Vec<String> = std::env::args()
        .skip(1)
        .filter(|word| word != "--bench")
        .collect();
    let wants = |words: &mut Vec<String>, mode: &str| {
        let found = words.first().is_some_and(|word| word == mode);
        if found {
            words.remove(0);
        }
        found
    };
    // Steps alone, to be counted.
    if wants(&mut words, "run") {
        let [name, steps] = &words[..] else {
            return Err("`run` wants a case and a number of steps".into());
        };
        let case = Case::all().into_iter().find(|case| case.to_string() == *name);
        step(&case.ok_or("there is no such case")?, steps.parse()?)?;
        return Ok(ExitCode::SUCCESS);
    }
    let (count, write) = (wants(&mut words, "count"), wants(&mut words, "write"));
    let filter = words.first().cloned().unwrap_or_default();
    let cases = || {
        Case::all()
            .into_iter()
            .filter(|case| case.to_string().contains(&filter))
    };
    if write {
        let mut rows = Vec::new();
        for case in cases() {
            let instructions = instructions(&case)?;
            rows.push(table::Row::new(&case, instructions, time(&case)?));
            eprintln!("{}", rows[rows.len() - 1]);
        }
        table::write(&rows)?;
    } else if count {
        return compare(cases());
    } else {
        for case in cases() {
            println!("{case:<52} {:8.2} ns a particle and step", time(&case)?);
        }
    }
    Ok(ExitCode::SUCCESS)
}

/// Counts, and says which have grown.
fn compare(cases: impl Iterator<Item = Case>) -> Result<ExitCode, Box<dyn Error>> {
    let recorded = table::recorded()?;
    let mut code = ExitCode::SUCCESS;
    for case in cases {
        let found = instructions(&case)?;
        let known = recorded.iter().find(|(name, _)| *name == case.to_string());
        let growth = known.map(|(_, count)| found / count - 1.0);
        let word = match growth {
            None => "new".to_owned(),
            Some(growth) => format!("{:+.1} %", 100.0 * growth),
        };
        println!("{case:<52} {found:9.1} instructions a particle and step, {word}");
        if growth.is_some_and(|growth| growth > MOST_GROWTH) {
            code = ExitCode::FAILURE;
        }
    }
    Ok(code)
}

fn step(case: &Case, steps: usize) -> Result<(), Box<dyn Error>> {
    let mut body = case.body()?;
    for _ in 0..steps {
        body.step()?;
    }
    Ok(())
}

/// Instructions a particle and step.
fn instructions(case: &Case) -> Result<f64, Box<dyn Error>> {
    let [few, many] = [WARM, WARM + COUNTED].map(|steps| counted(case, steps));
    Ok((many? - few?) / (COUNTED * case.particles()) as f64)
}

/// Instructions of a whole run, by `valgrind`.
fn counted(case: &Case, steps: usize) -> Result<f64, Box<dyn Error>> {
    let itself = std::env::current_exe()?;
    let output = Command::new("valgrind")
        .args([
            "--tool=cachegrind",
            "--cache-sim=no",
            "--cachegrind-out-file=/dev/null",
        ])
        .arg(itself)
        .args(["run", &case.to_string(), &steps.to_string()])
        .env("RAYON_NUM_THREADS", "1")
        .output()
        .map_err(|error| format!("counts want `valgrind`: {error}"))?;
    let text = String::from_utf8_lossy(&output.stderr);
    // `==1== I refs:        1,234`, or `I   refs:`.
    let line = text.lines().find(|line| line.contains("refs:"));
    let digits = line.and_then(|line| line.split("refs:").nth(1));
    let digits = digits.ok_or_else(|| format!("{case} was not counted:\n{text}"))?;
    Ok(digits.trim().replace(',', "").parse()?)
}

/// Median time (ns) a particle and step, on one thread.
fn time(case: &Case) -> Result<f64, Box<dyn Error>> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    Ok(pool.install(|| median(case).map_err(|error| error.to_string()))?)
}

fn median(case: &Case) -> Result<f64, Box<dyn Error>> {
    let mut body = case.body()?;
    let mut each = 0.0;
    for _ in 0..WARM {
        let begun = Instant::now();
        body.step()?;
        each = begun.elapsed().as_secs_f64();
    }
    let steps = ((SAMPLE / each) as usize).clamp(1, 2000);
    let mut samples = Vec::new();
    for _ in 0..SAMPLES {
        let begun = Instant::now();
        for _ in 0..steps {
            body.step()?;
        }
        samples.push(begun.elapsed().as_secs_f64() * 1e9 / (steps * case.particles()) as f64);
    }
    samples.sort_by(f64::total_cmp);
    Ok(samples[SAMPLES / 2])
}
