//! Runs that begin with a packing of LAMMPS and its contact forces (`tests/golden/lammps/make.in`).

use std::path::{Path, PathBuf};

use grainlab_console::Failure;
use grainlab_experiment::Simulation;
use grainlab_msgs::boundary::packing_message;
use grainlab_msgs::{to_cdr, topics};
use grainlab_recordings::copy::{CopyOptions, copy};
use grainlab_recordings::import::{self, ImportOptions, Start, load};
use grainlab_recordings::{Recording, RunWriter, TopicSpec};
use grainlab_scene::{Draft, SceneError, Source};

use crate::reference_packing::reference;
use crate::support::{SIMULATOR, START, assert_says, golden, options, sample};

/// A triaxial path from the packing, with these lines in `[start]` and these tables.
fn draft(start: &str, tables: &str, friction: f64) -> Draft {
    let text = format!(
        "name = 'from_lammps'\n[start]\npacking = 'grains.dump.gz'\n{start}\n{tables}\n[[phase]]\nkind = 'servo'\n\
         friction = {friction}\ncontrol = {{ xx = {{ stress = 1.3e5 }}, yy = {{ stress = 1e5 }}, zz = {{ rate = -2.0 }} }}\n\
         until = {{ strain = {{ zz = -0.001 }} }}\n"
    );
    draft_in(&golden("lammps"), text)
}

