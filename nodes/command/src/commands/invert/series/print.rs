//! Answers on a series as text and as CSV.

use super::sample::Sample;
use grainlab_console::{CsvText, Table, fixed, wrapped};
use grainlab_core::notes::Status;
use grainlab_emt::{Interval, PressureEstimate, SeriesEstimate, SeriesRow, SpeedMode};
use std::f64::consts::PI;

/// Probability of a contact law from which z under it is said.
pub(super) const LIKELY: f64 = 0.02;

/// Factor of the pressure beyond which a prediction is far from the data.
const FAR: f64 = 3.0;

pub(super) fn number(value: f64, digits: usize) -> String {
    format!("{value:.digits$}")
}

pub(super) fn interval(of: &Interval, digits: usize) -> String {
    format!("{} +- {}", number(of.mean, digits), number(of.stddev, digits))
}

fn ends(of: &Interval, digits: usize) -> String {
    format!("{} to {}", number(of.low, digits), number(of.high, digits))
}

pub(super) fn kilopascals(pascals: f64) -> String {
    let text = format!("{:.4}", pascals / 1e3);
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

pub(super) fn text(sample: &Sample) -> String {
    let e = &sample.estimate;
    let mut out = format!("contact: {}\n", sample.contact);
    if !sample.sample.is_empty() {
        out += &format!("sample: {}\n", sample.sample);
    }
    let has_eps = e.pressures.iter().any(|p| p.eps.is_some());
    let header = ["pressure, kPa", "z", "95 %", "of prior", "eps", "of prior", "eps_stiffness", "p"];
    let mut table = Table::new(header);
    for p in &e.pressures {
        let optional = |of: Option<&Interval>| of.map_or_else(|| "-".to_owned(), |i| interval(i, 4));
        table.row([
            kilopascals(p.pressure),
            interval(&p.z, 2),
            z_ends(p),
            number(p.z.left(), 2),
            optional(p.eps.as_ref()),
            fixed(p.eps.map(|eps| eps.left()), 2),
            optional(p.eps_stiffness.as_ref()),
            fixed(p.p, 3),
        ]);
    }
    out += &format!("\n{}", table.without_empty_columns().text());
    out += &wrapped(
        "",
        "of prior: share of the prior's standard deviation that is left; p: chance of speeds that agree less well with the other pressures, suspicious below 0.01",
    );
    if !has_eps {
        out += &wrapped(
            "",
            "eps is not determined: speeds of one mode in two directions determine it (SV along and across are one modulus)",
        );
    }
    let mut table = Table::new([
        "pressure, kPa",
        "mode",
        "angle, deg",
        "measured, m/s",
        "predicted, m/s",
        "difference, %",
        "",
    ]);
    for ((line, row), of) in sample.lines.iter().zip(&sample.series.rows).zip(&e.rows) {
        let difference = of.left_out.map(|l| 100.0 * l.residual.exp_m1());
        let flag = match (of.left_out, line.speed) {
            (None, None) if is_far(sample, row.pressure) => "predicted, far outside the measured pressures",
            (Some(left), _) if !left.is_inside => "outside 95 %",
            (None, None) => "predicted",
            _ => "",
        };
        table.row([
            kilopascals(row.pressure),
            mode(row).to_owned(),
            fixed(row.angle.map(|a| a * 180.0 / PI), 0),
            fixed(line.speed, 1),
            format!("{} +- {}", number(of.predicted, 1), number(of.stddev, 1)),
            difference.map_or_else(|| "-".to_owned(), |d| format!("{d:+.2}")),
            flag.to_owned(),
        ]);
    }
    let from = if e.pressures.len() > 1 { "pressures" } else { "rows" };
    out +=
        &format!("\nEach speed, predicted from the other {from}:\n{}", table.without_empty_columns().text());
    out +=
        &format!("\nk_t/k_n        {}  ({})\n", interval(&e.stiffness_ratio, 3), ends(&e.stiffness_ratio, 3));
    let [middle, low, high] = [e.level.mean, e.level.low, e.level.high].map(|l| number(l.exp(), 2));
    out += &format!("stiffness      {middle} times that of the law with these grains  ({low} to {high})\n");
    out += &format!(
        "scatter        {} times the stated errors  ({})\n",
        interval(&e.noise, 2),
        ends(&e.noise, 2)
    );
    out += "\nprobability of each contact law\n";
    for law in &e.laws {
        let cross = law.ln_crossover.map_or_else(String::new, |c| {
            let (at, within) = (number(c.mean.exp() / 1e3, 0), number(c.stddev.exp(), 1));
            format!(", its crossover at {at} kPa, within a factor of {within} either way")
        });
        out += &format!("{:<14} {}{cross}\n", law.law.name(), number(law.probability.max(0.0), 3));
    }
    out += "\nprobability of each preparation (simulated: lubricated, moulded, dense by vibration, loose)\n";
    for (name, probability) in &e.preparations {
        out += &format!("{name:<14} {}\n", number(probability.max(0.0), 3));
    }
    out.push('\n');
    out += &z_by_law(e);
    for note in sample.assumed.iter().chain(&sample.doubts).chain(&sample.notes) {
        out += &wrapped("note: ", note);
    }
    out
}

/// z at each pressure under each contact law alone.
fn z_by_law(e: &SeriesEstimate) -> String {
    let likely: Vec<_> = e.laws.iter().filter(|l| l.probability > LIKELY).collect();
    if likely.len() < 2 {
        return String::new();
    }
    let mut table = Table::new(["z, if the law is:"].into_iter().chain(likely.iter().map(|l| l.law.name())));
    for (k, p) in e.pressures.iter().enumerate() {
        let pressure = format!("{} kPa", kilopascals(p.pressure));
        table.row([pressure].into_iter().chain(likely.iter().map(|l| number(l.z[k], 2))));
    }
    table.text() + "\n"
}

pub(super) fn mode(row: &SeriesRow) -> &'static str {
    match row.mode {
        SpeedMode::P => "p",
        SpeedMode::Sv if row.angle.is_none() => "s",
        SpeedMode::Sv => "sv",
        SpeedMode::Sh => "sh",
        SpeedMode::Bulk => "bulk",
    }
}

