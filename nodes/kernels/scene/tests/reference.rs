//! The page about the format, and the template of a scene.

use grainlab_scene::{Draft, KEYS, Scene, reference, template};

#[test]
fn the_page_beside_the_scenes_is_the_one_written_from_the_keys() {
    let page = include_str!("../../../scenes/README.md");
    assert!(page == reference(), "run `grainlab scene keys > nodes/scenes/README.md`");
    for key in KEYS.iter() {
        assert!(page.contains(&format!("| `{}` |", key.name())), "{} is missing", key.path);
    }
    let longest = page.lines().flat_map(|line| line.split(" | ")).map(str::len).max();
    assert!(longest < Some(200), "a cell of {longest:?} characters");
}

#[test]
fn the_scene_to_start_from_holds() {
    let scene = Scene::parse(&template("mine")).unwrap();
    assert_eq!((scene.name.as_str(), scene.phases.len()), ("mine", 4));
}

#[test]
fn the_example_of_the_page_holds() {
    let page = reference();
    let example = page.split("```toml\n").nth(1).and_then(|rest| rest.split("```").next()).unwrap();
    let scene = Draft::of_text(example).unwrap().resolve().unwrap().scene;
    let names: Vec<&str> = scene.phases.iter().map(|p| p.name.as_str()).collect();
    assert_eq!(names[5..9], ["isotropic", "extend", "triax", "pause"]);
    assert_eq!((scene.grains, scene.phases[1].until.all.len(), scene.phases[8].friction), (500, 1, 0.2));
}
