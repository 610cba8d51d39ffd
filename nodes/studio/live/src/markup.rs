//! Values of a run as parts of the page, with the names and units of a report.

use crate::laboratory::Laboratory;
use grainlab_console::{count, fixed};
use grainlab_core::results::InferredQuantity;
use grainlab_core::{ComponentControl, SymTensor};
use grainlab_msgs::boundary::StressRequest;
use grainlab_msgs::simulated_seconds;
use grainlab_page::html::{Cell, escaped, paragraph, table};
use grainlab_report::card;
use grainlab_results::brief::moduli;
use grainlab_results::{Inference, by_origin};
use serde_json::json;

const KPA: f64 = 1e-3;

/// A large number in thousands or millions.
fn large(value: f64) -> String {
    match value {
        v if v >= 1e6 => format!("{:.1} <small>million</small>", v / 1e6),
        v if v >= 1e4 => format!("{:.1} <small>thousand</small>", v / 1e3),
        v => format!("{v:.0}"),
    }
}

/// A number with its sign, and none for zero.
fn signed(value: f64, digits: usize) -> String {
    let text = format!("{value:+.digits$}");
    if text.contains(|c: char| c.is_ascii_digit() && c != '0') { text } else { text[1..].to_owned() }
}

/// The mean of the imposed stresses, Pa, where all normal components have one.
fn target_pressure(request: &StressRequest) -> Option<f64> {
    let normal = request.controls.iter().take(3).map(|c| match c {
        ComponentControl::Stress(target) => Some(*target),
        _ => None,
    });
    normal.sum::<Option<f64>>().map(|sum| sum / 3.0)
}

impl Laboratory {
    /// The key values now.
    pub(crate) fn cards(&self) -> String {
        let none = || "–".to_owned();
        let request = self.latest.as_ref();
        let value = |f: &dyn Fn(&StressRequest) -> String| request.map_or_else(none, f);
        let pressure = |r: &StressRequest| r.stress.mean();
        let q = |r: &StressRequest| {
            let p = pressure(r);
            if p > 0.0 { format!("q/p {:.2e}", r.stress.deviatoric_invariant() / p) } else { String::new() }
        };
        let target = request.and_then(target_pressure).map_or_else(
            || request.map_or_else(String::new, q),
            |t| format!("target {:.2} kPa · {}", t * KPA, request.map_or_else(String::new, q)),
        );
        let steps = self.steps.per_second().filter(|_| self.end.is_none());
        let grain_steps = steps.zip(self.grains).map(|(s, n)| s * f64::from(n));
        let phase = self.phase();
        let time = request
            .map_or_else(String::new, |r| format!("{:.4} ms simulated", 1e3 * simulated_seconds(&r.stamp)));
        let step = self.step().map_or_else(String::new, |s| format!("step {s}"));
        let z = self.report.as_ref().map_or_else(String::new, |f| {
            format!("z {:.3} without rattlers, last packing", f.contacts.mechanical_coordination)
        });
        [
            card(
                "p",
                &value(&|r| format!("{:.2} <small>kPa</small>", pressure(r) * KPA)),
                "pressure",
                &target,
            ),
            card("φ", &value(&|r| format!("{:.4}", r.solid_fraction)), "solid fraction", ""),
            card("k", &value(&|r| format!("{:.3}", r.coordination)), "coordination number", &z),
            card(
                "u",
                &value(&|r| format!("{:.1e}", r.unbalanced)),
                "unbalanced force",
                "mean net force over mean contact force",
            ),
            card(
                "phase",
                &phase.map_or_else(none, |n| escaped(&self.timeline.phase_name(n))),
                &phase.map_or_else(String::new, |n| format!("number {n}")),
                &self
                    .state
                    .as_ref()
                    .map_or_else(String::new, |s| format!("{} published", count(s.packings, "packing"))),
            ),
            card(
                "t",
                &request.map_or_else(none, |_| time.replace(" ms simulated", " <small>ms</small>")),
                "simulated time",
                &step,
            ),
            card("steps", &steps.map_or_else(none, large), "per second", ""),
            card("grain-steps", &grain_steps.map_or_else(none, large), "per second", ""),
        ]
        .concat()
    }

