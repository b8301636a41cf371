//! Numbers, expressions, and what does not go together.

use super::Case;
use super::Edit::Set;

#[rustfmt::skip]
pub(super) const NUMBERS: &[Case] = &[
    ("a step of zero", Set("time.step=0"), &["time.step = 0 is not allowed", "positive", "\"auto\""]),
    ("a negative step", Set("time.step=-1e-4"), &["time.step = -0.0001 is not allowed", "positive"]),
    ("a step of nan", Set("time.step=nan"), &["time.step = NaN is not allowed", "positive"]),
    ("an infinite end", Set("time.end=inf"), &["time.end = inf is not allowed", "positive"]),
    ("an end of zero", Set("time.end=0.0"), &["time.end = 0.0 is not allowed", "positive"]),
    ("an end before the first step's", Set("time.end=1e-5"), &["time.end = 1e-5", "time.step = 0.0001"]),
    ("too many steps", Set("time.step=1e-300"), &["time.end = 0.1", "1e299 steps", "at most 1e12"]),
    ("an unknown word for the step", Set("time.step=fast"), &["time.step = \"fast\"", "\"auto\""]),
    ("safety without auto", Set("time.safety=0.5"), &["time.safety = 0.5", "\"auto\" only"]),
    ("too much safety", Set("time.step=auto\ntime.safety=1.5"), &["time.safety = 1.5", "above 0 and at most 1"]),
    ("no cell", Set("grid.cells=[0]"), &["grid.cells.0 = 0 is not allowed", "from 1 to"]),
    ("a negative number of cells", Set("grid.cells=[-4]"), &["grid.cells.0 = -4 is not allowed", "from 1 to"]),
    ("too many cells", Set("grid.cells=[4000000000]"), &["grid.cells.0 = 4000000000", "to 100000000"]),
    ("a grid turned round", Set("grid.max=[-1.0]"), &["grid.max.0 = -1.0", "above grid.min.0 = 0.0"]),
    ("an infinite grid", Set("grid.max=[inf]"), &["grid.max.0 = inf", "a finite number (m)"]),
    ("a grid beyond all numbers", Set("grid.min=[-1e308]\ngrid.max=[1e308]"), &["grid.max.0 = 1e308", "finite"]),
    ("cells below round-off", Set("grid.min=[1e16]\ngrid.max=[1.00000000000001e16]"), &["grid.cells = [20]", "round-off"]),
    ("cells below round-off of f32", Set("method.scalar=f32\ngrid.cells=[900000]"), &["grid.cells = [900000]", "\"f64\""]),
    ("particles below round-off of f32", Set("method.scalar=f32\nbody.0.particles_per_cell=[90000]"), &["body.0.particles_per_cell = [90000]", "round-off", "\"f64\""]),
    ("a density of zero", Set("material.density=0"), &["material.density = 0", "positive number (kg/m3)"]),
    ("a modulus of nan", Set("material.law.linear-elastic.youngs_modulus=nan"), &["youngs_modulus = NaN", "positive number (Pa)"]),
    ("no particle per cell", Set("body.0.particles_per_cell=[0]"), &["body.0.particles_per_cell.0 = 0", "from 1 to"]),
    ("too many particles", Set("body.0.particles_per_cell=[90000000]"), &["body.0.particles_per_cell = [90000000]", "9e8 particles", "at most 100000000"]),
    ("jitter above one", Set("body.0.jitter=1.1"), &["body.0.jitter = 1.1", "0 to 1"]),
    ("a negative jitter", Set("body.0.jitter=-0.1"), &["body.0.jitter = -0.1", "0 to 1"]),
    ("a negative seed", Set("body.0.seed=-1"), &["body.0.seed = -1", "0 or more"]),
    ("a negative output interval", Set("output.every=-1"), &["output.every = -1", "0 or more"]),
];

