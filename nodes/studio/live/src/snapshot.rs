//! Snapshots for browsers: parts of the page, and the packings.

use grainlab_page::Html;
use std::collections::BTreeMap;
use std::sync::Arc;

/// The packings as JSON, and how often they have changed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pictures {
    /// Counts changes from 1.
    pub version: u64,
    /// `about` and `states`, as the viewer takes them.
    pub json: Arc<str>,
}

/// The state of the page at one time. Texts that have not changed are shared with the snapshot before.
#[derive(Clone, Debug, Default)]
pub struct Snapshot {
    /// Markup by the id of its element.
    pub parts: BTreeMap<&'static str, Arc<str>>,
    /// The packings, if the run has published any.
    pub pictures: Option<Pictures>,
}

impl Snapshot {
    /// Sets a part.
    pub fn set(&mut self, id: &'static str, markup: Html) {
        if self.parts.get(id).is_none_or(|known| **known != *markup) {
            self.parts.insert(id, String::from(markup).into());
        }
    }

    /// The events that make a browser with `before` show this: name and data of each.
    pub(crate) fn since(&self, before: &Self) -> Vec<(&'static str, String)> {
        let is_new = |id: &str, text: &Arc<str>| before.parts.get(id).is_none_or(|known| known != text);
        let parts: BTreeMap<&str, &str> = self
            .parts
            .iter()
            .filter(|(id, text)| is_new(id, text))
            .map(|(id, text)| (*id, &**text))
            .collect();
        let mut events = Vec::new();
        if !parts.is_empty() {
            events.push(("parts", serde_json::to_string(&parts).unwrap_or_default()));
        }
        let version = |s: &Self| s.pictures.as_ref().map_or(0, |p| p.version);
        if version(self) != version(before) {
            events.push(("packings", version(self).to_string()));
        }
        events
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_browser_receives_all_at_first_and_then_what_has_changed() {
        let mut first = Snapshot::default();
        first.set("cards", grainlab_page::html!("<b>1</b>"));
        first.set("nodes", "n".into());
        let events = first.since(&Snapshot::default());
        let parts = r#"{"cards":"<b>1</b>","nodes":"n"}"#;
        assert_eq!(events, [("parts", parts.to_owned())]);
        let mut second = first.clone();
        second.set("nodes", "n".into());
        assert!(second.since(&first).is_empty());
        second.set("cards", "2".into());
        second.pictures = Some(Pictures { version: 3, json: "{}".into() });
        let expected = [("parts", r#"{"cards":"2"}"#.to_owned()), ("packings", "3".to_owned())];
        assert_eq!(second.since(&first), expected);
    }
}
