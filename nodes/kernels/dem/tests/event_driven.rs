//! Hard spheres from collision to collision: against exact mechanics, a brute-force simulation and the fluid's known
//! pressure.

use grainlab_core::{Cell, Mat3, Vec3};
use grainlab_dem::gas::GasError;
use grainlab_dem::gas::{self, HardSpheres, mean_free_time};
use grainlab_testkit::nightly;

const DIAMETER: f64 = 2e-4;

/// `grains` equal spheres at random places.
fn placed(grains: usize, solid_fraction: f64, seed: u64) -> HardSpheres {
    let radii = vec![0.5 * DIAMETER; grains];
    let g = gas::random_placement(&radii, solid_fraction, 1.0, seed).unwrap();
    HardSpheres::new(g.cell, radii, g.positions, g.velocities).unwrap()
}

/// `grains` equal spheres compressed from a random placement to `solid_fraction`.
fn fluid(grains: usize, solid_fraction: f64, seed: u64) -> HardSpheres {
    let mut spheres = placed(grains, solid_fraction.min(0.3), seed);
    let rate = -40.0;
    while spheres.solid_fraction() < solid_fraction * (1.0 - 1e-9) {
        let needed = (solid_fraction / spheres.solid_fraction()).ln() / 3.0 / -rate;
        spheres.advance(rate, needed.min(1e-4)).unwrap();
        spheres.apply_thermostat(1.0);
    }
    spheres
}

fn twice_energy(s: &HardSpheres, radii: &[f64]) -> f64 {
    s.velocities().iter().zip(radii).map(|(v, r)| r.powi(3) * v.norm_squared()).sum()
}

fn momentum(s: &HardSpheres, radii: &[f64]) -> Vec3 {
    s.velocities().iter().zip(radii).map(|(v, r)| v * r.powi(3)).sum()
}

/// Largest overlap over the distance of contact among all pairs and images; negative if none touch.
fn deepest(s: &HardSpheres, radii: &[f64]) -> f64 {
    let (cell, n) = (s.cell(), radii.len());
    let mut deepest = f64::NEG_INFINITY;
    for i in 0..n {
        for j in 0..=i {
            let mut f = cell.fractional(&(s.positions()[j] - s.positions()[i]));
            f.apply(|c| *c -= c.round());
            // Around the nearest image; a cell is wider than a contact is long.
            for image in 0..27 {
                let shift = Vec3::from([image / 9 - 1, image / 3 % 3 - 1, image % 3 - 1].map(f64::from));
                if i != j || shift != Vec3::zeros() {
                    let sigma = radii[i] + radii[j];
                    deepest = deepest.max(1.0 - (cell.matrix() * (f + shift)).norm() / sigma);
                }
            }
        }
    }
    deepest
}

/// Mechanics of the gas with nothing clever: all pairs and images, one collision after the other.
fn brute_force(s: &HardSpheres, radii: &[f64], rate: f64, interval: f64) -> (Vec<Vec3>, Vec<Vec3>, u32) {
    let (mut x, mut v) = (s.positions().to_vec(), s.velocities().to_vec());
    let end = (-rate * interval).exp_m1() / -rate;
    let (mut now, mut collisions) = (0.0, 0);
    loop {
        let mut first = (end - now, 0, 0, Vec3::zeros());
        for i in 0..x.len() {
            for j in 0..i {
                let nearest = s.cell().fractional(&(x[i] - x[j])).map(f64::round);
                for image in 0..343 {
                    let k = Vec3::from([image / 49 - 3, image / 7 % 7 - 3, image % 7 - 3].map(f64::from));
                    let (d, w) = (x[j] - x[i] + s.cell().matrix() * (nearest + k), v[j] - v[i]);
                    let (sigma, growth) =
                        ((radii[i] + radii[j]) * (1.0 - rate * now), -(radii[i] + radii[j]) * rate);
                    // |d + w t| = sigma + growth t
                    let a = w.norm_squared() - growth * growth;
                    let b = d.dot(&w) - sigma * growth;
                    let c = d.norm_squared() - sigma * sigma;
                    let t = (-b - (b * b - a * c).sqrt()) / a;
                    if b < 0.0 && t >= -1e-15 * end && t < first.0 {
                        first = (t, i, j, d + w * t);
                    }
                }
            }
        }
        let (t, i, j, d) = first;
        x.iter_mut().zip(&v).for_each(|(x, v)| *x += v * t);
        now += t;
        if i == j {
            let stretch = (rate * interval).exp();
            return (x.iter().map(|x| x * stretch).collect(), v, collisions);
        }
        let n = d.normalize();
        let (mi, mj) = (radii[i].powi(3), radii[j].powi(3));
        let closing = n.dot(&(v[j] - v[i])) + (radii[i] + radii[j]) * rate;
        v[i] += n * (2.0 * closing * mj / (mi + mj));
        v[j] -= n * (2.0 * closing * mi / (mi + mj));
        collisions += 1;
        assert!(collisions < 1000, "the brute-force simulation hangs at {now}");
    }
}

