//! Scenes, calibrations, priors and parameter files.

use fuzzing::{Counting, Target};
use grainlab_node_kit::{Names, ParameterSpec, Parameters, RosArgs};

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Settings have at most a megabyte; their tree is a few times as large.
const MEMORY: (usize, usize) = (1 << 20, 512);

fn run(name: &str, seeds: &[&str], words: &[&str], mut parse: impl FnMut(&str)) {
    Target {
        name,
        seeds: seeds.iter().map(|s| s.as_bytes().to_vec()).collect(),
        words,
        memory: MEMORY,
        decode: &mut |bytes| parse(&String::from_utf8_lossy(bytes)),
    }
    .run();
}

#[test]
fn a_scene_gives_a_scene_or_faults() {
    let seeds = [
        include_str!("../../../nodes/scenes/demo.toml"),
        include_str!("../../../nodes/scenes/s2.toml"),
        include_str!("../../golden/scenes/tiny.toml"),
    ];
    run("scene", &seeds, &["[[phase]]", "grains", "count", "friction", "=", "'"], |text| {
        if let Err(error) = grainlab_scene::Scene::parse(text) {
            assert!(!error.to_string().is_empty());
        }
    });
}

#[test]
fn a_calibration_gives_constants_or_an_error() {
    let seeds: Vec<String> = grainlab_emt::Calibration::BUILTIN
        .iter()
        .map(|name| grainlab_emt::Calibration::builtin(name).unwrap().to_toml().unwrap())
        .collect();
    let seeds: Vec<&str> = seeds.iter().map(String::as_str).collect();
    run("calibration", &seeds, &["name", "=", "[", "]", "[["], |text| {
        drop(grainlab_emt::Calibration::parse(text))
    });
}

#[test]
fn a_prior_gives_densities_or_an_error() {
    let seeds = [
        "[z]\ndistribution = \"truncated-normal\"\nmean = 5.2\nstddev = 0.3\nlow = 4.5\n",
        "[eps]\ndistribution = \"uniform\"\nlow = -0.1\nhigh = 0.2\n[k]\ndistribution = \"normal\"\nmean = 5\nstddev = 1e-3\n",
    ];
    run("prior", &seeds, &["mean", "stddev", "=", "1e308", "-1e-308", "nan"], |text| {
        let Ok(prior) = grainlab_emt::Prior::parse(text) else { return };
        assert_eq!(grainlab_emt::Prior::parse(&prior.to_toml()), Ok(prior.clone()));
        for density in prior.quantities().filter_map(|q| prior.get(q)) {
            let [low, high] = density.range();
            assert!((low..=high).contains(&density.mean()) && density.stddev() >= 0.0, "{density:?}");
        }
    });
}

#[test]
fn a_parameter_file_gives_values_or_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("p.yaml");
    let seeds = [
        "/**:\n  ros__parameters:\n    scene: demo\n    seed: 3\n    rate: 0.5\n    names: [a, b]\n    group:\n      on: true\n",
        "/ns:\n  node:\n    ros__parameters: {seed: &a 1, rate: *a}\n/**:\n  ros__parameters: {scene: \"x y\"}\n",
    ];
    let specs = [
        ParameterSpec::new("scene", "", ""),
        ParameterSpec::new("seed", 1_i64, ""),
        ParameterSpec::new("rate", 1.0, ""),
        ParameterSpec::new("names", Vec::<String>::new(), ""),
        ParameterSpec::new("group.on", false, ""),
    ];
    let names = Names::in_namespace("node", "/ns").unwrap();
    let words = ["ros__parameters", ":", "&a", "*a", "[", "{", "- ", "? ", "!!binary", "<<"];
    run("parameters", &seeds, &words, |text| {
        std::fs::write(&path, text).unwrap();
        let given = ["--ros-args", "--params-file", &path.to_string_lossy()].map(str::to_owned);
        let (arguments, _) = RosArgs::parse(&given).unwrap();
        drop(Parameters::resolve(&specs, "node", &names, &arguments));
        // Decodes the text as the value of one parameter.
        let given = ["--ros-args".to_owned(), "-p".to_owned(), format!("names:={text}")];
        if let Ok((arguments, _)) = RosArgs::parse(&given) {
            drop(Parameters::resolve(&specs, "node", &names, &arguments));
        }
    });
}
