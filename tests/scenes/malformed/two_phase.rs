//! Two phases.

use super::Case;
use super::Edit::{Replace, Set};

/// A scene without a reference that uses every key of two phases.
pub(super) const GOOD: &str = r#"
title = "Good soil"

[grid]
min = [0.0]
max = [1.0]
cells = [10]

[time]
step = 1e-6
end = 1e-3

[method]
basis = "bspline"
reconstruction = "taylor"

[material]
phases = 2
strain = "large"
law.logarithmic = { youngs_modulus = 1e6 }
porosity = 0.4
solid_density = 2600
liquid_density = 1e3
liquid_bulk_modulus = 3e7
permeability = 1e-4
permeability_exponent = 2
drag = "explicit"

[[body]]
min = [0.0]
max = [1.0]
particles_per_cell = [4]
velocity = ["1e-3*x"]
liquid_velocity = ["2e-3*x"]
stress = "-100*(1-x)"
pore_pressure = "-200*(1-x)"
initialise = "dofs"

[[boundary]]
face = "x-min"
fixed = true
drained = true

[[boundary]]
face = "x-max"
traction = ["-100*t"]
pore_pressure = "-10*t"

[load]
gravity = 9.81
body_force = ["-9.81*t"]
"#;

/// Keys of two phases in the good scene of one.
#[rustfmt::skip]
pub(super) const IN_ONE_PHASE: &[Case] = &[
    ("porosity", Set("material.porosity=0.4"), &["material.porosity = 0.4", "material.phases = 2 only"]),
    ("drag", Set("material.drag=implicit"), &["material.drag = \"implicit\"", "material.phases = 2 only"]),
    ("liquid velocity", Set("body.0.liquid_velocity=[\"0\"]"), &["body.0.liquid_velocity", "material.phases = 2 only"]),
    ("pore pressure", Set("body.1.pore_pressure=\"0\""), &["body.1.pore_pressure", "material.phases = 2 only"]),
    ("a drained face", Set("boundary.0.drained=true"), &["boundary.0.drained = true", "material.phases = 2 only"]),
    ("a pressure outside", Set("boundary.1.pore_pressure=\"t\""), &["boundary.1.pore_pressure", "material.phases = 2 only"]),
    ("gravity", Set("load.gravity=9.81"), &["load.gravity = 9.81", "body_force", "material.phases = 2"]),
    ("consolidation", Set("reference={consolidation={load=-1}}"), &["material.phases = 1", "reference.consolidation", "expected material.phases = 2"]),
];

/// Edits of [`GOOD`].
#[rustfmt::skip]
pub(super) const MATERIAL: &[Case] = &[
    ("density", Set("material.density=2000"), &["material.density = 2000", "porosity, solid_density and liquid_density"]),
    ("no porosity", Replace("porosity = 0.4\n", ""), &["material.porosity is missing", "above 0 and below 1"]),
    ("no grains", Replace("solid_density = 2600\n", ""), &["material.solid_density is missing", "(kg/m3)"]),
    ("no liquid", Replace("liquid_density = 1e3\n", ""), &["material.liquid_density is missing", "(kg/m3)"]),
    ("no bulk modulus", Replace("liquid_bulk_modulus = 3e7\n", ""), &["material.liquid_bulk_modulus is missing", "(Pa)"]),
    ("no permeability", Replace("permeability = 1e-4\n", ""), &["material.permeability is missing", "(m/s)"]),
    ("no pores", Set("material.porosity=0"), &["material.porosity = 0", "above 0 and below 1"]),
    ("nothing but pores", Set("material.porosity=1"), &["material.porosity = 1", "above 0 and below 1"]),
    ("porosity of nan", Set("material.porosity=nan"), &["material.porosity = NaN", "above 0 and below 1"]),
    ("grains without mass", Set("material.solid_density=0"), &["material.solid_density = 0", "positive number (kg/m3)"]),
    ("a light liquid", Set("material.liquid_density=-1"), &["material.liquid_density = -1", "positive number (kg/m3)"]),
    ("a liquid that gives way", Set("material.liquid_bulk_modulus=0"), &["liquid_bulk_modulus = 0", "positive number (Pa)"]),
    ("an impermeable solid", Set("material.permeability=0"), &["material.permeability = 0", "positive number (m/s)"]),
    ("an endless exponent", Set("material.permeability_exponent=inf"), &["permeability_exponent = inf", "finite"]),
    ("an unknown drag", Set("material.drag=none"), &["material.drag = \"none\"", "\"implicit\", \"explicit\""]),
    ("drag as a number", Set("material.drag=1"), &["material.drag = 1 is a whole number", "\"implicit\""]),
    ("an unknown key", Set("material.tortuosity=1"), &["material.tortuosity is not a key", "permeability_exponent, drag"]),
    ("no gravity", Set("load.gravity=0"), &["load.gravity = 0", "positive number (m/s2)"]),
];

