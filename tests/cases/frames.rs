//! Source: objectivity and dimensional analysis; Airy's stress function; the disc in steady rotation,
//! Timoshenko & Goodier (1970).
//! Goal: results do not depend on rotation, units, the place of the origin, or on whether a plane problem is
//! computed in space.
//! Parameters: a disc of radius 0.5 m with a locked-in stress that balances itself, beside which the
//! centrifugal stress is small, spins by a quarter turn; a slab of 0.53 m x 0.41 m x 0.2 m between smooth
//! walls is sheared and bent; soil that yields, written in four systems of units and at another place.
//! Expected: the stress of each particle turns with the body, Q sigma Q^T, for every law and any step: 3 % of
//! the locked-in stress may go with 24 cells and B-splines, and what is left over falls with the cells.
//! Measured shares 0.974 to 0.979, the rest 0.95 with 12 cells and 0.40 to 0.41 with 24 (a wrong sign of the
//! spin gives an error of 2). Linear functions do not converge here. The slab is the plane run to 1e-12, to
//! 1e-11 with a state. Units that are powers of two change no bit, others 1e-11; another origin 1e-10.

use materialpoint::particles::Particles;
use nalgebra::{Matrix2, matrix};

use super::{double_dot, largest, solved};

const DISC: &str = include_str!("turning-disc.toml");
const SLAB: &str = include_str!("slab.toml");
const UNITS: &str = include_str!("units.toml");

/// Locked-in stress (Pa).
fn locked_in(x: f64, y: f64) -> Matrix2<f64> {
    let (within, across) = (0.25 - x * x - y * y, x * x - y * y);
    let common = -4.0 * within * across;
    let xx = -2.0 * within * within + common + 8.0 * y * y * across + 16.0 * y * y * within;
    let yy = 2.0 * within * within + common + 8.0 * x * x * across - 16.0 * x * x * within;
    let xy = -8.0 * x * y * across;
    matrix![xx, xy; xy, yy] * 4000.0
}

/// Stress (Pa) of the spin at 1 rad/s in plane strain.
fn centrifugal(x: f64, y: f64) -> Matrix2<f64> {
    let (poisson, radius_squared, density) = (0.3, 0.25, 1000.0);
    let scale = density / (8.0 * (1.0 - poisson));
    let r_squared = x * x + y * y;
    let radial = scale * (3.0 - 2.0 * poisson) * (radius_squared - r_squared);
    let hoop = scale * ((3.0 - 2.0 * poisson) * radius_squared - (1.0 + 2.0 * poisson) * r_squared);
    let outward = matrix![x * x, x * y; x * y, y * y] / r_squared;
    outward * radial + (Matrix2::identity() - outward) * hoop
}

/// Share of the locked-in stress after a quarter turn, by least squares of both stresses, and what neither
/// explains over the locked-in one.
fn left(set: &[&str]) -> [f64; 2] {
    let particles = solved::<2>(DISC, set).particles;
    let quarter = matrix![0.0, -1.0; 1.0, 0.0];
    let stresses = || {
        let turned = particles.stress.iter().zip(&particles.initial_position);
        turned.map(|(stress, x)| {
            let back = quarter.transpose() * stress * quarter;
            (back, locked_in(x[0], x[1]), centrifugal(x[0], x[1]))
        })
    };
    let (mut normal, mut right) = (Matrix2::zeros(), nalgebra::Vector2::zeros());
    for (found, a, b) in stresses() {
        let cross = double_dot(&a, &b);
        normal += matrix![double_dot(&a, &a), cross; cross, double_dot(&b, &b)];
        right += nalgebra::vector![double_dot(&a, &found), double_dot(&b, &found)];
    }
    let shares = normal.try_inverse().unwrap() * right;
    let rest: f64 = stresses()
        .map(|(found, a, b)| {
            let rest = found - a * shares[0] - b * shares[1];
            double_dot(&rest, &rest)
        })
        .sum();
    [shares[0], (rest / normal[(0, 0)]).sqrt()]
}

