//! Valid and invalid scenes.

use grainlab_core::contact::{ContactLaw, RollingResistance};
use grainlab_core::{Cell, ComponentControl, Contact, Material, Packing, ServoLaw, SymTensor, Vec3};
use grainlab_scene::{
    Condition, Draft, GasMethod, Measure, Observation, PathState, PhaseEnded, PhaseKind, Record, Scene,
    Sizes, Species, assignment,
};

const GOOD: &str = r#"
name = "tiny"
seed = 7
[grains]
count = 100
diameter = 2e-4
[[phase]]
kind = "gas"
rate = -12.0
until = { solid_fraction = 0.6 }
[[phase]]
kind = "relax"
name = "rest"
friction = 0.0
reference = true
until = { speed = 1e-3, hold = 1e-4 }
[[phase]]
kind = "cycle"
times = 2
[[phase.phase]]
kind = "strain"
name = "unload"
friction = 0.1
rate = [0, 0, 4.0, 0, 0, 0]
until = { strain = { zz = 0.002 } }
[[phase.phase]]
kind = "servo"
name = "reload"
friction = 0.1
response_time = 2e-5
control = { xx = { stress = 50e3 }, yy = { stress = 50e3 }, zz = { stress = 50e3 }, xy = { rate = 0.5 } }
publish = true
until = { on_target = 1e-3, unbalanced = 1e-6, timeout = 0.5 }
"#;

fn seen(time: f64) -> Observation {
    Observation {
        time,
        stress: SymTensor::isotropic(50e3),
        strain: SymTensor::default(),
        solid_fraction: 0.5,
        unbalanced: 1.0,
        speed: 1.0,
    }
}

#[test]
fn cycles_unroll_into_numbered_phases() {
    let scene = Scene::parse(GOOD).unwrap();
    let names: Vec<&str> = scene.phases.iter().map(|p| p.name.as_str()).collect();
    assert_eq!(names, ["gas", "rest", "unload#1", "reload#1", "unload#2", "reload#2"]);
    assert_eq!(scene.phases[2].until.all, [Condition::AtLeast(Measure::Strain(2), 0.002)]);
    let PhaseKind::Servo { controls, .. } = &scene.phases[3].kind else { panic!("a servo phase") };
    assert_eq!(controls[0], ComponentControl::Stress(50e3));
    assert_eq!(controls[3], ComponentControl::Held);
    assert_eq!(controls[5], ComponentControl::StrainRate(0.5));
}

#[test]
fn a_servo_phase_is_normalised_and_damped_by_default() {
    let law = |keys: &str| {
        let text = GOOD.replace("response_time = 2e-5", keys);
        match Scene::parse(&text)?.phases.swap_remove(3).kind {
            PhaseKind::Servo { law, .. } => Ok(law),
            other => panic!("a servo phase: {other:?}"),
        }
    };
    assert_eq!(law(""), Ok(ServoLaw::Normalised { share: 0.3, leak: 0.01 }));
    let chosen = ServoLaw::Normalised { share: 0.1, leak: 0.05 };
    assert_eq!(law("law = 'normalised'\ngain_share = 0.1\nleak = 0.05"), Ok(chosen));
    assert_eq!(law("response_time = 2e-5"), Ok(ServoLaw::Scaled { response_time: 2e-5 }));
    assert_eq!(law("law = 'integral'\ngain = 1e-3"), Ok(ServoLaw::Integral { gain: 1e-3, leak: 0.0 }));
    for (wrong, place) in [
        ("gain_share = 1.0", "gain_share"),
        ("gain = 1e-3", "gain"),
        ("law = 'integral'\ngain = 1e-3\nresponse_time = 1e-5", "response_time"),
        ("law = 'scaled'", "response_time"),
    ] {
        let error: grainlab_scene::SceneError = law(wrong).unwrap_err();
        assert!(error.faults.iter().any(|f| f.place.ends_with(place)), "{wrong}: {error}");
    }
}

/// The text of the scene in a recording states every default that was in force.
#[test]
fn the_full_text_of_a_scene_states_its_leak_so_that_a_run_continues_under_the_one_it_began_with() {
    let full = |keys: &str| {
        let text = GOOD.replace("response_time = 2e-5", keys);
        Draft::of_text(&text).unwrap().resolve().unwrap().toml
    };
    for (keys, line) in [
        ("", "leak = 0.01\n"),
        ("leak = 0.0", "leak = 0.0\n"),
        ("law = 'integral'\ngain = 1e-3", "leak = 0.0\n"),
    ] {
        let text = full(keys);
        assert!(text.contains(line), "{keys}: {text}");
        assert_eq!(Draft::of_text(&text).unwrap().resolve().unwrap().toml, text);
    }
}

