//! The page of a series.

use grainlab_emt::{Calibration, SeriesPrior, SeriesRow, SpeedMode, SpeedSeries, infer_series};
use grainlab_report::{InferredSample, series_page};

/// The page of P and S of glass beads at two pressures, with these angles to the axis.
fn page(angles: &[f64]) -> String {
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
    let rows = [1e5, 4e5].into_iter().flat_map(of).collect();
    let series = SpeedSeries::of(rows, grainlab_core::Material::GLASS);
    let network = Calibration::builtin("grainlab").unwrap().network().unwrap();
    let estimate = infer_series(&series, network, SeriesPrior::builtin()).unwrap();
    let (doubts, notes) = (&[][..], &[][..]);
    series_page(&[InferredSample {
        name: "",
        series: &series,
        estimate: &estimate,
        is_contradictory: false,
        doubts,
        notes,
    }])
}

#[test]
fn the_page_of_a_series_has_eps_as_z_in_figure_sentence_and_table() {
    let with = page(&[0.0, std::f64::consts::FRAC_PI_2]);
    for part in ["id=\"plot-eps-0\"", "The anisotropy of the contacts, eps, is 0.0", "sigma of eps"] {
        assert!(with.contains(part), "{part}");
    }
    let without = page(&[0.0]);
    assert!(without.contains("eps, is not determined by them") && !without.contains("id=\"plot-eps-0\""));
}
