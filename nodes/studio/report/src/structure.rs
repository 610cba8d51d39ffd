//! Orientation of contacts and forces of the last packing, and the sizes of its forces.

use crate::run::Run;
use grainlab_core::results::{FORCE_BIN_WIDTH, ORIENTATION_BINS, PackingReport};
use grainlab_core::{Contact, Vec3};
use grainlab_page::plot::{Axis, Figure, Line, Point, Rose, Series};
use grainlab_page::{Html, csv, figure, grid, html, paragraph, signed, six_digits};

/// Values in the bins of orientation over the mean of all directions, and a of 1 + a (3 x² − 1).
struct Oriented {
    bins: Vec<f64>,
    a: Option<f64>,
}

/// Mean of a force in each bin of x = |n·h|, from x and force of single contacts, and its fit to them by least squares.
fn oriented(forces: impl Iterator<Item = (f64, f64)>) -> Option<Oriented> {
    let (mut sums, mut counts) = ([0.0; ORIENTATION_BINS], [0.0; ORIENTATION_BINS]);
    // Sums of the basis 1, y = 3 x² − 1: the normal equations.
    let [mut n, mut y, mut yy, mut f, mut fy] = [0.0; 5];
    for (x, value) in forces {
        let bin = ((x * ORIENTATION_BINS as f64) as usize).min(ORIENTATION_BINS - 1);
        let basis = 3.0 * x * x - 1.0;
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
    // Over the mean of all directions, not of all contacts, as the curve is.
    let (a, unit) = if a.is_finite() && constant > 0.0 { (Some(a), constant) } else { (None, mean) };
    let bins = sums.iter().zip(counts).map(|(sum, count)| sum / count / unit).collect();
    Some(Oriented { bins, a })
}

/// Contacts of each bin over their mean, and the recorded fit.
fn contacts(report: &PackingReport) -> Option<Oriented> {
    let histogram = &report.fabric.orientation;
    let total: u32 = histogram.contacts.iter().sum();
    let mean = f64::from(total) / ORIENTATION_BINS as f64;
    let bins = histogram.contacts.iter().map(|c| f64::from(*c) / mean).collect();
    (total > 0).then(|| Oriented { bins, a: histogram.contact_fit.as_ref().map(|fit| fit.eps) })
}

fn rose(id: &str, title: &str, caption: &str, colour: usize, found: &Oriented, axis: &Vec3) -> Html {
    let [x, y, z] = [axis.x, axis.y, axis.z];
    let name = if *axis == Vec3::z() { "z".to_owned() } else { format!("({x:.2}, {y:.2}, {z:.2})") };
    let fitted =
        found.a.map_or_else(String::new, |a| format!(" Curve: 1 + a (3 cos² θ − 1), a = {}.", signed(a, 4)));
    let end = |n: usize| (n as f64 / ORIENTATION_BINS as f64).to_string();
    let rows = found.bins.iter().enumerate().map(|(n, value)| [end(n), end(n + 1), six_digits(*value)]);
    let plot = Rose { title: title.to_owned(), bins: found.bins.clone(), curve: found.a, colour, axis: name };
    figure(id, plot.svg(), format!("{caption}{fitted}"), &csv(["x_from", "x_to", "relative"], rows))
}

impl Run {
    pub(crate) fn structure(&self) -> Html {
        let Some(state) = self.last() else { return paragraph("No packing was measured.") };
        let report = &state.packing.report;
        let axis = report.fabric.reference_axis;
        // Forces are only in the packing itself.
        let packing = self.timeline.last.as_ref().filter(|p| p.step == state.packing.step);
        let by_direction = |force: fn(&Contact) -> f64| {
            let of = |c: &Contact| (c.normal.dot(&axis).abs(), force(c));
            packing.and_then(|p| oriented(p.contacts.iter().map(of)))
        };
        let of_contacts = format!(
            "Contacts per solid angle, 1 if isotropic; a by maximum likelihood. ε = {} follows from the fabric tensor instead.",
            signed(report.fabric.contact_anisotropy, 4)
        );
        let found = [
            ("contacts", "Contacts", &*of_contacts, 0, contacts(report)),
            (
                "normal-force",
                "Normal force",
                "Mean over the contacts of a direction, over the mean c of all directions; c and a by least squares over the contacts.",
                2,
                by_direction(|c| c.normal_force),
            ),
            (
                "tangential-force",
                "Tangential force",
                "Mean magnitude, over the mean c of all directions; c and a by least squares over the contacts.",
                3,
                by_direction(|c| c.tangential_force.norm()),
            ),
        ];
        let roses = found.iter().filter_map(|(id, title, caption, colour, found)| {
            Some(rose(&format!("{id}-by-direction"), title, caption, *colour, found.as_ref()?, &axis))
        });
        html!(
            "<div class=\"grid roses\">\n{{ roses }}</div>\n{{ forces }}",
            roses => roses.collect::<Html>(),
            forces => forces(report)
        )
    }
}

fn forces(report: &PackingReport) -> Option<Html> {
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
    let series = |name: &str, colour, line, points| Series {
        name: name.to_owned(),
        colour,
        line,
        points,
        ..Series::default()
    };
    let left = |(f, d): &(f64, f64)| {
        [Point::at(f - 0.5 * FORCE_BIN_WIDTH, *d), Point::at(f + 0.5 * FORCE_BIN_WIDTH, *d)]
    };
    // Empty bins interrupt the line.
    let steps = bins.chunk_by(|a, b| (a.1 > 0.0) == (b.1 > 0.0)).filter(|of| of[0].1 > 0.0);
    let steps = steps.map(|of| series("", Some(0), Some(Line::Straight), of.iter().flat_map(left).collect()));
    let plot = Figure {
        title: "Density of normal forces".into(),
        subtitle: format!(
            "Participation ratio {:.3}, largest force {:.2} times the mean",
            forces.participation_ratio(),
            forces.largest
        ),
        x: Axis::linear("f = F / mean F"),
        y: Axis::log(""),
        series: [series("", None, Some(Line::Faint), exponential.filter(|p| p.y >= 0.5 * least).collect())]
            .into_iter()
            .chain(steps)
            .collect(),
        ..Figure::default()
    };
    let data = csv(["force_over_mean", "density"], bins.iter().map(|(f, d)| [f, d].map(|v| six_digits(*v))));
    let caption = format!(
        "Probability density of F over its mean, {:.3e} N; grey: exponential. Participation ratio {:.3}, largest {:.2}. The last bin holds everything above {}.",
        forces.mean_normal,
        forces.participation_ratio(),
        forces.largest,
        end - FORCE_BIN_WIDTH
    );
    Some(grid(figure("force-distribution", plot.element(), caption, &data)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Contacts that are more frequent along the axis: the mean over contacts is not that over directions.
    #[test]
    fn bins_are_on_the_scale_of_the_curve_however_contacts_are_distributed() {
        let curve = |x: f64| 1.0 + 0.4 * (3.0 * x * x - 1.0);
        let found =
            oriented((0..20_000).map(|n| (f64::from(n) / 20_000.0).sqrt()).map(|x| (x, 3.0 * curve(x))));
        let found = found.unwrap();
        assert!((found.a.unwrap() - 0.4).abs() < 1e-9);
        for (n, bin) in found.bins.iter().enumerate() {
            let middle = (n as f64 + 0.5) / ORIENTATION_BINS as f64;
            assert!((bin - curve(middle)).abs() < 0.02, "{n}: {bin}");
        }
    }
}
