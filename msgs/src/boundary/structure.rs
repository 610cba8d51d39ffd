//! The part of `Fabric` that is a packing's [`Structure`].

use super::BoundaryError;
use super::check::{tensor_message, vector_message};
use super::fabric::CHECK;
use crate::msg;
use grainlab_core::structure::{
    AxisFound, ContactFit, Forces, FourthOrderFabric, Mobilisation, NetworkPart, Orientation, OverlapFit,
    StressForceFabric, StressParts,
};
use grainlab_core::{Structure, Vec3};

/// A message with the fields of the structure set.
pub(super) fn structure_message(s: &Structure) -> msg::Fabric {
    let (o, axis) = (&s.orientation, &s.axis);
    let fit = o.contact_fit.unwrap_or_default();
    let g_stddev = o.overlap_fit.and_then(|f| f.g_stddev);
    let a = s.stress_force_fabric.unwrap_or_default();
    let forces = s.forces.unwrap_or_default();
    let mobilisation = s.mobilisation.unwrap_or_default();
    msg::Fabric {
        reference_axis: vector_message(&s.reference_axis),
        axis_eps: axis.eps,
        axis_eps_stddev_known: axis.eps_stddev.is_some(),
        axis_eps_stddev: axis.eps_stddev.unwrap_or(0.0),
        axis_angle_stddev_known: axis.angle_stddev.is_some(),
        axis_angle_stddev: axis.angle_stddev.unwrap_or(0.0),
        axis_determined: axis.determined,
        tangential_fabric: tensor_message(&s.tangential_fabric),
        fourth_order_fabric: s.fourth_order.components,
        fourth_order_magnitude: s.fourth_order.magnitude,
        stress_normal: tensor_message(&s.stress.normal),
        stress_tangential: tensor_message(&s.stress.tangential),
        stress_force_fabric_known: s.stress_force_fabric.is_some(),
        anisotropy_contacts: tensor_message(&a.contacts),
        anisotropy_normal_forces: tensor_message(&a.normal_forces),
        anisotropy_branches: tensor_message(&a.branches),
        anisotropy_tangential_forces: tensor_message(&a.tangential_forces),
        orientation_contacts: o.contacts,
        orientation_overlap: o.overlap,
        orientation_sqrt_overlap: o.sqrt_overlap,
        orientation_fit_known: o.contact_fit.is_some(),
        orientation_eps: fit.eps,
        orientation_eps_stddev: fit.eps_stddev,
        orientation_chi2: fit.chi2_per_dof,
        gamma_over_delta_contact_stddev_known: g_stddev.is_some(),
        gamma_over_delta_contact_stddev: g_stddev.unwrap_or(0.0),
        strong_contacts: s.strong.contacts,
        strong_fabric: tensor_message(&s.strong.fabric),
        weak_fabric: tensor_message(&s.weak.fabric),
        strong_eps: s.strong.eps,
        weak_eps: s.weak.eps,
        strong_stress: tensor_message(&s.strong.stress),
        weak_stress: tensor_message(&s.weak.stress),
        forces_known: s.forces.is_some(),
        force_mean_normal: forces.mean_normal,
        force_mean_tangential: forces.mean_tangential,
        force_moments: forces.moments,
        force_largest: forces.largest,
        force_contacts: forces.contacts,
        mobilisation_known: s.mobilisation.is_some(),
        mobilisation_mean: mobilisation.mean,
        mobilisation_contacts: mobilisation.contacts,
        ..msg::Fabric::default()
    }
}

/// The structure that a message holds.
pub(super) fn structure(m: &msg::Fabric) -> Result<Structure, BoundaryError> {
    let strong_contacts = m.strong_contacts;
    let few = "at most the number of contacts";
    CHECK.that(strong_contacts <= m.contacts, "strong_contacts", f64::from(strong_contacts), few)?;
    let weak_contacts = m.contacts - strong_contacts;
    CHECK.all_finite("fourth_order_fabric", &m.fourth_order_fabric)?;
    Ok(Structure {
        reference_axis: unit("reference_axis", m)?,
        axis: axis(m)?,
        tangential_fabric: CHECK.tensor("tangential_fabric", &m.tangential_fabric)?,
        fourth_order: FourthOrderFabric {
            components: m.fourth_order_fabric,
            magnitude: CHECK.not_negative("fourth_order_magnitude", m.fourth_order_magnitude)?,
        },
        orientation: orientation(m)?,
        stress: StressParts {
            normal: CHECK.tensor("stress_normal", &m.stress_normal)?,
            tangential: CHECK.tensor("stress_tangential", &m.stress_tangential)?,
        },
        stress_force_fabric: anisotropies(m)?,
        strong: NetworkPart {
            contacts: strong_contacts,
            fabric: CHECK.tensor("strong_fabric", &m.strong_fabric)?,
            eps: CHECK.finite("strong_eps", m.strong_eps)?,
            stress: CHECK.tensor("strong_stress", &m.strong_stress)?,
        },
        weak: NetworkPart {
            contacts: weak_contacts,
            fabric: CHECK.tensor("weak_fabric", &m.weak_fabric)?,
            eps: CHECK.finite("weak_eps", m.weak_eps)?,
            stress: CHECK.tensor("weak_stress", &m.weak_stress)?,
        },
        forces: forces(m)?,
        mobilisation: mobilisation(m)?,
    })
}

