//! How contacts and forces of the last packing are oriented, and how large its forces are.

use crate::figure::{PageFigure, number};
use crate::run::Run;
use grainlab_core::results::{FORCE_BIN_WIDTH, ORIENTATION_BINS, PackingReport};
use grainlab_core::{Packing, Vec3};
use grainlab_page::html::paragraph;
use grainlab_page::plot::{Axis, Entry, Figure, Line, Point, Rose, Series, Strip};
use std::fmt::Write;

/// Values in the bins of orientation over their mean, and a of 1 + a (3 x² − 1).
struct Oriented {
    bins: Vec<f64>,
    a: Option<f64>,
}

/// Mean of a force of the contacts in each bin of x = |n·h|, and its fit to single contacts by least squares.
fn oriented(
    packing: &Packing,
    axis: &Vec3,
    force: impl Fn(&grainlab_core::Contact) -> f64,
) -> Option<Oriented> {
    let (mut sums, mut counts) = ([0.0; ORIENTATION_BINS], [0.0; ORIENTATION_BINS]);
    // Sums of the basis 1, y = 3 x² − 1: the normal equations.
    let [mut n, mut y, mut yy, mut f, mut fy] = [0.0; 5];
    for contact in &packing.contacts {
        let x = contact.normal.dot(axis).abs();
        let bin = ((x * ORIENTATION_BINS as f64) as usize).min(ORIENTATION_BINS - 1);
        let (value, basis) = (force(contact), 3.0 * x * x - 1.0);
        sums[bin] += value;
        counts[bin] += 1.0;
        n += 1.0;
        y += basis;
        yy += basis * basis;
        f += value;
        fy += value * basis;
    }
    let determinant = n * yy - y * y;
    let mean = f / n;
    if n < 3.0 || mean <= 0.0 || mean.is_nan() {
        return None;
    }
    let (constant, slope) = ((f * yy - y * fy) / determinant, (n * fy - y * f) / determinant);
    let a = slope / constant;
    let bins = sums.iter().zip(counts).map(|(sum, count)| sum / count / mean).collect();
    Some(Oriented { bins, a: a.is_finite().then_some(a) })
}

/// Contacts of each bin over their mean, and the recorded fit.
fn contacts(report: &PackingReport) -> Option<Oriented> {
    let histogram = &report.fabric.orientation;
    let total: u32 = histogram.contacts.iter().sum();
    let mean = f64::from(total) / ORIENTATION_BINS as f64;
    let bins = histogram.contacts.iter().map(|c| f64::from(*c) / mean).collect();
    (total > 0).then(|| Oriented { bins, a: histogram.contact_fit.as_ref().map(|fit| fit.eps) })
}

fn rose(
    id: &'static str,
    title: &str,
    caption: &str,
    colour: usize,
    found: &Oriented,
    axis: &Vec3,
) -> String {
    let [x, y, z] = [axis.x, axis.y, axis.z];
    let name = if *axis == Vec3::z() { "z".to_owned() } else { format!("({x:.2}, {y:.2}, {z:.2})") };
    let fitted = found.a.map_or_else(String::new, |a| format!(" Curve: 1 + a (3 cos² θ − 1), a = {a:+.4}."));
    let mut csv = String::from("x_from,x_to,relative\n");
    for (n, value) in found.bins.iter().enumerate() {
        let end = |n: usize| n as f64 / ORIENTATION_BINS as f64;
        let _ = writeln!(csv, "{},{},{}", end(n), end(n + 1), number(*value));
    }
    let svg =
        Rose { title: title.to_owned(), bins: found.bins.clone(), curve: found.a, colour, axis: name }.svg();
    PageFigure { id, svg, caption: &format!("{caption}{fitted}"), csv }.html()
}

impl Run {
    /// Roses and the distribution of forces.
    pub(crate) fn structure(&self) -> String {
        let Some(state) = self.last() else { return paragraph("No packing was measured.") };
        let report = &state.packing.report;
        let axis = report.fabric.reference_axis;
        // Forces are only in the packing itself.
        let packing = self.timeline.last.as_ref().filter(|p| p.step == state.packing.step);
        let mut text = String::from("<div class=\"grid roses\">\n");
        if let Some(found) = contacts(report) {
            text += &rose(
                "contacts-by-direction",
                "Contacts",
                "Contacts per solid angle, 1 if isotropic.",
                0,
                &found,
                &axis,
            );
        }
        if let Some(found) = packing.and_then(|p| oriented(p, &axis, |c| c.normal_force)) {
            text += &rose(
                "normal-force-by-direction",
                "Normal force",
                "Mean over contacts of a direction, over that of all.",
                2,
                &found,
                &axis,
            );
        }
        if let Some(found) = packing.and_then(|p| oriented(p, &axis, |c| c.tangential_force.norm())) {
            text += &rose(
                "tangential-force-by-direction",
                "Tangential force",
                "Mean magnitude, over that of all contacts.",
                3,
                &found,
                &axis,
            );
        }
        text += "</div>\n";
        if let Some(forces) = forces(report) {
            text += &forces;
        }
        text
    }
}

/// The distribution of normal forces.
fn forces(report: &PackingReport) -> Option<String> {
    let forces = report.contacts.forces.as_ref()?;
    let total: u32 = forces.histogram.iter().sum();
    let density = |n: u32| f64::from(n) / f64::from(total) / FORCE_BIN_WIDTH;
    let bins: Vec<(f64, f64)> = forces
        .histogram
        .iter()
        .enumerate()
        .map(|(b, n)| ((b as f64 + 0.5) * FORCE_BIN_WIDTH, density(*n)))
        .collect();
    let end = bins.len() as f64 * FORCE_BIN_WIDTH;
    let least = bins.iter().map(|b| b.1).filter(|d| *d > 0.0).fold(1.0, f64::min);
    let exponential = (0..=100).map(|n| end * f64::from(n) / 100.0).map(|f| Point::at(f, (-f).exp()));
    let series = |colour, line, points| Series { colour, line, points, ..Series::default() };
    let left = |(f, d): &(f64, f64)| {
        [Point::at(f - 0.5 * FORCE_BIN_WIDTH, *d), Point::at(f + 0.5 * FORCE_BIN_WIDTH, *d)]
    };
    let figure = Figure {
        title: "Normal forces".into(),
        subtitle: format!(
            "Participation ratio {:.3}, largest force {:.2} times the mean",
            forces.participation_ratio(),
            forces.largest
        ),
        x: Axis::linear("f = F / mean F"),
        y: Axis::log(""),
        series: vec![
            series(None, Some(Line::Faint), exponential.filter(|p| p.y >= 0.5 * least).collect()),
            series(Some(0), Some(Line::Straight), bins.iter().filter(|b| b.1 > 0.0).flat_map(left).collect()),
        ],
        legend: vec![Entry::Colour(0, "density of f".into())],
    };
    let mut csv = String::from("force_over_mean,density\n");
    bins.iter().for_each(|(f, d)| _ = writeln!(csv, "{},{}", number(*f), number(*d)));
    let caption = format!(
        "Probability density of F over its mean, {:.3e} N; grey: exponential. Participation ratio {:.3}, largest {:.2}. The last bin has no upper end.",
        forces.mean_normal,
        forces.participation_ratio(),
        forces.largest
    );
    let svg = Strip { figure, ..Strip::default() }.svg();
    Some(format!(
        "<div class=\"grid\">{}</div>\n",
        PageFigure { id: "force-distribution", svg, caption: &caption, csv }.html()
    ))
}
