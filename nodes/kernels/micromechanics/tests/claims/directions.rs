//! Contacts by orientation, A(d) and g fitted, fourth-order fabric, and the axis with its noise.

use crate::golden::reference;
use crate::samples::{Pair, drawn, eq6, packing, pairs, random, spread, turned};
use grainlab_core::results::{ContactStatistics, Fabric, StressDecomposition};
use grainlab_core::{Cell, Mat3, Packing, SymTensor, Vec3};
use grainlab_micromechanics::PackingView;
use grainlab_micromechanics::structure::{contact_statistics, fabric, orientation_fit, stress_decomposition};
use grainlab_testkit::Random;
use nalgebra::Rotation3;

fn along_z(p: &Packing) -> Fabric {
    fabric(&PackingView::new(p).unwrap(), &Vec3::z())
}

fn of_directions(directions: &[Vec3], seed: u64) -> Packing {
    pairs(&directions.iter().map(|n| Pair::along(*n)).collect::<Vec<_>>(), seed)
}

/// Mean and standard deviation.
fn moments(values: &[f64]) -> (f64, f64) {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let square = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (values.len() - 1) as f64;
    (mean, square.sqrt())
}

/// 400 sets of 1,000 contacts each: errors over standard errors are normal, and χ² accepts A(d).
#[test]
fn contacts_drawn_from_eq_6_give_back_eps_with_an_honest_standard_error() {
    for eps in [-0.3, 0.0, 0.1, 0.6] {
        let mut dice = Random::new(51);
        let (mut pulls, mut chi2) = (Vec::new(), Vec::new());
        for _ in 0..400 {
            let directions = drawn(&mut dice, 1000, eq6(eps));
            let fit = orientation_fit(directions.iter().map(|n| n.z)).unwrap();
            pulls.push((fit.eps - eps) / fit.eps_stddev);
            chi2.push(fit.chi2_per_dof);
        }
        let (mean, spread) = moments(&pulls);
        // Standard errors of mean and spread over 400: .05 and .035; of the fraction within one: .023.
        assert!(mean.abs() < 0.2 && (spread - 1.0).abs() < 0.12, "{eps}: {mean} {spread}");
        let within = pulls.iter().filter(|p| p.abs() < 1.0).count() as f64 / 400.0;
        assert!((within - 0.683).abs() < 0.08, "{eps}: {within}");
        assert!(pulls.iter().filter(|p| p.abs() > 3.0).count() <= 5, "{eps}");
        // An unbinned fit leaves slightly more than 8 of the 9 degrees of freedom; σ of the mean is .025.
        let (chi2, _) = moments(&chi2);
        assert!((0.9..1.2).contains(&chi2), "{eps}: {chi2}");
    }
}

/// χ² detects contacts that do not follow Eq. 6: a density 1 + P4.
#[test]
fn chi_squared_detects_a_distribution_that_eq_6_does_not_describe() {
    let fourth = |x: f64| x + 0.125 * (7.0 * x.powi(5) - 10.0 * x.powi(3) + 3.0 * x);
    let directions = drawn(&mut Random::new(52), 2000, fourth);
    let fit = orientation_fit(directions.iter().map(|n| n.z)).unwrap();
    assert!(fit.chi2_per_dof > 5.0 && fit.eps.abs() < 4.0 * fit.eps_stddev, "{fit:?}");
}

#[test]
fn eps_is_kept_where_no_density_is_negative_and_not_fitted_without_information() {
    let chain = orientation_fit([1.0, 1.0, -1.0].into_iter()).unwrap();
    let disc = orientation_fit([0.0, 0.0].into_iter()).unwrap();
    assert_eq!((chain.eps, disc.eps), (1.0, -0.5));
    assert_eq!(orientation_fit([].into_iter()), None);
    assert_eq!(orientation_fit([(1.0f64 / 3.0).sqrt()].into_iter()), None);
    let one = orientation_fit([0.5].into_iter()).unwrap();
    assert!(one.eps == -0.5 && one.eps_stddev > 0.5 && one.chi2_per_dof.is_finite());
}

