//! Where the energy of a run went, where its scene asked for that.

use crate::figure::{PageFigure, number};
use crate::run::Run;
use grainlab_msgs::boundary::EnergyReading;
use grainlab_page::html::{Cell, table};
use grainlab_page::plot::{Bar, Bars};
use std::fmt::Write;

/// Columns of the table that add up several parts of a balance.
const DISSIPATED: [(&str, &[&str]); 4] = [
    ("friction", &["friction", "rolling friction"]),
    ("dashpots", &["normal dashpots", "tangential dashpots", "rolling dashpots"]),
    ("drag, thermostat", &["drag", "thermostat"]),
    ("contacts that change or open", &["contacts that change or open"]),
];

impl Run {
    /// The section; `None` without balances.
    pub(crate) fn energy(&self) -> Option<String> {
        let phases = &self.timeline.energy;
        let first = phases.first()?;
        let names = first.dissipated.map(|(name, _)| name);
        let total = |i: usize| phases.iter().map(|p| p.dissipated[i].1).sum::<f64>();
        let all: f64 = (0..names.len()).map(total).sum();
        let bars = names.iter().enumerate().filter(|(i, _)| total(*i) != 0.0).map(|(i, name)| Bar {
            name: (*name).to_owned(),
            colour: 0,
            value: total(i) / all.abs().max(f64::MIN_POSITIVE) * 100.0,
            interval: None,
            text: format!("{:.2} %", total(i) / all.abs().max(f64::MIN_POSITIVE) * 100.0),
        });
        let title = format!("Energy dissipated, % of {all:.3e} J");
        let svg = Bars { title, from_zero: true, bars: bars.collect(), reference: None }.svg();
        let caption = "Sums over the phases in the table.";
        let figure = PageFigure { id: "energy", svg, caption, csv: csv(phases) }.html();
        Some(format!("<div class=\"grid\">\n{figure}</div>\n{}", balance(phases)))
    }
}

/// One row per phase.
fn balance(phases: &[EnergyReading]) -> String {
    let mut header = vec!["phase", "work of strain", "change of stored"];
    header.extend(DISSIPATED.map(|(name, _)| name));
    header.extend(["time step", "residual"]);
    let row = |p: &EnergyReading| {
        let stored = p.stored.iter().map(|(_, v)| v).sum::<f64>() - p.start;
        let by = |parts: &[&str]| {
            p.dissipated.iter().filter(|(name, _)| parts.contains(name)).map(|(_, v)| v).sum::<f64>()
        };
        let mut values = vec![p.strain_work, stored];
        values.extend(DISSIPATED.map(|(_, parts)| by(parts)));
        values.extend([p.integration, p.residual()]);
        let mut cells = vec![Cell::text(&p.phase_name)];
        cells.extend(values.into_iter().map(|v| Cell::number(format!("{v:.3e}"))));
        cells
    };
    let caption = "J. Work of the strain and the error of the time step equal the change of the stored energy and what is \
                   dissipated; the residual is what is missing, by rounding.";
    table(caption, &header, &phases.iter().map(row).collect::<Vec<_>>())
}

fn csv(phases: &[EnergyReading]) -> String {
    let mut text = String::from("phase,part,energy_j\n");
    for p in phases {
        let rest = [
            ("start", p.start),
            ("work of strain", p.strain_work),
            ("time step", p.integration),
            ("residual", p.residual()),
        ];
        for (part, value) in rest.into_iter().chain(p.stored).chain(p.dissipated) {
            // Names of phases are letters, digits and signs other than commas.
            let _ = writeln!(text, "{},{part},{}", p.phase_name, number(value));
        }
    }
    text
}
