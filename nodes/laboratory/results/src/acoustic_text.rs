//! Wave speeds as text: the measured ones, and their moduli compared with those of the network.

use crate::acoustic::AcousticReport;
use crate::packing_text::indented;
use grainlab_console::{Table, count, three_digits};
use grainlab_core::Stiffness;
use grainlab_core::results::PackingReport;

/// Largest over smallest error of speeds that have one in common.
const ALIKE: f64 = 1.5;

/// Summary of the speeds: `wave speeds (dispersion, 27 speeds, each +- 0.30 %)`.
pub(crate) fn heading(a: &AcousticReport) -> String {
    let method = a.method().map_or_else(String::new, |m| format!("{}, ", m.replace('_', " ")));
    let errors = a.relative_errors();
    let error = match (errors.get(errors.len() / 2), errors[..].first().zip(errors.last())) {
        (Some(median), Some((least, greatest))) if *greatest > ALIKE * least => {
            format!(", +- {} to {}, median {}", percent(*least), percent(*greatest), percent(*median))
        }
        (Some(median), _) => format!(", each +- {}", percent(*median)),
        _ => String::new(),
    };
    let which = a.measurement.as_ref().map_or_else(String::new, |m| format!(", {}", m.label));
    format!("wave speeds{which} ({method}{}{error})", count(a.reading.speeds.len(), "speed"))
}

/// The block of one packing: its density, its moduli compared with the static ones of `report`, and notes.
pub(crate) fn text(a: &AcousticReport, report: &PackingReport) -> String {
    let mut text = format!("  {}\n", heading(a));
    text += &format!(
        "  density {:.1}{} kg/m3 moves with the waves, of {:.1} kg/m3 of all grains\n",
        a.reading.density,
        a.reading.density_stddev.map_or_else(String::new, |s| format!(" +- {s:.1}")),
        a.bulk_density,
    );
    let [x, y, z]: [f64; 3] = a.medium.axis.into();
    text += &match (&a.medium.no_axis, a.reading.axis) {
        (Some(_), _) => "  no axis stands out in the speeds; moduli about e3 = z\n".to_owned(),
        (None, None) => format!("  moduli about ({x:.3}, {y:.3}, {z:.3}), the axis that the speeds show\n"),
        (None, Some(_)) => format!("  moduli about ({x:.3}, {y:.3}, {z:.3})\n"),
    };
    text += &indented(&moduli(a, report.stiffness().map(|s| &s.tensor)).without_empty_columns().text());
    a.notes().iter().for_each(|w| text += &format!("  note: {w}\n"));
    text
}

/// Two significant digits of a small number.
fn percent(share: f64) -> String {
    if share < 5e-5 { format!("{:.0e} %", 100.0 * share) } else { format!("{:.2} %", 100.0 * share) }
}

/// The projection of the stiffness on media isotropic about the axis used, and the moduli from the speeds.
fn moduli(a: &AcousticReport, stiffness: Option<&Stiffness>) -> Table {
    let mut t = Table::new(["modulus", "network/MPa", "acoustic/MPa", "sigma", "difference", "in sigma"]);
    for (name, modulus, network) in a.moduli(stiffness) {
        let (value, sigma) = (a.medium.modulus(modulus), a.medium.stddev(modulus));
        let mega = |v: Option<f64>| three_digits(v.map(|v| v / 1e6), 2);
        let off = value.zip(network).map(|(v, n)| v - n);
        let percent = off.zip(network).map(|(o, n)| 100.0 * o / n);
        let in_sigma = off.zip(sigma.filter(|s| *s > 0.0)).map(|(o, s)| o / s);
        let signed = |v: Option<f64>, digits: usize, unit: &str| {
            v.filter(|v| v.is_finite()).map_or_else(|| "-".to_owned(), |v| format!("{v:+.digits$}{unit}"))
        };
        t.row([
            name.to_owned(),
            mega(network),
            mega(value),
            mega(sigma),
            signed(percent, 2, " %"),
            signed(in_sigma, 1, ""),
        ]);
    }
    t
}
