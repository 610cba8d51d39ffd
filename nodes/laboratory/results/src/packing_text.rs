//! A measured packing as text.

use crate::measured_packing::{self, MeasuredPacking};
use crate::printer::Printed;
use grainlab_console::{Table, count, fixed};
use grainlab_core::results::{PackingReport, StressForceFabric};
use grainlab_core::{Stiffness, Symmetry, Vec3};

impl Printed for MeasuredPacking {
    fn warnings(&self) -> Vec<String> {
        self.warnings.iter().map(|w| format!("{}, step {}: {w}", self.source, self.step)).collect()
    }

    fn text(&self) -> String {
        format!("{}, step {}\n{}", self.source, self.step, text(self))
    }

    fn table(packings: &[Self]) -> Table {
        measured_packing::table(packings)
    }
}

/// The block of one packing: structure in two lines, then the moduli, affine and relaxed.
pub(crate) fn text(m: &MeasuredPacking) -> String {
    let r = &m.report;
    let (c, f) = (&r.contacts, &r.fabric);
    let [l11, l22, l33, ..] = f.contact_fabric.voigt();
    let small = |ratio: Option<f64>| ratio.map_or_else(|| "-".to_owned(), |r| format!("{r:.1e}"));
    let mut text = format!(
        "  {}, {}, {}; phi {:.4}, p {:.4} kPa, q/p {}, unbalanced {}\n",
        count(c.grains, "grain"),
        count(c.contacts, "contact"),
        count(c.rattlers, "rattler"),
        r.solid_fraction,
        r.pressure() / 1e3,
        small(r.stress_ratio()),
        small(r.unbalanced_force_ratio),
    );
    text += &format!("  k {:.3}, z {:.3}; ", c.coordination, c.mechanical_coordination);
    text += &match c.contacts {
        0 => "no contacts, and so no L and eps\n".to_owned(),
        _ => format!("L11 {l11:.4}, L22 {l22:.4}, L33 {l33:.4}, eps {:.4}\n", f.contact_anisotropy),
    };
    if f.reference_axis != Vec3::z() {
        text += &format!("  eps, gamma/Delta, G12 and G13 are about {}\n", direction(&f.reference_axis));
    }
    text += &format!(
        "  gamma/Delta: total {}, elastic {}, contact {}\n",
        fixed(r.strain_ratios.total, 4),
        fixed(r.strain_ratios.elastic, 4),
        fixed(r.strain_ratios.contact, 4)
    );
    text += &structure(r);
    if let Some(stiffness) = r.stiffness() {
        let [relaxed, affine] =
            [&stiffness.tensor, &stiffness.bounds.affine].map(|c| three_moduli(c, &f.reference_axis));
        let mut t = Table::new(["modulus", "relaxed/MPa", "affine/MPa", "affine/relaxed"]);
        for (i, name) in ["G12", "G13", "Theta"].into_iter().enumerate() {
            let (r, a) = (relaxed[i], affine[i]);
            t.row([name.to_owned(), fixed(Some(r / 1e6), 2), fixed(Some(a / 1e6), 2), fixed(Some(a / r), 3)]);
        }
        text += &indented(&t.text());
    }
    if let Some(symmetry) = &r.symmetry {
        text += &stiffness(symmetry);
    }
    for warning in &m.warnings {
        text += &format!("  note: {warning}\n");
    }
    text
}

/// G12 and G13 about the unit vector `axis`, and Theta of a stiffness, Pa.
fn three_moduli(c: &Stiffness, axis: &Vec3) -> [f64; 3] {
    let t = c.transverse_isotropy_about(axis);
    [t.g12, t.g13, c.bulk_voigt()]
}

/// The counted anisotropy; `None` without contacts.
pub(crate) fn eps(r: &PackingReport) -> Option<f64> {
    (r.contacts.contacts > 0).then_some(r.fabric.contact_anisotropy)
}

/// G12, G13 and Theta, MPa.
pub fn moduli(r: &PackingReport) -> [Option<f64>; 3] {
    let known = r.stiffness().map(|s| three_moduli(&s.tensor, &r.fabric.reference_axis));
    known.map_or([None; 3], |moduli| moduli.map(|m| Some(m / 1e6)))
}

/// The axis, the anisotropies, the networks and the forces, one line each.
fn structure(r: &PackingReport) -> String {
    let mut text = String::new();
    let (axis, d) = (&r.fabric.principal_axis, &r.stress_decomposition);
    let noise = axis.contact_anisotropy_stddev.map_or_else(String::new, |d| format!(" +- {d:.4}"));
    if axis.determined {
        text += &format!(
            "  axis {}, +- {} rad; eps about it {:.4}{noise}\n",
            direction(&axis.direction),
            fixed(axis.angle_stddev, 2),
            axis.contact_anisotropy
        );
    } else if axis.contact_anisotropy_stddev.is_some() {
        text += &format!(
            "  axis undetermined; eps {:.4}{noise} about the likeliest, {}\n",
            axis.contact_anisotropy,
            direction(&axis.direction)
        );
    }
    if let Some(a) = &d.stress_force_fabric {
        let along = |tensor| StressForceFabric::along(tensor, &r.fabric.reference_axis);
        text += &format!(
            "  anisotropy of contacts {:.3}, normal forces {:.3}, tangential forces {:.3}; they predict q/p {:.4}\n",
            along(&a.contacts),
            along(&a.normal_forces),
            along(&a.tangential_forces),
            a.stress_ratio().deviatoric_invariant()
        );
    }
    let percent = |v: Option<f64>| fixed(v.map(|v| 100.0 * v), 0);
    if let Some(f) = &r.contacts.forces {
        text += &format!(
            "  strong contacts: {} % of all, {} % of p, eps {:.4} (weak {:.4}); participation {:.3}",
            percent(d.share_of_contacts(&d.strong)),
            percent(d.share_of_pressure(&d.strong)),
            d.strong.contact_anisotropy,
            d.weak.contact_anisotropy,
            f.participation_ratio()
        );
        if let Some(m) = &r.contacts.friction {
            let at_limit = percent(Some(r.contacts.sliding_fraction));
            text += &format!(", mobilised {:.3}, {at_limit} % at the limit", m.mean);
        }
        text.push('\n');
    }
    text
}

/// The symmetry class, and the residuals of the two most relevant ones.
fn stiffness(s: &Symmetry) -> String {
    let percent = |v: f64| 100.0 * v;
    format!(
        "  stiffness {} within its noise of {:.1} %: residual {:.1} % if isotropic, {:.1} % if transversely about {}\n",
        s.class.name(),
        percent(s.tolerance),
        percent(s.isotropic),
        percent(s.transversely_isotropic),
        direction(&s.axis)
    )
}

fn direction(v: &Vec3) -> String {
    format!("({:.2}, {:.2}, {:.2})", v[0], v[1], v[2])
}

/// Indents every line by two columns.
pub(crate) fn indented(text: &str) -> String {
    text.lines().map(|l| format!("  {l}\n")).collect()
}
