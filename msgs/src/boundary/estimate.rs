//! `Estimate`: the result of one model.

use super::check::Check;
use super::error::BoundaryError;
use crate::msg::Estimate;
use grainlab_core::results::{INFERENCE_INPUTS, InferredQuantity};
use serde::{Serialize, Serializer};
use std::ops::Index;

/// The result of one model: checked, if it is from a message. As JSON it has the stable keys of `results[]`.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ModelResult {
    /// Name of the model.
    pub model: String,
    /// Name of the calibration.
    pub calibration: String,
    /// Inferred values; `None`: undetermined, or not part of the model.
    #[serde(flatten)]
    pub values: Quantities<Option<f64>>,
    /// Standard deviations, from data and model.
    pub sigma: Quantities<Option<f64>>,
    /// Part of the standard deviations due to the model.
    pub sigma_model: Quantities<Option<f64>>,
    /// Credible intervals of the values.
    pub interval: Interval,
    /// Misfit: weighted sum of squares, by errors of data and model; `None` without degrees of freedom.
    pub chi_square: Option<f64>,
    /// Number of data minus number of unknowns; `None` without a solution.
    pub degrees_of_freedom: Option<usize>,
    /// Condition number, 1 or more: how much the effects of errors of the data differ between combinations.
    pub condition_number: Option<f64>,
    /// `ok`, `extrapolated`, `contradictory` or `unknown`.
    pub status: &'static str,
    /// The strain ratio γ/Δ that the model used; `None` if it uses none.
    pub gamma_over_delta: Option<f64>,
    /// Source of the strain ratio: `total`, `elastic`, `contact`: one of the three measured ones; `given`; `zero`: unknown, taken as 0.
    pub gamma_over_delta_source: Option<&'static str>,
    /// Notes for the user.
    pub warnings: Vec<String>,
}

/// One value per quantity of the microstructure, in the order of [`InferredQuantity::ALL`]; as JSON by name.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Quantities<T>(pub [T; N]);

/// Central intervals, low and high.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Interval {
    /// Probability inside each.
    pub level: Option<f64>,
    /// Low and high of each quantity.
    #[serde(flatten)]
    pub bounds: Quantities<Option<[f64; 2]>>,
}

impl<T> Quantities<T> {
    /// Each by this function.
    pub fn of(value: impl FnMut(InferredQuantity) -> T) -> Self {
        Self(InferredQuantity::ALL.map(value))
    }
}

impl<T> Index<InferredQuantity> for Quantities<T> {
    type Output = T;

    fn index(&self, quantity: InferredQuantity) -> &T {
        &self.0[quantity as usize]
    }
}

impl<T: Serialize> Serialize for Quantities<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(InferredQuantity::ALL.map(InferredQuantity::name).into_iter().zip(&self.0))
    }
}

impl ModelResult {
    /// A model without an estimate, and the reason.
    pub fn unknown(model: &str, calibration: &str, warnings: Vec<String>) -> Self {
        Self {
            model: model.to_owned(),
            calibration: calibration.to_owned(),
            status: "unknown",
            warnings,
            ..Self::default()
        }
    }
}

const CHECK: Check = Check("Estimate");

const N: usize = InferredQuantity::COUNT;

impl Estimate {
    /// The fields of the inferred quantities, each with one number or none, in the order of [`InferredQuantity::ALL`].
    pub fn quantities(&self) -> [&Vec<f64>; N] {
        [&self.k, &self.k_hat, &self.z, &self.eps, &self.eps_stiffness]
    }

    /// Fields of the inferred quantities, to be written.
    pub fn quantities_mut(&mut self) -> [&mut Vec<f64>; N] {
        [&mut self.k, &mut self.k_hat, &mut self.z, &mut self.eps, &mut self.eps_stiffness]
    }
}

impl TryFrom<&Estimate> for ModelResult {
    type Error = BoundaryError;

    fn try_from(m: &Estimate) -> Result<Self, BoundaryError> {
        let status = match m.status {
            Estimate::STATUS_OK => "ok",
            Estimate::STATUS_EXTRAPOLATED => "extrapolated",
            Estimate::STATUS_CONTRADICTORY => "contradictory",
            Estimate::STATUS_UNKNOWN => "unknown",
            other => {
                let allowed = "0 (ok), 1 (extrapolated), 2 (contradictory), 3 (unknown)";
                return Err(CHECK.code("status", other, allowed));
            }
        };
        let (gamma_over_delta, gamma_over_delta_source) = strain_ratio(m)?;
        let unknown = Self {
            status,
            gamma_over_delta,
            gamma_over_delta_source,
            ..Self::unknown(&m.model, &m.calibration, m.warnings.clone())
        };
        if m.status == Estimate::STATUS_UNKNOWN {
            return Ok(unknown);
        }
        let values = values(m)?;
        let known = values.map(|v| v.is_some());
        let sigma = standard_deviations("covariance", &m.covariance, &known)?;
        let sigma_model = standard_deviations("covariance_model", &m.covariance_model, &known)?;
        part_is_at_most_the_whole(m)?;
        let interval = interval(m, &known)?;
        let chi_square = chi_square(m)?;
        let condition_number = condition_number(m)?;
        information(m, &known)?;
        Ok(Self {
            values: Quantities(values),
            sigma,
            sigma_model,
            interval,
            chi_square,
            degrees_of_freedom: Some(m.degrees_of_freedom as usize),
            condition_number,
            ..unknown
        })
    }
}

