//! Elements of an HTML page.

use std::fmt::Write;

/// Text without markup.
pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// JSON, CSV or other data within a `script` element, which only `</` could end. A reader of JSON sees the same text.
pub fn script_text(text: &str) -> String {
    text.replace("</", "<\\/").replace("<!--", "<\\!--")
}

/// A cell of a table, with markup.
#[derive(Clone, Debug)]
pub struct Cell {
    content: String,
    class: &'static str,
}

impl Cell {
    /// A text.
    pub fn text(text: impl AsRef<str>) -> Self {
        Self { content: escaped(text.as_ref()), class: "" }
    }

    /// A number, aligned with those above it.
    pub fn number(text: impl AsRef<str>) -> Self {
        Self { content: escaped(text.as_ref()), class: "n" }
    }

    /// A number of the paper.
    pub fn paper(text: impl AsRef<str>) -> Self {
        Self { content: escaped(text.as_ref()), class: "n p" }
    }

    /// A text of this class.
    pub fn classed(text: impl AsRef<str>, class: &'static str) -> Self {
        Self { content: escaped(text.as_ref()), class }
    }
}

/// A table with a caption, which may have markup.
pub fn table(caption: &str, header: &[&str], rows: &[Vec<Cell>]) -> String {
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
pub fn section(id: &str, title: &str, content: &str) -> String {
    format!("<section id=\"{id}\">\n<h2>{}</h2>\n{content}</section>\n", escaped(title))
}

/// A paragraph of plain text.
pub fn paragraph(text: &str) -> String {
    format!("<p>{}</p>\n", escaped(text))
}

/// A command line.
pub fn code(text: &str) -> String {
    format!("<code>{}</code>", escaped(text))
}

/// A drawing with its caption.
pub fn figure(svg: &str, caption: &str) -> String {
    format!("<figure>{svg}<figcaption>{}</figcaption></figure>\n", escaped(caption))
}
