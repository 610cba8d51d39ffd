//! Scenes that cannot end are refused, and what stays uncontrolled is noted.

use grainlab_scene::{BUILT_IN, Draft, Scene, built_in};

/// A gas, and a phase with these lines.
fn scene(gas_until: &str, phase: &str) -> String {
    format!(
        "name = \"x\"\nfriction = 0.1\n[grains]\ncount = 100\ndiameter = 2e-4\n[[phase]]\nkind = \"gas\"\nrate = -12.0\n\
         until = {{ {gas_until} }}\n[[phase]]\nname = \"second\"\n{phase}\n"
    )
}

const GAS: &str = "solid_fraction = 0.6";
const ISOTROPIC: &str = "kind = \"servo\"\ncontrol = { xx = { stress = 5e4 }, yy = { stress = 5e4 }, zz = { stress = 5e4 }, \
                         yz = { stress = 0 }, xz = { stress = 0 }, xy = { stress = 0 } }\n";
const STRAIN: &str = "kind = \"strain\"\nrate = [0, 0, -5, 0, 0, 0]\n";

#[test]
fn a_phase_that_cannot_end_is_refused_with_the_reason() {
    let servo = |until: &str| format!("{ISOTROPIC}until = {{ {until} }}");
    let strain = |until: &str| format!("{STRAIN}until = {{ {until} }}");
    let relax = |until: &str| format!("kind = \"relax\"\nuntil = {{ {until} }}");
    for (gas, phase, reason) in [
        (GAS, servo("pressure_below = 1e3, pressure_above = 5e4"), "both never hold"),
        (GAS, strain("deviator_above = 5, deviator_below = -5"), "both never hold"),
        (GAS, strain("stress_above = { zz = 2e3 }, stress_below = { zz = 1e3 }"), "both never hold"),
        (GAS, relax("unbalanced = -1"), "0 or more"),
        (GAS, relax("speed = -1"), "0 or more"),
        (GAS, relax("pressure_below = -1"), "0 or more"),
        (GAS, servo("on_target = -1e-3"), "0 or more"),
        ("solid_fraction = 0.99", relax("speed = 1e-3"), "jams below 0.64"),
        ("solid_fraction = 1.1", relax("speed = 1e-3"), "below 1"),
        (GAS, strain("strain = { zz = 0.05 }"), "strains it at -5 1/s"),
        (GAS, strain("strain = { xx = -0.05 }"), "strains it at 0 1/s"),
        (GAS, relax("strain = { zz = -0.05 }"), "strains it at 0 1/s"),
        (GAS, relax("solid_fraction = 0.62"), "does not compress"),
        (
            GAS,
            "kind = \"strain\"\nrate = [2, 2, 2, 0, 0, 0]\nuntil = { solid_fraction = 0.62 }".into(),
            "does not compress",
        ),
        (GAS, servo("pressure_above = 6e4"), "beyond the 5e4 Pa"),
        (GAS, servo("stress_below = { zz = 4e4 }"), "beyond the 5e4 Pa"),
        (GAS, servo("deviator_above = 1e3"), "beyond the 0e0 Pa"),
        (GAS, relax("elapsed = 2.0"), "timeout of 1 s"),
        (GAS, relax("elapsed = 0.6, hold = 0.5"), "timeout of 1 s"),
        (GAS, strain("strain = { zz = -0.05 }, timeout = 0.005"), "timeout of 0.005 s"),
        ("solid_fraction = 0.6, timeout = 0.01", relax("speed = 1e-3"), "timeout of 0.01 s"),
        (GAS, relax("elapsed = 0.1") + "\nrecord = { every_strain = 1e-3 }", "publishes nothing"),
    ] {
        let error = Scene::parse(&scene(gas, &phase)).unwrap_err();
        assert!(error.to_string().contains(reason), "{phase}: {error}");
    }
}

#[test]
fn conditions_that_can_be_met_are_none_of_them() {
    for phase in [
        format!("{ISOTROPIC}until = {{ on_target = 1e-3, unbalanced = 1e-3, hold = 1e-4 }}"),
        format!("{ISOTROPIC}until = {{ pressure_above = 1e3, pressure_below = 5e4 }}"),
        format!("{ISOTROPIC}record = {{ every_strain = 1e-3 }}\nuntil = {{ strain = {{ zz = -0.01 }} }}"),
        format!("{STRAIN}until = {{ strain = {{ zz = -0.05 }}, pressure_above = 1e3 }}"),
        format!("{STRAIN}until = {{ solid_fraction = 0.9 }}"),
        "kind = \"relax\"\nuntil = { elapsed = 0.5, pressure_below = 10 }".to_owned(),
    ] {
        let found = Scene::parse(&scene(GAS, &phase));
        assert!(found.is_ok(), "{phase}: {}", found.unwrap_err());
    }
    let mixed = scene("solid_fraction = 0.68", "kind = \"relax\"\nuntil = { speed = 1e-3 }")
        .replace("diameter = 2e-4", "diameter = { min = 1e-4, max = 4e-4 }");
    assert!(Scene::parse(&mixed).is_ok());
}

