//! Probes the reference packing of 500 grains: each column beside LAMMPS's of the same strain and beside the frozen
//! network, and the CPU time it took: `cargo run --release -p micro --example probe [AMPLITUDE [REPEATS]]`.

#[path = "../tests/claims/golden.rs"]
#[expect(dead_code, reason = "shared with the tests")]
mod golden;
#[path = "../tests/claims/samples.rs"]
#[expect(dead_code, reason = "shared with the tests")]
mod samples;

use micro::{Probe, Settings, analyse, probe};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let amplitude = arguments.next().unwrap_or("1e-7".into());
    let repeats: u32 = arguments.next().map_or(Ok(1), |r| r.parse())?;
    let settings = Probe { amplitude: amplitude.parse()?, ..Probe::default() };
    let packing = golden::reference();
    let lammps = golden::lammps(&amplitude);
    let analysis = analyse(&packing, &Settings::default())?;
    let network = analysis.moduli?.stiffness.0;
    for _ in 0..repeats {
        let begin = cpu_seconds();
        let found = probe(&packing, &settings)?;
        let seconds = cpu_seconds() - begin;
        let c = found.stiffness.0;
        let c11 = c[(0, 0)];
        println!("column of C, MPa; differences as shares of C11");
        for (k, name) in ["xx", "yy", "zz", "yz", "xz", "xy"].iter().enumerate() {
            let column = c.column(k);
            let entries: String = column.iter().map(|v| format!("{:9.3}", v / 1e6)).collect();
            let to = |other: &nalgebra::Matrix6<f64>| (column - other.column(k)).amax() / c11;
            println!(
                "{name}{entries}  LAMMPS {:.1e} network {:.1e}  {:?}",
                to(&lammps),
                to(&network),
                found.columns[k]
            );
        }
        println!(
            "asymmetry {:.1e}; {} steps to rest; {:.4} s of CPU a column",
            found.asymmetry,
            found.rest_steps,
            seconds / 6.0
        );
    }
    Ok(())
}

/// CPU time of this process, s.
fn cpu_seconds() -> f64 {
    let mut now = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: the call writes one timespec, through a pointer to one.
    unsafe { libc::clock_gettime(libc::CLOCK_PROCESS_CPUTIME_ID, &mut now) };
    now.tv_sec as f64 + 1e-9 * now.tv_nsec as f64
}
