//! The frame of a page: one file, without references to others.

use crate::markup::Html;
use crate::plot::page_style;
use serde::Serialize;

/// Style of all pages, in addition to [`page_style`].
const STYLE: &str = include_str!("../assets/page.css");
const SCRIPTS: [&str; 2] = [include_str!("../assets/page.js"), include_str!("../assets/plots.js")];

/// A part of a page, to which its navigation leads.
#[derive(Clone, Debug, Serialize)]
pub struct Section {
    /// Id of the element.
    pub id: &'static str,
    /// Heading of the section.
    pub title: &'static str,
    /// Elements below the heading.
    pub content: Html,
}

/// A whole page.
#[derive(Clone, Debug, Default)]
pub struct Page {
    /// Name of the window.
    pub title: String,
    /// Elements before the sections.
    pub heading: Html,
    /// Parts in their order.
    pub sections: Vec<Section>,
    /// Styles that this page adds to those of all pages.
    pub styles: Vec<&'static str>,
    /// Scripts that this page adds to those of all pages.
    pub scripts: Vec<&'static str>,
    /// True with a bar, which has a navigation and a switch between light and dark.
    pub has_bar: bool,
    /// True for a page from a server, of which the browser would request an icon, too.
    pub is_served: bool,
}

impl Page {
    /// Text of the file.
    pub fn text(&self) -> String {
        let fixed = |text: &&'static str| Html::drawn((*text).to_owned());
        let styles: Html = [Html::drawn(page_style()), fixed(&STYLE)]
            .into_iter()
            .chain(self.styles.iter().map(fixed))
            .collect();
        let scripts: Vec<Html> = SCRIPTS.iter().chain(&self.scripts).map(fixed).collect();
        let Self { title, heading, sections, has_bar, is_served, .. } = self;
        // A page from a server gets its plots later.
        let has_plots = *is_served || sections.iter().any(|s| s.content.contains("data-frame"));
        html!(
            include_str!("../assets/frame.html"),
            title,
            heading,
            sections,
            styles,
            scripts,
            has_bar,
            has_plots,
            is_served
        )
        .into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bar_leads_to_every_section_and_a_page_without_one_has_no_navigation() {
        let section = Section { id: "a", title: "A & B", content: "1 < 2".into() };
        let page = Page { title: "<x>".into(), sections: vec![section], has_bar: true, ..Page::default() };
        let text = page.text();
        let section = "<section id=\"a\">\n<h2>A &amp; B <a class=\"anchor\" href=\"#a\" aria-label=\"Link to this section\">#</a></h2>\n1 &lt; 2<";
        for part in ["<title>&lt;x&gt;</title>", "<a href=\"#a\">A &amp; B</a>", section] {
            assert!(text.contains(part), "{part}: {text}");
        }
        let plain = Page { has_bar: false, ..page }.text();
        assert!(!plain.contains("<nav") && !plain.contains("id=\"theme\""));
    }
}
