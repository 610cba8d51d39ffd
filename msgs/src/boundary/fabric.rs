//! `Fabric`: structure of a packing.

use super::BoundaryError;
use super::check::{Check, ratios, tensor_message, vector_message};
use super::structure::{reading, structure_message};
use crate::msg;
use crate::std_msgs::Header;
use grainlab_core::results::{ContactStatistics, Fabric, PackingReport, StrainRatios, StressDecomposition};

pub(super) const CHECK: Check = Check("Fabric");

/// What a `Fabric` message holds, checked.
#[derive(Clone, Debug, PartialEq)]
pub struct FabricReading {
    /// Contacts and the forces they carry.
    pub contacts: ContactStatistics,
    /// Orientation of the contacts.
    pub fabric: Fabric,
    /// Which forces and which contacts carry the stress.
    pub stress_decomposition: StressDecomposition,
    /// The three ratios γ/Δ.
    pub strain_ratios: StrainRatios,
}

/// The message of the structure of a packing; `header` is that of the packing measured.
pub fn fabric_message(header: Header, report: &PackingReport) -> Result<msg::Fabric, BoundaryError> {
    let (c, f) = (&report.contacts, &report.fabric);
    let [total, elastic, contact] = ratios(&report.strain_ratios);
    let message = msg::Fabric {
        header,
        source_step: report.step,
        grains: c.grains,
        contacts: c.contacts,
        rattlers: c.rattlers,
        k: c.coordination,
        z: c.mechanical_coordination,
        contact_fabric: tensor_message(&f.contact_fabric),
        force_fabric: tensor_message(&f.normal_force_fabric),
        stiffness_fabric: tensor_message(&f.stiffness_fabric),
        eps: f.contact_anisotropy,
        axis: vector_message(&f.principal_axis.direction),
        fourth_order: f.p4_coefficient,
        gamma_over_delta_total_known: total.0,
        gamma_over_delta_total: total.1,
        gamma_over_delta_elastic_known: elastic.0,
        gamma_over_delta_elastic: elastic.1,
        gamma_over_delta_contact_known: contact.0,
        gamma_over_delta_contact: contact.1,
        mobilised: c.sliding_fraction,
        ..structure_message(report)
    };
    FabricReading::try_from(&message)?;
    Ok(message)
}

impl TryFrom<&msg::Fabric> for FabricReading {
    type Error = BoundaryError;

    fn try_from(m: &msg::Fabric) -> Result<Self, BoundaryError> {
        CHECK.header(&m.header)?;
        CHECK.that(m.rattlers <= m.grains, "rattlers", f64::from(m.rattlers), "at most the number of grains")?;
        reading(m)
    }
}
