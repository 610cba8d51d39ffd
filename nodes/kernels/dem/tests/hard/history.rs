//! The tangential history inside the engine: what changes it and what must not, and the work of closed cycles.

use crate::support::*;
use grainlab_core::contact::TangentialLaw;
use grainlab_core::{Cell, SymTensor, Vec3};
use grainlab_dem::Engine;

const OVERLAP: f64 = 4e-8;
const DT: f64 = 1e-9;

/// Two heavy grains that touch along z across the boundary of a large cell, led by the strain alone.
fn led(tangential: TangentialLaw, friction: f64) -> Engine {
    let edge = 8.0 * RADIUS;
    let mut s = setting(friction, DT);
    s.tangential = tangential;
    let x = [Vec3::zeros(), Vec3::z() * (edge - 2.0 * RADIUS + OVERLAP)];
    engine(Cell::cube(edge).unwrap(), HEAVY, &[RADIUS; 2], &x, s)
}

/// Strains by `strain` in `count` steps.
fn strain(e: &mut Engine, strain: &SymTensor, count: usize) {
    let rate = strain.voigt().map(|v| v / (DT * count as f64));
    e.set_rate(&rate).unwrap();
    steps(e, count);
}

/// Strain along the contact that moves the grains together by `depth` (m) without any slip.
fn approach(e: &Engine, depth: f64) -> SymTensor {
    let p = packing(e);
    let branch = p.branch(&p.contacts[0]);
    let n = branch.normalize();
    SymTensor::symmetric_part(&(n * n.transpose() * (-depth / branch.norm())))
}

fn shear(by: f64) -> SymTensor {
    SymTensor { xz: by / (2.0 * RADIUS), ..SymTensor::default() }
}

/// Expected: growing normal overlap leaves the tangential force alone (LAMMPS, PR 2196: a history kept as displacement
/// does not); falling overlap scales it with the stiffness where "rescaled", and leaves it alone where "incremental".
#[test]
fn the_tangential_force_does_not_change_when_only_the_normal_overlap_grows() {
    for tangential in [TangentialLaw::Rescaled, TangentialLaw::Incremental] {
        let mut e = led(tangential, f64::INFINITY);
        strain(&mut e, &shear(3e-9), 200);
        let loaded = packing(&e).contacts[0];
        let closing = approach(&e, 2.0 * OVERLAP);
        strain(&mut e, &closing, 200);
        let deep = packing(&e).contacts[0];
        assert!(deep.overlap > 2.9 * OVERLAP && loaded.tangential_force.norm() > 0.0);
        let change =
            (deep.tangential_force - loaded.tangential_force).norm() / loaded.tangential_force.norm();
        assert!(change < 1e-7, "{tangential:?}: {change}");
        let opening = approach(&e, -2.0 * OVERLAP);
        strain(&mut e, &opening, 200);
        let back = packing(&e).contacts[0];
        let kept = back.tangential_force.norm() / loaded.tangential_force.norm();
        let expected = match tangential {
            TangentialLaw::Rescaled => (back.overlap / deep.overlap).sqrt(),
            TangentialLaw::Incremental => 1.0,
        };
        assert!((kept / expected - 1.0).abs() < 1e-6, "{tangential:?}: {kept} {expected}");
    }
}

/// Work done on the pair, J, over legs of (approach, slip) in m, by −V σ:dE and the trapezium rule; over its elastic
/// energy at the start.
fn work(e: &mut Engine, legs: &[(f64, f64)]) -> f64 {
    let start = energy(&packing(e));
    let mut work = 0.0;
    for (depth, slip) in legs {
        let pieces = 50;
        for _ in 0..pieces {
            let p = packing(e);
            let (before, volume) = (grainlab_core::stress::stress(&p).tensor.matrix(), p.cell.volume());
            let a =
                approach(e, depth / f64::from(pieces)).matrix() + shear(slip / f64::from(pieces)).matrix();
            let step = SymTensor::symmetric_part(&a);
            strain(e, &step, 8);
            let after = e.observables().unwrap().stress.tensor.matrix();
            work -= 0.5 * volume * ((before + after) * step.matrix()).trace();
        }
    }
    work / start
}

/// Expected: no cycle of pressing and shearing, in any order, yields work with the rescaled history; the incremental one
/// yields work on the cycle that shears under high load and shears back under low.
#[test]
fn no_closed_cycle_of_strains_yields_work_with_the_rescaled_history() {
    let pump = [(2.0 * OVERLAP, 0.0), (0.0, 8e-9), (-2.0 * OVERLAP, 0.0), (0.0, -8e-9)];
    let rescaled = work(&mut led(TangentialLaw::Rescaled, f64::INFINITY), &pump);
    let incremental = work(&mut led(TangentialLaw::Incremental, f64::INFINITY), &pump);
    assert!(rescaled > 1e-3, "rescaled {rescaled}");
    assert!(incremental < -1e-3, "incremental {incremental}");
    let mut random = Random(11);
    for friction in [0.1, 0.5, f64::INFINITY] {
        let mut dissipated = 0.0f64;
        for cycle in 0..40 {
            // Three legs there and their opposites, shuffled, normal and tangential apart.
            let mut legs: Vec<(f64, f64)> = Vec::new();
            for _ in 0..3 {
                let (depth, slip) = (random.between(0.0, 0.5) * OVERLAP, random.between(-8e-9, 8e-9));
                legs.extend([(depth, 0.0), (-depth, 0.0), (0.0, slip), (0.0, -slip)]);
            }
            (1..legs.len()).rev().for_each(|k| legs.swap(k, (random.unit() * (k + 1) as f64) as usize));
            let mut e = led(TangentialLaw::Rescaled, friction);
            // Never out of contact, whatever the order: 1.5 overlaps at most are taken off three and a half.
            let closer = approach(&e, 2.5 * OVERLAP);
            strain(&mut e, &closer, 50);
            let gained = work(&mut e, &legs);
            assert!(gained > -1e-5, "friction {friction}, cycle {cycle}: {gained}");
            dissipated = dissipated.max(gained);
        }
        assert!(dissipated > 1e-4, "friction {friction}: cycles dissipate, {dissipated}");
    }
}
