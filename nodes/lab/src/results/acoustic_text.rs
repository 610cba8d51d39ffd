//! Wave speeds for people: what was measured, and its moduli beside those of the network.

use super::acoustic::AcousticView;
use super::state::State;
use super::state_text::indented;
use grainlab_console::{Table, fixed};
use grainlab_core::{Stiffness, Vec3};

/// What the speeds are, in a few words: `wave speeds (dispersion, 27 speeds, each +- 0.30 %)`.
pub(crate) fn heading(a: &AcousticView) -> String {
    let method = a.method.map_or_else(String::new, |m| format!("{}, ", m.replace('_', " ")));
    let error = a.relative_error().map_or_else(String::new, |e| format!(", each +- {}", percent(e)));
    format!("wave speeds ({method}{} speeds{error})", a.speeds.len())
}

/// The block of one packing: its density, its moduli beside the static ones of `state`, and what is to be known.
pub(crate) fn text(a: &AcousticView, state: &State) -> String {
    let mut text = format!("  {}\n", heading(a));
    text += &format!(
        "  density {:.1}{} kg/m3 moves with the waves, of {:.1} kg/m3 of all grains{}\n",
        a.density,
        a.density_stddev.map_or_else(String::new, |s| format!(" +- {s:.1}")),
        a.density_bulk,
        scatter(a),
    );
    if a.axis.is_none() {
        let [x, y, z] = a.moduli_axis;
        text += &format!("  moduli about ({x:.3}, {y:.3}, {z:.3}), for no axis was named\n");
    }
    text += &indented(&moduli(a, state.stiffness().as_ref()).without_empty_columns().text());
    a.warnings.iter().for_each(|w| text += &format!("  note: {w}\n"));
    text
}

/// Two digits that mean something, of something small.
fn percent(share: f64) -> String {
    if share < 5e-5 { format!("{:.0e} %", 100.0 * share) } else { format!("{:.2} %", 100.0 * share) }
}

/// How far the speeds are from those of one medium, and what that does to the errors.
fn scatter(a: &AcousticView) -> String {
    let Some(scatter) = a.scatter else { return String::new() };
    let enlarged = if a.departure.is_some() { ", more than their errors, which were enlarged" } else { "" };
    format!("; speeds scatter by {:.2} % about one medium{enlarged}", 100.0 * scatter)
}

/// The projection of the stiffness on media isotropic about the axis taken, and the moduli from the speeds.
fn moduli(a: &AcousticView, stiffness: Option<&Stiffness>) -> Table {
    let axis = Vec3::from(a.moduli_axis);
    let medium = stiffness.map(|c| c.transverse_isotropy_about(&axis));
    let (m, s) = (&a.moduli, &a.sigma);
    let mut t = Table::new(["modulus", "network/MPa", "acoustic/MPa", "sigma", "difference", "in sigma"]);
    for (name, network, value, sigma) in [
        ("C33", medium.map(|t| t.c33), m.c33_pa, s.c33_pa),
        ("C11", medium.map(|t| t.c11), m.c11_pa, s.c11_pa),
        ("C44 = G13", medium.map(|t| t.g13), m.g13_pa, s.g13_pa),
        ("C66 = G12", medium.map(|t| t.g12), m.g12_pa, s.g12_pa),
        ("C13", medium.map(|t| t.c13), m.c13_pa, s.c13_pa),
        ("Theta", stiffness.map(Stiffness::bulk_voigt), m.theta_pa, s.theta_pa),
    ] {
        let mega = |v: Option<f64>| fixed(v.map(|v| v / 1e6), 2);
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
