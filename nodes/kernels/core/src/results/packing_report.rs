//! Everything that is measured on one packing.

use super::contact_statistics::ContactStatistics;
use super::elastic_stiffness::{ElasticStiffness, Elasticity};
use super::fabric::Fabric;
use super::microstructure::InferredQuantity;
use super::spring_notes::of_springs;
use super::strain_ratios::StrainRatios;
use super::stress_decomposition::StressDecomposition;
use crate::contact::ContactLaw;
use crate::material::Material;
use crate::notes::Note;
use crate::stiffness::TransverseIsotropy;
use crate::stress::Stress;
use crate::symmetry::{Symmetry, SymmetryClass};
use crate::tensor::SymTensor;

/// Everything that is measured on one packing. [`super::QUANTITIES`] lists it by number.
#[derive(Clone, Debug, PartialEq)]
pub struct PackingReport {
    /// Solver steps done.
    pub step: u64,
    /// Material of the grains.
    pub material: Material,
    /// Contact law of the grains.
    pub law: ContactLaw,
    /// Friction coefficient in force when it was measured; may be infinite.
    pub friction: f64,
    /// Solid fraction φ.
    pub solid_fraction: f64,
    /// Standard deviation of the radii over their mean.
    pub size_spread: f64,
    /// Logarithmic strain, positive in extension, since the reference state, or since the first step of the run until a phase
    /// sets one; `None` for a packing that has neither.
    pub strain: Option<SymTensor>,
    /// Stress of the elastic contact forces.
    pub stress: Stress,
    /// Mean net force of non-rattlers over mean contact force; `None` without forces.
    pub unbalanced_force_ratio: Option<f64>,
    /// Contacts and the forces they carry.
    pub contacts: ContactStatistics,
    /// Orientation of the contacts.
    pub fabric: Fabric,
    /// Shares of the stress that kinds of forces and of contacts carry.
    pub stress_decomposition: StressDecomposition,
    /// The three ratios γ/Δ.
    pub strain_ratios: StrainRatios,
    /// The stiffness, or the reason why the packing has none.
    pub elasticity: Elasticity,
    /// Symmetry of the stiffness; `None` without one.
    pub symmetry: Option<Symmetry>,
}

impl PackingReport {
    /// Pressure on the packing, Pa.
    pub fn pressure(&self) -> f64 {
        self.stress.tensor.mean()
    }

    /// Density of all grains, kg/m³ of the cell.
    pub fn bulk_density(&self) -> f64 {
        self.solid_fraction * self.material.density
    }

    /// q/p; `None` without pressure.
    pub fn stress_ratio(&self) -> Option<f64> {
        let (p, q) = (self.pressure(), self.stress.tensor.deviatoric_invariant());
        (p > 0.0).then(|| q / p)
    }

    /// (σ_hh − (tr σ − σ_hh)/2)/p about the reference axis h: positive where the stress along h is the larger one; `None`
    /// without pressure.
    pub fn axial_stress_ratio(&self) -> Option<f64> {
        self.stress.tensor.axial_ratio(&self.fabric.reference_axis)
    }

    /// Value of an inferred quantity that is counted in this packing; `None` where it is undefined or cannot be counted.
    pub fn counted(&self, quantity: InferredQuantity) -> Option<f64> {
        quantity.counted(&self.contacts, &self.fabric)
    }

    /// ε of the contacts weighted by their normal stiffness; `None` without contacts.
    pub fn stiffness_anisotropy(&self) -> Option<f64> {
        self.counted(InferredQuantity::EpsStiffness)
    }

    /// The stiffness, if there is one.
    pub fn stiffness(&self) -> Option<&ElasticStiffness> {
        self.elasticity.as_deref().ok()
    }

    /// Notes on the springs of the stiffness; none without one.
    pub fn spring_notes(&self) -> Vec<Note> {
        let (law, sliding) = (&self.law, self.contacts.sliding_fraction);
        let notes =
            |s: &ElasticStiffness| of_springs("stiffness", law, self.friction, sliding, s.method, s.smooth);
        self.stiffness().map(notes).unwrap_or_default()
    }

    /// The stiffness projected on media isotropic about the reference axis.
    pub fn projected(&self) -> Option<TransverseIsotropy> {
        Some(self.stiffness()?.tensor.transverse_isotropy_about(&self.fabric.reference_axis))
    }

    /// Angle between the axis of the stiffness and that of the fabric, rad; `None` where either is not determined.
    pub fn symmetry_angle_to_fabric(&self) -> Option<f64> {
        let symmetry = self.symmetry.as_ref()?;
        let with_axis = !matches!(symmetry.class, SymmetryClass::Isotropic | SymmetryClass::Cubic);
        let axis = &self.fabric.principal_axis;
        let angle =
            || symmetry.axis.cross(&axis.direction).norm().atan2(symmetry.axis.dot(&axis.direction).abs());
        (with_axis && axis.determined).then(angle)
    }
}
