//! `Fabric`: orientation of the contacts of a packing.

use super::check::{Check, one_or_none, tensor_message, vector_message};
use super::contact_statistics::every_contact;
use super::error::BoundaryError;
use crate::msg;
use grainlab_core::results::{
    Fabric, FourthOrderFabric, OrientationFit, OrientationHistogram, OverlapAnisotropyFit, PrincipalAxis,
};

const CHECK: Check = Check("PackingReport.fabric");

pub(super) fn fabric_message(f: &Fabric) -> msg::Fabric {
    msg::Fabric {
        reference_axis: vector_message(&f.reference_axis),
        contact_fabric: tensor_message(&f.contact_fabric),
        normal_force_fabric: tensor_message(&f.normal_force_fabric),
        tangential_force_fabric: tensor_message(&f.tangential_force_fabric),
        stiffness_fabric: tensor_message(&f.stiffness_fabric),
        contact_anisotropy: f.contact_anisotropy,
        p4_coefficient: f.p4_coefficient,
        fourth_order_fabric: f.fourth_order.components,
        fourth_order_magnitude: f.fourth_order.magnitude,
        principal_axis: principal_axis_message(&f.principal_axis),
        orientation: orientation_message(&f.orientation),
    }
}

pub(super) fn fabric(m: &msg::Fabric, contacts: u32) -> Result<Fabric, BoundaryError> {
    CHECK.all_finite("fourth_order_fabric", &m.fourth_order_fabric)?;
    Ok(Fabric {
        reference_axis: CHECK.unit("reference_axis", &m.reference_axis)?,
        contact_fabric: CHECK.tensor("contact_fabric", &m.contact_fabric)?,
        normal_force_fabric: CHECK.tensor("normal_force_fabric", &m.normal_force_fabric)?,
        tangential_force_fabric: CHECK.tensor("tangential_force_fabric", &m.tangential_force_fabric)?,
        stiffness_fabric: CHECK.tensor("stiffness_fabric", &m.stiffness_fabric)?,
        contact_anisotropy: CHECK.finite("contact_anisotropy", m.contact_anisotropy)?,
        p4_coefficient: CHECK.finite("p4_coefficient", m.p4_coefficient)?,
        fourth_order: FourthOrderFabric {
            components: m.fourth_order_fabric,
            magnitude: CHECK.not_negative("fourth_order_magnitude", m.fourth_order_magnitude)?,
        },
        principal_axis: principal_axis(&m.principal_axis)?,
        orientation: orientation(&m.orientation, contacts)?,
    })
}

fn principal_axis_message(axis: &PrincipalAxis) -> msg::PrincipalAxis {
    msg::PrincipalAxis {
        direction: vector_message(&axis.direction),
        contact_anisotropy: axis.contact_anisotropy,
        contact_anisotropy_stddev: one_or_none(axis.contact_anisotropy_stddev),
        angle_stddev: one_or_none(axis.angle_stddev),
        determined: axis.determined,
    }
}

fn principal_axis(m: &msg::PrincipalAxis) -> Result<PrincipalAxis, BoundaryError> {
    Ok(PrincipalAxis {
        direction: CHECK.unit("principal_axis.direction", &m.direction)?,
        contact_anisotropy: CHECK.finite("principal_axis.contact_anisotropy", m.contact_anisotropy)?,
        contact_anisotropy_stddev: CHECK.optional_not_negative(
            "principal_axis.contact_anisotropy_stddev",
            &m.contact_anisotropy_stddev,
        )?,
        angle_stddev: CHECK.optional_not_negative("principal_axis.angle_stddev", &m.angle_stddev)?,
        determined: m.determined,
    })
}

fn orientation_message(o: &OrientationHistogram) -> msg::OrientationHistogram {
    let contact_fit = o.contact_fit.map(|f| msg::OrientationFit {
        eps: f.eps,
        eps_stddev: f.eps_stddev,
        chi2_per_dof: f.chi2_per_dof,
    });
    let overlap_fit =
        o.overlap_fit.map(|f| msg::OverlapAnisotropyFit { g: f.g, g_stddev: one_or_none(f.g_stddev) });
    msg::OrientationHistogram {
        contacts: o.contacts,
        overlap: o.overlap,
        sqrt_overlap: o.sqrt_overlap,
        contact_fit: one_or_none(contact_fit),
        overlap_fit: one_or_none(overlap_fit),
    }
}

fn orientation(m: &msg::OrientationHistogram, contacts: u32) -> Result<OrientationHistogram, BoundaryError> {
    every_contact(CHECK, "orientation.contacts", &m.contacts, contacts)?;
    for (field, means) in [("overlap", &m.overlap), ("sqrt_overlap", &m.sqrt_overlap)] {
        for (index, mean) in means.iter().enumerate() {
            CHECK.not_negative(format_args!("orientation.{field}[{index}]"), *mean)?;
        }
    }
    let contact_fit = CHECK.optional("orientation.contact_fit", &m.contact_fit, |field, fit| {
        let requirement = "between -1/2 and 1, where no contact density is negative";
        let eps = fit.eps;
        Ok(OrientationFit {
            eps: CHECK.that((-0.5..=1.0).contains(&eps), format_args!("{field}.eps"), eps, requirement)?,
            eps_stddev: CHECK.not_negative(format_args!("{field}.eps_stddev"), fit.eps_stddev)?,
            chi2_per_dof: CHECK.not_negative(format_args!("{field}.chi2_per_dof"), fit.chi2_per_dof)?,
        })
    })?;
    let overlap_fit = CHECK.optional("orientation.overlap_fit", &m.overlap_fit, |field, fit| {
        Ok(OverlapAnisotropyFit {
            g: CHECK.finite(format_args!("{field}.g"), fit.g)?,
            g_stddev: CHECK.optional_not_negative(&format!("{field}.g_stddev"), &fit.g_stddev)?,
        })
    })?;
    Ok(OrientationHistogram {
        contacts: m.contacts,
        overlap: m.overlap,
        sqrt_overlap: m.sqrt_overlap,
        contact_fit,
        overlap_fit,
    })
}
