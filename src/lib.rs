//! A trait-generic framework for the material point method (MPM).
//!
#![doc = include_str!("../docs/formulas.html")]
//!
//! MPM moves material as particles through a fixed grid. A step maps particle data to the grid's degrees of
//! freedom (DOFs), solves the balance of momentum there, and carries the particles along. Four things can be
//! chosen, each as a type:
//!
//! | trait | says | comes as |
//! |---|---|---|
//! | [`BasisFamily`](basis::BasisFamily) | which DOFs a point sees | [`Linear`](basis::Linear), [`DualDomain`](basis::DualDomain), [`BSpline`](basis::BSpline) |
//! | [`Reconstruction`](reconstruction::Reconstruction) | how particle data become integrals | [`Shepard`](reconstruction::Shepard), [`SubPoints`](reconstruction::SubPoints), [`Taylor`](reconstruction::Taylor), [`RelaxedTaylor`](reconstruction::RelaxedTaylor), [`CubicSpline`](reconstruction::CubicSpline) |
//! | [`ConstitutiveLaw`](law::ConstitutiveLaw) | how stress follows strain | [`LinearElastic`](law::LinearElastic), [`Hill`](law::Hill), [`NeoHookean`](law::NeoHookean), [`StVenantKirchhoff`](law::StVenantKirchhoff), [`Hencky`](law::Hencky), [`Logarithmic`](law::Logarithmic), [`VonMises`](law::VonMises), [`DruckerPrager`](law::DruckerPrager), [`NewtonianFluid`](law::NewtonianFluid) |
//! | [`Phase`](phase::Phase) | what shares the pores with the solid | [`OnePhase`](phase::OnePhase), [`TwoPhase`](phase::TwoPhase) |
//!
//! One [`Stepper`](stepper::Stepper) is generic over all four, over the [`Scalar`](scalar::Scalar) and over
//! the dimension. The weak form needs integrals such as $\int\sigma\nabla\phi_i$; a reconstruction streams
//! points with weighted values, and one assembly serves all:
//!
//! $$\int\sigma\nabla\phi_i \approx \sum_q w_q \sigma_q \nabla\phi_i(x_q).$$
//!
//! # A block in free fall
//! ```
//! use materialpoint::basis::BSpline;
//! use materialpoint::grid::Grid;
//! use materialpoint::law::{Moduli, NeoHookean};
//! use materialpoint::particles::{Particles, lattice};
//! use materialpoint::phase::OnePhase;
//! use materialpoint::reconstruction::Taylor;
//! use materialpoint::stepper::{Forcing, Setup, Stepper};
//! use nalgebra::vector;
//!
//! let grid = Grid::new(vector![0.0, 0.0], vector![1.0, 2.0], [10, 20])?;
//! let points = lattice(&grid, &vector![0.2, 1.0], &vector![0.6, 1.4], [3, 3]);
//! let particles = Particles::at_rest(&points, 1e3);
//! let law = NeoHookean { moduli: Moduli::from_young(1e5, 0.3)? };
//! let fits = Taylor::<f64, 2, 6>::new();
//! let mut stepper = Stepper::new(Setup::new(grid, BSpline::<2>, fits, law, OnePhase, particles))?;
//! let gravity = Forcing::none().with_body_force(vector![0.0, -9.81]);
//! for _ in 0..100 {
//!     stepper.step(1e-4, &gravity)?;
//! }
//! let fallen = stepper.particles().velocity[0][1];
//! assert!((fallen + 0.0981_f64).abs() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Where to go
//! * a law of your own: [`law`]; a basis: [`basis`]; check them with [`testing`];
//! * the algorithm: [`stepper`]; the fit: [`taylor`];
//! * exact and converged solutions: [`mod@reference`];
//! * scenes in TOML, runs and studies of them, files: the crate `materialpoint-command`, which is the command
//!   too.
//!
//! Feature `rayon` (default): threads, any number of which gives the bits of one.

#![forbid(unsafe_code)]

/// The crate of vectors and matrices that appear in this one's types.
pub use nalgebra;

pub mod basis;
pub mod error;
mod face;
pub mod field;
pub mod grid;
pub mod law;
pub mod mass;
pub mod method;
mod parallel;
pub mod particles;
pub mod phase;
pub mod quadrature;
pub mod reconstruction;
pub mod record;
pub mod reference;
pub mod scalar;
pub mod simd;
pub mod stepper;
pub mod taylor;
pub mod tensor;
pub mod testing;
pub mod transfer;
