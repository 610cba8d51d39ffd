//! Sentences on a series: reasons to doubt it, what is not determined, and what z depends on.

use super::super::speed_table::in_radians;
use super::print::{interval, is_far, kilopascals, mode, number};
use super::sample::Sample;
use grainlab_emt::{Doubted, PressureEstimate, SeriesEstimate, SeriesPrior, SpeedMode};

/// Posterior share at an end of a range that is reported.
const SHARE_AT_END: f64 = 0.1;

/// Ratio of the errors of speeds to the stated ones from which it is a reason to doubt.
const NOISE_TOO_LARGE: f64 = 1.5;

/// Ratio of the scatter of speeds to their stated errors below which the errors hide something.
const NOISE_TOO_SMALL: f64 = 0.7;

/// Ratio of noise to the largest assumed noise above which the model fits badly.
const NOISE_AT_LIMIT: f64 = 0.8;

/// |ln| of a stiffness over the stiffness of the law from which the material is doubtful.
const LEVEL_TOO_FAR: f64 = 1.0;

/// Effective number of draws below which the stated errors are too small.
const DRAWS_TOO_FEW: f64 = 100.0;

/// Standard deviations between z of the bulk modulus and z of the shear modulus that are a contradiction.
const MODULI_APART: f64 = 3.0;

#[derive(Default)]
struct Sentences {
    doubts: Vec<String>,
    remarks: Vec<String>,
}

/// Returns the reasons to doubt the result, and remarks on what it depends on.
pub(super) fn sentences(sample: &Sample, prior: &SeriesPrior, lowest_z: f64) -> [Vec<String>; 2] {
    let mut all = Sentences::default();
    all.on_contradictions(sample);
    all.on_measurement(sample);
    all.on_open_quantities(sample);
    all.on_contacts(sample, prior);
    all.on_range_of_z(sample, lowest_z);
    all.on_pressures(sample);
    all.on_modes(sample);
    all.remark("errors of the grain modulus and the density, and rounder or sharper grains, would look the same as this stiffness");
    all.remark("isotropic stress is assumed; validated on simulated spheres; on samples, predictions of speeds were tested, and z was not");
    [all.doubts, all.remarks]
}

impl Sentences {
    fn doubt(&mut self, text: impl Into<String>) {
        self.doubts.push(text.into());
    }

    fn remark(&mut self, text: impl Into<String>) {
        self.remarks.push(text.into());
    }

    fn on_contradictions(&mut self, sample: &Sample) {
        let is_contradictory = sample.is_contradictory();
        if is_contradictory {
            self.doubt(format!("contradictory: {}", contradiction(sample)));
        } else {
            self.doubts.extend(contradicting_pressures(&sample.estimate));
        }
        self.doubts.extend(outside(sample));
        let others = sample.sensitivity.doubted.iter().filter(|d| !is_contradictory || !d.is_decisive());
        self.doubts.extend(others.map(|doubted| without(sample, doubted)));
    }

    /// How the speeds were measured, and how well the posterior is known.
    fn on_measurement(&mut self, sample: &Sample) {
        let returns = returns(sample);
        if !returns.is_empty() {
            self.doubt(format!(
                "speeds at {} kPa were measured twice, with other pressures between: states of loading and unloading differ; name them as two samples",
                returns.join(", ")
            ));
        }
        self.doubts.extend(in_radians(&sample.lines));
        if sample.lines.iter().any(|line| line.pressure_sigma_pa.is_some_and(|sigma| sigma > 0.0)) {
            self.doubt(
                "pressure_sigma_pa was taken as the error of one factor of all pressures: an offset of all pressures looks like another contact \
                 law, and changes z; invert again with the pressures shifted by the offset",
            );
        }
        if let Some(difference) = sample.series.unequal_twins() {
            self.doubt(format!(
                "SV along, SV across and SH along the axis are one modulus, and their speeds differ by {:.1} % in every state: check mode and direction",
                100.0 * difference.abs().exp_m1()
            ));
        }
        let draws = sample.estimate.effective_draws;
        if draws < DRAWS_TOO_FEW {
            self.doubt(format!(
                "{draws:.0} draws represent the posterior, which is too few: the errors are larger than stated"
            ));
        }
    }

    fn on_open_quantities(&mut self, sample: &Sample) {
        let e = &sample.estimate;
        let of_z: fn(&PressureEstimate) -> bool = |p| p.z.is_undetermined();
        let of_eps = |p: &PressureEstimate| p.eps.is_some_and(|eps| eps.is_undetermined());
        let mut open: Vec<String> = Vec::new();
        for (name, is_open) in [("z", of_z), ("eps", of_eps)] {
            let all: Vec<_> =
                e.pressures.iter().filter(|p| is_open(p)).map(|p| kilopascals(p.pressure)).collect();
            open.extend(match &all[..] {
                [] => None,
                [first, .., last] if first != last => Some(format!("{name} from {first} to {last} kPa")),
                [first, ..] => Some(format!("{name} at {first} kPa")),
            });
        }
        for (name, quantity) in [
            ("k_t/k_n", &e.stiffness_ratio),
            ("the stiffness divided by the stiffness of the law", &e.level),
            ("the noise", &e.noise),
        ] {
            if quantity.is_undetermined() {
                let left = 100.0 * quantity.left();
                open.push(format!("{name} ({left:.0} % of its prior's standard deviation is left)"));
            }
        }
        for law in &e.laws {
            let Some(crossover) = law.ln_crossover.filter(|_| law.probability > super::print::LIKELY) else {
                continue;
            };
            if crossover.is_undetermined() || is_far(sample, crossover.mean.exp()) {
                open.push(format!("the crossover of {}", law.law));
            }
        }
        if !open.is_empty() {
            self.doubt(format!("not determined by these data: {}", open.join(", ")));
        }
    }

