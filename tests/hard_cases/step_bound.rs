//! The bound of the critical step (`docs/verification/stability.md`) against the eigenvalue that it bounds.
//!
//! Bars, squares and cubes with free ends at offsets against the grid, on cells of 1 : 1 and 1 : 4, in
//! regular and in random layouts, with one to four particles per cell and axis. Expected: the power
//! iteration's eigenvalue never exceeds the bound, whatever the layout and the basis, for plain MPM, of which
//! alone it is proved; in full cells along one axis the bound of linear functions is the classical `4 / h^2`.
//! A sample of many particles is as stiff as the whole where the whole is alike.

use materialpoint::method::{Method, ReconstructionKind};
use materialpoint::stepper::Forcing;
use materialpoint_command::run::{InSpace, simulation_in};
use materialpoint_command::scene::Scene;

/// Of a body with so many axes: the particles per cell, the offset in cells, the jitter and the length of
/// cells along all but the first axis.
struct Layout {
    axes: usize,
    per_cell: usize,
    offset: f64,
    jitter: f64,
    aspect: f64,
}

impl Layout {
    fn scene(&self, method: Method) -> Scene {
        let cells = [11, 7, 5][self.axes - 1];
        let size = |axis: usize| if axis == 0 { 1.0 } else { self.aspect };
        let list = |value: &dyn Fn(usize) -> f64| {
            let values: Vec<_> = (0..self.axes).map(|axis| format!("{:?}", value(axis))).collect();
            format!("[{}]", values.join(","))
        };
        let offset = |axis: usize| (self.offset * (1.0 + 0.37 * axis as f64)) % 1.0;
        let ratio = if self.axes > 1 {
            ", poissons_ratio = 0.3"
        } else {
            ""
        };
        let text = format!(
            "title = \"Layout\"\n[grid]\nmin = {}\nmax = {}\ncells = {:?}\n[time]\nstep = 1e-9\nend = 1e-8\n\
             [method]\nbasis = \"linear\"\nreconstruction = \"shepard\"\n[material]\nstrain = \"large\"\n\
             law.neo-hookean = {{ youngs_modulus = 1{ratio} }}\ndensity = 1\n\
             [[body]]\nmin = {}\nmax = {}\nparticles_per_cell = {:?}\njitter = {:?}\nseed = 3\n",
            list(&|_| 0.0),
            list(&|axis| cells as f64 * size(axis)),
            vec![cells; self.axes],
            list(&|axis| (1.0 + offset(axis)) * size(axis)),
            list(&|axis| (cells as f64 - 2.0 + offset(axis)) * size(axis)),
            vec![self.per_cell; self.axes],
            self.jitter,
        );
        Scene::from_toml(&text, &[]).unwrap().with_method(method)
    }
}

/// Eigenvalue over bound.
fn share<const D: usize>(scene: &Scene) -> f64
where
    Scene: InSpace<D>,
{
    let free = Forcing::none();
    let mut simulation = simulation_in::<D>(scene).unwrap();
    assert!(simulation.stiffness_is_bound());
    let bound = simulation.stiffness(&free).unwrap();
    // Two particles of which none strains the other are as good as free.
    let Some(critical) = simulation.critical_step(&free) else {
        return 0.0;
    };
    // The square of the speed of compression waves.
    let squared = if D == 1 { 1.0 } else { 0.7 / (1.3 * 0.4) };
    (2.0 / critical.step).powi(2) / (squared * bound)
}

fn plain(axes: usize) -> impl Iterator<Item = Method> {
    let is_plain =
        |method: &Method| method.reconstruction == ReconstructionKind::Shepard && method.subpoints == 1;
    Method::all_in(axes, 1).into_iter().filter(is_plain)
}

#[test]
fn no_layout_is_stiffer_than_the_bound() {
    for axes in 1..=3 {
        let (offsets, most) = [(12, 4), (3, 3), (2, 2)][axes - 1];
        for method in plain(axes) {
            for (jitter, aspect) in [(0.0, 1.0), (0.8, 1.0), (0.0, 4.0)] {
                for (per_cell, k) in (1..=most).flat_map(|n| (0..offsets).map(move |k| (n, k))) {
                    let offset = (k as f64 + 0.31) / offsets as f64;
                    let layout = Layout {
                        axes,
                        per_cell,
                        offset,
                        jitter,
                        aspect,
                    };
                    let scene = layout.scene(method);
                    let share = match axes {
                        1 => share::<1>(&scene),
                        2 => share::<2>(&scene),
                        _ => share::<3>(&scene),
                    };
                    let place = format!(
                        "{method}, {axes} axes, {per_cell} per cell, offset {offset}, {jitter}, {aspect}"
                    );
                    assert!(share <= 1.0 + 1e-9, "{place}: {share}");
                    // A bound that is far off would be of no use.
                    assert!(share == 0.0 || share > 0.09, "{place}: {share}");
                }
            }
        }
    }
}

#[test]
fn in_full_cells_it_is_the_classical_one() {
    for per_cell in [1, 2, 4] {
        let layout = Layout {
            axes: 1,
            per_cell,
            offset: 0.0,
            jitter: 0.0,
            aspect: 1.0,
        };
        let linear = plain(1).next().unwrap();
        let mut scene = layout.scene(linear);
        (scene.bodies[0].min[0], scene.bodies[0].max[0]) = (0.0, 11.0);
        let bound = simulation_in::<1>(&scene)
            .unwrap()
            .stiffness(&Forcing::none())
            .unwrap();
        // The free ends have half the mass and half the stiffness.
        assert!((bound - 4.0).abs() < 1e-12, "{per_cell}: {bound}");
    }
}

/// A bar of 8000 particles, alike all along: what is found on the 4096 at its left end holds for all of it.
/// (Of relaxed TLS, whose eigenvalues are real.) Within 2 %: 0.8 % was measured with dual domain, and where
/// it comes from was not looked into.
#[test]
fn a_sample_is_as_stiff_as_the_whole() {
    let has_real_ones = |method: &Method| method.reconstruction == ReconstructionKind::RelaxedTaylor;
    for method in Method::all_in(1, 1).into_iter().filter(has_real_ones) {
        let layout = Layout {
            axes: 1,
            per_cell: 8,
            offset: 0.0,
            jitter: 0.0,
            aspect: 1.0,
        };
        let mut scene = layout.scene(method);
        (scene.grid.max[0], scene.grid.cells[0]) = (1002.0, 1002);
        (scene.bodies[0].min[0], scene.bodies[0].max[0]) = (1.0, 1001.0);
        let free = Forcing::none();
        let mut simulation = simulation_in::<1>(&scene).unwrap();
        assert!(!simulation.stiffness_is_bound());
        let sample = simulation.stiffness(&free).unwrap();
        let whole = (2.0 / simulation.critical_step(&free).unwrap().step).powi(2);
        assert!((sample / whole - 1.0).abs() < 0.02, "{method}: {sample} {whole}");
    }
}
