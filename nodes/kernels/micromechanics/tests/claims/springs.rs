//! Contacts that have a tangential spring.

use crate::golden::reference;
use crate::samples::{random, with_springs};
use grainlab_core::contact::RollingResistance;
use grainlab_core::results::{ElasticStiffness, SpringNote, StiffnessMethod};
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
    assert_eq!(SpringNote::of(&packing, at_rest.method, at_rest.smooth), []);
    for c in packing.contacts.iter_mut().step_by(4) {
        let across = c.normal.cross(&Vec3::x()).normalize();
        c.tangential_force = 0.3 * c.normal_force * across;
    }
    let share = packing.sliding_fraction();
    assert!((share - 0.25).abs() < 0.01, "{share}");
    let sliding = with_springs(&packing, Springs::default());
    assert_eq!((sliding.tensor, sliding.smooth), (at_rest.tensor, false));
    let notes = SpringNote::of(&packing, sliding.method, sliding.smooth);
    assert_eq!(notes, [SpringNote::SlidingStuck { share }]);
}

#[test]
fn springs_that_differ_from_those_of_the_contacts_are_noted() {
    let network = StiffnessMethod::FrozenNetwork;
    let smooth = frictionless();
    assert_eq!(
        SpringNote::of(&smooth, network, true),
        [SpringNote::Frictionless, SpringNote::WithoutPrestress]
    );
    assert_eq!(SpringNote::of(&smooth, network, false), [SpringNote::TangentialAdded]);
    let mut rough = Packing { friction: 0.3, ..frictionless() };
    assert_eq!(SpringNote::of(&rough, network, true), [SpringNote::TangentialLeftOut { friction: 0.3 }]);
    rough.law = rough.law.with_rolling(RollingResistance { stiffness: 1e4, damping: 0.0, friction: 0.1 });
    assert_eq!(SpringNote::of(&rough, network, false), [SpringNote::WithoutRolling]);
    assert_eq!(SpringNote::of(&rough, StiffnessMethod::StrainProbe, false), []);
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
