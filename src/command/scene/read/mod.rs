//! From a TOML table to a checked scene.

mod agreement;
mod beyond_one_axis;
mod body;
mod boundary;
mod grid;
mod item;
mod law;
mod load;
mod material;
mod method;
mod output;
mod overlap;
mod reference;
mod section;
mod time;

use item::Item;
use section::Section;

use toml::Table;

use super::{Expression, ExpressionError, Scene, SceneError};

const KEYS: [&str; 10] = [
    "title",
    "grid",
    "time",
    "method",
    "material",
    "body",
    "boundary",
    "load",
    "reference",
    "output",
];

/// Most cells, most particles per cell and most particles: with more of them memory would run out first.
const MOST: u64 = 100_000_000;

/// Reads and checks a whole scene.
pub(super) fn scene(table: &Table) -> Result<Scene, SceneError> {
    let root = Section::new(String::new(), table).allow(&KEYS, &[])?;
    let title = title(&root)?;
    let grid = grid::read(&root)?;
    let phases = material::phases(&root)?;
    let method = method::read(root.section("method")?, grid.cells.len(), phases)?;
    grid::check_cell_size(&root, &grid, method.scalar)?;
    let time = time::read(root.section("time")?)?;
    let load = load::read(&root, &grid, time.end, phases)?;
    let scene = Scene {
        title,
        material: material::read(root.section("material")?, grid.cells.len(), phases, load.gravity)?,
        bodies: body::read(&root, &grid, method.scalar, phases)?,
        boundaries: boundary::read(&root, &grid, time.end, phases)?,
        body_force: load.body_force,
        reference: reference::read(&root)?,
        output: output::read(&root)?,
        grid,
        time,
        method,
    };
    if scene.dimension() > 1 {
        grid::check_box(&root, &scene.grid, &scene.bodies)?;
    }
    body::check_stress(&root, scene.material.law, scene.dimension())?;
    beyond_one_axis::check(&root, &scene)?;
    agreement::check(&scene)?;
    Ok(scene)
}

fn title(root: &Section<'_>) -> Result<String, SceneError> {
    let item = root.required("title", "what the scene is, in words")?;
    let title = item.text("text")?;
    if title.trim().is_empty() {
        return Err(item.not_allowed("what the scene is, in words"));
    }
    Ok(title.into())
}

/// Refuses expressions in `t` that have no finite value at the start, the middle or the end. A hint: a run
/// evaluates them at other times too.
fn check_over_time(expressions: &[Expression], end: f64) -> Result<(), ExpressionError> {
    for expression in expressions {
        for time in [0.0, 0.5 * end, end] {
            expression.eval_time(time)?;
        }
    }
    Ok(())
}
