//! The tangential history inside the engine: what changes it and what must not, and the work of closed cycles.

use grainlab_core::contact::TangentialLaw;
use grainlab_core::{Cell, SymTensor, Vec3};
use grainlab_dem::Engine;
use grainlab_testkit::engine::*;

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
