//! The parts of a page with a packing in three dimensions, which needs no other file.

use crate::canvas::Ground;
use crate::encode;
use crate::palette::Quantity;
use crate::picture::{Picture, PictureError, Size};
use crate::view::View;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use grainlab_page::{Html, Page, data, heading, html};

/// Style of the figure.
pub const STYLE: &str = include_str!("../assets/viewer.css");

/// Scripts of the figure, in order: three.js and ours.
pub static SCRIPTS: [&str; 6] = [
    include_str!("../assets/three.min.js"),
    include_str!("../assets/viewer_data.js"),
    include_str!("../assets/viewer_scene.js"),
    include_str!("../assets/viewer_visible.js"),
    include_str!("../assets/viewer_marks.js"),
    include_str!("../assets/viewer.js"),
];

/// Size of the picture that is shown before the scripts have begun, and where there is no WebGL.
const POSTER: Size = Size { width: 720, height: 540 };

/// The figure with the states as data; empty without states. `name` is that of saved pictures. Its scripts are not in it.
///
/// # Errors
/// If the picture cannot be written.
pub fn figure(name: &str, views: &[&View]) -> Result<Html, PictureError> {
    let Some(last) = views.last() else { return Ok(Html::default()) };
    let poster = STANDARD.encode(Picture::new(last, Quantity::Coordination, POSTER, Ground::Clear).png()?);
    let part = last.part.as_ref().map_or_else(String::new, |part| format!("; {part}"));
    let alt = format!(
        "{} grains in their periodic cell, coloured by the number of their contacts: {}{part}",
        last.grains(),
        last.label
    );
    let about = serde_json::to_string(&encode::about(name, views)).unwrap_or_default();
    let states = views
        .iter()
        .enumerate()
        .map(|(n, view)| data("text/plain", &format!("viewer-state-{n}"), &encode::state(view, views)));
    Ok(stage(&alt, Some(poster)) + data("application/json", "viewer-about", &about) + states.collect())
}

/// The elements, with the picture as base64.
fn stage(alt: &str, poster: Option<String>) -> Html {
    html!(include_str!("../assets/viewer.html"), alt, poster)
}

/// The figure without states, for a page that receives them later: its script shows what [`states`] returns.
pub fn empty_figure() -> Html {
    stage("Grains in their periodic cell", None)
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
    let page = Page {
        title: title.to_owned(),
        heading: heading("grainlab", title, about) + figure(name, views)?,
        styles: vec![STYLE, include_str!("../assets/viewer_page.css")],
        scripts: SCRIPTS.to_vec(),
        ..Page::default()
    };
    Ok(page.text())
}
