//! Answers on a series as text and as CSV, and the sentences on what they depend on.

use super::super::speed_table::in_radians;
use super::sample::Sample;
use grainlab_console::{CsvText, Table, fixed, wrapped};
use grainlab_core::notes::Status;
use grainlab_emt::{Doubted, Interval, PressureEstimate, SeriesEstimate, SeriesPrior, SeriesRow, SpeedMode};
use std::f64::consts::PI;

/// Share of a posterior at an end of a range from which it is said.
const AT_END: f64 = 0.1;

/// Ratio of the errors of speeds to the stated ones from which it is a reason to doubt.
const NOISY: f64 = 1.5;

/// ln of a stiffness over that of the law from which the material is doubtful.
const FAR_LEVEL: f64 = 1.0;

/// Scatter of speeds over their stated errors below which these hide something.
const QUIET: f64 = 0.7;

/// Effective number of draws below which the stated errors are too small.
const FEW_DRAWS: f64 = 100.0;

/// Probability of a contact law from which z under it is said.
const LIKELY: f64 = 0.02;

/// Factor of the pressure beyond which a prediction is far from the data.
const FAR: f64 = 3.0;

fn number(value: f64, digits: usize) -> String {
    format!("{value:.digits$}")
}

fn interval(of: &Interval, digits: usize) -> String {
    format!("{} +- {}", number(of.mean, digits), number(of.stddev, digits))
}

fn ends(of: &Interval, digits: usize) -> String {
    format!("{} to {}", number(of.low, digits), number(of.high, digits))
}

