//! Runs that begin with a packing of LAMMPS and its contact forces (`tests/golden/lammps/make.in`).

use std::path::{Path, PathBuf};

use grainlab_console::Failure;
use grainlab_experiment::Simulation;
use grainlab_msgs::boundary::packing_message;
use grainlab_msgs::{to_cdr, topics};
use grainlab_recordings::copy::{CopyOptions, Select, copy};
use grainlab_recordings::import::{self, ImportOptions, Start, load};
use grainlab_recordings::{Recording, RunWriter, TopicSpec};
use grainlab_scene::{Draft, SceneError, Source};

use crate::reference_packing::reference;
use crate::support::{SIMULATOR, START, options, sample};

fn golden() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/golden/lammps")
}

/// A triaxial path from the packing, with these lines in `[start]` and these tables.
fn draft(start: &str, tables: &str, friction: f64) -> Draft {
    let text = format!(
        "name = 'from_lammps'\n[start]\npacking = 'grains.dump.gz'\n{start}\n{tables}\n[[phase]]\nkind = 'servo'\n\
         friction = {friction}\ncontrol = {{ xx = {{ stress = 1.3e5 }}, yy = {{ stress = 1e5 }}, zz = {{ rate = -2.0 }} }}\n\
         until = {{ strain = {{ zz = -0.001 }} }}\n"
    );
    let source = Source { name: golden().join("scene.toml").to_string_lossy().into_owned(), text };
    Draft::of(&source, &|_, _| Err("no base".into())).unwrap()
}

fn start(draft: &Draft) -> Result<Start, Failure> {
    import::start(draft, &draft.start().unwrap())
}

fn begun(mut draft: Draft, found: &Start) -> Result<Simulation, SceneError> {
    let forces = found.contact_forces.as_ref().map(|path| path.to_string_lossy());
    draft.start_at(&found.path.to_string_lossy(), forces.as_deref(), found.step);
    let scene = draft.resolve_from(&found.packing)?.scene;
    Ok(Simulation::from_packing(scene, &found.packing).unwrap())
}

const FORCES: &str = "contact_forces = 'forces.dump.gz'";
const GLASS: &str = "[material]\nshear_modulus = 29e9\npoisson_ratio = 0.2\ndensity = 2500";

#[test]
fn a_frictional_packing_of_lammps_starts_at_rest_at_its_own_stress_and_goes_along_a_triaxial_path() {
    let draft = draft(FORCES, GLASS, 0.3);
    let found = start(&draft).unwrap();
    assert!(found.notes.is_empty(), "{:?}", found.notes);
    let mut run = begun(draft, &found).unwrap();
    let first = run.request().unwrap();
    assert!(first.unbalanced < 1e-8, "{:e}", first.unbalanced);
    let known = std::fs::read_to_string(golden().join("stress.txt")).unwrap();
    let known: Vec<f64> = known.split_whitespace().map(|v| v.parse().unwrap()).collect();
    // LAMMPS's order is xx yy zz xy xz yz.
    for (own, k) in first.input.stress.voigt().into_iter().zip([0, 1, 2, 5, 4, 3]) {
        assert!((own - known[k]).abs() < 1e-9 * known[0], "{own} {}", known[k]);
    }
    for _ in 0..50 {
        run.exchange().unwrap();
    }
    let later = run.request().unwrap();
    let axial = |r: &grainlab_servo::ServoRequest| r.input.stress.voigt()[2];
    assert!(axial(&later) > axial(&first) && later.unbalanced < 0.05, "{later:?}");
}

#[test]
fn without_its_forces_the_same_packing_is_far_from_rest() {
    let draft = draft("", GLASS, 0.3);
    let found = start(&draft).unwrap();
    assert!(found.notes.iter().any(|n| n.contains("no tangential forces")), "{:?}", found.notes);
    assert!(begun(draft, &found).unwrap().request().unwrap().unbalanced > 0.01);
}

#[test]
fn forces_that_the_run_would_change_at_once_are_said_or_refused() {
    let low = draft(FORCES, GLASS, 0.1);
    let notes = start(&low).unwrap().notes;
    assert!(notes.iter().any(|n| n.contains("of 847 contacts carry more tangential force")), "{notes:?}");
    // Another material, and another law.
    for tables in [
        GLASS.replace("29e9", "25e9"),
        format!("{GLASS}\n[contact]\nlaw = 'linear'\nnormal_stiffness = 1e5\nstiffness_ratio = 0.5"),
    ] {
        let other = draft(FORCES, &tables, 0.3);
        let found = start(&other).unwrap();
        let error = begun(other, &found).unwrap_err().to_string();
        assert!(error.contains("start.packing: normal forces of the packing differ by"), "{error}");
    }
}

