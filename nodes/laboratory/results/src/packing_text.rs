//! A measured packing as text.

use crate::measured_packing::{MeasuredPacking, ORIGIN};
use crate::printer::Printed;
use crate::quantities::{cells, columns, typed_cells};
use grainlab_console::{Cell, Table, count, three_digits, wrapped};
use grainlab_core::quantity::by_key;
use grainlab_core::results::{PackingReport, QUANTITIES};

impl Printed for MeasuredPacking {
    fn warnings(&self) -> Vec<String> {
        self.notes.iter().map(|w| format!("{}, step {}: {w}", self.source, self.step)).collect()
    }

    fn text(&self) -> String {
        format!("{}, step {}\n{}", self.source, self.step, text(self))
    }

    fn table(packings: &[Self]) -> Table {
        let mut t = Table::new(columns(ORIGIN).chain(columns(QUANTITIES)));
        for p in packings {
            t.row(cells(ORIGIN, p).chain(cells(QUANTITIES, &p.report)));
        }
        t
    }
}

/// Quantities below the first line of a packing; JSON and CSV have all.
const SHOWN: &str = "k z eps eps_stiffness fabric reference_axis g_total g_elastic g_contact axis axis_determined \
    axis_angle_stddev_rad axis_eps axis_eps_stddev a_contacts a_normal_forces a_tangential_forces \
    predicted_q_over_p strong_share_of_contacts strong_share_of_pressure strong_eps weak_eps \
    participation mobilised_mean mobilised_share_at_limit method g12_pa g13_pa theta_pa theta_reuss_pa \
    theta_bound_pa g_isotropic_pa poisson_isotropic symmetry symmetry_tolerance symmetry_axis residual_isotropic \
    residual_transversely_isotropic";

const ROW: usize = 3;

/// The block of one packing: what it is made of in a line, and its quantities by their keys.
pub(crate) fn text(m: &MeasuredPacking) -> String {
    let (r, c) = (&m.report, &m.report.contacts);
    let small = |ratio: Option<f64>| ratio.map_or_else(|| "-".to_owned(), |r| format!("{r:.1e}"));
    let about = format!(
        "{}, {}, {}; phi {:.4}, p {} kPa, q/p {}, unbalanced {}",
        count(c.grains, "grain"),
        count(c.contacts, "contact"),
        count(c.rattlers, "rattler"),
        r.solid_fraction,
        three_digits(Some(r.pressure() / 1e3), 4),
        small(r.stress_ratio()),
        small(r.unbalanced_force_ratio),
    );
    let mut text = wrapped("  ", &about);
    let mut table = Table::new(["quantity", "value", "symbol"]);
    for q in SHOWN.split(' ').filter_map(|key| by_key(QUANTITIES, key)) {
        let words: Vec<String> = typed_cells([q], r).map(|cell| rounded(&cell)).collect();
        if words.iter().all(|word| word == "-") {
            continue;
        }
        // A tensor has its normal and its shear components in two rows.
        for (n, row) in words.chunks(ROW).enumerate() {
            let names = if n == 0 { [q.key, q.symbol] } else { [""; 2] };
            table.row([names[0].to_owned(), row.join(" "), names[1].to_owned()]);
        }
    }
    text += &indented(&table.text());
    m.notes.iter().for_each(|note| text += &wrapped("  note: ", &note.to_string()));
    text
}

/// A value with four decimals, or in exponent form where they would show fewer than three digits.
fn rounded(cell: &Cell) -> String {
    match cell {
        Cell::Unknown => "-".to_owned(),
        Cell::Number(v) if v.abs() >= 1e4 || *v != 0.0 && v.abs() < 1e-2 => format!("{v:.4e}"),
        Cell::Number(v) => format!("{v:.4}"),
        other => other.text(),
    }
}

/// The counted anisotropy; `None` without contacts.
pub(crate) fn eps(r: &PackingReport) -> Option<f64> {
    (r.contacts.contacts > 0).then_some(r.fabric.contact_anisotropy)
}

/// G12, G13 and Theta, MPa.
pub fn moduli(r: &PackingReport) -> [Option<f64>; 3] {
    let Some(stiffness) = r.stiffness() else { return [None; 3] };
    let t = stiffness.tensor.transverse_isotropy_about(&r.fabric.reference_axis);
    [t.g12, t.g13, stiffness.tensor.bulk_voigt()].map(|m| Some(m / 1e6))
}

/// q/p, by its order of magnitude if it is small.
pub(crate) fn stress_ratio(r: &PackingReport) -> String {
    match r.stress_ratio() {
        None => "-".to_owned(),
        Some(q) if q.abs() < 0.01 => format!("{q:.0e}"),
        Some(q) => format!("{q:.3}"),
    }
}

/// Indents every line by two columns.
pub(crate) fn indented(text: &str) -> String {
    text.lines().map(|l| format!("  {l}\n")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measured_packing::tests::{lattice, measured};

    #[test]
    fn every_quantity_shown_is_one_of_the_table() {
        assert!(SHOWN.split(' ').all(|key| by_key(QUANTITIES, key).is_some()));
    }

    #[test]
    fn a_pressure_of_millipascals_keeps_three_digits() {
        let mut soft = lattice(true);
        soft.contacts.iter_mut().for_each(|c| c.normal_force *= 1e-7);
        let found = measured(&soft);
        let p = found.report.pressure() / 1e3;
        let text = text(&found);
        assert!(p < 1e-5 && text.contains(&format!("p {} kPa", three_digits(Some(p), 4))), "{p}: {text}");
        assert!(!text.contains("p 0.0000 kPa"), "{text}");
    }
}
