//! A scene is the stepper that one would set up by hand: the same bits, and the same errors.
//!
//! Scenes choose laws at run time; whatever a law says must pass through that choice unchanged. Relaxed
//! Taylor least squares ask a law for more than any other method does: strain for a stress, wave speed, start
//! under stress.

use materialpoint::basis::Linear;
use materialpoint::error::StepError;
use materialpoint::grid::{Face, Grid};
use materialpoint::law::{
    AnyLaw, ConeMatch, ConstitutiveLaw, DruckerPrager, Hencky, Hill, LinearElastic, Logarithmic, Moduli,
    NeoHookean, NewtonianFluid, StVenantKirchhoff, Strength, VonMises,
};
use materialpoint::mass::{MassModel, VelocityMass};
use materialpoint::method::{Basis, Method, ReconstructionKind};
use materialpoint::particles::{Particles, lattice};
use materialpoint::phase::OnePhase;
use materialpoint::reconstruction::{Reconstruction, RelaxedTaylor};
use materialpoint::record::Record;
use materialpoint::stepper::{FaceCondition, Forcing, Setup, Simulation, Stepper};
use materialpoint_command::run::{InSpace, RunError, run_in};
use materialpoint_command::scene::Scene;
use materialpoint_steppers::{Build, Parts};
use nalgebra::SVector;

/// Steps, and their size (s): a power of two, so that no sum of them is rounded.
const STEPS: u32 = 20;
const DT: f64 = 1.0 / 128.0;

/// A box full of material that moves within: no free surface, so that walls and law are all there is.
struct Case {
    /// The law's line. Linear elasticity is Hooke's law at small strain, Hill's rate at large.
    law: &'static str,
    large: bool,
    /// Velocity (m/s) along axis 0 is this times `x (1 - x)`.
    speed: f64,
    /// Initial stress (Pa), the same along every axis.
    stress: f64,
}

impl Case {
    fn scene<const D: usize>(&self, method: &str) -> Scene {
        let Self {
            law,
            large,
            speed,
            stress,
        } = self;
        let list = |entry: &str| vec![entry; D].join(", ");
        let velocity = format!("\"{speed:?}*x*(1 - x)\"{}", ", \"0\"".repeat(D - 1));
        let along = match D {
            1 => format!("stress = \"{stress:?}\""),
            _ => format!("stress = {{ xx = \"{stress:?}\", yy = \"{stress:?}\" }}"),
        };
        let stress = if *stress == 0.0 { String::new() } else { along };
        let walls: String = Face::all::<D>()
            .map(|face| {
                format!(
                    "\n[[boundary]]\nface = \"{face}\"\n{}\n",
                    if D == 1 { "fixed = true" } else { "roller = true" }
                )
            })
            .collect();
        let text = format!(
            "title = \"Box\"\n\n\
             [grid]\nmin = [{}]\nmax = [{}]\ncells = [{}]\n\n\
             [time]\nstep = {DT:?}\nend = {:?}\n\n\
             [method]\n{method}\n\n\
             [material]\nstrain = \"{}\"\nlaw.{law}\ndensity = 2.0\n\n\
             [[body]]\nmin = [{}]\nmax = [{}]\nparticles_per_cell = [{}]\n\
             velocity = [{velocity}]\n{stress}\ninitialise = \"exact\"\n{walls}",
            list("0.0"),
            list("1.0"),
            list("4"),
            f64::from(STEPS) * DT,
            if *large { "large" } else { "small" },
            list("0.0"),
            list("1.0"),
            list("3"),
        );
        Scene::from_toml(&text, &[]).unwrap_or_else(|error| panic!("{error}\n{text}"))
    }

    fn by_scene<const D: usize>(&self, method: &str) -> Result<Particles<f64, D>, StepError>
    where
        Scene: InSpace<D>,
    {
        match run_in::<D>(&self.scene::<D>(method), None, &mut |_| {}) {
            Ok(outcome) => Ok(outcome.particles),
            Err(RunError::Stopped { source, .. }) => Err(source),
            Err(other) => panic!("{other}"),
        }
    }

    fn by_api<const D: usize, L, R>(&self, law: L, reconstruction: R) -> Result<Particles<f64, D>, StepError>
    where
        L: ConstitutiveLaw<f64, D> + Clone + 'static,
        L::State: Record<f64>,
        R: Reconstruction<f64, D> + Clone + 'static,
    {
        let grid = Grid::new(SVector::zeros(), SVector::repeat(1.0), [4; D]).unwrap();
        let points = lattice(&grid, grid.min(), grid.max(), [3; D]);
        let mut particles = Particles::at_rest(&points, 2.0);
        for p in 0..points.len() {
            let x = points[p].0[0];
            particles.velocity[p][0] = self.speed * x * (1.0 - x);
            particles.stress[p].fill_diagonal(self.stress);
        }
        if self.stress != 0.0 {
            particles.start_under_stress(&law, |_, _| None).unwrap();
        }
        let mut simulation: Box<dyn Simulation<D>> = Box::new(
            Stepper::new(
                Setup::new(grid, Linear, reconstruction, law, OnePhase, particles)
                    .with_velocity_mass(MassModel::preferring(VelocityMass::Constrained)),
            )
            .unwrap(),
        );
        for _ in 0..STEPS {
            simulation.step(DT, &walls())?;
        }
        Ok(simulation.particles())
    }

