//! Cost of the gas stage, and the packing that follows: `gas_stage GRAINS FIRST-LAST METHOD:RATE…`, seeds
//! from first to last, for example `cargo run --release -p grainlab_experiment --example gas_stage 500 1-6
//! soft:12 event_driven:12`.
//!
//! Each gas is compressed to φ = 0.607 at that rate (1/s), comes to rest, is compressed without friction to 1
//! kPa (its φ there approximates jamming), then with μ = 0.1 to 50 kPa.

use std::time::Instant;

/// One gas and its result.
struct Outcome {
    /// Wall time to φ = 0.607, s.
    seconds: f64,
    /// φ at 1 kPa, frictionless.
    jammed: f64,
    /// φ, k and z at 50 kPa.
    loaded: [f64; 3],
}

impl Outcome {
    fn columns(&self) -> [f64; 5] {
        [self.seconds, self.jammed, self.loaded[0], self.loaded[1], self.loaded[2]]
    }
}

fn scene(grains: u32, seed: u64, method: &str, rate: f64) -> String {
    let press = |name: &str, stress: f64, friction: f64| {
        format!(
            "[[phase]]\nkind = 'servo'\nname = '{name}'\nfriction = {friction}\ndrag = 1.5e3\nresponse_time = 2e-6\n\
             control_period = 20\npublish = true\nuntil = {{ on_target = 1e-2, unbalanced = 1e-3, hold = 1e-4 }}\n\
             control = {{ xx = {{ stress = {stress} }}, yy = {{ stress = {stress} }}, zz = {{ stress = {stress} }}, \
             yz = {{ stress = 0 }}, xz = {{ stress = 0 }}, xy = {{ stress = 0 }} }}\n"
        )
    };
    format!(
        "name = 'gas_stage'\nseed = {seed}\n[grains]\ncount = {grains}\ndiameter = 2e-4\n\
         [[phase]]\nkind = 'gas'\nname = 'gas'\nmethod = '{method}'\nrate = -{rate}\nuntil = {{ solid_fraction = 0.607 }}\n\
         [[phase]]\nkind = 'relax'\nname = 'rest'\nfriction = 0\ndrag = 4e3\ncontrol_period = 100\n\
         until = {{ speed = 1e-3 }}\n{}{}",
        press("jam", 1e3, 0.0),
        press("load", 50e3, 0.1)
    )
}

fn run(text: &str) -> Result<Outcome, Box<dyn std::error::Error>> {
    let begin = Instant::now();
    let mut run = grainlab_experiment::Simulation::new(grainlab_scene::Scene::parse(text)?)?;
    let mut out = Outcome { seconds: 0.0, jammed: 0.0, loaded: [0.0; 3] };
    while let Some(outcome) = run.exchange()? {
        match outcome.ended.as_deref() {
            Some("gas") => out.seconds = begin.elapsed().as_secs_f64(),
            Some("jam") => out.jammed = run.packing()?.solid_fraction(),
            Some("load") => {
                let packing = run.packing()?;
                let settings = grainlab_micromechanics::Settings::default();
                let contacts = grainlab_micromechanics::analyze(&packing, &settings)?.report.contacts;
                out.loaded =
                    [packing.solid_fraction(), contacts.coordination, contacts.mechanical_coordination];
            }
            _ => {}
        }
    }
    Ok(out)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [grains, seeds, gases @ ..] = arguments.as_slice() else {
        return Err("usage: gas_stage GRAINS FIRST-LAST METHOD:RATE...".into());
    };
    let grains: u32 = grains.parse()?;
    let (first, last) = seeds.split_once('-').ok_or("seeds are FIRST-LAST")?;
    let (first, last): (u64, u64) = (first.parse()?, last.parse()?);
    println!(
        "{:18} {:>5} {:>18} {:>18} {:>18} {:>16} {:>16}",
        "gas", "seed", "seconds", "phi 1 kPa", "phi 50 kPa", "k", "z"
    );
    let mut outcomes: Vec<Vec<Outcome>> = gases.iter().map(|_| Vec::new()).collect();
    // Seed by seed, so that a varying load on the machine affects all alike.
    for seed in first..=last {
        for (gas, outcomes) in gases.iter().zip(&mut outcomes) {
            let (method, rate) = gas.split_once(':').ok_or("a gas is METHOD:RATE")?;
            let o = run(&scene(grains, seed, method, rate.parse()?))?;
            let [s, j, l, k, z] = o.columns();
            println!("{gas:18} {seed:5} {s:18.3} {j:18.4} {l:18.4} {k:16.3} {z:16.3}");
            outcomes.push(o);
        }
    }
    for (gas, outcomes) in gases.iter().zip(&outcomes) {
        let [s, j, l, k, z] = [0, 1, 2, 3, 4].map(|column| {
            let values: Vec<f64> = outcomes.iter().map(|o| o.columns()[column]).collect();
            let n = values.len() as f64;
            let mean = values.iter().sum::<f64>() / n;
            let square = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0).max(1.0);
            (mean, (square / n).sqrt())
        });
        print!("{gas:18}  mean ");
        print!("{:9.3} ± {:6.3} {:9.4} ± {:6.4} {:9.4} ± {:6.4} ", s.0, s.1, j.0, j.1, l.0, l.1);
        println!("{:8.3} ± {:5.3} {:8.3} ± {:5.3}", k.0, k.1, z.0, z.1);
    }
    Ok(())
}
