//! Scenes: a run described in TOML, read and checked as a whole before anything is computed.
//!
//! ```
//! use materialpoint_command::scene::Scene;
//!
//! let text = Scene::builtin("vibrating-bar-large").unwrap_or_default();
//! let scene = Scene::from_toml(text, &["grid.cells=[40]".into()])?;
//! assert_eq!(scene.grid.cells, [40]);
//!
//! let error = Scene::from_toml(text, &["grid.cells=[0]".into()]).unwrap_err();
//! assert!(error.to_string().starts_with("grid.cells.0 = 0 is not allowed"));
//! # Ok::<(), materialpoint_command::scene::SceneError>(())
//! ```

mod builtin;
mod error;
mod expression;
mod overrides;
mod read;
mod spec;
mod syntax;
mod text;

pub use error::SceneError;
pub use expression::{Expression, ExpressionError, ExpressionProblem};
pub use materialpoint::method::{Basis, ReconstructionKind};
pub(crate) use spec::FORGIVEN;
pub use spec::{
    Against, Body, Boundary, BoundaryKind, GridSpec, Initialise, Law, Material, Method, OutputSpec,
    ParticleOutput, Phases, PoreBoundary, ReferenceSpec, ScalarKind, SpaceLaw, StepSize, StressSpec,
    TimeSpec,
};

use std::path::Path;

use materialpoint::method;

/// A whole scene, checked.
#[derive(Clone, Debug)]
pub struct Scene {
    /// What the scene is, in words.
    pub title: String,
    /// Background grid.
    pub grid: GridSpec,
    /// Time steps.
    pub time: TimeSpec,
    /// Basis, reconstruction, velocity mass and floating-point type.
    pub method: Method,
    /// Material of every body.
    pub material: Material,
    /// Bodies, at least one; they do not overlap and lie within the grid.
    pub bodies: Vec<Body>,
    /// Boundaries, at most one a face.
    pub boundaries: Vec<Boundary>,
    /// Body force (N/kg), in `t`; one expression per axis.
    pub body_force: Option<Vec<Expression>>,
    /// Solution that errors are reported against.
    pub reference: Option<ReferenceSpec>,
    /// Files to write.
    pub output: OutputSpec,
}

impl Scene {
    /// Reads a scene from TOML text.
    ///
    /// Each override is `KEY=VALUE`: a dotted key (`time.end`, `body.0.jitter`) and a TOML value. A plain
    /// word need not be quoted (`method.basis=linear`).
    ///
    /// # Errors
    /// If the text is not TOML or the scene is not one that can be run; the message names the key, its value
    /// and what is allowed.
    pub fn from_toml(text: &str, overrides: &[String]) -> Result<Self, SceneError> {
        let table = overrides::apply(syntax::parse(text)?, overrides)?;
        read::scene(&table)
    }

    /// Reads a scene from a file, as [`Scene::from_toml`].
    ///
    /// # Errors
    /// As [`Scene::from_toml`], or if the file cannot be read.
    pub fn from_file(path: &Path, overrides: &[String]) -> Result<Self, SceneError> {
        let text = std::fs::read_to_string(path).map_err(|error| SceneError::File {
            path: path.display().to_string(),
            reason: error.to_string(),
        })?;
        Self::from_toml(&text, overrides)
    }

    /// Text of a scene that is compiled in.
    pub fn builtin(name: &str) -> Option<&'static str> {
        builtin::text(name)
    }

    /// Names of the scenes that are compiled in.
    pub fn builtin_names() -> impl Iterator<Item = &'static str> {
        builtin::names()
    }

    /// The same scene with another method. A velocity mass that was not the default of the old reconstruction
    /// stays where the new one has it.
    #[must_use]
    pub fn with_method(&self, method: method::Method) -> Self {
        let mut scene = self.clone();
        let told = self.method.velocity_mass != Method::default_velocity_mass(self.method.reconstruction);
        let default = Method::default_velocity_mass(method.reconstruction);
        scene.method.basis = method.basis;
        scene.method.reconstruction = method.reconstruction;
        scene.method.subpoints = method.subpoints;
        scene.method.virtual_points &= method.reconstruction == ReconstructionKind::Taylor;
        let has_no_other = matches!(
            method.reconstruction,
            ReconstructionKind::Shepard | ReconstructionKind::RelaxedTaylor
        );
        if !told || has_no_other {
            scene.method.velocity_mass = default;
        }
        scene
    }

    /// The same scene with this many cells along the first axis, at least 1, and as many along the others as
    /// keep the shape of the cells. The rest of the scene, the number of particles per cell among it, stays;
    /// it is not checked again.
    #[must_use]
    pub fn with_cells(mut self, cells: usize) -> Self {
        let cells = cells.max(1);
        let first = self.grid.cells.first().copied().unwrap_or(1).max(1);
        for along in &mut self.grid.cells {
            let scaled = *along as f64 * cells as f64 / first as f64;
            *along = (scaled.round() as usize).max(1);
        }
        self
    }

    /// Fraction of the largest stable step, or for plain MPM of a lower bound of it, that an automatic step
    /// takes: as told, or that of the method ([`Method::default_safety`]).
    pub fn safety(&self) -> f64 {
        match self.time.step {
            StepSize::Auto { safety: Some(safety) } => safety,
            _ => self.method.default_safety(),
        }
    }

    /// Number of axes.
    pub fn dimension(&self) -> usize {
        self.grid.cells.len()
    }
}

#[cfg(test)]
mod tests;