#[test]
fn spins_are_damped_where_grains_are_to_come_to_rest_unless_the_scene_says_otherwise() {
    let drags = |text: &str| -> Vec<f64> {
        Scene::parse(text).unwrap().phases[..4].iter().map(|p| p.spin_drag).collect()
    };
    // √(G/ρ)/(1000 d) of glass: gas, relax, strain, servo.
    let expected = (29e9f64 / 2500.0).sqrt() / 0.2;
    for (found, expected) in drags(GOOD).iter().zip([0.0, expected, 0.0, expected]) {
        assert!((found - expected).abs() <= 1e-9 * expected, "{found} {expected}");
    }
    let larger = GOOD.replace("diameter = 2e-4", "diameter = 2e-3\n[material]\ndensity = 1e4");
    assert!((drags(&larger)[3] / expected - 0.05).abs() < 1e-12);
    let own = GOOD.replace("response_time", "spin_drag = 0\nresponse_time");
    assert_eq!(drags(&own)[3], 0.0);
}

#[test]
fn every_fault_is_reported_at_once_with_its_place() {
    let bad = GOOD
        .replace("diameter = 2e-4", "diameter = -1\ncolour = 'red'")
        .replace("name = \"unload\"\nfriction = 0.1", "name = \"unload\"\nfriction = -0.1")
        .replace("rate = -12.0", "rate = 12.0")
        .replace("times = 2", "times = 0")
        .replace("hold = 1e-4", "hold = 'long'");
    let error = Scene::parse(&bad).unwrap_err();
    let places: Vec<&str> = error.faults.iter().map(|f| f.place.as_str()).collect();
    for place in [
        "grains.diameter",
        "grains.colour",
        "phase[0].rate",
        "phase[1] (rest).until.hold",
        "phase[2].times",
        "phase[2].phase[0] (unload).friction",
    ] {
        assert!(places.contains(&place), "{place} is missing from\n{error}");
    }
    assert_eq!(error.faults.len(), 6, "{error}");
}

#[test]
fn a_gas_is_event_driven_by_default() {
    let method = |text: &str| match Scene::parse(text).unwrap().phases[0].kind {
        PhaseKind::Gas { method, .. } => method,
        _ => panic!("a gas phase"),
    };
    assert_eq!(method(GOOD), GasMethod::EventDriven);
    let soft = GOOD.replace("rate = -12.0", "rate = -12.0\nmethod = 'soft'\ndamping = 0.01");
    assert_eq!(method(&soft), GasMethod::Soft);
    let other = Scene::parse(&soft.replace("'soft'", "'lattice'")).unwrap_err().to_string();
    assert!(
        other.contains("phase[0].method: is \"lattice\"; it must be \"event_driven\" or \"soft\""),
        "{other}"
    );
}

#[test]
fn an_event_driven_gas_refuses_what_needs_the_contact_law() {
    let text = GOOD.replace("rate = -12.0", "rate = -12.0\ndamping = 0.002\nfriction = 0.1").replace(
        "until = { solid_fraction = 0.6 }",
        "until = { solid_fraction = 0.6, pressure_above = 1e3 }",
    );
    let error = Scene::parse(&text).unwrap_err();
    let places: Vec<&str> = error.faults.iter().map(|f| f.place.as_str()).collect();
    assert_eq!(places, ["phase[0].friction", "phase[0].damping", "phase[0].until"], "{error}");
    assert!(error.to_string().contains("elastic and frictionless"), "{error}");
    assert!(Scene::parse(&text.replace("rate = -12.0", "rate = -12.0\nmethod = 'soft'")).is_ok());
}

#[test]
fn invalid_toml_is_refused_with_its_line() {
    let error = Scene::parse("name = \n").unwrap_err();
    assert!(error.to_string().contains("line 1"), "{error}");
}

