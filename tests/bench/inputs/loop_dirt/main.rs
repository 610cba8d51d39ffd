//! The stepping loop of DIRT on a dense frictional packing at rest, three periodic sides.
//!
//! usage: loop_dirt CONFIG.toml    with LOOP_WARMUP and LOOP_STEPS, the steps before and in the timed loop, in the environment
//!
//! Prints one line: `dirt: ` and the measurement as JSON. compare_peers.py writes the configuration and builds this file in a
//! temporary folder, outside the workspace.

use dirt_core::dirt_atom::DemAtom;
use dirt_core::prelude::*;
use std::time::Instant;

/// Wall and CPU time at the beginning of the timed loop, and the state before the first step.
#[derive(Default)]
struct Loop {
    done: usize,
    begin: Option<(Instant, f64)>,
    start: String,
}

fn main() {
    let mut app = App::new();
    app.add_plugins(CorePlugins).add_plugins(GranularDefaultPlugins);
    app.add_resource(Loop::default());
    app.add_update_system(observe, ParticleSimScheduleSet::PostFinalIntegration);
    app.start();
}

fn observe(
    atoms: Res<Atom>,
    registry: Res<AtomDataRegistry>,
    neighbor: Res<Neighbor>,
    domain: Res<Domain>,
    mut virial: ResMut<VirialStress>,
    mut timed: ResMut<Loop>,
) {
    let (warmup, steps) = (number("LOOP_WARMUP"), number("LOOP_STEPS"));
    timed.done += 1;
    if timed.done == 1 {
        // The grains are at rest and no force acts before the first step: its forces are those of the positions as read.
        timed.start = state(&atoms, &registry, &neighbor, &domain, &virial);
        // The virial again only at the end: the other codes without a servo do not evaluate it at every step, either.
        virial.set_interval(warmup + steps);
    }
    if timed.done == 1 + warmup {
        timed.begin = Some((Instant::now(), cpu_seconds()));
    }
    if timed.done == 1 + warmup + steps {
        let (wall, cpu) = timed.begin.expect("the loop has begun");
        let (wall, cpu) = (wall.elapsed().as_secs_f64(), cpu_seconds() - cpu);
        println!(
            "dirt: {{\"grains\": {}, \"steps\": {steps}, \"wall_s\": {wall}, \"cpu_s\": {cpu}, \"rebuilds\": {}, \"start\": {}, \"end\": {}}}",
            atoms.nlocal(),
            usize::from(neighbor.steps_since_build < steps),
            timed.start,
            state(&atoms, &registry, &neighbor, &domain, &virial),
        );
    }
}

/// Pressure, Pa, and contacts per grain times two.
fn state(
    atoms: &Atom,
    registry: &AtomDataRegistry,
    neighbor: &Neighbor,
    domain: &Domain,
    virial: &VirialStress,
) -> String {
    let radius = &registry.expect::<DemAtom>("loop_dirt").radius;
    let grains = atoms.nlocal() as usize;
    let touching = |(i, j): &(usize, usize)| {
        let square: f64 = (0..3).map(|c| (atoms.pos[*j][c] - atoms.pos[*i][c]).powi(2)).sum();
        square < (radius[*i] + radius[*j]).powi(2)
    };
    // The list has each pair once, also across the sides of the cell.
    let contacts = neighbor.pairs(grains).filter(touching).count();
    let pressure = -virial.trace() / (3.0 * domain.volume);
    format!("{{\"pressure\": {pressure:.17e}, \"coordination\": {}}}", 2.0 * contacts as f64 / grains as f64)
}

/// CPU time of this process, which has one thread, s.
fn cpu_seconds() -> f64 {
    let text = std::fs::read_to_string("/proc/self/schedstat").expect("/proc/self/schedstat");
    1e-9 * text.split_whitespace().next().and_then(|w| w.parse::<f64>().ok()).expect("nanoseconds")
}

fn number(name: &str) -> usize {
    std::env::var(name)
        .ok()
        .and_then(|v| v.parse().ok())
        .unwrap_or_else(|| panic!("{name} is no number of steps"))
}
