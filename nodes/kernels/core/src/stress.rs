//! The one definition of stress.

use crate::packing::Packing;
use crate::tensor::{Mat3, SymTensor};

/// Stress of a packing, before and after making it symmetric.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stress {
    /// Cauchy stress, Pa, positive in compression, symmetric part.
    pub tensor: SymTensor,
    /// Largest |σ_ij − σ_ji| before the symmetric part was taken, Pa: it vanishes when torques balance.
    pub asymmetry: f64,
}

impl Stress {
    /// From the sum Σ f ⊗ l over contacts (f the force on `j` by `i`, l from `i` to `j`), J, and the volume, m³.
    pub fn from_virial(virial: &Mat3, volume: f64) -> Self {
        let s = virial / volume;
        let asymmetry = (s[(0, 1)] - s[(1, 0)])
            .abs()
            .max((s[(0, 2)] - s[(2, 0)]).abs())
            .max((s[(1, 2)] - s[(2, 1)]).abs());
        Self { tensor: SymTensor::symmetric_part(&s), asymmetry }
    }
}

/// Love–Weber stress σ = (1/V) Σ_c f ⊗ l of the elastic contact forces, Pa, positive in compression (Eq. 4 in its
/// discrete form). Viscous forces are left out: they vanish at equilibrium and prop up a moving packing.
pub fn stress(packing: &Packing) -> Stress {
    let mut virial = Mat3::zeros();
    for c in &packing.contacts {
        let force_on_j = c.normal * c.normal_force - c.tangential_force;
        virial += force_on_j * packing.branch(c).transpose();
    }
    Stress::from_virial(&virial, packing.cell.volume())
}