const NINE_HUNDRED_STEPS: &str = "time.step=0.0017453292519943296";

#[test]
fn a_locked_in_stress_turns_with_the_body_in_every_law() {
    for law in [
        "linear-elastic={youngs_modulus=1e5, poissons_ratio=0.3}",
        "neo-hookean={youngs_modulus=1e5, poissons_ratio=0.3}",
        "logarithmic={youngs_modulus=1e5, poissons_ratio=0.3}",
        "von-mises={youngs_modulus=1e5, poissons_ratio=0.3, yield_stress=1e6}",
        "drucker-prager={youngs_modulus=1e5, poissons_ratio=0.3, cohesion=1e6, friction_angle=30}",
    ] {
        let [share, rest] = left(&[NINE_HUNDRED_STEPS, &format!("material.law={{{law}}}")]);
        assert!((share - 1.0).abs() < 0.03, "{law}: {share}");
        assert!(rest < 0.45, "{law}: {rest}");
    }
}

#[test]
fn neither_steps_nor_cells_take_a_locked_in_stress_away() {
    let [of_large_steps, rest] = left(&[NINE_HUNDRED_STEPS]);
    let [of_small_steps, _] = left(&["time.step=0.0005817764173314432"]);
    assert!(
        (of_large_steps - of_small_steps).abs() < 0.01,
        "{of_large_steps} {of_small_steps}"
    );
    let [_, coarse] = left(&[NINE_HUNDRED_STEPS, "grid.cells=[12, 12]"]);
    assert!(rest < coarse / 2.0, "{coarse} {rest}");
}

/// The slab with its axes renamed: `axes[k]` is what the k-th axis of the scene becomes.
fn slab(axes: [usize; 3], set: &[&str]) -> Particles<f64, 3> {
    let renamed = |values: [&str; 3]| {
        let mut out = [""; 3];
        for (value, axis) in values.into_iter().zip(axes) {
            out[axis] = value;
        }
        out.join(", ")
    };
    let names = axes.map(|axis| ["x", "y", "z"][axis]);
    let along = format!("'2*{}'", names[1]);
    let across = format!("'-3*{}*{}'", names[0], names[1]);
    let walls = ["0-min", "1-min", "2-min", "2-max"].map(|wall| {
        let (axis, side) = wall.split_at(1);
        let axis: usize = axis.parse().unwrap();
        format!("{{face='{}{side}', roller=true}}", names[axis])
    });
    let all = [
        format!(
            "grid={{min=[0, 0, 0], max=[{}], cells=[{}]}}",
            renamed(["1.0", "0.8", "0.2"]),
            renamed(["10", "8", "2"])
        ),
        format!(
            "body=[{{min=[0, 0, 0], max=[{}], particles_per_cell=[3, 3, 3], velocity=[{}]}}]",
            renamed(["0.53", "0.41", "0.2"]),
            renamed([&along, &across, "'0'"])
        ),
        format!("load.body_force=[{}]", renamed(["'3'", "'-9.81'", "'0'"])),
        format!("boundary=[{}]", walls.join(", ")),
        "time.end=0.02".to_owned(),
    ];
    let all: Vec<&str> = all
        .iter()
        .map(String::as_str)
        .chain(set.iter().copied())
        .collect();
    solved::<3>(SLAB, &all).particles
}

/// The same numbers in plane strain: of the scene all that has three axes is overridden.
fn sheet(set: &[&str]) -> Particles<f64, 2> {
    let plane = [
        "grid={min=[0, 0], max=[1.0, 0.8], cells=[10, 8]}",
        "body=[{min=[0, 0], max=[0.53, 0.41], particles_per_cell=[3, 3], velocity=['2*y', '-3*x*y']}]",
        "load.body_force=['3', '-9.81']",
        "boundary=[{face='x-min', roller=true}, {face='y-min', roller=true}]",
        "time.end=0.02",
    ];
    let all: Vec<&str> = plane.into_iter().chain(set.iter().copied()).collect();
    solved::<2>(SLAB, &all).particles
}

