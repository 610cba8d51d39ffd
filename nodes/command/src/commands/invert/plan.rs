//! Errors that planned speeds are expected to have, before any is measured.

use super::args::Args;
use super::speed_table::{SpeedLine, planned};
use grainlab_console::{CsvText, Failure, Format, Table, fixed, input, say};
use grainlab_emt::{
    Calibration, EmtError, SampleQuantity, SeriesPrior, SpeedSeries, series_stddev, simulate_series,
};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

/// Numbers of simulated samples, of the plan and for each comparison.
const SAMPLES: usize = 200;
const COMPARED: usize = 40;

/// Factors of the planned errors that are compared.
const FACTORS: [f64; 5] = [0.25, 0.5, 1.0, 2.0, 4.0];

/// Relative change of a sigma that simulated samples tell from none.
const WORTH: f64 = 0.03;

/// Modes and angles of one more speed, degrees.
const FURTHER: [(&str, Option<f64>); 6] = [
    ("p", Some(0.0)),
    ("p", Some(45.0)),
    ("p", Some(90.0)),
    ("s", Some(0.0)),
    ("sv", Some(45.0)),
    ("sh", Some(90.0)),
];

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Plan {
    pressures: Vec<f64>,
    error: f64,
    #[serde(default)]
    further_pressures: Vec<f64>,
    diameter: Option<f64>,
    roughness: Option<f64>,
    speeds: Vec<Planned>,
    #[serde(default)]
    want: BTreeMap<String, f64>,
}

