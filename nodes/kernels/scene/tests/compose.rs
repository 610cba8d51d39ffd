//! Scenes from a base: the composed scenes, and the faults of invalid ones.

use grainlab_core::ComponentControl;
use grainlab_scene::{BUILT_IN, Draft, Phase, Resolved, Scene, SceneError, Source, assignment, built_in};

/// The scenes as written out, without a base.
const FLAT_S2: &str = include_str!("../../../../tests/golden/scenes/flat/s2.toml");
const FLAT_UNIAXIAL: &str = include_str!("../../../../tests/golden/scenes/flat/uniaxial.toml");

/// The files of this test; a base is looked up among them, and among the built-in scenes.
fn compose(files: &[(&str, &str)], name: &str) -> Result<Draft, SceneError> {
    let find = |base: &str| {
        let text = files.iter().find(|(n, _)| *n == base).map(|(_, text)| *text).or(built_in(base));
        text.map(|t| Source { name: base.into(), text: t.into() }).ok_or("there is no such file".to_owned())
    };
    Draft::of(&find(name).unwrap(), &|base, _| find(base))
}

fn scene(files: &[(&str, &str)], name: &str) -> Scene {
    compose(files, name).unwrap().resolve().unwrap().scene
}

fn faults(of: Result<Draft, SceneError>) -> String {
    of.and_then(|draft| draft.resolve()).unwrap_err().to_string()
}

/// A scene without its text: texts of equal scenes may differ.
fn plain(scene: Scene) -> Scene {
    Scene { fingerprint: 0, ..scene }
}

#[test]
fn the_samples_of_the_paper_are_what_they_were_as_whole_files() {
    for (name, mu2) in [("s1", "0.05"), ("s2", "0.1"), ("s3", "0.3"), ("s4", "0.15")] {
        // The lines that set the friction from the extension at constant lateral stress on, the name and the description.
        let mut lines: Vec<String> = FLAT_S2.lines().map(str::to_owned).collect();
        for at in [69, 81, 93, 119, 145, 171] {
            assert_eq!(lines[at - 1], "friction = 0.1");
            lines[at - 1] = format!("friction = {mu2}");
        }
        let flat = lines.join("\n").replace("\"s2\"", &format!("{name:?}")).replace(
            "Sample S2 of the paper: 2000 grains, mu2 = 0.1,",
            &format!("Sample {} of the paper: 2000 grains, mu2 = {mu2},", name.to_uppercase()),
        );
        let flat = plain(Scene::parse(&flat).unwrap());
        assert_eq!(plain(scene(&[], name)), flat, "{name}");
        assert_eq!(plain(Scene::parse(built_in(name).unwrap()).unwrap()), flat);
    }
}

#[test]
fn the_scene_with_resistance_to_rolling_is_the_demo_but_for_its_contact_law() {
    let (rolling, demo) = (scene(&[], "rolling"), scene(&[], "demo"));
    assert!(rolling.law.rolling.is_some() && rolling.law.springs == demo.law.springs);
    let (name, description, law) = (demo.name.clone(), demo.description.clone(), demo.law);
    let fingerprint = demo.fingerprint;
    assert_eq!(Scene { name, description, law, fingerprint, ..rolling }, demo);
}

#[test]
fn the_scenes_of_the_ensembles_are_what_they_were_as_whole_files() {
    let files = [
        ("biaxial.toml", include_str!("../../../scenes/ensemble/biaxial.toml")),
        ("overloaded.toml", include_str!("../../../scenes/ensemble/overloaded.toml")),
        ("isotropic.toml", include_str!("../../../scenes/ensemble/isotropic.toml")),
    ];
    let uniaxial = Scene { name: "s2".into(), description: String::new(), ..scene(&files, "uniaxial") };
    let flat = Scene { description: String::new(), ..Scene::parse(FLAT_UNIAXIAL).unwrap() };
    assert_eq!(plain(uniaxial), plain(flat));
    for (name, flat) in [
        ("biaxial.toml", include_str!("../../../../tests/golden/scenes/flat/biaxial.toml")),
        ("overloaded.toml", include_str!("../../../../tests/golden/scenes/flat/overloaded.toml")),
        ("isotropic.toml", include_str!("../../../../tests/golden/scenes/flat/isotropic.toml")),
    ] {
        assert_eq!(plain(scene(&files, name)), plain(Scene::parse(flat).unwrap()), "{name}");
        // `vary` of a campaign sets the lines marked mu2.
        let mut draft = compose(&files, name).unwrap();
        draft.set(assignment("friction=0.3").unwrap()).unwrap();
        let turned: Vec<&str> =
            flat.lines().map(|line| if line.ends_with("# mu2") { "friction = 0.3" } else { line }).collect();
        let turned = Scene::parse(&turned.join("\n")).unwrap();
        let description = [&turned.description, ", with friction=0.3"].concat();
        let varied = draft.resolve().unwrap().scene;
        assert_eq!(plain(varied), plain(Scene { description, ..turned }), "{name}");
    }
}