    /// The stepper that has the method's types, by its name.
    fn by_name<const D: usize>(&self, method: Method, law: AnyLaw<f64, D>) -> Particles<f64, D>
    where
        Parts<f64, D>: Build<D>,
    {
        let grid = Grid::new(SVector::zeros(), SVector::repeat(1.0), [4; D]).unwrap();
        let points = lattice(&grid, grid.min(), grid.max(), [3; D]);
        let mut particles = Particles::at_rest(&points, 2.0);
        for (v, (x, _)) in particles.velocity.iter_mut().zip(&points) {
            v[0] = self.speed * x[0] * (1.0 - x[0]);
        }
        let parts = Parts {
            grid,
            law,
            liquid: None,
            velocity_mass: match method.reconstruction {
                ReconstructionKind::RelaxedTaylor => VelocityMass::Constrained,
                _ => VelocityMass::Lumped,
            },
            virtual_points: false,
            particles,
            pores: Vec::new(),
            surface: Vec::new(),
            under_stress: false,
        };
        let mut simulation = parts.stepper(method).unwrap();
        for _ in 0..STEPS {
            simulation.step(DT, &walls()).unwrap();
        }
        simulation.particles()
    }

    fn compare<const D: usize, L, R>(&self, law: L, reconstruction: R)
    where
        L: ConstitutiveLaw<f64, D> + Clone + 'static,
        L::State: Record<f64>,
        R: Reconstruction<f64, D> + Clone + 'static,
        Scene: InSpace<D>,
    {
        let (scene, api) = (
            self.by_scene::<D>(RELAXED).unwrap(),
            self.by_api(law, reconstruction).unwrap(),
        );
        assert_eq!(scene.position, api.position, "{}", self.law);
        assert_eq!(scene.velocity, api.velocity, "{}", self.law);
        assert_eq!(scene.stress, api.stress, "{}", self.law);
        assert_eq!(scene.volume, api.volume, "{}", self.law);
        let moved = api.displacement.iter().map(|u| u.norm()).fold(0.0, f64::max);
        assert!(moved > 1e-3, "nothing moves: {moved:e}");
    }
}

/// Every wall held, beyond one axis along its normal.
fn walls<const D: usize>() -> Forcing<f64, D> {
    Face::all::<D>().fold(Forcing::none(), |forcing, face| {
        let held = if D == 1 {
            FaceCondition::fixed()
        } else {
            FaceCondition::roller(face.axis)
        };
        forcing.with_face(face, held)
    })
}

/// Lines of a scene that choose a method.
const RELAXED: &str = "basis = \"linear\"\nreconstruction = \"relaxed-taylor\"";

fn on_one_axis() -> RelaxedTaylor<f64, 1, 3> {
    RelaxedTaylor::for_basis(&Linear)
}

fn in_the_plane() -> RelaxedTaylor<f64, 2, 6> {
    RelaxedTaylor::for_basis(&Linear)
}

#[test]
fn on_one_axis_the_bits_are_those_of_the_api() {
    let case = |law, stress| Case {
        law,
        large: true,
        speed: 0.25,
        stress,
    };
    let small = |law, stress| Case {
        large: false,
        ..case(law, stress)
    };
    let moduli = Moduli::uniaxial(8.0).unwrap();
    small("linear-elastic = { youngs_modulus = 8.0 }", 0.5).compare(LinearElastic { moduli }, on_one_axis());
    case("linear-elastic = { youngs_modulus = 8.0 }", 0.5).compare(Hill { moduli }, on_one_axis());
    case("logarithmic = { youngs_modulus = 8.0 }", 0.5).compare(Logarithmic { moduli }, on_one_axis());
    case("neo-hookean = { youngs_modulus = 8.0 }", 0.0).compare(NeoHookean { moduli }, on_one_axis());
}

