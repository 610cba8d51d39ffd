//! The page of a series.

use grainlab_emt::{Calibration, SeriesPrior, SeriesRow, SpeedMode, SpeedSeries, infer_series};
use grainlab_report::{InferredSample, series_page};
use std::f64::consts::FRAC_PI_2;

/// The page of P and S of glass beads at these pressures, with these angles to the axis, and a share of z beyond its limit.
fn page(pressures: &[f64], angles: &[f64], (z_beyond, is_contradictory): (f64, bool)) -> String {
    let row = |pressure: f64, mode, angle, speed: f64| SeriesRow {
        pressure,
        density: 1600.0,
        mode,
        angle: Some(angle),
        speed: Some(speed * (pressure / 1e5).powf(0.2)),
        stddev: 0.01,
        common_stddev: 0.0,
    };
    let of = |pressure: f64| {
        let waves = move |angle: &f64| {
            [row(pressure, SpeedMode::P, *angle, 500.0), row(pressure, SpeedMode::Sv, *angle, 310.0)]
        };
        angles.iter().flat_map(waves)
    };
    let rows = pressures.iter().copied().flat_map(of).collect();
    let series = SpeedSeries::of(rows, grainlab_core::Material::GLASS);
    let network = Calibration::builtin("grainlab").unwrap().network().unwrap();
    let mut estimate = infer_series(&series, network, SeriesPrior::builtin()).unwrap();
    estimate.pressures.iter_mut().for_each(|p| p.z_beyond = z_beyond);
    let (doubts, notes) = (&[][..], &[][..]);
    series_page(&[InferredSample {
        name: "",
        series: &series,
        estimate: &estimate,
        is_contradictory,
        doubts,
        notes,
    }])
}

#[test]
fn the_page_of_a_series_has_eps_as_z_in_figure_sentence_and_table() {
    let with = page(&[1e5, 4e5], &[0.0, FRAC_PI_2], (0.0, false));
    let sentence = with.split("The anisotropy of the contacts, eps, is ").nth(1).unwrap();
    assert!(!sentence.starts_with("not determined"), "{}", &sentence[..40]);
    for part in ["id=\"plot-eps-over-pressure\"", "sigma of eps"] {
        assert!(with.contains(part), "{part}");
    }
    let without = page(&[1e5, 4e5], &[0.0], (0.0, false));
    assert!(
        without.contains("eps, is not determined by them")
            && !without.contains("id=\"plot-eps-over-pressure\"")
    );
}

#[test]
fn one_pressure_has_its_interval_as_a_bar_and_its_status_in_the_caption() {
    let one = page(&[1e5], &[0.0, FRAC_PI_2], (0.0, true));
    let z = one.split("id=\"plot-z-over-pressure\"").nth(1).unwrap().split("</figure>").next().unwrap();
    assert_eq!(z.matches(" V ").count(), 1, "{z}");
    assert!(z.contains("The status is contradictory."), "{z}");
    let two = page(&[1e5, 4e5], &[0.0, FRAC_PI_2], (0.0, false));
    assert!(!two.split("id=\"plot-speeds\"").next().unwrap().contains(" V "));
}

#[test]
fn a_z_at_its_limit_has_only_a_lower_end_in_headline_caption_data_and_table() {
    let text = page(&[1e5, 4e5], &[0.0], (0.3, false));
    let stated = text.split(" or more").count() - 1;
    assert_eq!(stated, 8, "two pressures in four places");
    assert!(text.contains(" At 400 kPa z is ") && text.contains("prior_sigma,statement"), "{stated}");
}
