//! Scenes by name or path, with their bases and overrides.

use crate::import::{instead_of_hdf5, start};
use grainlab_console::Failure;
use grainlab_console::input;
use grainlab_core::Packing;
use grainlab_msgs::Exit;
use grainlab_scene::{BUILT_IN, Draft, Scene, Source, assignment, built_in};
use std::path::Path;

/// A scene and its text.
#[derive(Clone, Debug)]
pub struct SceneText {
    /// The text for the recording: complete without its bases, with the seed in force.
    pub text: String,
    /// Scene parsed from the text.
    pub scene: Scene,
    /// The packing that it starts from, if any.
    pub start: Option<Packing>,
    /// Notes on that packing.
    pub notes: Vec<String>,
}

/// [`read`], with the notes printed.
pub fn load(name_or_path: &str, sets: &[String], seed: Option<u64>) -> Result<SceneText, Failure> {
    let found = read(name_or_path, sets, seed)?;
    found.notes.iter().for_each(|note| grainlab_console::say!("grainlab: {note}"));
    Ok(found)
}

/// The scene of a built-in name, of a file, or of a text of several lines, changed by `sets` such as `grains.count=500`; `seed`
/// replaces that of the scene.
pub fn read(name_or_path: &str, sets: &[String], seed: Option<u64>) -> Result<SceneText, Failure> {
    let source = find(name_or_path, None).map_err(|f| match f.exit {
        Exit::Usage => f,
        exit => Failure::new(exit, format!("scene {name_or_path}: {f}")),
    })?;
    let name = if is_text(name_or_path) { "scene" } else { name_or_path };
    let with = |sets: &[String]| match sets {
        [] => name.to_owned(),
        sets => format!("{name} with {}", sets.join(" ")),
    };
    let library = |base: &str, from: &str| find(base, Some(Path::new(from))).map_err(|f| f.to_string());
    let refused = |e: grainlab_scene::SceneError| Failure::usage(format!("{}: {e}", with(sets)));
    let mut draft = Draft::of(&source, &library).map_err(refused)?;
    let seed = seed.map(|s| format!("seed={s}"));
    for set in sets.iter().chain(&seed) {
        draft.set(assignment(set).map_err(refused)?).map_err(refused)?;
    }
    let start = draft.start().map(|file| start(&draft, &file)).transpose();
    let start = start.map_err(|f| Failure::new(f.exit, format!("{}: {f}", with(sets))))?;
    let of_start =
        start.iter().flat_map(|s| s.notes.iter().map(|note| format!("{}: {note}", s.path.display())));
    let notes = of_start.collect();
    let resolved = match &start {
        None => draft.resolve(),
        Some(found) => {
            // The whole path, because the scene is read again from the directory of its run.
            let forces = found.contact_forces.as_ref().map(|path| path.to_string_lossy());
            draft.start_at(&found.path.to_string_lossy(), forces.as_deref(), found.step);
            draft.resolve_from(&found.packing)
        }
    };
    let resolved = resolved.map_err(refused)?;
    Ok(SceneText {
        text: resolved.toml,
        scene: resolved.scene,
        start: start.map(|found| found.packing),
        notes,
    })
}

/// Returns true for the text of a scene: several lines that are not the path of a file.
fn is_text(scene: &str) -> bool {
    scene.contains('\n') && !scene.ends_with(".toml") && !Path::new(scene).exists()
}

