//! Structure and symmetry of a state in CSV.

use super::structure::StructureView;
use super::symmetry::SymmetryView;
use grainlab_console::exact;

/// Columns of the structure: what is one number.
pub(crate) const STRUCTURE: [&str; 29] = [
    "axis_eps",
    "axis_eps_stddev",
    "axis_angle_stddev_rad",
    "axis_determined",
    "fourth_order_magnitude",
    "p4",
    "orientation_eps",
    "orientation_eps_stddev",
    "orientation_chi2_per_dof",
    "g_contact_stddev",
    "a_contacts",
    "a_normal_forces",
    "a_branches",
    "a_tangential_forces",
    "q_over_p",
    "predicted_q_over_p",
    "strong_contacts",
    "strong_eps",
    "weak_eps",
    "strong_share_of_pressure",
    "strong_share_of_deviator",
    "mean_normal_force_n",
    "mean_tangential_force_n",
    "force_moment_2",
    "force_moment_3",
    "force_moment_4",
    "participation",
    "mobilised_mean",
    "mobilised_share_at_limit",
];

/// Cells under [`STRUCTURE`].
pub(crate) fn structure_cells(s: &StructureView) -> [String; 29] {
    let (o, a, forces) = (&s.orientation, s.stress_force_fabric.as_ref(), s.forces.as_ref());
    let along = a.map(|a| a.along_axis);
    let number = |v: f64| exact(Some(v));
    [
        number(s.axis.eps),
        exact(s.axis.eps_stddev),
        exact(s.axis.angle_stddev_rad),
        s.axis.determined.to_string(),
        number(s.fabrics.fourth_order_magnitude),
        number(s.fabrics.p4),
        exact(o.eps),
        exact(o.eps_stddev),
        exact(o.chi2_per_dof),
        exact(o.g_stddev),
        exact(along.map(|a| a.contacts)),
        exact(along.map(|a| a.normal_forces)),
        exact(along.map(|a| a.branches)),
        exact(along.map(|a| a.tangential_forces)),
        exact(a.and_then(|a| a.q_over_p)),
        exact(a.map(|a| a.predicted_q_over_p)),
        s.strong.contacts.to_string(),
        number(s.strong.eps),
        number(s.weak.eps),
        exact(s.strong.share_of_pressure),
        exact(s.strong.share_of_deviator),
        exact(forces.map(|f| f.mean_normal_n)),
        exact(forces.map(|f| f.mean_tangential_n)),
        exact(forces.map(|f| f.moments[0])),
        exact(forces.map(|f| f.moments[1])),
        exact(forces.map(|f| f.moments[2])),
        exact(forces.map(|f| f.participation)),
        exact(s.friction.as_ref().map(|f| f.mean)),
        exact(s.friction.as_ref().map(|f| f.share_at_limit)),
    ]
}

/// Columns of the symmetry.
pub(crate) const SYMMETRY: [&str; 9] = [
    "symmetry",
    "symmetry_tolerance",
    "symmetry_axis_x",
    "symmetry_axis_y",
    "symmetry_axis_z",
    "residual_isotropic",
    "residual_cubic",
    "residual_transversely_isotropic",
    "residual_orthotropic",
];

/// Cells under [`SYMMETRY`], empty without a stiffness.
pub(crate) fn symmetry_cells(s: Option<&SymmetryView>) -> [String; 9] {
    let Some(s) = s else { return std::array::from_fn(|_| String::new()) };
    let (number, r) = (|v: f64| exact(Some(v)), &s.residuals);
    let [x, y, z] = s.axis.map(number);
    [
        s.class.to_owned(),
        number(s.tolerance),
        x,
        y,
        z,
        number(r.isotropic),
        number(r.cubic),
        number(r.transversely_isotropic),
        number(r.orthotropic),
    ]
}
