//! Bounds of the relaxed stiffness in closed form: above it, affine motion with one spin of all grains; below
//! its bulk modulus, the forces that the packing already carries.

use super::spring_network::{SpringNetwork, Springs};
use crate::view::PackingView;
use grainlab_core::Stiffness;
use nalgebra::{Matrix3, Matrix6x3};

/// Fraction of the largest entry of the affine stiffness below which a spin has no stiffness.
const FREE_SPIN: f64 = 1e-12;

/// Stiffness, Pa, of the network whose grains move with the mean deformation and all have the same spin, as
/// in the paper's theory (the spin that makes the stress symmetric, its Eq. 12): A less the relaxation of
/// three uniform spins. It lies between the relaxed and the affine stiffness. All are equal without
/// anisotropy and without tangential springs.
pub fn uniform_rotation_stiffness(network: &SpringNetwork, affine: &Stiffness) -> Stiffness {
    let (spin, coupling) = network.spin_energy();
    let eigen = spin.symmetric_eigen();
    let mut relaxed = affine.0;
    for (k, value) in eigen.eigenvalues.iter().enumerate() {
        if *value > FREE_SPIN * affine.0.amax() {
            let along: nalgebra::Vector6<f64> = coupling * eigen.eigenvectors.column(k);
            relaxed -= along * along.transpose() / *value;
        }
    }
    Stiffness(relaxed)
}

/// Lower bound of the bulk modulus under isotropic stress (Reuss), Pa: V p²/Σ(F_n²/k_n + F_t²/k_t).
///
/// Increasing all forces of the packing by the same fraction keeps every grain in balance and increases the
/// pressure by this fraction. The complementary energy of any such forces is at least that of the true ones.
/// The bound is as accurate as the packing is at rest under isotropic stress. Without tangential springs,
/// tangential forces cannot change and are left out. `None` without forces, and for laws that resist rolling: the network
/// lacks their springs, and without these the forces do not balance.
pub fn bulk_reuss_bound(view: &PackingView<'_>, springs: Springs) -> Option<f64> {
    let (packing, pressure) = (view.packing, view.stress.tensor.mean());
    if packing.law.rolling.is_some() {
        return None;
    }
    let mut compliance = 0.0;
    for (c, (k_n, k_t)) in packing.contacts.iter().zip(&view.contact_stiffnesses) {
        compliance += c.normal_force * c.normal_force / k_n;
        if springs.has_tangential(packing.friction) {
            compliance += c.tangential_force.norm_squared() / k_t;
        }
    }
    let bound = packing.cell.volume() * pressure * pressure / compliance;
    (compliance > 0.0 && bound.is_finite()).then_some(bound)
}

/// Energy of three uniform spins, and of each combined with the six unit strains, Pa.
pub(crate) type SpinEnergy = (Matrix3<f64>, Matrix6x3<f64>);

impl SpringNetwork {
    /// A spin θ of all grains displaces a contact by −(λ_i + λ_j) θ×n = −θ×l.
    pub(crate) fn spin_energy(&self) -> SpinEnergy {
        let (mut spin, mut coupling) = (Matrix3::zeros(), Matrix6x3::zeros());
        for s in &self.springs {
            let affine = s.affine();
            let [x, y, z] = s.branch();
            // Columns: θ along x, y, z.
            let w = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]];
            let f = s.force(&w);
            for k in 0..3 {
                for b in 0..3 {
                    for a in 0..3 {
                        spin[(a, b)] += w[k][a] * f[k][b];
                    }
                    for a in 0..6 {
                        coupling[(a, b)] += affine[k][a] * f[k][b];
                    }
                }
            }
        }
        (spin / self.volume(), coupling / self.volume())
    }
}