#[test]
fn a_phase_ends_only_after_its_conditions_held_for_the_hold_time() {
    let scene = Scene::parse(GOOD).unwrap();
    let mut state = PathState { phase: 1, began: 1.0, holding_since: None };
    let at = |time: f64, speed: f64| Observation { speed, ..seen(time) };
    assert_eq!(state.observe(&scene, &at(1.0, 1e-4)), Ok(None));
    // The condition fails once: the hold time restarts.
    assert_eq!(state.observe(&scene, &at(1.00005, 1.0)), Ok(None));
    assert_eq!(state.observe(&scene, &at(1.00009, 1e-4)), Ok(None));
    assert_eq!(state.observe(&scene, &at(1.00015, 1e-4)), Ok(None));
    let ended = PhaseEnded { reference: true, publish: false, finished: false };
    assert_eq!(state.observe(&scene, &at(1.00020, 1e-4)), Ok(Some(ended)));
    assert_eq!(state, PathState { phase: 2, began: 1.00020, holding_since: None });
}

#[test]
fn the_last_phase_finishes_the_path_and_a_timeout_names_what_was_not_met() {
    let scene = Scene::parse(GOOD).unwrap();
    let mut state = PathState { phase: 5, began: 2.0, holding_since: None };
    let off = Observation { unbalanced: 1e-3, ..seen(2.6) };
    let timeout = state.observe(&scene, &off).unwrap_err().to_string();
    assert!(timeout.starts_with("phase 6 (") && timeout.contains("unbalanced is "), "{timeout}");
    assert!(!timeout.contains("target"), "{timeout}");
    // As it is printed, the value is beyond its bound.
    let limit = Observation { unbalanced: 1.000_000_1e-6, ..seen(2.4) };
    let printed = state.unmet(&scene, &limit);
    assert!(printed.starts_with("unbalanced is 1.0000001e-6, above 1e-6"), "{printed}");
    let on = Observation { unbalanced: 1e-7, ..seen(2.4) };
    let ended = PhaseEnded { reference: false, publish: true, finished: true };
    assert_eq!(state.observe(&scene, &on), Ok(Some(ended)));
    assert!(state.phase(&scene).is_none());
}

#[test]
fn a_stress_that_misses_its_target_is_named_with_its_value_and_with_what_to_change() {
    let stress = SymTensor::from_voigt([50e3, 50e3, 51e3, 0.0, 0.0, 0.0]);
    let late = Observation { unbalanced: 1e-7, stress, ..seen(2.6) };
    let failed = |keys: &str| {
        let scene = Scene::parse(&GOOD.replace("response_time = 2e-5", keys)).unwrap();
        let mut state = PathState { phase: 3, began: 2.0, holding_since: None };
        state.observe(&scene, &late).unwrap_err().to_string()
    };
    let normalised = failed("leak = 0.005");
    let named = "stress zz is 5.1000e4 Pa for 5e4 Pa, off target by 2.0000e-2, above 1e-3; ";
    assert!(normalised.contains(named), "{normalised}");
    let advice = "raise the leak of the phase, 0.005 now, lower its rate_limit, or take law = \"scaled\"";
    assert!(normalised.contains(advice), "{normalised}");
    // The scaled law has no leak and does not swing.
    let scaled = failed("response_time = 2e-5");
    assert!(scaled.contains(named) && !scaled.contains("leak"), "{scaled}");
}

#[test]
fn the_share_of_a_phase_is_known_where_imposed_rates_and_time_alone_end_it() {
    let scene = Scene::parse(GOOD).unwrap();
    let share = |phase, seen: &Observation| {
        PathState { phase, began: 1.0, holding_since: None }.phase_share(&scene, seen)
    };
    // At 12 1/s from a solid fraction of 0.3, 0.6 is reached after ln 2 / 36 s; half of it is sqrt 2 times 0.3.
    let end = 2.0_f64.ln() / 36.0;
    let half = Observation { solid_fraction: 0.3 * 2.0_f64.sqrt(), ..seen(1.0 + 0.5 * end) };
    assert!((share(0, &half).unwrap() - 0.5).abs() < 1e-12);
    // A strain of 0.002 at 4 1/s.
    let strained = |zz: f64| SymTensor::from_voigt([0.0, 0.0, zz, 0.0, 0.0, 0.0]);
    let quarter = Observation { strain: strained(0.0005), ..seen(1.0 + 0.0005 / 4.0) };
    assert!((share(2, &quarter).unwrap() - 0.25).abs() < 1e-12);
    let over = Observation { strain: strained(0.002), ..seen(1.0 + 0.002 / 4.0) };
    assert_eq!(share(2, &over), Some(1.0));
    // A speed and an unbalanced force are answers of the packing, also where they hold at present.
    assert_eq!(share(1, &Observation { speed: 0.0, ..seen(1.1) }), None);
    assert_eq!(share(3, &Observation { unbalanced: 0.0, ..seen(1.1) }), None);
    assert_eq!(share(6, &seen(1.1)), None, "the path is done");
}