#[test]
fn energy_and_momentum_are_kept_through_a_hundred_thousand_collisions() {
    let mut s = fluid(200, 0.5, 1);
    let radii = [0.5 * DIAMETER; 200];
    let (energy, scale) = (twice_energy(&s, &radii), radii[0].powi(3) * 200.0);
    let mut collisions = 0;
    while collisions < 100_000 {
        collisions += s.advance(0.0, 1e-4).unwrap().1.count;
    }
    let drift = twice_energy(&s, &radii) / energy - 1.0;
    assert!(drift.abs() < 1e-12, "{drift:e}");
    let drift = momentum(&s, &radii).norm() / scale;
    assert!(drift < 1e-13, "{drift:e}");
}

#[test]
fn no_overlap_on_the_way_to_a_dense_gas() {
    let (radii, mut s) = ([0.5 * DIAMETER; 200], placed(200, 0.3, 2));
    while s.solid_fraction() < 0.607 {
        s.advance(-40.0, 5e-5).unwrap();
        s.apply_thermostat(1.0);
        let overlap = deepest(&s, &radii);
        assert!(overlap < 1e-12, "{overlap:e} at {}", s.solid_fraction());
    }
    assert!(s.speed() > 0.99 && s.speed() <= 1.0 + 1e-12, "still agitated: {}", s.speed());
}

#[test]
fn pressure_and_collision_rate_are_those_of_the_hard_sphere_fluid() {
    for phi in [0.3, 0.45] {
        let mut s = fluid(1000, phi, 3);
        assert!((s.solid_fraction() / phi - 1.0).abs() < 1e-6);
        let free = mean_free_time(phi, DIAMETER, s.speed());
        s.advance(0.0, 50.0 * free).unwrap();
        let (_, seen) = s.advance(0.0, 200.0 * free).unwrap();
        // Carnahan & Starling.
        let expected = (1.0 + phi + phi.powi(2) - phi.powi(3)) / (1.0 - phi).powi(3);
        assert!((seen.compressibility / expected - 1.0).abs() < 0.02, "{} {expected}", seen.compressibility);
        let each = 2.0 * seen.count as f64 / 1000.0;
        assert!((each / 200.0 - 1.0).abs() < 0.02, "{each} collisions a grain");
    }
}

