//! Text (TOML) to [`Scene`], with every fault reported at once.

use crate::contact;
use crate::fault::{Fault, SceneError};
use crate::model::{Numerics, Scene};
use crate::phases;
use crate::table::Reader;
use grainlab_core::Material;
use grainlab_core::contact::TangentialLaw;

impl Scene {
    /// Parses a scene; every fault of the text is in the error.
    ///
    /// ```
    /// let faults = grainlab_scene::Scene::parse("name = 'x'\nfriktion = 1").unwrap_err().faults;
    /// assert!(faults.iter().any(|f| f.place == "friktion" && f.message.starts_with("unknown key")));
    /// ```
    pub fn parse(text: &str) -> Result<Scene, SceneError> {
        let table: toml::Table = match text.parse() {
            Ok(table) => table,
            Err(e) => {
                let message = e.to_string().trim_end().to_string();
                return Err(SceneError { faults: vec![Fault { place: "scene".into(), message }] });
            }
        };
        let mut r = Reader::new("", &table);
        let scene = read_scene(&mut r);
        let faults = r.finish();
        if faults.is_empty() { Ok(scene) } else { Err(SceneError { faults }) }
    }
}

fn read_scene(r: &mut Reader<'_>) -> Scene {
    let name = r.text("name", None);
    let plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_' || c == '-';
    if r.has("name") && name.is_empty() || !name.chars().all(plain) {
        r.fault("name", format!("is {name:?}; use lower case letters, digits, _ and - (it names files)"));
    }
    let description = r.text("description", Some(""));
    let seed = r.integer("seed", Some(1), 0, u64::MAX >> 1);
    let (grains, diameter) = r
        .sub("grains", |r| {
            let count = r.integer("count", None, 1, 10_000_000);
            (
                count as u32,
                r.number("diameter", None, "a length in m, more than 0", |v| v > 0.0 && v.is_finite()),
            )
        })
        .unwrap_or_else(|| {
            r.fault("grains", "is missing; it must be a table with count and diameter");
            (1, 1.0)
        });
    let material = r.sub("material", read_material).unwrap_or(Material::GLASS);
    let law = r.sub("contact", contact::read).unwrap_or_default();
    let numerics = r.sub("numerics", read_numerics).unwrap_or_default();
    let phases = phases::read(r, phases::spin_drag(&material, diameter));
    Scene { name, description, seed, grains, diameter, material, law, numerics, phases }
}

fn read_material(r: &mut Reader<'_>) -> Material {
    let glass = Material::GLASS;
    let positive = |v: f64| v > 0.0 && v.is_finite();
    Material {
        shear_modulus: r.number(
            "shear_modulus",
            Some(glass.shear_modulus),
            "a modulus in Pa, more than 0",
            positive,
        ),
        poisson_ratio: r.number("poisson_ratio", Some(glass.poisson_ratio), "from 0 to 0.5", |v| {
            (0.0..=0.5).contains(&v)
        }),
        density: r.number("density", Some(glass.density), "a density in kg/m3, more than 0", positive),
    }
}

fn read_numerics(r: &mut Reader<'_>) -> Numerics {
    let d = Numerics::default();
    let tangential = [("rescaled", TangentialLaw::Rescaled), ("incremental", TangentialLaw::Incremental)];
    Numerics {
        time_step_safety: r.number(
            "time_step_safety",
            Some(d.time_step_safety),
            "more than 0, at most 1",
            |v| v > 0.0 && v <= 1.0,
        ),
        skin: r.number("skin", Some(d.skin), "in grain diameters, more than 0, at most 1", |v| {
            v > 0.0 && v <= 1.0
        }),
        tangential: r.choice("tangential", d.tangential, &tangential),
        energy_balance: r.boolean("energy_balance", d.energy_balance),
    }
}
