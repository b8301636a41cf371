//! Mistakes of scenes in two dimensions, and what such scenes cannot do in this version.

use super::Case;
use super::Edit::{Replace, Set};

/// Edits of the compiled-in waves in a box.
#[rustfmt::skip]
pub(super) const WAVES: &[Case] = &[
    ("another law", Set("material.law={linear-elastic={youngs_modulus=1, poissons_ratio=0.2}}"), &["reference.manufactured = { amplitude = 0.05 }", "neo-hookean"]),
    ("a wall without a roller", Set("boundary.3={face=\"y-max\", fixed=true}"), &["reference.manufactured", "roller = true", "y-max"]),
    ("a part of the box", Set("body.0.inside=\"x\""), &["reference.manufactured", "fills the grid"]),
    ("a velocity", Set("body.0.velocity=[\"0\", \"0\"]"), &["reference.manufactured", "gives initial state"]),
    ("no wave", Set("reference.manufactured.amplitude=0"), &["reference.manufactured.amplitude = 0", "other than 0"]),
    ("one axis", Set("grid={min=[0], max=[1], cells=[4]}"), &["poissons_ratio = 0.3", "one dimension knows uniaxial strain only"]),
    ("a reference of a line", Set("reference={vibrating-bar={velocity=1}}"), &["grid.cells = [16, 16]", "reference.vibrating-bar", "another number of dimensions"]),
];

/// Edits of the compiled-in vortex.
#[rustfmt::skip]
pub(super) const VORTEX: &[Case] = &[
    ("another law", Set("material.law={linear-elastic={youngs_modulus=1, poissons_ratio=0.2}}"), &["reference.vortex = { inner = 0.75, outer = 1.25, ... }", "neo-hookean"]),
    ("a wall that pulls", Set("boundary=[{face=\"x-min\", traction=[\"1\", \"0\"]}]"), &["reference.vortex", "fixed or roller at x-min"]),
    ("a thinner ring", Set("body.0.inside=\"1.2 - sqrt(x^2 + y^2)\""), &["reference.vortex", "holds the ring", "there is none"]),
    ("a ring beside the middle", Set("grid.max=[2.5, 1.5]"), &["reference.vortex", "about the middle of the grid"]),
    ("a box that cuts the ring", Set("body.0.max=[1.0, 1.25]"), &["reference.vortex", "there is none"]),
    ("a velocity", Set("body.0.velocity=[\"0\", \"0\"]"), &["reference.vortex", "gives initial state"]),
    ("no turn", Set("reference.vortex.angle=0"), &["reference.vortex.angle = 0", "other than 0"]),
    ("radii that cross", Set("reference.vortex.outer=0.5"), &["reference.vortex.outer = 0.5", "above the inner one, 0.75 m"]),
    ("no time", Set("reference.vortex.time=0"), &["reference.vortex.time = 0", "positive"]),
    ("no radius", Replace("inner = 0.75, ", ""), &["reference.vortex.inner is missing", "inner radius"]),
    ("a place without a traction", Set("boundary=[{face=\"x-min\", roller=true, inside=\"x\"}]"), &["boundary.0.inside", "expected traction beside it"]),
    ("a place in time", Set("boundary=[{face=\"x-min\", traction=[\"0\", \"0\"], inside=\"t\"}]"), &["boundary.0.inside", "x, y"]),
];

/// Edits of the compiled-in column of sand.
#[rustfmt::skip]
pub(super) const SAND: &[Case] = &[
    ("no Poisson's ratio", Replace(", poissons_ratio = 0.3", ""), &["law.drucker-prager.poissons_ratio is missing", "below 0.5"]),
    ("too steep", Set("material.law.drucker-prager.friction_angle=90"), &["friction_angle = 90", "below 90"]),
    ("more dilation than friction", Set("material.law.drucker-prager.dilation_angle=32.0"), &["dilation_angle = 32.0", "0 to the friction angle, 31.0"]),
    ("negative cohesion", Set("material.law.drucker-prager.cohesion=-1"), &["cohesion = -1", "0 or more"]),
    ("another constant", Set("material.law.drucker-prager.angle=1"), &["material.law.drucker-prager.angle", "friction_angle"]),
    ("small strain", Set("material.strain=small"), &["material.strain = \"small\"", "drucker-prager", "\"large\""]),
    ("a wall that pushes", Set("boundary.1.friction=-0.1"), &["boundary.1.friction = -0.1", "0 or more"]),
    ("a wall of two kinds", Set("boundary.1.roller=true"), &["exactly one of fixed, roller, friction", "roller and friction"]),
    ("an unknown component", Set("body.0.stress={zz=\"1\"}"), &["body.0.stress.zz", "xx, xy, yy"]),
    ("a stress without components", Set("body.0.stress=\"1\""), &["body.0.stress = \"1\"", "a table of components"]),
    ("a shape of time", Set("body.0.inside=\"t\""), &["body.0.inside", "x, y"]),
    ("too many cells", Set("grid.cells=[100000, 100000]"), &["grid.cells = [100000, 100000]", "at most 4000000000"]),
    ("bodies too far apart", Set("grid.cells=[60000, 60000]\nbody=[{min=[0, 0], max=[0.001, 0.001], particles_per_cell=[2, 2]}, {min=[0.499, 0.149], max=[0.5, 0.15], particles_per_cell=[2, 2]}]"),
     &["grid.cells = [60000, 60000]", "the box around the bodies", "at most 100000000"]),
    ("a fluid with pores", Set("material={phases=2, strain=\"large\", porosity=0.4, solid_density=2e3, liquid_density=1e3, liquid_bulk_modulus=1e8, permeability=1e-4, law={newtonian-fluid={bulk_modulus=1e6}}}"),
     &["material.law", "a fluid has no pores", "the law of a solid"]),
    ("relaxed Taylor with two phases", Set("material={phases=2, strain=\"small\", porosity=0.4, solid_density=2e3, liquid_density=1e3, liquid_bulk_modulus=1e8, permeability=1e-4, law={linear-elastic={youngs_modulus=1e6, poissons_ratio=0}}}\nmethod.reconstruction=relaxed-taylor\nboundary=[]"),
     &["method.reconstruction = \"relaxed-taylor\"", "beyond one axis it knows one phase only"]),
    ("half the digits", Set("method.scalar=f32"), &["method.scalar = \"f32\" is not possible in this version", "\"f64\""]),
    ("cubic functions", Set("method.degree=3"), &["method.degree = 3 is not possible in this version", "1 or 2"]),
    ("sub-points", Set("method.basis=dual-domain\nmethod.subpoints=2"), &["method.subpoints = 2 is not possible in this version"]),
    ("values at the DOFs", Set("body.0.initialise=dofs"), &["body.0.initialise = \"dofs\" is not possible in this version", "\"exact\""]),
];
