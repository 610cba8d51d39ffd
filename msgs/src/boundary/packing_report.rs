//! `PackingReport`: everything that is measured on one packing.

use super::check::{Check, one_or_none, strain_ratios_message, tensor_message};
use super::contact_statistics::{contact_statistics, contact_statistics_message};
use super::elastic_stiffness::{elastic_stiffness, elastic_stiffness_message};
use super::error::BoundaryError;
use super::fabric::{fabric, fabric_message};
use super::stress_decomposition::{stress_decomposition, stress_decomposition_message};
use super::symmetry::{symmetry, symmetry_message};
use crate::msg;
use crate::std_msgs::Header;
use grainlab_core::min_contacts;
use grainlab_core::results::{Elasticity, NoStiffness, PackingReport};
use grainlab_core::stress::Stress;

const CHECK: Check = Check("PackingReport");

/// The message of a report, bit for bit; `header` is that of the measured packing.
///
/// # Errors
/// A number that a reader would refuse.
pub fn packing_report_message(
    header: Header,
    report: &PackingReport,
) -> Result<msg::PackingReport, BoundaryError> {
    let (jamming, floppy_contacts) = match report.elasticity.as_ref().err() {
        None => (msg::PackingReport::JAMMED, 0),
        Some(NoStiffness::NoContacts { .. }) => (msg::PackingReport::NO_CONTACTS, 0),
        Some(NoStiffness::OnlyRattlers { .. }) => (msg::PackingReport::ONLY_RATTLERS, 0),
        Some(NoStiffness::Floppy { contacts }) => (msg::PackingReport::FLOPPY, *contacts as u32),
        Some(NoStiffness::TooDeep) => (msg::PackingReport::TOO_DEEP, 0),
        Some(NoStiffness::Unsolved) => (msg::PackingReport::UNSOLVED, 0),
    };
    let message = msg::PackingReport {
        header,
        source_step: report.step,
        grain_shear_modulus: report.material.shear_modulus,
        grain_poisson_ratio: report.material.poisson_ratio,
        grain_density: report.material.density,
        contact_law: report.law.name().to_owned(),
        contact_law_parameters: report.law.parameters(),
        friction: report.friction,
        solid_fraction: report.solid_fraction,
        size_spread: report.size_spread,
        strain: one_or_none(report.strain.as_ref().map(tensor_message)),
        stress: tensor_message(&report.stress.tensor),
        stress_asymmetry: report.stress.asymmetry,
        unbalanced_force_ratio: one_or_none(report.unbalanced_force_ratio),
        contacts: contact_statistics_message(&report.contacts),
        fabric: fabric_message(&report.fabric),
        stress_decomposition: stress_decomposition_message(&report.stress_decomposition),
        strain_ratios: strain_ratios_message(&report.strain_ratios),
        jamming,
        floppy_contacts,
        stiffness: one_or_none(report.stiffness().map(elastic_stiffness_message)),
        symmetry: one_or_none(report.symmetry.as_ref().map(symmetry_message)),
    };
    PackingReport::try_from(&message)?;
    Ok(message)
}

impl TryFrom<&msg::PackingReport> for PackingReport {
    type Error = BoundaryError;

    fn try_from(m: &msg::PackingReport) -> Result<Self, BoundaryError> {
        CHECK.header(&m.header)?;
        let contacts = contact_statistics(&m.contacts)?;
        let friction = CHECK.that(m.friction >= 0.0, "friction", m.friction, "0 or more")?;
        let (elasticity, symmetry) =
            (elasticity(m)?, CHECK.optional("symmetry", &m.symmetry, |_, s| symmetry(s))?);
        if let (Ok(stiffness), Some(symmetry)) = (&elasticity, &symmetry) {
            let found = symmetry.moduli.stiffness().bulk_voigt();
            let (expected, largest) = (stiffness.tensor.bulk_voigt(), symmetry.moduli.c11.abs());
            let same = (found - expected).abs() <= 1e-6 * largest.max(expected.abs());
            CHECK.that(same, "symmetry.moduli (bulk modulus)", found, "that of the stiffness")?;
        }
        Ok(Self {
            step: m.source_step,
            material: CHECK.material(m.grain_shear_modulus, m.grain_poisson_ratio, m.grain_density)?,
            law: CHECK.contact_law(&m.contact_law, &m.contact_law_parameters)?,
            friction,
            solid_fraction: CHECK.positive("solid_fraction", m.solid_fraction)?,
            size_spread: CHECK.not_negative("size_spread", m.size_spread)?,
            strain: CHECK.optional("strain", &m.strain, |field, strain| CHECK.tensor(field, strain))?,
            stress: Stress {
                tensor: CHECK.tensor("stress", &m.stress)?,
                asymmetry: CHECK.not_negative("stress_asymmetry", m.stress_asymmetry)?,
            },
            unbalanced_force_ratio: CHECK
                .optional_not_negative("unbalanced_force_ratio", &m.unbalanced_force_ratio)?,
            contacts,
            fabric: fabric(&m.fabric, contacts.contacts)?,
            stress_decomposition: stress_decomposition(&m.stress_decomposition, contacts.contacts)?,
            strain_ratios: CHECK.strain_ratios(&m.strain_ratios)?,
            elasticity,
            symmetry,
        })
    }
}

/// The stiffness, or the reason for its absence. A message must state exactly one of them.
fn elasticity(m: &msg::PackingReport) -> Result<Elasticity, BoundaryError> {
    let stiffness = CHECK.optional("stiffness", &m.stiffness, |_, s| elastic_stiffness(s))?;
    let grains = m.contacts.grains as usize;
    Ok(Err(match (stiffness, m.jamming) {
        (Some(stiffness), msg::PackingReport::JAMMED) => return Ok(Ok(Box::new(stiffness))),
        (None, msg::PackingReport::NO_CONTACTS) => NoStiffness::NoContacts { grains },
        (None, msg::PackingReport::ONLY_RATTLERS) => {
            NoStiffness::OnlyRattlers { grains, needed: min_contacts(m.friction) }
        }
        (None, msg::PackingReport::FLOPPY) => NoStiffness::Floppy { contacts: m.floppy_contacts as usize },
        (None, msg::PackingReport::TOO_DEEP) => NoStiffness::TooDeep,
        (None, msg::PackingReport::UNSOLVED) => NoStiffness::Unsolved,
        (_, other) => {
            let known = "0 (jammed) with a stiffness, 1 (no contacts), 2 (only rattlers), 3 (floppy), 4 (too deep), 5 (unsolved) \
                         without one";
            return Err(CHECK.code("jamming", other, known));
        }
    }))
}
