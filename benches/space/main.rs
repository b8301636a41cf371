//! Whole steps in two and three dimensions: millions of particle-steps a second, and how near they come to
//! the machine.
//!
//! `cargo bench --bench space [FILTER ...]`: only the cases whose names contain every FILTER.
//!
//! Quadratic B-splines, `f64`, full stress tensor, MUSL, two particles a cell and axis (three where TLS is
//! relaxed, and beside it); Hooke's law unless the name says otherwise. Cases of one size take turns; the
//! median and the best of several samples are printed, on one thread and on two.

mod body;
mod counts;
mod machine;
mod yardstick;

use std::time::Instant;

use materialpoint::law::{LinearElastic, Moduli, NeoHookean};
use materialpoint::mass::VelocityMass;
use materialpoint::reconstruction::{RelaxedTaylor, Shepard, Taylor};
use materialpoint::stepper::Simulation;

use body::{Body, Order, POISSON, YOUNG, walls};
use counts::Counts;
use yardstick::Plain;

const SAMPLES: usize = 11;
/// Least time (s) of a sample on one thread and on more. The system counts what a thread ran up to its last
/// tick, some milliseconds ago: samples of ten milliseconds came out up to twice too fast. The clock on the
/// wall, for more threads, needs no such care, and published TLS does not bear ever more steps.
const SAMPLE: [f64; 2] = [0.25, 0.1];

/// Something that steps.
struct Case {
    name: String,
    particles: usize,
    counts: Option<Counts>,
    step: Box<dyn FnMut() + Send>,
    /// Steps of a sample.
    steps: usize,
    /// Millions of particle-steps a second.
    samples: Vec<f64>,
}

/// A stepper of any kind, which one thread after the other may have.
struct Shared<const D: usize>(Box<dyn Simulation<D> + Send>);

fn wanted(name: &str) -> bool {
    let filters: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    filters.iter().all(|filter| name.contains(filter.as_str()))
}

fn case<const D: usize>(
    what: &str,
    body: Body,
    counts: Option<Counts>,
    build: impl FnOnce() -> Box<dyn Simulation<D> + Send>,
) -> Vec<Case> {
    let order = match body.order {
        Order::Cells => "cells",
        Order::Shuffled => "shuffled",
    };
    let particles = body.particles::<D>();
    let name = format!("{D}d {what} {order} {particles}");
    if !wanted(&name) {
        return Vec::new();
    }
    let (mut simulation, forcing, dt) = (Shared(build()), walls::<D>(), body.step());
    vec![Case {
        name,
        particles,
        counts,
        step: Box::new(move || {
            let Shared(simulation) = &mut simulation;
            simulation.step(dt, &forcing).expect("a stable step");
        }),
        steps: 0,
        samples: Vec::new(),
    }]
}

fn elastic() -> LinearElastic<f64> {
    let moduli = Moduli::from_young(YOUNG, POISSON).expect("good constants");
    LinearElastic { moduli }
}

fn plane(particles: usize) -> Vec<Case> {
    let counts = Some(counts::plain::<2>());
    let lumped = VelocityMass::Lumped;
    let mut cases = Vec::new();
    for order in [Order::Cells, Order::Shuffled] {
        let body = Body::of::<2>(particles, order);
        cases.extend(case("shepard", body, counts, || {
            body.simulation::<2, _, _>(Shepard, elastic(), lumped)
        }));
        cases.extend(case("tls", body, None, || {
            body.simulation::<2, _, _>(Taylor::<f64, 2, 6>::new(), elastic(), lumped)
        }));
    }
    let body = Body::of::<2>(particles, Order::Cells);
    cases.extend(case("shepard neo-hookean", body, None, || {
        let law = NeoHookean {
            moduli: elastic().moduli,
        };
        body.simulation::<2, _, _>(Shepard, law, lumped)
    }));
    cases.extend(yardstick(body, counts));
    cases
}

fn yardstick(body: Body, counts: Option<Counts>) -> Option<Case> {
    let particles = body.particles::<2>();
    let name = format!("2d plain loop cells {particles}");
    if !wanted(&name) {
        return None;
    }
    let (mut plain, dt) = (Plain::new(body), body.step());
    Some(Case {
        name,
        particles: plain.len(),
        counts,
        step: Box::new(move || plain.step(dt)),
        steps: 0,
        samples: Vec::new(),
    })
}

