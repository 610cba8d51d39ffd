//! Wave speeds of the last packing, where the run has some.

use crate::run::Run;
use grainlab_console::count;
use grainlab_core::{MeasuredWave, Stiffness, Vec3};
use grainlab_page::plot::{Axis, Figure, Marker, Point, Series};
use grainlab_page::{Cell, Html, csv, figure, grid, paragraph, six_digits, table};
use grainlab_results::AcousticReport;
use std::collections::BTreeSet;

/// Most measurements of one packing that are drawn.
const MOST_DRAWN: usize = 8;

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

/// True for a speed whose standard deviation is above it.
fn is_lost(wave: &MeasuredWave) -> bool {
    wave.wave.stddev.is_some_and(|s| s > wave.wave.speed)
}

impl Run {
    /// The section; `None` without wave speeds.
    pub(crate) fn waves(&self) -> Option<Html> {
        let state = self.states.iter().rev().find(|s| s.acoustic.is_some())?;
        let stiffness = state.packing.report.stiffness().map(|s| &s.tensor);
        let drawn =
            state.acoustics().take(MOST_DRAWN).enumerate().map(|(n, a)| of_measurement(n, a, stiffness));
        let note = match state.acoustics().skip(MOST_DRAWN).count() {
            0 => Html::default(),
            n => {
                paragraph(format!("{} of this packing more: summary.json has all.", count(n, "measurement")))
            }
        };
        Some(drawn.collect::<Html>() + note)
    }
}

fn of_measurement(n: usize, acoustic: &AcousticReport, stiffness: Option<&Stiffness>) -> Html {
    let which = acoustic.measurement.as_ref().map_or_else(String::new, |m| format!(", {}", m.label));
    let axis = acoustic.medium.axis;
    let speeds = &acoustic.reading.speeds;
    let rows = speeds.iter().map(|s| {
        let optional = |v: Option<f64>| v.map(six_digits).unwrap_or_default();
        let [angle, speed] = [angle(s, &axis), s.wave.speed].map(six_digits);
        [MODES[mode(s, &axis)].to_owned(), angle, optional(s.frequency), speed, optional(s.wave.stddev)]
    });
    let data = csv(["mode", "angle_deg", "frequency_hz", "speed_m_s", "stddev_m_s"], rows);
    let plot = |id: &str, title: &str, x: &str, caption: &str, at: &dyn Fn(&MeasuredWave) -> Option<f64>| {
        let series = |m: usize| Series {
            name: MODES[m].to_owned(),
            colour: Some(m),
            marker: Some(Marker::of(m)),
            points: (speeds.iter().filter(|s| mode(s, &axis) == m))
                .filter(|s| !is_lost(s))
                .filter_map(|s| Some(Point { error: s.wave.stddev, ..Point::at(at(s)?, s.wave.speed) }))
                .collect(),
            ..Series::default()
        };
        let plot = Figure {
            title: format!("{title}, m/s{which}"),
            x: Axis::linear(x),
            series: (0..MODES.len()).map(series).collect(),
            ..Figure::default()
        };
        let id = if n == 0 { id.to_owned() } else { format!("{id}-{}", n + 1) };
        figure(&id, plot.element(), caption, &data)
    };
    let lost = match speeds.iter().filter(|s| is_lost(s)).count() {
        0 => String::new(),
        n => format!(" Left out: {} with an error above its value.", count(n, "speed")),
    };
    let by_angle = &format!("By the angle between ray and axis; the bars are standard deviations.{lost}");
    let mut figures =
        plot("wave-speeds", "Wave speeds", "angle, degrees", by_angle, &|s| Some(angle(s, &axis)));
    // Equal frequencies show no dispersion.
    let frequencies: BTreeSet<u64> = speeds.iter().filter_map(|s| s.frequency).map(f64::to_bits).collect();
    if frequencies.len() > 1 {
        let by_frequency = &format!("By the dominant frequency.{lost}");
        figures += plot("dispersion", "Dispersion: speeds", "frequency, kHz", by_frequency, &|s| {
            s.frequency.map(|f| f / 1e3)
        });
    }
    grid(figures + medium(acoustic, stiffness))
}

/// Moduli from speeds compared with those of the contact network.
fn medium(acoustic: &AcousticReport, stiffness: Option<&Stiffness>) -> Html {
    let rows = acoustic.moduli(stiffness).map(|(name, modulus, network)| {
        let (value, sigma) = (acoustic.medium.modulus(modulus), acoustic.medium.stddev(modulus));
        let mega = |v: Option<f64>| Cell::three_digits(v.map(|v| v / 1e6), 2);
        let off = value.zip(network).map(|(v, n)| format!("{:+.2} %", 100.0 * (v / n - 1.0)));
        let off = Cell::number(off.as_deref().unwrap_or("–"));
        [Cell::text(name.replace("Theta", "Θ")), mega(network), mega(value), mega(sigma), off]
    });
    let of = acoustic.measurement.as_ref().map(|m| format!("the speeds of {}", m.label));
    let of = of.as_deref().unwrap_or("these speeds");
    let caption = format!("Moduli, MPa: of the contact network, and of the medium with {of}.");
    table(caption, ["modulus", "network", "waves", "std. dev.", "difference"], rows)
}
