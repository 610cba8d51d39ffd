//! Elements of an HTML page.

use std::fmt::Write;

/// Text without markup.
pub(crate) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// A cell of a table, with markup.
pub(crate) struct Cell {
    content: String,
    class: &'static str,
}

impl Cell {
    pub(crate) fn text(text: impl AsRef<str>) -> Self {
        Self { content: escaped(text.as_ref()), class: "" }
    }

    /// A number, aligned with those above it.
    pub(crate) fn number(text: impl AsRef<str>) -> Self {
        Self { content: escaped(text.as_ref()), class: "n" }
    }

    /// A number of the paper.
    pub(crate) fn paper(text: impl AsRef<str>) -> Self {
        Self { content: escaped(text.as_ref()), class: "n p" }
    }

    pub(crate) fn classed(text: impl AsRef<str>, class: &'static str) -> Self {
        Self { content: escaped(text.as_ref()), class }
    }
}

/// A table with a caption, which may have markup.
pub(crate) fn table(caption: &str, header: &[&str], rows: &[Vec<Cell>]) -> String {
    let mut text = String::from("<div class=\"scroll\"><table>\n");
    let _ = write!(text, "<caption>{caption}</caption>\n<thead><tr>");
    for name in header {
        let _ = write!(text, "<th scope=\"col\">{}</th>", escaped(name));
    }
    text += "</tr></thead>\n<tbody>\n";
    for row in rows {
        text += "<tr>";
        for (n, Cell { content, class }) in row.iter().enumerate() {
            let tag = if n == 0 { "th scope=\"row\"" } else { "td" };
            let end = if n == 0 { "th" } else { "td" };
            let class = if class.is_empty() { String::new() } else { format!(" class=\"{class}\"") };
            let _ = write!(text, "<{tag}{class}>{content}</{end}>");
        }
        text += "</tr>\n";
    }
    text + "</tbody></table></div>\n"
}

/// A section with a heading.
pub(crate) fn section(id: &str, title: &str, content: &str) -> String {
    format!("<section id=\"{id}\">\n<h2>{}</h2>\n{content}</section>\n", escaped(title))
}

/// A paragraph of plain text.
pub(crate) fn paragraph(text: &str) -> String {
    format!("<p>{}</p>\n", escaped(text))
}

/// A command line.
pub(crate) fn code(text: &str) -> String {
    format!("<code>{}</code>", escaped(text))
}

/// A drawing with its caption.
pub(crate) fn figure(svg: &str, caption: &str) -> String {
    format!("<figure>{svg}<figcaption>{}</figcaption></figure>\n", escaped(caption))
}
