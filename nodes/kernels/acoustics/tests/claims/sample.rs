//! Packings for the measurements.

use grainlab_acoustics::{Measurement, Settings, Survey, measure};
use grainlab_core::{Packing, Stiffness};
use grainlab_testkit::golden;
use std::sync::LazyLock;

/// 2,000 grains at 50 kPa with an isotropic contact network.
pub(crate) fn isotropic() -> Packing {
    golden::packing("packings/isotropic_2000")
}

/// 2,000 grains at 50 kPa with more contacts along e3, ε = .046.
pub(crate) fn anisotropic() -> Packing {
    golden::packing("packings/anisotropic_2000")
}

/// The stiffness of the frozen contact network.
pub(crate) fn stiffness(packing: &Packing) -> Stiffness {
    let settings = grainlab_micromechanics::Settings::default();
    grainlab_micromechanics::analyze(packing, &settings).unwrap().report.stiffness().unwrap().tensor
}

/// The speeds of both packings with default settings, and their static stiffness.
pub(crate) fn surveys() -> &'static [(Measurement, Stiffness); 2] {
    static SURVEYS: LazyLock<[(Measurement, Stiffness); 2]> = LazyLock::new(|| {
        [isotropic(), anisotropic()]
            .map(|packing| (measure(&packing, &Settings::default()).unwrap(), stiffness(&packing)))
    });
    &SURVEYS
}

/// The second packing along three rays, by two threads.
pub(crate) fn minimal() -> &'static Measurement {
    static MINIMAL: LazyLock<Measurement> = LazyLock::new(|| minimal_by(2));
    &MINIMAL
}

/// The measurement of [`minimal`] by other threads.
pub(crate) fn minimal_by(threads: usize) -> Measurement {
    let settings = Settings { survey: Survey::Minimal, ..Settings::default() };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    pool.install(|| measure(&anisotropic(), &settings).unwrap())
}

#[test]
fn the_samples_are_read_as_they_were_written() {
    for (packing, contacts) in [(isotropic(), 5134), (anisotropic(), 4977)] {
        assert_eq!((packing.grains(), packing.contacts.len()), (2000, contacts));
        for c in &packing.contacts {
            let branch = packing.branch(c);
            assert!((branch.normalize() - c.normal).amax() < 1e-9, "{c:?} {branch}");
            let gap = packing.radii[c.i as usize] + packing.radii[c.j as usize] - branch.norm();
            assert!((gap - c.overlap).abs() < 1e-9 * packing.radii[0]);
        }
    }
}
