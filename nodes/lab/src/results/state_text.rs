//! A measured packing for people.

use super::state::State;
use super::structure::StructureView;
use super::symmetry::SymmetryView;
use grainlab_console::{Table, fixed};

/// The block of one state: structure in two lines, then the moduli, affine beside relaxed.
pub(crate) fn text(s: &State) -> String {
    let [l11, l22, l33, ..] = s.fabric;
    let mut text = format!(
        "  {} grains, {} contacts, {} rattlers; phi {:.4}, p {:.4} kPa, q/p {}, unbalanced {}\n",
        s.grains,
        s.contacts,
        s.rattlers,
        s.phi,
        s.pressure_pa / 1e3,
        s.stress_ratio().map_or_else(|| "-".to_owned(), |r| format!("{r:.1e}")),
        s.unbalanced.map_or_else(|| "-".to_owned(), |r| format!("{r:.1e}")),
    );
    text += &format!(
        "  k {:.3}, z {:.3}; L11 {l11:.4}, L22 {l22:.4}, L33 {l33:.4}, eps {:.4}\n",
        s.k, s.z, s.eps
    );
    if s.reference_axis != [0.0, 0.0, 1.0] {
        text += &format!("  eps, gamma/Delta, G12 and G13 are about {}\n", direction(&s.reference_axis));
    }
    text += &format!(
        "  gamma/Delta: total {}, elastic {}, contact {}\n",
        fixed(s.g.total, 4),
        fixed(s.g.elastic, 4),
        fixed(s.g.contact, 4)
    );
    text += &structure(&s.structure);
    if let Some((relaxed, affine)) = s.moduli() {
        let mut t = Table::new(["modulus", "relaxed/MPa", "affine/MPa", "affine/relaxed"]);
        for (i, name) in ["G12", "G13", "Theta"].into_iter().enumerate() {
            let (r, a) = (relaxed[i], affine[i]);
            t.row([name.to_owned(), fixed(Some(r / 1e6), 2), fixed(Some(a / 1e6), 2), fixed(Some(a / r), 3)]);
        }
        text += &indented(&t.text());
    }
    if let Some(symmetry) = &s.symmetry {
        text += &stiffness(symmetry);
    }
    if let Some(scan) = &s.scan {
        text += &indented(&scan.text());
    }
    for warning in &s.warnings {
        text += &format!("  note: {warning}\n");
    }
    text
}

/// The axis, the anisotropies, the networks and the forces, a line each.
fn structure(s: &StructureView) -> String {
    let mut text = String::new();
    let noise = s.axis.eps_stddev.map_or_else(String::new, |d| format!(" +- {d:.4}"));
    if s.axis.determined {
        text += &format!(
            "  axis {}, +- {} rad; eps about it {:.4}{noise}\n",
            direction(&s.axis.found),
            fixed(s.axis.angle_stddev_rad, 2),
            s.axis.eps
        );
    } else if s.axis.eps_stddev.is_some() {
        text += &format!(
            "  axis undetermined; eps {:.4}{noise} about the likeliest, {}\n",
            s.axis.eps,
            direction(&s.axis.found)
        );
    }
    if let Some(a) = &s.stress_force_fabric {
        let along = &a.along_axis;
        text += &format!(
            "  anisotropy of contacts {:.3}, normal forces {:.3}, tangential forces {:.3}; they predict q/p {:.4}\n",
            along.contacts, along.normal_forces, along.tangential_forces, a.predicted_q_over_p
        );
    }
    let percent = |v: Option<f64>| fixed(v.map(|v| 100.0 * v), 0);
    if let Some(f) = &s.forces {
        text += &format!(
            "  strong contacts: {} % of all, {} % of p, eps {:.4} (weak {:.4}); participation {:.3}",
            percent(s.strong.share_of_contacts),
            percent(s.strong.share_of_pressure),
            s.strong.eps,
            s.weak.eps,
            f.participation
        );
        if let Some(m) = &s.friction {
            let at_limit = percent(Some(m.share_at_limit));
            text += &format!(", mobilised {:.3}, {at_limit} % at the limit", m.mean);
        }
        text.push('\n');
    }
    text
}

/// The class, and how far the stiffness is from the two that matter most.
fn stiffness(s: &SymmetryView) -> String {
    let percent = |v: f64| 100.0 * v;
    format!(
        "  stiffness {} within its noise of {:.1} %: residual {:.1} % if isotropic, {:.1} % if transversely about {}\n",
        s.class,
        percent(s.tolerance),
        percent(s.residuals.isotropic),
        percent(s.residuals.transversely_isotropic),
        direction(&s.axis)
    )
}

fn direction(v: &[f64; 3]) -> String {
    format!("({:.2}, {:.2}, {:.2})", v[0], v[1], v[2])
}

/// Every line two columns to the right.
pub(crate) fn indented(text: &str) -> String {
    text.lines().map(|l| format!("  {l}\n")).collect()
}
