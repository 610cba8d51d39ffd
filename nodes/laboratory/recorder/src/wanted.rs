//! Selection of the topics to record.

use regex_lite::Regex;

/// Topics that carry the parameters of nodes, not data.
const OF_PARAMETERS: &str = "/parameter_events";

/// Selects topics by their full names.
#[derive(Clone, Debug)]
pub struct Wanted {
    names: Vec<String>,
    regex: Option<Regex>,
    exclude_regex: Option<Regex>,
    exclude: Vec<String>,
    hidden: bool,
}

fn bare(name: &str) -> String {
    name.trim_start_matches('/').to_owned()
}

impl Wanted {
    /// The topics in `names`, with or without the leading slash, and those that match `regex` as a whole; without either, all.
    /// Left out are those in `exclude`, those that match `exclude_regex`, and, unless `hidden` is set or they are named,
    /// hidden topics (a part of their name begins with an underscore) and parameter events.
    ///
    /// # Errors
    /// If an expression is not valid.
    pub fn new(
        names: &[String],
        regex: Option<&str>,
        exclude_regex: Option<&str>,
        exclude: &[String],
        hidden: bool,
    ) -> Result<Self, regex_lite::Error> {
        // The longest match may be another alternative than the first one.
        let whole = |text: &str| Regex::new(&format!("^(?:{text})$"));
        Ok(Self {
            names: names.iter().map(|name| bare(name)).collect(),
            regex: regex.map(whole).transpose()?,
            exclude_regex: exclude_regex.map(whole).transpose()?,
            exclude: exclude.iter().map(|name| bare(name)).collect(),
            hidden,
        })
    }

    /// True if the topic of this full name is recorded.
    pub fn takes(&self, name: &str) -> bool {
        let is_one = |list: &[String]| list.contains(&bare(name));
        let matches = |regex: &Option<Regex>| regex.as_ref().is_some_and(|r| r.is_match(name));
        if is_one(&self.exclude) || matches(&self.exclude_regex) {
            return false;
        }
        let is_hidden = name == OF_PARAMETERS || name.split('/').any(|part| part.starts_with('_'));
        let all = self.names.is_empty() && self.regex.is_none();
        is_one(&self.names) || (all || matches(&self.regex)) && (self.hidden || !is_hidden)
    }

    /// The topics that are wanted by name, without the leading slash.
    pub(crate) fn names(&self) -> &[String] {
        &self.names
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [&str; 5] =
        ["/stress", "/strain_rate", "/packing", "/arm/_action/feedback", "/parameter_events"];

    fn taken(names: &[&str], regex: Option<&str>, exclude: Option<&str>, left_out: &[&str]) -> [bool; 5] {
        let owned = |list: &[&str]| list.iter().map(ToString::to_string).collect::<Vec<_>>();
        let wanted = Wanted::new(&owned(names), regex, exclude, &owned(left_out), false).unwrap();
        ALL.map(|name| wanted.takes(name))
    }

    #[test]
    fn an_expression_matches_the_whole_name() {
        assert_eq!(taken(&[], None, None, &[]), [true, true, true, false, false]);
        assert_eq!(taken(&[], Some("/str|/stress"), None, &[]), [true, false, false, false, false]);
        assert_eq!(taken(&[], Some("/str.*"), Some(".*rate"), &[]), [true, false, false, false, false]);
        assert_eq!(taken(&[], None, None, &["packing"]), [true, true, false, false, false]);
        assert!(Wanted::new(&[], Some("("), None, &[], false).is_err());
    }

    #[test]
    fn hidden_topics_are_taken_if_asked_for() {
        assert_eq!(taken(&["arm/_action/feedback"], None, None, &[]), [false, false, false, true, false]);
        assert_eq!(
            taken(&["stress", "parameter_events"], None, None, &[]),
            [true, false, false, false, true]
        );
        let wanted = Wanted::new(&[], None, None, &[], true).unwrap();
        assert!(ALL.iter().all(|name| wanted.takes(name)));
    }
}
