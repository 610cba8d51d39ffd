//! Elements that pages have in common: tables, plots, cards, texts.

use crate::markup::Html;
use grainlab_console::CsvText;
use serde::Serialize;

/// A cell of a table.
#[derive(Clone, Debug, Serialize)]
pub struct Cell {
    content: Html,
    class: &'static str,
    /// A reason, shown at the pointer and read out.
    note: Option<String>,
    /// The number by which a table is sorted, instead of the content.
    value: Option<String>,
}

impl Cell {
    /// A text of this class.
    pub fn classed(content: impl Into<Html>, class: &'static str) -> Self {
        Self { content: content.into(), class, note: None, value: None }
    }

    /// A cell with text.
    pub fn text(content: impl Into<Html>) -> Self {
        Self::classed(content, "")
    }

    /// A sentence, whose numbers have a true minus sign.
    pub fn sentence(text: &str) -> Self {
        Self::text(true_minus(text))
    }

    /// A number, aligned with those above it.
    pub fn number(content: impl ToString) -> Self {
        Self::classed(content.to_string(), "n")
    }

    /// A number with this many decimal places, by [`fixed`].
    pub fn fixed(value: impl Into<Option<f64>>, digits: usize) -> Self {
        Self::number(fixed(value, digits))
    }

    /// A number with three significant digits or more, by [`three_digits`].
    pub fn three_digits(value: impl Into<Option<f64>>, decimals: usize) -> Self {
        Self::number(three_digits(value, decimals))
    }

    /// A number with its sign, by [`signed`].
    pub fn signed(value: impl Into<Option<f64>>, digits: usize) -> Self {
        Self::number(signed(value, digits))
    }

    /// The cell with a reason, and of this class.
    #[must_use]
    pub fn noted(self, class: &'static str, note: impl Into<String>) -> Self {
        Self { class, note: Some(note.into()), ..self }
    }

    /// The cell of a table that is sorted by this number.
    #[must_use]
    pub fn sorted_by(self, value: f64) -> Self {
        Self { value: Some(value.to_string()), ..self }
    }
}

/// Rows under a header; nothing without rows. Readers sort it where it is in an element of the class `sortable`.
pub fn table(
    caption: impl Into<Html>,
    header: impl IntoIterator<Item: Into<Html>>,
    rows: impl IntoIterator<Item: IntoIterator<Item = Cell>>,
) -> Html {
    let caption = caption.into();
    let rows: Vec<Vec<Cell>> = rows.into_iter().map(|row| row.into_iter().collect()).collect();
    // A head is aligned as the cells below it.
    let is_number =
        |n: usize| rows[0].get(n).is_some_and(|c: &Cell| c.class.split(' ').any(|name| name == "n"));
    let header = header.into_iter().map(Into::into).enumerate();
    let header: Vec<(Html, bool)> =
        header.map(|(n, name)| (name, !rows.is_empty() && is_number(n))).collect();
    html!(include_str!("../assets/table.html"), caption, header, rows)
}

/// A plot with its caption. Readers save it, and its data, as files named after `id`; without data there are no buttons.
pub fn figure(id: &str, plot: Html, caption: impl Into<Html>, csv: &str) -> Html {
    let (caption, data): (Html, _) = (caption.into(), (!csv.is_empty()).then(|| Html::data(csv)));
    html!(include_str!("../assets/figure.html"), id, plot, caption, data)
}

/// Comma-separated data with a header.
pub fn csv<const N: usize>(header: [&str; N], rows: impl IntoIterator<Item = [String; N]>) -> String {
    let mut text = CsvText::default();
    text.row(header);
    rows.into_iter().for_each(|row| text.row(row));
    text.finish()
}

/// Data within the page, of a media type.
pub fn data(kind: &str, id: &str, text: &str) -> Html {
    let data = Html::data(text);
    html!("<script type=\"{{ kind }}\" id=\"{{ id }}\">{{ data }}</script>\n", kind, id, data)
}

/// A quantity with its value, and a line below.
pub fn card(symbol: &str, value: impl Into<Html>, meaning: &str, below: impl Into<Html>) -> Html {
    let (value, below): (Html, Html) = (value.into(), below.into());
    html!(include_str!("../assets/card.html"), symbol, value, meaning, below)
}

