//! Quantities that are compared with the paper.

use super::tables::{PAPER, REFERENCE_SOLID_FRACTION};
use grainlab_core::results::Microstructure;
use grainlab_core::results::PackingReport;
use grainlab_emt::{Calibration, Conditions, Eq16Reading, Medium, Modulus, StrainRatio, model};

/// A number in the paper.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Printed {
    /// Number as printed.
    pub value: f64,
    /// Half a unit of its last digit, or the error that the rounding of its sources causes.
    pub rounding: f64,
    /// True for a printed number; else it is computed from what is printed.
    pub is_printed: bool,
}

/// A quantity of a packing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Quantity {
    /// Coordination number of all grains.
    K,
    /// Coordination number without rattlers.
    Z,
    /// Diagonal of the fabric tensor.
    Fabric(usize),
    /// Anisotropy of the contacts, Eq. 20.
    Eps,
    /// Deviatoric fabric L33 − (L11 + L22)/2 (Fig. 1).
    DeviatoricFabric,
    /// Solid fraction φ.
    SolidFraction,
    /// γ/Δ of the total strain since the reference state.
    StrainTotal,
    /// γ/Δ of an elastic isotropic increment.
    StrainElastic,
    /// γ/Δ fitted to the overlaps.
    StrainContact,
    /// A shear or bulk modulus, Pa.
    Modulus(Modulus),
    /// Ratio of shear moduli, G13/G12.
    ShearRatio,
    /// k by the effective medium theory from G12, with the volume strain since the reference state (Eq. 14).
    KEmt,
    /// Stress ratio q/p.
    StressRatio,
}

impl Quantity {
    /// Every quantity with its key in files, in the order of the report.
    pub const ALL: [(Quantity, &'static str); 17] = [
        (Quantity::K, "k"),
        (Quantity::Z, "z"),
        (Quantity::Fabric(0), "l11"),
        (Quantity::Fabric(1), "l22"),
        (Quantity::Fabric(2), "l33"),
        (Quantity::Eps, "eps"),
        (Quantity::DeviatoricFabric, "ld"),
        (Quantity::SolidFraction, "phi"),
        (Quantity::StrainTotal, "g_total"),
        (Quantity::StrainElastic, "g_elastic"),
        (Quantity::StrainContact, "g_contact"),
        (Quantity::Modulus(Modulus::G12), "g12_pa"),
        (Quantity::Modulus(Modulus::G13), "g13_pa"),
        (Quantity::Modulus(Modulus::Theta), "theta_pa"),
        (Quantity::ShearRatio, "g13_over_g12"),
        (Quantity::KEmt, "k_emt"),
        (Quantity::StressRatio, "q_over_p"),
    ];

    /// Key in files.
    pub fn key(self) -> &'static str {
        Self::ALL.iter().find(|(known, _)| *known == self).map_or("", |(_, key)| key)
    }

    /// Value in a packing; `None` where it is not defined.
    pub fn measured(self, r: &PackingReport) -> Option<f64> {
        let modulus = |m: Modulus| {
            let stiffness = r.stiffness()?;
            let t = stiffness.tensor.transverse_isotropy_about(&r.fabric.reference_axis);
            Some(match m {
                Modulus::G12 => t.g12,
                Modulus::G13 => t.g13,
                _ => stiffness.tensor.bulk_voigt(),
            })
        };
        match self {
            Self::K => Some(r.contacts.coordination),
            Self::Z => Some(r.contacts.mechanical_coordination),
            Self::Fabric(i) => Some(r.fabric.contact_fabric.voigt()[i]),
            Self::Eps => Some(r.fabric.contact_anisotropy),
            Self::DeviatoricFabric => Some(0.4 * r.fabric.contact_anisotropy),
            Self::SolidFraction => Some(r.solid_fraction),
            Self::StrainTotal => r.strain_ratios.total,
            Self::StrainElastic => r.strain_ratios.elastic,
            Self::StrainContact => r.strain_ratios.contact,
            Self::Modulus(m) => modulus(m),
            Self::ShearRatio => Some(modulus(Modulus::G13)? / modulus(Modulus::G12)?),
            Self::KEmt => {
                let volume_strain = (r.solid_fraction / REFERENCE_SOLID_FRACTION).ln();
                if volume_strain <= 0.0 {
                    return None;
                }
                // Moduli are proportional to k.
                let one = Medium {
                    material: r.material,
                    solid_fraction: r.solid_fraction,
                    volume_strain,
                    k: 1.0,
                    eps: r.fabric.contact_anisotropy,
                    gamma_over_delta: r.strain_ratios.total?,
                };
                Some(modulus(Modulus::G12)? / one.moduli(Eq16Reading::Corrected).psi3)
            }
            Self::StressRatio => r.stress_ratio(),
        }
    }

