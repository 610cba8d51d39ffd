//! `Estimate`: the result of one model.

use super::check::Check;
use super::error::BoundaryError;
use super::note::{note_message, notes, status, status_code};
use crate::msg;
use grainlab_core::notes::{Status, texts};
use grainlab_core::results::{
    Estimate, GammaUsed, INFERENCE_INPUTS, InferredQuantity, Interval, MicrostructureCovariance, Quantities,
};

const CHECK: Check = Check("Estimate");

const N: usize = InferredQuantity::COUNT;

impl msg::Estimate {
    /// The fields of the inferred quantities, each with one number or none, in the order of [`InferredQuantity::ALL`].
    pub fn quantities(&self) -> [&Vec<f64>; N] {
        [&self.k, &self.k_hat, &self.z, &self.eps, &self.eps_stiffness]
    }

    /// Fields of the inferred quantities, to be written.
    pub fn quantities_mut(&mut self) -> [&mut Vec<f64>; N] {
        [&mut self.k, &mut self.k_hat, &mut self.z, &mut self.eps, &mut self.eps_stiffness]
    }
}

/// Returns the message of an estimate. It has numbers only where the status is not unknown.
pub fn estimate_message(estimate: &Estimate) -> msg::Estimate {
    let gamma = &estimate.gamma;
    let mut message = msg::Estimate {
        model: estimate.model.clone(),
        calibration: estimate.calibration.clone(),
        status: status_code(estimate.status),
        gamma_over_delta: gamma.iter().map(|gamma| gamma.value).collect(),
        gamma_over_delta_source: gamma.map_or("none", |gamma| gamma.source).to_owned(),
        warnings: texts(&estimate.notes),
        notes: estimate.notes.iter().map(note_message).collect(),
        ..Default::default()
    };
    if estimate.status != Status::Unknown {
        let level = estimate.interval.level;
        let bounds = estimate.interval.bounds.0.into_iter().flat_map(Option::unwrap_or_default);
        message.covariance = entries(estimate.covariance);
        message.covariance_model = entries(estimate.covariance_model);
        message.interval = level.map_or_else(Vec::new, |_| bounds.collect());
        message.credible_level = level.unwrap_or(0.0);
        message.chi_square = estimate.chi_square.unwrap_or(0.0);
        message.degrees_of_freedom = estimate.degrees_of_freedom.unwrap_or(0) as u32;
        message.condition_number = Vec::from_iter(estimate.condition_number);
        let shares = estimate.information.0.into_iter().flat_map(Option::unwrap_or_default);
        message.information.iter_mut().zip(shares).for_each(|(field, share)| *field = share);
        for (field, value) in message.quantities_mut().into_iter().zip(estimate.values.0) {
            field.extend(value);
        }
    }
    debug_assert!(Estimate::try_from(&message).is_ok(), "{:?}", Estimate::try_from(&message));
    message
}

fn entries(covariance: Option<MicrostructureCovariance>) -> Vec<f64> {
    covariance.map_or_else(Vec::new, |c| c.transpose().iter().copied().collect())
}

impl TryFrom<&msg::Estimate> for Estimate {
    type Error = BoundaryError;

    fn try_from(m: &msg::Estimate) -> Result<Self, BoundaryError> {
        let status = status(CHECK, "status", m.status)?;
        let notes = notes(CHECK, &m.notes, &m.warnings, status)?;
        if !m.notes.is_empty() && Status::of(&notes) != status {
            return Err(CHECK.refused("status", status, "be the worst status of the notes"));
        }
        let unknown = Self { gamma: strain_ratio(m)?, ..Self::unknown(&m.model, &m.calibration, notes) };
        if status == Status::Unknown {
            return Ok(unknown);
        }
        let values = values(m)?;
        let known = values.map(|v| v.is_some());
        let [whole, part] = [("covariance", &m.covariance), ("covariance_model", &m.covariance_model)]
            .map(|(field, entries)| covariance(field, entries, &known));
        let (covariance, covariance_model) = (whole?, part?);
        part_is_at_most_the_whole(m)?;
        let interval = interval(m, &known)?;
        let chi_square = chi_square(m)?;
        let condition_number = condition_number(m)?;
        Ok(Self {
            values: Quantities(values),
            covariance,
            covariance_model,
            interval,
            chi_square,
            degrees_of_freedom: Some(m.degrees_of_freedom as usize),
            condition_number,
            information: information(m, &known)?,
            status,
            ..unknown
        })
    }
}

