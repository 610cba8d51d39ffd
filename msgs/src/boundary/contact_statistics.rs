//! `ContactStatistics`: numbers of contacts, and their forces.

use super::check::{Check, one_or_none};
use super::error::BoundaryError;
use crate::msg;
use grainlab_core::results::{ContactStatistics, ForceStatistics, MobilisedFriction};

const CHECK: Check = Check("PackingReport.contacts");

pub(super) fn contact_statistics_message(c: &ContactStatistics) -> msg::ContactStatistics {
    let forces = c.forces.map(|f| msg::ForceStatistics {
        mean_normal: f.mean_normal,
        mean_tangential: f.mean_tangential,
        moments: f.moments,
        largest: f.largest,
        histogram: f.histogram,
    });
    let friction = c.friction.map(|f| msg::MobilisedFriction { mean: f.mean, histogram: f.histogram });
    msg::ContactStatistics {
        grains: c.grains,
        contacts: c.contacts,
        rattlers: c.rattlers,
        coordination: c.coordination,
        mechanical_coordination: c.mechanical_coordination,
        sliding_fraction: c.sliding_fraction,
        forces: one_or_none(forces),
        friction: one_or_none(friction),
    }
}

pub(super) fn contact_statistics(m: &msg::ContactStatistics) -> Result<ContactStatistics, BoundaryError> {
    let few = "at most the number of grains";
    CHECK.that(m.rattlers <= m.grains, "rattlers", f64::from(m.rattlers), few)?;
    Ok(ContactStatistics {
        grains: m.grains,
        contacts: m.contacts,
        rattlers: m.rattlers,
        coordination: CHECK.not_negative("coordination", m.coordination)?,
        mechanical_coordination: CHECK.not_negative("mechanical_coordination", m.mechanical_coordination)?,
        sliding_fraction: CHECK.share("sliding_fraction", m.sliding_fraction)?,
        forces: CHECK.optional("forces", &m.forces, |_, f| force_statistics(f, m.contacts))?,
        friction: CHECK.optional("friction", &m.friction, |_, f| mobilised_friction(f, m.contacts))?,
    })
}

fn force_statistics(m: &msg::ForceStatistics, contacts: u32) -> Result<ForceStatistics, BoundaryError> {
    every_contact(CHECK, "forces.histogram", &m.histogram, contacts)?;
    CHECK.all_finite("forces.moments", &m.moments)?;
    CHECK.positive("forces.moments[0]", m.moments[0])?;
    Ok(ForceStatistics {
        mean_normal: CHECK.positive("forces.mean_normal", m.mean_normal)?,
        mean_tangential: CHECK.not_negative("forces.mean_tangential", m.mean_tangential)?,
        moments: m.moments,
        largest: CHECK.positive("forces.largest", m.largest)?,
        histogram: m.histogram,
    })
}

fn mobilised_friction(m: &msg::MobilisedFriction, contacts: u32) -> Result<MobilisedFriction, BoundaryError> {
    every_contact(CHECK, "friction.histogram", &m.histogram, contacts)?;
    Ok(MobilisedFriction { mean: CHECK.share("friction.mean", m.mean)?, histogram: m.histogram })
}

pub(super) fn every_contact(
    check: Check,
    field: &str,
    counts: &[u32],
    contacts: u32,
) -> Result<(), BoundaryError> {
    let sum: u64 = counts.iter().map(|c| u64::from(*c)).sum();
    let requirement = "the number of contacts";
    check.that(sum == u64::from(contacts), format_args!("sum of {field}"), sum as f64, requirement).map(drop)
}
