//! A packing of 500 grains from LAMMPS, with its probed stiffness; the sidecar also holds a sparse direct
//! solve.

use crate::golden::{matrix, reference, sidecar};
use grainlab_micromechanics::{Analysis, Settings, analyze};

fn analysis() -> Analysis {
    analyze(&reference(), &Settings::default()).unwrap()
}

#[test]
fn coordination_rattlers_and_fabric_are_those_of_the_reference() {
    let (a, json) = (analysis(), sidecar());
    let (c, f) = (&a.report.contacts, &a.report.fabric);
    assert_eq!((c.grains, c.contacts, c.rattlers), (500, 1277, 24));
    assert_eq!(c.coordination, 5.108);
    assert_eq!(c.mechanical_coordination, 5.361344537815126);
    assert!((a.report.solid_fraction / json["phi"].as_f64().unwrap() - 1.0).abs() < 1e-14);
    for i in 0..3 {
        for j in 0..3 {
            // Normals are unit to 1e-16 and averaged over 1277 contacts.
            let expected = json["fabric_tensor"][i][j].as_f64().unwrap();
            assert!((f.contact_fabric.matrix()[(i, j)] - expected).abs() < 1e-14);
            let expected = json["stress_from_contacts"][i][j].as_f64().unwrap();
            // The shears of the sidecar are asymmetric by 1e-3 Pa because torques do not balance exactly.
            assert!((a.report.stress.tensor.matrix()[(i, j)] - expected).abs() < 1e-8 * a.report.pressure());
        }
    }
    assert!((c.sliding_fraction - json["mobilised_fraction_gt_0p999"].as_f64().unwrap()).abs() < 1e-14);
    // The sidecar averages net forces over all 500 grains, ours over the 476 non-rattlers; those of the
    // rattlers are tiny.
    let unbalanced = json["unbalanced_mean"].as_f64().unwrap() * 500.0 / 476.0;
    assert!((a.report.unbalanced_force_ratio.unwrap() / unbalanced - 1.0).abs() < 1e-2);
}

/// The direct solve adds 1e-11 of the mean stiffness to its diagonal and refines five times; 1e-9 is far
/// above the error of either.
#[test]
fn stiffness_is_that_of_a_sparse_direct_solve() {
    let m = analysis().report.stiffness().copied().unwrap();
    let json = sidecar();
    let affine = matrix(&json["C_affine_matrix_Pa"]);
    let error = (m.bounds.affine.0 - affine).amax() / affine[(0, 0)];
    assert!(error < 1e-12, "affine: {error:e}");
    let relaxed = matrix(&json["C_relaxed_matrix_Pa_stiffness_matrix_mu_inf"]);
    let error = (m.tensor.0 - relaxed).amax() / relaxed[(0, 0)];
    assert!(error < 1e-9, "relaxed: {error:e}");
}
