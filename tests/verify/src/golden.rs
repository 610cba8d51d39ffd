//! The packings of other codes, from the files in `tests/golden`.

use grainlab_console::{Failure, input};
use grainlab_core::{Material, Packing};
use grainlab_recordings::import::{ImportOptions, load};
use grainlab_verify::lammps_packings::Reference;
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// Largest size of a text, bytes.
const MOST: u64 = 1 << 24;

/// Moduli of the smooth spheres by matscipy.
pub(super) fn matscipy() -> Result<String, Failure> {
    text("packings/smooth_500_matscipy.csv")
}

/// Stress of the packing to compress, by LAMMPS.
pub(super) fn compressed() -> Result<String, Failure> {
    text("lammps/uniaxial_2000.csv")
}

/// 2,000 glass spheres to compress, from LAMMPS.
pub(super) fn to_compress() -> Result<Packing, Failure> {
    packing("packings/packing_2000.data.gz", &ImportOptions::of_grains(&Material::GLASS, 0.1))
}

/// 500 smooth spheres at 100 kPa.
pub(super) fn smooth_spheres() -> Result<Packing, Failure> {
    packing("packings/smooth_500.csv.gz", &ImportOptions::default())
}

/// 500 equal spheres of LAMMPS with their forces, and what LAMMPS says of them.
pub(super) fn equal_spheres() -> Result<(Packing, Reference), Failure> {
    /// The sidecar of the packing, with its own names.
    #[derive(Deserialize)]
    struct Sidecar {
        stress_from_contacts: [[f64; 3]; 3],
        n_contacts: f64,
        #[serde(rename = "Z_all")]
        all: f64,
        #[serde(rename = "Z_no_rattlers")]
        without_rattlers: f64,
        phi: f64,
        mean_normal_force: f64,
        #[serde(rename = "C_relaxed_matrix_Pa_stiffness_matrix_mu_inf")]
        relaxed: Vec<Vec<f64>>,
        #[serde(rename = "lammps_C_Pa_eps_1e-7")]
        probed: Vec<Vec<f64>>,
    }
    let name = "reference/ref_packing_500.json";
    let sidecar: Sidecar = serde_json::from_str(&text(name)?).map_err(|e| failed(name, e))?;
    let reference = Reference {
        stress: sidecar.stress_from_contacts,
        contacts: sidecar.n_contacts,
        coordination: [sidecar.all, sidecar.without_rattlers],
        solid_fraction: sidecar.phi,
        mean_force: sidecar.mean_normal_force,
        stiffness: sidecar.relaxed.concat(),
        probed: sidecar.probed.concat(),
    };
    Ok((packing("reference/ref_packing_500.csv.gz", &ImportOptions::default())?, reference))
}

/// 400 unequal spheres of LAMMPS with the contact forces that it dumped, and its stress, Pa: xx yy zz xy xz yz.
pub(super) fn unequal_spheres() -> Result<(Packing, [f64; 6]), Failure> {
    let contact_forces = Some(text("lammps/forces.dump.gz")?);
    let options = ImportOptions { contact_forces, ..ImportOptions::of_grains(&Material::GLASS, 0.3) };
    let name = "lammps/stress.txt";
    let stress = text(name)?.split_whitespace().filter_map(|w| w.parse().ok()).collect::<Vec<f64>>();
    let stress = stress.try_into().map_err(|_| failed(name, "not six numbers"))?;
    Ok((packing("lammps/grains.dump.gz", &options)?, stress))
}

fn path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../golden").join(name)
}

/// The last packing of a file.
fn packing(name: &str, options: &ImportOptions) -> Result<Packing, Failure> {
    let mut packings = load(&path(name), options).map_err(Failure::failed)?.packings;
    Ok(packings.pop().ok_or_else(|| failed(name, "no packing"))?.packing)
}

/// The text of a file, which may be compressed.
fn text(name: &str) -> Result<String, Failure> {
    let bytes = input::bytes(&path(name), MOST).map_err(|e| failed(name, e))?;
    let bytes =
        if name.ends_with(".gz") { input::gunzip(&bytes).map_err(|e| failed(name, e))? } else { bytes };
    String::from_utf8(bytes).map_err(|e| failed(name, e))
}

fn failed(name: &str, why: impl std::fmt::Display) -> Failure {
    Failure::failed(format!("{}: {why}", path(name).display()))
}
