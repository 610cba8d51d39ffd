//! A program that is missing, refuses, ends or hangs.

use super::agreement::PRESSED;
use super::lammps;
use grainlab_core::{Cell, Mat3, Packing, Vec3};
use grainlab_dem::Dem;
use grainlab_engine::{Compute, EngineError, EngineFactory, EngineSettings};
use grainlab_lammps::Lammps;
use std::time::Duration;

fn settings() -> EngineSettings {
    EngineSettings { skin: 1e-5, ..EngineSettings::default() }
}

/// The error of a start and 10 steps with this command in place of `lmp`.
fn error(command: &str, limit: Duration) -> EngineError {
    let lammps = Lammps { command: command.to_owned(), time_limit: limit };
    let started = lammps.start(&PRESSED, &settings(), &[0.0; 6], &Compute::default());
    started.and_then(|mut engine| engine.run(10).map(drop)).unwrap_err()
}

#[test]
fn a_program_that_is_missing_or_is_not_lammps_is_named_with_its_last_lines() {
    let limit = Duration::from_secs(20);
    let missing = error("/no/lmp", limit);
    assert!(missing.to_string().contains("`/no/lmp`: it ended (exit status: 127): "), "{missing}");
    let ended = error("sh -c 'echo no licence >&2; exit 7'", limit);
    assert!(matches!(ended, EngineError::Lost { .. }));
    let text = ended.to_string();
    assert!(text.contains("it ended (exit status: 7): no licence"), "{text}");
}

#[test]
fn a_program_that_hangs_is_ended_after_the_time_limit_with_all_its_processes() {
    let folder = tempfile::tempdir().unwrap();
    let mark = folder.path().join("alive");
    // Also one whose parent has ended, in a session of its own.
    for (inner, outer) in [("(", ")"), ("((setsid sh -c \"", "\") &)")] {
        let hang = format!("sh -c '{inner}sleep 3; touch {}{outer} & sleep 60' -n", mark.display());
        let text = error(&hang, Duration::from_millis(300)).to_string();
        assert!(text.contains("it did not answer within 0.3 s, and was ended"), "{text}");
    }
    std::thread::sleep(Duration::from_millis(3500));
    assert!(!mark.exists());
}

#[test]
fn a_program_that_prints_without_end_is_ended_after_the_time_limit() {
    let text = error("exec yes;", Duration::from_millis(300)).to_string();
    assert!(text.contains("it did not answer within 0.3 s, and was ended"), "{text}");
}

#[test]
fn the_first_time_step_after_a_gas_is_that_of_contacts_and_not_a_mean_free_time() {
    let Some(lammps) = lammps(1) else { return };
    let cell = Cell::new(1.5 * PRESSED.cell.matrix()).unwrap();
    let positions = PRESSED.positions.iter().map(|x| 1.5 * x).collect();
    let velocities = vec![Vec3::new(3.0, 0.0, 0.0); PRESSED.grains()];
    let gas =
        Packing { cell, positions, velocities, contacts: Vec::new(), time_step: 1e-5, ..PRESSED.clone() };
    let engine = lammps.start(&gas, &settings(), &[0.0; 6], &Compute::default()).unwrap();
    assert!(engine.time_step() < 1e-6, "{:e}", engine.time_step());
}

#[test]
fn an_error_of_lammps_is_quoted_and_ends_the_engine() {
    let Some(lammps) = lammps(1) else { return };
    // In place of the command that sets the time step.
    let spoiled = format!("sh -c '{{ sed -u s/^timestep/nonsense/; }} | {} -nb -log none'", lammps.command);
    let text = error(&spoiled, lammps.time_limit).to_string();
    assert!(text.contains("Unknown command: nonsense"), "{text}");
}

#[test]
fn tangential_forces_of_another_engine_are_refused_and_those_of_lammps_are_continued() {
    let Some(lammps) = lammps(1) else { return };
    let settings = EngineSettings { friction: 0.3, ..settings() };
    let start = |factory: &dyn EngineFactory, packing: &Packing| {
        factory.start(packing, &settings, &[0.0; 6], &Compute::default())
    };
    let mut engine = start(&lammps, &PRESSED).unwrap();
    engine.begin_phase(&settings).unwrap();
    engine.set_rate(&[0.0, 0.0, 0.0, 0.0, 0.0, 30.0]).unwrap();
    engine.run(50).unwrap();
    let (packing, own_state) = (engine.packing(Mat3::identity()).unwrap(), engine.own_state().unwrap());
    assert!(packing.contacts.iter().any(|c| c.tangential_force.norm() > 0.1 * c.normal_force));
    // Read twice, a state has the same bytes: a recording has it once.
    assert!(engine.packing(Mat3::identity()).unwrap() == packing && engine.own_state().unwrap() == own_state);
    // By its restart file, with all springs.
    let mut again =
        lammps.resume(&packing, &own_state, &settings, &engine.rate(), &Compute::default()).unwrap();
    again.set_rate(&engine.rate()).unwrap();
    let (first, second) = (engine.run(50).unwrap().1, again.run(50).unwrap().1);
    let off = (first.stress.tensor.matrix() - second.stress.tensor.matrix()).norm()
        / first.stress.tensor.matrix().norm();
    assert!(off < 1e-10, "{off:e}");
    // To ours by the forces of contacts; from ours not at all.
    assert!(start(&Dem::default(), &packing).is_ok());
    let refused = start(&lammps, &packing).unwrap_err().to_string();
    assert!(refused.contains("the packing has tangential forces, which LAMMPS cannot read"), "{refused}");
}
