//! An inversion by a user of this crate alone.

use grainlab::{Observation, StrainRatio, invert};

#[test]
fn moduli_of_a_user_are_inverted_and_the_status_is_printed() {
    let observation = Observation::from_g12_g13_theta(104.2e6, 112.4e6, 136e6, 50e3, StrainRatio::ZERO);
    let estimate = invert(&observation).unwrap();
    assert_eq!(format!("{}, {:>4}", estimate.status, estimate.status), "ok,   ok");
}