#[test]
fn small_cells_and_unequal_grains_follow_brute_force() {
    // Cells of 1.3 to 3 of the largest diameter: grains meet several images of each other.
    // The time of each leaves most digits to the chaos of collisions.
    let cases = [
        (vec![1.0; 2], 2.6, 3.0),
        (vec![1.0; 2], 4.001, 20.0),
        (vec![1.0; 8], 5.0, 1.5),
        (vec![1.0, 0.2, 0.3, 0.2], 3.0, 4.0),
    ];
    for (radii, edge, interval) in cases {
        let n = radii.len();
        // A body-centred pair of lattices leaves room at every size used here.
        let positions: Vec<Vec3> = (0..n)
            .map(|i| {
                let place = if n > 4 {
                    Vec3::new((i & 1) as f64, (i >> 1 & 1) as f64, (i >> 2) as f64) * 0.5
                } else {
                    [Vec3::zeros(), Vec3::repeat(0.5), Vec3::new(0.5, 0.0, 0.0), Vec3::new(0.0, 0.5, 0.0)][i]
                };
                place * edge + Vec3::new(0.01, 0.02, 0.03) * i as f64
            })
            .collect();
        let velocities: Vec<Vec3> = (0..n)
            .map(|i| {
                Vec3::new((2.1 * i as f64).sin(), (1.3 + 4.0 * i as f64).cos(), (0.7 + 1.9 * i as f64).sin())
            })
            .collect();
        let cell = Cell::cube(edge).unwrap();
        let start = HardSpheres::new(cell, radii.clone(), positions, velocities).unwrap();
        for rate in [-0.01, 0.01] {
            let mut s = start.clone();
            let (x, v, collisions) = brute_force(&s, &radii, rate, interval);
            let seen = s.advance(rate, interval).unwrap().1;
            assert!((3..40).contains(&collisions), "{collisions} collisions of {n} in {edge}");
            assert_eq!(seen.count, u64::from(collisions), "{n} in {edge}");
            for i in 0..n {
                assert!((s.positions()[i] - x[i]).norm() < 1e-7, "{:?} {:?}", s.positions()[i], x[i]);
                assert!((s.velocities()[i] - v[i]).norm() < 1e-7, "{:?} {:?}", s.velocities()[i], v[i]);
            }
        }
    }
}

#[test]
fn sizes_one_to_five_share_the_energy_equally() {
    // 20 grains five times as large as the other 480.
    let large = gas::random_placement(&[2.5; 20], 0.1, 1.0, 5).unwrap();
    let mut positions = large.positions.clone();
    let edge = large.cell.width(0);
    let mut lattice =
        (0..8000).map(|i| Vec3::from([i / 400, i / 20 % 20, i % 20].map(f64::from)) * (edge / 20.0));
    while positions.len() < 500 {
        let x = lattice.next().unwrap();
        let free =
            positions[..20].iter().all(|p| (p - x).map(|d| d - edge * (d / edge).round()).norm() > 3.1);
        positions.extend(free.then_some(x));
    }
    let radii: Vec<f64> = (0..500).map(|i| if i < 20 { 2.5 } else { 0.5 }).collect();
    let mut velocities = gas::random_placement(&[0.5; 500], 0.1, 1.0, 6).unwrap().velocities;
    // At rest as a whole: the motion of the centre of mass takes no part in equipartition.
    let mass: f64 = radii.iter().map(|r| r.powi(3)).sum();
    let drift = velocities.iter().zip(&radii).map(|(v, r)| v * r.powi(3)).sum::<Vec3>() / mass;
    velocities.iter_mut().for_each(|v| *v -= drift);
    let mut s = HardSpheres::new(large.cell, radii.clone(), positions, velocities).unwrap();
    let energy = twice_energy(&s, &radii);
    let (mut of_large, mut collisions) = (0.0, 0);
    let samples = nightly(100, 400);
    for sample in 0..samples {
        collisions += s.advance(0.0, 5.0).unwrap().1.count;
        let large: f64 = (0..20).map(|i| radii[i].powi(3) * s.velocities()[i].norm_squared()).sum();
        of_large += if sample < samples / 2 { 0.0 } else { large / energy / f64::from(samples / 2) };
    }
    assert!(collisions > nightly(12_500, 50_000), "{collisions}");
    assert!((twice_energy(&s, &radii) / energy - 1.0).abs() < 1e-12);
    assert!(deepest(&s, &radii) < 1e-12);
    // Equipartition: 20 of 500 grains hold 4 % of the energy (they began with 84 %); a mean of 200 samples of 60
    // degrees of freedom, not all independent, or of 50.
    assert!((of_large - 0.04).abs() < nightly(0.012, 0.006), "{of_large}");
}

#[test]
fn a_state_taken_up_anew_after_any_interval_goes_on_bit_for_bit() {
    let radii = vec![0.5 * DIAMETER; 100];
    let mut straight = fluid(100, 0.55, 7);
    let mut twin = straight.clone();
    for _ in 0..20 {
        straight.advance(-30.0, 2e-5).unwrap();
        // Nothing but what a packing holds goes over.
        twin = HardSpheres::new(
            *twin.cell(),
            radii.clone(),
            twin.positions().to_vec(),
            twin.velocities().to_vec(),
        )
        .unwrap();
        twin.advance(-30.0, 2e-5).unwrap();
        assert_eq!(straight, twin);
    }
}

