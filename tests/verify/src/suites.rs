//! The list of suites.

use crate::golden;
use grainlab_console::Failure;
use grainlab_verify::{
    Row, VerificationError, agnolin_roux, chung_ooi, grainlearning, laboratory, lammps_packings,
    lammps_pairs, mercury, ondem, smooth_moduli, uniaxial,
};
use rayon::prelude::*;

/// Comparisons that belong together.
pub(super) struct Suite {
    /// As in `--only`.
    pub(super) name: &'static str,
    /// Subject of the comparisons.
    pub(super) about: &'static str,
    /// True if it takes minutes.
    pub(super) slow: bool,
    pub(super) rows: fn() -> Result<Vec<Row>, Failure>,
}

/// Every suite, in the order of the table.
pub(super) const SUITES: [Suite; 10] = [
    quick(
        lammps_pairs::NAME,
        "two spheres, as LAMMPS's own tests record them",
        || made(lammps_pairs::rows()),
    ),
    quick(chung_ooi::NAME, "the eight tests of Chung & Ooi", || made(chung_ooi::rows())),
    quick(mercury::NAME, "the Mindlin tests of MercuryDPM", || made(mercury::rows())),
    quick(ondem::NAME, "the prescribed motions of ON-DEM", || made(ondem::rows())),
    quick(grainlearning::NAME, "what a force curve of GrainLearning fixes", || made(grainlearning::rows())),
    quick(smooth_moduli::NAME, "moduli of smooth spheres by matscipy", || {
        made(smooth_moduli::rows(&golden::smooth_spheres()?, &golden::matscipy()?))
    }),
    quick(lammps_packings::NAME, "packings of LAMMPS: contacts, forces, stress, stiffness", || {
        let (packing, reference) = golden::equal_spheres()?;
        let mut rows = made(lammps_packings::equal_spheres(&packing, &reference))?;
        let (packing, stress) = golden::unequal_spheres()?;
        rows.extend(lammps_packings::unequal_spheres(&packing, &stress));
        Ok(rows)
    }),
    quick(uniaxial::NAME, "uniaxial compression step by step compared with LAMMPS", || {
        made(uniaxial::rows(&golden::to_compress()?, &golden::compressed()?))
    }),
    quick(laboratory::NAME, "wave speeds of real samples, each pressure predicted from the others", || {
        made(laboratory::rows())
    }),
    Suite {
        name: agnolin_roux::NAME,
        about: "twelve packings of 4,000 grains prepared as Agnolin & Roux have them",
        slow: true,
        rows: agnolin_roux,
    },
];

/// Packings are prepared side by side.
fn agnolin_roux() -> Result<Vec<Row>, Failure> {
    let runs = agnolin_roux::STATES.iter().flat_map(|state| agnolin_roux::SEEDS.map(|seed| (state, seed)));
    let runs: Vec<_> = runs.collect();
    let found = runs.par_iter().map(|(state, seed)| agnolin_roux::prepared(state, *seed));
    let found = made(found.collect::<Result<Vec<_>, _>>())?;
    let of_states = agnolin_roux::STATES.iter().zip(found.chunks(agnolin_roux::SEEDS.len()));
    Ok(of_states.flat_map(|(state, found)| agnolin_roux::rows(state, found)).collect())
}

const fn quick(name: &'static str, about: &'static str, rows: fn() -> Result<Vec<Row>, Failure>) -> Suite {
    Suite { name, about, slow: false, rows }
}

fn made<T>(result: Result<T, VerificationError>) -> Result<T, Failure> {
    result.map_err(|e| Failure::failed(e.to_string()))
}
