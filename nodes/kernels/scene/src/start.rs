//! A run that starts from a packing: parts of the scene that have to agree with it.

use crate::canonical::Entry;
use crate::fault::Fault;
use crate::key::Domain;
use crate::keys;
use crate::model::{Phase, Start};
use crate::reader::Reader;
use crate::sizes::Sizes;
use grainlab_core::contact::ContactLaw;
use grainlab_core::{Material, OTHER_LAW, Packing};

/// Two numbers are equal if they differ by less than this fraction: a file may have six digits.
const SAME: f64 = 1e-5;

impl Start {
    /// Returns the number of grains of the run, whose packing has `grains`.
    ///
    /// # Errors
    /// If the copies are none, too many, or make more than [`keys::MOST_GRAINS`].
    pub fn grains_of_copies(&self, grains: usize) -> Result<u64, Fault> {
        let (copies, key) = (u64::from(self.copies), &keys::START_COPIES);
        let fault = |message| Fault { place: key.path.to_owned(), message };
        let Domain::Whole(least, most) = key.domain else { unreachable!("copies are a whole number") };
        if !(least..=most).contains(&copies) {
            return Err(fault(format!("is {copies}; it must be {}", key.requirement())));
        }
        let all = (grains as u64).saturating_mul(copies.pow(3));
        if copies > 1 && all > keys::MOST_GRAINS {
            let fit = (1..copies).rev().find(|n| grains as u64 * n.pow(3) <= keys::MOST_GRAINS).unwrap_or(1);
            return Err(fault(format!(
                "is {copies}, which asks for {all} grains, {copies} cubed times the {grains} of the packing; a run has at most {}, because \
                 a million take 6.5 GB of memory: at most {fit} copies fit",
                keys::MOST_GRAINS
            )));
        }
        Ok(all)
    }
}

/// Reads `[start]`; `None` if the scene has none.
pub(crate) fn read(r: &mut Reader<'_>) -> Option<Start> {
    r.sub(&keys::START, |r| {
        let packing = r.text(&keys::START_PACKING, None);
        let forces = &keys::START_CONTACT_FORCES;
        let contact_forces = r.get(forces).map(|_| r.text(forces, None));
        let contact_columns = columns(r);
        if !contact_columns.is_empty() && contact_forces.is_none() {
            r.fault("contact_columns", "names columns of contact_forces, which is missing");
        }
        let step = r.get(&keys::START_STEP).map(|_| r.whole(&keys::START_STEP, None));
        let copies = r.whole(&keys::START_COPIES, None) as u32;
        Start { packing, contact_forces, contact_columns, step, copies }
    })
}

fn columns(r: &mut Reader<'_>) -> Vec<String> {
    let key = &keys::START_CONTACT_COLUMNS;
    let Some(value) = r.get(key) else { return Vec::new() };
    let names: Option<Vec<String>> =
        value.as_array().and_then(|all| all.iter().map(|name| name.as_str().map(str::to_owned)).collect());
    let Some(names) = names.filter(|names| [5, 8].contains(&names.len())) else {
        r.refuse(key, Some(value));
        return Vec::new();
    };
    r.keep(key, Entry::Value(value.to_string()));
    names
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

/// Why the forces of the packing cannot be those of its contact law, if they cannot. The engine has normal forces from overlaps.
pub(crate) fn other_forces(packing: &Packing) -> Option<String> {
    let difference = packing.law_difference();
    (difference > OTHER_LAW).then(|| {
        format!(
            "normal forces of the packing differ by {:.1} % on average from those of {} with this material, from which the run would \
             begin at another stress: give the law and the material that the forces are of, or bring the packing to rest first",
            100.0 * difference, packing.law
        )
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