#[test]
fn the_time_for_which_conditions_must_hold_is_a_part_of_the_phase() {
    let text = GOOD.replace("speed = 1e-3, hold = 1e-4", "elapsed = 3e-4, hold = 1e-4");
    let scene = Scene::parse(&text).unwrap();
    let share = |time, holding_since| {
        PathState { phase: 1, began: 0.0, holding_since }.phase_share(&scene, &seen(time)).unwrap()
    };
    assert!((share(1e-4, None) - 0.25).abs() < 1e-12);
    assert!((share(3.5e-4, Some(3e-4)) - 0.875).abs() < 1e-12);
}

#[test]
fn grains_have_one_size_or_a_law() {
    let of =
        |diameter: &str| Scene::parse(&GOOD.replace("diameter = 2e-4", &format!("diameter = {diameter}")));
    let sizes = |diameter: &str| of(diameter).unwrap().sizes;
    assert_eq!(sizes("2e-4"), Sizes::Equal(2e-4));
    assert_eq!(sizes("{ min = 1e-4, max = 2e-4 }"), Sizes::Uniform { min: 1e-4, max: 2e-4 });
    assert_eq!(sizes("{ median = 2e-4, spread = 0.2 }"), Sizes::Lognormal { median: 2e-4, spread: 0.2 });
    let two = "[{ diameter = 1e-4, share = 3 }, { diameter = 2e-4, share = 1 }]";
    let species = |diameter, share| Species { diameter, share };
    assert_eq!(sizes(two), Sizes::Mixture(vec![species(1e-4, 0.75), species(2e-4, 0.25)]));
    // Counts are those of the list, or equal to its sum.
    let list = "[{ diameter = 1e-4, count = 30 }, { diameter = 2e-4, count = 70 }]";
    assert_eq!(sizes(list), Sizes::Mixture(vec![species(1e-4, 0.3), species(2e-4, 0.7)]));
    let without = GOOD.replace("count = 100\ndiameter = 2e-4", &format!("diameter = {list}"));
    assert_eq!(Scene::parse(&without).unwrap().grains, 100);
    for (wrong, expected) in [
        ("[{ diameter = 1e-4, count = 30 }]", "count: is 100, but the counts in diameter sum to 30"),
        ("{ min = 2e-4, max = 1e-4 }", "diameter: is a table; it must be a length above 0"),
        ("{ min = 1e-6, max = 1e-4 }", "a factor of 100.0; at most 20"),
        ("[{ diameter = 1e-4, share = -1 }]", "diameter: is an array; it must be"),
        ("[]", "diameter: is an array; it must be"),
        ("-1", "diameter: is -1; it must be a length above 0"),
    ] {
        let error = of(wrong).unwrap_err().to_string();
        assert!(error.contains(expected), "{wrong}: {error}");
    }
}

#[test]
fn a_phase_records_packings_by_steps_by_strain_or_by_time() {
    let of = |record: &str| {
        Scene::parse(&GOOD.replace("name = \"unload\"", &format!("name = \"unload\"\nrecord = {record}")))
    };
    let record = |text: &str| of(text).unwrap().phases[2].record;
    assert_eq!(record("{ every_strain = 1e-3 }"), Some(Record::EveryStrain(1e-3)));
    assert_eq!(record("{ every_steps = 500 }"), Some(Record::EverySteps(500)));
    assert_eq!(record("{ every_time = 1e-6 }"), Some(Record::EveryTime(1e-6)));
    assert_eq!(Scene::parse(GOOD).unwrap().phases[2].record, None);
    for wrong in ["{}", "{ every_strain = 1e-3, every_time = 1e-6 }", "{ every_strain = 0 }", "5"] {
        let error = of(wrong).unwrap_err().to_string();
        assert!(error.contains("(unload).record"), "{wrong}: {error}");
    }
}