#[test]
fn bins_are_of_equal_solid_angle_and_hold_the_overlaps_of_their_contacts() {
    let g = 0.05;
    let contacts: Vec<Pair> = spread(10_000, eq6(0.0))
        .into_iter()
        .map(|n| Pair { overlap: (1e-4 * (1.0 + g - 3.0 * g * n.z * n.z)).powi(2), ..Pair::along(n) })
        .collect();
    let o = along_z(&pairs(&contacts, 1)).orientation;
    assert!(o.contacts.iter().all(|c| c.abs_diff(1000) <= 1), "{:?}", o.contacts);
    for b in 0..10 {
        // Mean of x² over the bin.
        let (low, high) = (b as f64 / 10.0, (b + 1) as f64 / 10.0);
        let square = (high.powi(3) - low.powi(3)) / 0.3;
        let expected = 1e-4 * (1.0 + g - 3.0 * g * square);
        assert!((o.sqrt_overlap[b] / expected - 1.0).abs() < 1e-4, "{b}");
        assert!((o.overlap[b] / (expected * expected) - 1.0).abs() < 1e-3, "{b}");
    }
    let fit = o.overlap_fit.unwrap();
    assert!((fit.g - g).abs() < 1e-13 && fit.g_stddev.unwrap() < 1e-9);
}

#[test]
fn scattered_overlaps_give_back_g_with_an_honest_standard_error() {
    for g in [-0.1, 0.03] {
        let mut dice = Random::new(53);
        let pulls: Vec<f64> = (0..300)
            .map(|_| {
                let contacts: Vec<Pair> = drawn(&mut dice, 500, eq6(0.1))
                    .into_iter()
                    .map(|n| {
                        let root = 1e-4 * (1.0 + g - 3.0 * g * n.z * n.z + 0.2 * dice.normal());
                        Pair { overlap: root.max(1e-6).powi(2), ..Pair::along(n) }
                    })
                    .collect();
                let fit = along_z(&pairs(&contacts, 1)).orientation.overlap_fit.unwrap();
                (fit.g - g) / fit.g_stddev.unwrap()
            })
            .collect();
        let (mean, spread) = moments(&pulls);
        // Standard errors over 300: .058 and .041.
        assert!(mean.abs() < 0.23 && (spread - 1.0).abs() < 0.15, "{g}: {mean} {spread}");
    }
}

#[test]
fn fourth_order_fabrics_of_lattices_are_exact_and_contract_to_the_second() {
    let simple = [Vec3::x(), Vec3::y(), Vec3::z()];
    let found = along_z(&of_directions(&simple, 1)).fourth_order;
    let mut expected = [0.0; 15];
    [0, 10, 14].into_iter().for_each(|k| expected[k] = 1.0 / 3.0);
    assert!(found.components.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-15));
    // H: 2/15 for xxxx, −1/15 for xxyy; |H|² = 3 (2/15)² + 18 (1/15)² = 2/15.
    assert!((found.magnitude - 9.0 * (35.0f64 / 8.0 * 2.0 / 15.0).sqrt()).abs() < 1e-13);
    let face = [(1, 1, 0), (1, -1, 0), (1, 0, 1), (1, 0, -1), (0, 1, 1), (0, 1, -1)];
    let face = face.map(|(x, y, z)| Vec3::new(f64::from(x), f64::from(y), f64::from(z)).normalize());
    let found = along_z(&of_directions(&face, 1)).fourth_order;
    // H: −1/30 for xxxx, 1/60 for xxyy; |H|² = 1/120.
    assert!((found.magnitude - 9.0 * (35.0f64 / 960.0).sqrt()).abs() < 1e-13);
    let one = along_z(&of_directions(&[Vec3::new(0.36, 0.48, 0.8)], 1)).fourth_order;
    assert!((one.magnitude - 9.0).abs() < 1e-12);
    let f = along_z(&random(60, 1.15, 54));
    let (c, l) = (f.fourth_order.components, f.contact_fabric);
    let second = [
        (c[0] + c[3] + c[5], l.xx),
        (c[3] + c[10] + c[12], l.yy),
        (c[5] + c[12] + c[14], l.zz),
        (c[4] + c[11] + c[13], l.yz),
        (c[2] + c[7] + c[9], l.xz),
        (c[1] + c[6] + c[8], l.xy),
    ];
    assert!(second.iter().all(|(a, b)| (a - b).abs() < 1e-15), "{second:?}");
}