/// Edits of [`GOOD`].
#[rustfmt::skip]
pub(super) const BODIES: &[Case] = &[
    ("a liquid velocity of two components", Set("body.0.liquid_velocity=[\"0\", \"0\"]"), &["body.0.liquid_velocity", "2 of them"]),
    ("a liquid velocity that is infinite", Set("body.0.liquid_velocity=[\"1/x\"]"), &["body.0.liquid_velocity.0", "inf at x = 0.0"]),
    ("time in a pore pressure", Set("body.0.pore_pressure=\"t\""), &["body.0.pore_pressure", "unknown name 't'"]),
    ("a pore pressure that is no number", Set("body.0.pore_pressure=\"sqrt(x-0.5)\""), &["body.0.pore_pressure", "NaN at x = 0.0"]),
    ("a face that is not drained", Set("boundary.0.drained=false"), &["boundary.0.drained = false", "expected true"]),
    ("drained twice", Set("boundary.1.drained=true"), &["boundary.1.drained = true", "pore_pressure too", "one of them"]),
    ("a pressure in a list", Set("boundary.1.pore_pressure=[\"t\"]"), &["boundary.1.pore_pressure", "is a list", "an expression in t"]),
    ("a pressure of position", Set("boundary.1.pore_pressure=\"x\""), &["boundary.1.pore_pressure", "unknown name 'x'"]),
    ("a pressure that is infinite", Set("boundary.1.pore_pressure=\"1/t\""), &["boundary.1.pore_pressure", "inf at t = 0.0"]),
    ("a drained face of two kinds", Set("boundary.0.velocity=[\"0\"]"), &["boundary.0 = {", "exactly one", "drained", "fixed and velocity"]),
    ("a boundary of nothing", Set("boundary.0={face=\"x-min\"}"), &["boundary.0 = {", "drained or pore_pressure", "none"]),
    ("a bar", Set("reference={vibrating-bar={velocity=1}}"), &["material.phases = 2", "reference.vibrating-bar", "expected material.phases = 1"]),
];

