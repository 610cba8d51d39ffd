//! The built-in scenes under LAMMPS.

use super::lammps;
use grainlab_engine::EngineFactory;
use grainlab_experiment::Simulation;
use grainlab_lammps::check_scene;
use grainlab_scene::{BUILT_IN, Scene};
use std::sync::Arc;

fn built_in() -> impl Iterator<Item = (&'static str, Scene)> {
    BUILT_IN
        .into_iter()
        .map(|(name, text)| (name, Scene::parse(text).unwrap_or_else(|e| panic!("{name}: {e}"))))
}

#[test]
fn the_readme_says_which_built_in_scenes_lammps_runs() {
    let row = |(name, scene): (&str, Scene)| match check_scene(&scene) {
        Ok(()) => format!("| {name} | runs |\n"),
        Err(why) => format!("| {name} | {why} |\n"),
    };
    let table: String = built_in().map(row).collect();
    let readme = include_str!("../../README.md");
    assert!(readme.contains(&table), "the table of README.md is out of date; it should be:\n{table}");
    assert!(table.matches("| runs |").count() >= 6);
}

/// Expected: from the gas through the first phases with contacts, with less than a twentieth of the grains of the scene.
#[test]
fn at_least_six_built_in_scenes_run_with_lammps_from_the_gas_into_phases_with_contacts() {
    let Some(lammps) = lammps(1) else { return };
    let factory: Arc<dyn EngineFactory> = Arc::new(lammps);
    for (name, scene) in built_in().filter(|(_, scene)| check_scene(scene).is_ok()) {
        let mut run = Simulation::with_engine(Scene { grains: 60, ..scene }, factory.clone(), None).unwrap();
        let mut exchanges = 0;
        while exchanges < 30 {
            run.exchange().unwrap_or_else(|e| panic!("{name}: {e}"));
            exchanges += u32::from(run.engine().program().is_some());
        }
    }
}
