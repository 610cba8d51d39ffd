//! The table of quantities: everything that [`PackingReport`] says in numbers. A new one is a row here.

use super::contact_statistics::FORCE_BIN_WIDTH;
use super::fabric::{ORIENTATION_BINS, OrientationFit};
use super::packing_report::PackingReport;
use super::stress_decomposition::{StressForceFabric, SubNetwork};
use crate::quantities;
use crate::quantity::{Quantity, Shape::*};
use crate::tensor::SymTensor;

/// Every quantity of a [`PackingReport`], in the order in which it is printed.
pub static QUANTITIES: &[Quantity<PackingReport>] = quantities! { PackingReport:
    // The state.
    "grains" "N" "1" "number of grains" Scalar, |r| r.contacts.grains;
    "phi" "φ" "1" "solid fraction" Scalar, |r| r.solid_fraction;
    "size_spread" "" "1" "standard deviation of the radii over their mean" Scalar, |r| r.size_spread;
    "pressure_pa" "p" "Pa" "pressure, positive in compression"
        Scalar, |r| r.pressure(), or "p_pa" x 1.0, or "p_kpa" x 1e3;
    "stress_pa" "σ" "Pa" "Love-Weber stress of the elastic contact forces, positive in compression"
        Tensor, |r| r.stress.tensor;
    "strain" "E" "1" "logarithmic strain since the reference state, else since the first step of the run, positive in extension; unknown for a packing from elsewhere"
        Tensor, |r| r.strain;
    "unbalanced" "" "1" "mean net force of the grains that carry force, over the mean contact force"
        Scalar, |r| r.unbalanced_force_ratio;
    "grain_shear_modulus_pa" "G_g" "Pa" "shear modulus of the grains" Scalar, |r| r.material.shear_modulus;
    "poisson" "ν_g" "1" "Poisson ratio of the grains" Scalar, |r| r.material.poisson_ratio;
    "contact_law" "" "" "contact law, with the parameters that do not follow from the material"
        Scalar, |r| r.law.to_string();
    "friction" "μ" "1" "friction coefficient in force at the measurement; infinite (null in JSON) where no contact can slide"
        Scalar, |r| r.friction;
    "reference_axis" "h" "1" "unit axis that eps, p4, g, G12, G13 and the ti_ moduli are about"
        Vector, |r| r.fabric.reference_axis;
    // Contacts.
    "contacts" "N_c" "1" "number of contacts" Scalar, |r| r.contacts.contacts;
    "rattlers" "N_r" "1" "grains that carry no force: recursively fewer than 2 contacts with friction, 4 without"
        Scalar, |r| r.contacts.rattlers;
    "k" "k" "1" "coordination number, 2 contacts/grains, all grains" Scalar, |r| r.contacts.coordination;
    "z" "z" "1" "coordination number without rattlers and their contacts"
        Scalar, |r| r.contacts.mechanical_coordination;
    "eps" "ε" "1" "anisotropy of the contacts about h, 5/2 (L_hh - (tr L - L_hh)/2) (Eq. 20)"
        Scalar, |r| of_contacts(r, r.fabric.contact_anisotropy);
    "eps_stiffness" "ε_k" "1" "the same with every contact weighted by its normal stiffness"
        Scalar, |r| r.stiffness_anisotropy();
    // Orientation of the contacts.
    "fabric" "L" "1" "fabric tensor, mean of n n, trace 1 (Eq. 2)" Tensor, |r| r.fabric.contact_fabric;
    "force_fabric" "" "1" "the same weighted by normal force" Tensor, |r| r.fabric.normal_force_fabric;
    "tangential_force_fabric" "" "1" "mean of t t weighted by the size of the tangential force, t its direction"
        Tensor, |r| Some(r.fabric.tangential_force_fabric).filter(|f| f.trace() > 0.0);
    "stiffness_fabric" "" "1" "fabric tensor weighted by normal stiffness" Tensor, |r| r.fabric.stiffness_fabric;
    "axis" "" "1" "unit principal axis of the fabric that stands out most"
        Vector, |r| r.fabric.principal_axis.direction;
    "axis_eps" "" "1" "eps about it" Scalar, |r| of_contacts(r, r.fabric.principal_axis.contact_anisotropy);
    "axis_eps_stddev" "" "1" "standard deviation of eps among packings like this one, about any axis"
        Scalar, |r| r.fabric.principal_axis.contact_anisotropy_stddev;
    "axis_angle_stddev_rad" "" "rad" "standard deviation of the direction of the axis"
        Scalar, |r| r.fabric.principal_axis.angle_stddev;
    "axis_determined" "" "" "whether the anisotropy exceeds its noise and one axis stands out"
        Scalar, |r| r.fabric.principal_axis.determined;
    "p4" "a4" "1" "coefficient of P4(cos) in the contact distribution about h" Scalar, |r| of_contacts(r, r.fabric.p4_coefficient);
    "fourth_order_fabric" "" "1" "mean of n n n n: xxxx xxxy xxxz xxyy xxyz xxzz xyyy xyyz xyzz xzzz yyyy yyyz yyzz yzzz zzzz"
        List, |r| r.fabric.fourth_order.components;
    "fourth_order_magnitude" "" "1" "magnitude of its harmonic part: |a4| where that is a4 P4 about some axis"
        Scalar, |r| r.fabric.fourth_order.magnitude;
    "orientation_x" "x" "1" "edges of the bins of x = |n.h|" List, |_packing| bin_edges();
    "orientation_contacts" "" "1" "contacts by x" List, |r| r.fabric.orientation.contacts;
    "orientation_overlap_m" "" "m" "mean overlap by x" List, |r| known(r, &r.fabric.orientation.overlap);
    "orientation_sqrt_overlap_sqrt_m" "" "m^0.5" "mean square root of the overlap by x"
        List, |r| known(r, &r.fabric.orientation.sqrt_overlap);
    "orientation_eps" "" "1" "eps by maximum likelihood of (1 - eps) + 3 eps x^2 (Eq. 6)"
        Scalar, |r| orientation(r).map(|f| f.eps);
    "orientation_eps_stddev" "" "1" "its standard error for independent contacts"
        Scalar, |r| orientation(r).map(|f| f.eps_stddev);
    "orientation_chi2_per_dof" "" "1" "chi^2 of orientation_contacts over its 8 degrees of freedom"
        Scalar, |r| orientation(r).map(|f| f.chi2_per_dof);
    // Strain ratios.
    "g_total" "γ/Δ" "1" "gamma/Delta of that strain, where it began as a packing, not as a gas" Scalar, |r| r.strain_ratios.total;
    "g_elastic" "γ/Δ" "1" "gamma/Delta of an isotropic stress increment on the frozen network"
        Scalar, |r| r.strain_ratios.elastic;
    "g_contact" "γ/Δ" "1" "gamma/Delta fitted to the overlaps (Eq. 10)" Scalar, |r| r.strain_ratios.contact;
    "g_contact_stddev" "" "1" "its standard error for independent contacts"
        Scalar, |r| r.fabric.orientation.overlap_fit.and_then(|f| f.g_stddev);
    // Stress.
    "q_over_p" "q/p" "1" "deviatoric stress over pressure"
        Scalar, |r| r.stress_decomposition.stress_ratio();
    "axial_q_over_p" "" "1" "axial stress less the lateral one over pressure, about h: (s_hh - (tr s - s_hh)/2)/p"
        Scalar, |r| r.axial_stress_ratio();
    "predicted_q_over_p" "" "1" "the same by the anisotropies of contacts and forces"
        Scalar, |r| anisotropies(r).map(|a| a.stress_ratio().deviatoric_invariant());
    "anisotropy_contacts" "" "1" "traceless anisotropy tensor of the contacts"
        Tensor, |r| anisotropies(r).map(|a| a.contacts);
    "a_contacts" "a_c" "1" "3/2 of its component along h" Scalar, |r| anisotropies(r).map(|a| along(r, &a.contacts));
    "anisotropy_normal_forces" "" "1" "traceless anisotropy tensor of the normal forces"
        Tensor, |r| anisotropies(r).map(|a| a.normal_forces);
    "a_normal_forces" "a_n" "1" "3/2 of its component along h"
        Scalar, |r| anisotropies(r).map(|a| along(r, &a.normal_forces));
    "anisotropy_branches" "" "1" "traceless anisotropy tensor of the branch lengths"
        Tensor, |r| anisotropies(r).map(|a| a.branches);
    "a_branches" "a_l" "1" "3/2 of its component along h" Scalar, |r| anisotropies(r).map(|a| along(r, &a.branches));
    "anisotropy_tangential_forces" "" "1" "traceless anisotropy tensor of the tangential forces"
        Tensor, |r| anisotropies(r).map(|a| a.tangential_forces);
    "a_tangential_forces" "a_t" "1" "3/2 of its component along h"
        Scalar, |r| anisotropies(r).map(|a| along(r, &a.tangential_forces));
    "stress_normal_pa" "" "Pa" "stress of the normal forces" Tensor, |r| r.stress_decomposition.normal;
    "stress_tangential_pa" "" "Pa" "stress of the tangential forces" Tensor, |r| r.stress_decomposition.tangential;
    "strong_contacts" "" "1" "number of strong contacts: contacts with more than the mean normal force"
        Scalar, |r| r.stress_decomposition.strong.contacts;
    "strong_share_of_contacts" "" "1" "their share of all contacts"
        Scalar, |r| r.stress_decomposition.share_of_contacts(&r.stress_decomposition.strong);
    "strong_eps" "" "1" "eps of the strong contacts" Scalar, |r| some_contacts(&r.stress_decomposition.strong).map(|n| n.contact_anisotropy);
    "strong_fabric" "" "1" "their fabric tensor" Tensor, |r| some_contacts(&r.stress_decomposition.strong).map(|n| n.fabric);
    "strong_stress_pa" "" "Pa" "the stress they carry" Tensor, |r| r.stress_decomposition.strong.stress;
    "strong_share_of_pressure" "" "1" "their share of the pressure"
        Scalar, |r| r.stress_decomposition.share_of_pressure(&r.stress_decomposition.strong);
    "strong_share_of_deviator" "" "1" "their share of the stress deviator; unknown where q/p is at most 1e-3"
        Scalar, |r| r.stress_decomposition.share_of_deviator(&r.stress_decomposition.strong);
    "strong_q_over_pressure" "" "1" "deviatoric part of the stress they carry, over the whole pressure"
        Scalar, |r| r.stress_decomposition.deviator_over_pressure(&r.stress_decomposition.strong);
    "weak_contacts" "" "1" "number of weak contacts: the other contacts"
        Scalar, |r| r.stress_decomposition.weak.contacts;
    "weak_share_of_contacts" "" "1" "their share of all contacts"
        Scalar, |r| r.stress_decomposition.share_of_contacts(&r.stress_decomposition.weak);
    "weak_eps" "" "1" "eps of the weak contacts" Scalar, |r| some_contacts(&r.stress_decomposition.weak).map(|n| n.contact_anisotropy);
    "weak_fabric" "" "1" "their fabric tensor" Tensor, |r| some_contacts(&r.stress_decomposition.weak).map(|n| n.fabric);
    "weak_stress_pa" "" "Pa" "the stress they carry" Tensor, |r| r.stress_decomposition.weak.stress;
    "weak_share_of_pressure" "" "1" "their share of the pressure"
        Scalar, |r| r.stress_decomposition.share_of_pressure(&r.stress_decomposition.weak);
    "weak_share_of_deviator" "" "1" "their share of the stress deviator; unknown where q/p is at most 1e-3"
        Scalar, |r| r.stress_decomposition.share_of_deviator(&r.stress_decomposition.weak);
    "weak_q_over_pressure" "" "1" "deviatoric part of the stress they carry, over the whole pressure"
        Scalar, |r| r.stress_decomposition.deviator_over_pressure(&r.stress_decomposition.weak);
    // Forces.
    "mean_normal_force_n" "⟨F_n⟩" "N" "mean normal force" Scalar, |r| r.contacts.forces.map(|f| f.mean_normal);
    "mean_tangential_force_n" "⟨F_t⟩" "N" "mean size of the tangential force"
        Scalar, |r| r.contacts.forces.map(|f| f.mean_tangential);
    "force_moment_2" "⟨f^2⟩" "1" "mean of f^2, f the normal force over its mean"
        Scalar, |r| r.contacts.forces.map(|f| f.moments[0]);
    "force_moment_3" "⟨f^3⟩" "1" "mean of f^3, f the normal force over its mean"
        Scalar, |r| r.contacts.forces.map(|f| f.moments[1]);
    "force_moment_4" "⟨f^4⟩" "1" "mean of f^4, f the normal force over its mean"
        Scalar, |r| r.contacts.forces.map(|f| f.moments[2]);
    "participation" "" "1" "participation ratio, 1 over the mean of f^2"
        Scalar, |r| r.contacts.forces.map(|f| f.participation_ratio());
    "largest_force_ratio" "" "1" "largest f" Scalar, |r| r.contacts.forces.map(|f| f.largest);
    "force_bin_width" "" "1" "width of the bins of force_contacts; the last has no upper end"
        Scalar, |r| r.contacts.forces.map(|_| FORCE_BIN_WIDTH);
    "force_contacts" "" "1" "contacts by f" List, |r| r.contacts.forces.map(|f| f.histogram);
    "mobilised_mean" "" "1" "mean of |F_t|/(mu F_n), each at most 1" Scalar, |r| r.contacts.friction.map(|f| f.mean);
    "mobilised_share_at_limit" "" "1" "share of contacts at the Coulomb limit"
        Scalar, |r| r.contacts.friction.map(|_| r.contacts.sliding_fraction);
    "mobilised_contacts" "" "1" "contacts by |F_t|/(mu F_n), in tenths"
        List, |r| r.contacts.friction.map(|f| f.histogram);
    // Stiffness.
    "method" "" "" "how the stiffness was found: frozen_network, prestressed_network, probe"
        Scalar, |r| r.stiffness().map(|s| s.method.name());
    "smooth" "" "" "whether the stiffness is without tangential springs, as that of grains without friction"
        Scalar, |r| r.stiffness().map(|s| s.smooth);
    "g12_pa" "G12" "Pa" "shear modulus in the plane of isotropy"
        Scalar, |r| r.projected().map(|t| t.g12), or "c66_pa" x 1.0;
    "g13_pa" "G13" "Pa" "shear modulus along the axis h" Scalar, |r| r.projected().map(|t| t.g13), or "c44_pa" x 1.0;
    "theta_pa" "Θ" "Pa" "bulk modulus C_iijj/9 (Voigt: under isotropic strain)"
        Scalar, |r| r.stiffness().map(|s| s.tensor.bulk_voigt());
    "ti_c11_pa" "C11" "Pa" "P modulus across h, of the stiffness projected on media isotropic about h"
        Scalar, |r| r.projected().map(|t| t.c11), or "c11_pa" x 1.0;
    "ti_c33_pa" "C33" "Pa" "P modulus along h, likewise" Scalar, |r| r.projected().map(|t| t.c33), or "c33_pa" x 1.0;
    "ti_c13_pa" "C13" "Pa" "modulus that couples the two, likewise"
        Scalar, |r| r.projected().map(|t| t.c13), or "c13_pa" x 1.0;
    "theta_reuss_pa" "" "Pa" "bulk modulus under isotropic stress (Reuss)"
        Scalar, |r| r.stiffness().and_then(|s| s.tensor.bulk_reuss());
    "theta_bound_pa" "" "Pa" "lower bound of theta_reuss_pa by the forces present; none with rolling resistance, prestress or by the probe"
        Scalar, |r| r.stiffness().and_then(|s| s.bounds.bulk_reuss);
    "g_isotropic_pa" "G" "Pa" "shear modulus of the nearest isotropic stiffness, whose bulk modulus is theta_pa"
        Scalar, |r| r.stiffness().map(|s| s.tensor.shear_isotropic());
    "poisson_isotropic" "ν" "1" "Poisson ratio of the nearest isotropic stiffness"
        Scalar, |r| r.stiffness().map(|s| s.tensor.poisson_isotropic());
    "residual" "" "1" "relative residual of the solve, the worst of the six columns"
        Scalar, |r| r.stiffness().map(|s| s.residual);
    "stiffness_pa" "C" "Pa" "stiffness in the frame of the cell, engineering shear"
        Stiffness(""), |r| r.stiffness().map(|s| s.tensor);
    "stiffness_stddev_pa" "" "Pa" "error that the solver, or the probe, left in each entry; how much packings of one kind differ is not in it"
        Stiffness("stddev_"), |r| r.stiffness().map(|s| s.stddev);
    "stiffness_affine_pa" "" "Pa" "affine stiffness: every grain moves with the mean deformation"
        Stiffness("affine_"), |r| r.stiffness().map(|s| s.bounds.affine);
    "stiffness_mean_spin_pa" "" "Pa" "affine motion with one rotation of all grains"
        Stiffness("mean_spin_"), |r| r.stiffness().map(|s| s.bounds.uniform_rotation);
    // Symmetry of the stiffness.
    "symmetry" "" "" "isotropic, cubic, transversely isotropic, orthotropic or lower"
        Scalar, |r| r.symmetry.map(|s| s.class.name());
    "symmetry_tolerance" "" "1" "largest residual that counts as noise: 1.1/sqrt(grains), which isotropic packings scatter by, but at most 0.05"
        Scalar, |r| r.symmetry.map(|s| s.tolerance);
    "symmetry_axis" "" "1" "axis of the nearest transversely isotropic stiffness"
        Vector, |r| r.symmetry.map(|s| s.axis);
    "symmetry_angle_to_fabric_rad" "" "rad" "angle between this axis and that of the fabric, where both are determined"
        Scalar, |r| r.symmetry_angle_to_fabric();
    "residual_isotropic" "" "1" "relative distance to the nearest isotropic stiffness (Mandel norm)"
        Scalar, |r| r.symmetry.map(|s| s.isotropic);
    "residual_cubic" "" "1" "relative distance to the nearest cubic stiffness (Mandel norm)"
        Scalar, |r| r.symmetry.map(|s| s.cubic);
    "residual_transversely_isotropic" "" "1" "relative distance to the nearest transversely isotropic stiffness (Mandel norm)"
        Scalar, |r| r.symmetry.map(|s| s.transversely_isotropic);
    "residual_orthotropic" "" "1" "relative distance to the nearest orthotropic stiffness (Mandel norm)"
        Scalar, |r| r.symmetry.map(|s| s.orthotropic);
    "residual_about_z" "" "1" "the same to the nearest one that is transversely isotropic about z"
        Scalar, |r| r.stiffness().map(|s| s.tensor.transverse_isotropy().residual);
    "symmetry_c11_pa" "C11" "Pa" "of the nearest transversely isotropic stiffness, about symmetry_axis"
        Scalar, |r| r.symmetry.map(|s| s.moduli.c11);
    "symmetry_c12_pa" "C12" "Pa" "of the nearest transversely isotropic stiffness, about symmetry_axis"
        Scalar, |r| r.symmetry.map(|s| s.moduli.c12);
    "symmetry_c13_pa" "C13" "Pa" "of the nearest transversely isotropic stiffness, about symmetry_axis"
        Scalar, |r| r.symmetry.map(|s| s.moduli.c13);
    "symmetry_c33_pa" "C33" "Pa" "of the nearest transversely isotropic stiffness, about symmetry_axis"
        Scalar, |r| r.symmetry.map(|s| s.moduli.c33);
    "symmetry_g12_pa" "G12" "Pa" "of the nearest transversely isotropic stiffness, about symmetry_axis"
        Scalar, |r| r.symmetry.map(|s| s.moduli.g12);
    "symmetry_g13_pa" "G13" "Pa" "of the nearest transversely isotropic stiffness, about symmetry_axis"
        Scalar, |r| r.symmetry.map(|s| s.moduli.g13);
};

