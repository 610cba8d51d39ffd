//! Dispersion as SVG: how much slower than long waves the shorter ones are, and the law of the extrapolation.

use crate::plot::{AXES, Axis, COLOURS, axes, begin, circle, line, text};
use grainlab_acoustics::curve::Point;
use grainlab_acoustics::{Curve, Modes, Ray, Survey, dispersion, standing};
use grainlab_console::Failure;
use grainlab_core::{Packing, Vec3};
use grainlab_node_kit::Exit;
use std::f64::consts::TAU;

/// Wavelengths shown, mean diameters: down to where packings hardly have waves any more.
const SHOWN: [f64; 11] = [20.0, 28.0, 40.0, 56.0, 80.0, 112.0, 160.0, 240.0, 320.0, 480.0, 640.0];

/// A wave that is surely one, beside each of them, mean diameters.
const LONG: f64 = 800.0;

/// The curves of the three rays.
const NAMES: [&str; 9] =
    ["P, e3", "S, e3", "S, e3", "P, e1", "S, e1", "S, e1", "qP, 45°", "qS, 45°", "S, 45°"];

/// The picture of one packing.
pub(super) fn svg(packing: &Packing) -> Result<String, Failure> {
    let invalid = |e: grainlab_acoustics::AcousticsError| Failure::new(Exit::PhysicsInvalid, e.to_string());
    let axis = Vec3::z();
    let rays = Survey::Three.rays(&axis, Modes::All);
    let laws = dispersion::curves(packing, &rays, &dispersion::Settings::default()).map_err(invalid)?;
    let seen = seen(packing, &rays);
    let lattice = Survey::Three.lattice_rays(&packing.cell, &axis, Modes::All);
    let settings = standing::Settings { copies: 12, ..Default::default() };
    let (rung, ..) = standing::curves(packing, &lattice, &settings, &Default::default()).map_err(invalid)?;
    let diameter = 2.0 * packing.radii.iter().sum::<f64>() / packing.grains() as f64;
    Ok(draw(&laws, &seen, &rung, diameter))
}

/// Speeds at every wavelength shown, by curve, where the packing has modes of that length that are waves.
fn seen(packing: &Packing, rays: &[Ray]) -> Vec<Vec<Point>> {
    let at = |wavelength: f64| {
        let wavelengths = vec![wavelength, LONG, 2.0 * LONG];
        let settings = dispersion::Settings { wavelengths, tolerance: 1e-4, ..Default::default() };
        dispersion::curves(packing, rays, &settings).ok()
    };
    let all: Vec<Vec<Curve>> = SHOWN.into_iter().filter_map(at).collect();
    let of = |k: usize| all.iter().filter_map(|curves| curves.get(k)?.points.last().copied()).collect();
    (0..all.first().map_or(0, Vec::len)).map(of).collect()
}

fn draw(laws: &[Curve], seen: &[Vec<Point>], rung: &[Curve], diameter: f64) -> String {
    let slower = |law: &Curve, points: &[Point]| -> Vec<[f64; 2]> {
        let of = |p: &Point| [TAU / (p.wavenumber * diameter), 1.0 - (p.speed / law.speed).powi(2)];
        points.iter().map(of).filter(|[_, y]| *y > 0.0).collect()
    };
    let points: Vec<_> = laws.iter().zip(seen).map(|(law, seen)| slower(law, seen)).collect();
    let rings: Vec<_> = laws.iter().zip(rung).map(|(law, rung)| slower(law, &rung.points)).collect();
    let all = || points.iter().chain(&rings).flatten();
    let (x, y) = (Axis::horizontal(all().map(|p| p[0])), Axis::vertical(all().map(|p| p[1])));
    let mut svg = begin(
        "Dispersion of a packing: how much slower shorter waves are",
        "full: modes of the frozen network; hollow: standing waves of moving grains; lines: b q^2, taken from 160 to 320 diameters",
    );
    axes(&mut svg, (&x, "wavelength, mean grain diameters"), (&y, "1 - v^2/v0^2"));
    let ends = [SHOWN[0], SHOWN[SHOWN.len() - 1]];
    for (k, law) in laws.iter().enumerate() {
        let colour = COLOURS[k % COLOURS.len()];
        let bent = |wavelength: f64| law.bend * (TAU / (wavelength * diameter)).powi(2);
        if law.bend > 0.0 {
            let [from, to] = ends.map(|w| [x.at(w), y.at(bent(w))]);
            line(&mut svg, [from[0], from[1], to[0], to[1]], colour);
        }
        let name = NAMES.get(k).copied().unwrap_or("mode");
        for (set, fill) in [(&points[k], colour), (rings.get(k).unwrap_or(&points[k]), "white")] {
            for [wavelength, slower] in set {
                let title = format!("{name}: {wavelength:.1} diameters, {slower:.2e}");
                circle(&mut svg, [x.at(*wavelength), y.at(*slower)], (colour, fill), &title);
            }
        }
        let at = AXES[2] + 10.0 + 20.0 * k as f64;
        circle(&mut svg, [AXES[1] + 36.0, at - 4.0], (colour, colour), "");
        let bend = law.bend / (diameter * diameter);
        text(&mut svg, AXES[1] + 50.0, at, "start", "", &format!("{name}: b = {bend:.2} D^2"));
    }
    svg + "</svg>\n"
}
