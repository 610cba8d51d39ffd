//! The eight tests of Chung & Ooi, Granular Matter 13, 643 (2011), for codes of spheres.
//!
//! A rigid plane is a sphere of 10⁵ times the radius, of the same material with twice its shear modulus: two of these have E* and
//! G* of one sphere of the material upon a rigid body.

mod data;
mod elastic;
mod microscopic;
mod oblique;
mod restitution;
mod spinning;

pub use data::NAME;

use crate::error::VerificationError;
use crate::lammps_impacts::Impacts;
use crate::reference::parse;
use crate::row::Row;
use data::Data;
use std::collections::BTreeMap;

/// Rows of the suite.
pub fn rows() -> Result<Vec<Row>, VerificationError> {
    let data: Data = parse("chung_ooi.toml", include_str!("../../data/chung_ooi.toml"))?;
    let mut rows = Vec::new();
    for case in &data.elastic {
        rows.extend(elastic::rows(case)?);
    }
    for solid in &data.restitution {
        rows.push(restitution::row(solid)?);
    }
    rows.push(restitution::perfectly_plastic());
    let impacts = Impacts::new()?;
    for (n, case) in data.oblique.iter().enumerate() {
        rows.extend(oblique::rows(n, case, &data.measured, &impacts)?);
    }
    for (n, case) in data.microscopic.iter().enumerate() {
        rows.extend(microscopic::rows(n, case, &impacts)?);
    }
    rows.extend(microscopic::finite_elements(&data.microscopic[0], &data.finite_elements, &impacts)?);
    let mut seen = BTreeMap::new();
    for case in &data.spinning {
        let material = seen.entry(case.test).or_insert(0);
        rows.extend(spinning::rows(*material, case, &impacts)?);
        *material += 1;
    }
    rows.extend(spinning::counter_spinning(&data.counter_spinning)?);
    Ok(rows)
}