#[test]
fn the_canonical_text_of_a_scene_means_the_same_and_is_its_own() {
    for (name, text) in BUILT_IN {
        let resolved = compose(&[], name).unwrap().resolve().unwrap();
        let again = Draft::of_text(&resolved.toml).unwrap().resolve().unwrap();
        assert_eq!(again, resolved, "{name}");
        assert_eq!(resolved.scene, Scene::parse(text).unwrap());
    }
    let awkward = "name = 'x'\ndescription = \"two\\nlines and a \\\" quote\"\nfriction = inf\n\
        [grains]\ncount = 2\ndiameter = 1.2345678901234567e-4\n\
        [[phase]]\nkind = 'gas'\nmethod = 'soft'\nrate = -1e-300\nuntil = { elapsed = 1e-6 }\n\
        [[phase]]\nkind = 'cycle'\nname = 'c'\ntimes = 3\n\
        [[phase.phase]]\nkind = 'servo'\nname = 'a'\nlaw = 'integral'\ngain = 1e-3\n\
        control = { xx = { stress = 1e5 }, xy = { rate = -0.5 } }\nuntil = { on_target = 0.1, strain = { xx = -1 } }\n\
        [[phase.phase]]\nkind = 'strain'\nrate = [0, 0, 1, 0, 0, 1e22]\nfriction = 0.5\nuntil = { elapsed = 0.5 }\n";
    let resolved = Draft::of_text(awkward).unwrap().resolve().unwrap();
    let again = Draft::of_text(&resolved.toml).unwrap_or_else(|e| panic!("{e}\n{}", resolved.toml));
    assert_eq!(again.resolve().unwrap(), resolved, "{}", resolved.toml);
}

#[test]
fn bases_form_a_chain_in_which_the_last_value_wins() {
    let files = [
        ("a", "base = 'demo'\nname = 'a'\ngrains.count = 300\nphase.rest.drag = 1e3"),
        ("b", "base = 'a'\nname = 'b'\nphase.rest.drag = 5e2\nphase.settle.until.hold = 'unset'"),
    ];
    let (demo, b) = (scene(&[], "demo"), scene(&files, "b"));
    assert_eq!((b.name.as_str(), b.grains, b.phases[1].drag), ("b", 300, 5e2));
    assert_eq!((demo.phases[9].until.hold, b.phases[9].until.hold), (1e-5, 0.0));
    assert_eq!((b.phases[9].until.all.clone(), b.sizes), (demo.phases[9].until.all.clone(), demo.sizes));
}

#[test]
fn phases_are_changed_by_name_left_out_and_added() {
    let names = |s: &Scene| s.phases.iter().map(|p| p.name.clone()).collect::<Vec<_>>();
    let a = "base = 'demo'\nname = 'a'\nremove = ['ext*', '*-*', 'triax', 'load']\n\
             phase.'*s*t*'.control_period = 7\n\
             [[append]]\nafter = 'rest'\nkind = 'relax'\nname = 'one'\nuntil.elapsed = 1e-6\n\
             [[append]]\nafter = 'rest'\nkind = 'relax'\nname = 'two'\nuntil.elapsed = 1e-6\n\
             [[append]]\nkind = 'relax'\nname = 'end'\nuntil.elapsed = 1e-6\n";
    let a = scene(&[("a", a)], "a");
    assert_eq!(names(&a), ["gas", "rest", "one", "two", "isotropic", "settle", "end"]);
    let periods: Vec<u32> = a.phases.iter().map(|p| p.control_period).collect();
    assert_eq!(periods, [20, 7, 10, 10, 7, 7, 10]);
    let whole = "base = 'demo'\nname = 'b'\n[[phase]]\nkind = 'gas'\nrate = -1\nuntil.elapsed = 1e-6\n\
                 [[phase]]\nkind = 'relax'\nuntil.elapsed = 1e-6\n";
    assert_eq!(names(&scene(&[("b", whole)], "b")), ["gas", "relax"]);
}

