//! Real samples: what is predicted is measured, and what contradicts is said.

use grainlab_emt::{
    Calibration, RelaxationCalibration, Sensitivity, SeriesEstimate, SeriesPrior, SpeedMode, SpeedSeries,
    infer_series,
};
use grainlab_verify::laboratory::samples;

/// The pressure of Domenico's pair with K/G .70, Pa.
const PAIR: f64 = 2.758e6;

fn network() -> &'static RelaxationCalibration {
    Calibration::builtin("grainlab").unwrap().network.as_ref().unwrap()
}

fn sample(name: &str) -> SpeedSeries {
    samples().unwrap().into_iter().find(|(of, ..)| of == name).unwrap().2
}

fn inferred(series: &SpeedSeries) -> SeriesEstimate {
    infer_series(series, network(), SeriesPrior::builtin()).unwrap()
}

fn rms(found: &SeriesEstimate, series: &SpeedSeries, used: impl Fn(f64) -> bool) -> f64 {
    let rows = found.rows.iter().zip(&series.rows).filter(|(_, row)| used(row.pressure));
    let squares: Vec<f64> = rows.map(|(to, _)| to.left_out.unwrap().residual.powi(2)).collect();
    (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}

#[test]
fn each_pressure_of_a_sand_is_predicted_from_the_others_within_its_interval() {
    let sand = sample("dry");
    let found = inferred(&sand);
    let inside = found.rows.iter().filter(|r| r.left_out.unwrap().is_inside).count();
    println!("sand: rms {:.4}, inside {inside} of {}", rms(&found, &sand, |_| true), sand.rows.len());
    assert!(rms(&found, &sand, |_| true) < 0.02 && 10 * inside >= 9 * sand.rows.len(), "{inside}");
    assert!(!found.is_contradictory(), "{}", found.p);
}

#[test]
fn speeds_that_no_packing_has_are_contradictory_alone_and_flagged_in_their_series() {
    let beads = sample("beads");
    let of_pair = |p: f64| (p - PAIR).abs() < 1e3;
    let found = inferred(&beads);
    let flagged = found.pressures.iter().filter(|p| p.p.unwrap() < SeriesEstimate::CONTRADICTORY);
    let flagged: Vec<f64> = flagged.map(|p| p.pressure).collect();
    println!("beads: rms {:.4}, flagged {flagged:?}, p {}", rms(&found, &beads, |p| !of_pair(p)), found.p);
    assert!(flagged.iter().any(|p| of_pair(*p)) && flagged.len() <= 2, "{flagged:?}");
    assert!(!found.is_contradictory(), "{}", found.p);
    let alone = |pressure: f64| {
        let mut alone = beads.clone();
        alone.rows.retain(|r| (r.pressure - pressure).abs() < 1e3);
        inferred(&alone)
    };
    let pair = alone(PAIR);
    println!("pair: p {} of rows {:?}", pair.p, pair.rows.iter().map(|r| r.p).collect::<Vec<_>>());
    assert!(
        pair.is_contradictory() && pair.rows.iter().all(|r| r.p.unwrap() < SeriesEstimate::CONTRADICTORY)
    );
    let has_both = |p: &f64| beads.rows.iter().filter(|r| (r.pressure - p).abs() < 1e3).count() == 2;
    for p in found.pressures.iter().map(|p| p.pressure).filter(|p| !of_pair(*p) && has_both(p)) {
        let other = alone(p);
        assert!(!other.is_contradictory(), "{p}");
    }
}

#[test]
fn bulk_and_shear_modulus_of_real_samples_have_one_coordination_number() {
    for (name, _, series) in samples().unwrap() {
        if !series.rows.iter().any(|r| r.mode == SpeedMode::P) {
            continue;
        }
        let estimate = inferred(&series);
        let found = Sensitivity::of(&estimate, &series, network(), SeriesPrior::builtin()).unwrap();
        for [difference, stddev] in found.bulk_less_shear {
            assert!(difference.abs() < 2.5 * stddev, "{name}: {difference} +- {stddev}");
        }
        assert!(estimate.pressures.iter().all(|p| p.z.high <= 6.6), "{name}");
    }
}

/// The speeds of the beads are off by 1.9 % and 1.5 % in sum: a tolerance of 2 % would be one that was set at the result.
#[test]
fn the_tolerance_of_speeds_that_are_left_out_is_their_stated_error() {
    let rows = grainlab_verify::laboratory::rows().unwrap();
    let of_beads: Vec<_> =
        rows.iter().filter(|row| row.name.ends_with("of beads, each pressure left out")).collect();
    assert_eq!(of_beads.len(), 2);
    for row in of_beads {
        assert!((row.tolerance - 0.01).abs() < 1e-4 && row.difference() > Some(row.tolerance), "{row:?}");
        assert_eq!(row.verdict(), grainlab_verify::Verdict::Differs);
    }
}
