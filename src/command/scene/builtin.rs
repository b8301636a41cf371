//! Scenes that are compiled in.

/// Names and texts; the first is the default.
const SCENES: [(&str, &str); 20] = [
    (
        "vibrating-bar-large",
        include_str!("../../../examples/scenes/vibrating-bar-large.toml"),
    ),
    (
        "vibrating-bar-small",
        include_str!("../../../examples/scenes/vibrating-bar-small.toml"),
    ),
    (
        "vibrating-bar-period",
        include_str!("../../../examples/scenes/vibrating-bar-period.toml"),
    ),
    (
        "column-compaction",
        include_str!("../../../examples/scenes/column-compaction.toml"),
    ),
    (
        "consolidation",
        include_str!("../../../examples/scenes/consolidation.toml"),
    ),
    (
        "consolidation-small",
        include_str!("../../../examples/scenes/consolidation-small.toml"),
    ),
    (
        "consolidation-large",
        include_str!("../../../examples/scenes/consolidation-large.toml"),
    ),
    (
        "saturated-column",
        include_str!("../../../examples/scenes/saturated-column.toml"),
    ),
    (
        "undrained-load",
        include_str!("../../../examples/scenes/undrained-load.toml"),
    ),
    (
        "standing-wave",
        include_str!("../../../examples/scenes/standing-wave.toml"),
    ),
    (
        "manufactured",
        include_str!("../../../examples/scenes/manufactured.toml"),
    ),
    ("vortex", include_str!("../../../examples/scenes/vortex.toml")),
    (
        "spinning-disc",
        include_str!("../../../examples/scenes/spinning-disc.toml"),
    ),
    (
        "colliding-discs",
        include_str!("../../../examples/scenes/colliding-discs.toml"),
    ),
    (
        "cantilever",
        include_str!("../../../examples/scenes/cantilever.toml"),
    ),
    (
        "cooks-membrane",
        include_str!("../../../examples/scenes/cooks-membrane.toml"),
    ),
    (
        "granular-column",
        include_str!("../../../examples/scenes/granular-column.toml"),
    ),
    (
        "dam-break",
        include_str!("../../../examples/scenes/dam-break.toml"),
    ),
    ("slope", include_str!("../../../examples/scenes/slope.toml")),
    ("footing", include_str!("../../../examples/scenes/footing.toml")),
];

/// Text of the scene `name`.
pub(super) fn text(name: &str) -> Option<&'static str> {
    SCENES.iter().find(|scene| scene.0 == name).map(|scene| scene.1)
}

/// All names.
pub(super) fn names() -> impl Iterator<Item = &'static str> {
    SCENES.iter().map(|scene| scene.0)
}
