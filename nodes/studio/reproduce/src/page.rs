//! The HTML page: one file, without references to others.

use crate::Reproduction;
use crate::paper::claims::Verdict;
use crate::paper::{PAPER, PRESSURE};
use grainlab_page::{Cell, Html, Page, Section, code, finding, heading, html, lines, list, paragraph, table};

/// Parts of the scenes that the text of the paper does not have, or has otherwise.
const DEPARTURES: [&str; 5] = [
    "An early extension at constant volume, before the grains touch. The deviatoric strain of the compression undoes it, so that \
     γ/Δ is near that of Table II; the paper does not mention it.",
    "Isotropic compression to φ = 0.628, then pure shear until the grains jam, in place of the uniaxial compression.",
    "One cycle at constant lateral stress at μ2. The paper has servo-controlled cycles at constant volume, which targets of \
     stress exclude.",
    "During the relaxation at μ = 10 the servo holds the stress. The paper removes the servo.",
    "The paper gives no rates, no damping, no density and no time step. Ours are in the scenes.",
];

impl Reproduction {
    /// Text of the page.
    pub fn html(&self) -> String {
        let p = &self.provenance;
        let title = "Contact anisotropy and coordination number: the paper, compared";
        let seeds: Vec<String> = p.seeds.iter().map(u64::to_string).collect();
        let about = format!(
            "La Ragione & Magnanimo, Phys. Rev. E 85, 031304 (2012), compared with packings of {} grains prepared, measured and \
             inverted by grainlab {}: four samples at four pressures, {} each ({} {}). Every number is computed from the \
             recordings of the runs.",
            p.grains,
            p.version,
            if p.seeds.len() == 1 { "one seed".to_owned() } else { format!("{} seeds", p.seeds.len()) },
            if p.seeds.len() == 1 { "seed" } else { "seeds" },
            seeds.join(", "),
        );
        let missing = self.states.missing();
        let missing: Vec<String> = missing
            .iter()
            .map(|(s, n)| format!("{} at {} kPa", PAPER[*s].name, PRESSURE[*n] / 1e3))
            .collect();
        let missing = html!(
            "{% if missing %}<p class=\"missing\">Not simulated: {{ missing }}</p>\n{% endif %}",
            missing => missing.join(", ")
        );
        let drawn = html!(
            "<p>Drawn from {{ file }}, which {{ command }} writes beside this page.</p>\n",
            file => code("reproduction.csv"),
            command => code(&p.command)
        );
        let sections = [
            ("claims", "What holds", self.claims_table()),
            ("figures", "Figures", drawn + self.figures()),
            ("tables", "Tables", self.tables()),
            ("inversion", "From moduli to microstructure", self.inversion()),
            ("protocol", "The protocol", protocol()),
            ("repeat", "Repeat it", self.commands()),
        ];
        let page = Page {
            title: title.to_owned(),
            heading: heading("grainlab", title, "") + self.found() + paragraph(about) + missing,
            sections: sections.map(|(id, title, content)| Section { id, title, content }).into(),
            styles: vec![include_str!("../assets/reproduction.css")],
            has_bar: true,
            ..Page::default()
        };
        page.text()
    }

    fn found(&self) -> Html {
        let p = &self.provenance;
        let count = |verdict| self.claims.iter().filter(|c| c.verdict == verdict).count();
        let seeds = grainlab_console::count(p.seeds.len(), "seed");
        let done =
            format!("The paper's four samples at four pressures, with {} grains and {seeds} each.", p.grains);
        let found = [
            Some(format!(
                "Of {} statements, {} hold, {} are undecided at this size, {} do not hold.",
                self.claims.len(),
                count(Verdict::Holds),
                count(Verdict::Undecided),
                count(Verdict::Missed)
            )),
            self.judged("relaxed", None, "grainlab").and_then(|j| j.eps).zip(self.judged("ratio", Some("total"), "paper").and_then(|j| j.eps)).map(|(ours, theirs)| {
                format!(
                    "From the moduli of these packings, the model relaxed infers ε with errors of {:.4} in the mean, regardless of sign, and the paper's model with {:.4}.",
                    ours.magnitude, theirs.magnitude
                )
            }),
        ];
        let named = |verdict: Verdict, why: &str| {
            let texts: Vec<&str> =
                self.claims.iter().filter(|c| c.verdict == verdict).map(|c| c.text.as_str()).collect();
            (!texts.is_empty()).then(|| format!("{why}: {}.", texts.join("; ")))
        };
        let within = format!(
            "Missed by at most two standard errors of the mean over seeds of {} grains; undecided",
            p.grains
        );
        let doubts = [
            named(Verdict::Missed, "Not reproduced"),
            named(Verdict::Undecided, &within),
            named(Verdict::Unchecked, "Not checked"),
        ];
        finding(
            &done,
            &found.into_iter().flatten().collect::<Vec<_>>(),
            &doubts.into_iter().flatten().collect::<Vec<_>>(),
        )
    }