#[test]
fn an_interval_that_is_stopped_at_any_event_changes_nothing() {
    let begin = fluid(600, 0.55, 7);
    let mut whole = begin.clone();
    let looks = std::cell::Cell::new(0u32);
    let count = || {
        looks.set(looks.get() + 1);
        false
    };
    whole.advance_unless(-30.0, 2e-5, &count).unwrap();
    assert!(looks.get() > 8, "{looks:?}");
    for limit in 0..looks.get() {
        let (mut stopped, seen) = (begin.clone(), std::cell::Cell::new(0));
        let over = || seen.replace(seen.get() + 1) >= limit;
        assert_eq!(stopped.advance_unless(-30.0, 2e-5, &over), Err(GasError::Stopped));
        assert_eq!(stopped, begin);
        stopped.advance(-30.0, 2e-5).unwrap();
        assert_eq!(stopped, whole);
    }
}

#[test]
fn a_gas_that_can_get_no_denser_is_refused_and_left_as_it_was() {
    let mut s = fluid(64, 0.6, 9);
    let error = loop {
        let before = s.clone();
        if let Err(error) = s.advance(-200.0, 2e-6) {
            assert_eq!(s, before);
            break error;
        }
        s.apply_thermostat(1.0);
        assert!(s.solid_fraction() < 0.7405, "denser than any packing of spheres");
    };
    let GasError::Jammed { solid_fraction, .. } = error else { panic!("{error}") };
    assert!((0.6..0.7405).contains(&solid_fraction), "{error}");
    // One grain, whose images come nearer until they touch at φ = π/6.
    let mut s = placed(1, 0.3, 1);
    let error = loop {
        if let Err(error) = s.advance(-40.0, 1e-4) {
            break error;
        }
    };
    let GasError::Jammed { solid_fraction, .. } = error else { panic!("{error}") };
    assert!((solid_fraction - std::f64::consts::PI / 6.0).abs() < 0.01, "{error}");
}

#[test]
fn what_is_no_gas_of_hard_spheres_is_refused_with_its_reason() {
    let cell = Cell::cube(10.0).unwrap();
    let two = |gap: f64| vec![Vec3::new(9.8, 5.0, 5.0), Vec3::new(gap - 0.2, 5.0, 5.0)];
    let new =
        |cell, radii: &[f64], x: Vec<Vec3>| HardSpheres::new(cell, radii.to_vec(), x, vec![Vec3::x(); 2]);
    let says = |r: Result<HardSpheres, GasError>, what: &str| {
        let error = r.and_then(|mut s| s.advance(-0.1, 0.1)).unwrap_err().to_string();
        assert!(error.contains(what), "{error}");
    };
    assert!(new(cell, &[0.5; 2], two(1.0)).unwrap().advance(-0.1, 0.1).is_ok(), "touching is allowed");
    says(new(cell, &[0.5; 2], two(0.9)), "grains 0 and 1 overlap by 1");
    says(new(cell, &[0.5, -1.0], two(2.0)), "radius of grain 1 is -1");
    says(new(cell, &[0.5; 3], two(2.0)), "3 radii come with 2 positions");
    says(new(cell, &[0.5; 2], vec![Vec3::zeros(), Vec3::repeat(f64::NAN)]), "grain 1 is not finite");
    let sheared = Mat3::identity() * 10.0 + Mat3::new(0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
    says(new(Cell::new(sheared).unwrap(), &[0.5; 2], two(2.0)), "along the axes");
    let mut s = new(cell, &[0.5; 2], two(2.0)).unwrap();
    for (rate, interval) in [(0.0, 0.0), (-1.0, f64::NAN), (f64::NAN, 1.0), (-1.0, 1e9)] {
        assert!(s.advance(rate, interval).unwrap_err().to_string().contains("leads nowhere"));
    }
}