#[test]
fn in_the_plane_the_bits_are_those_of_the_api() {
    let case = |law, stress| Case {
        law,
        large: true,
        speed: 0.25,
        stress,
    };
    let small = |law, stress| Case {
        large: false,
        ..case(law, stress)
    };
    let moduli = Moduli::from_young(8.0, 0.25).unwrap();
    let elastic = "youngs_modulus = 8.0, poissons_ratio = 0.25";
    let named = |law: &str, more: &str| -> &'static str { format!("{law} = {{ {elastic}{more} }}").leak() };
    small(named("linear-elastic", ""), 0.5).compare(LinearElastic { moduli }, in_the_plane());
    case(named("linear-elastic", ""), 0.5).compare(Hill { moduli }, in_the_plane());
    case(named("neo-hookean", ""), 0.0).compare(NeoHookean { moduli }, in_the_plane());
    case(named("st-venant-kirchhoff", ""), 0.0).compare(StVenantKirchhoff { moduli }, in_the_plane());
    case(named("logarithmic", ""), 0.5).compare(Hencky { moduli }, in_the_plane());
    let metal = VonMises::new(moduli, 0.3125, 1.0).unwrap();
    case(
        named("von-mises", ", yield_stress = 0.3125, hardening = 1.0"),
        -0.5,
    )
    .compare(metal, in_the_plane());
    let strength = Strength {
        cohesion: 0.25,
        friction_angle: 30.0_f64.to_radians(),
        dilation_angle: 0.0,
    };
    let soil = DruckerPrager::new(moduli, &strength, ConeMatch::PlaneStrain).unwrap();
    case(
        named("drucker-prager", ", cohesion = 0.25, friction_angle = 30.0"),
        -0.5,
    )
    .compare(soil, in_the_plane());
    let water = NewtonianFluid::new(8.0, 7.0, 0.125).unwrap();
    case(
        "newtonian-fluid = { bulk_modulus = 8.0, gamma = 7.0, viscosity = 0.125 }",
        0.0,
    )
    .compare(water, in_the_plane());
}

/// One step strains the first cells by three: Hill's stress has no meaning beyond the modulus.
#[test]
fn a_scene_beyond_hill_s_law_ends_in_the_error_of_the_api() {
    let case = Case {
        law: "linear-elastic = { youngs_modulus = 8.0 }",
        large: true,
        speed: 3.0 / DT,
        stress: 0.0,
    };
    let law = Hill {
        moduli: Moduli::uniaxial(8.0).unwrap(),
    };
    let (scene, api) = (
        case.by_scene::<1>(RELAXED).unwrap_err(),
        case.by_api(law, on_one_axis()).unwrap_err(),
    );
    assert_eq!(scene, api);
    assert!(
        matches!(scene, StepError::Stress { step: 1, particle: 0, value, .. } if value >= 8.0),
        "{scene}"
    );
}

/// The same of every method by name, with one law: a scene says nothing that the types' own steppers do not
/// do, whatever the basis and the reconstruction.
fn every_method<const D: usize>(law: &AnyLaw<f64, D>, methods: &[Method], elastic: &'static str)
where
    Parts<f64, D>: Build<D>,
    Scene: InSpace<D>,
{
    let case = Case {
        law: elastic,
        large: true,
        speed: 0.25,
        stress: 0.0,
    };
    for &method in methods {
        let (basis, degree) = (method.basis.name(), method.basis.degree());
        let mut lines = format!(
            "basis = \"{basis}\"\nreconstruction = \"{}\"",
            method.reconstruction.name()
        );
        if let Basis::BSpline { .. } = method.basis {
            lines += &format!("\ndegree = {degree}");
        }
        if method.subpoints > 1 {
            lines += &format!("\nsubpoints = {}", method.subpoints);
        }
        if let ReconstructionKind::Taylor | ReconstructionKind::Spline = method.reconstruction {
            lines += "\nvelocity_mass = \"lumped\"";
        }
        let (scene, api) = (
            case.by_scene::<D>(&lines).unwrap(),
            case.by_name(method, law.clone()),
        );
        assert_eq!(scene.position, api.position, "{method}");
        assert_eq!(scene.velocity, api.velocity, "{method}");
        assert_eq!(scene.stress, api.stress, "{method}");
        let moved = api.displacement.iter().map(|u| u.norm()).fold(0.0, f64::max);
        assert!(moved > 1e-3, "{method}: nothing moves: {moved:e}");
    }
}

#[test]
fn every_method_of_a_scene_is_the_stepper_of_its_name() {
    let line: Vec<Method> = Method::all_in(1, 1)
        .into_iter()
        .chain([1, 3].map(|degree| Method::new(Basis::BSpline { degree }, ReconstructionKind::Taylor)))
        .chain([Method::sub_points(3)])
        .collect();
    let moduli = Moduli::uniaxial(8.0).unwrap();
    every_method::<1>(
        &AnyLaw::new(NeoHookean { moduli }),
        &line,
        "neo-hookean = { youngs_modulus = 8.0 }",
    );
    let moduli = Moduli::from_young(8.0, 0.25).unwrap();
    every_method::<2>(
        &AnyLaw::new(NeoHookean { moduli }),
        &Method::all_in(2, 1),
        "neo-hookean = { youngs_modulus = 8.0, poissons_ratio = 0.25 }",
    );
}
