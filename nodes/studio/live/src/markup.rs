//! Values of a run as parts of the page, with the names and units of a report.

use crate::laboratory::Laboratory;
use grainlab_console::count;
use grainlab_core::results::InferredQuantity;
use grainlab_core::{ComponentControl, SymTensor};
use grainlab_page::{Cell, Html, card, finding, fixed, grid, paragraph, signed, table, with_unit};
use grainlab_results::MeasuredPacking;
use grainlab_results::brief::moduli;
use grainlab_results::findings::{Findings, Judged, recommended};
use grainlab_results::read_back::InvertedPacking;
use grainlab_servo::ServoRequest;

pub(crate) const KPA: f64 = 1e-3;

/// A number with three digits; a power of ten only below 1/10,000.
pub(crate) fn three_digits(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let size = value.abs().log10().floor() as i32;
    if size >= -4 {
        return format!("{value:.*}", usize::try_from(2 - size).unwrap_or(0)).replace('-', "−");
    }
    let raised = |c: char| match c {
        '-' => '⁻',
        digit => ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'][digit.to_digit(10).unwrap_or(0) as usize],
    };
    let power: String = size.to_string().chars().map(raised).collect();
    format!("{:.1}·10{power}", value / 10f64.powi(size)).replace('-', "−")
}

