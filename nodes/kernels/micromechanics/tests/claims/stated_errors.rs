//! The error of the solver that a stiffness states, against a dense factorisation.

use crate::factorised::factorised;
use crate::golden::reference;
use crate::samples::{random, solved, thinned};
use grainlab_core::Packing;
use grainlab_core::results::ElasticStiffness;
use grainlab_micromechanics::Settings;
use grainlab_micromechanics::network::Springs;
use grainlab_testkit::nightly;

fn measured(packing: &Packing, springs: Springs, tolerance: Option<f64>) -> ElasticStiffness {
    solved(packing, &Settings { springs, tolerance, ..Settings::default() })
}

/// Expected: every entry within three of its stated errors, at any tolerance, also near isostaticity; the largest stated error is
/// that which is left.
#[test]
fn every_entry_is_within_its_stated_error_which_is_no_larger_than_what_is_left() {
    let both = Springs::NormalAndTangential;
    let (packings, exponents) = nightly((3, [5, 8, 12].to_vec()), (6, (5..=12).collect()));
    let all = [
        ("dense", random(200, 1.3, 4), both),
        ("nearly isostatic", thinned(&random(100, 1.25, 21), 4.1), both),
        ("smooth", random(300, 1.3, 5), Springs::Normal),
        ("of LAMMPS", reference(), both),
        ("loose", thinned(&random(300, 1.25, 4), 4.6), both),
        ("with a motion of many grains that is almost free", thinned(&random(600, 1.25, 42), 4.5), both),
    ];
    for (name, packing, springs) in all.into_iter().take(packings) {
        let exact = factorised(&packing, springs);
        for exponent in exponents.iter().copied() {
            let found = measured(&packing, springs, Some(10f64.powi(-exponent)));
            let rounding = 1e-14 * found.bounds.affine.0.amax();
            let errors = (found.tensor.0 - exact).abs();
            let excess = errors.zip_map(&found.stddev.0, |error, stddev| (error - rounding) / stddev);
            assert!(excess.max() < 3.0, "{name}, 1e-{exponent}: {:.1} stated errors", excess.max());
            let [stated, left] = [&found.stddev.0, &errors].map(|m| m.diagonal().amax());
            assert!(
                stated < 1.5 * left || left < rounding,
                "{name}, 1e-{exponent}: {stated} stated, {left} left"
            );
        }
    }
}

/// Expected: copies of a packing have its stiffness. From 50,000 grains the solve stops at 1e-5, with an error below 1e-6 of C11,
/// which it states.
#[test]
fn a_large_packing_is_solved_more_coarsely_within_its_stated_error() {
    let one = reference();
    let many = one.repeated(5).unwrap();
    let [one, many] = [one, many].map(|p| measured(&p, Springs::NormalAndTangential, None));
    assert!(one.residual <= 1e-9 && (1e-7..=1e-5).contains(&many.residual), "{}", many.residual);
    let c11 = one.tensor.0[(0, 0)];
    let errors = (many.tensor.0 - one.tensor.0).abs();
    let excess = errors.zip_map(&many.stddev.0, |error, stddev| (error - 1e-13 * c11) / stddev);
    assert!(
        errors.amax() < 1e-6 * c11 && excess.max() < 3.0,
        "{:e}, {:.1}",
        errors.amax() / c11,
        excess.max()
    );
}
