// Generated from msg/Fabric.msg by examples/generate; not edited by hand.

use crate::generated::geometry_msgs::Vector3;
use crate::generated::grainlab_msgs::SymmetricTensor;
use crate::generated::std_msgs::Header;
use crate::message::{Message, definition};
use serde::{Deserialize, Serialize};

/// Structure of one packing. h is the reference axis, e3 = z unless the analyzer was told another; x = |n.h|, n a contact normal.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Fabric {
    /// copied from the Packing measured
    pub header: Header,
    /// step of the Packing measured
    pub source_step: u64,
    /// Dimensionless.
    pub grains: u32,
    /// Dimensionless.
    pub contacts: u32,
    /// recursively fewer than 2 contacts with friction, 4 without
    pub rattlers: u32,
    /// 2 contacts / grains, all grains
    pub k: f64,
    /// the same without rattlers and their contacts
    pub z: f64,
    /// mean of n n, trace 1 (Eq. 2)
    pub contact_fabric: SymmetricTensor,
    /// weighted by normal force, trace 1
    pub force_fabric: SymmetricTensor,
    /// weighted by normal stiffness, trace 1
    pub stiffness_fabric: SymmetricTensor,
    /// 5/2 (L33 - (L11 + L22)/2), about h (Eq. 20)
    pub eps: f64,
    /// unit eigenvector of the contact fabric furthest from isotropy, z \>= 0
    pub axis: Vector3,
    /// coefficient of P4(cos) in the contact distribution about h
    pub fourth_order: f64,
    /// whether the next field is valid
    pub gamma_over_delta_total_known: bool,
    /// of the strain since the reference state, else 0
    pub gamma_over_delta_total: f64,
    /// whether the next field is valid
    pub gamma_over_delta_elastic_known: bool,
    /// of an isotropic stress increment on the frozen network, else 0
    pub gamma_over_delta_elastic: f64,
    /// whether the next field is valid
    pub gamma_over_delta_contact_known: bool,
    /// fitted to the overlaps, else 0
    pub gamma_over_delta_contact: f64,
    /// share of contacts at the Coulomb limit, 0 = none or no limit
    pub mobilised: f64,
    /// h, unit
    pub reference_axis: Vector3,
    /// eps about the axis found
    pub axis_eps: f64,
    /// whether the next field is valid; not with fewer than 30 contacts
    pub axis_eps_stddev_known: bool,
    /// standard deviation of eps among packings like this one, else 0
    pub axis_eps_stddev: f64,
    /// whether the next field is valid; not where it would exceed 1 rad
    pub axis_angle_stddev_known: bool,
    /// rad, of the direction of the axis found, else 0
    pub axis_angle_stddev: f64,
    /// whether the anisotropy exceeds its noise and one axis stands out; else any axis is as good
    pub axis_determined: bool,
    /// mean of t t weighted by |Ft|, t along Ft, trace 1, all 0 = no tangential forces
    pub tangential_fabric: SymmetricTensor,
    /// mean of n n n n: xxxx xxxy xxxz xxyy xxyz xxzz xyyy xyyz xyzz xzzz yyyy yyyz yyzz yzzz zzzz
    pub fourth_order_fabric: [f64; 15],
    /// of its harmonic part: |a4| where that is a4 P4 about some axis
    pub fourth_order_magnitude: f64,
    /// Pa, stress of the normal forces, positive in compression
    pub stress_normal: SymmetricTensor,
    /// Pa, stress of the tangential forces; both add up to the stress
    pub stress_tangential: SymmetricTensor,
    /// whether the next four fields are valid; not without normal forces
    pub stress_force_fabric_known: bool,
    /// traceless: contacts are distributed as 1 + a.nn
    pub anisotropy_contacts: SymmetricTensor,
    /// traceless: normal forces as 1 + a.nn
    pub anisotropy_normal_forces: SymmetricTensor,
    /// traceless: branch lengths as 1 + a.nn
    pub anisotropy_branches: SymmetricTensor,
    /// traceless: tangential forces as a.n - (n.a.n) n, in mean normal forces
    pub anisotropy_tangential_forces: SymmetricTensor,
    /// contacts by x, bins of 0.1 from 0
    pub orientation_contacts: [u32; 10],
    /// m, mean overlap of each bin, 0 where there is no contact
    pub orientation_overlap: [f64; 10],
    /// m^0.5, mean square root of the overlap of each bin, 0 where there is no contact
    pub orientation_sqrt_overlap: [f64; 10],
    /// whether the next three fields are valid
    pub orientation_fit_known: bool,
    /// maximum likelihood of (1 - eps) + 3 eps x^2 (Eq. 6), else 0
    pub orientation_eps: f64,
    /// its standard error for independent contacts, else 0
    pub orientation_eps_stddev: f64,
    /// chi^2 of orientation_contacts over its 8 degrees of freedom, else 0
    pub orientation_chi2: f64,
    /// whether the next field is valid
    pub gamma_over_delta_contact_stddev_known: bool,
    /// standard error for independent contacts, else 0
    pub gamma_over_delta_contact_stddev: f64,
    /// contacts with more than the mean normal force; the others are weak
    pub strong_contacts: u32,
    /// mean of n n of the strong contacts, trace 1, all 0 = none
    pub strong_fabric: SymmetricTensor,
    /// mean of n n of the weak contacts, trace 1, all 0 = none
    pub weak_fabric: SymmetricTensor,
    /// eps of the strong contacts about h
    pub strong_eps: f64,
    /// eps of the weak contacts about h
    pub weak_eps: f64,
    /// Pa, stress that the strong contacts carry
    pub strong_stress: SymmetricTensor,
    /// Pa, stress that the weak contacts carry; both add up to the stress
    pub weak_stress: SymmetricTensor,
    /// whether the next fields up to force_contacts are valid; not without normal forces
    pub forces_known: bool,
    /// N, mean normal force, else 0
    pub force_mean_normal: f64,
    /// N, mean |Ft|, else 0
    pub force_mean_tangential: f64,
    /// means of f^2, f^3, f^4, f = Fn over its mean, else 0
    pub force_moments: [f64; 3],
    /// largest f, else 0
    pub force_largest: f64,
    /// contacts by f, bins of 0.25 from 0, the last without upper end
    pub force_contacts: [u32; 20],
    /// whether the next fields are valid; not without friction, nor with an infinite one
    pub mobilisation_known: bool,
    /// mean of |Ft|/(mu Fn), each at most 1, else 0
    pub mobilisation_mean: f64,
    /// contacts by |Ft|/(mu Fn), bins of 0.1 from 0, the last with those at the limit
    pub mobilisation_contacts: [u32; 10],
}

impl Message for Fabric {
    const PACKAGE: &'static str = "grainlab_msgs";
    const NAME: &'static str = "Fabric";
    const TYPE: &'static str = "grainlab_msgs/msg/Fabric";
    const HASH: &'static str = "RIHS01_b647428b3411fc0c64d1a5cb712ac45e22b680f817483f187bba2f329f8c3826";
    const DEFINITION: &'static str = definition!(
        "msg/Fabric.msg",
        "geometry_msgs/Vector3" => "std/geometry_msgs/msg/Vector3.msg",
        "grainlab_msgs/SymmetricTensor" => "msg/SymmetricTensor.msg",
        "std_msgs/Header" => "std/std_msgs/msg/Header.msg",
        "builtin_interfaces/Time" => "std/builtin_interfaces/msg/Time.msg",
    );
}
