//! Topics on the command line.

use regex_lite::Regex;
use std::collections::BTreeSet;

/// Topics that carry the parameters of nodes, not data.
const OF_PARAMETERS: &str = "/parameter_events";

/// Topics, by name or regular expression.
#[derive(Clone, Debug, Default, clap::Args)]
pub struct TopicNames {
    /// Topics to take, by name [default: all]
    #[arg(long, num_args = 1.., value_name = "TOPIC")]
    pub topics: Vec<String>,
    /// Topics to take, by a regular expression that matches their whole name
    #[arg(long, value_name = "REGEX", value_parser = whole)]
    pub regex: Option<Regex>,
    /// Topics to leave out of those, by name
    #[arg(long, visible_alias = "exclude-topics", num_args = 1.., value_name = "TOPIC")]
    pub exclude: Vec<String>,
    /// Topics to leave out of those, by a regular expression that matches their whole name
    #[arg(long, value_name = "REGEX", value_parser = whole)]
    pub exclude_regex: Option<Regex>,
    /// True if the names are complete, with their slash.
    #[arg(skip)]
    exact: bool,
}

/// An expression that matches whole names only: the longest match may be another alternative than the first one.
fn whole(text: &str) -> Result<Regex, regex_lite::Error> {
    Regex::new(&format!("^(?:{text})$"))
}

impl TopicNames {
    /// Selection by the complete names of these topics: two of them may differ by the leading slash, then the name as typed counts.
    pub fn among(&self, known: &BTreeSet<&str>) -> Self {
        let bare = |name: &str| name.trim_start_matches('/').to_owned();
        let complete = |names: &[String]| {
            let of = |name: &String| match known.contains(name.as_str()) {
                true => vec![name.clone()],
                false => known.iter().filter(|k| bare(k) == bare(name)).map(ToString::to_string).collect(),
            };
            names.iter().flat_map(of).collect()
        };
        Self { topics: complete(&self.topics), exclude: complete(&self.exclude), exact: true, ..self.clone() }
    }

    /// True if the topic of this full name is taken. `of_type` says whether its type is one of those asked for, if any are.
    /// Unless `hidden` is set or they are named, hidden topics (a part of their name begins with an underscore) and parameter
    /// events are left out.
    pub fn take(&self, name: &str, of_type: Option<bool>, hidden: bool) -> bool {
        let bare = name.trim_start_matches('/');
        let is_one = |names: &[String]| {
            names.iter().any(|n| n == name || !self.exact && n.trim_start_matches('/') == bare)
        };
        let matches = |regex: &Option<Regex>| regex.as_ref().is_some_and(|r| r.is_match(name));
        let is_hidden = name == OF_PARAMETERS || name.split('/').any(|part| part.starts_with('_'));
        let all = self.topics.is_empty() && self.regex.is_none() && of_type.is_none();
        let found = all || matches(&self.regex) || of_type == Some(true);
        let taken = is_one(&self.topics) || found && (hidden || !is_hidden);
        taken && !is_one(&self.exclude) && !matches(&self.exclude_regex)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [&str; 5] =
        ["/stress", "/strain_rate", "/packing", "/arm/_action/feedback", "/parameter_events"];

    fn taken(names: &[&str], regex: Option<&str>, exclude: Option<&str>, left_out: &[&str]) -> [bool; 5] {
        let owned = |list: &[&str]| list.iter().map(ToString::to_string).collect::<Vec<_>>();
        let [regex, exclude_regex] = [regex, exclude].map(|text| text.map(|text| whole(text).unwrap()));
        let names =
            TopicNames { topics: owned(names), regex, exclude: owned(left_out), exclude_regex, exact: false };
        ALL.map(|name| names.take(name, None, false))
    }

    #[test]
    fn an_expression_matches_the_whole_name() {
        assert_eq!(taken(&[], None, None, &[]), [true, true, true, false, false]);
        assert_eq!(taken(&[], Some("/str|/stress"), None, &[]), [true, false, false, false, false]);
        assert_eq!(taken(&[], Some("/str.*"), Some(".*rate"), &[]), [true, false, false, false, false]);
        assert_eq!(taken(&[], None, None, &["packing"]), [true, true, false, false, false]);
        assert!(whole("(").is_err());
    }

    #[test]
    fn a_name_as_typed_is_taken_before_one_that_differs_by_its_slash() {
        let typed = |name: &str| TopicNames { topics: vec![name.to_owned()], ..TopicNames::default() };
        let known = BTreeSet::from(["foo", "/foo", "/bar"]);
        for (name, expected) in [("foo", vec!["foo"]), ("/foo", vec!["/foo"]), ("bar", vec!["/bar"])] {
            let names = typed(name).among(&known);
            let taken: Vec<&str> =
                ["foo", "/foo", "/bar"].into_iter().filter(|n| names.take(n, None, true)).collect();
            assert_eq!(taken, expected);
        }
    }

    #[test]
    fn hidden_topics_are_taken_if_asked_for() {
        assert_eq!(taken(&["arm/_action/feedback"], None, None, &[]), [false, false, false, true, false]);
        assert_eq!(
            taken(&["stress", "parameter_events"], None, None, &[]),
            [true, false, false, false, true]
        );
        assert!(ALL.iter().all(|name| TopicNames::default().take(name, None, true)));
        assert!(!TopicNames::default().take("/stress", Some(false), true));
    }
}
