//! The ratio of the shear moduli and the strain ratio, from which several models infer ε.

use crate::error::EmtError;
use crate::moduli::Modulus;
use crate::observation::Observation;
use grainlab_core::notes::Note;

/// r = G13/G12, dimensionless. It is below 2 in every model here.
pub(super) fn shear_ratio(model: &'static str, observation: &Observation) -> Result<f64, EmtError> {
    let need = |m| observation.moduli.get(m).ok_or(EmtError::missing(model, m));
    let (g12, g13) = (need(Modulus::G12)?, need(Modulus::G13)?);
    let ratio = g13 / g12;
    if !(ratio > 0.0 && ratio < 2.0) {
        return Err(Note::ratio_out_of_range(ratio).into());
    }
    Ok(ratio)
}

/// The note for a shear ratio that contact anisotropy alone cannot give.
pub(super) fn ratio_notes(ratio: f64) -> Vec<Note> {
    let usual = (2.0 / 3.0..=1.5).contains(&ratio);
    if usual { Vec::new() } else { vec![Note::ratio_unusual(ratio)] }
}

/// g = γ/Δ, if Eq. 10, the root of the overlap to first order in g, gives every contact a positive stiffness. It costs less than
/// 0.006 in ε for g in [−0.3, 0.1], and 0.1 at g = 1/4.
pub(super) fn check_eq_10(g: f64) -> Result<f64, EmtError> {
    if g > -1.0 && g < 0.5 { Ok(g) } else { Err(Note::gamma_out_of_range(g).into()) }
}