/// A scene in this folder.
fn draft_in(folder: &Path, text: String) -> Draft {
    let name = folder.join("scene.toml").to_string_lossy().into_owned();
    Draft::of(&Source { name, text }, &|_, _| Err("no base".into())).unwrap()
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
    let known = std::fs::read_to_string(golden("lammps/stress.txt")).unwrap();
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

/// The packing of YADE with its default law, as by an older script, which did not write the law.
#[test]
fn the_contact_law_of_the_scene_counts_where_the_file_states_none() {
    let folder = tempfile::tempdir().unwrap();
    let yade = golden("yade");
    std::fs::copy(yade.join("default_law.csv"), folder.path().join("real.csv")).unwrap();
    let text = std::fs::read_to_string(yade.join("default_law.json")).unwrap();
    let mut about: serde_json::Value = serde_json::from_str(&text).unwrap();
    about.as_object_mut().unwrap().retain(|key, _| !key.starts_with("contact_law"));
    std::fs::write(folder.path().join("real.json"), about.to_string()).unwrap();
    let scene = |contact: &str| {
        let text = format!(
            "name = 'from_yade'\nfriction = 0.365\n[start]\npacking = 'real.csv'\n{contact}\n[[phase]]\nkind = 'relax'\n\
             until = {{ elapsed = 1e-3 }}\n"
        );
        draft_in(folder.path(), text)
    };
    let linear = scene("[contact]\nlaw = 'linear'\nnormal_stiffness = 7e6\nstiffness_ratio = 0.3");
    let found = start(&linear).unwrap();
    assert_eq!(found.packing.law.to_string(), "linear:7000000.0,0.3");
    assert!(found.notes.is_empty(), "{:?}", found.notes);
    assert!(begun(linear, &found).unwrap().request().unwrap().unbalanced < 0.01);
    let without = start(&scene("")).unwrap_err().to_string();
    assert!(without.contains("in a scene, give the law under [contact]"), "{without}");
    // A scene with a law that the forces are not of is refused by its own law, not by another one.
    let stiffer = scene("[contact]\nlaw = 'linear'\nnormal_stiffness = 8e6\nstiffness_ratio = 0.3");
    let found = start(&stiffer).unwrap();
    let error = begun(stiffer, &found).unwrap_err().to_string();
    assert!(error.contains("from those of linear:8000000.0,0.3"), "{error}");
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

/// A scene in this folder that starts from its file.
fn scene_in(folder: &tempfile::TempDir, start: &str) -> Draft {
    let text = format!(
        "name = 'x'\nfriction = 0.3\n[start]\n{start}\n{GLASS}\n[[phase]]\nkind = 'relax'\nuntil = {{ elapsed = 1e-4 }}"
    );
    draft_in(folder.path(), text)
}

#[test]
fn copies_of_more_grains_than_a_run_has_are_refused_before_they_are_made() {
    let error = start(&draft("copies = 100", GLASS, 0.3)).unwrap_err();
    let text = error.to_string();
    assert_eq!(error.exit, grainlab_msgs::Exit::Usage);
    assert!(text.starts_with("start.copies: is 100, which asks for 400000000 grains"), "{text}");
    let none = start(&draft("copies = 0", GLASS, 0.3)).unwrap_err().to_string();
    assert!(none.contains("start.copies: is 0; it must be a whole number from 1 to 100"), "{none}");
    assert_eq!(start(&draft("copies = 2", GLASS, 0.3)).unwrap().packing.grains(), 3200);
}

/// A force of 13 nm of overlap beside positions that give 10 nm, and are rounded by 5 nm.
#[test]
fn a_run_does_not_start_from_forces_that_rounded_positions_do_not_hold() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: String| std::fs::write(folder.path().join(name), text).unwrap();
    let box_of = "ITEM: BOX BOUNDS pp pp pp\n0 2e-3\n0 2e-3\n0 2e-3\n";
    let grains = |second: &str| {
        format!(
            "ITEM: TIMESTEP\n1\nITEM: NUMBER OF ATOMS\n2\n{box_of}ITEM: ATOMS id x y z radius\n1 0.001 0.001 0.001 0.0001\n\
             2 {second} 0.001 0.001 0.0001\n"
        )
    };
    let force = grainlab_core::Material::GLASS.normal_force(5e-5, 1.3e-8);
    let row = format!("1 2 1 {} 0 0 0 0 0\n", -force);
    write(
        "forces.dump",
        format!(
            "ITEM: TIMESTEP\n1\nITEM: NUMBER OF ENTRIES\n1\n{box_of}ITEM: ENTRIES patom1 patom2 dist fx fy fz p1 p2 p3\n{row}"
        ),
    );
    let begin = |second: &str| {
        write("grains.dump", grains(second));
        start(&scene_in(&folder, "packing = 'grains.dump'\ncontact_forces = 'forces.dump'"))
    };
    let words =
        ["start.packing: ", "positions have 6 digits", "other forces than those of the file", "%.17g"];
    assert_says(&begin("0.00119999").unwrap_err().to_string(), &words);
    // With all digits, these forces are of another law or state, which the scene is refused by.
    assert!(begin("0.00119999000000000").is_ok());
}

/// The run would end at its first step, and no key of the scene is to blame.
#[test]
fn a_start_whose_grains_overlap_beyond_every_contact_law_is_invalid_physics() {
    let folder = tempfile::tempdir().unwrap();
    let deep = "2\nLattice=\"1 0 0 0 1 0 0 0 1\" Properties=pos:R:3:radius:R:1\n0 0 0 0.1\n0.17 0 0 0.1\n";
    std::fs::write(folder.path().join("deep.xyz"), deep).unwrap();
    let refused = start(&scene_in(&folder, "packing = 'deep.xyz'")).unwrap_err();
    assert_eq!(refused.exit, grainlab_msgs::Exit::PhysicsInvalid);
    let text = refused.to_string();
    assert!(
        text.contains("start.packing: ") && text.contains("by 15 %") && !text.contains("strain rates"),
        "{text}"
    );
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
    copy(&sources, &merged, &CopyOptions::default()).unwrap();
    let packings = load(&merged, &ImportOptions::default()).unwrap().packings;
    assert_eq!(packings.len(), 4);
    assert!(packings.iter().all(|p| p.notes.iter().any(|n| n.contains("holds several runs"))));
    let of = |path: &Path, start: &str| {
        let text = format!(
            "name = 'x'\n[start]\npacking = '{}'\n{start}\n[[phase]]\nkind = 'strain'\nfriction = 0.3\n\
             rate = [-1.0, -1.0, -1.0, 0, 0, 0]\nuntil = {{ elapsed = 1e-3 }}\n",
            path.display()
        );
        super::start::start(&draft_in(root.path(), text))
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
    copy(&same, &twice, &CopyOptions::default()).unwrap();
    assert_eq!(of(&twice, "").unwrap().step, 10);
}

#[test]
fn a_recorded_packing_that_overlaps_beyond_every_contact_law_says_so_where_it_is_read() {
    let root = tempfile::tempdir().unwrap();
    let directory = root.path().join("deep");
    let spec = TopicSpec::of_contract(&topics::PACKING, "/packing");
    let mut run = RunWriter::create(&directory, "deep", &[spec], options()).unwrap();
    let mut packing = reference().packing;
    packing.radii.iter_mut().for_each(|radius| *radius *= 1.15);
    packing.contacts = grainlab_core::contact_search::of_packing(&packing).unwrap();
    let body = to_cdr(&packing_message(&packing, "made", Vec::new()));
    run.write("/packing", &sample(SIMULATOR, 1, START, &body)).unwrap();
    run.finish().unwrap();
    let [deep] = &load(&directory, &ImportOptions::default()).unwrap().packings[..] else {
        panic!("one packing")
    };
    assert!(deep.notes.iter().any(|n| n.contains("overlap by more than 10 %")), "{:?}", deep.notes);
    assert_eq!(deep.exit(), grainlab_msgs::Exit::PhysicsInvalid);
}

#[test]
fn a_run_starts_from_a_step_of_a_dump_whose_other_steps_have_no_forces() {
    let folder = tempfile::tempdir().unwrap();
    let grains = import::text(&golden("lammps/grains.dump.gz")).unwrap();
    let step = grains.lines().nth(1).unwrap();
    let two = format!("{}{grains}", grains.replacen(step, "0", 1));
    std::fs::write(folder.path().join("two.dump"), two).unwrap();
    let forces = golden("lammps/forces.dump.gz");
    let of = |asked: &str| {
        let text = format!(
            "name = 'from_lammps'\nfriction = 0.3\n{GLASS}\n[start]\npacking = 'two.dump'\ncontact_forces = {forces:?}\n{asked}\n\
             [[phase]]\nkind = 'relax'\nuntil = {{ elapsed = 1e-3 }}\n"
        );
        start(&draft_in(folder.path(), text))
    };
    for asked in [format!("step = {step}"), String::new()] {
        let found = of(&asked).unwrap();
        assert_eq!((found.step.to_string().as_str(), found.packing.contacts.len()), (step.trim(), 847));
    }
    let error = of("step = 0").unwrap_err().to_string();
    assert!(error.contains("and the grains of step 0"), "{error}");
    assert!(of("step = 7").unwrap_err().to_string().contains("has no packing of step 7"));
}