    /// Each component with what is imposed on it.
    pub(crate) fn targets(&self) -> String {
        let Some(r) = &self.latest else { return paragraph("No stress has been published yet.") };
        let (stress, strain) = (r.stress.voigt(), r.strain.voigt());
        let row = |n: usize| {
            let (imposed, off) = match r.controls[n] {
                ComponentControl::Held => ("held".to_owned(), String::new()),
                ComponentControl::Stress(t) => {
                    (format!("{:.3} kPa", t * KPA), signed((stress[n] - t) * KPA, 3))
                }
                ComponentControl::StrainRate(rate) => (format!("{rate} 1/s"), String::new()),
            };
            vec![
                Cell::text(SymTensor::COMPONENTS[n]),
                Cell::number(signed(stress[n] * KPA, 3).trim_start_matches('+')),
                Cell::number(imposed),
                Cell::number(off),
                Cell::number(signed(strain[n] * 100.0, 4)),
                Cell::number(format!("{:+.3e}", r.rate[n])),
            ]
        };
        let header = ["", "stress, kPa", "imposed", "off target, kPa", "strain, %", "strain rate, 1/s"];
        table("The servo, now", &header, &(0..6).map(row).collect::<Vec<_>>())
    }

    /// Moduli and microstructure of the last measured packing.
    pub(crate) fn structure(&self) -> String {
        let Some(report) = &self.report else {
            return paragraph("No packing has been measured yet: at the states set in the scene.");
        };
        let (step, (inferred_step, results)) = (report.step, &self.inferred);
        let groups = by_origin(results);
        let best = groups
            .iter()
            .find_map(|(_, results)| Inference::recommended(results))
            .filter(|_| *inferred_step == step);
        let rows: Vec<Vec<Cell>> = InferredQuantity::countable()
            .map(|q| {
                let (counted, digits) = (report.counted(q), q.digits());
                let value = best.and_then(|b| b.values[q]);
                let sigma =
                    best.and_then(|b| b.sigma[q]).map_or_else(String::new, |s| format!("± {s:.digits$}"));
                let error =
                    value.zip(counted).map_or_else(String::new, |(v, c)| format!("{:+.digits$}", v - c));
                let number = |v: Option<f64>| {
                    Cell::number(v.map_or_else(|| "–".to_owned(), |v| format!("{v:.digits$}")))
                };
                vec![
                    Cell::text(q.symbol()),
                    Cell::text(q.meaning()),
                    number(counted),
                    number(value),
                    Cell::number(sigma),
                    Cell::number(error),
                ]
            })
            .collect();
        let which = best.filter(|b| b.measurement.is_some()).and_then(|b| b.origin().data());
        let which = which.map_or_else(String::new, |data| format!(" from {}", escaped(&data)));
        let by = best.map_or_else(String::new, |b| format!(", by model {}{which}", escaped(&b.model)));
        let mut text = table(
            &format!("Packing of step {step}{by}"),
            &["", "", "counted", "inferred", "", "error"],
            &rows,
        );
        if report.stiffness().is_some() {
            let names =
                [("G12", "shear across the axis"), ("G13", "shear along the axis"), ("Θ", "bulk modulus")];
            let rows = names.into_iter().zip(moduli(report)).map(|((name, meaning), value)| {
                vec![Cell::text(name), Cell::text(meaning), Cell::number(fixed(value, 2))]
            });
            text += &table("Moduli", &["", "", "MPa"], &rows.collect::<Vec<_>>());
        }
        format!("<div class=\"grid\">{text}</div>")
    }

    /// The latest request for programs: SI units, Voigt order xx, yy, zz, yz, xz, xy; null where no stress is imposed.
    pub(crate) fn sample(&self) -> String {
        let Some(r) = &self.latest else { return String::new() };
        let targets = r.controls.map(|c| match c {
            ComponentControl::Stress(target) => Some(target),
            _ => None,
        });
        json!({
            "run": self.run.map(|run| run.to_string()), "sequence": r.sequence, "step": r.step, "phase": r.phase,
            "time": simulated_seconds(&r.stamp), "stress": r.stress.voigt(), "target": targets, "strain": r.strain.voigt(),
            "solid_fraction": r.solid_fraction, "coordination": r.coordination, "unbalanced": r.unbalanced,
        })
        .to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::signed;

    #[test]
    fn zero_has_no_sign() {
        let all = [(-1e-9, "0.000"), (1e-9, "0.000"), (-0.5, "-0.500"), (0.5, "+0.500")];
        all.iter().for_each(|(value, text)| assert_eq!(signed(*value, 3), *text));
    }
}