fn assert_slab_is_sheet(axes: [usize; 3], set: &[&str], tolerance: f64) {
    let (space, plane) = (slab(axes, set), sheet(set));
    let [x, y, z] = axes;
    let way = largest(plane.displacement.iter().map(|u| u.norm()));
    let most = largest(plane.stress.iter().flat_map(|s| s.iter().copied()));
    assert_eq!(space.len() % plane.len(), 0);
    let mut matched = 0;
    for (p, place) in space.initial_position.iter().enumerate() {
        let twin = plane
            .initial_position
            .iter()
            .position(|at| (at[0] - place[x]).abs() + (at[1] - place[y]).abs() < 1e-9);
        let twin = twin.expect("a particle at the same place in the plane");
        matched += 1;
        let (u, v) = (space.displacement[p], plane.displacement[twin]);
        let off = largest([u[x] - v[0], u[y] - v[1], u[z]].into_iter()) / way;
        assert!(off < tolerance, "{axes:?} {set:?}: displacement {off:e}");
        let (s, t) = (&space.stress[p], &plane.stress[twin]);
        let differences = [
            s[(x, x)] - t[(0, 0)],
            s[(y, y)] - t[(1, 1)],
            s[(x, y)] - t[(0, 1)],
            s[(x, z)],
            s[(y, z)],
        ];
        let off = largest(differences.into_iter()) / most;
        assert!(off < tolerance, "{axes:?} {set:?}: stress {off:e}");
    }
    assert_eq!(matched, space.len());
}

#[test]
fn a_slab_between_smooth_walls_is_in_plane_strain() {
    let elastic = "material.law={neo-hookean={youngs_modulus=1e5, poissons_ratio=0.3}}";
    let sand = "material.law={drucker-prager={youngs_modulus=1e5, poissons_ratio=0.3, cohesion=500, \
                friction_angle=25, dilation_angle=5}}";
    for basis in ["linear", "dual-domain", "bspline"] {
        let basis = format!("method.basis={basis}");
        assert_slab_is_sheet([0, 1, 2], &[&basis, elastic], 1e-12);
        assert_slab_is_sheet([0, 1, 2], &[&basis, sand], 1e-11);
    }
}

#[test]
fn axes_have_no_order() {
    for axes in [[0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]] {
        assert_slab_is_sheet(axes, &[], 1e-12);
    }
}

/// Units of length, mass and time in those of the metre, kilogram and second.
#[derive(Clone, Copy)]
struct Units {
    length: f64,
    mass: f64,
    time: f64,
}

const SI: Units = Units {
    length: 1.0,
    mass: 1.0,
    time: 1.0,
};

impl Units {
    fn stress(self) -> f64 {
        self.mass / (self.length * self.time * self.time)
    }

    /// The soil's scene in these units, its corner at `corner` (m).
    fn soil(self, basis: &str, law: &Soil, corner: [f64; 2]) -> Particles<f64, 2> {
        let Self { length, mass, time } = self;
        let [left, bottom] = corner.map(|at| at / length);
        let at = |x: f64, y: f64| format!("[{:?}, {:?}]", left + x / length, bottom + y / length);
        let (metre, speed) = (1.0 / length, time / length);
        let set = [
            format!(
                "grid={{min={}, max={}, cells=[16, 16]}}",
                at(0.0, 0.0),
                at(1.0, 1.0)
            ),
            format!(
                "time={{step={:?}, end={:?}}}",
                1.0 / 2048.0 / time,
                100.0 / 2048.0 / time
            ),
            format!("method.basis={basis}"),
            format!("material.law={{{}}}", law(1.0 / self.stress())),
            format!("material.density={:?}", 1000.0 * length.powi(3) / mass),
            format!(
                "body=[{{min={}, max={}, particles_per_cell=[3, 3], \
                 velocity=['{:?}*((y-({bottom:?}))/{metre:?})', \
                 '{:?}*((x-({left:?}))/{metre:?})*((y-({bottom:?}))/{metre:?})']}}]",
                at(0.0, 0.0),
                at(0.5625, 0.4375),
                2.0 * speed,
                -3.0 * speed
            ),
            format!("load.body_force=['0', '{:?}']", -9.81 * time * time / length),
        ];
        solved(UNITS, &set.each_ref().map(String::as_str)).particles
    }
}