fn strain_ratio(m: &msg::Estimate) -> Result<Option<GammaUsed>, BoundaryError> {
    const SOURCES: [&str; 6] = ["total", "elastic", "contact", "given", "zero", "none"];
    let listed = "total, elastic, contact, given, zero, none";
    let source = CHECK.word("gamma_over_delta_source", &m.gamma_over_delta_source, &SOURCES, listed)?;
    let value = CHECK.optional_finite("gamma_over_delta", &m.gamma_over_delta)?;
    let expected = usize::from(source != "none");
    let reason = "one strain ratio, or none where its source is none";
    CHECK.length("gamma_over_delta", m.gamma_over_delta.len(), expected, reason)?;
    Ok(value.map(|value| GammaUsed { value, source }))
}

fn values(m: &msg::Estimate) -> Result<[Option<f64>; N], BoundaryError> {
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
) -> Result<Option<MicrostructureCovariance>, BoundaryError> {
    let checked: Option<[f64; N * N]> = CHECK.covariance(field, values)?;
    for (at, value) in values.iter().enumerate() {
        let both = known[at / N] && known[at % N];
        CHECK.that(both || *value == 0.0, format_args!("{field}[{at}]"), *value, NOTHING)?;
    }
    Ok(checked.map(|entries| MicrostructureCovariance::from_row_slice(&entries)))
}

fn part_is_at_most_the_whole(m: &msg::Estimate) -> Result<(), BoundaryError> {
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

fn interval(m: &msg::Estimate, known: &[bool; N]) -> Result<Interval, BoundaryError> {
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

fn chi_square(m: &msg::Estimate) -> Result<Option<f64>, BoundaryError> {
    let chi_square = CHECK.not_negative("chi_square", m.chi_square)?;
    if m.degrees_of_freedom == 0 {
        CHECK.that(chi_square == 0.0, "chi_square", chi_square, "0 where degrees_of_freedom is 0")?;
        return Ok(None);
    }
    Ok(Some(chi_square))
}

fn condition_number(m: &msg::Estimate) -> Result<Option<f64>, BoundaryError> {
    CHECK.optional("condition_number", &m.condition_number, |field, number| {
        CHECK.that(number.is_finite() && *number >= 1.0, field, *number, "finite and 1 or more")
    })
}

type Shares = [f64; INFERENCE_INPUTS.len()];

fn information(m: &msg::Estimate, known: &[bool; N]) -> Result<Quantities<Option<Shares>>, BoundaryError> {
    CHECK.all_finite("information", &m.information)?;
    let mut found = Quantities::default();
    for (i, shares) in m.information.as_chunks().0.iter().enumerate() {
        let shares: &Shares = shares;
        let start = shares.len() * i;
        let Some(j) = shares.iter().position(|s| *s != 0.0) else { continue };
        CHECK.that(known[i], format_args!("information[{}]", start + j), shares[j], NOTHING)?;
        // Contributions of correlated data may be large and cancel, so that rounding affects the sum.
        let slack = 1e-6 * shares.iter().map(|s| s.abs()).sum::<f64>();
        let sum: f64 = shares.iter().sum();
        let name = format!("sum of information[{start}..{}]", start + shares.len());
        CHECK.that((sum - 1.0).abs() <= slack, &name, sum, "1, or the row all 0 if unknown")?;
        found.0[i] = Some(*shares);
    }
    Ok(found)
}