/// Edits of the compiled-in consolidation.
#[rustfmt::skip]
pub(super) const CONSOLIDATION: &[Case] = &[
    ("another load", Set("boundary.1.traction=[\"-2e4\"]"),
     &["reference.consolidation = { load = -10000.0, start = 0.5 }", "traction = load", "found -2.0000e4"]),
    ("a load that grows", Set("boundary.1.traction=[\"-1e4*t/0.5\"]"), &["reference.consolidation", "at t = 0.0000e0 s"]),
    ("no load", Set("boundary.1={face=\"x-max\", drained=true}"), &["reference.consolidation", "traction = load"]),
    ("a load on a part", Set("boundary.1.inside=\"x\""), &["reference.consolidation", "on all of x-max", "no inside"]),
    ("a sealed top", Set("boundary.1={face=\"x-max\", traction=[\"-1e4\"]}"), &["reference.consolidation", "at x-max with drained = true"]),
    ("a pressure outside", Set("boundary.1={face=\"x-max\", traction=[\"-1e4\"], pore_pressure=\"0\"}"), &["drained = true"]),
    ("a drained base", Set("boundary.0.drained=true"), &["reference.consolidation", "fixed = true at x-min", "neither drained"]),
    ("a free base", Set("boundary.0={face=\"x-min\", traction=[\"0\"]}"), &["reference.consolidation", "fixed = true at x-min"]),
    ("a layer in the air", Set("body.0.min=[0.1]"), &["reference.consolidation", "stands on x-min"]),
    ("weight", Set("load.body_force=[\"-9.81\"]"), &["reference.consolidation", "no load.body_force"]),
    ("a velocity", Set("body.0.velocity=[\"0\"]"), &["reference.consolidation", "initial state", "without velocity"]),
    ("a pore pressure", Set("body.0.pore_pressure=\"-1e4\""), &["reference.consolidation", "initial state", "pore_pressure"]),
    ("large strain from the middle", Set("material.strain=large"), &["reference.consolidation", "start = 0", "\"small\""]),
    ("a negative start", Set("reference.consolidation.start=-1"), &["reference.consolidation.start = -1", "0 or more (s)"]),
    ("a load of zero", Set("reference.consolidation.load=0"), &["reference.consolidation.load = 0", "other than 0 (Pa)"]),
    ("an unknown parameter", Set("reference.consolidation.height=1"), &["reference.consolidation.height", "load, start"]),
    ("one phase", Set("material={strain=\"small\", density=1, law={linear-elastic={youngs_modulus=1}}}"),
     &["boundary.1.drained = true", "material.phases = 2 only"]),
];

/// Edits of the compiled-in consolidation at large strain.
#[rustfmt::skip]
pub(super) const XIE_LEO: &[Case] = &[
    ("another law", Set("material.law={linear-elastic={youngs_modulus=1e6}}"), &["reference.xie-leo = { load = -500000.0 }", "E ln J", "logarithmic"]),
    ("another permeability", Set("material.permeability_exponent=1"), &["reference.xie-leo", "permeability_exponent = 2"]),
    ("another load", Set("reference.xie-leo.load=-1"), &["reference.xie-leo = { load = -1.0 }", "traction = load"]),
];

/// Edits of the compiled-in standing wave.
#[rustfmt::skip]
pub(super) const WAVE: &[Case] = &[
    ("a drained wall", Set("boundary.0.drained=true"), &["reference.standing-wave = { velocity = 0.001, mode = 1 }", "fixed = true at x-min and at x-max"]),
    ("a free end", Set("boundary=[{face=\"x-min\", fixed=true}]"), &["reference.standing-wave", "fixed = true"]),
    ("a short body", Set("body.0.max=[0.9]"), &["reference.standing-wave", "grid.min to grid.max"]),
    ("large strain", Set("material.strain=large"), &["reference.standing-wave", "small strain"]),
    ("no half wave", Set("reference.standing-wave.mode=0"), &["reference.standing-wave.mode = 0", "from 1"]),
    ("half a half wave", Set("reference.standing-wave.mode=0.5"), &["reference.standing-wave.mode = 0.5 is a number", "whole number"]),
    ("a stress", Set("body.0.stress=\"0\""), &["reference.standing-wave", "initial state"]),
];

/// Edits of the compiled-in saturated column.
#[rustfmt::skip]
pub(super) const WEIGHT: &[Case] = &[
    ("another weight", Set("load.gravity=1.62"), &["reference.self-weight = {}", "load.body_force = -gravity", "-1.6200e0", "found -9.8100e0"]),
    ("a ramp that is too long", Set("time.end=0.2"), &["reference.self-weight", "at time.end"]),
    ("a loaded top", Set("boundary.1.traction=[\"-1\"]"), &["reference.self-weight", "without traction"]),
    ("a sealed top", Set("boundary=[{face=\"x-min\", fixed=true}]"), &["reference.self-weight", "drained = true"]),
    ("a parameter", Set("reference.self-weight.height=1"), &["reference.self-weight.height = 1", "empty"]),
    ("large strain", Set("material.strain=large"), &["reference.self-weight", "small strain"]),
];
