//! A calibration as text.

use grainlab_console::Table;
use grainlab_core::results::InferredQuantity;
use grainlab_emt::{Calibration, CalibrationSample, IsotropicCalibration};
use grainlab_emt::{DeviatorLaw, RattlerLaw, Reach, RelaxationCalibration, ScalingLaw};
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
    let lines = [InferredQuantity::K, InferredQuantity::Z].map(|q| calibration.with_coordination_kind(q));
    text += &line_table(lines.iter().flatten().map(Calibration::isotropic));
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

fn line_table<'a>(lines: impl Iterator<Item = &'a IsotropicCalibration>) -> String {
    let columns = ["k is", "alpha", "+-", "beta", "+-", "rho", "+-", "zeta", "+-", "from", "to"];
    let mut t = Table::new(columns.into_iter().chain(["scatter of G", "of Theta"]));
    for line in lines {
        let errors = line.covariance.map(|c| std::array::from_fn::<f64, 4, _>(|i| c[i][i].max(0.0).sqrt()));
        let errors = errors.map_or_else(|| [(); 4].map(|()| "-".to_owned()), |e| e.map(significant));
        let mut cells = vec![line.coordination_kind.name().to_owned()];
        for (value, error) in line.constants().into_iter().zip(errors) {
            cells.extend([format!("{value:.4}"), error]);
        }
        cells.extend(line.fitted.map(|v| format!("{v:.3}")));
        match line.scatter {
            Some(scatter) => cells.extend(scatter.map(|s| format!("{:.1} %", 100.0 * s))),
            None => cells.extend([(); 2].map(|()| "-".to_owned())),
        }
        t.row(cells);
    }
    t.text()
}

fn network_text(n: &RelaxationCalibration) -> String {
    let RattlerLaw([a, b, c, d, e, f, g]) = n.rattlers;
    let names = ["ln bulk", "ln shear", "dilatational", "Voigt", "harmonic", "eps by stiffness", "k"];
    let mut scatter = Table::new(names);
    scatter.row((0..names.len()).map(|i| format!("{:.4}", n.scatter[i][i].max(0.0).sqrt())));
    let Reach { z, eps, pressure, stiffness_ratio, size_spread, stress_ratio } = n.reach;
    let growth =
        n.scatter_by_state.map(|[sizes, pressure]| format!("exp({sizes:.2} s^2 {pressure:+.3} ln p)"));
    let [of_scalars, of_deviators, of_k] = growth;
    format!(
        "\nRelaxed networks of {} grains, {}, in units of E*^(2/3) p^(1/3)\nz {:.3} to {:.3}, eps {:.3} to {:.3}, p/E* {:.2e} \
         to {:.2e}, k_t/k_n {:.3} to {:.3}, s {:.3} to {:.3}, q/p {:.3} to {:.3}\np is p/E* over 1e-6, kappa k_t/k_n - 8/9, s \
         the standard deviation of the radii over their mean, u = z/(z - 4)\n{}{}k = {a:.3} {b:+.4} z {c:+.4} z^2 {d:+.4} z^3 \
         {e:+.4} ln p {f:+.3} s^2 {g:+.3} z s^2\nScatter of packings left out of the laws by their recipes, all but that of k times (z - 4)/z\n\
         {}Its variance grows as {of_scalars} for bulk and shear, {of_k} for k, {of_deviators} for the others\n",
        n.grains,
        grainlab_console::count(n.recipes as usize, "recipe"),
        z[0],
        z[1],
        eps[0],
        eps[1],
        pressure[0],
        pressure[1],
        stiffness_ratio[0],
        stiffness_ratio[1],
        size_spread[0],
        size_spread[1],
        stress_ratio[0],
        stress_ratio[1],
        scalars(n),
        deviators(n),
        scatter.text(),
    )
}

/// One line a term of the laws of ln Θ and ln G.
fn scalars(n: &RelaxationCalibration) -> String {
    let terms = ["1", "ln z", "ln(z - z0)", "z0", "ln p", "kappa", "s^2", "kappa ln z", "ln p ln z"];
    let coefficients = [&n.theta, &n.shear].map(|law| {
        let ScalingLaw { level, by_z, by_excess, onset, by_pressure, by_stiffness_ratio, .. } = *law;
        let [by_mixed_ratio, by_mixed_pressure] = law.mixed;
        [
            level,
            by_z,
            by_excess,
            onset,
            by_pressure,
            by_stiffness_ratio,
            law.by_size_variance,
            by_mixed_ratio,
            by_mixed_pressure,
        ]
    });
    by_term(["terms of ln X", "bulk", "shear"], &terms, |i| coefficients.map(|law| law[i]))
}

/// One line a term of the laws of the deviators.
fn deviators(n: &RelaxationCalibration) -> String {
    let head = ["terms of X", "dilatational deviator", "Voigt deviator", "harmonic part", "eps by stiffness"];
    let laws = [&n.dilatation, &n.voigt, &n.harmonic, &n.eps_stiffness];
    let of_eps = ["eps", "eps u", "eps s^2", "eps kappa", "eps ln p", "eps u ln p", "eps z", "eps u kappa"];
    let of_stress = ["q/p", "q/p u", "q/p u ln p"];
    let terms = [&of_eps[..], &of_stress].concat();
    by_term(head, &terms, |i| {
        laws.map(|DeviatorLaw { by_eps, by_stress_ratio }| {
            by_eps.iter().chain(by_stress_ratio).nth(i).copied().unwrap_or(0.0)
        })
    })
}

fn by_term<const COLUMNS: usize, const LAWS: usize>(
    head: [&str; COLUMNS],
    terms: &[&str],
    coefficients: impl Fn(usize) -> [f64; LAWS],
) -> String {
    let mut table = Table::new(head);
    for (i, term) in terms.iter().enumerate() {
        let numbers = coefficients(i).map(|v| format!("{v:.4}"));
        table.row(std::iter::once((*term).to_owned()).chain(numbers));
    }
    table.text()
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
