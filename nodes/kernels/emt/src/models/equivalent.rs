//! The equivalent isotropic packing, to which the ratio models compare a packing.
//!
//! Moduli of an anisotropic packing over those of an isotropic one with coordination number k̂ are k/k̂ times
//! factors that depend on the contact distribution alone. With G and Θ of Eqs. 21 and 22, G12/Θ gives k̂, and Θ then
//! gives k: closed and unique.

use super::shear_ratio::ratio_notes;
use crate::calibration::Calibration;
use crate::conditions::Conditions;
use crate::domain::{Domain, Fitted, by_quantity, outside_fitted};
use crate::error::EmtError;
use crate::moduli::{Moduli, Modulus};
use crate::observation::Observation;
use crate::point_estimate::PointEstimate;
use grainlab_core::notes::Note;
use grainlab_core::results::{InferredQuantity, Microstructure};

/// Highest coordination number of the domain: larger than the number of neighbours that equal spheres can
/// have.
pub(super) const MAX_COORDINATION: f64 = 15.0;

/// Moduli over those of an isotropic packing with as many contacts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Factors {
    /// G12 over the isotropic shear modulus. Positive.
    pub(super) g12: f64,
    /// G13 over the isotropic shear modulus.
    pub(super) g13: f64,
    /// Bulk modulus over the isotropic one. Positive.
    pub(super) bulk: f64,
}

impl Factors {
    /// The moduli of a packing with the coordination numbers of `found`, a structure of [`domain`] in the order of
    /// [`InferredQuantity::ALL`].
    pub(super) fn moduli(
        &self,
        found: &[f64; InferredQuantity::COUNT],
        conditions: &Conditions,
        calibration: &Calibration,
    ) -> Moduli {
        let isotropic = calibration.isotropic_for(conditions.material);
        let [k, k_hat] = [InferredQuantity::K, InferredQuantity::KHat].map(|q| found[q as usize]);
        let pressure = conditions.pressure.value;
        let denser = k / k_hat;
        let shear = denser * isotropic.shear_modulus(k_hat, pressure);
        let bulk = denser * isotropic.bulk_modulus(k_hat, pressure);
        Moduli::paper(self.g12 * shear, self.g13 * shear, self.bulk * bulk)
    }

    /// The structure of contact anisotropy `eps` that has the observed moduli, with notes. Without Θ its
    /// coordination numbers stay undetermined.
    pub(super) fn point_estimate(
        &self,
        eps: f64,
        observation: &Observation,
        calibration: &Calibration,
    ) -> Result<PointEstimate, EmtError> {
        let structure = Microstructure::default().with(InferredQuantity::Eps, eps);
        let [g12, g13, theta] =
            [Modulus::G12, Modulus::G13, Modulus::Theta].map(|m| observation.moduli.get(m));
        let mut notes = g12.zip(g13).map_or(Vec::new(), |(g12, g13)| ratio_notes(g13 / g12));
        let Some((g12, theta)) = g12.zip(theta) else {
            return Ok(PointEstimate { notes, ..PointEstimate::exact(structure) });
        };
        let isotropic = calibration.isotropic_for(observation.conditions.material);
        let of_isotropic = self.bulk / self.g12;
        let s = isotropic.reduced(g12 / theta * of_isotropic);
        if s >= 1.0 {
            let limit = 1.0 / isotropic.reduced(of_isotropic);
            return Err(Note::shear_too_stiff(calibration.name().to_owned(), g12 / theta, limit).into());
        }
        let k_hat = isotropic.coordination(s);
        let denser = theta / (isotropic.bulk_modulus(k_hat, observation.pressure()) * self.bulk);
        let k = k_hat * denser;
        let structure = structure.with(InferredQuantity::K, k).with(InferredQuantity::KHat, k_hat);
        notes.extend(outside_fitted(&fitted(InferredQuantity::KHat, calibration), &structure));
        Ok(PointEstimate { notes, ..PointEstimate::exact(structure) })
    }
}

/// The packings of Eqs. 21 and 22, for the coordination number that a model takes in them.
pub(super) fn fitted(
    quantity: InferredQuantity,
    calibration: &Calibration,
) -> [Option<Fitted>; InferredQuantity::COUNT] {
    let mut range = calibration.isotropic().fitted;
    if range[1].is_infinite()
        && let Some(learned) = Calibration::builtin("grainlab")
    {
        // The errors are known up to the densest packings that they were learned from.
        range[1] = learned.isotropic().fitted[1];
    }
    by_quantity(&[(quantity, Fitted { range, inside: range })])
}

/// Domain of a model with the paper's three unknowns: k, k̂ above the zero of the
/// shear modulus, and ε.
pub(super) fn domain(model: &'static str, calibration: &Calibration) -> Domain {
    // At the zero of shear itself nothing can be inverted.
    let lowest = -calibration.isotropic().constants()[1] * (1.0 + 1e-3);
    let ranges = [
        (InferredQuantity::K, [0.1, MAX_COORDINATION]),
        (InferredQuantity::KHat, [lowest, MAX_COORDINATION]),
        (InferredQuantity::Eps, [-0.5, 1.0]),
    ];
    let fitted = fitted(InferredQuantity::KHat, calibration);
    Domain { gamma: [-0.5, 0.25], fitted, ..Domain::new(model, &ranges) }
}