fn unit(field: &str, m: &msg::Fabric) -> Result<Vec3, BoundaryError> {
    let direction = CHECK.direction(field, &m.reference_axis)?;
    CHECK.that(direction.is_some(), &format!("|{field}|"), 0.0, "1")?;
    Ok(direction.unwrap_or_default())
}

fn axis(m: &msg::Fabric) -> Result<AxisFound, BoundaryError> {
    Ok(AxisFound {
        eps: CHECK.finite("axis_eps", m.axis_eps)?,
        eps_stddev: spread("axis_eps_stddev", (m.axis_eps_stddev_known, m.axis_eps_stddev))?,
        angle_stddev: spread("axis_angle_stddev", (m.axis_angle_stddev_known, m.axis_angle_stddev))?,
        determined: m.axis_determined,
    })
}

/// A standard deviation, known or not.
fn spread(field: &str, (known, value): (bool, f64)) -> Result<Option<f64>, BoundaryError> {
    if known { CHECK.not_negative(field, value).map(Some) } else { Ok(None) }
}

fn orientation(m: &msg::Fabric) -> Result<Orientation, BoundaryError> {
    of_all_contacts("orientation_contacts", &m.orientation_contacts, m)?;
    for (field, means) in [
        ("orientation_overlap", &m.orientation_overlap),
        ("orientation_sqrt_overlap", &m.orientation_sqrt_overlap),
    ] {
        for (index, mean) in means.iter().enumerate() {
            CHECK.not_negative(&format!("{field}[{index}]"), *mean)?;
        }
    }
    let contact_fit = if m.orientation_fit_known {
        let eps = m.orientation_eps;
        let requirement = "between -1/2 and 1, where no contact density is negative";
        Some(ContactFit {
            eps: CHECK.that((-0.5..=1.0).contains(&eps), "orientation_eps", eps, requirement)?,
            eps_stddev: CHECK.not_negative("orientation_eps_stddev", m.orientation_eps_stddev)?,
            chi2_per_dof: CHECK.not_negative("orientation_chi2", m.orientation_chi2)?,
        })
    } else {
        None
    };
    let g = CHECK
        .ratio("gamma_over_delta_contact", (m.gamma_over_delta_contact_known, m.gamma_over_delta_contact))?;
    let g_stddev = spread(
        "gamma_over_delta_contact_stddev",
        (m.gamma_over_delta_contact_stddev_known, m.gamma_over_delta_contact_stddev),
    )?;
    Ok(Orientation {
        contacts: m.orientation_contacts,
        overlap: m.orientation_overlap,
        sqrt_overlap: m.orientation_sqrt_overlap,
        contact_fit,
        overlap_fit: g.map(|g| OverlapFit { g, g_stddev }),
    })
}

fn anisotropies(m: &msg::Fabric) -> Result<Option<StressForceFabric>, BoundaryError> {
    if !m.stress_force_fabric_known {
        return Ok(None);
    }
    Ok(Some(StressForceFabric {
        contacts: CHECK.tensor("anisotropy_contacts", &m.anisotropy_contacts)?,
        normal_forces: CHECK.tensor("anisotropy_normal_forces", &m.anisotropy_normal_forces)?,
        branches: CHECK.tensor("anisotropy_branches", &m.anisotropy_branches)?,
        tangential_forces: CHECK.tensor("anisotropy_tangential_forces", &m.anisotropy_tangential_forces)?,
    }))
}

fn forces(m: &msg::Fabric) -> Result<Option<Forces>, BoundaryError> {
    if !m.forces_known {
        return Ok(None);
    }
    of_all_contacts("force_contacts", &m.force_contacts, m)?;
    CHECK.all_finite("force_moments", &m.force_moments)?;
    CHECK.positive("force_moments[0]", m.force_moments[0])?;
    Ok(Some(Forces {
        mean_normal: CHECK.positive("force_mean_normal", m.force_mean_normal)?,
        mean_tangential: CHECK.not_negative("force_mean_tangential", m.force_mean_tangential)?,
        moments: m.force_moments,
        largest: CHECK.positive("force_largest", m.force_largest)?,
        contacts: m.force_contacts,
    }))
}

fn mobilisation(m: &msg::Fabric) -> Result<Option<Mobilisation>, BoundaryError> {
    if !m.mobilisation_known {
        return Ok(None);
    }
    of_all_contacts("mobilisation_contacts", &m.mobilisation_contacts, m)?;
    Ok(Some(Mobilisation {
        mean: CHECK.share("mobilisation_mean", m.mobilisation_mean)?,
        contacts: m.mobilisation_contacts,
    }))
}

/// A histogram holds every contact once.
fn of_all_contacts(field: &str, counts: &[u32], m: &msg::Fabric) -> Result<(), BoundaryError> {
    let sum: u64 = counts.iter().map(|c| u64::from(*c)).sum();
    let requirement = "the number of contacts";
    CHECK.that(sum == u64::from(m.contacts), &format!("sum of {field}"), sum as f64, requirement).map(drop)
}
