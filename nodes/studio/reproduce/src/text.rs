//! A summary for a terminal.

use crate::Reproduction;
use crate::paper::{Comparison, PAPER, PRESSURE, Quantity, States};
use grainlab_console::{Table, fixed, wrapped};

impl Reproduction {
    /// A row for each state, and the claims.
    pub fn text(&self) -> String {
        let mut table =
            Table::new(["state", "p/kPa", "z", "paper k", "eps", "paper", "g total", "paper", "phi"]);
        for (sample, pressure) in States::places() {
            let get = |q| self.get(q, sample, pressure);
            let ours = |c: Option<&Comparison>, digits| fixed(c.map(|c| c.ours.value), digits);
            let paper =
                |c: Option<&Comparison>, digits| fixed(c.and_then(|c| c.paper).map(|p| p.value), digits);
            let (z, eps, g) = (get(Quantity::Z), get(Quantity::Eps), get(Quantity::StrainTotal));
            table.row([
                PAPER[sample].name.to_owned(),
                format!("{}", PRESSURE[pressure] / 1e3),
                ours(z, 3),
                paper(z, 2),
                ours(eps, 4),
                paper(eps, 3),
                ours(g, 4),
                paper(g, 4),
                ours(get(Quantity::SolidFraction), 4),
            ]);
        }
        let mut text = table.text();
        for claim in &self.claims {
            text += &wrapped(
                &format!("{:18}  ", claim.verdict.words()),
                &format!("{}: {}", claim.text, claim.found),
            );
        }
        text
    }
}