    /// Value in the paper; `None` where the paper does not have it. z is compared with the paper's k: see the report.
    pub fn in_paper(self, sample: usize, pressure: usize) -> Option<Printed> {
        let (s, state) = (&PAPER[sample], &PAPER[sample].states[pressure]);
        let printed = |value: f64, rounding: f64| Some(Printed { value, rounding, is_printed: true });
        let implied = |value: f64, rounding: f64| Some(Printed { value, rounding, is_printed: false });
        match self {
            Self::K | Self::Z => printed(state.k_sim, 0.005),
            Self::Fabric(i) if pressure == 0 => printed(s.fabric[i], 0.0005),
            Self::SolidFraction if pressure == 0 => printed(s.solid_fraction, 0.0005),
            Self::Eps => printed(state.eps_sim, 0.0005),
            Self::DeviatoricFabric => implied(0.4 * state.eps_sim, 0.0002),
            Self::StrainTotal => printed(s.gamma_over_delta[pressure], 0.00005),
            Self::KEmt => printed(state.k_emt, 0.005),
            Self::Modulus(m) => {
                let value = implied_moduli(sample, pressure)?[m as usize];
                // k̂ is printed to 0.005, and dG/G = dk̂/(k̂ − 3.66).
                let scale = if m == Modulus::Theta { state.k_hat - 0.5 } else { state.k_hat - 3.66 };
                implied(value, value * 0.005 / scale)
            }
            Self::ShearRatio => {
                let m = implied_moduli(sample, pressure)?;
                // ε is printed to 0.0005, and the ratio is about 1 + 0.6 (ε − g).
                implied(m[1] / m[0], 0.0003)
            }
            Self::Fabric(_)
            | Self::SolidFraction
            | Self::StrainElastic
            | Self::StrainContact
            | Self::StressRatio => None,
        }
    }
}

/// G12, G13 and Θ, Pa, that the paper's k, k̂ and ε of Table III imply by its own Eqs. 16–18, 21 and 22.
fn implied_moduli(sample: usize, pressure: usize) -> Option<[f64; 3]> {
    let state = &PAPER[sample].states[pressure];
    let conditions = Conditions {
        gamma: StrainRatio::given(PAPER[sample].gamma_over_delta[pressure]),
        ..Conditions::at(super::tables::PRESSURE[pressure])
    };
    let structure = Microstructure::paper(state.k_ratio, state.k_hat, state.eps_ratio);
    let moduli = model("ratio")?.predict(&structure, &conditions, &Calibration::PAPER).ok()?;
    let [g12, g13, theta, ..] = moduli.values();
    Some([g12?, g13?, theta?])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The moduli of the first and the last row, from an independent evaluation of the same equations.
    #[test]
    fn table_iii_implies_the_moduli_of_its_rows() {
        for (sample, expected) in [(0, [121.71e6, 127.37e6, 144.38e6]), (2, [51.8e6, 59.2e6, 122.1e6])] {
            let found = implied_moduli(sample, 0).unwrap();
            for (found, expected) in found.iter().zip(expected) {
                assert!((found / expected - 1.0).abs() < 1e-3, "{found} {expected}");
            }
        }
    }

    #[test]
    fn the_keys_are_distinct() {
        let mut keys: Vec<_> = Quantity::ALL.iter().map(|(_, key)| key).collect();
        keys.sort_unstable();
        keys.dedup();
        assert_eq!(keys.len(), Quantity::ALL.len());
    }
}
