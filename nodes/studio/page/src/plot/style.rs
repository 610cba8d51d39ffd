//! Colours of plots, as one style sheet.

use super::figure::{Series, Theme};
use std::fmt::Write;

/// Hues of Okabe and Ito and two more, distinct under colour blindness, and dark enough on white for letters.
const ON_WHITE: [&str; Series::COLOURS] =
    ["#0064a6", "#b54a00", "#00734f", "#a0447f", "#8a6100", "#3a719f", "#000000", "#6f5a1e", "#6a3d9a"];

/// Colours of the same hues, light enough on dark.
const ON_DARK: [&str; Series::COLOURS] =
    ["#4aa3df", "#ff8a3d", "#2fc79b", "#e3a1c6", "#f2b632", "#8fd0f5", "#f0f0f0", "#c9a64a", "#b08fe0"];

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

#[cfg(test)]
mod tests {
    use super::*;

    /// Relative luminance of a colour (WCAG 2).
    fn luminance(colour: &str) -> f64 {
        let part = |n: usize| f64::from(u8::from_str_radix(&colour[n..n + 2], 16).unwrap()) / 255.0;
        let linear = |c: f64| if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) };
        0.2126 * linear(part(1)) + 0.7152 * linear(part(3)) + 0.0722 * linear(part(5))
    }

    #[test]
    fn letters_of_every_colour_have_a_contrast_of_4_5_to_every_ground() {
        let sheet = page_style();
        let of = |block: &str, name: &str| {
            let at = block.find(&format!("{name}:#")).unwrap() + name.len() + 1;
            luminance(&block[at..at + 7])
        };
        let blocks: Vec<&str> = sheet.split(":root").skip(1).collect();
        for block in [blocks[0], blocks[2]] {
            for ground in ["--paper", "--band", "--stage"] {
                let numbered = (0..Series::COLOURS).map(|n| format!("--c{n}"));
                for ink in ["--ink", "--faint", "--good", "--warn", "--bad"]
                    .map(str::to_owned)
                    .into_iter()
                    .chain(numbered)
                {
                    let [a, b] = [of(block, &ink), of(block, ground)];
                    let contrast = (a.max(b) + 0.05) / (a.min(b) + 0.05);
                    assert!(contrast >= 4.5, "{ink} on {ground}: {contrast:.2}");
                }
            }
        }
    }
}
