//! Coordination numbers and strain ratios in calibration files, by name.

use crate::conditions::StrainRatioSource;
use grainlab_core::results::InferredQuantity;
use serde::{Deserialize, Deserializer, Serializer, de::Error};

/// A coordination number: `k` or `z`.
pub(super) mod coordination_kind {
    use super::{Deserialize, Deserializer, Error, InferredQuantity, Serializer};

    pub(crate) fn serialize<S: Serializer>(kind: &InferredQuantity, to: S) -> Result<S::Ok, S::Error> {
        to.serialize_str(kind.name())
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<InferredQuantity, D::Error> {
        let name = String::deserialize(from)?;
        let known = [InferredQuantity::K, InferredQuantity::Z].into_iter().find(|q| q.name() == name);
        known.ok_or_else(|| D::Error::custom(format!("abscissa = {name:?}: it must be \"k\" or \"z\"")))
    }
}

/// Source of γ/Δ, or `none` for a model that does not use it.
pub(super) mod strain_ratio {
    use super::{Deserialize, Deserializer, Error, Serializer, StrainRatioSource};

    pub(crate) fn serialize<S: Serializer>(
        source: &Option<StrainRatioSource>,
        to: S,
    ) -> Result<S::Ok, S::Error> {
        to.serialize_str(source.map_or("none", StrainRatioSource::name))
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(
        from: D,
    ) -> Result<Option<StrainRatioSource>, D::Error> {
        use StrainRatioSource::{Contact, Elastic, Total, Zero};
        let name = String::deserialize(from)?;
        if name == "none" {
            return Ok(None);
        }
        let known = [Total, Elastic, Contact, Zero].into_iter().find(|source| source.name() == name);
        let fault = || format!("gamma = {name:?}: it must be total, elastic, contact, zero or none");
        known.map(Some).ok_or_else(|| D::Error::custom(fault()))
    }
}
