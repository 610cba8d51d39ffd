//! Values of a run as parts of the page, with the names and units of a report.

use crate::laboratory::Laboratory;
use grainlab_console::count;
use grainlab_core::results::InferredQuantity;
use grainlab_core::{ComponentControl, SymTensor};
use grainlab_page::html::{Cell, escaped, paragraph, table};
use grainlab_report::card;
use grainlab_results::{Inference, by_origin};
use grainlab_servo::ServoRequest;
use serde_json::json;

const KPA: f64 = 1e-3;
const MPA: f64 = 1e-6;

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
fn target_pressure(request: &ServoRequest) -> Option<f64> {
    let normal = request.input.controls.iter().take(3).map(|c| match c {
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
        let value = |f: &dyn Fn(&ServoRequest) -> String| request.map_or_else(none, f);
        let pressure = |r: &ServoRequest| r.input.stress.mean();
        let q = |r: &ServoRequest| {
            let p = pressure(r);
            if p > 0.0 {
                format!("q/p {:.2e}", r.input.stress.deviatoric_invariant() / p)
            } else {
                String::new()
            }
        };
        let target = request.and_then(target_pressure).map_or_else(
            || request.map_or_else(String::new, q),
            |t| format!("target {:.2} kPa · {}", t * KPA, request.map_or_else(String::new, q)),
        );
        let steps = self.steps.per_second().filter(|_| self.end.is_none());
        let grain_steps = steps.zip(self.grains).map(|(s, n)| s * f64::from(n));
        let phase = self.phase();
        let time = request.map_or_else(String::new, |r| format!("{:.4} ms simulated", 1e3 * r.time));
        let step = self.step().map_or_else(String::new, |s| format!("step {s}"));
        let z = self.fabric.as_ref().map_or_else(String::new, |(_, f)| {
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
        let (stress, strain) = (r.input.stress.voigt(), r.strain.voigt());
        let row = |n: usize| {
            let (imposed, off) = match r.input.controls[n] {
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
                Cell::number(format!("{:+.3e}", r.input.rate[n])),
            ]
        };
        let header = ["", "stress, kPa", "imposed", "off target, kPa", "strain, %", "strain rate, 1/s"];
        table("The servo, now", &header, &(0..6).map(row).collect::<Vec<_>>())
    }

    /// Moduli and microstructure of the last measured packing.
    pub(crate) fn structure(&self) -> String {
        let Some((step, fabric)) = &self.fabric else {
            return paragraph("No packing has been measured yet: at the states set in the scene.");
        };
        let (inferred_step, results) = &self.inferred;
        let groups = by_origin(results);
        let best = groups
            .iter()
            .find_map(|(_, results)| Inference::recommended(results))
            .filter(|_| inferred_step == step);
        let rows: Vec<Vec<Cell>> = InferredQuantity::countable()
            .map(|q| {
                let (counted, digits) = (q.counted(&fabric.contacts, &fabric.fabric), q.digits());
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
        if let Some((_, m)) = self.moduli.as_ref().filter(|(of, _)| of == step) {
            let names =
                [("G12", "shear across the axis"), ("G13", "shear along the axis"), ("Θ", "bulk modulus")];
            let moduli = names.into_iter().zip([m.g12, m.g13, m.theta]).map(|((name, meaning), value)| {
                let value = value.map_or_else(|| "–".to_owned(), |v| format!("{:.2}", v * MPA));
                vec![Cell::text(name), Cell::text(meaning), Cell::number(value)]
            });
            text += &table("Moduli", &["", "", "MPa"], &moduli.collect::<Vec<_>>());
        }
        format!("<div class=\"grid\">{text}</div>")
    }

    /// The latest request for programs: SI units, Voigt order xx, yy, zz, yz, xz, xy; null where no stress is imposed.
    pub(crate) fn sample(&self) -> String {
        let Some(r) = &self.latest else { return String::new() };
        let targets = r.input.controls.map(|c| match c {
            ComponentControl::Stress(target) => Some(target),
            _ => None,
        });
        json!({
            "run": self.run.map(|run| run.to_string()), "sequence": r.sequence, "step": r.step, "phase": r.phase,
            "time": r.time, "stress": r.input.stress.voigt(), "target": targets, "strain": r.strain.voigt(),
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