#[test]
fn phases_within_a_cycle_are_found_by_name_too() {
    let cyclic = "base = 'demo'\nname = 'c'\nfriction = 0.1\n[[phase]]\nkind = 'gas'\nrate = -1\nuntil.elapsed = 1e-6\n\
        [[phase]]\nkind = 'cycle'\ntimes = 2\n[[phase.phase]]\nkind = 'relax'\nname = 'in'\nuntil.elapsed = 1e-6\n";
    let over = "base = 'c'\nname = 'd'\nphase.in.drag = 3\nphase.cycle.times = 1\n\
        [[append]]\nafter = 'in'\nkind = 'relax'\nname = 'next'\nuntil.elapsed = 0.5\n";
    let d = scene(&[("c", cyclic), ("d", over)], "d");
    let phases: Vec<(&str, f64)> = d.phases.iter().map(|p| (p.name.as_str(), p.drag)).collect();
    assert_eq!(phases, [("gas", 0.0), ("in#1", 3.0), ("next#1", 0.0)]);
}

#[test]
fn a_component_of_a_servo_is_one_value() {
    let set = "phase.load.control={xx={rate=-1},yy='held'}";
    let toml = with("demo", set).unwrap().toml;
    let expected = "control = { xx = { rate = -1.0 }, yy = \"held\", zz = { stress = 50000.0 }, ";
    assert!(toml.contains(expected), "{toml}");
}

#[test]
fn a_circle_of_bases_is_named_and_so_is_a_base_that_is_not_there() {
    let files = [("a", "base = 'b'"), ("b", "base = 'c'"), ("c", "base = 'b'"), ("d", "base = 'nowhere'")];
    let circle = faults(compose(&files, "a"));
    assert!(circle.contains("base: is a circle: a -> b -> c -> b"), "{circle}");
    let missing = faults(compose(&files, "d"));
    assert!(missing.contains("base: is \"nowhere\": there is no such file"), "{missing}");
    assert!(faults(compose(&[("e", "base = 5")], "e")).contains("base: is 5; it must be"));
}

#[test]
fn an_unknown_key_is_named_with_a_suggestion() {
    for (text, expected) in [
        ("grains.cuont=500", "grains.cuont: unknown key (did you mean count?)"),
        ("count=500", "count: unknown key (did you mean grains.count?)"),
        ("drag=1", "drag: unknown key (did you mean phase.NAME.drag?)"),
        (
            "contact.normal_stiffness=1e4",
            "contact.normal_stiffness: is not taken here: needs law = \"linear\"; ",
        ),
        ("grain.count=500", "grain: unknown key (did you mean grains?)"),
        ("grains.count=0", "grains.count: is 0; it must be a whole number from 1 to 10000000"),
        ("grains.count=many", "grains.count: is \"many\"; it must be a whole number from 1 to 10000000"),
        (
            "phase.rset.drag=1",
            "phase.rset: no phase is named \"rset\" (did you mean rest?); there are: gas, rest, ",
        ),
        ("phase.rest.drag=-1", "phase[1] (rest).drag: is -1; it must be a number in 1/s, 0 or more"),
        ("phase.rest.darg=1", "phase[1] (rest).darg: unknown key (did you mean drag?)"),
        ("phase.rest.until.sped=1", "phase[1] (rest).until.sped: unknown key (did you mean speed?)"),
        (
            "phase.rest.frction=unset",
            "phase.rest.frction: is unset, but there is none (did you mean friction?)",
        ),
        ("material.poisson_ratio=0.6", "material.poisson_ratio: is 0.6; it must be a number, from 0 to 0.5"),
    ] {
        let found = with("s2", text).unwrap_err().to_string();
        assert!(found.contains(expected), "{text}: {found}");
    }
}

#[test]
fn a_friction_that_no_phase_takes_is_a_fault() {
    let error = with("demo", "phase.*.friction=0.3 friction=0.2").unwrap_err().to_string();
    assert!(error.contains("friction: is taken by no phase"), "{error}");
    let phases = with("demo", "phase.*.friction=0.3").unwrap().scene.phases;
    assert!(phases[1..].iter().all(|p| p.friction == 0.3), "that of every phase replaces that of the scene");
}

/// A built-in scene with keys set one after another.
fn with(name: &str, sets: &str) -> Result<Resolved, SceneError> {
    let mut draft = compose(&[], name)?;
    sets.split(' ').try_for_each(|set| draft.set(assignment(set)?))?;
    draft.resolve()
}

