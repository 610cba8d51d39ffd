//! Checks of received messages.

use super::error::BoundaryError;
use crate::geometry_msgs::Vector3;
use crate::msg::{self, SymmetricTensor};
use crate::std_msgs::Header;
use grainlab_core::contact::ContactLaw;
use grainlab_core::results::StrainRatios;
use grainlab_core::{Mat3, Material, SymTensor, Vec3};
use std::fmt::{self, Display};

/// Frame of every header.
const FRAME: &str = "cell";

/// Checks the fields of one message.
#[derive(Clone, Copy)]
pub(super) struct Check(pub(super) &'static str);

type Checked<T> = Result<T, BoundaryError>;

impl Check {
    pub(super) fn refused(
        self,
        field: impl Display,
        found: impl Display,
        must: impl Display,
    ) -> BoundaryError {
        BoundaryError(format!("{}.{field} = {found} is refused: it must {must}", self.0))
    }

    pub(super) fn that(
        self,
        good: bool,
        field: impl Display,
        value: f64,
        requirement: &'static str,
    ) -> Checked<f64> {
        if good {
            return Ok(value);
        }
        Err(self.refused(field, format_args!("{value:?}"), format_args!("be {requirement}")))
    }

    pub(super) fn finite(self, field: impl Display, value: f64) -> Checked<f64> {
        self.that(value.is_finite(), field, value, "finite")
    }

    pub(super) fn positive(self, field: impl Display, value: f64) -> Checked<f64> {
        self.that(value.is_finite() && value > 0.0, field, value, "finite and more than 0")
    }

    pub(super) fn not_negative(self, field: impl Display, value: f64) -> Checked<f64> {
        self.that(value.is_finite() && value >= 0.0, field, value, "finite and 0 or more")
    }

    pub(super) fn share(self, field: impl Display, value: f64) -> Checked<f64> {
        self.that((0.0..=1.0).contains(&value), field, value, "between 0 and 1")
    }

    /// A part that may be missing: an array of one entry or of none. The entry must pass `check`, which gets
    /// its field.
    pub(super) fn optional<T, U>(
        self,
        field: &str,
        entries: &[T],
        check: impl FnOnce(&str, &T) -> Checked<U>,
    ) -> Checked<Option<U>> {
        self.length(field, entries.len(), entries.len().min(1), "or none, if it is not known")?;
        entries.first().map(|entry| check(field, entry)).transpose()
    }

    pub(super) fn optional_finite(self, field: &str, entries: &[f64]) -> Checked<Option<f64>> {
        self.optional(field, entries, |field, v| self.finite(field, *v))
    }

    pub(super) fn optional_not_negative(self, field: &str, entries: &[f64]) -> Checked<Option<f64>> {
        self.optional(field, entries, |field, v| self.not_negative(field, *v))
    }

    pub(super) fn optional_positive(self, field: &str, entries: &[f64]) -> Checked<Option<f64>> {
        self.optional(field, entries, |field, v| self.positive(field, *v))
    }

    pub(super) fn material(self, shear_modulus: f64, poisson_ratio: f64, density: f64) -> Checked<Material> {
        let (known, requirement) = ((0.0..=0.5).contains(&poisson_ratio), "between 0 and 0.5");
        Ok(Material {
            shear_modulus: self.positive("grain_shear_modulus", shear_modulus)?,
            poisson_ratio: self.that(known, "grain_poisson_ratio", poisson_ratio, requirement)?,
            density: self.positive("grain_density", density)?,
        })
    }

    pub(super) fn contact_law(self, name: &str, parameters: &[f64]) -> Checked<ContactLaw> {
        let refused = |fault| BoundaryError(format!("{}.contact_law is refused: {fault}", self.0));
        ContactLaw::new(name, parameters).map_err(refused)
    }

    /// The contact law, with an empty name for unknown.
    pub(super) fn optional_contact_law(self, name: &str, parameters: &[f64]) -> Checked<Option<ContactLaw>> {
        if name.is_empty() && parameters.is_empty() {
            return Ok(None);
        }
        self.contact_law(name, parameters).map(Some)
    }

    /// A quantity with 0 for unknown.
    pub(super) fn known(self, field: &str, value: f64) -> Checked<Option<f64>> {
        Ok(Some(self.not_negative(field, value)?).filter(|v| *v > 0.0))
    }

    /// A standard deviation with 0 for exact or not stated; it must be 0 where the value is unknown.
    pub(super) fn stddev(self, field: &str, stddev: f64, is_known: bool) -> Checked<f64> {
        let stddev = self.not_negative(field, stddev)?;
        self.that(is_known || stddev == 0.0, field, stddev, "0 where the quantity is not known")
    }

    /// A code that is not one of the constants of the message.
    pub(super) fn code(self, field: impl Display, value: u8, allowed: &'static str) -> BoundaryError {
        self.refused(field, value, format_args!("be one of {allowed}"))
    }

    pub(super) fn length(
        self,
        field: &str,
        found: usize,
        expected: usize,
        reason: &'static str,
    ) -> Checked<()> {
        if found == expected {
            return Ok(());
        }
        let message = self.0;
        Err(BoundaryError(format!(
            "{message}.{field} has {found} entries and is refused: it must have {expected} ({reason})"
        )))
    }

    pub(super) fn header(self, header: &Header) -> Checked<()> {
        let nanosec = header.stamp.nanosec;
        let good = nanosec < 1_000_000_000;
        self.that(good, "header.stamp.nanosec", f64::from(nanosec), "less than 1e9").map(drop)
    }

    pub(super) fn all_finite(self, field: &str, values: &[f64]) -> Checked<()> {
        match values.iter().enumerate().find(|(_, v)| !v.is_finite()) {
            Some((index, value)) => self.finite(format_args!("{field}[{index}]"), *value).map(drop),
            None => Ok(()),
        }
    }

    pub(super) fn six(self, field: &str, values: &[f64; 6]) -> Checked<[f64; 6]> {
        match (0..6).find(|i| !values[*i].is_finite()) {
            Some(i) => self.finite(Component(field, i), values[i]).map(|_| *values),
            None => Ok(*values),
        }
    }

    pub(super) fn tensor(self, field: &str, t: &SymmetricTensor) -> Checked<SymTensor> {
        let values = [t.xx, t.yy, t.zz, t.yz, t.xz, t.xy];
        if let Some(i) = (0..6).find(|i| !values[*i].is_finite()) {
            self.finite(format_args!("{field}.{}", SymTensor::COMPONENTS[i]), values[i])?;
        }
        Ok(SymTensor::from_voigt(values))
    }

    /// A unit vector; `None` if it is zero.
    pub(super) fn direction(self, field: &str, v: &Vector3) -> Checked<Option<Vec3>> {
        let vector = Vec3::new(v.x, v.y, v.z);
        if vector == Vec3::zeros() {
            return Ok(None);
        }
        let norm = vector.norm();
        self.that((norm - 1.0).abs() < 1e-6, format_args!("|{field}|"), norm, "1, or 0 if unknown")?;
        Ok(Some(vector))
    }

    /// A unit vector.
    pub(super) fn unit(self, field: &str, v: &Vector3) -> Checked<Vec3> {
        let known = self.direction(field, v)?;
        self.that(known.is_some(), format_args!("|{field}|"), 0.0, "1").map(|_| known.unwrap_or_default())
    }

    pub(super) fn strain_ratios(self, m: &msg::StrainRatios) -> Checked<StrainRatios> {
        Ok(StrainRatios {
            total: self.optional_finite("strain_ratios.total", &m.total)?,
            elastic: self.optional_finite("strain_ratios.elastic", &m.elastic)?,
            contact: self.optional_finite("strain_ratios.contact", &m.contact)?,
        })
    }

    /// An array of the stated length; `None` if it is empty.
    pub(super) fn array<const ENTRIES: usize>(
        self,
        field: &str,
        values: &[f64],
    ) -> Checked<Option<[f64; ENTRIES]>> {
        if values.is_empty() {
            return Ok(None);
        }
        self.length(field, values.len(), ENTRIES, "or none, if they are not known")?;
        Ok(values.try_into().ok())
    }

    /// A covariance, row-major; `None` if it is unknown.
    pub(super) fn covariance<const ENTRIES: usize>(
        self,
        field: &str,
        values: &[f64],
    ) -> Checked<Option<[f64; ENTRIES]>> {
        let Some(c) = self.array::<ENTRIES>(field, values)? else { return Ok(None) };
        self.all_finite(field, &c)?;
        let side = ENTRIES.isqrt();
        let variance = |i: usize| c[(side + 1) * i];
        for i in 0..side {
            self.not_negative(format_args!("{field}[{}]", (side + 1) * i), variance(i))?;
            for j in 0..i {
                let (lower, upper) = (c[side * i + j], c[side * j + i]);
                let bound = (variance(i) * variance(j)).sqrt();
                // 1e-9: rounding by the sender, far below any uncertainty of an uncertainty.
                let good = (lower - upper).abs() <= 1e-9 * bound && lower.abs() <= bound * (1.0 + 1e-9);
                let name = format!("{field}[{}]", side * i + j);
                self.that(good, &name, lower, "symmetric and at most 1 as a correlation")?;
            }
        }
        Ok(Some(c))
    }

    /// The entry of `allowed` that equals `word`; `listed` is the list of all of them as text.
    pub(super) fn word(
        self,
        field: &'static str,
        word: &str,
        allowed: &[&'static str],
        listed: &'static str,
    ) -> Checked<&'static str> {
        let refused = || self.refused(field, format_args!("{word:?}"), format_args!("be one of {listed}"));
        allowed.iter().find(|w| **w == word).copied().ok_or_else(refused)
    }
}

/// Name of a component: `rate[2] (zz)`.
/// Name of a component of an array, written only in errors.
pub(super) struct Component<'a>(pub(super) &'a str, pub(super) usize);

impl Display for Component<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}[{}] ({})", self.0, self.1, SymTensor::COMPONENTS[self.1])
    }
}

pub(super) fn header(stamp: crate::builtin_interfaces::Time) -> Header {
    Header { stamp, frame_id: FRAME.to_owned() }
}

pub(super) fn row_major(m: &Mat3) -> [f64; 9] {
    std::array::from_fn(|k| m[(k / 3, k % 3)])
}

pub(super) fn tensor_message(t: &SymTensor) -> SymmetricTensor {
    SymmetricTensor { xx: t.xx, yy: t.yy, zz: t.zz, yz: t.yz, xz: t.xz, xy: t.xy }
}

/// A vector as a message.
pub fn vector_message(v: &Vec3) -> Vector3 {
    Vector3 { x: v.x, y: v.y, z: v.z }
}

/// A part that may be missing, as an array.
pub(super) fn one_or_none<T>(value: Option<T>) -> Vec<T> {
    value.into_iter().collect()
}

pub(super) fn strain_ratios_message(g: &StrainRatios) -> msg::StrainRatios {
    let [total, elastic, contact] = [g.total, g.elastic, g.contact].map(one_or_none);
    msg::StrainRatios { total, elastic, contact }
}