/// A built-in scene or a file; one named in the file `from` is searched for beside it.
fn find(name: &str, from: Option<&Path>) -> Result<Source, Failure> {
    if is_text(name) {
        return Ok(Source { name: "scene".to_owned(), text: name.to_owned() });
    }
    if let Some(text) = built_in(name) {
        return Ok(Source { name: name.to_owned(), text: text.to_owned() });
    }
    let path = from.and_then(Path::parent).unwrap_or(Path::new("")).join(name);
    if !name.contains('/') && !path.exists() {
        let known = BUILT_IN.map(|(name, _)| name).join(", ");
        let message = format!("no scene {name:?}: neither a file nor built in; built in are: {known}");
        return Err(Failure::usage(message));
    }
    if let Some(instead) = instead_of_hdf5(&path) {
        return Err(Failure::usage(format!("{name} is no scene: {instead}")));
    }
    let text = input::text(&path, input::SETTINGS).map_err(Failure::failed)?;
    // The whole path identifies a file, also if it is reached in two ways.
    let name = path.canonicalize().unwrap_or(path);
    Ok(Source { name: name.to_string_lossy().into_owned(), text })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_scene_built_in_parses_and_carries_its_own_name() {
        for (name, _) in BUILT_IN {
            assert_eq!(load(name, &[], None).unwrap().scene.name, name);
        }
    }

    #[test]
    fn the_seed_given_wins_and_an_unknown_scene_lists_those_there_are() {
        let seven = load("demo", &[], Some(7)).unwrap();
        assert!(seven.scene.seed == 7 && seven.text.contains("seed = 7\n"));
        let failure = load("dmeo", &[], None).unwrap_err();
        assert!(failure.exit == Exit::Usage && failure.to_string().contains("demo, s1"), "{failure}");
        assert_eq!(load("no/such.toml", &[], None).unwrap_err().exit, Exit::Failure);
    }

    #[test]
    fn a_path_may_contain_a_newline_and_is_named_if_no_file_has_it() {
        let folder = tempfile::tempdir().unwrap();
        let text = "base = 's2'\nname = 'mine'\ngrains.count = 600\n";
        for name in ["ti\nny.toml", "ti\nny"] {
            let path = folder.path().join(name);
            std::fs::write(&path, text).unwrap();
            assert_eq!(load(&path.to_string_lossy(), &[], None).unwrap().scene.grains, 600);
        }
        let failure = load("no\nsuch.toml", &[], None).unwrap_err().to_string();
        assert!(failure.starts_with(r#"no scene "no\nsuch.toml""#), "{failure}");
        assert_eq!(load(text, &[], None).unwrap().scene.grains, 600);
    }

    #[test]
    fn what_is_set_is_in_the_scene_and_a_fault_names_it() {
        let sets =
            |sets: &[&str]| load("s2", &sets.iter().map(|s| (*s).to_owned()).collect::<Vec<_>>(), None);
        let small = sets(&["grains.count=500", "friction=0.2", "name=n500"]).unwrap();
        assert_eq!((small.scene.grains, small.scene.name.as_str()), (500, "n500"));
        assert_eq!(small.scene.phases[6].friction, 0.2);
        let failure = sets(&["grains.cuont=500"]).unwrap_err();
        assert_eq!(failure.exit, Exit::Usage);
        assert!(
            failure.to_string().starts_with("s2 with grains.cuont=500: the scene has 1 fault"),
            "{failure}"
        );
        assert!(sets(&["grains"]).unwrap_err().to_string().contains("KEY=VALUE"));
    }

    #[test]
    fn a_start_that_cannot_be_read_names_the_scene() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("mine.toml");
        std::fs::write(&path, "base = 's2'\nname = 'mine'\nstart.packing = 'nothing.csv'").unwrap();
        let failure = load(&path.to_string_lossy(), &[], None).unwrap_err().to_string();
        assert!(
            failure.contains("mine.toml: start.packing: ") && failure.contains("nothing.csv"),
            "{failure}"
        );
    }

    #[test]
    fn hdf5_as_a_scene_or_as_its_start_is_wrong_usage_with_what_to_use_instead() {
        let folder = tempfile::tempdir().unwrap();
        let [hdf5, scene] = ["packing.vtkhdf", "mine.toml"].map(|name| folder.path().join(name));
        std::fs::write(&hdf5, b"\x89HDF\r\n\x1a\n").unwrap();
        std::fs::write(&scene, "base = 's2'\nname = 'mine'\nstart.packing = 'packing.vtkhdf'").unwrap();
        for path in [hdf5, scene] {
            let failure = load(&path.to_string_lossy(), &[], None).unwrap_err();
            assert_eq!(failure.exit, Exit::Usage, "{failure}");
            assert!(failure.to_string().contains("--format csv"), "{failure}");
        }
    }

    #[test]
    fn a_base_is_looked_for_beside_the_file_that_names_it() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| {
            let path = folder.path().join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(&path, text).unwrap();
            path.to_string_lossy().into_owned()
        };
        write("mine.toml", "base = 's2'\nname = 'mine'\ngrains.count = 600");
        let deep = write("deep/er.toml", "base = '../mine.toml'\nname = 'er'");
        assert_eq!(load(&deep, &[], None).unwrap().scene.grains, 600);
        let round = write("round.toml", "base = 'deep/../round.toml'\nname = 'round'");
        let failure = load(&round, &[], None).unwrap_err();
        assert!(failure.exit == Exit::Usage && failure.to_string().contains("circle"), "{failure}");
        let lost = write("lost.toml", "base = 'nowhere.toml'\nname = 'lost'");
        assert!(load(&lost, &[], None).unwrap_err().to_string().contains("no scene \"nowhere.toml\""));
    }
}