impl Plan {
    /// Cells of every row. No error depends on the density.
    fn extra(&self) -> [(&'static str, Option<f64>); 3] {
        [("diameter", self.diameter), ("roughness", self.roughness), ("density", Some(1500.0))]
    }
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Planned {
    mode: String,
    angles: Option<Vec<f64>>,
    pressures: Option<Vec<f64>>,
    error: Option<f64>,
}

#[derive(Clone, Debug, Serialize)]
struct Quantity {
    /// Name in `[want]`.
    name: &'static str,
    pressure_pa: Option<f64>,
    prior_sigma: f64,
    /// Root mean square of the standard deviations over the samples, with their 10 and 90 % quantiles.
    sigma: f64,
    low: f64,
    high: f64,
    /// The sigma with the errors of the speeds times the factors of the answer.
    sigma_by_error: Vec<f64>,
}

#[derive(Debug, Serialize)]
struct Further {
    mode: String,
    angle_deg: Option<f64>,
    pressure_pa: f64,
    sigma: Vec<f64>,
}

#[derive(Debug, Serialize)]
struct Answer {
    speeds: usize,
    samples: usize,
    error_factors: [f64; 5],
    quantities: Vec<Quantity>,
    further: Vec<Further>,
    /// Sentences: the best further speed, the errors that are wanted, assumptions.
    notes: Vec<String>,
}

const KINDS: [&str; 5] = ["z", "eps", "eps_stiffness", "stiffness_ratio", "level"];

impl Answer {
    fn places(&self, name: &str) -> Vec<usize> {
        let all = self.quantities.iter().enumerate();
        all.filter(|(_, q)| q.name == name).map(|(k, _)| k).collect()
    }

    /// Relative change of the sigma of a quantity by one more speed, its mean over the pressures.
    fn change(&self, by: &Further, name: &str) -> Option<f64> {
        let of = self.places(name);
        let left = of.iter().map(|k| (by.sigma[*k] / self.quantities[*k].sigma).ln()).sum::<f64>();
        (!of.is_empty()).then(|| (left / of.len() as f64).exp() - 1.0)
    }
}

type Wave = (SpeedLine, f64);

fn waves(plan: &Plan) -> Result<Vec<Wave>, String> {
    let extra = plan.extra();
    for (name, is_empty) in [("pressures", plan.pressures.is_empty()), ("speeds", plan.speeds.is_empty())] {
        if is_empty {
            return Err(format!("{name} is empty"));
        }
    }
    for (name, sigma) in &plan.want {
        if !(KINDS.contains(&name.as_str()) && *sigma > 0.0 && sigma.is_finite()) {
            let kinds = KINDS.join(", ");
            return Err(format!(
                "[want] {name} = {sigma}: a sigma, more than 0, of one of {kinds} is expected"
            ));
        }
    }
    let mut all = Vec::new();
    for (n, of) in plan.speeds.iter().enumerate() {
        let error = of.error.unwrap_or(plan.error);
        if !(1e-5..0.5).contains(&error) {
            return Err(format!("error = {error} must be relative, from 1e-5 to 0.5: 0.01 is one percent"));
        }
        let angles = of.angles.clone().map_or(vec![None], |a| a.into_iter().map(Some).collect());
        for pressure in of.pressures.as_ref().unwrap_or(&plan.pressures) {
            for angle in &angles {
                let line = planned(*pressure, &of.mode, *angle, &extra);
                all.push((line.map_err(|fault| format!("[[speeds]] number {}: {fault}", n + 1))?, error));
            }
        }
    }
    Ok(all)
}

fn further(plan: &Plan, planned_waves: &[Wave]) -> Result<Vec<(Further, Wave)>, String> {
    let extra = plan.extra();
    let has_angle = plan.speeds.iter().any(|s| s.angles.is_some());
    let modes = FURTHER.into_iter().filter(|(_, angle)| has_angle || *angle == Some(0.0));
    let modes: Vec<_> = modes.map(|(mode, angle)| (mode, angle.filter(|_| has_angle))).collect();
    let mut all = Vec::new();
    for pressure in plan.pressures.iter().chain(&plan.further_pressures) {
        for (mode, angle) in &modes {
            let line = planned(*pressure, mode, *angle, &extra)?;
            let is_there = |(l, _): &Wave| l.wave == line.wave && l.pressure_pa == line.pressure_pa;
            if !planned_waves.iter().any(is_there) {
                let mode = (*mode).to_owned();
                let of = Further { mode, angle_deg: *angle, pressure_pa: *pressure, sigma: Vec::new() };
                all.push((of, (line, plan.error)));
            }
        }
    }
    Ok(all)
}

/// Quantities with their standard deviations in the prior, and these in one simulated experiment after another.
type Sigmas = (Vec<SampleQuantity>, Vec<Vec<f64>>);

pub(super) fn run(
    path: &Path,
    args: &Args,
    prior: &SeriesPrior,
    contact: &str,
    format: Format,
) -> Result<(), Failure> {
    let name = path.display();
    let usage = |fault: String| Failure::usage(format!("{name}: {fault}"));
    let text = input::text(path, input::SETTINGS).map_err(Failure::at(path))?;
    let plan: Plan = toml::from_str(&text).map_err(|e| usage(e.to_string()))?;
    let network = Calibration::builtin("grainlab").and_then(|c| c.network.as_ref());
    let network = network.ok_or_else(|| Failure::failed("the built-in calibration has no network"))?;
    let planned_waves = waves(&plan).map_err(usage)?;
    let mut others = further(&plan, &planned_waves).map_err(usage)?;
    let all: Vec<Wave> = planned_waves.iter().cloned().chain(others.iter().map(|(_, w)| w.clone())).collect();
    let lines: Vec<SpeedLine> = all.iter().map(|(line, _)| line.clone()).collect();
    let (whole, assumed) =
        args.series(&lines).map_err(|fault| usage(fault.replace("line 0: column ", "")))?;
    // The sigmas with some of the waves, with the errors times a factor; of these quantities, or of all that the waves determine.
    let wrong = |e: EmtError| usage(e.to_string());
    let sigmas = |chosen: &[usize], factor: f64, samples: usize, of: Option<&[SampleQuantity]>| {
        let mut series = whole.clone();
        series.rows.iter_mut().zip(&all).for_each(|(row, (_, error))| row.stddev = factor * error);
        let one = |seed: usize| {
            let mut made = series.clone();
            simulate_series(&mut made, network, prior, Some(1.0), seed as u64)?;
            let rows = chosen.iter().map(|n| made.rows[*n]).collect();
            let [found, before] = series_stddev(&SpeedSeries { rows, ..made }, network, prior)?;
            let at = |q: &SampleQuantity| found.iter().find(|f| (f.name, f.pressure) == (q.name, q.pressure));
            let found = of.unwrap_or(&before).iter().filter_map(at).map(|f| f.value).collect();
            Ok((before, found))
        };
        let all =
            (0..samples).into_par_iter().map(one).collect::<Result<Vec<_>, EmtError>>().map_err(wrong)?;
        Ok::<Sigmas, Failure>((all[0].0.clone(), all.into_iter().map(|(_, found)| found).collect()))
    };
    let own: Vec<usize> = (0..planned_waves.len()).collect();
    say!("grainlab: contact: {contact}");
    let count = SAMPLES + (FACTORS.len() - 1 + others.len()) * COMPARED;
    say!("grainlab: {count} inversions of simulated samples follow, a minute or more");
    let mut done = 0;
    let mut progress = |samples: usize| {
        done += samples;
        say!("grainlab: {done} of {count} inversions are done");
    };
    let (before, base) = sigmas(&own, 1.0, SAMPLES, None)?;
    progress(SAMPLES);
    // One set of samples, so that ratios have little noise.
    let few = rms(&base[..COMPARED]);
    let scaled = |found: &[Vec<f64>]| -> Vec<f64> {
        rms(found).iter().zip(&few).zip(rms(&base)).map(|((found, few), base)| base * found / few).collect()
    };
    let mut by_error = Vec::new();
    for factor in FACTORS {
        by_error.push(if factor == 1.0 {
            rms(&base)
        } else {
            let found = sigmas(&own, factor, COMPARED, None)?.1;
            progress(COMPARED);
            scaled(&found)
        });
    }
    let quantity = |(k, of): (usize, &SampleQuantity)| {
        let mut each: Vec<f64> = base.iter().map(|s| s[k]).collect();
        each.sort_by(f64::total_cmp);
        Quantity {
            name: of.name,
            pressure_pa: of.pressure,
            prior_sigma: of.value,
            sigma: rms(&base)[k],
            low: each[SAMPLES / 10],
            high: each[SAMPLES - 1 - SAMPLES / 10],
            sigma_by_error: by_error.iter().map(|s| s[k]).collect(),
        }
    };
    let quantities = before.iter().enumerate().map(quantity).collect();
    for (n, (further, _)) in others.iter_mut().enumerate() {
        let with: Vec<usize> = own.iter().copied().chain([own.len() + n]).collect();
        further.sigma = scaled(&sigmas(&with, 1.0, COMPARED, Some(&before))?.1);
        progress(COMPARED);
    }
    let mut answer = Answer {
        speeds: own.len(),
        samples: SAMPLES,
        error_factors: FACTORS,
        quantities,
        further: others.into_iter().map(|(of, _)| of).collect(),
        notes: assumed,
    };
    answer.notes.splice(0..0, sentences(&answer, &plan.want).map_err(usage)?);
    format.print(&answer, || csv(&answer), || table(&answer))
}

/// Root mean square of each quantity.
fn rms(all: &[Vec<f64>]) -> Vec<f64> {
    let mean = |k: usize| all.iter().map(|s| s[k] * s[k]).sum::<f64>() / all.len() as f64;
    (0..all[0].len()).map(|k| mean(k).sqrt()).collect()
}

fn of_wave(of: &Further) -> String {
    let angle = of.angle_deg.map_or(String::new(), |a| format!(" at {a} degrees"));
    format!("{}{angle}, {} kPa", of.mode, of.pressure_pa / 1e3)
}

fn sentences(answer: &Answer, want: &BTreeMap<String, f64>) -> Result<Vec<String>, String> {
    let mut notes = Vec::new();
    for name in KINDS {
        let change = |f: &Further| answer.change(f, name).unwrap_or(0.0);
        let best = answer.further.iter().min_by(|a, b| change(a).total_cmp(&change(b)));
        match best.filter(|_| !answer.places(name).is_empty()) {
            Some(best) if change(best) < -WORTH => notes.push(format!(
                "one more speed helps {name} most at: {} ({:.0} % of its sigma)",
                of_wave(best),
                100.0 * change(best)
            )),
            Some(_) => notes.push(format!("no single speed more lowers the sigma of {name} by 3 %")),
            None => {}
        }
    }
    for (name, sigma) in want {
        let of = answer.places(name);
        if of.is_empty() {
            return Err(format!("[want] {name}: it is determined by angles, which the speeds lack"));
        }
        // The largest factor with which every pressure has the wanted sigma.
        let worst: Vec<f64> = (0..FACTORS.len())
            .map(|f| of.iter().map(|k| answer.quantities[*k].sigma_by_error[f]).fold(0.0, f64::max))
            .collect();
        let at_worst = match of.len() {
            1 => "",
            _ => " at the pressure where it is largest",
        };
        let last = worst.iter().rposition(|s| s <= sigma);
        notes.push(match last {
            None => format!(
                "{name} +- {sigma} is not reached: it would be +- {}{at_worst} with {} of these errors; measure more speeds",
                fixed(Some(worst[0]), 4),
                FACTORS[0]
            ),
            Some(f) if f + 1 == FACTORS.len() => format!("{name} +- {sigma} allows errors of {} times these, or larger ones", FACTORS[f]),
            Some(f) => {
                let part = (sigma / worst[f]).ln() / (worst[f + 1] / worst[f]).ln();
                format!("{name} +- {sigma} allows errors of at most {:.2} times these", FACTORS[f] * (FACTORS[f + 1] / FACTORS[f]).powf(part))
            }
        });
    }
    Ok(notes)
}

fn csv(answer: &Answer) -> String {
    let mut text = CsvText::default();
    text.row(["quantity", "pressure_pa", "prior_sigma", "sigma", "low", "high"]);
    for q in &answer.quantities {
        text.cell(q.name);
        for value in [q.pressure_pa, Some(q.prior_sigma), Some(q.sigma), Some(q.low), Some(q.high)] {
            text.number(value);
        }
        text.end();
    }
    text.finish()
}

fn table(answer: &Answer) -> String {
    let label =
        |q: &Quantity| q.pressure_pa.map_or(q.name.to_owned(), |p| format!("{}, {} kPa", q.name, p / 1e3));
    let number = |v: f64| fixed(Some(v), 3);
    let mut all = Table::new(["sigma of", "prior", "expected", "10 %", "90 %"]);
    let mut errors = Table::new(["errors times", "0.25", "0.5", "1", "2", "4"]);
    for q in &answer.quantities {
        all.row([label(q), number(q.prior_sigma), number(q.sigma), number(q.low), number(q.high)]);
        errors.row([label(q)].into_iter().chain(q.sigma_by_error.iter().map(|s| number(*s))));
    }
    let mut more = Table::new(["one more speed, change of sigma in %"].into_iter().chain(KINDS));
    for f in &answer.further {
        let change = |name| fixed(answer.change(f, name).map(|c| 100.0 * c), 0);
        more.row([of_wave(f)].into_iter().chain(KINDS.map(change)));
    }
    let head =
        format!("{} speeds, in {} simulated samples from the prior\n\n", answer.speeds, answer.samples);
    let notes: String = answer.notes.iter().map(|n| format!("{n}\n")).collect();
    let more = if answer.further.is_empty() { String::new() } else { more.text() + "\n" };
    head + &all.text() + "\n" + &errors.text() + "\n" + &more + &notes
}
