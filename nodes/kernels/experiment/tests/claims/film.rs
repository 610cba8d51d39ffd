//! Packings within phases, grains of several sizes, and runs that start from a packing.

use crate::{begin, path};
use grainlab_core::Packing;
use grainlab_experiment::Simulation;
use grainlab_scene::{Draft, Scene};
use std::sync::LazyLock;

static SCENE: LazyLock<String> = LazyLock::new(|| path("rate = -60.0", ""));

/// A packing that was due, its run state, and whether a phase had ended.
type Published = (Packing, Vec<u8>, bool);

/// Runs to the end; all packings that were due.
fn run(mut run: Simulation) -> (Simulation, Vec<Published>) {
    let mut published = Vec::new();
    while let Some(outcome) = run.exchange().unwrap() {
        if outcome.packing_due {
            published.push((run.packing().unwrap(), run.run_state().unwrap(), outcome.ended.is_some()));
        }
    }
    (run, published)
}

fn filmed() -> String {
    SCENE
        .replace(
            "until = { solid_fraction = 0.55 }",
            "record = { every_steps = 100 }\nuntil = { solid_fraction = 0.55 }",
        )
        .replace(
            "until = { pressure_above = 2e4 }",
            "record = { every_strain = 1e-3 }\nuntil = { pressure_above = 2e4 }",
        )
        .replace("until = { elapsed = 5e-5 }", "record = { every_time = 1e-5 }\nuntil = { elapsed = 5e-5 }")
}

/// Expected: the same end, bit for bit, with a packing per thousandth of strain and one at the end.
#[test]
fn recording_packings_within_phases_does_not_change_a_run() {
    let ((_, plain), (film, frames)) = (run(begin(&SCENE)), run(begin(&filmed())));
    assert_eq!(plain.len(), 1);
    assert_eq!(frames.last().unwrap().0, plain[0].0);
    assert_eq!(film.packings(), frames.len() as u64);
    assert!(frames.iter().all(|(p, _, ended)| p.path.as_ref().unwrap().end_of_phase == *ended));
    let strained: Vec<&Packing> = frames.iter().map(|(p, ..)| p).filter(|p| p.friction == 0.1).collect();
    assert!(strained.len() > 10, "{} packings", strained.len());
    for (n, pair) in strained.windows(2).enumerate() {
        let strain = |p: &Packing| p.deformation[(2, 2)].ln().abs();
        let step = strain(pair[1]) - strain(pair[0]);
        assert!((step - 1e-3).abs() < 2e-4, "between packings {n} and {}: {step}", n + 1);
    }
}

/// Expected: a run resumed from any of its packings continues to the same packings, bit for bit.
#[test]
fn a_run_resumes_from_each_packing_recorded_within_phases() {
    let scene = filmed();
    let (_, frames) = run(begin(&scene));
    for at in (0..frames.len() - 1).step_by(7) {
        let (packing, state, _) = &frames[at];
        let again = Simulation::resume(Scene::parse(&scene).unwrap(), packing, state).unwrap();
        assert_eq!(&again.run_state().unwrap(), state, "what it says again is what it said");
        assert_eq!(run(again).1, frames[at + 1..], "from packing {at}");
    }
}

/// Expected: solid fraction, energy per grain and momentum of a gas of several sizes, with the same end each
/// time.
#[test]
fn grains_of_several_sizes_are_placed_compressed_and_pressed() {
    for diameter in [
        "{ min = 1.4e-4, max = 2.6e-4 }",
        "{ median = 2e-4, spread = 0.2 }",
        "[{ diameter = 1.4e-4, share = 0.6 }, { diameter = 2.8e-4, share = 0.4 }]",
    ] {
        let scene = SCENE.replace("diameter = 2e-4", &format!("diameter = {diameter}"));
        for scene in [scene.clone(), scene.replace("rate = -60.0", "method = \"soft\"\nrate = -60.0")] {
            let start = begin(&scene);
            let gas = start.packing().unwrap();
            let sizes = start.scene().sizes.diameters(48);
            assert!(gas.radii.iter().zip(&sizes).all(|(r, d)| *r == 0.5 * d));
            assert!((gas.solid_fraction() - 0.3).abs() < 1e-12, "{}", gas.solid_fraction());
            let mass = |r: &f64| gas.material.sphere_mass(*r);
            let momentum = gas.velocities.iter().zip(&gas.radii).map(|(v, r)| v * mass(r));
            assert!(momentum.sum::<grainlab_core::Vec3>().norm() < 1e-12 * mass(&gas.radii[0]));
            let (a, b) = (run(start).1, run(begin(&scene)).1);
            assert_eq!(a, b, "{diameter}");
            assert!(a[0].0.solid_fraction() > 0.55 && a[0].0.clone().validated().is_ok(), "{diameter}");
        }
    }
}

