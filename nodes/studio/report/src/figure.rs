//! A plot with its caption, its data, and buttons that save both.

use grainlab_page::html::{escaped, script_text};

/// A plot of a page.
pub(crate) struct PageFigure<'a> {
    /// Name of saved files, and id in the page.
    pub(crate) id: &'a str,
    pub(crate) svg: String,
    /// What is drawn; may be empty.
    pub(crate) caption: &'a str,
    /// The data, with a header; without data there are no buttons either.
    pub(crate) csv: String,
}

impl PageFigure<'_> {
    /// The elements.
    pub(crate) fn html(&self) -> String {
        let Self { id, svg, caption, csv } = self;
        let caption =
            if caption.is_empty() { String::new() } else { format!("<span>{}</span>", escaped(caption)) };
        if csv.is_empty() {
            return format!(
                "<figure class=\"drawing\" id=\"plot-{id}\">\n{svg}<figcaption>{caption}</figcaption>\n</figure>\n"
            );
        }
        let button = |kind: &str, text: &str| {
            format!(
                "<button type=\"button\" data-save=\"{kind}\" aria-label=\"Save {id} as {text}\">{text}</button>"
            )
        };
        format!(
            "<figure class=\"drawing\" id=\"plot-{id}\">\n{svg}<script type=\"text/csv\">{}</script>\n\
             <figcaption>{caption}<span class=\"save\">{}{}</span></figcaption>\n</figure>\n",
            script_text(csv),
            button("svg", "SVG"),
            button("csv", "CSV")
        )
    }
}

/// A number of a plot's data: six significant digits.
pub(crate) fn number(value: f64) -> String {
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

#[cfg(test)]
mod tests {
    use super::number;

    #[test]
    fn numbers_keep_six_digits_and_no_zeros_that_say_nothing() {
        let all = [
            (0.0, "0"),
            (50_000.0, "50000"),
            (1.0 / 3.0, "0.333333"),
            (-2.5e-3, "-0.0025"),
            (1.25e-7, "1.25000e-7"),
        ];
        all.iter().for_each(|(value, text)| assert_eq!(number(*value), *text));
    }
}
