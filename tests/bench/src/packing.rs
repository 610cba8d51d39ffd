//! The packing to measure: from a file or the default one, repeated along each axis.

use grainlab_console::{Failure, memory};
use grainlab_core::{Material, Packing};
use grainlab_recordings::import::{ImportOptions, load as load_file};
use std::path::{Path, PathBuf};

/// Glass with the friction of the default packing.
fn glass() -> ImportOptions {
    ImportOptions::of_grains(&Material::GLASS, 0.1)
}

/// 2,000 glass spheres from LAMMPS at 100 kPa, z = 5.11: see the README of its folder.
const DEFAULT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../golden/packings/packing_2000.data.gz");

/// The first packing of the file, or the default one.
pub(crate) fn load(path: Option<&Path>) -> Result<Packing, Failure> {
    Ok(all_of(path.unwrap_or(Path::new(DEFAULT)))?.swap_remove(0))
}

/// Every packing of the file, at least one. Glass if it does not contain the material.
fn all_of(path: &Path) -> Result<Vec<Packing>, Failure> {
    let known = load_file(path, &ImportOptions::default());
    let loaded = known.or_else(|_| load_file(path, &glass())).map_err(Failure::failed)?;
    let packings: Vec<Packing> = loaded.packings.into_iter().map(|imported| imported.packing).collect();
    let none = || Failure::failed(format!("{}: contains no packing", path.display()));
    if packings.is_empty() { Err(none()) } else { Ok(packings) }
}

/// Every packing of every file, or the default one.
pub(crate) fn load_all(paths: &[PathBuf]) -> Result<Vec<Packing>, Failure> {
    if paths.is_empty() {
        return Ok(vec![load(None)?]);
    }
    Ok(paths.iter().map(|path| all_of(path)).collect::<Result<Vec<_>, _>>()?.concat())
}

/// Copies along each axis for these sizes; default 1, 2 and 4.
pub(crate) fn copies(grains: usize, wanted: &[u64]) -> Result<Vec<u32>, Failure> {
    if wanted.is_empty() {
        return Ok(vec![1, 2, 4]);
    }
    let one = |n: &u64| {
        let ratio = *n as f64 / grains as f64;
        let copies = ratio.cbrt().round().max(1.0) as u32;
        let size = |c: u32| grains as u64 * u64::from(c).pow(3);
        if size(copies) == *n {
            return Ok(copies);
        }
        let (first, second, third) = (size(1), size(2), size(3));
        let fitting = format!("{first}, {second}, {third}, and so on");
        Err(Failure::usage(format!("--grains {n}: the packing has {grains}, and copies of it {fitting}")))
    };
    wanted.iter().map(one).collect()
}

/// The packing repeated `copies` times along each edge of its cell.
pub(crate) fn replicated(packing: &Packing, copies: u32) -> Result<Packing, Failure> {
    let bytes = packing.bytes() as f64 * f64::from(copies).powi(3);
    memory::require(bytes, &format!("--grains: {copies} copies along each edge take"))?;
    packing.repeated(copies).ok_or_else(|| Failure::failed("the cell of the copies is invalid"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn copies_have_the_contacts_and_the_stress_of_the_packing() {
        let packing = load(None).unwrap();
        let copies = replicated(&packing, 2).unwrap().validated().unwrap().consistent().unwrap();
        assert_eq!(copies.contacts.len(), 8 * packing.contacts.len());
        let [one, eight] = [&packing, &copies].map(|p| grainlab_core::stress::stress(p).tensor.voigt());
        assert!(one.iter().zip(eight).all(|(a, b)| (a - b).abs() < 1e-9 * one[0]), "{one:?} {eight:?}");
    }

    #[test]
    fn the_default_packing_has_the_coordination_that_lammps_found() {
        let packing = load(None).unwrap();
        assert_eq!((packing.grains(), packing.contacts.len()), (2000, 5109));
    }

    #[test]
    fn copies_keep_the_solid_fraction_and_lie_apart() {
        let packing = load(None).unwrap();
        let Packing { cell, positions: centres, .. } = replicated(&packing, 2).unwrap();
        assert_eq!(centres.len(), 16_000);
        assert!((cell.volume() / packing.cell.volume() - 8.0).abs() < 1e-9);
        let shift = centres[2000] - centres[0];
        assert!((shift - packing.cell.matrix().column(2)).norm() < 1e-12);
    }

    #[test]
    fn sizes_that_no_number_of_copies_gives_are_refused_with_those_that_fit() {
        assert_eq!(copies(2000, &[128_000, 2000]).unwrap(), [4, 1]);
        assert_eq!(copies(2000, &[]).unwrap(), [1, 2, 4]);
        let failure = copies(2000, &[16_001]).unwrap_err().to_string();
        assert!(failure.contains("2000, 16000, 54000"), "{failure}");
        assert!(copies(2000, &[0]).is_err());
    }
}
