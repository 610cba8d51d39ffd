//! The page: what stays while its parts change.

use grainlab_page::{Html, Page, Section, html};

/// The page, which loads nothing but the events and packings of its own server.
pub fn page() -> String {
    let about =
        "Samples of the exchanges, each line with the extremes in bins. The recording has every exchange.";
    let curves = grainlab_report::curves(about, Html::default(), Html::default());
    let packing = html!("<p id=\"no-packing\">No packing has been received yet.</p>\n");
    let contents = [
        ("time", "Against time", curves + html!("<div id=\"targets\"></div>\n")),
        ("packing", "The packing", packing + grainlab_viewer::empty_figure()),
        ("measured", "Moduli and microstructure", html!("<div id=\"structure\"></div>\n")),
        ("processes", "Processes", html!("<div id=\"nodes\"></div>\n")),
    ];
    let page = Page {
        title: "grainlab".to_owned(),
        heading: html!(include_str!("../assets/heading.html")),
        sections: contents.map(|(id, title, content)| Section { id, title, content }).into(),
        styles: vec![grainlab_report::STYLE, grainlab_viewer::STYLE, include_str!("../assets/live.css")],
        scripts: [
            &grainlab_viewer::SCRIPTS[..],
            &[grainlab_report::SCRIPT, include_str!("../assets/live.js")],
        ]
        .concat(),
        has_bar: true,
        is_served: true,
    };
    page.text()
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
        for id in ["time", "packing", "measured", "processes"] {
            let both = [format!("href=\"#{id}\""), format!("<section id=\"{id}\"")];
            assert!(both.iter().all(|part| markup.contains(part)), "{id}");
        }
    }
}