/// Ends of z, of which those above the highest that is stated are cut.
fn z_ends(p: &PressureEstimate) -> String {
    let is_cut = p.z_beyond > 0.025;
    if is_cut { format!("{} to >6.6", number(p.z.low, 2)) } else { ends(&p.z, 2) }
}

pub(super) fn is_far(sample: &Sample, pressure: f64) -> bool {
    let measured = || sample.series.rows.iter().filter(|r| r.speed.is_some()).map(|r| r.pressure);
    let (low, high) = (measured().fold(f64::INFINITY, f64::min), measured().fold(0.0, f64::max));
    pressure < low / FAR || pressure > high * FAR
}

/// One row for each pressure.
pub(super) fn csv(samples: &[Sample]) -> String {
    let mut text = CsvText::default();
    text.row([
        "sample",
        "pressure_pa",
        "z",
        "z_sigma",
        "z_low",
        "z_high",
        "z_prior_sigma",
        "eps",
        "eps_sigma",
        "eps_prior_sigma",
        "eps_stiffness",
        "eps_stiffness_sigma",
        "p",
        "stiffness_ratio",
        "stiffness_ratio_sigma",
        "p_whole",
        "z_beyond",
        "status",
        "reason",
    ]);
    for sample in samples {
        let e = &sample.estimate;
        for p in &e.pressures {
            text.cell(&sample.sample);
            let pair = |of: Option<Interval>| [of.map(|i| i.mean), of.map(|i| i.stddev)];
            let z = [p.z.mean, p.z.stddev, p.z.low, p.z.high, p.z.prior_stddev].map(Some);
            let rest = [p.p, Some(e.stiffness_ratio.mean), Some(e.stiffness_ratio.stddev), Some(e.p)];
            let eps = pair(p.eps).into_iter().chain([p.eps.map(|i| i.prior_stddev)]);
            let all = z.into_iter().chain(eps).chain(pair(p.eps_stiffness)).chain(rest);
            [Some(p.pressure)].into_iter().chain(all).for_each(|v| text.number(v));
            text.number(Some(p.z_beyond));
            text.cell(status(sample, p).name());
            text.cell(&[&sample.doubts[..], &sample.notes].concat().join("; "));
            text.end();
        }
    }
    text.finish()
}

/// Returns the status of one pressure: the status of the sample, except that a pressure inside the calibration is not extrapolated.
fn status(sample: &Sample, estimate: &PressureEstimate) -> Status {
    let is_inside = sample.status == Status::Extrapolated && estimate.outside.is_none();
    if is_inside { Status::Ok } else { sample.status }
}
