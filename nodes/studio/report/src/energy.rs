//! Energy of a run by its losses, where the scene asked for that.

use grainlab_msgs::msg::EnergyBalance;
use grainlab_page::plot::{Bar, Bars};
use grainlab_page::{Cell, Html, csv, figure, grid, six_digits, table};

/// Columns of the table that add up several parts of a balance.
const DISSIPATED: [(&str, &[&str]); 4] = [
    ("friction", &["friction", "rolling friction"]),
    ("dashpots", &["normal dashpots", "tangential dashpots", "rolling dashpots"]),
    ("drag, thermostat", &["drag", "thermostat"]),
    ("contacts that change or open", &["contacts that change or open"]),
];

/// Energies present at the end of a phase, J.
fn stored(m: &EnergyBalance) -> [(&'static str, f64); 4] {
    [
        ("kinetic", m.kinetic),
        ("normal springs", m.normal_springs),
        ("tangential springs", m.tangential_springs),
        ("rolling springs", m.rolling_springs),
    ]
}

/// Energies dissipated in a phase, J.
fn dissipated(m: &EnergyBalance) -> [(&'static str, f64); 8] {
    [
        ("normal dashpots", m.normal_damping),
        ("tangential dashpots", m.tangential_damping),
        ("rolling dashpots", m.rolling_damping),
        ("friction", m.sliding),
        ("rolling friction", m.rolling),
        ("contacts that change or open", m.history),
        ("drag", m.drag),
        ("thermostat", m.thermostat),
    ]
}

fn sum(parts: &[(&str, f64)]) -> f64 {
    parts.iter().map(|(_, value)| value).sum()
}

/// Energy that the balance misses, J: rounding, in a correct run. Not finite if a part is not.
pub(crate) fn residual(m: &EnergyBalance) -> f64 {
    m.start + m.strain_work + m.integration - sum(&stored(m)) - sum(&dissipated(m))
}

/// The section on energy, one balance per phase; `None` without balances.
pub(crate) fn section(phases: &[EnergyBalance]) -> Option<Html> {
    let names = dissipated(phases.first()?).map(|(name, _)| name);
    let total = |i: usize| phases.iter().map(|p| dissipated(p)[i].1).sum::<f64>();
    let all: f64 = (0..names.len()).map(total).sum();
    let bars = names.iter().enumerate().filter(|(i, _)| total(*i) != 0.0).map(|(i, name)| {
        let value = total(i) / all.abs().max(f64::MIN_POSITIVE) * 100.0;
        Bar { name: (*name).to_owned(), colour: 0, value, text: format!("{value:.2} %") }
    });
    let title = format!("Energy dissipated, % of {all:.3e} J");
    let plot = Bars { title, bars: bars.collect() }.svg();
    let figure = figure("energy", plot, "Sums over the phases in the table.", &data(phases));
    Some(grid(figure) + balance(phases))
}

fn balance(phases: &[EnergyBalance]) -> Html {
    let columns = DISSIPATED.map(|(name, _)| name);
    let header =
        [&["phase", "work of strain", "change of stored"], &columns[..], &["time step", "residual"]].concat();
    let row = |p: &EnergyBalance| {
        let stored = sum(&stored(p)) - p.start;
        let by = |(_, parts): (&str, &[&str])| {
            dissipated(p).iter().filter(|(name, _)| parts.contains(name)).map(|(_, v)| v).sum::<f64>()
        };
        let values =
            [&[p.strain_work, stored], &DISSIPATED.map(by)[..], &[p.integration, residual(p)]].concat();
        let values = values.into_iter().map(|v| Cell::number(format!("{v:.3e}")));
        std::iter::once(Cell::text(&p.phase_name)).chain(values).collect::<Vec<_>>()
    };
    let caption = "J. Work of the strain and the error of the time step equal the change of the stored energy and what is \
                   dissipated; the residual is what is missing, by rounding.";
    table(caption, header, phases.iter().map(row))
}

fn data(phases: &[EnergyBalance]) -> String {
    let rows = phases.iter().flat_map(|p| {
        let rest = [
            ("start", p.start),
            ("work of strain", p.strain_work),
            ("time step", p.integration),
            ("residual", residual(p)),
        ];
        let all = rest.into_iter().chain(stored(p)).chain(dissipated(p));
        all.map(|(part, value)| [p.phase_name.clone(), part.to_owned(), six_digits(value)])
    });
    csv(["phase", "part", "energy_j"], rows)
}
