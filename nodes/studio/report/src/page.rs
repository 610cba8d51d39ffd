//! The page of one run: one file, without references to others.

use crate::run::{Run, recommended};
use grainlab_console::fixed;
use grainlab_core::results::InferredQuantity;
use grainlab_page::html::{escaped, section};
use grainlab_page::plot::page_style;
use grainlab_results::brief::{ended, lost_words, moduli};
use grainlab_results::read_back::InvertedPacking;
use grainlab_viewer::PictureError;

/// Style of a page, beside [`page_style`].
pub const STYLE: &str = include_str!("../assets/report.css");
/// Script of a page: theme, saved plots, values under the pointer.
pub const SCRIPT: &str = include_str!("../assets/report.js");

/// A page with a heading, a navigation and sections (id, title, content). `scripts` are added to that of the page.
pub(crate) fn whole(
    title: &str,
    heading: &str,
    sections: &[(&str, &str, String)],
    scripts: &[&str],
) -> String {
    let links: String =
        sections.iter().map(|(id, title, _)| format!("<a href=\"#{id}\">{}</a>", escaped(title))).collect();
    let content: String = sections.iter().map(|(id, title, content)| section(id, title, content)).collect();
    let scripts: String =
        scripts.iter().chain(&[SCRIPT]).map(|s| format!("<script>{s}</script>\n")).collect();
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{}</title>\n\
         <style id=\"style\">\n{}{STYLE}{}</style>\n</head>\n<body>\n\
         <header class=\"top\"><nav aria-label=\"Sections\">{links}</nav>\
         <button type=\"button\" id=\"theme\" aria-label=\"Light or dark\">Light / dark</button></header>\n\
         <main>\n{heading}{content}</main>\n{scripts}</body>\n</html>\n",
        escaped(title),
        page_style(),
        grainlab_viewer::HEAD,
    )
}

impl Run {
    /// The page.
    ///
    /// # Errors
    /// If the picture of the packing cannot be written.
    pub fn html(&self) -> Result<String, PictureError> {
        let views = self.timeline.film.states();
        let mut sections: Vec<(&str, &str, String)> = Vec::new();
        if !views.is_empty() {
            let left_out = self.timeline.film.count() - views.len();
            let note = match left_out {
                0 => String::new(),
                n => format!(
                    "<p>{n} of {} recorded states are left out, for the size of the page.</p>\n",
                    self.timeline.film.count()
                ),
            };
            sections.push(("packing", "The packing", grainlab_viewer::figure(&self.name(), &views)? + &note));
        }
        sections.push(("time", "Against time", self.timeline.against_time()));
        sections.push(("structure", "Contacts and forces", self.structure()));
        sections.push(("moduli", "Moduli", self.moduli()));
        sections.push(("inference", "Inferred and counted", self.inferred()));
        sections.extend(self.waves().map(|waves| ("waves", "Waves", waves)));
        sections.extend(self.energy().map(|energy| ("energy", "Energy", energy)));
        sections.push(("health", "Health of the run", self.health()));
        sections.push(("repeat", "Repeat it", self.repeat()));
        let title = format!("{}: run {}", self.scene_name(), self.name());
        let scripts: &[&str] = if views.is_empty() { &[] } else { &grainlab_viewer::SCRIPTS };
        Ok(whole(&title, &self.heading(), &sections, scripts))
    }

    /// What was run, how it ended, and the key results.
    fn heading(&self) -> String {
        let mut text = format!(
            "<p class=\"eyebrow\">grainlab · {}</p>\n<h1>{}</h1>\n",
            escaped(&self.name()),
            escaped(&self.headline())
        );
        let description = self.scene.as_ref().map(|s| s.description.as_str()).filter(|d| !d.is_empty());
        text += &description.map_or_else(String::new, |d| format!("<p class=\"lead\">{}</p>\n", escaped(d)));
        text += &self.verdict();
        if !self.missing.is_empty() {
            let items: String = self.missing.iter().map(|m| format!("<li>{}</li>", escaped(m))).collect();
            text += &format!("<div class=\"missing\"><b>Missing or not readable</b><ul>{items}</ul></div>\n");
        }
        if let Some(state) = self.last() {
            text += &cards(state);
            text += &self.states_table();
        }
        text
    }

    fn headline(&self) -> String {
        let scene = self.scene_name();
        match (self.last(), &self.timeline.last) {
            (Some(s), _) => {
                let r = &s.packing.report;
                format!("{scene}: {} grains at {:.2} kPa", r.contacts.grains, r.pressure() / 1e3)
            }
            (None, Some(packing)) => format!("{scene}: {} grains, not measured", packing.grains()),
            (None, None) => format!("{scene}: no packing"),
        }
    }

    /// How the run ended, in one line, which begins with the damage if there is any.
    fn verdict(&self) -> String {
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
        format!("<p class=\"verdict {class}\">{}</p>\n", escaped(&words))
    }
}

/// The key results of a state.
fn cards(state: &InvertedPacking) -> String {
    let r = &state.packing.report;
    let best = recommended(state);
    let mut text = String::from("<div class=\"cards\">\n");
    for q in InferredQuantity::countable() {
        let (counted, digits) = (r.counted(q), q.digits());
        let inferred = best.and_then(|b| b.values[q]).map_or_else(
            || "not inferred".to_owned(),
            |v| {
                let sigma =
                    best.and_then(|b| b.sigma[q]).map_or_else(String::new, |s| format!(" ± {s:.digits$}"));
                let error = counted.map_or_else(String::new, |c| {
                    format!(" <span class=\"error\">{:+.digits$}</span>", v - c)
                });
                let status = best.map_or("ok", |b| b.status);
                let status = if status == "ok" { String::new() } else { format!(" ({status})") };
                format!("inferred {v:.digits$}{sigma}{error}{status}")
            },
        );
        text += &card(q.symbol(), &fixed(counted, digits), q.meaning(), &inferred);
    }
    let [g12, g13, theta] = moduli(r).map(|m| fixed(m, 2));
    let shear = format!("{g12}, {g13} <small>MPa</small>");
    text += &card("G12, G13", &shear, "shear across and along the axis", "");
    text += &card("Θ", &format!("{theta} <small>MPa</small>"), "bulk modulus", "");
    let unbalanced = r.unbalanced_force_ratio.map_or_else(|| "–".to_owned(), |u| format!("{u:.1e}"));
    let ratio = r.stress_ratio().map_or_else(String::new, |q| format!("q/p {q:.1e}"));
    text += &card("p", &format!("{:.2} <small>kPa</small>", r.pressure() / 1e3), "pressure", &ratio);
    text += &card(
        "φ",
        &format!("{:.4}", r.solid_fraction),
        "solid fraction",
        &format!("unbalanced force {unbalanced}"),
    );
    text + "</div>\n"
}

/// A quantity; `value` and `below` are markup.
pub fn card(symbol: &str, value: &str, meaning: &str, below: &str) -> String {
    let below = if below.is_empty() { String::new() } else { format!("<div class=\"below\">{below}</div>") };
    format!(
        "<div class=\"card\"><div class=\"symbol\">{} <span>{}</span></div><div class=\"value\">{value}</div>{below}</div>\n",
        escaped(symbol),
        escaped(meaning)
    )
}
