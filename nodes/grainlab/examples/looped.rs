use grainlab::{Observation, measure, simulate};
fn main() {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let n: u64 = args[1].parse().unwrap();
    for seed in 1..=n {
        let seed = format!("seed={seed}");
        let mut sets: Vec<&str> = args[2..].iter().map(String::as_str).collect();
        sets.push(&seed);
        let mut sum = 0.0;
        for state in simulate(&args[0], &sets).unwrap().with_threads(1).unwrap() {
            let state = match state {
                Ok(s) => s,
                Err(e) => {
                    println!("{seed} {e}");
                    break;
                }
            };
            let report = measure(&state).unwrap();
            if let Some(observation) = Observation::of(&report) {
                for model in grainlab_emt::models() {
                    if let Ok(e) = model.infer(&observation, model.default_calibration()) {
                        sum += e.structure.eps.unwrap_or(0.0);
                    }
                }
            }
        }
        println!("{seed} {sum}");
    }
}