#[test]
fn a_star_reaches_every_phase_that_has_the_key_and_no_other() {
    let phases = |set| with("demo", set).unwrap().scene.phases;
    let drags: Vec<f64> = phases("phase.*.drag=7").iter().map(|p| p.drag).collect();
    assert_eq!((drags[0], &drags[1..]), (0.0, &[7.0; 9][..]), "an event-driven gas has no drag");
    let limits = phases("phase.*.rate_limit=5");
    assert_eq!(limits.iter().filter(|p| p.kind.rate_limit() == Some(5.0)).count(), 5);
    let conditions = |phases: Vec<Phase>| phases.iter().map(|p| p.until.all.len()).sum::<usize>();
    let all = conditions(scene(&[], "demo").phases);
    assert_eq!(conditions(phases("phase.*.until.unbalanced=1e-2")), all);
    assert_eq!(conditions(phases("phase.*.until.unbalanced=unset")), all - 3);
    for (set, hint) in [
        ("phase.*.darg=1", " (did you mean drag?)"),
        ("phase.*.until.deviator_above=1", ""),
        ("phase.*.times=2", ""),
        ("phase.r*.rate_limit=1", ""),
    ] {
        let (found, key) = (with("demo", set).unwrap_err().to_string(), set.split('=').next().unwrap());
        assert!(found.contains(&format!("{key}: no phase of this pattern has the key{hint};")), "{found}");
    }
}

#[test]
fn a_pressure_is_that_of_every_phase_that_holds_one_and_of_the_bounds_that_equal_it() {
    let body = |toml: &str| toml.split_once("seed").unwrap().1.to_owned();
    let pressed = "phase.pure-shear.until.pressure_above=50e3";
    let own = with("demo", pressed).unwrap().toml;
    let changed = body(&with("demo", &format!("{pressed} pressure=2e5")).unwrap().toml);
    assert_eq!(changed, body(&own.replace("50000.0", "200000.0")), "as written out by hand");
    assert!(changed.contains("pressure_below = 10.0") && changed.contains("pressure_above = 200000.0"));
    let over = with("demo", "pressure=20e3 phase.load.control.zz.stress=70e3").unwrap().scene;
    assert_eq!(over.phases[8].controls()[1..3], [20e3, 70e3].map(ComponentControl::Stress));
    for (sets, expected) in [
        ("pressure=-1", "pressure: is -1; it must be a number in Pa, more than 0"),
        (
            "phase.triax.until.pressure_above=40e3 pressure=2e5",
            "of 40000 Pa, beside 50000 Pa elsewhere, in phase.triax.until.pressure_above;",
        ),
        ("phase.load.control.zz.stress=60e3 pressure=2e5", "50000 Pa in isotropic, 60000 Pa in load;"),
        ("phase.load.control.xy.stress=10e3 pressure=2e5", "in phase.load.control.xy.stress;"),
        ("phase.load.name=load-50kPa pressure=2e5", "is not that in the name of phase load-50kPa"),
        ("remove=['isotropic','extend','triax','load','settle'] pressure=2e5", "the scene has none"),
        ("pressure=2e5 pressure=unset", "pressure: is unset, but there is none"),
    ] {
        let found = with("demo", sets).unwrap_err().to_string();
        assert!(found.contains(expected), "{sets}: {found}");
    }
}

#[test]
fn what_changes_a_base_needs_one() {
    let error = Scene::parse("name = 'x'\nremove = ['rest']\nphase.rest.drag = 1").unwrap_err().to_string();
    assert!(error.contains("remove: changes a base, and this scene has none"), "{error}");
    assert!(error.contains("phase: is a table; it must be an array of tables"), "{error}");
}

#[test]
fn a_description_is_followed_by_the_keys_that_are_set_and_by_no_seed_or_name() {
    let mut draft = compose(&[], "demo").unwrap();
    let own = draft.resolve().unwrap().scene.description;
    for set in ["seed=7", "name=small", "grains.count=200", "phase.rest.drag=1e3"] {
        draft.set(assignment(set).unwrap()).unwrap();
    }
    let resolved = draft.resolve().unwrap();
    assert_eq!(resolved.scene.description, format!("{own}, with grains.count=200, phase.rest.drag=1000.0"));
    assert_eq!(Scene::parse(&resolved.toml).unwrap(), resolved.scene);
}