fn orientation(r: &PackingReport) -> Option<OrientationFit> {
    r.fabric.orientation.contact_fit
}

/// A network with contacts: one without has no fabric.
fn some_contacts(network: &SubNetwork) -> Option<&SubNetwork> {
    Some(network).filter(|network| network.contacts > 0)
}

fn anisotropies(r: &PackingReport) -> Option<StressForceFabric> {
    r.stress_decomposition.stress_force_fabric
}

/// a of the distribution 1 + a (x² − 1/3) that an anisotropy tensor makes about h.
fn along(r: &PackingReport, tensor: &SymTensor) -> f64 {
    StressForceFabric::along(tensor, &r.fabric.reference_axis)
}

fn bin_edges() -> [f64; ORIENTATION_BINS + 1] {
    std::array::from_fn(|b| b as f64 / ORIENTATION_BINS as f64)
}

/// A property of the orientation of contacts: unknown without contacts.
fn of_contacts(r: &PackingReport, value: f64) -> Option<f64> {
    (r.contacts.contacts > 0).then_some(value)
}

/// Means of the bins that have contacts.
fn known(r: &PackingReport, means: &[f64; ORIENTATION_BINS]) -> [Option<f64>; ORIENTATION_BINS] {
    let counts = &r.fabric.orientation.contacts;
    std::array::from_fn(|b| (counts[b] > 0).then_some(means[b]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn every_key_and_column_is_there_once_and_every_number_has_a_unit() {
        let (mut keys, mut columns) = (BTreeSet::new(), BTreeSet::new());
        for q in QUANTITIES {
            assert!(keys.insert(q.key), "{} is there twice", q.key);
            for column in q.columns() {
                assert!(columns.insert(column.clone()), "column {column} is there twice");
            }
            assert!(!q.meaning.is_empty() && !q.meaning.ends_with('.'), "{}", q.key);
            let has_unit = ["_pa", "_n", "_m", "_rad"].iter().any(|end| q.key.ends_with(end));
            assert_eq!(has_unit, !matches!(q.unit, "" | "1"), "{}: the key ends with the unit", q.key);
        }
    }
}
