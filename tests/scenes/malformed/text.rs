//! Text, keys, types and names.

use super::Case;
use super::Edit::{Replace, Set};

#[rustfmt::skip]
pub(super) const SYNTAX: &[Case] = &[
    ("a value without quotes", Replace("\"csv\"", "csv"), &["line 53, column 13", "quoted", "particles = csv"]),
    ("an open list", Replace("cells = [20]", "cells = [20"), &["line 9, column 1", "missing comma", "[time]"]),
    ("a key given twice", Replace("degree = 2", "degree = 2\ndegree = 3"), &["line 16, column 1", "duplicate key"]),
    ("a table given twice", Replace("[output]", "[grid]"), &["line 52, column 2", "duplicate key"]),
    ("not TOML at all", Replace("title = \"Good\"", "<scene>"), &["line 2, column 8", "expected `=`", "<scene>"]),
];

#[rustfmt::skip]
pub(super) const KEYS: &[Case] = &[
    ("an unknown table", Replace("[load]", "[loads]"), &["loads is not a key", "title, grid", "load, reference"]),
    ("an unknown key", Replace("step =", "dt ="), &["time.dt is not a key", "step, safety, end"]),
    ("an unknown key of a body", Set("body.1.ppc=[4]"), &["body.1.ppc is not a key", "particles_per_cell"]),
    ("an unknown key of a boundary", Set("boundary.0.free=true"), &["boundary.0.free", "face, fixed, roller, friction, velocity, traction, inside, drained, pore_pressure"]),
    ("an unknown constant", Set("material.law.linear-elastic.mu=1"), &["law.linear-elastic.mu", "youngs_modulus"]),
    ("a key of an unprintable name", Set("grid.\"\\n\"=1"), &["not a key", "min, max, cells"]),
    ("no title", Replace("title = \"Good\"", ""), &["title is missing", "in words"]),
    ("an empty title", Set("title=\" \""), &["title = \" \" is not allowed", "in words"]),
    ("no grid", Replace("[grid]\nmin = [0.0]\nmax = [1.0]\ncells = [20]", ""), &["grid is missing", "[grid]"]),
    ("no end", Replace("end = 0.1\n", ""), &["time.end is missing", "positive number (s)"]),
    ("no basis", Replace("basis = \"bspline\"\n", ""), &["method.basis is missing", "\"linear\""]),
    ("no reconstruction", Replace("reconstruction = \"taylor\"\n", ""), &["method.reconstruction is missing", "shepard"]),
    ("no density", Replace("density = 2000.0\n", ""), &["material.density is missing", "(kg/m3)"]),
    ("no strain", Replace("strain = \"large\"\n", ""), &["material.strain is missing", "\"small\" or \"large\""]),
    ("no law", Replace("law.linear-elastic = { youngs_modulus = 4e4 }\n", ""), &["material.law is missing", "law.linear-elastic ="]),
    ("no particles", Replace("particles_per_cell = [4]\n", ""), &["body.1.particles_per_cell is missing"]),
    ("no face", Replace("face = \"x-max\"\n", ""), &["boundary.1.face is missing", "\"x-min\", \"x-max\""]),
];

#[rustfmt::skip]
pub(super) const TYPES: &[Case] = &[
    ("text for a number", Set("time.end=\"long\""), &["time.end = \"long\" is text", "a positive number (s)"]),
    ("a number for text", Set("title=3"), &["title = 3 is a whole number", "expected text"]),
    ("a number for a list", Set("grid.min=0.0"), &["grid.min = 0.0 is a number", "a list of numbers (m)"]),
    ("a table for a list", Set("grid.cells={x=20}"), &["grid.cells = { x = 20 } is a table", "a list of whole numbers"]),
    ("half a cell", Set("grid.cells=[20.5]"), &["grid.cells.0 = 20.5 is a number", "a whole number from 1"]),
    ("a number for a flag", Set("boundary.0.fixed=1"), &["boundary.0.fixed = 1 is a whole number", "expected true"]),
    ("one body as a table", Set("body={min=[0.0]}"), &["body = { min = [0.0] } is a table", "[[body]]"]),
    ("a number for a table", Set("output=1"), &["output = 1 is a whole number", "[output]"]),
    ("a flag for a step", Set("time.step=true"), &["time.step = true is a boolean", "\"auto\""]),
    ("a date for an end", Set("time.end=2020-01-01"), &["time.end = 2020-01-01 is a date"]),
    ("a number for a velocity", Set("body.0.velocity=[0.5]"), &["body.0.velocity.0 = 0.5 is a number", "in quotes"]),
    ("text for a list of text", Set("load.body_force=\"-2*t\""), &["load.body_force = \"-2*t\" is text", "a list of expressions"]),
    ("the law as text", Set("material.law=linear-elastic"), &["material.law = \"linear-elastic\" is text", "law.linear-elastic ="]),
];

#[rustfmt::skip]
pub(super) const NAMES: &[Case] = &[
    ("an unknown basis", Set("method.basis=quadratic"), &["method.basis = \"quadratic\"", "\"linear\", \"dual-domain\", \"bspline\""]),
    ("an unknown reconstruction", Set("method.reconstruction=tls"), &["= \"tls\"", "\"shepard\", \"taylor\", \"relaxed-taylor\", \"spline\""]),
    ("an unknown mass", Set("method.velocity_mass=diagonal"), &["= \"diagonal\"", "\"consistent\", ", "\"lumped\""]),
    ("an unknown scalar", Set("method.scalar=f16"), &["method.scalar = \"f16\"", "\"f64\", \"f32\""]),
    ("an unknown strain", Set("material.strain=finite"), &["material.strain = \"finite\"", "\"small\", \"large\""]),
    ("an unknown law", Set("material.law={jelly={}}"), &["material.law.jelly", "linear-elastic, neo-hookean, logarithmic"]),
    ("an unknown face", Set("boundary.0.face=bottom"), &["boundary.0.face = \"bottom\"", "\"x-min\", \"x-max\""]),
    ("a face of another dimension", Set("boundary.0.face=y-min"), &["= \"y-min\"", "\"x-min\", \"x-max\""]),
    ("an unknown reference", Set("reference={pendulum={}}"), &["reference.pendulum", "vibrating-bar, column-compaction"]),
    ("an unknown output", Set("output.particles=json"), &["output.particles = \"json\"", "\"csv\", \"vtu\", \"none\""]),
    ("an unknown start", Set("body.0.initialise=guess"), &["body.0.initialise = \"guess\"", "\"exact\", \"dofs\""]),
];
