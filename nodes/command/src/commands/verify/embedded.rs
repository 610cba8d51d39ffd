//! The packings of other codes that are part of this program.

use flate2::read::GzDecoder;
use grainlab_console::Failure;
use grainlab_core::{Material, Packing};
use grainlab_recordings::import::{ImportError, ImportOptions, csv, lammps_dump};
use grainlab_verification::lammps_packings::Reference;
use serde::Deserialize;
use std::io::Read as _;

macro_rules! golden {
    ($file:literal) => {
        concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/golden/", $file)
    };
}

/// Moduli of the smooth spheres by matscipy.
pub(super) const MATSCIPY: &str = include_str!(golden!("packings/smooth_500_matscipy.csv"));

/// Stress of the packing to compress, by LAMMPS.
pub(super) const UNIAXIAL: &str = include_str!(golden!("lammps/uniaxial_2000.csv"));

/// 500 smooth spheres at 100 kPa.
pub(super) fn smooth_spheres() -> Result<Packing, Failure> {
    let text = unpacked(include_bytes!(golden!("packings/smooth_500.csv.gz")))?;
    let sidecar = include_str!(golden!("packings/smooth_500.json"));
    Ok(read(csv::packing(&text, Some(sidecar), &ImportOptions::default()))?.packing)
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
    let text = unpacked(include_bytes!(golden!("reference/ref_packing_500.csv.gz")))?;
    let json = include_str!(golden!("reference/ref_packing_500.json"));
    let packing = read(csv::packing(&text, Some(json), &ImportOptions::default()))?.packing;
    let sidecar: Sidecar = serde_json::from_str(json).map_err(|e| failed("ref_packing_500.json", &e))?;
    let reference = Reference {
        stress: sidecar.stress_from_contacts,
        contacts: sidecar.n_contacts,
        coordination: [sidecar.all, sidecar.without_rattlers],
        solid_fraction: sidecar.phi,
        mean_force: sidecar.mean_normal_force,
        stiffness: sidecar.relaxed.concat(),
        probed: sidecar.probed.concat(),
    };
    Ok((packing, reference))
}

/// 400 unequal spheres of LAMMPS with the contact forces that it dumped, and its stress, Pa: xx yy zz xy xz yz.
pub(super) fn unequal_spheres() -> Result<(Packing, [f64; 6]), Failure> {
    let contact_forces = Some(unpacked(include_bytes!(golden!("lammps/forces.dump.gz")))?);
    let options = ImportOptions { contact_forces, ..ImportOptions::of_grains(&Material::GLASS, 0.3) };
    let text = unpacked(include_bytes!(golden!("lammps/grains.dump.gz")))?;
    let mut packings = read(lammps_dump::packings(&text, &options))?;
    let packing = packings.pop().ok_or_else(|| failed("grains.dump.gz", &"no packing"))?.packing;
    let stress: Vec<f64> = include_str!(golden!("lammps/stress.txt"))
        .split_whitespace()
        .filter_map(|w| w.parse().ok())
        .collect();
    let stress = stress.try_into().map_err(|_| failed("stress.txt", &"not six numbers"))?;
    Ok((packing, stress))
}

fn unpacked(bytes: &[u8]) -> Result<String, Failure> {
    let mut text = String::new();
    GzDecoder::new(bytes).read_to_string(&mut text).map_err(|e| failed("a packing", &e))?;
    Ok(text)
}

fn read<T>(result: Result<T, ImportError>) -> Result<T, Failure> {
    result.map_err(|e| failed("a packing", &e))
}

fn failed(what: &str, why: &dyn std::fmt::Display) -> Failure {
    Failure::failed(format!("reference data in this program, {what}: {why}"))
}