/// A value with its unit.
pub fn with_unit(value: impl Into<Html>, unit: &str) -> Html {
    html!("{{ value }} <small>{{ unit }}</small>", value => value.into(), unit)
}

/// Plots and tables beside one another, where there is room.
pub fn grid(content: Html) -> Html {
    html!("<div class=\"grid\">\n{{ content }}</div>\n", content)
}

/// A paragraph of text.
pub fn paragraph(content: impl Into<Html>) -> Html {
    html!("<p>{{ content }}</p>\n", content => content.into())
}

/// A list; nothing without items.
pub fn list(items: impl IntoIterator<Item: Into<Html>>) -> Html {
    let items: Vec<Html> = items.into_iter().map(Into::into).collect();
    html!("{% if items %}<ul>{% for item in items %}<li>{{ item }}</li>{% endfor %}</ul>\n{% endif %}", items)
}

/// Content that the reader opens; nothing without content.
pub fn details(summary: impl Into<Html>, content: Html) -> Html {
    let summary = summary.into();
    html!(
        "{% if content %}<details><summary>{{ summary }}</summary>{{ content }}</details>\n{% endif %}",
        summary,
        content
    )
}

/// A command line or a name of a file.
pub fn code(text: &str) -> Html {
    html!("<code>{{ text }}</code>", text)
}

/// Lines of a terminal or a file.
pub fn lines(text: &str) -> Html {
    html!("<pre>{{ text }}</pre>\n", text)
}

/// The first lines of a page: its kind, its title, and what it is about, where there is such a text.
pub fn heading(kind: &str, title: &str, about: &str) -> Html {
    html!(
        "<p class=\"eyebrow\">{{ kind }}</p>\n<h1>{{ title }}</h1>\n\
         {% if about %}<p class=\"lead\">{{ about }}</p>\n{% endif %}",
        kind,
        title,
        about
    )
}

/// The findings of a page: what was done, what was found, and reasons to doubt, each a sentence.
pub fn finding(done: &str, found: &[String], doubts: &[String]) -> Html {
    let doubts = doubts.iter().map(|text| true_minus(text));
    html!(
        "<div class=\"finding\"><p>{{ done }}</p>\n{% if found %}<p class=\"found\">{{ found }}</p>\n{% endif %}\
         {% if doubts %}<p>Reasons to doubt:</p>{{ doubts }}{% else %}<p>No reason to doubt it was found.</p>\n{% endif %}</div>\n",
        done => true_minus(done),
        found => true_minus(&found.join(" ")),
        doubts => list(doubts)
    )
}

/// The state of a run in one line: `good`, `warn` or `bad`.
pub fn verdict(class: &str, words: &str) -> Html {
    html!("<p class=\"verdict {{ class }}\">{{ words }}</p>\n", class, words)
}

/// A number with `digits` decimal places and a true minus sign; without one `–`.
pub fn fixed(value: impl Into<Option<f64>>, digits: usize) -> String {
    finite(value, |v| format!("{v:.digits$}"))
}

/// A number as [`grainlab_console::three_digits`] writes it, with a true minus sign; without one `–`.
pub fn three_digits(value: impl Into<Option<f64>>, decimals: usize) -> String {
    finite(value, |v| grainlab_console::three_digits(Some(v), decimals))
}

/// A number with its sign, and none for zero; without one `–`.
pub fn signed(value: impl Into<Option<f64>>, digits: usize) -> String {
    finite(value, |v| {
        let text = format!("{v:+.digits$}");
        if text.contains(|c: char| c.is_ascii_digit() && c != '0') { text } else { text[1..].to_owned() }
    })
}

/// A text with a true minus sign before each number.
pub(crate) fn true_minus(text: &str) -> String {
    let mut before = ' ';
    let mut letters = text.chars().peekable();
    let mut written = String::with_capacity(text.len());
    while let Some(letter) = letters.next() {
        let is_number = letters.peek().is_some_and(char::is_ascii_digit) && " ([\u{a0}".contains(before);
        written.push(if letter == '-' && is_number { '−' } else { letter });
        before = letter;
    }
    written
}

