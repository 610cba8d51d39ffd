//! Energy of a run by its losses, where the scene asked for that.

use crate::run::Run;
use grainlab_msgs::boundary::EnergyReading;
use grainlab_page::plot::{Bar, Bars};
use grainlab_page::{Cell, Html, csv, figure, grid, six_digits, table};

/// Columns of the table that add up several parts of a balance.
const DISSIPATED: [(&str, &[&str]); 4] = [
    ("friction", &["friction", "rolling friction"]),
    ("dashpots", &["normal dashpots", "tangential dashpots", "rolling dashpots"]),
    ("drag, thermostat", &["drag", "thermostat"]),
    ("contacts that change or open", &["contacts that change or open"]),
];

impl Run {
    /// The section; `None` without balances.
    pub(crate) fn energy(&self) -> Option<Html> {
        let phases = &self.timeline.energy;
        let names = phases.first()?.dissipated.map(|(name, _)| name);
        let total = |i: usize| phases.iter().map(|p| p.dissipated[i].1).sum::<f64>();
        let all: f64 = (0..names.len()).map(total).sum();
        let bars = names.iter().enumerate().filter(|(i, _)| total(*i) != 0.0).map(|(i, name)| {
            let value = total(i) / all.abs().max(f64::MIN_POSITIVE) * 100.0;
            Bar { name: (*name).to_owned(), colour: 0, value, interval: None, text: format!("{value:.2} %") }
        });
        let title = format!("Energy dissipated, % of {all:.3e} J");
        let plot = Bars { title, from_zero: true, bars: bars.collect(), reference: None }.svg();
        let figure = figure("energy", plot, "Sums over the phases in the table.", &data(phases));
        Some(grid(figure) + balance(phases))
    }
}

/// One row per phase.
fn balance(phases: &[EnergyReading]) -> Html {
    let dissipated = DISSIPATED.map(|(name, _)| name);
    let header =
        [&["phase", "work of strain", "change of stored"], &dissipated[..], &["time step", "residual"]]
            .concat();
    let row = |p: &EnergyReading| {
        let stored = p.stored.iter().map(|(_, v)| v).sum::<f64>() - p.start;
        let by = |(_, parts): (&str, &[&str])| {
            p.dissipated.iter().filter(|(name, _)| parts.contains(name)).map(|(_, v)| v).sum::<f64>()
        };
        let values =
            [&[p.strain_work, stored], &DISSIPATED.map(by)[..], &[p.integration, p.residual()]].concat();
        let values = values.into_iter().map(|v| Cell::number(format!("{v:.3e}")));
        std::iter::once(Cell::text(&p.phase_name)).chain(values).collect::<Vec<_>>()
    };
    let caption = "J. Work of the strain and the error of the time step equal the change of the stored energy and what is \
                   dissipated; the residual is what is missing, by rounding.";
    table(caption, header, phases.iter().map(row))
}

fn data(phases: &[EnergyReading]) -> String {
    let rows = phases.iter().flat_map(|p| {
        let rest = [
            ("start", p.start),
            ("work of strain", p.strain_work),
            ("time step", p.integration),
            ("residual", p.residual()),
        ];
        let all = rest.into_iter().chain(p.stored).chain(p.dissipated);
        all.map(|(part, value)| [p.phase_name.clone(), part.to_owned(), six_digits(value)])
    });
    csv(["phase", "part", "energy_j"], rows)
}
