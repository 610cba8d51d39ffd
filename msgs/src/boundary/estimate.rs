//! `Estimate`: the result of one model.

use super::check::Check;
use super::error::BoundaryError;
use crate::msg::Estimate;
use grainlab_core::results::InferredQuantity;

/// The data, in the order of every row of [`Inferred::information`].
pub const DATA: [&str; 13] = [
    "G12",
    "G13",
    "Theta",
    "C11",
    "C33",
    "C13",
    "pressure",
    "gamma/Delta",
    "solid fraction",
    "q/p",
    "size spread",
    "grain shear modulus",
    "grain Poisson ratio",
];

/// The checked result of one model.
#[derive(Clone, Debug, PartialEq)]
pub struct EstimateReading {
    /// Name of the model.
    pub model: String,
    /// Name of the calibration.
    pub calibration: String,
    /// Status of the inversion.
    pub status: EstimateStatus,
    /// The strain ratio γ/Δ that the model used; `None` if it uses none.
    pub strain_ratio: Option<StrainRatio>,
    /// The values; `None` where the status is `Unknown`.
    pub inferred: Option<Inferred>,
    /// Notes.
    pub warnings: Vec<String>,
}

/// Status of an inversion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EstimateStatus {
    /// All unknowns of the model, inside its range.
    Ok,
    /// A solution outside that range, or some unknowns of the model alone.
    Extrapolated,
    /// The data contradict each other or the model.
    Contradictory,
    /// No answer.
    Unknown,
}

/// A strain ratio γ/Δ with its source.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StrainRatio {
    /// γ/Δ, dimensionless.
    pub value: f64,
    /// `total`, `elastic` or `contact`: one of the three measured ones; `given`; `zero`: unknown, taken as 0.
    pub source: &'static str,
}

/// Inferred values; arrays have the order of [`InferredQuantity::ALL`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inferred {
    /// The values, at least one of them known; `None`: undetermined, or not part of the model.
    pub values: [Option<f64>; N],
    /// Covariance from data and model, row-major; 0 for unknown values.
    pub covariance: Option<[f64; N * N]>,
    /// Its part due to the model.
    pub covariance_model: Option<[f64; N * N]>,
    /// Credible intervals.
    pub interval: Option<Interval>,
    /// Misfit if there are more data than unknowns; else `None`.
    pub misfit: Option<Misfit>,
    /// Condition number, 1 or more: how much the effects of errors of the data differ between combinations.
    pub condition_number: Option<f64>,
    /// Contribution of each of [`DATA`] to the variance of each quantity from the data; the sum of a row is
    /// 1.
    pub information: [Option<[f64; DATA.len()]>; N],
}

/// Credible intervals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Probability inside each, between 0 and 1.
    pub level: f64,
    /// Low and high of each known quantity.
    pub bounds: [Option<[f64; 2]>; N],
}

/// Misfit of the data about the best structure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Misfit {
    /// Weighted sum of squares, by errors of data and model.
    pub chi_square: f64,
    /// Number of data minus number of unknowns, 1 or more.
    pub degrees_of_freedom: u32,
}

const CHECK: Check = Check("Estimate");

const N: usize = InferredQuantity::COUNT;

impl Estimate {
    /// The fields of the inferred quantities, each with one number or none, in the order of [`InferredQuantity::ALL`].
    pub fn quantities(&self) -> [&Vec<f64>; N] {
        [&self.k, &self.k_hat, &self.z, &self.eps, &self.eps_stiffness]
    }

    /// The same fields, to be written.
    pub fn quantities_mut(&mut self) -> [&mut Vec<f64>; N] {
        [&mut self.k, &mut self.k_hat, &mut self.z, &mut self.eps, &mut self.eps_stiffness]
    }
}

impl TryFrom<&Estimate> for EstimateReading {
    type Error = BoundaryError;

    fn try_from(m: &Estimate) -> Result<Self, BoundaryError> {
        let status = match m.status {
            Estimate::STATUS_OK => EstimateStatus::Ok,
            Estimate::STATUS_EXTRAPOLATED => EstimateStatus::Extrapolated,
            Estimate::STATUS_CONTRADICTORY => EstimateStatus::Contradictory,
            Estimate::STATUS_UNKNOWN => EstimateStatus::Unknown,
            other => {
                let allowed = "0 (ok), 1 (extrapolated), 2 (contradictory), 3 (unknown)";
                return Err(CHECK.code("status", other, allowed));
            }
        };
        Ok(Self {
            model: m.model.clone(),
            calibration: m.calibration.clone(),
            status,
            strain_ratio: strain_ratio(m)?,
            inferred: if status == EstimateStatus::Unknown { None } else { Some(inferred(m)?) },
            warnings: m.warnings.clone(),
        })
    }
}

