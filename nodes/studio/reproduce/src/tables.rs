//! Tables I, II and III, and the moduli, ours compared with the paper's.

use crate::Reproduction;
use crate::paper::{Comparison, Mean, PAPER, PRESSURE, Quantity, States};
use grainlab_emt::Modulus;
use grainlab_page::{Cell, Html, code, fixed, html, plus_minus, signed, table};

pub(crate) fn mean(m: Option<&Mean>, scale: f64, digits: usize) -> Cell {
    let error = plus_minus(m.and_then(|m| m.error).map(|e| e / scale), digits);
    Cell::number(fixed(m.map(|m| m.value / scale), digits) + &error)
}

pub(crate) fn of_paper(text: String) -> Cell {
    Cell::classed(text, "n p")
}

/// Ours, the paper's, the difference, and the difference in units of its error.
fn cells(c: Option<&Comparison>, scale: f64, digits: usize, relative: bool) -> [Cell; 4] {
    let paper = c.and_then(|c| c.paper).map(|p| p.value / scale);
    let percent =
        || c.and_then(Comparison::relative).map_or_else(|| "–".to_owned(), |d| signed(100.0 * d, 1) + " %");
    let difference = || signed(c.and_then(Comparison::difference).map(|d| d / scale), digits);
    [
        mean(c.map(|c| Mean { error: c.error(), ..c.ours }).as_ref(), scale, digits),
        of_paper(fixed(paper, digits)),
        Cell::number(if relative { percent() } else { difference() }),
        Cell::signed(c.and_then(Comparison::in_errors), 1),
    ]
}

impl Reproduction {
    /// A caption: what it is, and the command and the columns that regenerate it.
    fn caption(&self, what: &str, columns: &str) -> Html {
        let command = code(&format!("grainlab campaign gather {}", self.provenance.folder));
        html!("{{ what }}. Columns {{ columns }} of {{ command }}", what, columns => code(columns), command)
    }

    /// Table I: the states at 50 kPa.
    pub(crate) fn table_one(&self) -> Html {
        let quantities = [
            (Quantity::K, 3),
            (Quantity::Z, 3),
            (Quantity::Fabric(0), 4),
            (Quantity::Fabric(1), 4),
            (Quantity::Fabric(2), 4),
            (Quantity::SolidFraction, 4),
        ];
        let names =
            ["k, all grains", "z, without rattlers (compared with the paper's k)", "L11", "L22", "L33", "φ"];
        let mut rows = Vec::new();
        for (sample, paper) in PAPER.iter().enumerate() {
            for ((quantity, digits), name) in quantities.iter().zip(names) {
                let relative = matches!(quantity, Quantity::K | Quantity::Z);
                let row = [Cell::text(format!("{} (μ2 = {})", paper.name, paper.mu2)), Cell::text(name)];
                rows.push(row.into_iter().chain(cells(
                    self.get(*quantity, sample, 0),
                    1.0,
                    *digits,
                    relative,
                )));
            }
        }
        let caption = self.caption("Table I: the four samples at 50 kPa", "k, z, fabric_*, phi");
        table(caption, ["sample", "", "ours", "paper", "difference", "in errors"], rows)
    }

    /// Table II: γ/Δ.
    pub(crate) fn table_two(&self) -> Html {
        let rows = States::places().map(|(sample, pressure)| {
            let total = cells(self.get(Quantity::StrainTotal, sample, pressure), 1.0, 4, false);
            let own = [Quantity::StrainElastic, Quantity::StrainContact]
                .map(|q| mean(self.get(q, sample, pressure).map(|c| &c.ours), 1.0, 4));
            head(sample, pressure).into_iter().chain(total).chain(own)
        });
        let caption =
            self.caption("Table II: deviatoric over volumetric strain γ/Δ", "g_total, g_elastic, g_contact");
        let header =
            "sample | p/kPa | total, ours | paper | difference | in errors | elastic | contact overlaps";
        table(caption, header.split(" | "), rows)
    }

    /// The simulated columns of Table III.
    pub(crate) fn table_three(&self) -> Html {
        let rows = States::places().map(|(sample, pressure)| {
            let [k, z, eps] =
                [Quantity::K, Quantity::Z, Quantity::Eps].map(|q| self.get(q, sample, pressure));
            let all = |c, digits| {
                let [ours, paper, _, errors] = cells(c, 1.0, digits, false);
                [ours, paper, errors]
            };
            let [ours_z, _, errors_z] = all(z, 3);
            let row = head(sample, pressure).into_iter().chain(all(k, 3)).chain([ours_z, errors_z]);
            row.chain(all(eps, 4))
        });
        let caption = self.caption("Table III, simulation: coordination number and anisotropy", "k, z, eps");
        let header =
            "sample | p/kPa | k | paper k | in errors | z | z − paper k, in errors | ε | paper ε | in errors";
        table(caption, header.split(" | "), rows)
    }

    /// The moduli, compared with those that Table III implies.
    pub(crate) fn moduli(&self) -> Html {
        let rows = States::places().map(|(sample, pressure)| {
            let mut row: Vec<Cell> = head(sample, pressure).into();
            for modulus in [Modulus::G12, Modulus::G13, Modulus::Theta] {
                let [ours, paper, difference, _] =
                    cells(self.get(Quantity::Modulus(modulus), sample, pressure), 1e6, 1, true);
                row.extend([ours, paper, difference]);
            }
            let [ours, paper, ..] = cells(self.get(Quantity::KEmt, sample, pressure), 1.0, 2, false);
            row.extend([ours, paper]);
            row
        });
        let caption = self.caption(
            "Moduli in MPa, compared with those that the paper's k, k̂ and ε of Table III imply by its Eqs. 16–18, 21 and 22; \
             and k by the effective medium theory from G12 with the strain Δ since the reference state (Table III, k_EMT)",
            "g12_pa, g13_pa, theta_pa",
        );
        let header = "sample | p/kPa | G12 | implied | difference | G13 | implied | difference | Θ | implied | \
                      difference | k_EMT | paper k_EMT";
        table(caption, header.split(" | "), rows)
    }
}

pub(crate) fn head(sample: usize, pressure: usize) -> [Cell; 2] {
    [Cell::text(PAPER[sample].name), Cell::number(PRESSURE[pressure] / 1e3)]
}
