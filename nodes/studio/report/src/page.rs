//! The page of one run: one file, without references to others.

use crate::energy;
use crate::run::{Run, pressure_range};
use grainlab_console::count;
use grainlab_core::results::InferredQuantity;
use grainlab_page::{
    Html, Page, Section, card, finding, fixed, heading, html, list, paragraph, three_digits, verdict,
    with_unit,
};
use grainlab_results::brief::{ended, lost_words, moduli};
use grainlab_results::findings::{Findings, Judged, recommended};
use grainlab_results::read_back::InvertedPacking;
use grainlab_scene::Scene;
use grainlab_viewer::PictureError;

/// Style of plots against time and of tables of runs, in addition to that of all pages.
pub const STYLE: &str = include_str!("../assets/report.css");
/// Script of plots against time.
pub const SCRIPT: &str = include_str!("../assets/time.js");

/// Most warnings of the run among the findings; its health has all.
const MOST_WARNINGS: usize = 4;

impl Run {
    /// The page.
    ///
    /// # Errors
    /// If the picture of the packing cannot be written.
    pub fn html(&self) -> Result<String, PictureError> {
        let (film, views) = (&self.timeline.film, self.timeline.film.states());
        let packing = match film.count() - views.len() {
            0 => Html::default(),
            n => paragraph(format!(
                "{n} of {} recorded states are left out, for the size of the page.",
                film.count()
            )),
        };
        let packing = grainlab_viewer::figure(&self.name(), &views)? + packing;
        let sections = [
            ("inference", "Inferred and counted", Some(self.inferred())),
            ("packing", "The packing", (!views.is_empty()).then_some(packing)),
            ("numbers", "Numbers", self.last().map(|state| cards(state) + self.states_table())),
            ("time", "Against time", Some(self.timeline.against_time() + self.stress_path())),
            ("structure", "Contacts and forces", Some(self.structure())),
            ("moduli", "Moduli", Some(self.moduli())),
            ("waves", "Waves", self.waves()),
            ("energy", "Energy", energy::section(&self.timeline.energy)),
            ("health", "Health of the run", Some(self.health())),
            ("repeat", "Repeat it", Some(self.repeat())),
        ];
        let section =
            |(id, title, content): (_, _, Option<Html>)| Some(Section { id, title, content: content? });
        let scripts = if views.is_empty() { &[][..] } else { &grainlab_viewer::SCRIPTS };
        let page = Page {
            title: format!("{}: run {}", self.scene_name(), self.name()),
            heading: self.heading(),
            sections: sections.into_iter().filter_map(section).collect(),
            styles: vec![STYLE, grainlab_viewer::STYLE],
            scripts: [scripts, &[SCRIPT]].concat(),
            has_bar: true,
            ..Page::default()
        };
        Ok(page.text())
    }

    fn stress_path(&self) -> Html {
        let reference = self.scene.as_ref().and_then(|s| s.phases.iter().rposition(|p| p.reference));
        let after = reference.map_or(0, |n| n as u32 + 1);
        self.timeline.path.figures(after + self.timeline.first_phase())
    }

    fn heading(&self) -> Html {
        let about = self.scene.as_ref().map_or("", |s| s.description.as_str());
        let words = self.launched.as_deref().unwrap_or_default();
        let set: Vec<&str> = words.windows(2).filter(|w| w[0] == "--set").map(|w| w[1].as_str()).collect();
        let about = match set.as_slice() {
            [] => about.to_owned(),
            set => format!("{} with {}, made from: {about}", self.scene_name(), set.join(", ")),
        };
        let missing = list(&self.missing);
        let missing = html!(
            "{% if missing %}<div class=\"missing\"><b>Missing or not readable</b>{{ missing }}</div>\n{% endif %}",
            missing
        );
        let about = if about.is_empty() { Html::default() } else { paragraph(format!("The scene: {about}")) };
        let Findings { done, found, mut doubts } = Findings::of(&self.states);
        let more = self.summary.warnings.iter().filter(|w| !doubts.iter().any(|d| d.contains(w.as_str())));
        let more: Vec<String> = more.take(MOST_WARNINGS).cloned().collect();
        doubts.extend(more);
        if self.summary.exit != Some(0) || self.is_incomplete() {
            doubts.push(
                "The run is not complete, or cannot be read whole: the lines below say why.".to_owned(),
            );
        }
        let within = self.timeline.fabrics.len().saturating_sub(self.states.len());
        let within = (within > 0).then(|| {
            paragraph(format!(
                "{} within phases {} measured, too: the plots against time have them, these sentences do not.",
                count(within, "packing"),
                if within == 1 { "was" } else { "were" }
            ))
        });
        heading(&format!("grainlab · {}", self.name()), &self.headline(), "")
            + within.unwrap_or_default()
            + finding(&done, &found, &doubts)
            + about
            + list(self.scene.as_ref().map(Scene::notes).unwrap_or_default())
            + self.verdict()
            + missing
    }

