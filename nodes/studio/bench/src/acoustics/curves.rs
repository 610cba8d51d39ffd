//! Dispersion as SVG: decrease of the speed at shorter wavelengths, and the law of the extrapolation.

use grainlab_acoustics::DispersionPoint;
use grainlab_acoustics::{DispersionCurve, Modes, Ray, Survey, dispersion};
use grainlab_console::Failure;
use grainlab_core::{Packing, Vec3};
use grainlab_node_kit::Exit;
use grainlab_page::plot::{self, Axis, Entry, Figure, Line, Marker, Series, Theme};
use std::f64::consts::TAU;

/// Wavelengths shown, mean diameters: down to the shortest ones that propagate.
const SHOWN: [f64; 11] = [20.0, 28.0, 40.0, 56.0, 80.0, 112.0, 160.0, 240.0, 320.0, 480.0, 640.0];

/// A longer wave that certainly propagates, for each of them, mean diameters.
const LONG: f64 = 800.0;

/// The curves of the three rays.
const NAMES: [&str; 9] =
    ["P, e3", "S, e3", "S, e3", "P, e1", "S, e1", "S, e1", "qP, 45°", "qS, 45°", "S, 45°"];

/// The plot of one packing.
pub(super) fn svg(packing: &Packing) -> Result<String, Failure> {
    let invalid = |e: grainlab_acoustics::AcousticsError| Failure::new(Exit::PhysicsInvalid, e.to_string());
    let rays = Survey::Minimal.rays(&Vec3::z(), Modes::All);
    let laws = dispersion::curves(packing, &rays, &dispersion::Settings::default()).map_err(invalid)?;
    let seen = seen(packing, &rays);
    let diameter = 2.0 * packing.radii.iter().sum::<f64>() / packing.grains() as f64;
    Ok(draw(&laws, &seen, diameter))
}

/// Speeds at every wavelength shown, by curve, as far as the packing has propagating modes of that
/// wavelength.
fn seen(packing: &Packing, rays: &[Ray]) -> Vec<Vec<DispersionPoint>> {
    let at = |wavelength: f64| {
        let wavelengths = vec![wavelength, LONG, 2.0 * LONG];
        let settings =
            dispersion::Settings { wavelengths, tolerance: 1e-4, doublings: 0, ..Default::default() };
        dispersion::curves(packing, rays, &settings).ok()
    };
    let all: Vec<Vec<DispersionCurve>> = SHOWN.into_iter().filter_map(at).collect();
    let of = |k: usize| all.iter().filter_map(|curves| curves.get(k)?.points.last().copied()).collect();
    (0..all.first().map_or(0, Vec::len)).map(of).collect()
}

fn draw(laws: &[DispersionCurve], seen: &[Vec<DispersionPoint>], diameter: f64) -> String {
    let (mut series, mut legend) = (Vec::new(), Vec::new());
    for (k, law) in laws.iter().enumerate() {
        let name = NAMES.get(k).copied().unwrap_or("mode");
        let slower = |points: &Vec<DispersionPoint>| {
            let of = |p: &DispersionPoint| {
                let wavelength = TAU / (p.wavenumber * diameter);
                let slower = 1.0 - (p.speed / law.speed).powi(2);
                let tooltip = format!("{name}: {wavelength:.1} diameters, {slower:.2e}");
                plot::Point { tooltip: Some(tooltip), ..plot::Point::at(wavelength, slower) }
            };
            let points = points.iter().map(of).collect();
            Series { colour: Some(k), marker: Some(Marker::Circle), points, ..Series::default() }
        };
        let bent = |wavelength: f64| {
            plot::Point::at(wavelength, law.dispersion_coefficient * (TAU / (wavelength * diameter)).powi(2))
        };
        let points = [SHOWN[0], SHOWN[SHOWN.len() - 1]].map(bent).into();
        series.push(Series { colour: Some(k), line: Some(Line::Straight), points, ..Series::default() });
        series.extend(seen.get(k).map(slower));
        let bend = law.dispersion_coefficient / (diameter * diameter);
        legend.push(Entry::Shape(Marker::Circle, Some(k), false, format!("{name}: b = {bend:.2} D^2")));
    }
    Figure {
        title: "Dispersion of a packing: how much slower shorter waves are".into(),
        subtitle: "points: modes of the frozen network; lines: b q^2, taken from 320 to 1280 diameters"
            .into(),
        x: Axis::log("wavelength, mean grain diameters"),
        y: Axis::log("1 - v^2/v0^2"),
        series,
        legend,
    }
    .svg(Theme::Light)
}