fn space(particles: usize) -> Vec<Case> {
    let counts = Some(counts::plain::<3>());
    let lumped = VelocityMass::Lumped;
    let mut cases = Vec::new();
    for order in [Order::Cells, Order::Shuffled] {
        let body = Body::of::<3>(particles, order);
        cases.extend(case("shepard", body, counts, || {
            body.simulation::<3, _, _>(Shepard, elastic(), lumped)
        }));
        cases.extend(case("tls", body, None, || {
            body.simulation::<3, _, _>(Taylor::<f64, 3, 10>::new(), elastic(), lumped)
        }));
    }
    cases
}

/// Relaxed TLS, whose matrix is solved twice a step, beside published TLS with the consistent mass. Three
/// particles a cell and axis: with two and B-splines it gains energy in the some thousand steps of a
/// measurement.
fn relaxed() -> Vec<Case> {
    let (consistent, constrained) = (VelocityMass::Consistent, VelocityMass::Constrained);
    let mut cases = Vec::new();
    for particles in [10_000, 100_000] {
        let body = Body::with::<2>(particles, 3, Order::Cells);
        cases.extend(case("consistent tls", body, None, || {
            body.simulation::<2, _, _>(Taylor::<f64, 2, 6>::for_degree(2), elastic(), consistent)
        }));
        cases.extend(case("relaxed tls", body, None, || {
            let method = RelaxedTaylor::<f64, 2, 6>::for_degree(2);
            body.simulation::<2, _, _>(method, elastic(), constrained)
        }));
    }
    let body = Body::with::<3>(100_000, 3, Order::Cells);
    cases.extend(case("consistent tls", body, None, || {
        body.simulation::<3, _, _>(Taylor::<f64, 3, 10>::for_degree(2), elastic(), consistent)
    }));
    cases.extend(case("relaxed tls", body, None, || {
        let method = RelaxedTaylor::<f64, 3, 10>::for_degree(2);
        body.simulation::<3, _, _>(method, elastic(), constrained)
    }));
    cases
}

/// Seconds that `work` takes; on one thread those that it ran, where the system tells: others may share the
/// machine.
fn time(threads: usize, work: impl FnOnce()) -> f64 {
    let ran = || {
        let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
        let nanoseconds: f64 = text.split(' ').next()?.parse().ok()?;
        Some(1e-9 * nanoseconds)
    };
    let (begun, before) = (Instant::now(), ran());
    work();
    match (before, ran()) {
        (Some(before), Some(after)) if threads == 1 => after - before,
        _ => begun.elapsed().as_secs_f64(),
    }
}

fn measure(mut cases: Vec<Case>, threads: usize, limits: (f64, f64)) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let pool = pool.expect("threads");
    for sample in 0..=SAMPLES {
        for case in &mut cases {
            let run = |case: &mut Case, steps| {
                pool.install(|| time(threads, || (0..steps).for_each(|_| (case.step)())))
            };
            // The first one warms up and says how many steps a sample takes.
            if sample == 0 {
                case.steps = 1;
                while run(case, case.steps) < SAMPLE[usize::from(threads > 1)] {
                    case.steps *= 2;
                }
                continue;
            }
            let seconds = run(case, case.steps);
            case.samples
                .push(1e-6 * (case.steps * case.particles) as f64 / seconds);
        }
    }
    for case in &mut cases {
        case.samples.sort_by(f64::total_cmp);
        let (median, best) = (case.samples[SAMPLES / 2], case.samples[SAMPLES - 1]);
        print!("{:44} {threads} {median:7.2} {best:7.2}", case.name);
        if let Some(Counts { bytes, flops }) = case.counts {
            let share = |each: f64, limit: f64| 1e8 * best * each / limit / threads as f64;
            let (memory, peak) = (share(bytes, limits.0), share(flops, limits.1));
            print!("   {bytes:4.0} {flops:5.0} {memory:4.0} % {peak:4.0} %");
        }
        println!();
    }
}

fn main() {
    let limits = (machine::bandwidth(), machine::peak());
    let [gigabytes, gigaflops] = [limits.0, limits.1].map(|x| x * 1e-9);
    println!("one thread: triad {gigabytes:.1} GB/s, fused multiply-add {gigaflops:.1} Gflop/s");
    println!(
        "M particle-steps/s on so many threads: median, best; bytes and flops each, share of the machine's"
    );
    for threads in [1, 2] {
        for particles in [100_000, 1_000_000] {
            measure(plane(particles), threads, limits);
            measure(space(particles), threads, limits);
        }
        measure(relaxed(), threads, limits);
    }
}