/// A large number in thousands or millions.
fn large(value: f64) -> Html {
    match value {
        v if v >= 1e6 => with_unit(fixed(v / 1e6, 1), "million"),
        v if v >= 1e4 => with_unit(fixed(v / 1e3, 1), "thousand"),
        v => fixed(v, 0).into(),
    }
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
    pub(crate) fn cards(&self) -> Html {
        let request = self.latest.as_ref();
        let value = |of: fn(&ServoRequest) -> f64, digits| fixed(request.map(of), digits);
        let ratio = request
            .map(|r| (r.input.stress.mean(), r.input.stress.deviatoric_invariant()))
            .filter(|(p, _)| *p > 0.0);
        let ratio = ratio.map_or_else(String::new, |(p, q)| format!("q/p {}", three_digits(q / p)));
        let target = request.and_then(target_pressure);
        let target = target.map_or_else(String::new, |t| format!("target {} kPa · ", three_digits(t * KPA)));
        let unbalanced = request.map_or_else(|| "–".to_owned(), |r| three_digits(r.unbalanced));
        let pressure = request.map_or_else(|| "–".to_owned(), |r| three_digits(r.input.stress.mean() * KPA));
        let steps = self.steps.per_second().filter(|_| self.end.is_none());
        let grain_steps = steps.zip(self.grains).map(|(s, n)| s * f64::from(n));
        let rate =
            |name, value: Option<f64>| card(name, value.map_or_else(|| "–".into(), large), "per second", "");
        let phase = self.phase();
        let name = phase.map_or_else(|| "–".to_owned(), |n| self.timeline.phase_name(n));
        let number = phase.map_or_else(String::new, |n| format!("number {n}"));
        let published = self.state.as_ref().map(|s| format!("{} published", count(s.packings, "packing")));
        let time = value(|r| 1e3 * r.time, 4);
        let step = self.step().map_or_else(String::new, |s| format!("step {s}"));
        let z = self.report.as_ref().map_or_else(String::new, |f| {
            format!("z {:.3} without rattlers, last packing", f.contacts.mechanical_coordination)
        });
        let all = [
            card("p", with_unit(pressure, "kPa"), "pressure", target + &ratio),
            card("φ", value(|r| r.solid_fraction, 4), "solid fraction", ""),
            card("k", value(|r| r.coordination, 3), "coordination number", z),
            card("u", unbalanced, "unbalanced force", "mean net force over mean contact force"),
            card("phase", name, &number, published.unwrap_or_default()),
            card("t", with_unit(time, "ms"), "simulated time", step),
            rate("steps", steps),
            rate("grain-steps", grain_steps),
        ];
        all.into_iter().collect()
    }

    pub(crate) fn targets(&self) -> Html {
        let Some(r) = &self.latest else { return paragraph("No stress has been published yet.") };
        let (stress, strain) = (r.input.stress.voigt(), r.strain.voigt());
        let is_zero = |n: usize| stress[n].abs() < 0.5 && strain[n].abs() < 5e-7 && r.input.rate[n] == 0.0;
        if (0..6).all(is_zero) {
            return paragraph("The cell is at rest, and no grains press on one another yet.");
        }
        let row = |n: usize| {
            let (imposed, off) = match r.input.controls[n] {
                ComponentControl::Held => ("held".to_owned(), String::new()),
                ComponentControl::Stress(t) => {
                    (format!("{:.3} kPa", t * KPA), signed((stress[n] - t) * KPA, 3))
                }
                ComponentControl::StrainRate(rate) => (format!("{} 1/s", three_digits(rate)), String::new()),
            };
            [
                Cell::text(SymTensor::COMPONENTS[n]),
                Cell::number(three_digits(stress[n] * KPA)),
                Cell::number(imposed),
                Cell::number(off),
                Cell::signed(strain[n] * 100.0, 4),
                Cell::number(three_digits(r.input.rate[n])),
            ]
        };
        let header = ["", "stress, kPa", "imposed", "off target, kPa", "strain, %", "strain rate, 1/s"];
        table("The servo, now", header, (0..6).map(row))
    }

    pub(crate) fn structure(&self) -> Html {
        let Some(report) = &self.report else {
            return paragraph("No packing has been measured yet: at the states set in the scene.");
        };
        let (step, (inferred_step, results)) = (report.step, &self.inferred);
        let results = if *inferred_step == step { results.clone() } else { Vec::new() };
        let packing = MeasuredPacking::new(String::new(), report.clone());
        let state = InvertedPacking { packing, acoustic: None, further_acoustic: Vec::new(), results };
        let best = recommended(&state);
        let judged = best.map_or_else(Vec::new, |best| Judged::of(best, report));
        let rows = InferredQuantity::countable().map(|q| {
            let found = judged.iter().find(|j| j.quantity == q);
            let text = |of: fn(&Judged) -> String| Cell::number(found.map(of).unwrap_or_default());
            let counted = Cell::fixed(report.counted(q), q.digits());
            [
                Cell::text(q.symbol()),
                Cell::text(q.meaning()),
                counted,
                text(Judged::value),
                text(Judged::distance),
            ]
        });
        let Findings { done, found, doubts } = Findings::of(std::slice::from_ref(&state));
        let found = if best.is_some() { finding(&done, &found, &doubts) } else { Html::default() };
        let which = best.filter(|b| b.origin.measurement.is_some()).and_then(|b| b.origin.data());
        let which = which.map_or_else(String::new, |data| format!(" from {data}"));
        let by = best.map_or_else(String::new, |b| format!(", by model {}{which}", b.model));
        let caption = format!("Packing of step {step}{by}");
        let inferred = table(caption, ["", "", "counted", "inferred", "less counted"], rows);
        if report.stiffness().is_none() {
            return found + grid(inferred);
        }
        let names =
            [("G12", "shear across the axis"), ("G13", "shear along the axis"), ("Θ", "bulk modulus")];
        let rows = names.into_iter().zip(moduli(report)).map(|((name, meaning), value)| {
            [Cell::text(name), Cell::text(meaning), Cell::three_digits(value, 2)]
        });
        found + grid(inferred + table("Moduli", ["", "", "MPa"], rows))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_written_as_people_write_them() {
        let values = [0.0, 0.96, -4.0, 2345.6, 1.5e-4, -9.62e-5, 2e-12].map(three_digits);
        assert_eq!(values, ["0", "0.960", "−4.00", "2346", "0.000150", "−9.6·10⁻⁵", "2.0·10⁻¹²"]);
    }
}
