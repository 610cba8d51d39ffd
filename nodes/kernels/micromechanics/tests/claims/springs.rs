//! Contacts that have a tangential spring.

use crate::golden::reference;
use crate::samples::{random, with_springs};
use grainlab_core::contact::RollingResistance;
use grainlab_core::notes::Note;
use grainlab_core::results::{ElasticStiffness, StiffnessMethod, spring_notes};
use grainlab_core::{Packing, Vec3};
use grainlab_micromechanics::network::Springs;
use grainlab_micromechanics::probe::{StrainProbe, strain_probe};
use grainlab_micromechanics::{Settings, analyze};

fn frictionless() -> Packing {
    Packing { friction: 0.0, ..random(60, 1.35, 5) }
}

#[test]
fn a_packing_without_friction_has_no_tangential_springs_unless_asked_for() {
    let packing = frictionless();
    let as_it_is = analyze(&packing, &Settings::default()).unwrap().report;
    assert_eq!(as_it_is.stiffness(), Some(&with_springs(&packing, Springs::Normal)));
    assert!(as_it_is.stiffness().unwrap().smooth);
    let added = with_springs(&packing, Springs::NormalAndTangential);
    assert!(!added.smooth);
    let g12 = |s: &ElasticStiffness| s.tensor.transverse_isotropy().g12;
    assert!(g12(&added) > 1.5 * g12(as_it_is.stiffness().unwrap()), "the test shows nothing");
}

#[test]
fn contacts_that_slide_keep_their_tangential_springs_and_a_note_says_so() {
    let mut packing = Packing { friction: 0.3, ..random(60, 1.3, 4) };
    let at_rest = with_springs(&packing, Springs::default());
    assert_eq!(spring_notes("stiffness", &packing, at_rest.method, at_rest.smooth), []);
    for c in packing.contacts.iter_mut().step_by(4) {
        let across = c.normal.cross(&Vec3::x()).normalize();
        c.tangential_force = 0.3 * c.normal_force * across;
    }
    let share = packing.sliding_fraction();
    assert!((share - 0.25).abs() < 0.01, "{share}");
    let sliding = with_springs(&packing, Springs::default());
    assert_eq!((sliding.tensor, sliding.smooth), (at_rest.tensor, false));
    let notes = spring_notes("stiffness", &packing, sliding.method, sliding.smooth);
    assert_eq!(notes, [Note::sliding_stuck("stiffness", share)]);
}

#[test]
fn springs_that_differ_from_those_of_the_contacts_are_noted() {
    let network = StiffnessMethod::FrozenNetwork;
    let smooth = frictionless();
    assert_eq!(
        spring_notes("stiffness", &smooth, network, true),
        [Note::frictionless("stiffness"), Note::without_prestress("stiffness")]
    );
    assert_eq!(spring_notes("stiffness", &smooth, network, false), [Note::tangential_added("stiffness")]);
    let mut rough = Packing { friction: 0.3, ..frictionless() };
    assert_eq!(
        spring_notes("stiffness", &rough, network, true),
        [Note::tangential_left_out("stiffness", 0.3)]
    );
    rough.law = rough.law.with_rolling(RollingResistance { stiffness: 1e4, damping: 0.0, friction: 0.1 });
    assert_eq!(spring_notes("stiffness", &rough, network, false), [Note::without_rolling("stiffness")]);
    assert_eq!(spring_notes("stiffness", &rough, StiffnessMethod::StrainProbe, false), []);
}

/// The probe has the tangential springs that the network has.
#[test]
fn a_packing_without_friction_is_probed_without_friction() {
    let packing = Packing { friction: 0.0, ..reference() };
    // Without friction it hardly settles.
    let probe = StrainProbe { amplitude: 1e-7, tolerance: 1e-3, max_steps: 5000, ..StrainProbe::default() };
    let found = strain_probe(&packing, &probe);
    assert_eq!(found, strain_probe(&packing, &StrainProbe { friction: Some(0.0), ..probe }));
    assert!(found.is_err() || found.unwrap().smooth);
    let rough = strain_probe(&reference(), &probe).unwrap();
    assert!(!rough.smooth);
    assert_ne!(Ok(rough), strain_probe(&packing, &probe));
}