/// Expected: the same packing, at time 0, with its own forces.
#[test]
fn a_run_starts_from_a_packing() {
    let packing = run(begin(&SCENE)).1.remove(0).0;
    let text = "name = \"on\"\nfriction = inf\n[start]\npacking = \"x\"\n\
        [[phase]]\nkind = \"strain\"\nrate = [0, 0, -1.0, 0, 0, 0]\nuntil = { elapsed = 1e-6 }\npublish = true\n";
    let scene = Draft::of_text(text).unwrap().resolve_from(&packing).unwrap().scene;
    let start = Simulation::from_packing(scene.clone(), &packing).unwrap();
    let first = start.packing().unwrap();
    assert_eq!((first.step, first.time, start.packings()), (0, 0.0, 1));
    assert_eq!((&first.positions, &first.velocities), (&packing.positions, &packing.velocities));
    assert_eq!(first.contacts, packing.contacts);
    // It is published first, and the run continues from it.
    let again = Simulation::resume(scene, &first, &start.run_state().unwrap()).unwrap();
    assert_eq!(run(again).1, run(start).1);
}

/// Expected: what each phase leaves out, by name.
#[test]
fn a_run_reports_what_each_phase_leaves_out() {
    let mut run = begin(&SCENE);
    let mut said = Vec::new();
    while run.request().is_some() {
        if said.len() <= run.path().phase {
            said.push(run.left_out());
        }
        run.exchange().unwrap();
    }
    assert!(said[0].contains("hard spheres"), "{said:?}");
    assert_eq!(said[1], "without spins, tangential springs, unequal sizes");
    assert_eq!(said[2], "without unequal sizes");
    assert_eq!(said[3], "without the Coulomb check, unequal sizes");
    let unequal = SCENE.replace("diameter = 2e-4", "diameter = { min = 1.9e-4, max = 2.1e-4 }");
    assert!(!begin(&unequal).left_out().contains("unequal"));
}

fn trace(packing: &Packing) -> f64 {
    packing.strain().unwrap().trace()
}

/// Expected: the volumetric strain since the gas was placed, and since the reference state.
#[test]
fn strain_counts_from_the_first_step_of_a_run_until_a_phase_sets_the_reference() {
    let last = |scene: &str| run(begin(scene)).1.pop().unwrap().0;
    let free = last(&SCENE.replace("reference = true\n", ""));
    assert!((trace(&free) - (0.3 / free.solid_fraction()).ln()).abs() < 1e-12);
    let referred = last(&SCENE);
    assert!((trace(&referred) - (0.55 / referred.solid_fraction()).ln()).abs() < 1e-3);
    assert_eq!((&free.positions, free.cell), (&referred.positions, referred.cell));
}

const PRESSED: &str = "name = \"on\"\nfriction = inf\n[start]\npacking = \"x\"\n\
    [[phase]]\nkind = \"strain\"\nrate = [0, 0, -1.0, 0, 0, 0]\nuntil = { strain = { zz = -3e-6 } }\n";

/// The packing that [`PRESSED`] starts from, and the run.
fn pressed(changed: impl Fn(&str) -> String) -> (Packing, Simulation) {
    let packing = run(begin(&SCENE)).1.remove(0).0;
    let scene = Draft::of_text(&changed(PRESSED)).unwrap().resolve_from(&packing).unwrap().scene;
    let run = Simulation::from_packing(scene, &packing).unwrap();
    (packing, run)
}

/// Expected: no strain at the start, although the packing had one, and then that of the phase.
#[test]
fn a_run_from_a_packing_counts_its_own_strain() {
    let (packing, start) = pressed(|text| text.to_owned() + "publish = true\n");
    assert!(trace(&packing) < -0.01);
    assert_eq!(trace(&start.packing().unwrap()), 0.0);
    let mut straining = start.fork().unwrap();
    let rate = grainlab_servo::control(&straining.request().unwrap().input).unwrap().rate;
    straining.advance(&rate).unwrap();
    let elapsed = straining.engine().time();
    let strain = straining.request().unwrap().strain;
    assert!(elapsed > 0.0 && (strain.zz + elapsed).abs() < 1e-12 && strain.xx == 0.0, "{strain:?}");
    let ended = run(start).1.pop().unwrap().0;
    assert!(trace(&ended) <= -3e-6 && trace(&ended) > -4e-6, "{}", trace(&ended));
}

/// Expected: a packing for each multiple, the last one at the exchange that ends the phase, and one there where the phase
/// publishes, too.
#[test]
fn a_packing_that_is_due_at_the_end_of_a_phase_is_published() {
    let period = "control_period = 1\n";
    for (record, until) in [
        ("every_strain = 1e-6", "strain = { zz = -3e-6 }"),
        ("every_time = 1e-6", "elapsed = 3e-6"),
        ("every_steps = 7", "strain = { zz = -3e-6 }"),
    ] {
        let filmed = |publish: &str| {
            pressed(|text| {
                text.replace("strain = { zz = -3e-6 }", until)
                    + period
                    + &format!("record = {{ {record} }}\n")
                    + publish
            })
        };
        let (_, published) = run(filmed("").1);
        let (_, twice) = run(filmed("publish = true\n").1);
        let (end, _, ended) = published.last().unwrap();
        if record.starts_with("every_steps") {
            // The end is a multiple of the steps by chance alone.
            assert_eq!(published.len() as u64, twice.last().unwrap().0.step / 7, "{record}");
            continue;
        }
        assert_eq!(
            published.len(),
            3,
            "{record}: {:?}",
            published.iter().map(|p| p.0.step).collect::<Vec<_>>()
        );
        assert!(*ended && end.path.as_ref().unwrap().end_of_phase, "{record}");
        assert_eq!(twice.len(), 3, "{record}");
        assert_eq!(&twice.last().unwrap().0, end, "{record}");
    }
}
