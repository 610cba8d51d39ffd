//! The parts of a page with a packing in three dimensions, which needs no other file.

use crate::encode;
use crate::palette::Quantity;
use crate::picture::{Picture, PictureError, Size};
use crate::view::View;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use grainlab_page::html::{escaped, script_text};
use grainlab_page::plot::page_style;

/// Style of the figure. It uses the colours of [`page_style`].
pub const HEAD: &str = include_str!("../assets/viewer.css");

/// Scripts of the figure, in order: three.js and ours.
pub const SCRIPTS: [&str; 5] = [
    include_str!("../assets/three.min.js"),
    include_str!("../assets/viewer_data.js"),
    include_str!("../assets/viewer_scene.js"),
    include_str!("../assets/viewer_visible.js"),
    include_str!("../assets/viewer.js"),
];

const FIGURE: &str = include_str!("../assets/viewer.html");
const PAGE_STYLE: &str = include_str!("../assets/page.css");

/// Size of the picture that is shown before the scripts have begun, and where there is no WebGL.
const POSTER: Size = Size { width: 720, height: 540 };

/// The figure with the states as data; empty without states. `name` is that of saved pictures. Its scripts are not in it.
///
/// # Errors
/// If the picture cannot be written.
pub fn figure(name: &str, views: &[&View]) -> Result<String, PictureError> {
    let Some(last) = views.last() else { return Ok(String::new()) };
    let poster = STANDARD.encode(Picture::plain(last, Quantity::Coordination, POSTER)?.png()?);
    let alt = format!(
        "{} grains in their periodic cell, coloured by the number of their contacts: {}",
        last.grains(),
        last.label
    );
    let about = serde_json::to_string(&encode::about(name, views)).unwrap_or_default();
    let mut text = FIGURE
        .replace("{alt}", &escaped(&alt))
        .replace("{poster}", &format!("data:image/png;base64,{poster}"));
    text +=
        &format!("<script type=\"application/json\" id=\"viewer-about\">{}</script>\n", script_text(&about));
    for (n, view) in views.iter().enumerate() {
        text += &format!(
            "<script type=\"text/plain\" id=\"viewer-state-{n}\">{}</script>\n",
            encode::state(view, views)
        );
    }
    Ok(text)
}

/// The figure without states, for a page that receives them later: its script shows what [`states`] returns.
pub fn empty_figure() -> String {
    FIGURE.replace("{alt}", "Grains in their periodic cell").replace("src=\"{poster}\"", "hidden")
}

/// States of packings as JSON: `about` and `states`, the texts that [`figure`] has as elements.
pub fn states(name: &str, views: &[&View]) -> String {
    let states: Vec<String> = views.iter().map(|view| encode::state(view, views)).collect();
    serde_json::json!({ "about": encode::about(name, views), "states": states }).to_string()
}

/// A page of its own with the figure.
///
/// # Errors
/// As [`figure`].
pub fn page(title: &str, about: &str, name: &str, views: &[&View]) -> Result<String, PictureError> {
    let scripts: String = SCRIPTS.iter().map(|s| format!("<script>{s}</script>\n")).collect();
    Ok(format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{0}</title>\n\
         <style>\n{1}{PAGE_STYLE}{HEAD}</style>\n</head>\n<body>\n<main>\n<h1>{0}</h1>\n<p>{2}</p>\n{3}</main>\n{scripts}</body>\n</html>\n",
        escaped(title),
        page_style(),
        escaped(about),
        figure(name, views)?
    ))
}