fn strain_ratio(m: &Estimate) -> Result<Option<StrainRatio>, BoundaryError> {
    const SOURCES: [&str; 6] = ["total", "elastic", "contact", "given", "zero", "none"];
    let listed = "total, elastic, contact, given, zero, none";
    let source = CHECK.word("gamma_over_delta_source", &m.gamma_over_delta_source, &SOURCES, listed)?;
    let value = CHECK.optional_finite("gamma_over_delta", &m.gamma_over_delta)?;
    let expected = usize::from(source != "none");
    let reason = "one strain ratio, or none where its source is none";
    CHECK.length("gamma_over_delta", m.gamma_over_delta.len(), expected, reason)?;
    Ok(value.map(|value| StrainRatio { value, source }))
}

fn inferred(m: &Estimate) -> Result<Inferred, BoundaryError> {
    let values = values(m)?;
    let known = values.map(|v| v.is_some());
    Ok(Inferred {
        values,
        covariance: covariance("covariance", &m.covariance, &known)?,
        covariance_model: covariance_model(m, &known)?,
        interval: interval(m, &known)?,
        misfit: misfit(m)?,
        condition_number: condition_number(m)?,
        information: information(m, &known)?,
    })
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

fn covariance(
    field: &'static str,
    values: &[f64],
    known: &[bool; N],
) -> Result<Option<[f64; N * N]>, BoundaryError> {
    let checked = CHECK.covariance(field, values)?;
    for (at, value) in values.iter().enumerate() {
        let both = known[at / N] && known[at % N];
        CHECK.that(both || *value == 0.0, &format!("{field}[{at}]"), *value, NOTHING)?;
    }
    Ok(checked)
}

fn covariance_model(m: &Estimate, known: &[bool; N]) -> Result<Option<[f64; N * N]>, BoundaryError> {
    let part = covariance("covariance_model", &m.covariance_model, known)?;
    for at in (0..m.covariance_model.len()).step_by(N + 1) {
        let whole = m.covariance.get(at).copied().unwrap_or_default();
        let part = m.covariance_model[at];
        let fits = part <= whole * (1.0 + 1e-9);
        CHECK.that(fits, &format!("covariance_model[{at}]"), part, "at most the same entry of covariance")?;
    }
    Ok(part)
}

fn interval(m: &Estimate, known: &[bool; N]) -> Result<Option<Interval>, BoundaryError> {
    let level = CHECK.share("credible_level", m.credible_level)?;
    if level == 0.0 {
        return Ok(None);
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
    Ok(Some(Interval { level, bounds }))
}

fn misfit(m: &Estimate) -> Result<Option<Misfit>, BoundaryError> {
    let chi_square = CHECK.not_negative("chi_square", m.chi_square)?;
    if m.degrees_of_freedom == 0 {
        CHECK.that(chi_square == 0.0, "chi_square", chi_square, "0 where degrees_of_freedom is 0")?;
        return Ok(None);
    }
    Ok(Some(Misfit { chi_square, degrees_of_freedom: m.degrees_of_freedom }))
}

fn condition_number(m: &Estimate) -> Result<Option<f64>, BoundaryError> {
    CHECK.optional("condition_number", &m.condition_number, |field, number| {
        CHECK.that(number.is_finite() && *number >= 1.0, field, *number, "finite and 1 or more")
    })
}

fn information(m: &Estimate, known: &[bool; N]) -> Result<[Option<[f64; DATA.len()]>; N], BoundaryError> {
    CHECK.all_finite("information", &m.information)?;
    let mut rows = [None; N];
    for (i, row) in rows.iter_mut().enumerate() {
        let start = DATA.len() * i;
        let shares: [f64; DATA.len()] = std::array::from_fn(|j| m.information[start + j]);
        if let Some(j) = shares.iter().position(|s| *s != 0.0) {
            CHECK.that(known[i], &format!("information[{}]", start + j), shares[j], NOTHING)?;
            // Contributions of correlated data may be large and cancel, so that rounding affects the sum.
            let slack = 1e-6 * shares.iter().map(|s| s.abs()).sum::<f64>();
            let (sum, name) =
                (shares.iter().sum::<f64>(), format!("sum of information[{start}..{}]", start + DATA.len()));
            CHECK.that((sum - 1.0).abs() <= slack, &name, sum, "1, or the row all 0 if unknown")?;
            *row = Some(shares);
        }
    }
    Ok(rows)
}
