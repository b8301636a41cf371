use super::super::soil::tests::report_soil;
use super::*;
use crate::reference::Logarithmic;

#[test]
#[ignore]
fn probe() {
    for (k, m, t) in [(3.68e-4, 2.0, 0.4), (1e-5, 2.0, 0.4)] {
        for (elements, degree, levels) in [
            (8, 8, 0),
            (8, 8, 2),
            (8, 8, 4),
            (8, 8, 6),
            (8, 8, 8),
            (16, 8, 5),
            (8, 12, 5),
            (16, 6, 5),
        ] {
            let soil = Soil {
                permeability_exponent: m,
                ..report_soil(k, 3e7)
            };
            let clock = std::time::Instant::now();
            let problem = SoilProblem::new(1.0, soil, Logarithmic { youngs_modulus: 1e6 })
                .load(|_| -5e5)
                .initial_stresses(|_| 0.0, |_| -5e5)
                .levels(levels);
            let mut s = LagrangianSoil::new(problem, Resolution { elements, degree }).unwrap();
            let r = s.advance(t);
            println!(
                "k {k:e} m {m} {elements}x{degree}/{levels}: {r:?} settlement {:.9e} in {:?} level {}",
                s.at(1.0).solid_displacement,
                clock.elapsed(),
                s.level
            );
        }
    }
}
