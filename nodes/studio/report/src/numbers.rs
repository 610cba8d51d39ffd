//! Numbers of runs: the columns of their table.

use crate::outliers::Outliers;
use crate::run::Run;
use crate::settings::keys;
use grainlab_console::decimals_of;
use grainlab_core::results::InferredQuantity;
use grainlab_page::{Cell, fixed};
use grainlab_results::brief::moduli;
use grainlab_results::findings::recommended;
use std::collections::BTreeMap;

pub(crate) struct Number {
    /// Header of its column.
    pub(crate) name: String,
    form: Form,
    pub(crate) value: Option<f64>,
    /// Robust z-score, if the value is far from the values of runs with the same settings.
    pub(crate) outlier: Option<f64>,
}

impl Number {
    /// Returns false for times and counts of a computer: far values say nothing about a packing.
    pub(crate) fn is_compared(&self) -> bool {
        !matches!(self.name.as_str(), "wall, s" | "lost" | "unbalanced")
    }

    /// Returns the cell of the table of runs, which marks an outlier.
    pub(crate) fn cell(&self) -> Cell {
        let Some(value) = self.value else { return Cell::number("") };
        let cell = self.form.cell(value).sorted_by(value);
        match self.outlier {
            None => cell,
            Some(score) if score.is_finite() => {
                cell.noted("n outlier", format!("outlier: robust z-score {}", fixed(score, 1)))
            }
            Some(_) => cell.noted("n outlier", "outlier: all others are alike"),
        }
    }

    /// Returns the cells of this number, of the number of another run, and of their difference.
    pub(crate) fn compared_with(&self, other: &Self) -> [Cell; 3] {
        let [x, y] = [self.value, other.value].map(|value| value.map(|v| self.form.cell(v)));
        let difference = self.value.zip(other.value).map(|(x, y)| self.form.difference(x, y));
        [x, y, difference].map(|cell| cell.unwrap_or_else(|| Cell::number("–")))
    }
}

#[derive(Clone, Copy)]
enum Form {
    /// With this number of decimal places.
    Fixed(usize),
    /// With this number of decimal places, or three significant digits.
    Significant(usize),
    /// With two significant digits and a power of ten.
    Order,
}

impl Form {
    fn cell(self, value: f64) -> Cell {
        match self {
            Self::Fixed(digits) => Cell::fixed(value, digits),
            Self::Significant(digits) => Cell::three_digits(value, digits),
            Self::Order => Cell::number(format!("{value:.1e}")),
        }
    }

    /// The cell of `y` minus `x`, with the decimal places of these.
    fn difference(self, x: f64, y: f64) -> Cell {
        match self {
            Self::Fixed(digits) => Cell::signed(y - x, digits),
            Self::Significant(digits) => Cell::signed(y - x, decimals_of(x.abs().max(y.abs()), digits)),
            Self::Order => self.cell(y - x),
        }
    }
}

/// Returns the numbers of a run, first the numbers of its last packing.
pub(crate) fn numbers(run: &Run) -> Vec<Number> {
    let number = |name: &str, form, value| Number { name: name.to_owned(), form, value, outlier: None };
    let (fixed, significant) = (Form::Fixed, Form::Significant);
    let report = run.last().map(|state| &state.packing.report);
    let best = run.last().and_then(recommended);
    let counted = |q: InferredQuantity| report.and_then(|r| r.counted(q));
    let error = |q: InferredQuantity| Some(best?.values[q]? - counted(q)?);
    let moduli = ["G12, MPa", "G13, MPa", "Θ, MPa"].into_iter().zip(report.map_or([None; 3], moduli));
    let lost = (!run.summary.topics.is_empty()).then(|| run.summary.total(|t| t.lost) as f64);
    let mut all = vec![
        number("p, kPa", significant(2), report.map(|r| r.pressure() / 1e3)),
        number("φ", fixed(4), report.map(|r| r.solid_fraction)),
    ];
    all.extend(InferredQuantity::countable().map(|q| number(q.symbol(), fixed(q.digits()), counted(q))));
    all.extend(moduli.map(|(name, value)| number(name, significant(2), value)));
    let errors = InferredQuantity::countable();
    all.extend(errors.map(|q| number(&format!("error of {}", q.symbol()), fixed(q.digits()), error(q))));
    all.extend([
        number("unbalanced", Form::Order, report.and_then(|r| r.unbalanced_force_ratio)),
        number("wall, s", fixed(1), run.summary.wall_seconds),
        number("lost", fixed(0), lost),
    ]);
    all
}

/// Marks the values that are far from the values of runs with the same settings.
pub(crate) fn mark_outliers(runs: &[&Run], numbers: &mut [Vec<Number>]) {
    let mut alike: BTreeMap<_, Vec<&mut Vec<Number>>> = BTreeMap::new();
    for (run, numbers) in runs.iter().zip(numbers) {
        alike.entry((run.scene_name(), keys(&run.scene_text))).or_default().push(numbers);
    }
    for mut group in alike.into_values() {
        for column in 0..group[0].len() {
            let compared = group.iter().map(|numbers| &numbers[column]).filter(|number| number.is_compared());
            let Some(outliers) = Outliers::of(compared.filter_map(|number| number.value)) else { continue };
            for number in group.iter_mut().map(|numbers| &mut numbers[column]) {
                let far = number.value.filter(|value| outliers.has(*value));
                number.outlier = far.map(|value| outliers.score(value));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainlab_page::table;

    #[test]
    fn small_numbers_and_their_differences_keep_their_digits_side_by_side() {
        let form = Form::Significant(2);
        let cells = [form.cell(0.011_24), form.cell(0.012_36), form.difference(0.011_24, 0.012_36)];
        let text = table("", ["first", "second", "difference"], [cells]);
        for part in [">0.0112<", ">0.0124<", ">+0.0011<"] {
            assert!(text.contains(part), "{part}: {text:?}");
        }
    }
}