fn finite(value: impl Into<Option<f64>>, text: impl FnOnce(f64) -> String) -> String {
    value.into().filter(|v| v.is_finite()).map_or_else(|| "–".to_owned(), |v| text(v).replace('-', "−"))
}

/// The standard deviation behind a number; nothing without one.
pub fn plus_minus(sigma: Option<f64>, digits: usize) -> String {
    sigma.map_or_else(String::new, |s| format!(" ± {s:.digits$}"))
}

/// A number of a plot's data: six significant digits.
pub fn six_digits(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let size = value.abs().log10().floor();
    if (-4.0..9.0).contains(&size) {
        let digits = (5.0 - size).max(0.0) as usize;
        let text = format!("{value:.digits$}");
        if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
    } else {
        format!("{value:.5e}")
    }
}

/// A part of a name of a file for a quantity or a setting: small letters, digits and `_`, Greek letters by their names, and `-`
/// for anything else.
pub fn slug(name: &str) -> String {
    let letter = |c: char| match c {
        'φ' => "phi".to_owned(),
        'ε' => "eps".to_owned(),
        'θ' => "theta".to_owned(),
        'µ' | 'μ' => "mu".to_owned(),
        'a'..='z' | '0'..='9' | '_' => c.to_string(),
        _ => " ".to_owned(),
    };
    let text: String = name.to_lowercase().chars().map(letter).collect();
    text.split_whitespace().collect::<Vec<_>>().join("-")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_in_a_sentence_has_a_true_minus_and_a_name_and_a_power_keep_theirs() {
        let text = true_minus("-0.5 (-2, [-3, 1e-5) of load-50kPa");
        assert_eq!(text, "−0.5 (−2, [−3, 1e-5) of load-50kPa");
    }

    #[test]
    fn a_name_of_a_file_has_plain_letters() {
        let all = ["φ", "ε_k", "Θ", "G12", "error of z", "phase.load.friction", "Ä, b"].map(slug);
        assert_eq!(all, ["phi", "eps_k", "theta", "g12", "error-of-z", "phase-load-friction", "b"]);
    }

    #[test]
    fn numbers_keep_six_digits_and_no_zeros_that_say_nothing_and_zero_has_no_sign() {
        let all = [
            (0.0, "0"),
            (50_000.0, "50000"),
            (1.0 / 3.0, "0.333333"),
            (-2.5e-3, "-0.0025"),
            (1.25e-7, "1.25000e-7"),
        ];
        all.iter().for_each(|(value, text)| assert_eq!(six_digits(*value), *text));
        let all = [(-1e-9, "0.000"), (1e-9, "0.000"), (-0.5, "−0.500"), (0.5, "+0.500"), (f64::NAN, "–")];
        all.iter().for_each(|(value, text)| assert_eq!(signed(*value, 3), *text));
    }

    #[test]
    fn a_table_names_its_columns_and_rows_aligns_heads_as_their_cells_and_escapes_its_cells() {
        let far = Cell::fixed(1.0, 2).sorted_by(1.0).noted("n bad", "far");
        let text = table("a & b", ["x", "y", "z"], [[Cell::text("<a>"), Cell::fixed(None, 2), far]]);
        let row = "<th scope=\"row\">&lt;a&gt;</th><td class=\"n\">–</td><td class=\"n bad\" data-value=\"1\" title=\"far\">1.00";
        let heads = "<th scope=\"col\">x</th><th scope=\"col\" class=\"n\">y</th>";
        for part in ["<caption>a &amp; b</caption>", heads, row, "hidden\"> (far)</span></td>"] {
            assert!(text.contains(part), "{part}: {text:?}");
        }
        assert!(table("", ["x"], [[]; 0]).is_empty());
    }

    #[test]
    fn small_numbers_keep_three_digits_with_a_true_minus() {
        let all = [(112.4, "112.40"), (0.011_24, "0.0112"), (-0.011_24, "−0.0112"), (f64::NAN, "–")];
        all.iter().for_each(|(value, text)| assert_eq!(three_digits(*value, 2), *text));
    }
}
