//! `StressDecomposition`: parts of the stress by force and by network.

use super::check::{Check, one_or_none, tensor_message};
use super::error::BoundaryError;
use crate::msg;
use grainlab_core::results::{StressDecomposition, StressForceFabric, SubNetwork};

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

/// The content of the field `stress` of a message about a packing with this number of contacts.
pub(super) fn stress_decomposition(
    check: Check,
    m: &msg::StressDecomposition,
    contacts: u32,
) -> Result<StressDecomposition, BoundaryError> {
    let both = u64::from(m.strong.contacts) + u64::from(m.weak.contacts);
    let sum = "sum of stress.strong.contacts and stress.weak.contacts";
    check.that(both == u64::from(contacts), sum, both as f64, "the number of contacts")?;
    Ok(StressDecomposition {
        normal: check.tensor("stress.normal", &m.normal)?,
        tangential: check.tensor("stress.tangential", &m.tangential)?,
        strong: network(check, "strong", &m.strong)?,
        weak: network(check, "weak", &m.weak)?,
        stress_force_fabric: check.optional(
            "stress.stress_force_fabric",
            &m.stress_force_fabric,
            |field, a| stress_force_fabric(check, field, a),
        )?,
    })
}

fn network(check: Check, name: &str, m: &msg::SubNetwork) -> Result<SubNetwork, BoundaryError> {
    let field = |field: &str| format!("stress.{name}.{field}");
    Ok(SubNetwork {
        contacts: m.contacts,
        fabric: check.tensor(&field("fabric"), &m.fabric)?,
        contact_anisotropy: check.finite(&field("contact_anisotropy"), m.contact_anisotropy)?,
        stress: check.tensor(&field("stress"), &m.stress)?,
    })
}

fn stress_force_fabric(
    check: Check,
    name: &str,
    m: &msg::StressForceFabric,
) -> Result<StressForceFabric, BoundaryError> {
    let tensor = |field: &str, tensor| check.tensor(&format!("{name}.{field}"), tensor);
    Ok(StressForceFabric {
        contacts: tensor("contacts", &m.contacts)?,
        normal_forces: tensor("normal_forces", &m.normal_forces)?,
        branches: tensor("branches", &m.branches)?,
        tangential_forces: tensor("tangential_forces", &m.tangential_forces)?,
    })
}
