//! The inversion of the paper's models against the paper's table.

use crate::{PAPER_MODELS, model, table3};
use grainlab_core::Material;
use grainlab_emt::{Calibration, Eq16Reading, Measured, Medium, models};

/// The accuracy claimed is 1e-6; the moduli are stored to 1 mPa, which adds at most 1e-9.
#[test]
fn every_row_of_table_iii_comes_back_from_its_implied_moduli() {
    let rows = table3::rows();
    assert_eq!(rows.len(), 16);
    for row in rows {
        for (name, o) in [("ratio", row.observation()), ("ratio-as-printed", row.observation_as_printed())] {
            let s = model(name).infer(&o, &Calibration::PAPER).unwrap().structure;
            for (found, printed) in s.values().into_iter().zip(row.structure().values()) {
                let close = found.zip(printed).map_or(found == printed, |(f, p)| (f - p).abs() < 1e-6);
                assert!(close, "{} {name}: {s:?}", row.label);
            }
        }
    }
}

/// Table III's k_EMT is G12 over ψ3 for one contact per grain, Δ = ln(0.636/0.607): S1 agrees within the two
/// printed digits and 2 %. (S3 and S4 do not: the table is inconsistent there.)
#[test]
fn absolute_theory_gives_k_emt_of_sample_s1() {
    for (row, k_emt) in table3::rows().iter().zip([0.31, 0.41, 0.58, 0.75]) {
        let one_contact = Medium {
            material: Material::GLASS,
            solid_fraction: 0.636,
            volume_strain: (0.636f64 / 0.607).ln(),
            k: 1.0,
            eps: row.printed[2],
            gamma_over_delta: row.g,
        };
        let k = row.g12 / one_contact.moduli(Eq16Reading::Corrected).psi3;
        assert!((k - k_emt).abs() < 0.005 + 0.02 * k_emt, "{}: {k}", row.label);
    }
}

/// The plain theory over-predicts shear.
#[test]
fn the_effective_medium_needs_fewer_than_half_of_the_contacts() {
    for row in &table3::rows() {
        let mut o = row.observation();
        o.conditions.solid_fraction = Some(Measured::exact(0.636));
        let s = model("emt").infer(&o, &Calibration::PAPER).unwrap().structure;
        assert!(s.k.unwrap() < 0.5 * row.printed[0], "{}: {s:?}", row.label);
        assert!((s.eps.unwrap() - row.printed[2]).abs() < 1e-6 && s.k_hat.is_none());
    }
}

#[test]
fn models_are_listed_in_a_fixed_order_and_found_by_name() {
    let names: Vec<_> = models().iter().map(|m| m.name()).collect();
    assert_eq!(names[..3], PAPER_MODELS);
    for name in names {
        assert_eq!(grainlab_emt::model(name).unwrap().name(), name);
    }
    assert!(grainlab_emt::model("none such").is_none());
}