/// Text of a law whose stresses are in Pa times the argument.
type Soil = dyn Fn(f64) -> String;

fn yielding(pascal: f64) -> String {
    format!(
        "drucker-prager={{youngs_modulus={:?}, poissons_ratio=0.3, cohesion={:?}, friction_angle=25, \
         dilation_angle=5}}",
        1e5 * pascal,
        500.0 * pascal
    )
}

fn elastic(pascal: f64) -> String {
    format!(
        "neo-hookean={{youngs_modulus={:?}, poissons_ratio=0.3}}",
        1e5 * pascal
    )
}

/// Largest differences of displacements and stresses over the largest of each, `found` being in `units`.
fn differences(found: &Particles<f64, 2>, units: Units, expected: &Particles<f64, 2>) -> [f64; 2] {
    let way = largest(expected.displacement.iter().map(|u| u.norm()));
    let most = largest(expected.stress.iter().flat_map(|s| s.iter().copied()));
    assert_eq!(found.len(), expected.len());
    let ways = found.displacement.iter().zip(&expected.displacement);
    let stresses = found.stress.iter().zip(&expected.stress);
    [
        largest(ways.map(|(u, v)| (u * units.length - v).norm())) / way,
        largest(stresses.map(|(s, t)| (s * units.stress() - t).abs().max())) / most,
    ]
}

#[test]
fn units_do_not_matter() {
    let millimetre_tonne = Units {
        length: 1e-3,
        mass: 1e3,
        time: 1.0,
    };
    let kilometre_megatonne_hour = Units {
        length: 1e3,
        mass: 1e9,
        time: 3600.0,
    };
    let powers_of_two = Units {
        length: 2_f64.powi(-30),
        mass: 2_f64.powi(-90),
        time: 2_f64.powi(-10),
    };
    for basis in super::BASES {
        for law in [&yielding as &Soil, &elastic] {
            let expected = SI.soil(basis, law, [0.0; 2]);
            for (units, tolerance) in [
                (powers_of_two, 0.0),
                (millimetre_tonne, 1e-11),
                (kilometre_megatonne_hour, 1e-11),
            ] {
                let found = units.soil(basis, law, [0.0; 2]);
                let off = differences(&found, units, &expected);
                assert!(
                    off.iter().all(|&off| off <= tolerance),
                    "{basis} {}: {off:?} > {tolerance:e}",
                    law(1.0)
                );
            }
        }
    }
}

/// The scene as it is written, in millimetres, against one in metres.
#[test]
fn a_scene_in_millimetres_is_the_one_in_metres() {
    let written = solved::<2>(UNITS, &[]).particles;
    let units = Units {
        length: 1e-3,
        mass: 1e3,
        time: 1.0,
    };
    let expected = SI.soil("bspline", &yielding, [0.0; 2]);
    let off = differences(&written, units, &expected);
    assert!(off.iter().all(|&off| off < 1e-11), "{off:?}");
}

#[test]
fn the_place_of_the_origin_does_not_matter() {
    let expected = SI.soil("bspline", &yielding, [0.0; 2]);
    let found = SI.soil("bspline", &yielding, [-1024.0, 4096.0]);
    let off = differences(&found, SI, &expected);
    assert!(off.iter().all(|&off| off < 1e-10), "{off:?}");
}
