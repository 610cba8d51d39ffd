//! A scene's table to [`Scene`], with every fault reported at once.

use crate::canonical;
use crate::contact;
use crate::fault::SceneError;
use crate::grains;
use crate::keys;
use crate::model::{Numerics, Scene};
use crate::phases::{self, Inherited};
use crate::reader::Reader;
use crate::sizes::Sizes;
use crate::start;
use grainlab_core::contact::{ContactLaw, TangentialLaw};
use grainlab_core::{Material, Packing};
use toml::Table;

/// A valid scene, as a value and as text.
#[derive(Clone, Debug, PartialEq)]
pub struct Resolved {
    /// Scene as a value.
    pub scene: Scene,
    /// Scene as TOML that needs no other file: bases and overrides applied, every default written out.
    /// Resolving this text gives the same text.
    pub toml: String,
}

/// Reads a table without base.
pub(crate) fn read(table: &Table, packing: Option<&Packing>) -> Result<Resolved, SceneError> {
    let mut r = Reader::new("", table);
    let scene = read_scene(&mut r, packing);
    let (entries, faults) = r.finish();
    SceneError::of(faults)?;
    let toml = canonical::write(&entries);
    Ok(Resolved { scene: Scene { fingerprint: fingerprint(&toml), ..scene }, toml })
}

fn read_scene(r: &mut Reader<'_>, packing: Option<&Packing>) -> Scene {
    for key in [&keys::BASE, &keys::REMOVE, &keys::APPEND] {
        if r.get(key).is_some() {
            r.fault(key.name(), "changes a base, and this scene has none");
        }
    }
    // A number was applied to the phases.
    r.optional(&keys::PRESSURE);
    let name = r.text(&keys::NAME, None);
    let plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_' || c == '-';
    if r.has(&keys::NAME) && name.is_empty() || !name.chars().all(plain) {
        let message = format!("is {name:?}; use lower case letters, digits, _ and - (it names files)");
        r.fault("name", message);
    }
    let description = r.text(&keys::DESCRIPTION, None);
    let seed = r.whole(&keys::SEED, None);
    let friction = r.optional(&keys::FRICTION);
    let start = start::read(r);
    if start.is_some() && packing.is_none() {
        r.fault("start", "names a packing, which has not been read");
    }
    let packing = packing.filter(|_| start.is_some());
    let (grains, sizes) = match packing {
        Some(packing) => start::grains(r, packing),
        None if start.is_some() => (1, Sizes::Equal(1.0)),
        None => r.section("grains", grains::read),
    };
    let default = packing.map_or(Material::GLASS, |p| p.material);
    let material = r.section("material", |r| read_material(r, &default));
    if let Some(packing) = packing {
        r.adopt(start::differing(&material, packing));
    }
    let law = packing.map_or_else(ContactLaw::default, |p| p.law);
    let law = r.section("contact", |r| contact::read(r, &law));
    if let Some(message) = packing.and_then(|p| start::other_law(&law, p)) {
        r.fault("contact", message);
    }
    if let Some(message) = packing.and_then(start::other_forces) {
        r.fault("start.packing", message);
    }
    let numerics = r.section("numerics", read_numerics);
    let mut inherited = Inherited {
        sizes: &sizes,
        friction,
        taken: false,
        spin_drag: phases::spin_drag(&material, sizes.mean()),
        solid_fraction: packing.map_or(0.0, Packing::solid_fraction),
    };
    let phases = phases::read(r, &mut inherited, start.is_none());
    if let (Some(packing), Some(first)) = (packing, phases.first()) {
        start::refused(first, packing).into_iter().for_each(|m| r.fault("phase", m));
    }
    if friction.is_some() && !inherited.taken && !phases.is_empty() && r.is_sound() {
        let message =
            "is taken by no phase: each names its own; set phase.NAME.friction, or phase.*.friction";
        r.fault("friction", message);
    }
    // The text is complete once everything is read.
    let fingerprint = 0;
    Scene { name, description, seed, start, grains, sizes, material, law, numerics, phases, fingerprint }
}

/// FNV-1a of a text.
fn fingerprint(text: &str) -> u64 {
    text.bytes()
        .fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3))
}

fn read_material(r: &mut Reader<'_>, default: &Material) -> Material {
    Material {
        shear_modulus: r.number(&keys::SHEAR_MODULUS, Some(default.shear_modulus)),
        poisson_ratio: r.number(&keys::POISSON_RATIO, Some(default.poisson_ratio)),
        density: r.number(&keys::DENSITY, Some(default.density)),
    }
}

fn read_numerics(r: &mut Reader<'_>) -> Numerics {
    let tangential = [("rescaled", TangentialLaw::Rescaled), ("incremental", TangentialLaw::Incremental)];
    Numerics {
        time_step_safety: r.number(&keys::TIME_STEP_SAFETY, None),
        skin: r.number(&keys::SKIN, None),
        tangential: r.choice(&keys::TANGENTIAL, "rescaled", &tangential),
        energy_balance: r.flag(&keys::ENERGY_BALANCE),
    }
}
