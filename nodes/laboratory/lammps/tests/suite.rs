//! LAMMPS passes the suite of engines.

use grainlab_lammps::Lammps;
use grainlab_verification::conformance::CLAIMS;

#[test]
fn lammps_passes_the_suite_of_engines() {
    let broken: Vec<String> = CLAIMS.iter().filter_map(|claim| claim.check(&Lammps::default()).err()).collect();
    assert_eq!(broken, Vec::<String>::new());
}