    fn claims_table(&self) -> Html {
        let rows = self.claims.iter().map(|claim| {
            let class = match claim.verdict {
                Verdict::Holds => "yes",
                Verdict::Missed => "no",
                Verdict::Undecided => "open",
                Verdict::Unchecked => "",
            };
            let verdict = claim.verdict.words();
            [Cell::text(&claim.text), Cell::classed(verdict, class), Cell::sentence(&claim.found)]
        });
        let caption = html!(
            "Statements of the paper and goals of the reproduction, on the means over seeds. Key {{ key }} of {{ file }}, by {{ command }}",
            key => code("claims"),
            file => code("reproduction.json"),
            command => code(&self.provenance.command)
        );
        table(caption, ["statement", "", "found"], rows)
    }

    fn tables(&self) -> Html {
        let scatter = match self.provenance.seeds.len() {
            1..5 => {
                "The errors of so few seeds are those expected of packings of this size, from 12 seeds of 500 grains."
            }
            _ => "Mean ± standard error over seeds.",
        };
        let about = paragraph(format!(
            "{scatter} A difference in errors is divided by that error and the rounding of the paper's \
             number; the scatter of the paper's own samples, one each, is not known. The paper's k is compared with our z, as if its \
             rattlers were left out: the difference is smaller than that of our k.",
        ));
        about + self.table_one() + self.table_two() + self.table_three() + self.moduli()
    }

    fn inversion(&self) -> Html {
        let about = paragraph(
            "Every model infers from the moduli of the counted packings, with an error of 1 % each. The paper's model needs γ/Δ: total is that \
             of the strain since the reference state, as in the paper; elastic that of an isotropic stress increment; contact that \
             of the overlaps.",
        );
        about + self.bias() + self.rows_table() + self.judged_table()
    }

    /// The sign of the errors of the paper's model, here and in the paper.
    fn bias(&self) -> Html {
        let [_, _, theirs] = crate::paper::inversion::of_the_paper();
        let ours = self.judged("ratio", Some("total"), "paper").and_then(|j| j.eps);
        let Some(ours) = ours else { return Html::default() };
        paragraph(format!(
            "By the paper's model with its γ/Δ, ε is {} on average here, and {} on the paper's own packings: ε \
             follows G13/G12 and γ/Δ alone, and the table of moduli has both ratios.",
            aside(ours.bias),
            aside(theirs.bias)
        ))
    }

    fn commands(&self) -> Html {
        let p = &self.provenance;
        let runs = &p.folder;
        let commands = [
            format!("{}    # this page", p.command),
            format!("grainlab campaign gather {runs}    # every number of the packings: states.csv"),
            format!("grainlab analyze {runs}/members/s1-{}    # one sample", p.seeds.first().unwrap_or(&1)),
            self.judge_command() + "    # every model",
        ];
        let data = html!(
            "<p>The data of this page: {{ json }} and {{ csv }} beside it.</p>\n",
            json => code("reproduction.json"),
            csv => code("reproduction.csv")
        );
        lines(&commands.join("\n")) + data
    }
}

/// A mean error in words.
fn aside(bias: f64) -> String {
    format!("too {} by {:.3}", if bias < 0.0 { "low" } else { "high" }, bias.abs())
}

fn protocol() -> Html {
    paragraph(
        "The scenes s1 to s4 follow the paper: a gas compressed without friction to φ = 0.607, relaxed, compressed at μ1 = 0.1, held \
         at 50 kPa, cycled at μ2, relaxed at μ = 10, and compressed isotropically at μ2 to 100, 250 and 500 kPa. What its text does not \
         say, or says otherwise:",
    ) + list(DEPARTURES)
}
