//! The parts of a page with a packing in three dimensions, which needs no other file.

use crate::encode;
use crate::view::View;
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

/// The figure with the states as data; empty without states. `name` is that of saved pictures. Its scripts are not in it.
pub fn figure(name: &str, views: &[&View]) -> Html {
    let Some(last) = views.last() else { return Html::default() };
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
    stage(&alt) + data("application/json", "viewer-about", &about) + states.collect()
}

/// The elements, without states.
fn stage(alt: &str) -> Html {
    html!(include_str!("../assets/viewer.html"), alt)
}

/// The figure without states, for a page that receives them later: its script shows what [`states`] returns.
pub fn empty_figure() -> Html {
    stage("Grains in their periodic cell")
}

/// States of packings as JSON: `about` and `states`, the texts that [`figure`] has as elements.
pub fn states(name: &str, views: &[&View]) -> String {
    let states: Vec<String> = views.iter().map(|view| encode::state(view, views)).collect();
    serde_json::json!({ "about": encode::about(name, views), "states": states }).to_string()
}

/// A page of its own with the figure.
pub fn page(title: &str, about: &str, name: &str, views: &[&View]) -> String {
    let page = Page {
        title: title.to_owned(),
        heading: heading("grainlab", title, about) + figure(name, views),
        styles: vec![STYLE, include_str!("../assets/viewer_page.css")],
        scripts: SCRIPTS.to_vec(),
        ..Page::default()
    };
    page.text()
}
