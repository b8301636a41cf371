//! What files tell of the particles: all of the stress, when velocities live, and under which names.
//!
//! Expected: columns that cannot widen, which the elastic stress `nu / (1 - nu)` of the vertical one presses
//! from the side; free fall.

use std::path::{Path, PathBuf};

use materialpoint::method::Method;
use materialpoint_command::output::Folder;
use materialpoint_command::run::run_in;
use nalgebra::SVector;
use vtkio::Vtk;
use vtkio::model::{Attribute, DataSet, Piece};

use super::scene;

/// A block without a floor or a wall, one cell beside.
const BLOCK: &str = r#"
title = "Block"
[grid]
min = [-1.0, -2.0]
max = [1.0, 1.0]
cells = [10, 15]
[time]
step = 5e-3
end = 0.5
[method]
basis = "linear"
reconstruction = "shepard"
[material]
strain = "large"
law.neo-hookean = { youngs_modulus = 1e5, poissons_ratio = 0.3 }
density = 1000.0
[[body]]
min = [-0.33, 0.11]
max = [0.37, 0.83]
particles_per_cell = [2, 2]
velocity = ["0.3", "0"]
[load]
body_force = ["0", "-9.81"]
"#;

/// A column between smooth walls, under its weight for a while.
const COLUMN: &[&str] = &[
    "grid={min=[0,0], max=[1,2], cells=[4,8]}",
    "body=[{min=[0,0], max=[0.5,1], particles_per_cell=[2,2]}, {min=[0.5,0], max=[1,1], particles_per_cell=[2,2]}]",
    "boundary=[{face='x-min', roller=true}, {face='x-max', roller=true}, {face='y-min', roller=true}]",
    "time={step=1e-3, end=0.05}",
];

struct Place(PathBuf);

impl Place {
    fn new(name: &str) -> Self {
        Self(std::env::temp_dir().join(format!("materialpoint-{name}-{}", std::process::id())))
    }

    fn folder(&self) -> Folder {
        Folder::create(&self.0).unwrap()
    }

    fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(&self.0).unwrap();
        let mut names: Vec<_> = entries
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// A column of a table.
fn column(path: &Path, name: &str) -> Vec<f64> {
    let text = std::fs::read_to_string(path).unwrap();
    let mut lines = text.lines();
    let header: Vec<_> = lines.next().unwrap().split(',').collect();
    let at = header.iter().position(|column| *column == name);
    let at = at.unwrap_or_else(|| panic!("no {name} in {header:?}"));
    lines
        .map(|line| line.split(',').nth(at).unwrap().parse().unwrap())
        .collect()
}

fn header(path: &Path) -> String {
    let text = std::fs::read_to_string(path).unwrap();
    text.lines().next().unwrap().to_owned()
}

/// The arrays of a VTU file by name, and its first number of each field datum.
fn arrays(path: &Path) -> Vec<(String, Vec<f64>)> {
    let DataSet::UnstructuredGrid { pieces, .. } = Vtk::import(path).unwrap().data else {
        panic!("no unstructured grid");
    };
    let Some(Piece::Inline(piece)) = pieces.into_iter().next() else {
        panic!("no piece");
    };
    let arrays = piece.data.point.into_iter();
    arrays
        .map(|attribute| match attribute {
            Attribute::DataArray(array) => (array.name, array.data.cast_into::<f64>().unwrap()),
            other => panic!("{other:?}"),
        })
        .collect()
}

/// Depth of a free fall of `time` (s) in steps of `dt` (s): exact with half a kick first, and as if it had
/// begun half a step before without.
fn depth(half_kick: bool, time: f64, dt: f64) -> f64 {
    9.81 * time * if half_kick { time } else { time + dt } / 2.0
}

#[test]
fn free_fall_is_exact_with_half_a_kick_and_early_by_half_a_step_without() {
    let (time, dt) = (0.5, 5e-3);
    for method in Method::all_in(2, 1) {
        for half_kick in [true, false] {
            let set = format!("time.half_kick={half_kick}");
            let scene = scene(BLOCK, &[&set]).with_method(method);
            let outcome = run_in::<2>(&scene, None, &mut |_| {}).unwrap();
            for u in &outcome.particles.displacement {
                let error = (u[1] + depth(half_kick, time, dt)).abs().max((u[0] - 0.15).abs());
                assert!(error < 1e-9, "{method}, {set}: {u}");
            }
            // The velocity is that of the middle of the last step, and the summary says so.
            let lives = outcome.summary.velocity_time;
            assert!((lives - (time - 0.5 * dt)).abs() < 1e-15);
            let v = outcome.particles.velocity[0][1] + 9.81 * if half_kick { lives } else { time };
            assert!(v.abs() < 1e-9, "{method}, {set}: {v}");
        }
    }
}

/// The last step is shorter, and its kick the mean of both.
#[test]
fn half_a_kick_is_exact_with_a_shorter_last_step_too() {
    let set = ["time.half_kick=true", "time.step=7e-3"];
    let outcome = run_in::<2>(&scene(BLOCK, &set), None, &mut |_| {}).unwrap();
    let error = |u: &SVector<f64, 2>| (u[1] + depth(true, 0.5, 0.0)).abs();
    assert!(
        outcome
            .particles
            .displacement
            .iter()
            .map(error)
            .fold(0.0, f64::max)
            < 1e-12
    );
}

/// Solid and liquid fall as one, whatever the drag and the method.
#[test]
fn so_do_two_phases() {
    let soil = "material={phases=2, strain='small', law={linear-elastic={youngs_modulus=1e5, poissons_ratio=0.3}}, \
                porosity=0.4, solid_density=2.6e3, liquid_density=1e3, liquid_bulk_modulus=1e6, permeability=1e-2}";
    for method in Method::all_in(2, 2) {
        for (drag, half_kick) in ["implicit", "explicit"]
            .into_iter()
            .flat_map(|d| [(d, true), (d, false)])
        {
            let (drag, half) = (
                format!("material.drag={drag}"),
                format!("time.half_kick={half_kick}"),
            );
            let set = [soil, &drag, &half, "time.step=1e-3", "time.end=0.1"];
            let scene = scene(BLOCK, &set).with_method(method);
            let outcome = run_in::<2>(&scene, None, &mut |_| {}).unwrap();
            for (u, liquid) in outcome.particles.displacement.iter().zip(&outcome.liquid) {
                let error = (u[1] + depth(half_kick, 0.1, 1e-3)).abs();
                let v = liquid.velocity[1] + 9.81 * if half_kick { 0.0995 } else { 0.1 };
                assert!(error < 1e-9 && v.abs() < 1e-7, "{method}, {set:?}: {u} {v}");
            }
        }
    }
}

/// A pendulum of one dimension: the bar's error falls by four with half the step, and by two without half a
/// kick.
#[test]
fn half_a_kick_makes_the_run_of_second_order_in_time() {
    const SPRING: &str = r#"
title = "Block that is pulled"
[grid]
min = [0.0]
max = [2.0]
cells = [2]
[time]
step = 0.01
end = 1.0
[method]
basis = "linear"
reconstruction = "shepard"
[material]
strain = "small"
law.linear-elastic = { youngs_modulus = 1.0 }
density = 1.0
[[body]]
min = [0.5]
max = [1.5]
particles_per_cell = [1]
[load]
body_force = ["cos(3*t)"]
"#;
    let error = |half: bool, step: f64| {
        let set = [format!("time.half_kick={half}"), format!("time.step={step:?}")];
        let set = set.each_ref().map(String::as_str);
        let outcome = materialpoint_command::run::run(&scene(SPRING, &set), None, &mut |_| {}).unwrap();
        // Rigid: u = (1 - cos(3 t)) / 9.
        (outcome.particles.displacement[0][0] - (1.0 - 3_f64.cos()) / 9.0).abs()
    };
    let ratio = |half| error(half, 0.02) / error(half, 0.01);
    assert!((ratio(true) - 4.0).abs() < 0.1, "{}", ratio(true));
    assert!((ratio(false) - 2.0).abs() < 0.1, "{}", ratio(false));
}

#[test]
fn the_stress_off_the_plane_is_in_every_file() {
    let laws = [
        (
            "small",
            "linear-elastic={youngs_modulus=1e6, poissons_ratio=0.3}",
            0.3,
        ),
        (
            "large",
            "linear-elastic={youngs_modulus=1e6, poissons_ratio=0.3}",
            0.3,
        ),
        (
            "large",
            "neo-hookean={youngs_modulus=1e6, poissons_ratio=0.3}",
            0.3,
        ),
        (
            "large",
            "von-mises={youngs_modulus=1e6, poissons_ratio=0.3, yield_stress=1e6}",
            0.3,
        ),
        // A fluid has one pressure.
        ("large", "newtonian-fluid={bulk_modulus=1e6, viscosity=0}", 0.5),
    ];
    for (strain, law, nu) in laws {
        let material = format!("material={{strain='{strain}', density=1000, law={{{law}}}}}");
        let mut set = COLUMN.to_vec();
        let (csv, vtu) = (Place::new("zz-csv"), Place::new("zz-vtu"));
        set.push(&material);
        set.push("body.0.velocity=['0','0']");
        run_in::<2>(&scene(BLOCK, &set), Some(&csv.folder()), &mut |_| {}).unwrap();
        set.push("output.particles=vtu");
        run_in::<2>(&scene(BLOCK, &set), Some(&vtu.folder()), &mut |_| {}).unwrap();
        let table = csv.0.join("particles.csv");
        let [xx, yy, xy, zz, mean, mises] = [
            "stress_xx",
            "stress_yy",
            "stress_xy",
            "stress_zz",
            "mean_stress",
            "von_mises",
        ]
        .map(|name| column(&table, &format!("{name}[Pa]")));
        let arrays = arrays(&vtu.0.join("particles-000001.vtu"));
        let array = |name: &str| &arrays.iter().find(|(found, _)| found == name).unwrap().1;
        let tensors = array("stress[Pa]").chunks(6);
        let mut pressed = 0;
        for (p, tensor) in tensors.enumerate() {
            assert_eq!(tensor, [xx[p], yy[p], zz[p], xy[p], 0.0, 0.0], "{law}");
            // Nothing widens: of every column the sides are pressed alike.
            let right = nu / (1.0 - nu) * yy[p];
            assert!((zz[p] - xx[p]).abs() < 1e-9 * 1e4, "{law}: {} {}", zz[p], xx[p]);
            // Large strain differs by the strain, under 2 %.
            assert!(
                (zz[p] - right).abs() <= 0.02 * right.abs() + 1e-9,
                "{law}: {} for {right}",
                zz[p]
            );
            assert!((mean[p] - (yy[p] + 2.0 * xx[p]) / 3.0).abs() < 1e-6, "{law}");
            assert!(
                (mises[p] - (yy[p] - xx[p]).abs()).abs() < 1e-6,
                "{law}: {}",
                mises[p]
            );
            pressed += usize::from(yy[p] < -1e3);
        }
        assert!(pressed > 10, "{law}: {pressed}");
        assert_eq!(
            (array("mean_stress[Pa]"), array("von_mises[Pa]")),
            (&mean, &mises)
        );
    }
}

/// The contract's columns stand first and as they were; one naming for tables and ParaView.
#[test]
fn tables_and_points_have_one_naming() {
    let (csv, vtu) = (Place::new("names-csv"), Place::new("names-vtu"));
    let material = "material={strain='large', density=1000, \
                    law={von-mises={youngs_modulus=1e6, poissons_ratio=0.3, yield_stress=1e2}}}";
    let mut set = COLUMN.to_vec();
    set.push(material);
    run_in::<2>(&scene(BLOCK, &set), Some(&csv.folder()), &mut |_| {}).unwrap();
    set.push("output.particles=vtu");
    run_in::<2>(&scene(BLOCK, &set), Some(&vtu.folder()), &mut |_| {}).unwrap();
    let table = csv.0.join("particles.csv");
    assert_eq!(
        header(&table),
        "x0[m],y0[m],x[m],y[m],u_x[m],u_y[m],v_x[m/s],v_y[m/s],stress_xx[Pa],stress_yy[Pa],stress_xy[Pa],density[kg/m3],volume[m2],\
         stress_zz[Pa],mass[kg/m],mean_stress[Pa],von_mises[Pa],plastic_strain[-],body[-],particle[-]"
    );
    let path = vtu.0.join("particles-000001.vtu");
    let arrays = arrays(&path);
    let names: Vec<_> = arrays.iter().map(|(name, _)| name.as_str()).collect();
    let right = [
        "x0[m]",
        "u[m]",
        "v[m/s]",
        "stress[Pa]",
        "density[kg/m3]",
        "volume[m2]",
        "mass[kg/m]",
        "mean_stress[Pa]",
        "von_mises[Pa]",
        "plastic_strain[-]",
        "body[-]",
        "particle[-]",
    ];
    assert_eq!(names, right);
    for (name, values) in &arrays {
        let scalar = !["x0", "u", "v", "stress"]
            .iter()
            .any(|vector| name.starts_with(&format!("{vector}[")));
        if scalar {
            assert_eq!(*values, column(&table, name), "{name}");
        }
    }
    // 64 particles in each of two bodies, that of the lower numbers to the left.
    let (body, x0) = (column(&table, "body[-]"), column(&table, "x0[m]"));
    assert_eq!(
        column(&table, "particle[-]"),
        (0..64).map(f64::from).collect::<Vec<_>>()
    );
    assert!(
        body.iter()
            .zip(&x0)
            .all(|(body, x)| *body == f64::from(u8::from(*x > 0.5)))
    );
    assert_eq!(column(&table, "mass[kg/m]"), vec![1000.0 / 64.0; 64]);
    assert!(
        column(&table, "plastic_strain[-]")
            .iter()
            .any(|strain| *strain > 0.0)
    );
    let text = std::fs::read_to_string(path).unwrap();
    assert!(text.contains("Name=\"TimeValue\"") && text.contains("Name=\"velocity_time[s]\""));
}

#[test]
fn a_run_removes_the_frames_of_the_one_before_and_nothing_else() {
    let place = Place::new("frames-left");
    let folder = place.folder();
    std::fs::write(place.0.join("notes-000001.vtu"), "mine").unwrap();
    std::fs::write(place.0.join(".particles.csv.4294967295-0.tmp"), "half").unwrap();
    let mut set = COLUMN.to_vec();
    set.extend(["output={particles='vtu', every=10}"]);
    let first = run_in::<2>(&scene(BLOCK, &set), Some(&folder), &mut |_| {}).unwrap();
    assert_eq!(first.summary.removed, [".particles.csv.4294967295-0.tmp"]);
    assert!(place.names().contains(&"particles-000005.vtu".to_owned()));
    set.extend(["output={particles='csv', every=25}"]);
    let second = run_in::<2>(&scene(BLOCK, &set), Some(&folder), &mut |_| {}).unwrap();
    assert_eq!(second.summary.removed.len(), 7, "{:?}", second.summary.removed);
    assert_eq!(
        place.names(),
        ["notes-000001.vtu", "particles-00000025.csv", "particles.csv"]
    );
}
