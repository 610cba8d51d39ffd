//! Scenes by name or path.

use crate::failure::Failure;
use grainlab_node_kit::Exit;
use grainlab_recordings::input;
use grainlab_scene::Scene;
use std::path::Path;

/// The scenes built in.
const BUILT_IN: [(&str, &str); 5] = [
    ("demo", include_str!("../../scenes/demo.toml")),
    ("s1", include_str!("../../scenes/s1.toml")),
    ("s2", include_str!("../../scenes/s2.toml")),
    ("s3", include_str!("../../scenes/s3.toml")),
    ("s4", include_str!("../../scenes/s4.toml")),
];

/// A scene and the text it was read from.
#[derive(Clone, Debug)]
pub struct SceneText {
    /// The full text, which goes into the recording.
    pub text: String,
    /// The same, parsed, with the seed in force.
    pub scene: Scene,
}

/// The scene of a built-in name or of a file; `seed` overrides the one that it names.
pub fn load(name_or_path: &str, seed: Option<u64>) -> Result<SceneText, Failure> {
    let text = match BUILT_IN.iter().find(|(name, _)| *name == name_or_path) {
        Some((_, text)) => (*text).to_owned(),
        None => read(name_or_path)?,
    };
    let mut scene = Scene::parse(&text).map_err(|e| Failure::usage(format!("{name_or_path}: {e}")))?;
    scene.seed = seed.unwrap_or(scene.seed);
    Ok(SceneText { text, scene })
}

fn read(path: &str) -> Result<String, Failure> {
    if !path.contains('/') && !Path::new(path).exists() {
        let known = BUILT_IN.map(|(name, _)| name).join(", ");
        let message = format!("no scene {path:?}: neither a file nor built in; built in are: {known}");
        return Err(Failure::usage(message));
    }
    input::text(Path::new(path), input::SETTINGS)
        .map_err(|e| Failure::new(Exit::Failure, format!("scene {path}: {e}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_scene_built_in_parses_and_carries_its_own_name() {
        for (name, _) in BUILT_IN {
            assert_eq!(load(name, None).unwrap().scene.name, name);
        }
    }

    #[test]
    fn the_seed_given_wins_and_an_unknown_scene_lists_those_there_are() {
        assert_eq!(load("demo", Some(7)).unwrap().scene.seed, 7);
        let failure = load("dmeo", None).unwrap_err();
        assert!(failure.exit == Exit::Usage && failure.to_string().contains("demo, s1"), "{failure}");
        assert_eq!(load("no/such.toml", None).unwrap_err().exit, Exit::Failure);
    }
}