#[rustfmt::skip]
pub(super) const COMBINATIONS: &[Case] = &[
    ("shepard with consistent mass", Set("method.reconstruction=shepard"),
     &["method.velocity_mass = \"consistent\"", "shepard is always lumped"]),
    ("relaxed Taylor with overwritten walls", Set("method.reconstruction=relaxed-taylor"),
     &["method.velocity_mass = \"consistent\"", "relaxed-taylor is always constrained"]),
    ("a degree of linear", Set("method.basis=linear"), &["method.degree = 2", "\"bspline\" only"]),
    ("a degree of zero", Set("method.degree=0"), &["method.degree = 0", "from 1 to 3"]),
    ("a degree of four", Set("method.degree=4"), &["method.degree = 4", "from 1 to 3"]),
    ("subpoints of a B-spline", Set("method.subpoints=1"), &["method.subpoints = 1", "\"dual-domain\"", "\"shepard\" only"]),
    ("subpoints of Taylor least squares", Set("method={basis=\"dual-domain\", reconstruction=\"taylor\", subpoints=2}"),
     &["method.subpoints = 2", "\"dual-domain\"", "\"shepard\" only"]),
    ("no sub-point", Set("method={basis=\"dual-domain\", reconstruction=\"shepard\", subpoints=0}"), &["method.subpoints = 0", "from 1 to 128"]),
    ("too many sub-points", Set("method={basis=\"dual-domain\", reconstruction=\"shepard\", subpoints=129}"),
     &["method.subpoints = 129", "from 1 to 128"]),
    ("half a sub-point", Set("method={basis=\"dual-domain\", reconstruction=\"shepard\", subpoints=2.5}"),
     &["method.subpoints = 2.5", "a whole number from 1 to 128"]),
    ("neo-hookean in small strain", Set("material.strain=small\nmaterial.law={neo-hookean={youngs_modulus=1}}"),
     &["material.strain = \"small\"", "neo-hookean", "\"large\""]),
    ("logarithmic in small strain", Set("material.strain=small\nmaterial.law={logarithmic={youngs_modulus=1}}"),
     &["material.strain = \"small\"", "logarithmic", "\"large\""]),
    ("a stressed neo-hookean body", Set("material.law={neo-hookean={youngs_modulus=1}}"),
     &["body.0.stress = \"-10*x\"", "starts undeformed"]),
    ("two laws", Set("material.law.neo-hookean.youngs_modulus=1"), &["material.law = {", "exactly one"]),
    ("no law in the table", Set("material.law={}"), &["material.law is missing", "law.linear-elastic ="]),
    ("lists of different lengths", Set("grid.max=[1.0, 2.0]"), &["grid.max = [1.0, 2.0]", "2 of them", "grid.min has 1"]),
    ("an empty list", Set("grid.min=[]"), &["grid.min = [] is not allowed", "one, two or three"]),
    ("four dimensions", Set("grid.min=[0, 0, 0, 0]"), &["grid.min = [0, 0, 0, 0]", "one, two or three"]),
    ("a velocity of two components", Set("body.0.velocity=[\"x\", \"0\"]"), &["body.0.velocity = [\"x\", \"0\"]", "2 of them"]),
    ("a body of two dimensions", Set("body.0.min=[0, 0]"), &["body.0.min = [0, 0]", "one per axis"]),
    ("no load in the list", Set("load.body_force=[]"), &["load.body_force = []", "0 of them"]),
];

#[rustfmt::skip]
pub(super) const BODIES: &[Case] = &[
    ("no body", Set("body=[]"), &["body = [] is not allowed", "[[body]]"]),
    ("an empty body", Set("body.1.max=[0.5]"), &["body.1.max = [0.5]", "more than the body's min, 0.5"]),
    ("a body turned round", Set("body.1.max=[0.4]"), &["body.1.max = [0.4]", "more than"]),
    ("overlapping bodies", Set("body.1.min=[0.4]"), &["body.1.min = [0.4]", "overlaps body.0", "touch"]),
    ("a body below the grid", Set("body.0.min=[-0.1]"), &["body.0.min = [-0.1]", "within the grid, 0.0 to 1.0 m"]),
    ("a body above the grid", Set("body.1.max=[1.1]"), &["body.1.max = [1.1]", "within the grid, 0.0 to 1.0 m"]),
    ("a body end of nan", Set("body.1.max=[nan]"), &["body.1.max.0 = NaN", "finite"]),
    ("a boundary of nothing", Set("boundary.0={face=\"x-min\"}"), &["boundary.0 = {", "exactly one of fixed, roller, friction, velocity, traction", "none"]),
    ("a boundary of two kinds", Set("boundary.0.velocity=[\"0\"]"), &["boundary.0 = {", "exactly one", "fixed and velocity"]),
    ("two boundaries of a face", Set("boundary.1.face=x-min"), &["boundary.1.face = \"x-min\"", "boundary.0", "one [[boundary]] a face"]),
    ("a boundary that is not fixed", Set("boundary.0.fixed=false"), &["boundary.0.fixed = false", "is free"]),
    ("a traction of two components", Set("boundary.1.traction=[\"t\", \"t\"]"), &["boundary.1.traction", "2 of them"]),
];

#[rustfmt::skip]
pub(super) const EXPRESSIONS: &[Case] = &[
    ("an open parenthesis", Set("body.0.velocity=[\"sin(x\"]"), &["body.0.velocity.0 = \"sin(x\"", "ends where ')'"]),
    ("an empty expression", Set("body.0.stress=\"\""), &["body.0.stress = \"\"", "ends", "a number"]),
    ("time in a body", Set("body.0.velocity=[\"t\"]"), &["body.0.velocity.0", "unknown name 't'", "allowed: x, pi, e"]),
    ("another axis", Set("body.0.stress=\"x + y\""), &["body.0.stress", "unknown name 'y'", "allowed: x, pi, e"]),
    ("position in a load", Set("load.body_force=[\"x\"]"), &["load.body_force.0", "unknown name 'x'", "allowed: t, pi, e"]),
    ("an unknown function", Set("boundary.1.traction=[\"heaviside(t)\"]"),
     &["boundary.1.traction.0", "unknown function 'heaviside'", "sin, cos"]),
    ("a missing star", Set("body.0.stress=\"2x\""), &["body.0.stress = \"2x\"", "'x' at column 2", "operator"]),
    ("a velocity that is infinite", Set("body.0.velocity=[\"1/x\"]"), &["body.0.velocity.0 = \"1/x\"", "inf at x = 0.0"]),
    ("a stress that is no number", Set("body.0.stress=\"sqrt(0.2-x)\""), &["body.0.stress", "NaN at x = 0.25"]),
    ("a load that is infinite at the start", Set("load.body_force=[\"1/t\"]"), &["load.body_force.0", "inf at t = 0.0"]),
    ("a traction that ends", Set("boundary.1.traction=[\"sqrt(0.09-t)\"]"), &["boundary.1.traction.0", "NaN at t = 0.1"]),
    ("an endless expression", Set("body.0.stress=\"((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((((\""),
     &["body.0.stress", "deeply nested", "100 levels"]),
];
