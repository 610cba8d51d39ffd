//! Lattices with closed forms, and contacts with own images.

use crate::samples::{packing, solved, with_springs};
use grainlab_core::contact::{ContactLaw, Rough, SpringLaw};
use grainlab_core::{Cell, Mat3, Packing, Stiffness, Vec3};
use grainlab_micromechanics::network::Springs;
use grainlab_micromechanics::{Settings, analyze};
use grainlab_testkit::packings::{FACE_CENTRED, cubic};

const D: f64 = 2.0e-4;
const OVERLAP: f64 = 3.0e-8;

/// Spheres that barely overlap, with the overlap of every spring set to [`OVERLAP`]; branch lengths are D
/// exactly.
fn lattice(cell: Mat3, sites: &[[f64; 3]]) -> Packing {
    let cell = Cell::new(cell).unwrap();
    let positions = sites.iter().map(|s| cell.matrix() * Vec3::from(*s)).collect();
    packing(cell, positions, 0.5 * D * (1.0 + 1e-9), 0.3, Some(OVERLAP))
}

fn simple_cubic() -> Packing {
    lattice(Mat3::identity() * D, &[[0.1, 0.2, 0.3]])
}

fn fcc() -> Packing {
    lattice(Mat3::identity() * (D * 2f64.sqrt()), &FACE_CENTRED)
}

fn springs(p: &Packing) -> (f64, f64) {
    p.contact_stiffness(&p.contacts[0])
}

/// Relative to the largest entry; 1e-10 allows for rounding of the sum over contacts.
fn assert_equal(found: &Stiffness, expected: &Stiffness, what: &str) {
    let (found, expected) = (found.0, expected.0);
    let error = (found - expected).amax() / expected.amax();
    assert!(error < 1e-10, "{what}: {error:e}\n{found}\n{expected}");
}

/// Three contacts per grain along the axes, V = D³: C11 = k_n/D, C12 = 0, C44 = k_t/(2D); nothing relaxes by
/// symmetry.
#[test]
fn simple_cubic_is_exact_with_one_grain_touching_its_own_images() {
    let p = simple_cubic();
    assert_eq!(p.contacts.len(), 3);
    let (k_n, k_t) = springs(&p);
    let a = analyze(&p, &Settings::default()).unwrap();
    assert_eq!(
        (
            a.report.contacts.coordination,
            a.report.contacts.mechanical_coordination,
            a.report.contacts.rattlers
        ),
        (6.0, 6.0, 0)
    );
    let m = a.report.stiffness().copied().unwrap();
    let expected = cubic(k_n / D, 0.0, 0.5 * k_t / D);
    assert_equal(&m.tensor, &expected, "relaxed");
    assert_equal(&m.bounds.affine, &expected, "affine");
}

/// Six contacts per grain along ⟨110⟩, V = D³/√2: C11 = √2 (k_n + k_t)/D, C12 = (k_n − k_t)/(√2 D), C44 =
/// (k_n + k_t)/(√2 D); affine motion is exact.
#[test]
fn fcc_is_exact_with_four_grains() {
    let p = fcc();
    assert_eq!(p.contacts.len(), 24);
    let (k_n, k_t) = springs(&p);
    let root = 2f64.sqrt();
    let expected = cubic(root * (k_n + k_t) / D, (k_n - k_t) / (root * D), (k_n + k_t) / (root * D));
    let m = solved(&p, &Settings::default());
    assert_equal(&m.tensor, &expected, "relaxed");
    assert_equal(&m.bounds.affine, &expected, "affine");
}

#[test]
fn fcc_is_exact_with_one_grain_in_a_skewed_primitive_cell() {
    let h = D / 2f64.sqrt();
    let p = lattice(Mat3::new(0.0, h, h, h, 0.0, h, h, h, 0.0), &[[0.0; 3]]);
    assert_eq!(p.contacts.len(), 6);
    let four = solved(&fcc(), &Settings::default());
    let one = solved(&p, &Settings::default());
    assert_equal(&one.tensor, &four.tensor, "primitive cell");
}

/// The lattice is affine, so that G and p are those of one contact: G ∝ p^n with n = 1 − 1/c, 1 − 1/b and 1/3 in the stages of
/// the law.
#[test]
fn a_rough_crystal_stiffens_with_the_exponents_of_the_stages_of_its_contacts() {
    let rough = Rough { roughness: 1e-9, tangential_factor: 0.7 };
    let state = |overlap: f64| {
        let mut p = fcc();
        p.law = ContactLaw::of(SpringLaw::Rough(rough));
        let force = p.law.normal_force(&p.material, 0.25 * D, overlap);
        p.contacts.iter_mut().for_each(|c| (c.overlap, c.normal_force) = (overlap, force));
        let report = analyze(&p, &Settings::default()).unwrap().report;
        [report.pressure(), report.stiffness().unwrap().tensor.0[(3, 3)]].map(f64::ln)
    };
    for (overlap, expected) in
        [(1e-10, 0.613_869_1), (1e-9, 0.613_869_1), (1e-8, 0.368_291_9), (1e-6, 1.0 / 3.0)]
    {
        let [before, after] = [state(overlap), state(1.01 * overlap)];
        let exponent = (after[1] - before[1]) / (after[0] - before[0]);
        assert!((exponent - expected).abs() < 1e-5, "{overlap}: {exponent}");
    }
}

/// Eight contacts per grain along ⟨111⟩, two grains per cell, V = 4D³/(3√3) each: Σ n_x² = 4/3, Σ n_x⁴ = Σ
/// n_x²n_y² = 4/9.
#[test]
fn bcc_is_exact_with_two_grains() {
    let p = lattice(Mat3::identity() * (2.0 * D / 3f64.sqrt()), &[[0.0; 3], [0.5; 3]]);
    assert_eq!(p.contacts.len(), 8);
    let (k_n, k_t) = springs(&p);
    let f = 3.0 * 3f64.sqrt() / (4.0 * D);
    let expected = cubic(
        f * (4.0 / 9.0 * (k_n - k_t) + 4.0 / 3.0 * k_t),
        f * 4.0 / 9.0 * (k_n - k_t),
        f * (4.0 / 9.0 * (k_n - k_t) + 2.0 / 3.0 * k_t),
    );
    let m = solved(&p, &Settings::default());
    assert_equal(&m.tensor, &expected, "relaxed");
}

#[test]
fn frictionless_simple_cubic_has_no_shear_stiffness_and_no_nan() {
    let p = simple_cubic();
    let m = with_springs(&p, Springs::Normal);
    assert_equal(&m.tensor, &cubic(springs(&p).0 / D, 0.0, 0.0), "frictionless");
}
