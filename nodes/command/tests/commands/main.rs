//! The binary on the command line, command by command.

mod analyze;
mod calibrate;
mod experiment;
mod invert;
mod pick;
mod probe;
mod usage;

use std::path::Path;
use std::process::Command;
use system_tests::process::{Ended, Process};
use system_tests::wait::LIMIT;

/// A packing of 500 grains.
const REFERENCE: &str =
    concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/golden/reference/ref_packing_500.csv.gz");

/// The material and friction of a packing from a file without them.
const GLASS: [&str; 8] =
    ["--shear-modulus", "29e9", "--poisson", "0.2", "--density", "2500", "--friction", "0.3"];

/// Runs the binary to its end, without standard input.
fn grainlab(arguments: &[&str]) -> Ended {
    grainlab_in(Path::new("."), arguments)
}

/// Runs the binary in this folder.
fn grainlab_in(folder: &Path, arguments: &[&str]) -> Ended {
    let mut command = Command::new(env!("CARGO_BIN_EXE_grainlab"));
    // A series is judged by inversions of simulated samples, for a minute or more.
    Process::start(command.args(arguments).current_dir(folder)).ended(10 * LIMIT)
}

/// A pair of grains `apart` in a unit cell, as a dump with one frame per step.
fn dump(apart: f64, steps: &[u64]) -> String {
    let frame = |step: &u64| {
        format!(
            "ITEM: TIMESTEP\n{step}\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS pp pp pp\n0 1\n0 1\n0 1\n\
             ITEM: ATOMS id x y z radius\n1 0.1 0 0 0.1\n2 {} 0 0 0.1\n",
            0.1 + apart
        )
    };
    steps.iter().map(frame).collect()
}