    fn headline(&self) -> String {
        let scene = self.scene_name();
        match (self.last(), &self.timeline.last) {
            (Some(s), _) => {
                let range = pressure_range(&self.states, 2);
                format!("{scene}: {} grains at {range} kPa", s.packing.report.contacts.grains)
            }
            (None, Some(packing)) => format!("{scene}: {} grains, not measured", packing.grains()),
            (None, None) => format!("{scene}: no packing"),
        }
    }

    /// End of the run, in one line, which begins with the damage if there is any.
    fn verdict(&self) -> Html {
        let s = &self.summary;
        let (class, mut words) = match s.exit {
            Some(0) if self.is_incomplete() => ("bad", "Damaged: the run was complete once".to_owned()),
            None => ("bad", "The end of the run is not known".to_owned()),
            Some(0) if s.warnings.is_empty() => ("good", "Complete".to_owned()),
            Some(0) => {
                ("warn", format!("Complete, with {}", grainlab_console::count(s.warnings.len(), "warning")))
            }
            Some(code) => {
                let why = ended(code, s.warnings.first().map(String::as_str), s.saved_step);
                ("bad", format!("Ended {}", why.unwrap_or_else(|| format!("with exit code {code}"))))
            }
        };
        if let Some(t) = s.wall_seconds {
            words += &format!(" · {t:.1} s");
        }
        if let Some(seed) = self.seed() {
            words += &format!(" · seed {seed}");
        }
        if !s.topics.is_empty() {
            let (recorded, lost) = (s.total(|t| t.recorded), s.total(|t| t.lost));
            words += &format!(" · {recorded} messages recorded, {}", lost_words(lost, self.uncounted_files));
        }
        verdict(class, &words)
    }
}

fn cards(state: &InvertedPacking) -> Html {
    let r = &state.packing.report;
    let best = recommended(state);
    let inferred = |q: InferredQuantity| {
        let Some(best) = best else { return "not inferred".into() };
        let Some(j) = Judged::of(best, r).into_iter().find(|j| j.quantity == q) else {
            return "not inferred".into();
        };
        html!(
            "inferred {{ value }}{% if error %} <span class=\"error\">{{ error }}</span>{% endif %}{% if status != \"ok\" %} ({{ status }}){% endif %}",
            value => j.value(),
            error => format!("({})", j.distance()),
            status => best.status.name(),
        )
    };
    let counted = InferredQuantity::countable()
        .map(|q| card(q.symbol(), fixed(r.counted(q), q.digits()), q.meaning(), inferred(q)));
    let [g12, g13, theta] = moduli(r).map(|m| three_digits(m, 2));
    let ratio = r.stress_ratio().map_or_else(String::new, |q| format!("q/p {q:.1e}"));
    let unbalanced =
        r.unbalanced_force_ratio.map_or_else(String::new, |u| format!("unbalanced force {u:.1e}"));
    let measured = [
        card("G12, G13", with_unit(format!("{g12}, {g13}"), "MPa"), "shear across and along the axis", ""),
        card("Θ", with_unit(theta, "MPa"), "bulk modulus", ""),
        card("p", with_unit(three_digits(r.pressure() / 1e3, 2), "kPa"), "pressure", ratio),
        card("φ", fixed(r.solid_fraction, 4), "solid fraction", unbalanced),
    ];
    html!("<div class=\"cards\">\n{{ cards }}</div>\n", cards => counted.chain(measured).collect::<Html>())
}
