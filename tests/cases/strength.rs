//! Source: limit analysis in plane strain; Drucker & Prager (1952); dry sand bears no tension.
//! Goal: a body bears what plasticity says, stands just below it and flows just above; sand without cohesion
//! flies apart.
//! Parameters: a block of 1 m x 1 m, half of it computed, its sides free, pressed on top within 0.5 s by 0.97
//! and 1.03 of its strength, 10 cells high; the same between smooth walls under 400 kPa; a square of sand of
//! 0.4 m, whose velocity grows with the place.
//! Expected: von Mises bears 2 / sqrt(3) of the yield stress, Drucker-Prager matched in plane strain 2 c
//! cos(phi) / (1 - sin(phi)) with any dilation. Below, von Mises settles by q y (1 - nu^2) / E within 1 %:
//! measured 0.9924 to 0.9927 mm at y = 0.975 m for 0.9937. Above, it settles by 54 mm or more; Drucker-Prager
//! by 2.0 to 3.0 mm below and 59 to 257 mm above. Between walls sigma_xx - sigma_yy is the yield stress
//! within 1 %. Sand has no stress, keeps its energy and flies straight on; with Shepard mapped velocities
//! leave the outermost particles behind, by 12.7 to 18.2 % of the largest way, and relaxed TLS, which has
//! linear velocities, leaves none.

use super::{BASES, largest, solved_by};

const BLOCK: &str = include_str!("strength.toml");
const SAND: &str = include_str!("sand-apart.toml");

fn pressed(pressure: f64) -> String {
    format!("boundary.2.traction=['0', '-{pressure:?}*sin(pi/2*min(t/0.5,1))^2']")
}

/// Settlement (m) of the uppermost particles and their height (m).
fn settled(basis: &str, set: &[&str]) -> [f64; 2] {
    let particles = solved_by(BLOCK, [basis, "shepard"], set).particles;
    let top = largest(particles.initial_position.iter().map(|x| x[1]));
    let uppermost = particles
        .displacement
        .iter()
        .zip(&particles.initial_position)
        .filter(|(_, x)| x[1] > top - 1e-9);
    let (sum, count) = uppermost.fold((0.0, 0), |(sum, count), (u, _)| (sum - u[1], count + 1));
    [sum / f64::from(count), top]
}

#[test]
fn von_mises_bears_its_strength_in_plane_strain() {
    let strength = 2.0 / 3_f64.sqrt() * 1e5;
    for basis in BASES {
        let pressure = 0.97 * strength;
        let [stands, height] = settled(basis, &[&pressed(pressure)]);
        let elastic = pressure * height * (1.0 - 0.3 * 0.3) / 1e8;
        assert!(
            (stands / elastic - 1.0).abs() < 0.01,
            "{basis}: {stands}, {elastic}"
        );
        let [flows, _] = settled(basis, &[&pressed(1.03 * strength), "time.end=0.7"]);
        assert!(flows > 10.0 * elastic, "{basis}: {flows}");
    }
}

#[test]
fn drucker_prager_bears_its_strength_in_plane_strain_with_any_dilation() {
    let angle = 25_f64.to_radians();
    let strength = 2.0 * 5e4 * angle.cos() / (1.0 - angle.sin());
    for dilation in ["0", "25"] {
        let law = format!(
            "material.law={{drucker-prager={{youngs_modulus=1e8, poissons_ratio=0.3, cohesion=5e4, \
             friction_angle=25, dilation_angle={dilation}}}}}"
        );
        let [stands, _] = settled("linear", &[&law, &pressed(0.97 * strength)]);
        assert!(stands < 5e-3, "dilation {dilation}: {stands}");
        let [flows, _] = settled("linear", &[&law, &pressed(1.03 * strength)]);
        assert!(flows > 30e-3, "dilation {dilation}: {flows}");
    }
}

#[test]
fn between_walls_the_difference_of_stresses_is_the_yield_stress() {
    let set = [
        "grid={min=[0, 0], max=[0.5, 1.2], cells=[5, 12]}",
        "boundary=[{face='x-min', roller=true}, {face='x-max', roller=true}, {face='y-min', roller=true}, \
         {face='y-max', traction=['0', '-4e5*sin(pi/2*min(t/0.5,1))^2']}]",
        "time.end=0.6",
    ];
    for basis in BASES {
        for stress in &solved_by(BLOCK, [basis, "shepard"], &set).particles.stress {
            let difference = (stress[(0, 0)] - stress[(1, 1)]) / 1e5;
            assert!((difference - 1.0).abs() < 0.01, "{basis}: {difference}");
        }
    }
}

#[test]
fn dry_sand_flies_apart_without_stress() {
    for basis in BASES {
        for (reconstruction, lag, density_off) in
            [("shepard", 0.2, f64::INFINITY), ("relaxed-taylor", 1e-9, 1e-9)]
        {
            let outcome = solved_by(SAND, [basis, reconstruction], &[]);
            let particles = &outcome.particles;
            let stress = largest(particles.stress.iter().map(|s| s.abs().max()));
            // Of round-off: a strain of 1e-12 would cause 1e-6 Pa.
            assert!(stress < 1e-6, "{basis} {reconstruction}: {stress}");
            let energy = outcome.summary.energy;
            for ratio in [energy.highest_ratio, energy.lowest_ratio] {
                assert!(
                    (ratio.unwrap() - 1.0).abs() < 1e-9,
                    "{basis} {reconstruction}: {energy:?}"
                );
            }
            // x = 1 + (x0 - 1) (1 + 0.5 t) at 0.5 s.
            let ways = || {
                particles
                    .initial_position
                    .iter()
                    .map(|x| x.add_scalar(-1.0) * 0.25)
            };
            let longest = largest(ways().map(|way| way.norm()));
            let off = particles
                .displacement
                .iter()
                .zip(ways())
                .map(|(u, way)| (u - way).norm());
            let off = largest(off) / longest;
            assert!(off < lag, "{basis} {reconstruction}: {off}");
            let expected = 1600.0 / (1.25 * 1.25);
            let off = largest((0..particles.len()).map(|p| particles.density(p) / expected - 1.0));
            assert!(off < density_off, "{basis} {reconstruction}: density {off}");
        }
    }
}
