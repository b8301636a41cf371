//! One step of each method against a plain hand-written loop, over the number of particles.
//!
//! `cargo bench --bench step [FILTER]`; criterion prints millions of particle-steps per second as `Melem/s`.
//! Filter `f32` for single beside double precision.

mod bar;
mod yardstick;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use materialpoint::method::Method;

use bar::{Layout, STEP, fixed_ends, simulation, single_precision};
use yardstick::Bar;

const SIZES: [usize; 3] = [1_000, 100_000, 1_000_000];

fn steps(criterion: &mut Criterion) {
    for per_cell in [4, 8] {
        for particles in SIZES {
            let layout = Layout {
                cells: particles / per_cell,
                per_cell,
            };
            let mut group = criterion.benchmark_group(format!("{per_cell} per cell"));
            group
                .throughput(Throughput::Elements(particles as u64))
                .sample_size(20);
            let step = STEP / layout.cells as f64;
            yardsticks_agree(layout, step);
            for (name, advance) in [
                ("loop, linear", Bar::step_linear as fn(&mut Bar, f64)),
                ("loop, quadratic", Bar::step_quadratic),
            ] {
                let mut bar = layout.plain();
                group.bench_function(BenchmarkId::new(name, particles), |b| {
                    b.iter(|| advance(&mut bar, step))
                });
            }
            let forcing = fixed_ends();
            for method in Method::ALL {
                let mut stepper = simulation(method, layout);
                group.bench_function(BenchmarkId::new(method.to_string(), particles), |b| {
                    b.iter(|| stepper.step(step, &forcing).expect("a stable step"));
                });
            }
        }
    }
}

/// The loops must do the stepper's work: same positions after some steps.
fn yardsticks_agree(layout: Layout, step: f64) {
    let advance = [Bar::step_linear as fn(&mut Bar, f64), Bar::step_quadratic];
    for (name, advance) in ["linear+shepard", "bspline+shepard"].into_iter().zip(advance) {
        let method = Method::ALL.into_iter().find(|m| m.to_string() == name);
        let mut stepper = simulation(method.expect("a method of that name"), layout);
        let mut bar = layout.plain();
        for _ in 0..20 {
            stepper.step(step, &fixed_ends()).expect("a stable step");
            advance(&mut bar, step);
        }
        let positions = &stepper.particles().position;
        let difference = positions.iter().zip(&bar.x).map(|(a, b)| (a[0] - b).abs());
        let worst = difference.fold(0.0, f64::max);
        assert!(worst < 1e-13, "{name}: positions differ by {worst:e}");
    }
}

/// Single beside double precision. With 1e6 particles a cell is given 64: eight would be in cells of some
/// hundred single-precision numbers, and one particle in ten so near an edge that its cell is looked up in
/// each step.
fn precisions(criterion: &mut Criterion) {
    let forcing = fixed_ends();
    for (per_cell, particles) in [(8, 100_000), (64, 1_000_000)] {
        let layout = Layout {
            cells: particles / per_cell,
            per_cell,
        };
        let mut group = criterion.benchmark_group(format!("f32 and f64, {per_cell} per cell"));
        group
            .throughput(Throughput::Elements(particles as u64))
            .sample_size(20);
        let step = STEP / layout.cells as f64;
        for method in Method::ALL {
            for (name, mut stepper) in [
                ("f64", simulation(method, layout)),
                ("f32", single_precision(method, layout)),
            ] {
                group.bench_function(BenchmarkId::new(format!("{method} {name}"), particles), |b| {
                    b.iter(|| stepper.step(step, &forcing).expect("a stable step"));
                });
            }
        }
    }
}

criterion_group!(benches, steps, precisions);
criterion_main!(benches);