/// 1 + a2 P2 + a4 P4 about any axis: the magnitude is |a4|, independent of a2.
#[test]
fn magnitude_of_the_fourth_order_is_that_of_its_p4_about_any_axis() {
    let a4 = -0.4;
    let cumulative = |x: f64| eq6(0.2)(x) + a4 / 8.0 * (7.0 * x.powi(5) - 10.0 * x.powi(3) + 3.0 * x);
    let directions = spread(40_000, cumulative);
    for r in [Rotation3::identity(), Rotation3::from_euler_angles(0.7, -0.4, 2.0)] {
        let turned: Vec<Vec3> = directions.iter().map(|n| r * n).collect();
        let found = along_z(&of_directions(&turned, 1)).fourth_order;
        assert!((found.magnitude - 0.4).abs() < 1e-3, "{}", found.magnitude);
    }
}

/// Independent contacts have the scatter of independent contacts, and an axis is rarely found where there is
/// none.
#[test]
fn the_noise_of_independent_contacts_is_found_and_no_axis_in_it() {
    let mut dice = Random::new(55);
    let (mut noise, mut pulls, mut alarms) = (Vec::new(), Vec::new(), 0);
    for seed in 0..200 {
        let f = along_z(&of_directions(&drawn(&mut dice, 800, eq6(0.0)), seed));
        let a = f.principal_axis;
        noise.push(a.contact_anisotropy_stddev.unwrap() * 800f64.sqrt());
        pulls.push(f.contact_anisotropy / a.contact_anisotropy_stddev.unwrap());
        alarms += u32::from(a.determined);
    }
    // sd(ε)·√contacts = (15/4) √(4/45) = 1.118; each estimate has an error of 12 %.
    let (mean, spread) = moments(&noise);
    assert!((mean - 1.118).abs() < 0.04 && spread < 0.2, "{mean} {spread}");
    assert!((moments(&pulls).1 - 1.0).abs() < 0.2, "{:?}", moments(&pulls));
    // 1 % of 200 are expected.
    assert!(alarms <= 7, "{alarms}");
}

/// Prolate and oblate, about a random axis: found, within the stated angle.
#[test]
fn an_axis_is_found_where_there_is_one_and_its_angle_is_honest() {
    for eps in [0.4, -0.4] {
        let mut dice = Random::new(56);
        let (mut square, mut claimed) = (0.0, 0.0);
        for seed in 0..100 {
            let r = Rotation3::new(Vec3::from_fn(|_, _| 3.0 * dice.normal()));
            let directions: Vec<Vec3> = drawn(&mut dice, 800, eq6(eps)).iter().map(|n| r * n).collect();
            let f = along_z(&of_directions(&directions, seed));
            let a = f.principal_axis;
            assert!(a.determined, "{eps}: {a:?}");
            assert!(
                (a.contact_anisotropy - eps).abs() < 4.0 * a.contact_anisotropy_stddev.unwrap(),
                "{eps}: {a:?}"
            );
            square += f.principal_axis.direction.cross(&(r * Vec3::z())).norm().asin().powi(2) / 100.0;
            claimed += a.angle_stddev.unwrap().powi(2) / 100.0;
        }
        let ratio = (square / claimed).sqrt();
        assert!((0.8..1.25).contains(&ratio), "{eps}: {ratio}");
    }
}

/// Three different eigenvalues with the middle one at the mean: two axes are equally distinct.
#[test]
fn of_two_axes_that_stand_out_alike_neither_is_chosen() {
    let mut dice = Random::new(57);
    let mut directions = Vec::new();
    while directions.len() < 2000 {
        let n = drawn(&mut dice, 1, eq6(0.0))[0];
        // Density 1 + 0.6 (z² − x²).
        if 1.6 * dice.unit() < 1.0 + 0.6 * (n.z * n.z - n.x * n.x) {
            directions.push(n);
        }
    }
    let f = along_z(&of_directions(&directions, 1));
    let l = f.contact_fabric;
    assert!(l.zz - l.xx > 0.1 && (l.yy - 1.0 / 3.0).abs() < 0.02);
    assert!(!f.principal_axis.determined, "{:?}", f.principal_axis);
}

