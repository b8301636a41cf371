//! A scene is the stepper that one would set up by hand: the same bits, and the same errors.
//!
//! Scenes choose laws at run time; whatever a law says must pass through that choice unchanged. Relaxed
//! Taylor least squares ask a law for more than any other method does: strain for a stress, wave speed, start
//! under stress.

use materialpoint::basis::Linear;
use materialpoint::error::StepError;
use materialpoint::grid::{Face, Grid};
use materialpoint::law::{
    AnyLaw, Bodies, ConeMatch, ConstitutiveLaw, DruckerPrager, Hencky, Hill, LawSweep, LinearElastic,
    Logarithmic, Moduli, NeoHookean, NewtonianFluid, StVenantKirchhoff, Strength, VonMises,
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
use nalgebra::{SMatrix, SVector};

use crate::compiled;

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
        for p in 0..points.len() {
            let x = points[p].0[0];
            particles.velocity[p][0] = self.speed * x * (1.0 - x);
            particles.stress[p].fill_diagonal(self.stress);
        }
        let parts = Parts {
            under_stress: self.stress != 0.0,
            ..compiled::behind(grid, law, particles)
        };
        let mut simulation = compiled::simulation(method, VelocityMass::Lumped, parts);
        for _ in 0..STEPS {
            simulation.step(DT, &walls()).unwrap();
        }
        simulation.particles()
    }

    /// With the law behind a pointer, as a scene has it, and whether that passes on what the law says.
    fn compare<const D: usize, L>(&self, law: L)
    where
        L: ConstitutiveLaw<f64, D, State: Record<f64>> + Clone + 'static,
        AnyLaw<f64, D>: LawSweep<f64, D, Number = f64>,
        Parts<f64, D>: Build<D>,
        Scene: InSpace<D>,
    {
        passes_on(&law);
        let method = Method::new(Basis::Linear, ReconstructionKind::RelaxedTaylor);
        let api = self.by_name(method, AnyLaw::new(law));
        self.is_scene(&api);
    }

    /// With a stepper that was compiled for the law.
    fn compare_with_type<const D: usize, L, R>(&self, law: L, reconstruction: R)
    where
        L: ConstitutiveLaw<f64, D, State: Record<f64>> + Clone + 'static,
        R: Reconstruction<f64, D> + Clone + 'static,
        Scene: InSpace<D>,
    {
        self.is_scene(&self.by_api(law, reconstruction).unwrap());
    }

    fn is_scene<const D: usize>(&self, api: &Particles<f64, D>)
    where
        Scene: InSpace<D>,
    {
        let scene = self.by_scene::<D>(RELAXED).unwrap();
        assert_eq!(scene.position, api.position, "{}", self.law);
        assert_eq!(scene.velocity, api.velocity, "{}", self.law);
        assert_eq!(scene.stress, api.stress, "{}", self.law);
        assert_eq!(scene.volume, api.volume, "{}", self.law);
        let moved = api.displacement.iter().map(|u| u.norm()).fold(0.0, f64::max);
        assert!(moved > 1e-3, "nothing moves: {moved:e}");
    }
}

