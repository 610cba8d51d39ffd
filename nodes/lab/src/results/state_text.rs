//! A measured packing for people.

use super::state::State;
use crate::output::{Table, fixed};

/// The block of one state: structure in two lines, then the moduli, affine beside relaxed.
pub(crate) fn text(s: &State) -> String {
    let [l11, l22, l33, ..] = s.fabric;
    let mut text = format!(
        "  {} grains, {} contacts, {} rattlers; phi {:.4}, p {:.4} kPa, q/p {}\n",
        s.grains,
        s.contacts,
        s.rattlers,
        s.phi,
        s.pressure_pa / 1e3,
        s.stress_ratio().map_or_else(|| "-".to_owned(), |r| format!("{r:.1e}")),
    );
    text += &format!(
        "  k {:.3}, z {:.3}; L11 {l11:.4}, L22 {l22:.4}, L33 {l33:.4}, eps {:.4}\n",
        s.k, s.z, s.eps
    );
    text += &format!(
        "  gamma/Delta: total {}, elastic {}, contact {}\n",
        fixed(s.g.total, 4),
        fixed(s.g.elastic, 4),
        fixed(s.g.contact, 4)
    );
    if let Some((relaxed, affine)) = s.moduli() {
        let mut t = Table::new(["modulus", "relaxed/MPa", "affine/MPa", "affine/relaxed"]);
        for (i, name) in ["G12", "G13", "Theta"].into_iter().enumerate() {
            let (r, a) = (relaxed[i], affine[i]);
            t.row([name.to_owned(), fixed(Some(r / 1e6), 2), fixed(Some(a / 1e6), 2), fixed(Some(a / r), 3)]);
        }
        text += &indented(&t.text());
    }
    for warning in &s.warnings {
        text += &format!("  note: {warning}\n");
    }
    text
}

/// Every line two columns to the right.
pub(crate) fn indented(text: &str) -> String {
    text.lines().map(|l| format!("  {l}\n")).collect()
}
