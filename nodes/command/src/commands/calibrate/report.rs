//! A calibration as text.

use grainlab_console::Table;
use grainlab_emt::{Calibration, CalibrationSample, IsotropicCalibration, Reach, RelaxationCalibration};
use std::collections::BTreeSet;

/// Constants with their standard errors, scatter, and ranges.
pub(super) fn text(
    calibration: &Calibration,
    [isotropic, anisotropic, others]: [&[CalibrationSample]; 3],
) -> String {
    let mut text = format!("calibration {}\n", calibration.name());
    for (kind, samples) in [("isotropic", isotropic), ("not isotropic", anisotropic), ("other", others)] {
        if !samples.is_empty() {
            text += &format!("  {}\n", summary(kind, samples));
        }
    }
    text += "\nEqs. 21 and 22, G = alpha (k + beta) p^(1/3), Theta = rho (k + zeta) p^(1/3), in MPa\n";
    text += &line_table(calibration.isotropic());
    if let Some(network) = calibration.network() {
        text += &network_text(network);
    }
    text
}

fn summary(kind: &str, samples: &[CalibrationSample]) -> String {
    let packings: BTreeSet<&str> = samples.iter().map(|s| s.packing.as_str()).collect();
    let preparations: BTreeSet<&str> = samples.iter().map(|s| s.preparation.as_str()).collect();
    let range = |value: fn(&CalibrationSample) -> f64| {
        let values = samples.iter().map(value);
        values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)])
    };
    let ([p, q], [y, z], [a, b]) = (range(|s| s.pressure / 1e3), range(|s| s.z), range(|s| s.eps));
    format!(
        "{} of {} {kind} ({}): p {p:.4} to {q:.4} kPa, z {y:.3} to {z:.3}, eps {a:.3} to {b:.3}",
        grainlab_console::count(samples.len(), "state"),
        grainlab_console::count(packings.len(), "packing"),
        preparations.into_iter().collect::<Vec<_>>().join(", "),
    )
}

fn line_table(line: &IsotropicCalibration) -> String {
    let columns = ["alpha", "+-", "beta", "+-", "rho", "+-", "zeta", "+-", "from", "to"];
    let mut t = Table::new(columns.into_iter().chain(["scatter of G", "of Theta"]));
    let errors = line.covariance.map(|c| std::array::from_fn::<f64, 4, _>(|i| c[i][i].max(0.0).sqrt()));
    let errors = errors.map_or_else(|| [(); 4].map(|()| "-".to_owned()), |e| e.map(significant));
    let mut cells = Vec::new();
    for (value, error) in line.constants().into_iter().zip(errors) {
        cells.extend([format!("{value:.4}"), error]);
    }
    cells.extend(line.fitted.map(|v| format!("{v:.3}")));
    match line.scatter {
        Some(scatter) => cells.extend(scatter.map(|s| format!("{:.1} %", 100.0 * s))),
        None => cells.extend([(); 2].map(|()| "-".to_owned())),
    }
    t.row(cells);
    t.text()
}

/// Reach of the laws of relaxed networks, and the scatter about them; the file has their coefficients.
fn network_text(n: &RelaxationCalibration) -> String {
    let names = ["ln bulk", "ln shear", "dilatational", "Voigt", "harmonic", "eps by stiffness", "k"];
    let mut scatter = Table::new(names);
    scatter.row((0..names.len()).map(|i| format!("{:.4}", n.scatter[i][i].max(0.0).sqrt())));
    let Reach { z, eps, pressure: [p, q], stiffness_ratio, size_spread, stress_ratio } = n.reach;
    let others =
        [("z", z), ("eps", eps), ("k_t/k_n", stiffness_ratio), ("s", size_spread), ("q/p", stress_ratio)];
    let others = others.map(|(name, [low, high])| format!(", {name} {low:.3} to {high:.3}")).concat();
    format!(
        "\nRelaxed networks of {} grains, {}: p/E* {p:.2e} to {q:.2e}{others}\nScatter of packings left out of the laws by their \
         recipes, all but that of k times (z - 4)/z\n{}",
        n.grains,
        grainlab_console::count(n.recipes as usize, "recipe"),
        scatter.text(),
    )
}

/// An error to two digits.
fn significant(value: f64) -> String {
    if value <= 0.0 || !value.is_finite() {
        return value.to_string();
    }
    let digits = (1.0 - value.log10().floor()).clamp(0.0, 12.0) as usize;
    format!("{value:.digits$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_printed_with_two_digits() {
        for (value, text) in [(0.000_123_4, "0.00012"), (1.808, "1.8"), (23.7, "24"), (0.0, "0")] {
            assert_eq!(significant(value), text);
        }
    }
}
