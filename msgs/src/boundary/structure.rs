//! The parts of a `Fabric` message.

use super::BoundaryError;
use super::check::{tensor_message, vector_message};
use super::fabric::{CHECK, FabricReading};
use crate::msg;
use grainlab_core::Vec3;
use grainlab_core::results::{
    ContactStatistics, Fabric, ForceStatistics, FourthOrderFabric, MobilisedFriction, OrientationFit,
    OrientationHistogram, OverlapAnisotropyFit, PackingReport, PrincipalAxis, StrainRatios,
    StressDecomposition, StressForceFabric, SubNetwork,
};

/// A message with these fields set.
pub(super) fn structure_message(report: &PackingReport) -> msg::Fabric {
    let (c, f, d) = (&report.contacts, &report.fabric, &report.stress_decomposition);
    let (o, axis) = (&f.orientation, &f.principal_axis);
    let fit = o.contact_fit.unwrap_or_default();
    let g_stddev = o.overlap_fit.and_then(|f| f.g_stddev);
    let a = d.stress_force_fabric.unwrap_or_default();
    let forces = c.forces.unwrap_or_default();
    let friction = c.friction.unwrap_or_default();
    msg::Fabric {
        reference_axis: vector_message(&f.reference_axis),
        axis_eps: axis.contact_anisotropy,
        axis_eps_stddev_known: axis.contact_anisotropy_stddev.is_some(),
        axis_eps_stddev: axis.contact_anisotropy_stddev.unwrap_or(0.0),
        axis_angle_stddev_known: axis.angle_stddev.is_some(),
        axis_angle_stddev: axis.angle_stddev.unwrap_or(0.0),
        axis_determined: axis.determined,
        tangential_fabric: tensor_message(&f.tangential_force_fabric),
        fourth_order_fabric: f.fourth_order.components,
        fourth_order_magnitude: f.fourth_order.magnitude,
        stress_normal: tensor_message(&d.normal),
        stress_tangential: tensor_message(&d.tangential),
        stress_force_fabric_known: d.stress_force_fabric.is_some(),
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
        strong_contacts: d.strong.contacts,
        strong_fabric: tensor_message(&d.strong.fabric),
        weak_fabric: tensor_message(&d.weak.fabric),
        strong_eps: d.strong.contact_anisotropy,
        weak_eps: d.weak.contact_anisotropy,
        strong_stress: tensor_message(&d.strong.stress),
        weak_stress: tensor_message(&d.weak.stress),
        forces_known: c.forces.is_some(),
        force_mean_normal: forces.mean_normal,
        force_mean_tangential: forces.mean_tangential,
        force_moments: forces.moments,
        force_largest: forces.largest,
        force_contacts: forces.histogram,
        mobilisation_known: c.friction.is_some(),
        mobilisation_mean: friction.mean,
        mobilisation_contacts: friction.histogram,
        ..msg::Fabric::default()
    }
}

/// What a message holds.
pub(super) fn reading(m: &msg::Fabric) -> Result<FabricReading, BoundaryError> {
    CHECK.all_finite("fourth_order_fabric", &m.fourth_order_fabric)?;
    Ok(FabricReading {
        contacts: ContactStatistics {
            grains: m.grains,
            contacts: m.contacts,
            rattlers: m.rattlers,
            coordination: CHECK.not_negative("k", m.k)?,
            mechanical_coordination: CHECK.not_negative("z", m.z)?,
            sliding_fraction: CHECK.share("mobilised", m.mobilised)?,
            forces: forces(m)?,
            friction: friction(m)?,
        },
        fabric: Fabric {
            reference_axis: unit("reference_axis", m)?,
            contact_fabric: CHECK.tensor("contact_fabric", &m.contact_fabric)?,
            normal_force_fabric: CHECK.tensor("force_fabric", &m.force_fabric)?,
            tangential_force_fabric: CHECK.tensor("tangential_fabric", &m.tangential_fabric)?,
            stiffness_fabric: CHECK.tensor("stiffness_fabric", &m.stiffness_fabric)?,
            contact_anisotropy: CHECK.finite("eps", m.eps)?,
            p4_coefficient: CHECK.finite("fourth_order", m.fourth_order)?,
            fourth_order: FourthOrderFabric {
                components: m.fourth_order_fabric,
                magnitude: CHECK.not_negative("fourth_order_magnitude", m.fourth_order_magnitude)?,
            },
            principal_axis: axis(m)?,
            orientation: orientation(m)?,
        },
        stress_decomposition: stress_decomposition(m)?,
        strain_ratios: strain_ratios(m)?,
    })
}

