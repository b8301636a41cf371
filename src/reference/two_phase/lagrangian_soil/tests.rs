use super::super::soil::tests::report_soil;
use super::*;
use crate::reference::Logarithmic;

#[test]
#[ignore]
fn probe() {
    for (k, m, t) in [
        (3.68e-4, 2.0, 0.4),
        (1e-5, 0.0, 0.4),
        (1e-5, 1.0, 0.4),
        (1e-5, 2.0, 0.4),
        (1e-9, 2.0, 0.05),
    ] {
        for (elements, degree) in [(8, 8), (16, 8), (32, 6), (32, 8)] {
            let soil = Soil {
                permeability_exponent: m,
                ..report_soil(k, 3e7)
            };
            let clock = std::time::Instant::now();
            let mut s = LagrangianSoil::consolidation(1.0, -5e5, soil, Logarithmic { youngs_modulus: 1e6 })
                .unwrap()
                .with_resolution(Resolution { elements, degree })
                .unwrap();
            let r = s.advance(t);
            println!(
                "k {k:e} m {m} {elements}x{degree}: {r:?} settlement {:.9e} in {:?}",
                s.at(1.0).solid_displacement,
                clock.elapsed()
            );
        }
    }
}
