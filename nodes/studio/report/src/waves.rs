//! Wave speeds of the last packing, where the run has some.

use crate::figure::{PageFigure, number};
use crate::run::Run;
use grainlab_console::{count, fixed};
use grainlab_core::{MeasuredWave, Vec3};
use grainlab_emt::Modulus;
use grainlab_page::html::{Cell, escaped, paragraph, table};
use grainlab_page::plot::{Axis, Entry, Figure, Marker, Point, Series, Strip};
use grainlab_results::AcousticReport;
use std::collections::BTreeSet;
use std::fmt::Write;

/// Most measurements of one packing that are drawn.
const MOST_DRAWN: usize = 8;

/// Modes by particle motion.
const MODES: [&str; 3] = ["P", "S along the axis", "S across it"];

/// Index into [`MODES`].
fn mode(wave: &MeasuredWave, axis: &Vec3) -> usize {
    let (n, u) = (&wave.wave.direction, &wave.wave.polarization);
    match n.dot(u).abs() {
        c if c > 0.7 => 0,
        _ if u.dot(axis).abs() > 0.35 => 1,
        _ => 2,
    }
}

/// Angle between a ray and the axis, degrees, from 0 to 90.
fn angle(wave: &MeasuredWave, axis: &Vec3) -> f64 {
    wave.wave.direction.dot(axis).abs().min(1.0).acos().to_degrees()
}

impl Run {
    /// The section; `None` without wave speeds.
    pub(crate) fn waves(&self) -> Option<String> {
        let state = self.states.iter().rev().find(|s| s.acoustic.is_some())?;
        let stiffness = state.packing.report.stiffness().map(|s| &s.tensor);
        let drawn: String = state
            .acoustics()
            .take(MOST_DRAWN)
            .enumerate()
            .map(|(n, a)| of_measurement(n, a, stiffness))
            .collect();
        let left_out = state.acoustics().skip(MOST_DRAWN).count();
        let note = match left_out {
            0 => String::new(),
            n => {
                paragraph(&format!("{} of this packing more: summary.json has all.", count(n, "measurement")))
            }
        };
        Some(drawn + &note)
    }
}

/// The speeds of one measurement, drawn, and their medium.
fn of_measurement(
    n: usize,
    acoustic: &AcousticReport,
    stiffness: Option<&grainlab_core::Stiffness>,
) -> String {
    let which = acoustic.measurement.as_ref().map_or_else(String::new, |m| format!(", {}", m.label));
    let id = |name: &str| if n == 0 { name.to_owned() } else { format!("{name}-{}", n + 1) };
    let axis = acoustic.medium.axis;
    let speeds = &acoustic.reading.speeds;
    let mut csv = String::from("mode,angle_deg,frequency_hz,speed_m_s,stddev_m_s\n");
    for s in speeds {
        let optional = |v: Option<f64>| v.map(number).unwrap_or_default();
        let _ = writeln!(
            csv,
            "{},{},{},{},{}",
            MODES[mode(s, &axis)],
            number(angle(s, &axis)),
            optional(s.frequency),
            number(s.wave.speed),
            optional(s.wave.stddev)
        );
    }
    let plot = |id: &str, title: &str, x: &str, caption: &str, at: &dyn Fn(&MeasuredWave) -> Option<f64>| {
        let series = |m: usize| Series {
            colour: Some(m),
            marker: Some(Marker::of(m)),
            points: (speeds.iter().filter(|s| mode(s, &axis) == m))
                .filter_map(|s| Some(Point { error: s.wave.stddev, ..Point::at(at(s)?, s.wave.speed) }))
                .collect(),
            ..Series::default()
        };
        let figure = Figure {
            title: title.to_owned(),
            subtitle: String::new(),
            x: Axis::linear(x),
            y: Axis::linear(""),
            series: (0..MODES.len()).map(series).collect(),
            legend: MODES.iter().enumerate().map(|(m, name)| Entry::Colour(m, (*name).to_owned())).collect(),
        };
        PageFigure { id, svg: Strip { figure, ..Strip::default() }.svg(), caption, csv: csv.clone() }.html()
    };
    let by_angle = "By the angle between ray and axis; the bars are standard deviations.";
    let mut figures =
        plot(&id("wave-speeds"), &format!("Wave speeds, m/s{which}"), "angle, degrees", by_angle, &|s| {
            Some(angle(s, &axis))
        });
    // Equal frequencies show no dispersion.
    let frequencies: BTreeSet<u64> = speeds.iter().filter_map(|s| s.frequency).map(f64::to_bits).collect();
    if frequencies.len() > 1 {
        figures += &plot(
            &id("dispersion"),
            &format!("Dispersion: speeds, m/s{which}"),
            "frequency, kHz",
            "By the dominant frequency.",
            &|s| s.frequency.map(|f| f / 1e3),
        );
    }
    format!("<div class=\"grid\">\n{figures}{}</div>\n", medium(acoustic, stiffness))
}

/// Moduli from speeds beside those of the contact network.
fn medium(acoustic: &AcousticReport, stiffness: Option<&grainlab_core::Stiffness>) -> String {
    let t = stiffness.map(|c| c.transverse_isotropy_about(&acoustic.medium.axis));
    let all = [
        ("C33", Modulus::C33, t.map(|t| t.c33)),
        ("C11", Modulus::C11, t.map(|t| t.c11)),
        ("C44 = G13", Modulus::G13, t.map(|t| t.g13)),
        ("C66 = G12", Modulus::G12, t.map(|t| t.g12)),
        ("C13", Modulus::C13, t.map(|t| t.c13)),
        ("Θ", Modulus::Theta, stiffness.map(grainlab_core::Stiffness::bulk_voigt)),
    ];
    let row = |(name, modulus, network): &(&str, Modulus, Option<f64>)| {
        let (value, sigma) = (acoustic.medium.modulus(*modulus), acoustic.medium.stddev(*modulus));
        let mega = |v: Option<f64>| Cell::number(fixed(v.map(|v| v / 1e6), 2));
        let off = value.zip(*network).map(|(v, n)| 100.0 * (v / n - 1.0));
        vec![
            Cell::text(name),
            mega(*network),
            mega(value),
            mega(sigma),
            Cell::number(off.map_or_else(|| "-".into(), |o| format!("{o:+.2} %"))),
        ]
    };
    let rows: Vec<Vec<Cell>> = all.iter().map(row).collect();
    let of = acoustic
        .measurement
        .as_ref()
        .map_or_else(|| "these speeds".to_owned(), |m| format!("the speeds of {}", m.label));
    let caption = escaped(&format!("Moduli, MPa: of the contact network, and of the medium with {of}."));
    table(&caption, &["modulus", "network", "waves", "std. dev.", "difference"], &rows)
}