#[test]
fn a_run_that_starts_from_a_packing_takes_its_grains_and_its_material() {
    let (head, rest) = (
        "name = 'x'\n[start]\npacking = 'p.csv'\n",
        "[[phase]]\nkind = 'relax'\nfriction = 0.1\nuntil = { elapsed = 1e-6 }\n",
    );
    let packing = pair();
    let of = |text: &str| Draft::of_text(text).unwrap().resolve_from(&packing);
    let scene = of(&format!("{head}{rest}")).unwrap().scene;
    assert!(scene.grains == 2 && (scene.sizes.mean() - 3e-4).abs() < 1e-18);
    assert_eq!((scene.material, scene.start.unwrap().packing.as_str()), (packing.material, "p.csv"));
    let gas = "[[phase]]\nkind = 'gas'\nrate = -1\nuntil = { elapsed = 1e-6 }\n";
    for (text, expected) in [
        (format!("{head}[grains]\ncount = 2\n{rest}"), "grains: is there, but the grains are those"),
        (format!("{head}[material]\ndensity = 3000\n{rest}"), "material.density: is 3000, but the packing"),
        (format!("{head}{gas}{rest}"), "a path that starts from a packing has no gas phase"),
        (format!("{head}{}", rest.replace("0.1", "0.0")), "has no friction, and the packing"),
    ] {
        let error = of(&text).unwrap_err().to_string();
        assert!(error.contains(expected), "{text}: {error}");
    }
    // Keys of the table are refused where the packing is known and where the command line sets them.
    let mut draft = Draft::of_text(&format!("{head}foo = 3\n{rest}")).unwrap();
    draft.start_at("/whole/p.csv", None, 5);
    let unknown = draft.resolve_from(&packing).unwrap_err().to_string();
    assert!(unknown.contains("start.foo: unknown key"), "{unknown}");
    let mut draft = Draft::of_text(&format!("{head}{rest}")).unwrap();
    draft.set(assignment("start.contact_columns=[\"a\"]").unwrap()).unwrap();
    draft.start_at("/whole/p.csv", None, 5);
    let columns = draft.resolve_from(&packing).unwrap_err().to_string();
    assert!(columns.contains("start.contact_columns: is an array; it must be"), "{columns}");
    let mut draft = Draft::of_text(&format!("{head}contact_forces = 'f.dump'\n{rest}")).unwrap();
    draft.set(assignment("start.contact_columns=['a','b','x','y','z']").unwrap()).unwrap();
    let file = draft.start().unwrap();
    let forces = (file.contact_forces.as_deref(), draft.source_of("contact_forces"));
    assert_eq!(forces, (Some("f.dump"), Some("scene")));
    assert_eq!(file.contact_columns, ["a", "b", "x", "y", "z"]);
    draft.start_at("/whole/p.csv", Some("/whole/f.dump"), 5);
    let first = draft.resolve_from(&packing).unwrap();
    let again = Draft::of_text(&first.toml).unwrap().resolve_from(&packing).unwrap();
    assert_eq!(again.scene.start, first.scene.start);
    assert_eq!(first.scene.start.unwrap().contact_forces.as_deref(), Some("/whole/f.dump"));
    let other =
        Packing { contacts: vec![Contact { normal_force: 2e-4, ..packing.contacts[0] }], ..packing.clone() };
    let own = Draft::of_text(&format!("{head}{rest}")).unwrap();
    let error = own.resolve_from(&other).unwrap_err().to_string();
    assert!(error.contains("start.packing: normal forces of the packing differ by"), "{error}");
    let unread = Scene::parse(&format!("{head}{rest}")).unwrap_err().to_string();
    assert!(unread.contains("start: names a packing, which has not been read"), "{unread}");
}

/// A scene with these lines in its table of the contact law.
fn with_contact(lines: &str) -> Result<Scene, grainlab_scene::SceneError> {
    Scene::parse(&format!("{GOOD}\n[contact]\n{lines}\n"))
}

#[test]
fn every_contact_law_is_read_by_its_own_parameters() {
    for law in ContactLaw::examples() {
        let keys = law.springs.parameter_list().iter().chain(&RollingResistance::PARAMETERS);
        let pairs = keys.zip(law.parameters()).map(|(key, value)| format!("{} = {value:?}", key.key));
        let lines =
            [format!("law = '{}'", law.name())].into_iter().chain(pairs).collect::<Vec<_>>().join("\n");
        let scene = with_contact(&lines).unwrap();
        assert_eq!(scene.law, law, "{lines}");
        let text = format!("{GOOD}\n[contact]\n{lines}\n");
        let canonical = Draft::of_text(&text).unwrap().resolve().unwrap().toml;
        assert_eq!(Scene::parse(&canonical).unwrap().law, law, "the canonical text means the same");
    }
}

