//! Notes for the reader of a stiffness, about its springs.

use super::elastic_stiffness::StiffnessMethod;
use crate::contact::ContactLaw;
use crate::notes::Note;
use crate::packing::Packing;

/// Returns notes on the differences between the springs of a stiffness of `packing` by this method and its contact law, or those
/// that inversions are calibrated for. `what` begins their sentences; `smooth`: the stiffness has no tangential springs.
pub fn spring_notes(
    what: &'static str,
    packing: &Packing,
    method: StiffnessMethod,
    smooth: bool,
) -> Vec<Note> {
    of_springs(what, &packing.law, packing.friction, packing.sliding_fraction(), method, smooth)
}

pub(super) fn of_springs(
    what: &'static str,
    law: &ContactLaw,
    friction: f64,
    share: f64,
    method: StiffnessMethod,
    smooth: bool,
) -> Vec<Note> {
    let tangential = match (smooth, friction > 0.0) {
        (true, true) => Some(Note::tangential_left_out(what, friction)),
        (true, false) => Some(Note::frictionless(what)),
        (false, false) => Some(Note::tangential_added(what)),
        (false, true) => (share > 0.0).then(|| Note::sliding_stuck(what, share)),
    };
    let network = !matches!(method, StiffnessMethod::StrainProbe);
    let rolling = (network && law.rolling.is_some()).then(|| Note::without_rolling(what));
    let unstressed = matches!(method, StiffnessMethod::FrozenNetwork);
    let prestress = (unstressed && smooth && friction <= 0.0).then(|| Note::without_prestress(what));
    tangential.into_iter().chain(rolling).chain(prestress).collect()
}
