//! The table `tests/golden/inversion_errors.csv`: the errors of `relaxed` on every ensemble, and what `relaxed` states of them.
//!
//! `GRAINLAB_WRITE=1 cargo test --release -p grainlab_calibration --test ensembles table` writes the table anew.

use crate::judged::inside;
use crate::left_out::truth;
use crate::{csv, ours};
use grainlab_calibration::CalibrationSample;
use grainlab_core::results::InferredQuantity;
use grainlab_emt::{Estimate, Model, Modulus, Observation, Relaxed, Status, StrainRatioSource};
use grainlab_testkit::Random;
use grainlab_testkit::golden::text;
use std::fmt::Write as _;

const FILE: &str = "inversion_errors.csv";

/// Difference of two numbers of the table that other roundings of a logarithm may make.
const ROUNDING: f64 = 3e-4;

const QUANTITIES: [InferredQuantity; 4] =
    [InferredQuantity::Z, InferredQuantity::K, InferredQuantity::Eps, InferredQuantity::EpsStiffness];

/// The ensembles; `recipes_judged.csv` waits for the scatter that `recipes.csv` chooses.
const SETS: [&str; 7] = ["held_out", "large", "steps", "locked", "wide", "judged", "recipes"];

/// Changes what is known of a state.
type Known = (&'static str, fn(&mut Observation));

const KNOWN: [Known; 5] = [
    ("all", |_| {}),
    ("all but grains", |o| o.grains = None),
    ("all but q/p", |o| o.conditions.stress_ratio = None),
    ("all but sizes", |o| o.conditions.size_spread = None),
    ("pressure and material", |o| {
        o.grains = None;
        o.conditions.stress_ratio = None;
        o.conditions.size_spread = None;
        o.conditions.solid_fraction = None;
    }),
];

/// One line of the table.
#[derive(Default)]
struct Line {
    states: usize,
    answers: usize,
    ok: usize,
    beyond: usize,
    /// Error and stated standard deviation of each quantity in each answer.
    found: [Vec<(f64, f64)>; QUANTITIES.len()],
}

impl Line {
    fn add(&mut self, found: Option<Estimate>, truth: impl Fn(InferredQuantity) -> f64) {
        self.states += 1;
        let Some(found) = found else { return };
        self.answers += 1;
        let mut furthest = 0.0_f64;
        for (all, q) in self.found.iter_mut().zip(QUANTITIES) {
            let (Some(value), Some(stddev)) = (found.structure.get(q), found.stddev(q)) else { continue };
            let truth = truth(q);
            if truth.is_nan() {
                continue;
            }
            furthest = furthest.max(((value - truth) / stddev).abs());
            all.push((value - truth, stddev));
        }
        if found.status == Status::Ok {
            self.ok += 1;
            self.beyond += usize::from(furthest > 3.0);
        }
    }

    fn write(&self, to: &mut String, head: &str) {
        let Self { states, answers, ok, beyond, .. } = self;
        write!(to, "{head},{states},{answers},{ok},{beyond}").unwrap();
        for all in &self.found {
            let mean = |of: &dyn Fn(&(f64, f64)) -> f64| all.iter().map(of).sum::<f64>() / all.len() as f64;
            let (bias, rms) = (mean(&|f| f.0), mean(&|f| f.0 * f.0).sqrt());
            let stated = mean(&|f| f.1 * f.1).sqrt();
            let inside = mean(&|f| f64::from(u8::from(f.0.abs() < 1.96 * f.1)));
            if all.is_empty() {
                to.push_str(",,,,");
            } else {
                write!(to, ",{bias:.4},{rms:.4},{stated:.4},{inside:.3}").unwrap();
            }
        }
        to.push('\n');
    }
}

fn header() -> String {
    let of = |q: InferredQuantity| format!("{q}_bias,{q}_rms,{q}_stated,{q}_inside_95");
    let all = QUANTITIES.map(of).join(",");
    format!("set,error,known,states,answers,ok,ok_beyond_3_sigma,{all}\n")
}

/// The observation of a packing with errors of all moduli of this relative size, stated and made.
fn observed(s: &CalibrationSample, error: f64, random: &mut Random) -> Observation {
    with_errors(s.observation(StrainRatioSource::Zero), error, random)
}

fn with_errors(o: Observation, error: f64, random: &mut Random) -> Observation {
    let mut o = if error > 0.0 { o.with_relative_error(error) } else { o };
    for modulus in Modulus::ALL {
        let by = 1.0 + error * random.normal();
        if let Some(value) = o.moduli.get(modulus) {
            o.moduli = o.moduli.with(modulus, value * by);
        }
    }
    o
}

fn table() -> String {
    let mut all = header();
    for name in SETS {
        let samples: Vec<_> = csv::samples(&format!("{name}.csv"))
            .into_iter()
            .filter(|s| inside(s) && s.preparation != "smooth")
            .collect();
        for error in [0.0, 0.01, 0.03] {
            for (known, forget) in KNOWN {
                let mut random = Random::new(58);
                let mut line = Line::default();
                for s in &samples {
                    let mut o = observed(s, error, &mut random);
                    forget(&mut o);
                    line.add(Relaxed.infer(&o, ours()).ok(), |q| truth(s, q));
                }
                line.write(&mut all, &format!("{name},{error},{known}"));
            }
        }
    }
    for error in [0.0, 0.01] {
        for (name, counted) in
            [("paper rows by k", InferredQuantity::K), ("paper rows by z", InferredQuantity::Z)]
        {
            let mut line = Line::default();
            for (o, k, eps) in csv::paper_rows_known() {
                let o = if error > 0.0 { o.with_relative_error(error) } else { o };
                line.add(Relaxed.infer(&o, ours()).ok(), |q| match q {
                    InferredQuantity::Eps => eps,
                    q if q == counted => k,
                    _ => f64::NAN,
                });
            }
            line.write(&mut all, &format!("{name},{error},all"));
        }
    }
    all
}

#[test]
fn the_stored_table_of_errors_is_that_of_this_version() {
    let found = table();
    if std::env::var_os("GRAINLAB_WRITE").is_some() {
        let golden = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../tests/golden/");
        std::fs::write(format!("{golden}{FILE}"), &found).unwrap();
    }
    let kept = text(FILE);
    assert_eq!(found.lines().count(), kept.lines().count());
    for (found, kept) in found.lines().zip(kept.lines()) {
        for (f, k) in found.split(',').zip(kept.split(',')) {
            let is_alike = match (f.parse::<f64>(), k.parse::<f64>()) {
                // One state may be on the other side of a bound.
                (Ok(f), Ok(k)) if f.fract() == 0.0 && k.fract() == 0.0 => (f - k).abs() <= 1.0,
                (Ok(f), Ok(k)) => (f - k).abs() <= ROUNDING.max(0.005 * k.abs()),
                _ => f == k,
            };
            assert!(is_alike, "{found}\n{kept}");
        }
    }
}