#[test]
fn targets_that_pull_on_grains_without_cohesion_are_refused_with_their_range() {
    let servo = |control: &str| {
        format!("kind = \"servo\"\ncontrol = {{ {control} }}\nuntil = {{ on_target = 1e-3 }}")
    };
    let faults =
        |phase: &str| Scene::parse(&scene(GAS, phase)).map_or_else(|e| e.to_string(), |_| String::new());
    let held = "xx = { stress = 4e4 }, yy = { stress = 1e4 }";
    for (control, fault) in [
        ("zz = { stress = -1e3 }", "(second).control.zz: is { stress = -1000.0 }; it must be 0 or more"),
        (
            "xy = { stress = -3e4 }",
            "control.xy: is { stress = -30000.0 }; it must be from -2.000000e4 to 2.000000e4",
        ),
        (
            "zz = { stress = 0 }, xz = { stress = 1 }",
            "control.xz: is { stress = 1.0 }; it must be from -0.000000e0 to",
        ),
    ] {
        let found = faults(&servo(&format!("{held}, {control}")));
        assert!(found.contains(fault) && found.contains("1 fault"), "{control}: {found}");
    }
    for control in
        ["xy = { stress = 2e4 }", "zz = { stress = 0 }, xz = { stress = 0 }", "xz = { stress = 9e4 }"]
    {
        assert_eq!(faults(&servo(&format!("{held}, {control}"))), "", "{control}");
    }
    let below = faults(&format!("{STRAIN}until = {{ stress_below = {{ zz = -1.0 }} }}"));
    assert!(below.contains("stress zz at or below -1e0 Pa is tension"), "{below}");
}

/// Strains are logarithmic, so that no strain makes an edge of the cell negative; but grains fill it before.
#[test]
fn a_compression_beyond_a_full_cell_is_refused_with_the_strain_at_which_it_is_full() {
    let faults = |gas: &str, phase: &str| {
        Scene::parse(&scene(gas, phase)).map_or_else(|e| e.to_string(), |_| String::new())
    };
    let strain = |rate: &str, until: &str| {
        format!("kind = \"strain\"\nrate = [{rate}, 0, 0, 0]\nuntil = {{ {until} }}")
    };
    let full = faults(GAS, &strain("0, 0, -5", "strain = { zz = -1.2 }"));
    assert!(
        full.contains(
            "(second).until: strain zz = -1.2 is reached where the grains fill the cell 1.99 times"
        ),
        "{full}"
    );
    assert!(full.contains("solid fraction is 0.600 or more") && full.contains("full at -0.511"), "{full}");
    let timed = faults(GAS, &strain("-2, -2, -2", "elapsed = 0.2"));
    assert!(timed.contains("elapsed = 0.2 is reached where") && timed.contains("full at 0.085"), "{timed}");
    let gas = faults("strain = { xx = -1 }", &strain("0, 0, -5", "strain = { zz = -0.1 }"));
    assert!(gas.contains("strain xx = -1 is reached where") && gas.contains("full at -0.401"), "{gas}");
    // Room for it: a change of shape, a loose cell, and a phase after one that may have loosened the packing.
    for phase in [strain("2, 2, -4", "strain = { zz = -1.5 }"), strain("0, 0, -5", "strain = { zz = -0.5 }")]
    {
        assert_eq!(faults(GAS, &phase), "");
    }
    assert_eq!(faults("solid_fraction = 0.31", &strain("0, 0, -5", "strain = { zz = -1.2 }")), "");
    let first = strain("0, 0, 5", "strain = { zz = 0.1 }");
    let second = format!("[[phase]]\nname = \"third\"\n{}", strain("0, 0, -5", "strain = { zz = -1.2 }"));
    assert_eq!(faults(GAS, &format!("{first}\n{second}")), "");
}

#[test]
fn components_that_stay_uncontrolled_are_noted() {
    let notes = |phase: &str| {
        Scene::parse(&scene(GAS, &format!("{phase}until = {{ on_target = 1e-3 }}")))
            .unwrap()
            .notes()
            .join("\n")
    };
    assert_eq!(notes(ISOTROPIC), "");
    let held = notes(
        "kind = \"servo\"\ncontrol = { xx = { stress = 5e4 }, yy = { stress = 5e4 }, zz = { stress = 5e4 } }\n",
    );
    assert!(held.contains("phase second: the strain of yz, xz, xy is held"), "{held}");
}

#[test]
fn an_implausible_shear_modulus_is_noted_and_no_built_in_scene_has_one() {
    let with = |shear_modulus: &str| {
        let text = scene(GAS, &format!("{ISOTROPIC}until = {{ on_target = 1e-3 }}"));
        Scene::parse(&format!("{text}[material]\nshear_modulus = {shear_modulus}\n"))
            .unwrap()
            .notes()
            .join("\n")
    };
    assert_eq!(with("29"), "material.shear_modulus is 29 Pa, softer than gels: is its unit Pa?");
    assert_eq!(["2e3", "5e11"].map(with), ["", ""]);
    for (name, text) in BUILT_IN {
        let notes = Draft::of_text(text).unwrap().resolve().unwrap().scene.notes().join("\n");
        assert!(!notes.contains("shear_modulus"), "{name}: {notes}");
    }
}

#[test]
fn a_packing_measured_at_another_friction_than_it_was_prepared_with_is_noted() {
    let demo = |sets: &[&str]| {
        let library = |_: &str, _: &str| Err::<grainlab_scene::Source, _>("no base".to_owned());
        let source =
            grainlab_scene::Source { name: "demo".into(), text: built_in("demo").unwrap().to_owned() };
        let mut draft = Draft::of(&source, &library).unwrap();
        for set in sets {
            draft.set(grainlab_scene::assignment(set).unwrap()).unwrap();
        }
        draft.resolve().unwrap().scene
    };
    let notes = demo(&["friction=0"]).notes();
    assert_eq!(notes.len(), 1, "{notes:?}");
    assert!(notes[0].contains("measured at friction 10, prepared at friction 0, 0.1"), "{notes:?}");
    let one = scene(GAS, &format!("{ISOTROPIC}publish = true\nuntil = {{ on_target = 1e-3 }}"));
    assert_eq!(Scene::parse(&one).unwrap().notes(), Vec::<String>::new());
    assert!(BUILT_IN.iter().any(|(name, _)| *name == "demo"));
}
