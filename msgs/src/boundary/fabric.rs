//! `Fabric`: structure of a packing.

use super::BoundaryError;
use super::check::{Check, ratios, tensor_message, vector_message};
use super::structure::{structure, structure_message};
use crate::msg;
use crate::std_msgs::Header;
use grainlab_core::{Anisotropy, Fabric, Vec3};

pub(super) const CHECK: Check = Check("Fabric");

/// The message of a fabric; `header` and `source_step` are those of the packing measured.
pub fn fabric_message(header: Header, source_step: u64, f: &Fabric) -> Result<msg::Fabric, BoundaryError> {
    let [total, elastic, contact] = ratios(&f.anisotropy);
    let message = msg::Fabric {
        header,
        source_step,
        grains: f.grains,
        contacts: f.contacts,
        rattlers: f.rattlers,
        k: f.k,
        z: f.z,
        contact_fabric: tensor_message(&f.contact_fabric),
        force_fabric: tensor_message(&f.force_fabric),
        stiffness_fabric: tensor_message(&f.stiffness_fabric),
        eps: f.eps,
        axis: vector_message(&f.axis),
        fourth_order: f.fourth_order,
        gamma_over_delta_total_known: total.0,
        gamma_over_delta_total: total.1,
        gamma_over_delta_elastic_known: elastic.0,
        gamma_over_delta_elastic: elastic.1,
        gamma_over_delta_contact_known: contact.0,
        gamma_over_delta_contact: contact.1,
        mobilised: f.mobilised,
        ..structure_message(&f.structure)
    };
    Fabric::try_from(&message)?;
    Ok(message)
}

impl TryFrom<&msg::Fabric> for Fabric {
    type Error = BoundaryError;

    fn try_from(m: &msg::Fabric) -> Result<Self, BoundaryError> {
        CHECK.header(&m.header)?;
        CHECK.that(
            m.rattlers <= m.grains,
            "rattlers",
            f64::from(m.rattlers),
            "at most the number of grains",
        )?;
        Ok(Self {
            grains: m.grains,
            contacts: m.contacts,
            rattlers: m.rattlers,
            k: CHECK.not_negative("k", m.k)?,
            z: CHECK.not_negative("z", m.z)?,
            contact_fabric: CHECK.tensor("contact_fabric", &m.contact_fabric)?,
            force_fabric: CHECK.tensor("force_fabric", &m.force_fabric)?,
            stiffness_fabric: CHECK.tensor("stiffness_fabric", &m.stiffness_fabric)?,
            eps: CHECK.finite("eps", m.eps)?,
            axis: CHECK.direction("axis", &m.axis)?.unwrap_or_else(Vec3::zeros),
            fourth_order: CHECK.finite("fourth_order", m.fourth_order)?,
            anisotropy: Anisotropy {
                total: CHECK.ratio(
                    "gamma_over_delta_total",
                    (m.gamma_over_delta_total_known, m.gamma_over_delta_total),
                )?,
                elastic: CHECK.ratio(
                    "gamma_over_delta_elastic",
                    (m.gamma_over_delta_elastic_known, m.gamma_over_delta_elastic),
                )?,
                contact: CHECK.ratio(
                    "gamma_over_delta_contact",
                    (m.gamma_over_delta_contact_known, m.gamma_over_delta_contact),
                )?,
            },
            mobilised: CHECK.share("mobilised", m.mobilised)?,
            structure: structure(m)?,
        })
    }
}