#[test]
fn resistance_to_rolling_needs_a_stiffness_and_a_friction_and_may_lack_a_dashpot() {
    let undamped = RollingResistance { stiffness: 1e4, damping: 0.0, friction: 0.1 };
    let read = with_contact("rolling_stiffness = 1e4\nrolling_friction = 0.1").unwrap();
    assert_eq!(read.law, ContactLaw::default().with_rolling(undamped));
    for (wrong, place) in [
        ("rolling_stiffness = 1e4", "contact.rolling_friction"),
        ("rolling_friction = 0.1", "contact.rolling_stiffness"),
        ("rolling_damping = 1e-3", "contact.rolling_friction"),
        ("rolling_stiffness = 1e4\nrolling_friction = 0.0", "contact.rolling_friction"),
        (
            "rolling_stiffness = 1e4\nrolling_friction = 0.1\nrolling_damping = -1.0",
            "contact.rolling_damping",
        ),
        ("normal_stiffness = 1e4", "contact.normal_stiffness"),
    ] {
        let error = with_contact(wrong).unwrap_err();
        assert!(error.faults.iter().any(|f| f.place == place), "{wrong}: {error}");
    }
}

/// Two unequal grains that touch, with a tangential force.
fn pair() -> Packing {
    let overlap = 1e-8;
    let force = Material::GLASS.normal_force(1e-4 * 2e-4 / 3e-4, overlap);
    let pressed = Contact::pressed([0, 1], [0; 3], Vec3::x(), overlap, force);
    let contact = Contact { tangential_force: Vec3::y() * 1e-6, ..pressed };
    Packing {
        contacts: vec![contact],
        material: Material { density: 2000.0, ..Material::GLASS },
        friction: 0.3,
        ..Packing::at_rest(
            Cell::cube(1e-3).unwrap(),
            vec![1e-4, 2e-4],
            vec![Vec3::zeros(), Vec3::x() * (3e-4 - overlap)],
        )
    }
}

#[test]
fn copies_ask_for_at_most_the_grains_of_a_run() {
    let start = |copies| grainlab_scene::Start {
        packing: "p.csv".into(),
        contact_forces: None,
        contact_columns: Vec::new(),
        step: None,
        copies,
    };
    let asked = |copies, grains| start(copies).grains_of_copies(grains);
    assert_eq!((asked(1, 20_000_000), asked(27, 500)), (Ok(20_000_000), Ok(9_841_500)));
    for (copies, grains, words) in [
        (
            100,
            500,
            "is 100, which asks for 500000000 grains, 100 cubed times the 500 of the packing; a run has at most 10000000",
        ),
        (28, 500, "at most 27 copies fit"),
        (2, 9_000_000, "at most 1 copies fit"),
        (101, 1, "is 101; it must be a whole number from 1 to 100"),
        (u32::MAX, 1, "it must be a whole number from 1 to 100"),
    ] {
        let fault = asked(copies, grains).unwrap_err();
        assert!(fault.place == "start.copies" && fault.message.contains(words), "{fault}");
    }
}

#[test]
fn a_number_with_a_decimal_point_is_told_from_a_whole_number() {
    let fault = |from: &str, to: &str| Scene::parse(&GOOD.replace(from, to)).unwrap_err().to_string();
    let count = fault("count = 100", "count = 80.0");
    let expected = "grains.count: is 80.0; it must be a whole number from 1 to 10000000, written without a decimal point or exponent";
    assert!(count.contains(expected), "{count}");
    assert!(fault("times = 2", "times = 1e1").contains("times: is 10.0; it must be a whole number"));
    let list = |count: &str| {
        fault("count = 100\ndiameter = 2e-4", &format!("diameter = [{{ diameter = 2e-4, count = {count} }}]"))
    };
    let of_list = list("30.0");
    assert!(of_list.contains("grains.diameter: has the count 30.0; a count is a whole number"), "{of_list}");
    assert!(of_list.contains("1 fault"), "{of_list}");
    let many = list("20_000_000");
    assert!(
        many.contains("counts that sum to 20000000 grains; a run has at most 10000000")
            && many.contains("1 fault"),
        "{many}"
    );
}
