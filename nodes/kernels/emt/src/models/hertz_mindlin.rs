//! The isotropic pack of rock physics: Hertz contacts, of which a share f sticks (Mindlin) and the others slip.
//!
//! K = [k²φ²G²p/(18π²(1−ν)²)]^⅓ and G/K = (3/5)(1 + 3f(1−ν)/(2−ν)): Walton's rough (f = 1) and smooth (f = 0) spheres, and the
//! practice between them (Bachrach & Avseth, Geophysics 73, E197 (2008); Mavko, Mukerji & Dvorkin, The Rock Physics
//! Handbook, 5.4). Θ gives k, and the shear modulus over it f, which stands for all that makes real packs softer in shear.
//! Without Θ it is C33 − 4/3 G13, or C11 − 4/3 G12, as from one P and one S wave. The contacts have no anisotropy.
//!
//! If the moduli are anisotropic, the shear modulus is that of the isotropic part, or the mean of the known ones.

use super::equivalent::MAX_COORDINATION;
use crate::calibration::Calibration;
use crate::conditions::Conditions;
use crate::domain::Domain;
use crate::error::EmtError;
use crate::invariants::Invariants;
use crate::model::Model;
use crate::moduli::{Moduli, Modulus};
use crate::observation::Observation;
use crate::point_estimate::PointEstimate;
use grainlab_core::notes::Note;
use grainlab_core::results::{InferredQuantity, Microstructure, MicrostructureCovariance};
use grainlab_core::{Material, TransverseIsotropy};
use std::f64::consts::PI;

/// Hertz–Mindlin with a share of contacts that stick: model `hertz-mindlin`. It uses only the material of the calibration,
/// where that of the grains is not known.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HertzMindlin;

const NAME: &str = "hertz-mindlin";

/// Error of k over the k inferred, root mean square over the 1,068 states of the calibration `grainlab`, bias included: what the model
/// leaves out is the relaxation of the network. No constant of the model comes from it.
const ERROR_OF_K: f64 = 0.21;

/// Mean stress in units of (2/π) φ k E* (Δ/3)^{3/2}.
const PRESSURE: f64 = 1.0 / 3.0;

impl Model for HertzMindlin {
    fn name(&self) -> &'static str {
        NAME
    }

    fn uses_constants(&self) -> bool {
        false
    }

    fn domain(&self, _: &Calibration) -> Domain {
        let ranges = [(InferredQuantity::K, [0.1, MAX_COORDINATION])];
        Domain { needs_solid_fraction: true, ..Domain::new(NAME, &ranges) }
    }

    /// With f = 1: small waves do not make contacts slip.
    fn predict(
        &self,
        structure: &Microstructure,
        conditions: &Conditions,
        calibration: &Calibration,
    ) -> Result<Moduli, EmtError> {
        let found = self.domain(calibration).validate(structure, conditions)?;
        let material = conditions.material.unwrap_or(*calibration.material());
        let phi = conditions.solid_fraction.map_or(f64::NAN, |phi| phi.value);
        let network = phi * found[InferredQuantity::K as usize] * material.effective_young();
        let unit = 3.0 / PI * network * (0.5 * PI * conditions.pressure.value / (network * PRESSURE)).cbrt();
        let moduli = Moduli::of_medium(&stiffness(mindlin(&material))).values();
        Ok(Moduli::of_values(moduli.map(|m| m.map(|m| m * unit))))
    }

    fn solve(&self, observation: &Observation, calibration: &Calibration) -> Result<PointEstimate, EmtError> {
        let conditions = &observation.conditions;
        let missing = EmtError::Missing { model: NAME, missing: "the solid fraction" };
        let phi = conditions.solid_fraction.ok_or(missing)?.value;
        let material = conditions.material.unwrap_or(*calibration.material());
        let Known { bulk, shear } = Known::of(&observation.moduli)?;
        // Θ of the isotropic pack is a ninth of the unit of the moduli.
        let unit = 9.0 * bulk;
        let network = (PI / 3.0 * unit).powf(1.5) * (2.0 * PRESSURE / (PI * observation.pressure())).sqrt();
        let k = network / (phi * material.effective_young());
        let mut notes = vec![Note::isotropic_contacts()];
        notes.extend(shear.map(|shear| {
            let smooth = 0.6 * bulk;
            sticking_share((shear / smooth - 1.0) / (1.5 * mindlin(&material)))
        }));
        let structure = Microstructure::default().with(InferredQuantity::K, k);
        let mut discrepancy = MicrostructureCovariance::zeros();
        let at = InferredQuantity::K as usize;
        discrepancy[(at, at)] = (ERROR_OF_K * k).powi(2);
        Ok(PointEstimate { notes, discrepancy: Some(discrepancy), ..PointEstimate::exact(structure) })
    }
}

fn sticking_share(share: f64) -> Note {
    // To the rounding of its computation.
    let is_share = (-1e-9..=1.0 + 1e-9).contains(&share);
    if is_share { Note::sticking_share(share) } else { Note::sticking_share_outside(share) }
}

/// k_t/k_n of two spheres that stick, 2(1−ν)/(2−ν) (Mindlin).
fn mindlin(material: &Material) -> f64 {
    4.0 * material.effective_shear() / material.effective_young()
}

/// The moduli in units of (3/π) φ k E* (Δ/3)^½, for this k_t/k_n. Walton, J. Mech. Phys. Solids 35, 213 (1987).
fn stiffness(tangential: f64) -> TransverseIsotropy {
    // Means of the second and fourth power of the cosine to an axis.
    let [i2, i4] = [1.0 / 3.0, 1.0 / 5.0];
    let normal = 1.0 - tangential;
    let flat = 1.0 - 2.0 * i2 + i4;
    TransverseIsotropy {
        c11: 0.375 * normal * flat + 0.5 * tangential * (1.0 - i2),
        c12: 0.125 * normal * flat,
        c13: 0.5 * normal * (i2 - i4),
        c33: normal * i4 + tangential * i2,
        g13: 0.5 * normal * (i2 - i4) + 0.125 * tangential * (1.0 + i2),
        g12: 0.125 * normal * flat + 0.25 * tangential * (1.0 - i2),
        residual: 0.0,
    }
}

/// Bulk and shear modulus of the medium as if it were isotropic, Pa.
struct Known {
    bulk: f64,
    shear: Option<f64>,
}

impl Known {
    fn of(moduli: &Moduli) -> Result<Self, EmtError> {
        let get = |m| moduli.get(m);
        let one_direction = |p, s| Some(Self { bulk: get(p)? - 4.0 / 3.0 * get(s)?, shear: get(s) });
        let shear = Invariants::of(moduli).map(|i| i.ln_shear.exp()).or_else(|| {
            // e3 lies in two of the three planes.
            match (get(Modulus::G12), get(Modulus::G13)) {
                (Some(g12), Some(g13)) => Some((g12 + 2.0 * g13) / 3.0),
                (one, other) => one.or(other),
            }
        });
        let known = get(Modulus::Theta)
            .map(|bulk| Self { bulk, shear })
            .or_else(|| one_direction(Modulus::C33, Modulus::G13))
            .or_else(|| one_direction(Modulus::C11, Modulus::G12))
            .ok_or(EmtError::missing(NAME, Modulus::Theta))?;
        if known.bulk <= 0.0 {
            return Err(Note::unstable(Modulus::Theta.name(), known.bulk).into());
        }
        Ok(known)
    }
}
