//! The HTML page: one file, without references to others.

use crate::Reproduction;
use grainlab_page::html::{Cell, code, escaped, paragraph, section, table};
use grainlab_paper::{PAPER, PRESSURE};

const STYLE: &str = "\
:root{color-scheme:light dark;--ink:#1b1b1f;--faint:#5c5c66;--back:#ffffff;--line:#dcdce2;--good:#0a6b3d;--bad:#a32014;--band:#f5f5f8}
@media (prefers-color-scheme:dark){:root{--ink:#e8e8ec;--faint:#a9a9b4;--back:#1b1b1f;--line:#3a3a42;--good:#5fd39a;--bad:#ff8f80;--band:#24242a}}
body{margin:0 auto;max-width:60rem;padding:1rem 1.25rem 4rem;font:16px/1.55 system-ui,sans-serif;color:var(--ink);background:var(--back)}
h1{font-size:1.7rem;line-height:1.2;margin:1rem 0 .5rem}
h2{font-size:1.25rem;margin:2.5rem 0 .5rem;border-bottom:1px solid var(--line);padding-bottom:.25rem}
p{max-width:46rem}
.lead{color:var(--faint)}
nav{display:flex;flex-wrap:wrap;gap:.25rem 1rem}
a{color:inherit}
.scroll{overflow-x:auto;margin:1rem 0}
table{border-collapse:collapse;font-size:.86rem;font-variant-numeric:tabular-nums}
caption{text-align:left;color:var(--faint);padding:.25rem 0;max-width:46rem}
th,td{padding:.2rem .6rem;text-align:left;vertical-align:top}
thead th{border-bottom:1px solid var(--line);font-weight:600;vertical-align:bottom}
tbody th{font-weight:600;white-space:nowrap}
#claims tbody th{white-space:normal;min-width:11rem;font-weight:400}
#claims td:last-child{min-width:11rem}
tbody tr:nth-child(even){background:var(--band)}
.n{text-align:right;white-space:nowrap}
.p{color:var(--faint)}
.yes,.no{font-weight:600;white-space:nowrap}
.yes{color:var(--good)}
.no{color:var(--bad)}
figure{margin:1.25rem 0;overflow-x:auto}
figure svg{width:100%;min-width:34rem;height:auto;display:block}
figcaption{color:var(--faint);font-size:.9rem}
code{font:.85em ui-monospace,monospace;overflow-wrap:anywhere}
pre{overflow-x:auto;background:var(--band);padding:.6rem .8rem;font-size:.85rem}
";

/// What the scenes have that the text of the paper does not have, or has otherwise.
const DEPARTURES: [&str; 5] = [
    "An early extension at constant volume, before the grains touch. The deviatoric strain of the compression undoes it, so that \
     γ/Δ is that of Table II; the paper does not mention it.",
    "Isotropic compression to φ = 0.628, then pure shear until the grains jam, in place of the uniaxial compression.",
    "One cycle at constant lateral stress at μ2. The paper has servo-controlled cycles at constant volume, which targets of \
     stress exclude.",
    "During the relaxation at μ = 10 the servo holds the stress. The paper removes the servo.",
    "The paper gives no rates, no damping, no density and no time step. Ours are in the scenes.",
];

impl Reproduction {
    /// The page.
    pub fn html(&self) -> String {
        let p = &self.provenance;
        let title = "Contact anisotropy and coordination number: the paper, reproduced";
        let seeds: Vec<String> = p.seeds.iter().map(u64::to_string).collect();
        let missing: Vec<String> = self
            .states
            .missing()
            .into_iter()
            .map(|(s, n)| format!("{} at {} kPa", PAPER[s].name, PRESSURE[n] / 1e3))
            .collect();
        let mut body = format!(
            "<h1>{}</h1>\n<p class=\"lead\">{}</p>\n",
            escaped(title),
            escaped(&format!(
                "La Ragione & Magnanimo, Phys. Rev. E 85, 031304 (2012), beside packings of {} grains prepared, measured and \
                 inverted by grainlab {}: four samples at four pressures, {} each ({}). Every number is computed from the \
                 recordings of the runs.",
                p.grains,
                p.version,
                if p.seeds.len() == 1 { "one seed".to_owned() } else { format!("{} seeds", p.seeds.len()) },
                seeds.join(", "),
            ))
        );
        if !missing.is_empty() {
            body += &format!("<p class=\"no\">Not simulated: {}</p>\n", escaped(&missing.join(", ")));
        }
        body += "<nav><a href=\"#claims\">What holds</a><a href=\"#figures\">Figures</a><a href=\"#tables\">Tables</a>\
                 <a href=\"#inversion\">Inversion</a><a href=\"#protocol\">Protocol</a><a href=\"#repeat\">Repeat it</a></nav>\n";
        body += &section("claims", "What holds", &self.claims_table());
        let drawn = format!(
            "<p>Drawn from {}, which {} writes beside this page.</p>\n",
            code("reproduction.csv"),
            code(&self.provenance.command)
        );
        body += &section("figures", "Figures", &(drawn + &self.figures()));
        body += &section("tables", "Tables", &self.tables());
        body += &section("inversion", "From moduli to microstructure", &self.inversion());
        body += &section("protocol", "The protocol", &protocol());
        body += &section("repeat", "Repeat it", &self.commands());
        format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{}</title>\n<style>\n{STYLE}</style>\n\
             </head>\n<body>\n{body}</body>\n</html>\n",
            escaped(title)
        )
    }

    fn claims_table(&self) -> String {
        let row = |claim: &grainlab_paper::claims::Claim| {
            let (verdict, class) = match claim.holds {
                Some(true) => ("holds", "yes"),
                Some(false) => ("does not hold", "no"),
                None => ("not checked", ""),
            };
            vec![Cell::text(&claim.text), Cell::classed(verdict, class), Cell::text(&claim.found)]
        };
        let rows: Vec<Vec<Cell>> = self.claims.iter().map(row).collect();
        let caption = format!(
            "Statements of the paper and goals of the reproduction, on the means over seeds. Key {} of {}, by {}",
            code("claims"),
            code("reproduction.json"),
            code(&self.provenance.command)
        );
        table(&caption, &["statement", "", "found"], &rows)
    }

    fn tables(&self) -> String {
        let scatter = match self.provenance.seeds.len() {
            1 => "One packing of each state: its scatter is not known.",
            2..5 => "Mean ± standard error over seeds, which is rough with so few.",
            _ => "Mean ± standard error over seeds.",
        };
        let about = paragraph(&format!(
            "{scatter} A difference in errors is divided by that error and the rounding of the paper's \
             number; the scatter of the paper's own samples, one each, is not known. The paper's k agrees with our z, as if its \
             rattlers were left out.",
        ));
        about + &self.table_one() + &self.table_two() + &self.table_three() + &self.moduli()
    }

    fn inversion(&self) -> String {
        let about = paragraph(
            "Every model infers from the moduli of the counted packings, taken as exact. The paper's model needs γ/Δ: total is that \
             of the strain since the reference state, as in the paper; elastic that of an isotropic stress increment; contact that \
             of the overlaps.",
        );
        let about = about + &self.bias();
        about + &self.rows_table() + &self.judged_table() + &self.calibration_table()
    }

    /// The sign of the errors of the paper's model, here and in the paper.
    fn bias(&self) -> String {
        let [_, _, theirs] = grainlab_paper::inversion::of_the_paper();
        let total = |j: &&grainlab_paper::inversion::Judged| {
            let way = &j.way;
            way.model.name() == "ratio"
                && way.calibration.name() == "paper"
                && way.gamma.map(|g| g.name()) == Some("total")
        };
        let Some(ours) = self.judged.iter().find(total).and_then(|j| j.eps) else { return String::new() };
        paragraph(&format!(
            "By the paper's model with its γ/Δ, ε comes out {:+.3} on average here, and {:+.3} on the paper's own packings: ε \
             follows G13/G12 and γ/Δ alone, and the table of moduli has both ratios.",
            ours.bias, theirs.bias
        ))
    }

    fn commands(&self) -> String {
        let p = &self.provenance;
        let runs = &p.folder;
        let lines = [
            format!("{}    # this page", p.command),
            format!("grainlab campaign gather {runs}    # every number of the packings: states.csv"),
            format!("grainlab analyze {runs}/members/s1-{}    # one sample", p.seeds.first().unwrap_or(&1)),
            format!("grainlab invert --table {runs}/states.csv --judge --gamma all    # every model"),
        ];
        format!(
            "<pre>{}</pre>\n<p>The data of this page: {} and {} beside it.</p>\n",
            escaped(&lines.join("\n")),
            code("reproduction.json"),
            code("reproduction.csv")
        )
    }
}

fn protocol() -> String {
    let items: String = DEPARTURES.iter().map(|d| format!("<li>{}</li>\n", escaped(d))).collect();
    paragraph(
        "The scenes s1 to s4 follow the paper: a gas compressed without friction to φ = 0.607, relaxed, compressed at μ1 = 0.1, held \
         at 50 kPa, cycled at μ2, relaxed at μ = 10, and compressed isotropically at μ2 to 100, 250 and 500 kPa. What its text does not \
         say, or says otherwise:",
    ) + &format!("<ul>\n{items}</ul>\n")
}