fn kilopascals(pascals: f64) -> String {
    let text = format!("{:.4}", pascals / 1e3);
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// The answer for people.
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

fn mode(row: &SeriesRow) -> &'static str {
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

/// True for a pressure three times beyond the measured ones.
fn is_far(sample: &Sample, pressure: f64) -> bool {
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

fn chance(p: f64) -> String {
    if p < 1e-4 { "p below 0.0001".to_owned() } else { format!("p {p:.4}") }
}

/// A sentence for each pressure whose speeds contradict the others.
fn contradicting_pressures(e: &SeriesEstimate) -> impl Iterator<Item = String> {
    e.pressures.iter().filter_map(|of| {
        let (at, p) = (kilopascals(of.pressure), of.p.filter(|p| *p < SeriesEstimate::CONTRADICTORY)?);
        Some(format!("the speeds at {at} kPa contradict those at the other pressures ({})", chance(p)))
    })
}

/// Text on the rows that contradict the others.
pub(super) fn contradiction(sample: &Sample) -> String {
    let e = &sample.estimate;
    let of_row = |n: usize| {
        let p = e.rows[n].p.filter(|p| *p < SeriesEstimate::CONTRADICTORY)?;
        let (row, by) = (&sample.series.rows[n], e.rows[n].by_rows?);
        let (speed, predicted) = (row.speed?, row.speed? * (-by.residual).exp());
        Some(format!(
            "line {} ({} at {} kPa: {speed:.1} m/s, {predicted:.1} +- {:.1} by all other rows, {})",
            sample.lines[n].line,
            mode(row),
            kilopascals(row.pressure),
            by.stddev * predicted,
            chance(p)
        ))
    };
    let rows: Vec<String> = (0..e.rows.len()).filter_map(of_row).collect();
    let mut faults = Vec::new();
    if e.p < SeriesEstimate::CONTRADICTORY {
        faults.push(format!("the model does not fit these speeds ({})", chance(e.p)));
    }
    if e.has_far_level() {
        let ratio = number(e.level.mean.exp(), 2);
        faults.push(format!(
            "the stiffness is {ratio} times that of the law: check pressure, material, density and units"
        ));
    }
    if e.has_unequal_twins() {
        let p = chance(e.p_twins.unwrap_or(0.0));
        faults.push(format!(
            "SV along, SV across and SH along the axis are one modulus, and their speeds differ by more than their errors ({p}): check mode and direction"
        ));
    }
    if sample.sensitivity.has_split_moduli() {
        faults.push("the bulk modulus and the shear modulus have no z in common: check the P speeds against the S speeds".to_owned());
    }
    faults.extend(contradicting_pressures(e));
    faults.extend(sample.sensitivity.doubted.iter().filter(|d| d.is_decisive()).map(|d| without(sample, d)));
    if !rows.is_empty() {
        faults.push(format!("furthest from the others: {}", rows.join(", ")));
    }
    faults.join("; ")
}

/// z without rows that the others contradict.
fn without(sample: &Sample, doubted: &Doubted) -> String {
    let row = |n: usize| &sample.series.rows[n];
    let at = kilopascals(row(doubted.rows[0]).pressure);
    let left_out = match &doubted.rows[..] {
        [n] => format!("line {} ({} at {at} kPa)", sample.lines[*n].line, mode(row(*n))),
        _ => format!("the speeds at {at} kPa"),
    };
    let (of, [z, stddev]) = (&sample.estimate.pressures[doubted.place], doubted.z[doubted.place]);
    format!(
        "without {left_out}, z is {z:.2} +- {stddev:.2} at {} kPa, {:.1} stated standard deviations from {}",
        kilopascals(of.pressure),
        doubted.moved.abs(),
        interval(&of.z, 2)
    )
}

/// Sentences on pressures outside the packings of the calibration.
fn outside(sample: &Sample) -> Option<String> {
    let all: Vec<_> = sample.estimate.pressures.iter().filter(|p| p.outside.is_some()).collect();
    let pressures: Vec<String> = all.iter().map(|p| kilopascals(p.pressure)).collect();
    let first = all.first()?.outside.as_ref()?;
    Some(format!("extrapolated at {} kPa: {first}", pressures.join(", ")))
}

/// z at the lowest and the highest pressure, as text.
fn range(values: &[f64]) -> String {
    match values {
        [first, .., last] => format!("{first:.2}, {last:.2}"),
        all => format!("{:.2}", all.first().unwrap_or(&f64::NAN)),
    }
}

/// Pressures, kPa, at which a wave has speeds before and after one at another pressure, in the order of the rows.
fn returns(sample: &Sample) -> Vec<String> {
    let all = sample.lines.iter().zip(&sample.series.rows).filter(|(line, _)| line.speed.is_some());
    let (mut before, mut found): (Vec<_>, Vec<String>) = (Vec::new(), Vec::new());
    for (line, row) in all {
        let of_wave = before.iter().filter(|(wave, _)| *wave == line.wave).map(|(_, pressure)| *pressure);
        let is_back = of_wave.skip_while(|p| *p != row.pressure).any(|p| p != row.pressure);
        let at = kilopascals(row.pressure);
        if is_back && !found.contains(&at) {
            found.push(at);
        }
        before.push((line.wave, row.pressure));
    }
    found
}

/// Reasons to doubt the result, and further sentences: on what is not determined, and what z depends on.
pub(super) fn notes(sample: &Sample, prior: &SeriesPrior, lowest_z: f64) -> [Vec<String>; 2] {
    let (e, s) = (&sample.estimate, &sample.sensitivity);
    let (mut doubts, mut notes) = (Vec::new(), Vec::new());
    if sample.is_contradictory() {
        doubts.push(format!("contradictory: {}", contradiction(sample)));
    }
    if !sample.is_contradictory() {
        doubts.extend(contradicting_pressures(e));
    }
    doubts.extend(outside(sample));
    let others = s.doubted.iter().filter(|d| !sample.is_contradictory() || !d.is_decisive());
    doubts.extend(others.map(|d| without(sample, d)));
    let returns = returns(sample);
    if !returns.is_empty() {
        doubts.push(format!(
            "speeds at {} kPa were measured twice, with other pressures between: states of loading and unloading differ; name them as two samples",
            returns.join(", ")
        ));
    }
    doubts.extend(in_radians(&sample.lines));
    if sample.lines.iter().any(|line| line.pressure_sigma_pa.is_some_and(|sigma| sigma > 0.0)) {
        doubts.push(
            "pressure_sigma_pa was taken as that of a factor of all pressures: an offset of them looks like another contact law, and \
             changes z; invert again with the pressures shifted by it"
                .to_owned(),
        );
    }
    if let Some(difference) = sample.series.unequal_twins() {
        doubts.push(format!(
            "SV along, SV across and SH along the axis are one modulus, and their speeds differ by {:.1} % in every state: check mode and direction",
            100.0 * difference.abs().exp_m1()
        ));
    }
    if e.effective_draws < FEW_DRAWS {
        doubts.push(format!(
            "{:.0} draws represent the posterior, which is too few: the errors are larger than stated",
            e.effective_draws
        ));
    }
    let mut open: Vec<String> = Vec::new();
    let of_z: fn(&PressureEstimate) -> bool = |p| p.z.is_undetermined();
    let of_eps = |p: &PressureEstimate| p.eps.is_some_and(|eps| eps.is_undetermined());
    for (name, is_open) in [("z", of_z), ("eps", of_eps)] {
        let undetermined: Vec<_> = e.pressures.iter().filter(|p| is_open(p)).collect();
        if let (Some(first), Some(last)) = (undetermined.first(), undetermined.last()) {
            let (first, last) = (kilopascals(first.pressure), kilopascals(last.pressure));
            open.push(if first == last {
                format!("{name} at {first} kPa")
            } else {
                format!("{name} from {first} to {last} kPa")
            });
        }
    }
    for (name, of) in [
        ("k_t/k_n", &e.stiffness_ratio),
        ("the stiffness over that of the law", &e.level),
        ("the noise", &e.noise),
    ] {
        if of.is_undetermined() {
            open.push(format!(
                "{name} ({:.0} % of its prior's standard deviation is left)",
                100.0 * of.left()
            ));
        }
    }
    for law in &e.laws {
        let Some(crossover) = law.ln_crossover.filter(|_| law.probability > LIKELY) else { continue };
        if crossover.is_undetermined() || is_far(sample, crossover.mean.exp()) {
            open.push(format!("the crossover of {}", law.law));
        }
    }
    if !open.is_empty() {
        doubts.push(format!("not determined by these data: {}", open.join(", ")));
    }
    let below = prior.lowest_stiffness_ratio;
    let ends = [
        format!("lower limit (the lowest that is assumed, {below})"),
        "upper limit (Mindlin, smooth contacts)".to_owned(),
    ];
    for (at, text) in e.at_ends.iter().zip(ends) {
        if *at > AT_END && prior.mindlin < 1.0 {
            notes.push(format!("k_t/k_n is at its {text} in {:.0} % of the posterior", 100.0 * at));
        }
    }
    if e.noise.mean > 0.8 * prior.noise[1] {
        doubts.push(format!(
            "the model fits these speeds badly: their errors would be {:.1} times the stated ones, and {} is the most that is assumed",
            e.noise.mean, prior.noise[1]
        ));
    } else if e.noise.mean < QUIET {
        notes.push(
            "speeds agree better than their errors: errors common to all rows cannot be seen here; what the scatter leaves of the stated errors \
             counts as common to the rows of a mode and direction"
                .to_owned(),
        );
    } else if e.noise.mean > NOISY {
        doubts.push(format!("the errors of these speeds are {:.1} times the stated ones", e.noise.mean));
    }
    if e.level.mean.abs() > FAR_LEVEL {
        doubts.push(format!(
            "the stiffness is {:.2} times that of the law: check material, density and units",
            e.level.mean.exp()
        ));
    }
    let beyond = e.pressures.iter().map(|p| p.z_beyond).fold(0.0, f64::max);
    if beyond > AT_END {
        doubts.push(format!(
            "up to {:.0} % of the posterior has z above 6.6, beyond the simulated packings: only the lower end of z is known there",
            100.0 * beyond
        ));
    }
    let below = e.pressures.iter().map(|p| p.z_below).fold(0.0, f64::max);
    if below > AT_END {
        doubts.push(format!(
            "up to {:.0} % of the posterior has z below {lowest_z:.2}, below the simulated packings: only the upper end of z is known there",
            100.0 * below
        ));
    }
    if e.pressures.len() > 1 {
        let z: Vec<f64> = e.pressures.iter().map(|p| p.z.mean).collect();
        let growth = |z: &[f64]| z[z.len() - 1] - z[0];
        if growth(&z) * growth(&s.without_slope) <= 0.0 {
            doubts.push(format!(
                "the change of z with pressure follows from the prior: without its slope, z is {} at the lowest and the highest pressure",
                range(&s.without_slope)
            ));
        }
        notes.push(format!(
            "z at the lowest and the highest pressure: {}; if k_t/k_n fell by 10 % per decade of pressure, {}; if it rose so, {}; \
             without the prior's slope of z, {}",
            range(&z),
            range(&s.drifted[0]),
            range(&s.drifted[1]),
            range(&s.without_slope)
        ));
    }
    let has = |p: bool| sample.series.rows.iter().any(|r| r.speed.is_some() && (r.mode == SpeedMode::P) == p);
    if has(true) && has(false) {
        let worst = s.bulk_less_shear.iter().map(|[d, sd]| d.abs() / sd).fold(0.0, f64::max);
        let text = format!(
            "z of the bulk modulus and z of the shear modulus differ by {worst:.1} standard deviations where they differ most"
        );
        if worst >= 3.0 {
            doubts.push(text + ": they contradict each other");
        } else {
            notes.push(text + " (3 or more would be a contradiction)");
        }
    }
    if has(true) != has(false) {
        doubts.push("only one mode was measured: z follows from its level and its growth with pressure, which contacts and preparation change too, and no other mode tests it".to_owned());
    }
    notes.push("errors of the grain modulus and the density, and rounder or sharper grains, would look the same as this stiffness".to_owned());
    notes.push("isotropic stress is assumed; validated on simulated spheres; on samples, predictions of speeds were tested, and z was not".to_owned());
    [doubts, notes]
}