/// Particles follow a path without order, by the law and by the law behind a pointer: each question has the
/// same answer, to the bit.
fn passes_on<const D: usize, L>(law: &L)
where
    L: ConstitutiveLaw<f64, D, State: Record<f64>> + Clone + 'static,
    AnyLaw<f64, D>: LawSweep<f64, D, Number = f64>,
{
    const COUNT: usize = 7;
    let any = AnyLaw::new(law.clone());
    assert_eq!(LawSweep::limits(law), any.limits());
    assert_eq!(LawSweep::large_strain(law), any.large_strain());
    let told = |states: &[L::State]| {
        let mut numbers = Vec::new();
        states
            .iter()
            .for_each(|state| state.put(&mut |x| numbers.push(x)));
        numbers
    };
    let (mut states, mut numbers) = (vec![L::State::default(); COUNT], any.at_rest(COUNT));
    assert_eq!(told(&states), numbers);
    let mut stress = vec![SMatrix::<f64, D, D>::zeros(); COUNT];
    let mut behind = stress.clone();
    let mut place = 0.0;
    let mut noise = || {
        place += 0.754_877_666;
        f64::fract(place) - 0.5
    };
    let which: Vec<u32> = (0..COUNT as u32).rev().collect();
    let (mass, volume) = ([3.0; COUNT], [1.5; COUNT]);
    for _ in 0..40 {
        let increments: Vec<_> = (0..COUNT)
            .map(|_| SMatrix::from_fn(|_, _| 0.04 * noise()))
            .collect();
        law.carry(DT, &increments, &mut stress, &mut states);
        any.carry(DT, &increments, &mut behind, &mut numbers);
        assert_eq!(stress, behind);
        assert_eq!(told(&states), numbers);
        assert_eq!(law.are_known(&stress, &states), any.are_known(&stress, &numbers));
        let mut found = [[0.0; COUNT]; 4];
        law.energy_densities(&stress, &states, &mut found[0]);
        any.energy_densities(&stress, &numbers, &mut found[1]);
        let bodies = |state| Bodies {
            mass: &mass,
            volume: &volume,
            stress: &stress,
            state,
        };
        law.wave_speeds(&which, &bodies(&states[..]), &mut found[2]);
        let bodies = Bodies {
            mass: &mass,
            volume: &volume,
            stress: &stress,
            state: &numbers[..],
        };
        any.wave_speeds(&which, &bodies, &mut found[3]);
        assert_eq!((found[0], found[2]), (found[1], found[3]));
        for p in 0..COUNT {
            let (own, other) = (LawSweep::of(law, &states, p), any.of(&numbers, p));
            let (at, change) = (&stress[p], &increments[p]);
            assert_eq!(
                LawSweep::wave_speed(law, 2.0, at, own),
                any.wave_speed(2.0, at, other)
            );
            assert_eq!(
                LawSweep::strain_for(law, change, 2.0, at, own),
                any.strain_for(change, 2.0, at, other)
            );
            assert_eq!(
                LawSweep::off_plane_stress(law, at, own),
                any.off_plane_stress(at, other)
            );
            assert_eq!(LawSweep::plastic_strain(law, own), any.plastic_strain(other));
            assert_eq!(LawSweep::knows(law, at, own), any.knows(at, other));
        }
    }
    assert!(stress.iter().any(|stress| stress.norm() > 1e-3));
    for (size, off_plane) in [(-0.5, None), (-0.5, Some(-0.25)), (0.0, None), (0.5, Some(0.25))] {
        let at = SMatrix::from_diagonal_element(size);
        let starts = LawSweep::start(law, &at, off_plane, &mut states[..1]);
        let each = any.numbers();
        assert_eq!(starts, any.start(&at, off_plane, &mut numbers[..each]));
        assert_eq!(told(&states[..1]), numbers[..each]);
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
    small("linear-elastic = { youngs_modulus = 8.0 }", 0.5).compare::<1, _>(LinearElastic { moduli });
    let rate = case("linear-elastic = { youngs_modulus = 8.0 }", 0.5);
    rate.compare::<1, _>(Hill { moduli });
    rate.compare_with_type(Hill { moduli }, on_one_axis());
    case("logarithmic = { youngs_modulus = 8.0 }", 0.5).compare::<1, _>(Logarithmic { moduli });
    let remembers = case("neo-hookean = { youngs_modulus = 8.0 }", 0.0);
    remembers.compare::<1, _>(NeoHookean { moduli });
    remembers.compare_with_type(NeoHookean { moduli }, on_one_axis());
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
    small(named("linear-elastic", ""), 0.5).compare::<2, _>(LinearElastic { moduli });
    let rate = case(named("linear-elastic", ""), 0.5);
    rate.compare::<2, _>(Hill { moduli });
    rate.compare_with_type(Hill { moduli }, in_the_plane());
    case(named("neo-hookean", ""), 0.0).compare::<2, _>(NeoHookean { moduli });
    case(named("st-venant-kirchhoff", ""), 0.0).compare::<2, _>(StVenantKirchhoff { moduli });
    case(named("logarithmic", ""), 0.5).compare::<2, _>(Hencky { moduli });
    let metal = VonMises::new(moduli, 0.3125, 1.0).unwrap();
    let flows = case(
        named("von-mises", ", yield_stress = 0.3125, hardening = 1.0"),
        -0.5,
    );
    flows.compare::<2, _>(metal);
    flows.compare_with_type(metal, in_the_plane());
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
    .compare::<2, _>(soil);
    let water = NewtonianFluid::new(8.0, 7.0, 0.125).unwrap();
    case(
        "newtonian-fluid = { bulk_modulus = 8.0, gamma = 7.0, viscosity = 0.125 }",
        0.0,
    )
    .compare::<2, _>(water);
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
