//! Scenes in two and three dimensions.

mod body;
mod manufactured;
mod saturated;
mod slope;
mod walls;
mod window;

use materialpoint::scene::Scene;

/// A scene with overrides.
#[track_caller]
pub fn scene(text: &str, set: &[&str]) -> Scene {
    let set: Vec<String> = set.iter().map(ToString::to_string).collect();
    Scene::from_toml(text, &set).unwrap()
}
