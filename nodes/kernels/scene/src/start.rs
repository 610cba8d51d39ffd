//! A run that starts from a packing: parts of the scene that have to agree with it.

use crate::fault::Fault;
use crate::keys;
use crate::model::{Phase, Start};
use crate::reader::Reader;
use crate::sizes::Sizes;
use grainlab_core::contact::ContactLaw;
use grainlab_core::{Material, Packing};

/// Two numbers are equal if they differ by less than this fraction: a file may have six digits.
const SAME: f64 = 1e-5;

/// Reads `[start]`; `None` if the scene has none.
pub(crate) fn read(r: &mut Reader<'_>) -> Option<Start> {
    r.sub(&keys::START, |r| {
        let packing = r.text(&keys::START_PACKING);
        let step = r.has(&keys::START_STEP).then(|| r.whole(&keys::START_STEP));
        if step.is_none() {
            r.get(&keys::START_STEP);
        }
        Start { packing, step }
    })
}

/// Number and sizes of the grains are those of the packing.
pub(crate) fn grains(r: &mut Reader<'_>, packing: &Packing) -> (u32, Sizes) {
    if r.get(&keys::GRAINS).is_some() {
        r.fault(
            "grains",
            "is there, but the grains are those of the packing that the run starts from; leave it out",
        );
    }
    let mean = 2.0 * packing.radii.iter().sum::<f64>() / packing.grains().max(1) as f64;
    (u32::try_from(packing.grains()).unwrap_or(u32::MAX), Sizes::OfPacking { mean })
}

/// Faults of a material that differs from that of the packing.
pub(crate) fn differing(own: &Material, packing: &Packing) -> Vec<Fault> {
    let of = &packing.material;
    let pairs = [
        (&keys::SHEAR_MODULUS, own.shear_modulus, of.shear_modulus),
        (&keys::POISSON_RATIO, own.poisson_ratio, of.poisson_ratio),
        (&keys::DENSITY, own.density, of.density),
    ];
    let differ = |a: f64, b: f64| (a - b).abs() > SAME * a.abs().max(b.abs());
    let differing = pairs.into_iter().filter(|(_, own, of)| differ(*own, *of));
    let fault = |(key, own, of): (&crate::key::Key, f64, f64)| Fault {
        place: key.path.to_owned(),
        message: format!("is {own}, but the packing that the run starts from has {of}"),
    };
    differing.map(fault).collect()
}

/// Why the contact law cannot be that of the scene, if it cannot.
pub(crate) fn other_law(own: &ContactLaw, packing: &Packing) -> Option<String> {
    let of = &packing.law;
    (own != of).then(|| {
        format!("is {own}, but the forces of the packing that the run starts from are those of {of}")
    })
}

/// Why the first phase cannot start from the packing, if it cannot.
pub(crate) fn refused(first: &Phase, packing: &Packing) -> Option<String> {
    let pulled =
        packing.contacts.iter().any(|c| c.tangential_force.norm() > 0.0 || c.rolling_force.norm() > 0.0);
    (first.friction == 0.0 && pulled).then(|| {
        format!(
            "{} has no friction, and the packing that the run starts from has tangential or rolling forces (friction {}), which it would \
             drop at once; begin with a phase with friction",
            first.name, packing.friction
        )
    })
}
