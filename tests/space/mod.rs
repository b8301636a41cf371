//! Scenes in two and three dimensions.

mod automatic_step;
mod body;
mod cantilever;
mod collapse;
mod cook;
mod discs;
mod files;
mod footing;
mod mandel;
mod manufactured;
mod patch;
mod rotation;
mod rubbing;
mod saturated;
mod shape;
mod slope;
mod translation;
mod vortex;
mod walls;
mod watch;
mod window;

use materialpoint_command::scene::Scene;

/// A scene with overrides.
#[track_caller]
pub fn scene(text: &str, set: &[&str]) -> Scene {
    let set: Vec<String> = set.iter().map(ToString::to_string).collect();
    Scene::from_toml(text, &set).unwrap()
}
