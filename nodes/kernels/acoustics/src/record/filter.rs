//! Filters of the receiver's electronics, applied to the source too, so that both are late alike.

use super::passage::Passage;
use crate::time_of_flight::spectrum::{Analytic, Spectrum};
use std::f64::consts::PI;

/// Response of a Butterworth low pass of so many poles at a frequency over that of −3 dB.
fn low_pass(order: u32, over: f64) -> Analytic {
    let n = f64::from(order);
    let pole = |k: u32| Analytic::cis(PI * (2.0 * f64::from(k) + n + 1.0) / (2.0 * n));
    (0..order).map(|k| pole(k) / (pole(k) - Analytic::new(0.0, over))).product()
}

pub(super) fn filtered(source: &[f64], rate: f64, passage: &Passage) -> Vec<f64> {
    if passage.lowpass.is_none() && passage.highpass.is_none() {
        return source.to_vec();
    }
    let spectrum = Spectrum::new(source.len(), 1);
    let response = |f: f64| {
        let low = passage.lowpass.map_or(1.0.into(), |edge| low_pass(passage.filter_order, f / edge));
        // A high pass is a low pass of the inverse frequency, conjugated.
        let high = |edge: f64| low_pass(passage.filter_order, -edge / f.max(1e-9 * edge));
        low * passage.highpass.map_or(1.0.into(), high)
    };
    let frequencies = spectrum.frequencies().map(|f| f * rate);
    let lines: Vec<Analytic> =
        spectrum.of(source).iter().zip(frequencies).map(|(s, f)| s * response(f)).collect();
    spectrum.delayed(&lines, |_| 0.0)
}