    /// Ends of k_t/k_n, noise and level.
    fn on_contacts(&mut self, sample: &Sample, prior: &SeriesPrior) {
        let e = &sample.estimate;
        let ends = [
            format!("lower limit (the lowest that is assumed, {})", prior.lowest_stiffness_ratio),
            "upper limit (Mindlin, smooth contacts)".to_owned(),
        ];
        for (share, end) in e.at_ends.iter().zip(ends) {
            if *share > SHARE_AT_END && prior.mindlin < 1.0 {
                self.remark(format!("k_t/k_n is at its {end} in {:.0} % of the posterior", 100.0 * share));
            }
        }
        if e.noise.mean > NOISE_AT_LIMIT * prior.noise[1] {
            self.doubt(format!(
                "the model fits these speeds badly: their errors would be {:.1} times the stated ones, and {} is the most that is assumed",
                e.noise.mean, prior.noise[1]
            ));
        } else if e.noise.mean < NOISE_TOO_SMALL {
            self.remark(
                "speeds agree better than their errors: errors common to all rows cannot be seen here; what the scatter leaves of the stated errors \
                 counts as common to the rows of a mode and direction",
            );
        } else if e.noise.mean > NOISE_TOO_LARGE {
            self.doubt(format!("the errors of these speeds are {:.1} times the stated ones", e.noise.mean));
        }
        if e.level.mean.abs() > LEVEL_TOO_FAR {
            self.doubt(format!(
                "the stiffness is {:.2} times the stiffness of the law: check material, density and units",
                e.level.mean.exp()
            ));
        }
    }

    fn on_range_of_z(&mut self, sample: &Sample, lowest_z: f64) {
        let largest = |share: fn(&PressureEstimate) -> f64| {
            sample.estimate.pressures.iter().map(share).fold(0.0, f64::max)
        };
        let (above, below) = (largest(|p| p.z_beyond), largest(|p| p.z_below));
        if above > SHARE_AT_END {
            self.doubt(format!(
                "up to {:.0} % of the posterior has z above 6.6, beyond the simulated packings: only the lower end of z is known there",
                100.0 * above
            ));
        }
        if below > SHARE_AT_END {
            self.doubt(format!(
                "up to {:.0} % of the posterior has z below {lowest_z:.2}, below the simulated packings: only the upper end of z is known there",
                100.0 * below
            ));
        }
    }

    /// What the growth of z with pressure depends on.
    fn on_pressures(&mut self, sample: &Sample) {
        let (e, s) = (&sample.estimate, &sample.sensitivity);
        if e.pressures.len() < 2 {
            return;
        }
        let z: Vec<f64> = e.pressures.iter().map(|p| p.z.mean).collect();
        let growth = |z: &[f64]| z[z.len() - 1] - z[0];
        if growth(&z) * growth(&s.without_slope) <= 0.0 {
            self.doubt(format!(
                "the change of z with pressure follows from the prior: without its slope, z is {} at the lowest and the highest pressure",
                range(&s.without_slope)
            ));
        }
        self.remark(format!(
            "z at the lowest and the highest pressure: {}; if k_t/k_n fell by 10 % per decade of pressure, {}; if it rose so, {}; \
             without the prior's slope of z, {}",
            range(&z),
            range(&s.drifted[0]),
            range(&s.drifted[1]),
            range(&s.without_slope)
        ));
    }

    fn on_modes(&mut self, sample: &Sample) {
        let measured = |is_p: bool| {
            sample.series.rows.iter().any(|r| r.speed.is_some() && (r.mode == SpeedMode::P) == is_p)
        };
        if measured(true) != measured(false) {
            self.doubt("only one mode was measured: z follows from its level and its growth with pressure, which contacts and preparation change too, and no other mode tests it");
        } else if measured(true) {
            let sigmas = sample.sensitivity.bulk_less_shear.iter().map(|[d, stddev]| d.abs() / stddev);
            let worst = sigmas.fold(0.0, f64::max);
            let text = format!(
                "z of the bulk modulus and z of the shear modulus differ by {worst:.1} standard deviations where they differ most"
            );
            if worst >= MODULI_APART {
                self.doubt(text + ": they contradict each other");
            } else {
                self.remark(text + " (3 or more would be a contradiction)");
            }
        }
    }
}

fn chance(p: f64) -> String {
    if p < 1e-4 { "p below 0.0001".to_owned() } else { format!("p {p:.4}") }
}

fn contradicting_pressures(e: &SeriesEstimate) -> impl Iterator<Item = String> {
    e.pressures.iter().filter_map(|of| {
        let (at, p) = (kilopascals(of.pressure), of.p.filter(|p| *p < SeriesEstimate::CONTRADICTORY)?);
        Some(format!("the speeds at {at} kPa contradict those at the other pressures ({})", chance(p)))
    })
}

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
            "the stiffness is {ratio} times the stiffness of the law: check pressure, material, density and units"
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
