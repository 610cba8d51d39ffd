//! `StressDecomposition`: parts of the stress by force and by network.

use super::check::{Check, one_or_none, tensor_message};
use super::error::BoundaryError;
use crate::msg;
use grainlab_core::results::{StressDecomposition, StressForceFabric, SubNetwork};

const CHECK: Check = Check("PackingReport.stress_decomposition");

pub(super) fn stress_decomposition_message(d: &StressDecomposition) -> msg::StressDecomposition {
    let anisotropies = d.stress_force_fabric.map(|a| msg::StressForceFabric {
        contacts: tensor_message(&a.contacts),
        normal_forces: tensor_message(&a.normal_forces),
        branches: tensor_message(&a.branches),
        tangential_forces: tensor_message(&a.tangential_forces),
    });
    msg::StressDecomposition {
        normal: tensor_message(&d.normal),
        tangential: tensor_message(&d.tangential),
        strong: network_message(&d.strong),
        weak: network_message(&d.weak),
        stress_force_fabric: one_or_none(anisotropies),
    }
}

fn network_message(n: &SubNetwork) -> msg::SubNetwork {
    msg::SubNetwork {
        contacts: n.contacts,
        fabric: tensor_message(&n.fabric),
        contact_anisotropy: n.contact_anisotropy,
        stress: tensor_message(&n.stress),
    }
}

pub(super) fn stress_decomposition(
    m: &msg::StressDecomposition,
    contacts: u32,
) -> Result<StressDecomposition, BoundaryError> {
    let both = u64::from(m.strong.contacts) + u64::from(m.weak.contacts);
    let sum = "sum of strong.contacts and weak.contacts";
    CHECK.that(both == u64::from(contacts), sum, both as f64, "the number of contacts")?;
    Ok(StressDecomposition {
        normal: CHECK.tensor("normal", &m.normal)?,
        tangential: CHECK.tensor("tangential", &m.tangential)?,
        strong: network("strong", &m.strong)?,
        weak: network("weak", &m.weak)?,
        stress_force_fabric: CHECK.optional("stress_force_fabric", &m.stress_force_fabric, |field, a| {
            stress_force_fabric(field, a)
        })?,
    })
}

fn network(name: &str, m: &msg::SubNetwork) -> Result<SubNetwork, BoundaryError> {
    let field = |field: &str| format!("{name}.{field}");
    Ok(SubNetwork {
        contacts: m.contacts,
        fabric: CHECK.tensor(&field("fabric"), &m.fabric)?,
        contact_anisotropy: CHECK.finite(field("contact_anisotropy"), m.contact_anisotropy)?,
        stress: CHECK.tensor(&field("stress"), &m.stress)?,
    })
}

fn stress_force_fabric(name: &str, m: &msg::StressForceFabric) -> Result<StressForceFabric, BoundaryError> {
    let tensor = |field: &str, tensor| CHECK.tensor(&format!("{name}.{field}"), tensor);
    Ok(StressForceFabric {
        contacts: tensor("contacts", &m.contacts)?,
        normal_forces: tensor("normal_forces", &m.normal_forces)?,
        branches: tensor("branches", &m.branches)?,
        tangential_forces: tensor("tangential_forces", &m.tangential_forces)?,
    })
}
