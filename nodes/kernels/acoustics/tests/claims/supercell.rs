//! A packing repeated along a path has the properties of the packing.

use crate::sample;
use grainlab_acoustics::{AcousticsError, Ray, supercell};
use grainlab_core::{Cell, Mat3, Packing, Vec3, stress::stress};

const PLANES: [[i32; 3]; 6] = [[0, 0, 1], [1, 0, 0], [1, 0, 1], [1, -1, 0], [1, 1, 1], [2, -1, 3]];

/// The first packing, in a skewed cell of the same lattice.
fn skewed(packing: Packing) -> Packing {
    let mut packing = packing;
    // Edges a, b + a, c − b: the image k of the old cell is the image M⁻¹ k of the new one.
    let m = Mat3::new(1.0, 1.0, 0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 1.0);
    packing.cell = Cell::new(packing.cell.matrix() * m).unwrap();
    let inverse = m.try_inverse().unwrap();
    for c in &mut packing.contacts {
        let image = inverse * Vec3::from(c.image.map(f64::from));
        c.image = image.map(|k| k.round() as i8).into();
        if c.i == c.j && c.image < [0; 3] {
            (c.image, c.normal) = (c.image.map(|k| -k), -c.normal);
            c.tangential_force = -c.tangential_force;
        }
    }
    packing.contacts.sort_by_key(|c| (c.i, c.j, c.image));
    packing.validated().unwrap()
}

#[test]
fn a_repeated_packing_is_a_packing_with_the_same_contacts() {
    for packing in [sample::isotropic(), skewed(sample::anisotropic())] {
        for indices in PLANES {
            for copies in [1, 2, 5] {
                let r = supercell(&packing, indices, copies).unwrap();
                let many = r.packing.clone().validated().unwrap();
                assert_eq!(many.grains(), copies as usize * packing.grains());
                assert_eq!(many.contacts.len(), copies as usize * packing.contacts.len());
                for c in &many.contacts {
                    let branch = many.branch(c);
                    assert!((branch.normalize() - c.normal).amax() < 1e-9, "{indices:?} {c:?}");
                    let gap = many.radii[c.i as usize] + many.radii[c.j as usize] - branch.norm();
                    assert!((gap - c.overlap).abs() < 1e-9 * many.radii[0], "{indices:?} {c:?}");
                }
                let normal = Ray::normal(&packing.cell, indices).unwrap();
                assert!(r.along.iter().all(|x| (0.0..r.path).contains(x)));
                for (x, along) in many.positions.iter().zip(&r.along) {
                    let turns = (x.dot(&normal) - along) / r.path;
                    assert!((turns - turns.round()).abs() < 1e-12, "{indices:?} {turns}");
                }
            }
        }
    }
}

#[test]
fn a_repeated_packing_has_the_stress_of_the_packing() {
    let packing = sample::anisotropic();
    let expected = stress(&packing).tensor.matrix();
    for indices in PLANES {
        let many = supercell(&packing, indices, 2).unwrap().packing;
        let found = stress(&many).tensor.matrix();
        assert!((found - expected).amax() < 1e-12 * expected.amax(), "{indices:?}");
    }
}

#[test]
fn common_divisors_of_indices_do_not_count() {
    let packing = sample::isotropic();
    let one = supercell(&packing, [1, 0, -1], 3).unwrap();
    assert_eq!(supercell(&packing, [4, 0, -4], 3).unwrap(), one);
}

#[test]
fn no_planes_no_copies_and_too_many_are_refused() {
    let packing = sample::isotropic();
    let planes = supercell(&packing, [0; 3], 2).unwrap_err();
    assert!(matches!(planes, AcousticsError::NoLatticePlane { .. }), "{planes}");
    let dense = supercell(&packing, [i32::MIN, 0, 1], 2).unwrap_err();
    assert!(matches!(dense, AcousticsError::Setting { name: "indices", .. }), "{dense}");
    for copies in [0, 10_001, u32::MAX] {
        let error = supercell(&packing, [0, 0, 1], copies).unwrap_err();
        assert!(matches!(error, AcousticsError::Setting { name: "copies", .. }), "{error}");
    }
}
