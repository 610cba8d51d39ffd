//! Colours of plots, as one style sheet.

use super::figure::{Series, Theme};
use std::fmt::Write;

/// Distinct under colour blindness (Okabe and Ito, and two more), dark enough on white.
const ON_WHITE: [&str; Series::COLOURS] =
    ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000", "#8c6d1f", "#6a3d9a"];

/// Colours of the same hues, light enough on dark.
const ON_DARK: [&str; Series::COLOURS] =
    ["#4aa3df", "#ff8a3d", "#2fc79b", "#e3a1c6", "#f2b632", "#8fd0f5", "#f0f0f0", "#c9a64a", "#b08fe0"];

/// The style sheet of one SVG.
pub(super) fn style(theme: Theme) -> String {
    let sheet = |paper: &str, ink: &str, faint: &str, grid: &str, colours: &[&str]| {
        let mut css = format!(
            ".paper{{fill:{paper}}}.ink{{fill:{ink}}}.faint{{fill:{faint}}}.axis{{stroke:{ink}}}.grid{{stroke:{grid}}}\
             .full{{fill:currentColor;stroke:currentColor;stroke-width:1.4}}\
             .hollow{{fill:{paper};stroke:currentColor;stroke-width:1.4}}.grey{{color:{faint}}}"
        );
        for (n, colour) in colours.iter().enumerate() {
            let _ = write!(css, ".c{n}{{color:{colour}}}");
        }
        css
    };
    let light = || sheet("#ffffff", "#000000", "#555555", "#e4e4e4", &ON_WHITE);
    let dark = || sheet("#1b1b1f", "#e6e6e6", "#a8a8a8", "#38383e", &ON_DARK);
    match theme {
        Theme::Light => light(),
        Theme::System => format!("{}@media (prefers-color-scheme: dark){{{}}}", light(), dark()),
    }
}

/// Colours of a page and of all plots in it, which have the class `plot`: those of the reader's system, or those that the
/// attribute `data-theme` of the root element names (`light`, `dark`).
pub(crate) fn page_style() -> String {
    let variables = |own: &str, colours: &[&str]| {
        let numbered = colours.iter().enumerate().map(|(n, colour)| format!(";--c{n}:{colour}"));
        own.to_owned() + &numbered.collect::<String>()
    };
    let light = variables(
        "--paper:#ffffff;--ink:#1d1d22;--faint:#5c5c66;--grid:#e7e7ec;--band:#f4f4f7;--stage:#fbfbfc;--good:#0a6b3d;--warn:#8a5a00;\
         --bad:#a32014",
        &ON_WHITE,
    );
    let dark = variables(
        "--paper:#1b1b1f;--ink:#e8e8ec;--faint:#a9a9b4;--grid:#34343c;--band:#232329;--stage:#141417;--good:#5fd39a;--warn:#e5b45c;\
         --bad:#ff8f80",
        &ON_DARK,
    );
    let classes: String = (0..Series::COLOURS).map(|n| format!(".plot .c{n}{{color:var(--c{n})}}")).collect();
    format!(
        ":root{{{light}}}\n@media screen and (prefers-color-scheme:dark){{:root:not([data-theme=light]){{{dark}}}}}\n\
         :root[data-theme=dark]{{{dark}}}\n{classes}\n"
    )
}
