//! `materialpoint list`.

use materialpoint::method::Method;
use materialpoint_command::scene::Scene;
use serde_json::{Map, Value, json};

/// Names with what they stand for.
type Names = &'static [(&'static str, &'static str)];

/// Key in JSON, heading for people, and what there is.
const NAMES: [(&str, &str, Names); 5] = [
    (
        "bases",
        "basis families (method.basis)",
        &[
            ("linear", "piecewise linear hats: the original MPM"),
            (
                "dual-domain",
                "linear values, gradients continuous over cell edges: DDMPM",
            ),
            ("bspline", "B-splines of degree 1, 2 (default) or 3: BSMPM"),
        ],
    ),
    (
        "reconstructions",
        "reconstructions (method.reconstruction)",
        &[
            (
                "shepard",
                "the particles themselves are the quadrature points: plain MPM; with dual-domain also subpoints = 2 to 128 in each",
            ),
            (
                "taylor",
                "Taylor least squares per cell and Gauss points: keeps mass and momentum; virtual_points = true in 1-D",
            ),
            (
                "relaxed-taylor",
                "the same, stable in long runs and more accurate: our own, keeps both",
            ),
            (
                "spline",
                "global cubic spline and Gauss points, 1-D: accurate, keeps neither",
            ),
        ],
    ),
    (
        "laws",
        "laws (material.law.NAME with material.strain)",
        &[
            (
                "linear-elastic",
                "strain = \"small\": Hooke; strain = \"large\": Hill's rate",
            ),
            ("neo-hookean", "strain = \"large\": compressible neo-Hookean"),
            (
                "logarithmic",
                "strain = \"large\": stress E ln J; Hencky beyond 1-D",
            ),
            ("st-venant-kirchhoff", "strain = \"large\", 2-D and 3-D"),
            ("von-mises", "strain = \"large\", hardening, 2-D and 3-D"),
            (
                "drucker-prager",
                "strain = \"large\", cohesion, dilation, 2-D and 3-D",
            ),
            (
                "newtonian-fluid",
                "strain = \"large\", weakly compressible, 2-D and 3-D",
            ),
        ],
    ),
    (
        "phases",
        "phases (material.phases)",
        &[
            ("1", "a dry solid"),
            (
                "2",
                "a saturated solid: solid and pore liquid with velocities of their own (v-w), 1-D and 2-D",
            ),
        ],
    ),
    (
        "references",
        "references ([reference])",
        &[
            (
                "vibrating-bar",
                "exact at small strain, converged Lagrangian solution at large strain",
            ),
            (
                "column-compaction",
                "against = \"static\" or \"dynamic\" (converged)",
            ),
            (
                "consolidation",
                "two phases: a loaded layer drains; exact at small strain, converged at large strain",
            ),
            (
                "xie-leo",
                "two phases: the same at large strain (logarithmic), no inertia, incompressible",
            ),
            (
                "standing-wave",
                "two phases: damped wave between walls, exact at small strain",
            ),
            (
                "self-weight",
                "two phases: saturated column at rest under its weight, small strain",
            ),
            (
                "manufactured",
                "2-D and 3-D: neo-Hookean waves in a box on rollers, exact at finite strain",
            ),
            (
                "vortex",
                "2-D and 3-D: a neo-Hookean ring sheared and turned, exact at finite strain",
            ),
        ],
    ),
];

/// The list for people.
pub(super) fn list() -> String {
    let mut lines = Vec::new();
    for (_, heading, names) in NAMES {
        lines.push(heading.to_owned());
        lines.extend(names.iter().map(|(name, words)| format!("  {name:<19} {words}")));
    }
    lines.push("scenes (compiled in; give the name instead of a file)".to_owned());
    lines.extend(Scene::builtin_names().map(|name| format!("  {name}")));
    let methods: Vec<_> = Method::ALL.iter().map(Method::to_string).collect();
    lines.push(format!(
        "methods of a study (--methods)\n  {}; dual-domain+shepardS with S = 2 to 128 sub-points\n",
        methods.join(", ")
    ));
    lines.join("\n")
}

/// The same as one JSON object: lists of `name` and `about`, of scenes and methods the names alone.
pub(super) fn json() -> Value {
    let entry = |&(name, about): &(&str, &str)| json!({ "name": name, "about": about });
    let list = |names: &[(&str, &str)]| Value::Array(names.iter().map(entry).collect());
    let mut all: Map<_, _> = NAMES
        .iter()
        .map(|(key, _, names)| (key.to_string(), list(names)))
        .collect();
    all.insert("scenes".to_owned(), Scene::builtin_names().collect());
    all.insert(
        "methods".to_owned(),
        Method::ALL.iter().map(Method::to_string).collect(),
    );
    Value::Object(all)
}
