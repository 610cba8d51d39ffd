//! The page: what stays while its parts change.

use grainlab_page::html::{code, paragraph, section};
use grainlab_page::plot::page_style;
use grainlab_report::{SCRIPT, STYLE};

const OWN_STYLE: &str = include_str!("../assets/live.css");
const OWN_SCRIPT: &str = include_str!("../assets/live.js");

/// Id and title of each section.
const SECTIONS: [(&str, &str); 4] = [
    ("time", "Against time"),
    ("packing", "The packing"),
    ("measured", "Moduli and microstructure"),
    ("processes", "Processes"),
];

/// The page, which loads nothing but the events and packings of its own server.
pub fn page() -> String {
    let links: String = SECTIONS.iter().map(|(id, title)| format!("<a href=\"#{id}\">{title}</a>")).collect();
    let choice = "<div class=\"choice\" role=\"group\" aria-label=\"Horizontal axis\">\
                  <button type=\"button\" data-show=\"phase\" aria-pressed=\"true\">Phases of equal width</button>\
                  <button type=\"button\" data-show=\"time\" aria-pressed=\"false\">Time</button></div>\n";
    let contents = [
        format!(
            "<div id=\"targets\"></div>\n<p>Samples of the exchanges, each line with the extremes in bins about a pixel wide. The \
             recording has every exchange.</p>\n{choice}<ol class=\"phases\" id=\"phases\"></ol>\n\
             <div class=\"grid\" id=\"curves\" data-phases=\"0 1\"></div>\n"
        ),
        format!(
            "<p id=\"no-packing\">No packing has been published yet.</p>\n{}",
            grainlab_viewer::empty_figure()
        ),
        "<div id=\"structure\"></div>\n".to_owned(),
        "<div id=\"nodes\"></div>\n".to_owned(),
    ];
    let sections: String =
        SECTIONS.iter().zip(&contents).map(|((id, title), content)| section(id, title, content)).collect();
    let scripts: String = grainlab_viewer::SCRIPTS
        .iter()
        .chain(&[SCRIPT, OWN_SCRIPT])
        .map(|s| format!("<script>{s}</script>\n"))
        .collect();
    let needs = paragraph("This page needs JavaScript. Without it, see the recording after the run:")
        + &code("grainlab report RUN");
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>grainlab</title>\n\
         <link rel=\"icon\" href=\"data:,\">\n<style>\n{}{STYLE}{}{OWN_STYLE}</style>\n</head>\n\
         <body data-stage=\"waiting\">\n\
         <header class=\"top\"><nav aria-label=\"Sections\">{links}</nav>\
         <button type=\"button\" id=\"theme\" aria-label=\"Light or dark\">Light / dark</button></header>\n\
         <main>\n<p class=\"lost\" id=\"lost\" role=\"alert\" hidden>No connection to <code>grainlab view --live</code>: these are \
         the last values. The page tries again.</p>\n<noscript>{needs}</noscript>\n<div id=\"heading\"></div>\n\
         <div class=\"of-run\">\n<div class=\"cards\" id=\"cards\"></div>\n{sections}</div>\n</main>\n{scripts}</body>\n</html>\n",
        page_style(),
        grainlab_viewer::HEAD,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The elements of the page without scripts and styles.
    fn markup() -> String {
        let without = |text: String, name: &str| {
            let (open, close) = (format!("<{name}"), format!("</{name}>"));
            let mut parts = text.split(&open);
            let first = parts.next().unwrap_or_default().to_owned();
            first + &parts.map(|p| p.split_once(&close).expect("it is closed").1).collect::<String>()
        };
        without(without(page(), "script"), "style")
    }

    #[test]
    fn every_element_is_closed_and_every_id_is_there_once() {
        let markup = markup();
        for name in
            ["main", "section", "div", "header", "nav", "button", "p", "h2", "ol", "span", "label", "select"]
        {
            let opened =
                markup.matches(&format!("<{name}>")).count() + markup.matches(&format!("<{name} ")).count();
            assert_eq!(opened, markup.matches(&format!("</{name}>")).count(), "{name}");
        }
        for id in ["heading", "cards", "targets", "phases", "curves", "structure", "nodes", "lost", "theme"] {
            assert_eq!(markup.matches(&format!(" id=\"{id}\"")).count(), 1, "{id}");
        }
        for (id, _) in SECTIONS {
            assert!(
                markup.contains(&format!("href=\"#{id}\""))
                    && markup.contains(&format!("<section id=\"{id}\""))
            );
        }
    }
}
