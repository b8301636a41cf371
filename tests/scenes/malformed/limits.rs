//! What this version cannot do, and what a reference does not solve.

use super::Case;
use super::Edit::{Replace, Set};

#[rustfmt::skip]
pub(super) const NOT_IN_THIS_VERSION: &[Case] = &[
    ("three phases", Set("material.phases=3"), &["material.phases = 3 is not allowed", "expected 1", "or 2"]),
    ("Poisson's ratio", Set("material.law.linear-elastic.poissons_ratio=0.3"),
     &["poissons_ratio = 0.3", "one dimension knows uniaxial strain only"]),
    ("two dimensions half told", Set("grid={min=[0, 0], max=[1, 1], cells=[4, 5]}"),
     &["load.body_force = [\"-2*t\"]", "it has 1 of them and grid.min has 2"]),
    ("a cubic spline in two dimensions", Set("method.reconstruction=spline\ngrid={min=[0, 0], max=[1, 1], cells=[4, 5]}"),
     &["method.reconstruction = \"spline\"", "exists in 1-D only", "2 axes"]),
    ("a cubic basis in two dimensions", Set("method.degree=3\ngrid={min=[0, 0], max=[1, 1], cells=[4, 5]}\nmaterial.law={linear-elastic={youngs_modulus=1, poissons_ratio=0}}\nbody=[{min=[0, 0], max=[1, 1], particles_per_cell=[2, 2]}]\nboundary=[]\nload={}"),
     &["method.degree = 3 is not possible in this version", "1 or 2 beyond one dimension"]),
];

/// Edits of the compiled-in bar.
#[rustfmt::skip]
pub(super) const BAR: &[Case] = &[
    ("a bar with a hole", Set("body.0.inside=\"abs(x - 0.5) - 0.1\""), &["reference.vibrating-bar", "exactly one [[body]]"]),
    ("a law of the plane", Set("material.law={von-mises={}}"), &["material.law.von-mises", "two and three dimensions"]),
    ("two bodies", Replace("[[body]] ", "[[body]]\nmin = [0.1]\nmax = [0.2]\nparticles_per_cell = [1]\n[[body]]\n"),
     &["body.1.min = [0.0]", "overlaps body.0"]),
    ("a free end", Set("boundary=[{face=\"x-min\", fixed=true}]"), &["reference.vibrating-bar = { velocity = 0.8 }", "x-min and at x-max"]),
    ("a moving end", Set("boundary.1={face=\"x-max\", velocity=[\"0\"]}"), &["reference.vibrating-bar", "fixed = true"]),
    ("a bar that is too short", Set("body.0.max=[0.9]"), &["reference.vibrating-bar", "from grid.min to grid.max"]),
    ("another velocity", Set("reference.vibrating-bar.velocity=0.4"), &["reference.vibrating-bar = { velocity = 0.4 }", "body.0.velocity"]),
    ("another shape", Set("body.0.velocity=[\"0.8*sin(3*pi*x)\"]"), &["reference.vibrating-bar", "sin(pi*X/length)"]),
    ("a load", Set("load.body_force=[\"-1\"]"), &["reference.vibrating-bar", "without load.body_force"]),
    ("no velocity", Set("reference.vibrating-bar.velocity=0"), &["reference.vibrating-bar.velocity = 0", "other than 0"]),
    ("no parameter", Set("reference.vibrating-bar={}"), &["reference.vibrating-bar.velocity is missing", "(m/s)"]),
    ("no reference in the table", Set("reference={}"), &["reference is missing", "vibrating-bar, column-compaction"]),
    ("two references", Set("reference.column-compaction={body_force=-1, ramp=1}"), &["reference.vibrating-bar", "exactly one reference"]),
];

/// Edits of the compiled-in column.
#[rustfmt::skip]
pub(super) const COLUMN: &[Case] = &[
    ("two bodies", Set("body=[{min=[0], max=[9], particles_per_cell=[1]}, {min=[9], max=[50], particles_per_cell=[1]}]"),
     &["reference.column-compaction", "exactly one [[body]]"]),
    ("a free base", Set("boundary=[]"), &["reference.column-compaction = { body_force = -200.0, ramp = 0.5 }", "fixed = true at x-min"]),
    ("a fixed top", Set("boundary=[{face=\"x-min\", fixed=true}, {face=\"x-max\", fixed=true}]"), &["no [[boundary]] at x-max"]),
    ("a column in the air", Set("body.0.min=[1.0]"), &["reference.column-compaction", "stands on x-min"]),
    ("a column in motion", Set("body.0.velocity=[\"x\"]"), &["reference.column-compaction", "at rest"]),
    ("another load", Set("load.body_force=[\"-100*t/0.5\"]"), &["reference.column-compaction", "min(t/ramp, 1)", "load.body_force"]),
    ("no load", Replace("[load]\nbody_force = [\"-200*t/0.5\"]", "[load]\n"), &["reference.column-compaction", "load.body_force"]),
    ("another ramp", Set("reference.column-compaction.ramp=0.25"), &["reference.column-compaction", "ramp = 0.25"]),
    ("a ramp beyond the end", Set("time.end=1.0"), &["reference.column-compaction", "min(t/ramp, 1)", "t = 7.0000e-1"]),
    ("a negative ramp", Set("reference.column-compaction.ramp=-0.5"), &["reference.column-compaction.ramp = -0.5", "positive number (s)"]),
    ("against something else", Set("reference.column-compaction.against=rest"), &["against = \"rest\"", "\"static\", \"dynamic\""]),
    ("static neo-hookean", Set("reference.column-compaction.against=static\nmaterial.law={neo-hookean={youngs_modulus=1e6}}"),
     &["reference.column-compaction", "linear-elastic", "\"dynamic\""]),
    ("more tension than the law bears", Set("reference.column-compaction={body_force=2e4, ramp=0.5, against=\"static\"}\nload.body_force=[\"4e4*t\"]"),
     &["reference.column-compaction", "no equilibrium", "smaller body_force"]),
];