fn strain_ratio(m: &Estimate) -> Result<(Option<f64>, Option<&'static str>), BoundaryError> {
    const SOURCES: [&str; 6] = ["total", "elastic", "contact", "given", "zero", "none"];
    let listed = "total, elastic, contact, given, zero, none";
    let source = CHECK.word("gamma_over_delta_source", &m.gamma_over_delta_source, &SOURCES, listed)?;
    let value = CHECK.optional_finite("gamma_over_delta", &m.gamma_over_delta)?;
    let expected = usize::from(source != "none");
    let reason = "one strain ratio, or none where its source is none";
    CHECK.length("gamma_over_delta", m.gamma_over_delta.len(), expected, reason)?;
    Ok((value, value.map(|_| source)))
}

fn values(m: &Estimate) -> Result<[Option<f64>; N], BoundaryError> {
    let mut values = [None; N];
    for (i, value) in m.quantities().into_iter().enumerate() {
        values[i] = CHECK.optional_finite(InferredQuantity::ALL[i].name(), value)?;
    }
    let any = values.iter().any(Option::is_some);
    CHECK.that(any, "number of known quantities", 0.0, "1 or more unless the status is 3 (unknown)")?;
    Ok(values)
}

/// The value of every entry that belongs to an unknown quantity.
const NOTHING: &str = "0, because its quantity is not known";

fn standard_deviations(
    field: &'static str,
    values: &[f64],
    known: &[bool; N],
) -> Result<Quantities<Option<f64>>, BoundaryError> {
    let checked: Option<[f64; N * N]> = CHECK.covariance(field, values)?;
    for (at, value) in values.iter().enumerate() {
        let both = known[at / N] && known[at % N];
        CHECK.that(both || *value == 0.0, format_args!("{field}[{at}]"), *value, NOTHING)?;
    }
    Ok(Quantities::of(|q| {
        let variance = checked.filter(|_| known[q as usize])?[(N + 1) * q as usize];
        Some(variance.sqrt())
    }))
}

fn part_is_at_most_the_whole(m: &Estimate) -> Result<(), BoundaryError> {
    for at in (0..m.covariance_model.len()).step_by(N + 1) {
        let whole = m.covariance.get(at).copied().unwrap_or_default();
        let part = m.covariance_model[at];
        let fits = part <= whole * (1.0 + 1e-9);
        CHECK.that(
            fits,
            format_args!("covariance_model[{at}]"),
            part,
            "at most the same entry of covariance",
        )?;
    }
    Ok(())
}

fn interval(m: &Estimate, known: &[bool; N]) -> Result<Interval, BoundaryError> {
    let level = CHECK.share("credible_level", m.credible_level)?;
    if level == 0.0 {
        return Ok(Interval::default());
    }
    CHECK.all_finite("interval", &m.interval)?;
    let ends = CHECK.array::<{ 2 * N }>("interval", &m.interval)?.unwrap_or_default();
    let mut bounds = [None; N];
    for (i, bounds) in bounds.iter_mut().enumerate() {
        let (low, high) = (ends[2 * i], ends[2 * i + 1]);
        let name = format!("interval[{}]", 2 * i);
        if known[i] {
            CHECK.that(low <= high, &name, low, "at most the upper bound that follows it")?;
            *bounds = Some([low, high]);
        } else {
            let requirement = "0 as the bound after it, because its quantity is not known";
            CHECK.that(low == 0.0 && high == 0.0, &name, low, requirement)?;
        }
    }
    Ok(Interval { level: Some(level), bounds: Quantities(bounds) })
}

fn chi_square(m: &Estimate) -> Result<Option<f64>, BoundaryError> {
    let chi_square = CHECK.not_negative("chi_square", m.chi_square)?;
    if m.degrees_of_freedom == 0 {
        CHECK.that(chi_square == 0.0, "chi_square", chi_square, "0 where degrees_of_freedom is 0")?;
        return Ok(None);
    }
    Ok(Some(chi_square))
}

fn condition_number(m: &Estimate) -> Result<Option<f64>, BoundaryError> {
    CHECK.optional("condition_number", &m.condition_number, |field, number| {
        CHECK.that(number.is_finite() && *number >= 1.0, field, *number, "finite and 1 or more")
    })
}

fn information(m: &Estimate, known: &[bool; N]) -> Result<(), BoundaryError> {
    CHECK.all_finite("information", &m.information)?;
    for (i, shares) in m.information.chunks_exact(INFERENCE_INPUTS.len()).enumerate() {
        let start = INFERENCE_INPUTS.len() * i;
        let Some(j) = shares.iter().position(|s| *s != 0.0) else { continue };
        CHECK.that(known[i], format_args!("information[{}]", start + j), shares[j], NOTHING)?;
        // Contributions of correlated data may be large and cancel, so that rounding affects the sum.
        let slack = 1e-6 * shares.iter().map(|s| s.abs()).sum::<f64>();
        let (sum, name) = (
            shares.iter().sum::<f64>(),
            format!("sum of information[{start}..{}]", start + INFERENCE_INPUTS.len()),
        );
        CHECK.that((sum - 1.0).abs() <= slack, &name, sum, "1, or the row all 0 if unknown")?;
    }
    Ok(())
}