#[test]
fn files_and_columns_that_are_not_there_are_named_by_their_key() {
    for (lines, expected) in [
        ("contact_forces = 'nothing.dump'", "start.contact_forces: "),
        (
            "contact_forces = 'forces.dump.gz'\ncontact_columns = ['a', 'b', 'x', 'y', 'z']",
            "there is no column a",
        ),
        ("contact_forces = 'forces.dump.gz'\nstep = 3", "start.step: "),
    ] {
        let error = start(&draft(lines, GLASS, 0.3)).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    }
}

/// A recording of two packings of these steps, moved by this share of a radius.
fn recorded(root: &tempfile::TempDir, name: &str, steps: [u64; 2], moved: f64, scene: &str) -> PathBuf {
    let directory = root.path().join(name);
    let spec = TopicSpec::of_contract(&topics::PACKING, "/packing");
    let mut run = RunWriter::create(&directory, name, &[spec], options()).unwrap();
    run.attach("scene.toml", "application/toml", scene.as_bytes()).unwrap();
    for (n, step) in steps.into_iter().enumerate() {
        let mut packing = grainlab_core::Packing { step, time: 1e-6 * step as f64, ..reference().packing };
        let shift = moved * packing.radii[0];
        packing.positions.iter_mut().for_each(|position| position.x += shift);
        let body = to_cdr(&packing_message(&packing, "made", Vec::new()));
        run.write("/packing", &sample(SIMULATOR, n as i64 + 1, START + step, &body)).unwrap();
    }
    run.finish().unwrap();
    directory
}

#[test]
fn a_merged_recording_starts_a_run_only_from_a_step_that_one_of_its_runs_has() {
    let root = tempfile::tempdir().unwrap();
    let runs = [
        recorded(&root, "left", [0, 10], 0.0, "name = 'left'"),
        recorded(&root, "right", [0, 20], 1e-3, "name = 'right'"),
    ];
    let sources = runs.map(|run| Recording::open(&run).unwrap());
    let merged = root.path().join("merged.mcap");
    copy(&sources, &Select::default(), &merged, &CopyOptions::default()).unwrap();
    let packings = load(&merged, &ImportOptions::default()).unwrap().packings;
    assert_eq!(packings.len(), 4);
    assert!(packings.iter().all(|p| p.notes.iter().any(|n| n.contains("holds several runs"))));
    let of = |path: &Path, start: &str| {
        let text = format!(
            "name = 'x'\n[start]\npacking = '{}'\n{start}\n[[phase]]\nkind = 'strain'\nfriction = 0.3\n\
             rate = [-1.0, -1.0, -1.0, 0, 0, 0]\nuntil = {{ elapsed = 1e-3 }}\n",
            path.display()
        );
        let source = Source { name: root.path().join("scene.toml").to_string_lossy().into_owned(), text };
        super::start::start(&Draft::of(&source, &|_, _| Err("no base".into())).unwrap())
    };
    let error = of(&merged, "step = 0").unwrap_err();
    assert!(error.to_string().contains("several different packings of step 0"), "{error}");
    let error = of(&merged, "").unwrap_err();
    assert!(error.to_string().contains("holds several runs"), "{error}");
    assert!(of(&merged, "step = 11").unwrap_err().to_string().contains("no packing of step 11"));
    let found = of(&merged, "step = 20").unwrap();
    assert!(found.notes.iter().any(|n| n.contains("holds several runs")), "{:?}", found.notes);
    // Each by itself is one run; so is one that was merged with itself.
    let left = root.path().join("left");
    assert_eq!((of(&left, "").unwrap().step, of(&left, "step = 0").unwrap().notes.len()), (10, 0));
    let twice = root.path().join("twice.mcap");
    let same = [Recording::open(&left).unwrap(), Recording::open(&left).unwrap()];
    copy(&same, &Select::default(), &twice, &CopyOptions::default()).unwrap();
    assert_eq!(of(&twice, "").unwrap().step, 10);
}
