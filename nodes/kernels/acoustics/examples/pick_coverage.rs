//! Picks computed records of known speed, and prints how many have an answer, and how far the answers are off.
//!
//! `cargo run --release -p grainlab_acoustics --example pick_coverage [RECORDS]`; the test `pick_coverage` takes the first 24 of these records.

#[path = "../tests/claims/computed_records.rs"]
mod computed_records;

use computed_records::{computed, has_later, usual};
use grainlab_acoustics::record::picks;
use rayon::prelude::*;

fn main() {
    let count = std::env::args().nth(1).and_then(|text| text.parse().ok()).unwrap_or(200);
    println!("record,mode,s_over_p,noise,later,true_speed,speed,stddev,off,refused");
    let one = |seed: u64| {
        let conditions = usual(seed);
        let of = computed(seed, &conditions);
        let found = picks(&of.record, &of.passage, 1).map(|found| found.picks[found.recommended]);
        (seed, conditions, of, found)
    };
    let all: Vec<_> = (0..count).into_par_iter().map(one).collect();
    let mut answers = [(0, 0); 2];
    let mut off = Vec::new();
    for (seed, conditions, of, found) in &all {
        let noise = conditions.noise;
        let mode = if of.passage.longitudinal == Some(true) { "p" } else { "s" };
        let (s_over_p, later) = (conditions.s_over_p, has_later(*seed));
        print!("{seed},{mode},{s_over_p:.1},{noise:.3},{later},{:.1},", of.speed);
        let class = usize::from(noise > 0.125);
        answers[class].1 += 1;
        match found {
            Ok(p) => {
                answers[class].0 += 1;
                let sigmas = (p.speed - of.speed) / p.speed_stddev;
                println!("{:.1},{:.1},{sigmas:.2},", p.speed, p.speed_stddev);
                off.push((
                    sigmas.abs(),
                    p.speed_stddev / p.speed,
                    noise < 0.03,
                    (p.speed / of.speed - 1.0).abs(),
                ));
            }
            Err(reason) => println!(",,,\"{reason}\""),
        }
    }
    let [(clear, of_clear), (weak, of_weak)] = answers;
    println!(
        "# answers: {clear} of {of_clear} whose wave is 8 times the noise or more, {weak} of the {of_weak} others"
    );
    for (k, sigmas) in [1.0, 2.0, 3.0].into_iter().enumerate() {
        let inside = off.iter().filter(|(off, ..)| *off <= sigmas).count();
        println!("# within {} stated sigmas: {inside} of {}", k + 1, off.len());
    }
    for (is_quiet, name) in [(true, "below"), (false, "above")] {
        let median = |of: fn(&(f64, f64, bool, f64)) -> f64| {
            let mut values: Vec<f64> = off.iter().filter(|o| o.2 == is_quiet).map(of).collect();
            values.sort_by(f64::total_cmp);
            100.0 * values[values.len() / 2]
        };
        println!(
            "# noise {name} 3 %: median sigma {:.2} %, median error {:.2} %",
            median(|o| o.1),
            median(|o| o.3)
        );
    }
}