#[test]
fn lattices_and_handfuls_of_contacts_have_no_axis_to_trust() {
    // 8 copies of a simple cubic cell: 24 contacts; 27: 81.
    for (n, known) in [(2, false), (3, true)] {
        let cell = Cell::new(Mat3::identity() * (f64::from(n) * 2e-4)).unwrap();
        let sites =
            (0..n * n * n).map(|k| Vec3::new(f64::from(k % n), f64::from(k / n % n), f64::from(k / n / n)));
        let p = packing(cell, sites.map(|s| s * 2e-4).collect(), 1e-4 * (1.0 + 1e-4), 0.3, None);
        assert_eq!(p.contacts.len(), 3 * p.grains());
        let a = along_z(&p).principal_axis;
        assert!(
            !a.determined
                && a.contact_anisotropy.abs() < 1e-12
                && a.contact_anisotropy_stddev.is_some() == known,
            "{a:?}"
        );
    }
}

/// Every quantity about an axis depends on the packing and that axis, not on the frame.
#[test]
fn turning_packing_and_axis_changes_no_number() {
    let mut p = random(120, 1.15, 58);
    let mut dice = Random::new(58);
    for c in &mut p.contacts {
        let any = Vec3::from_fn(|_, _| dice.unit() - 0.5);
        c.tangential_force = c.normal.cross(&any) * 0.3 * c.normal_force;
    }
    let r = Rotation3::from_euler_angles(0.5, 0.8, -0.3);
    let measured = |p: &Packing, h: Vec3| {
        let view = PackingView::new(p).unwrap();
        let fabric = fabric(&view, &h);
        (contact_statistics(&view), stress_decomposition(&view, &fabric), fabric)
    };
    let (one, other) = (measured(&p, Vec3::z()), measured(&turned(&p, r.matrix()), r * Vec3::z()));
    let numbers = |(c, d, f): &(ContactStatistics, StressDecomposition, Fabric)| {
        let (fit, h, axis) = (f.orientation.contact_fit.unwrap(), f.reference_axis, f.principal_axis);
        let (sff, forces) = (d.stress_force_fabric.unwrap(), c.forces.unwrap());
        let overlaps = f.orientation.overlap_fit.unwrap();
        let pressure = d.sum().mean();
        let mut numbers = vec![f.contact_anisotropy, axis.contact_anisotropy];
        numbers.extend([axis.contact_anisotropy_stddev.unwrap(), axis.angle_stddev.unwrap_or(0.0)]);
        numbers.extend([fit.eps, fit.eps_stddev, fit.chi2_per_dof, f.fourth_order.magnitude]);
        numbers.extend([overlaps.g, overlaps.g_stddev.unwrap()]);
        numbers.extend([d.strong.contact_anisotropy, d.weak.contact_anisotropy]);
        numbers.extend([c.friction.unwrap().mean, forces.participation_ratio()]);
        let tensors =
            [sff.contacts, sff.normal_forces, sff.branches, sff.tangential_forces, sff.stress_ratio()];
        let stresses = [d.normal, d.tangential, d.strong.stress, d.weak.stress];
        let scaled = |t: &SymTensor| SymTensor::from_voigt(t.voigt().map(|v| v / pressure));
        let scaled = stresses.iter().map(scaled);
        for t in tensors.into_iter().chain(scaled).chain([f.tangential_force_fabric]) {
            numbers.extend([t.along(&h), t.deviatoric_invariant()]);
        }
        numbers
    };
    for (k, (x, y)) in numbers(&one).into_iter().zip(numbers(&other)).enumerate() {
        assert!((x - y).abs() < 1e-11, "{k}: {x} {y}");
    }
    let ((a, _, f), (b, _, g)) = (one, other);
    assert_eq!(f.orientation.contacts, g.orientation.contacts);
    assert_eq!(a.forces.unwrap().histogram, b.forces.unwrap().histogram);
    assert_eq!(a.friction.unwrap().histogram, b.friction.unwrap().histogram);
    assert_eq!(f.principal_axis.determined, g.principal_axis.determined);
}

#[test]
fn the_reference_packing_is_isotropic_within_its_noise() {
    let f = along_z(&reference());
    let a = f.principal_axis;
    // 1,277 contacts: .031 if they were independent; packings of 500 grains scatter by .02.
    let stddev = a.contact_anisotropy_stddev.unwrap();
    assert!(
        (0.010..0.025).contains(&stddev) && f.contact_anisotropy.abs() < 3.0 * stddev,
        "{} {a:?}",
        f.contact_anisotropy
    );
    let fit = f.orientation.contact_fit.unwrap();
    assert!(
        (fit.eps_stddev - 0.0313).abs() < 0.002 && (fit.eps - f.contact_anisotropy).abs() < 0.01,
        "{fit:?} {}",
        f.contact_anisotropy
    );
}
