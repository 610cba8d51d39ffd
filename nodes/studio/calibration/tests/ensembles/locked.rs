//! Packings of which the contacts do not slide: pressed at a low friction, then sheared at a high one.

use crate::{csv, ours};
use grainlab_core::results::InferredQuantity;
use grainlab_emt::StrainRatioSource;

/// At unchanged contacts their stiffness follows q/p less than in the packings taught. `--nocapture` prints the numbers that the README
/// of `grainlab_emt` has.
#[test]
fn intervals_of_eps_contain_the_count_of_packings_sheared_without_sliding() {
    let relaxed = grainlab_emt::model("relaxed").unwrap();
    let (mut squares, mut inside) = (0.0, 0);
    let samples = csv::samples("locked.csv");
    for sample in &samples {
        let observation = sample.observation(StrainRatioSource::Zero).with_relative_error(0.01);
        let found = relaxed.infer(&observation, ours()).unwrap();
        let sigma = found.stddev(InferredQuantity::Eps).unwrap();
        squares += ((found.structure.get(InferredQuantity::Eps).unwrap() - sample.eps) / sigma).powi(2);
        let [low, high] = found.interval(InferredQuantity::Eps).unwrap();
        inside += usize::from((low..=high).contains(&sample.eps));
    }
    let n = samples.len();
    let rms = (squares / n as f64).sqrt();
    eprintln!("eps of {n} states, q/p -.2 to .3: rms {rms:.2} stated errors; {inside} in the 95 % intervals");
    assert!(inside * 100 >= n * 95, "{inside} of {n}");
}