fn strain_ratios(m: &msg::Fabric) -> Result<StrainRatios, BoundaryError> {
    let total = (m.gamma_over_delta_total_known, m.gamma_over_delta_total);
    let elastic = (m.gamma_over_delta_elastic_known, m.gamma_over_delta_elastic);
    let contact = (m.gamma_over_delta_contact_known, m.gamma_over_delta_contact);
    Ok(StrainRatios {
        total: CHECK.ratio("gamma_over_delta_total", total)?,
        elastic: CHECK.ratio("gamma_over_delta_elastic", elastic)?,
        contact: CHECK.ratio("gamma_over_delta_contact", contact)?,
    })
}

fn stress_decomposition(m: &msg::Fabric) -> Result<StressDecomposition, BoundaryError> {
    let strong_contacts = m.strong_contacts;
    let few = "at most the number of contacts";
    CHECK.that(strong_contacts <= m.contacts, "strong_contacts", f64::from(strong_contacts), few)?;
    Ok(StressDecomposition {
        normal: CHECK.tensor("stress_normal", &m.stress_normal)?,
        tangential: CHECK.tensor("stress_tangential", &m.stress_tangential)?,
        strong: SubNetwork {
            contacts: strong_contacts,
            fabric: CHECK.tensor("strong_fabric", &m.strong_fabric)?,
            contact_anisotropy: CHECK.finite("strong_eps", m.strong_eps)?,
            stress: CHECK.tensor("strong_stress", &m.strong_stress)?,
        },
        weak: SubNetwork {
            contacts: m.contacts - strong_contacts,
            fabric: CHECK.tensor("weak_fabric", &m.weak_fabric)?,
            contact_anisotropy: CHECK.finite("weak_eps", m.weak_eps)?,
            stress: CHECK.tensor("weak_stress", &m.weak_stress)?,
        },
        stress_force_fabric: anisotropies(m)?,
    })
}

fn unit(field: &str, m: &msg::Fabric) -> Result<Vec3, BoundaryError> {
    let direction = CHECK.direction(field, &m.reference_axis)?;
    CHECK.that(direction.is_some(), &format!("|{field}|"), 0.0, "1")?;
    Ok(direction.unwrap_or_default())
}

fn axis(m: &msg::Fabric) -> Result<PrincipalAxis, BoundaryError> {
    Ok(PrincipalAxis {
        direction: CHECK.direction("axis", &m.axis)?.unwrap_or_else(Vec3::zeros),
        contact_anisotropy: CHECK.finite("axis_eps", m.axis_eps)?,
        contact_anisotropy_stddev: spread("axis_eps_stddev", (m.axis_eps_stddev_known, m.axis_eps_stddev))?,
        angle_stddev: spread("axis_angle_stddev", (m.axis_angle_stddev_known, m.axis_angle_stddev))?,
        determined: m.axis_determined,
    })
}

/// A standard deviation, known or not.
fn spread(field: &str, (known, value): (bool, f64)) -> Result<Option<f64>, BoundaryError> {
    if known { CHECK.not_negative(field, value).map(Some) } else { Ok(None) }
}

fn orientation(m: &msg::Fabric) -> Result<OrientationHistogram, BoundaryError> {
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
        Some(OrientationFit {
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
    Ok(OrientationHistogram {
        contacts: m.orientation_contacts,
        overlap: m.orientation_overlap,
        sqrt_overlap: m.orientation_sqrt_overlap,
        contact_fit,
        overlap_fit: g.map(|g| OverlapAnisotropyFit { g, g_stddev }),
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

fn forces(m: &msg::Fabric) -> Result<Option<ForceStatistics>, BoundaryError> {
    if !m.forces_known {
        return Ok(None);
    }
    of_all_contacts("force_contacts", &m.force_contacts, m)?;
    CHECK.all_finite("force_moments", &m.force_moments)?;
    CHECK.positive("force_moments[0]", m.force_moments[0])?;
    Ok(Some(ForceStatistics {
        mean_normal: CHECK.positive("force_mean_normal", m.force_mean_normal)?,
        mean_tangential: CHECK.not_negative("force_mean_tangential", m.force_mean_tangential)?,
        moments: m.force_moments,
        largest: CHECK.positive("force_largest", m.force_largest)?,
        histogram: m.force_contacts,
    }))
}

fn friction(m: &msg::Fabric) -> Result<Option<MobilisedFriction>, BoundaryError> {
    if !m.mobilisation_known {
        return Ok(None);
    }
    of_all_contacts("mobilisation_contacts", &m.mobilisation_contacts, m)?;
    Ok(Some(MobilisedFriction {
        mean: CHECK.share("mobilisation_mean", m.mobilisation_mean)?,
        histogram: m.mobilisation_contacts,
    }))
}

/// A histogram holds every contact once.
fn of_all_contacts(field: &str, counts: &[u32], m: &msg::Fabric) -> Result<(), BoundaryError> {
    let sum: u64 = counts.iter().map(|c| u64::from(*c)).sum();
    let requirement = "the number of contacts";
    CHECK.that(sum == u64::from(m.contacts), &format!("sum of {field}"), sum as f64, requirement).map(drop)
}
