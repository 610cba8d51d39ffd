//! Topics by regular expressions on their names.

use grainlab_console::Failure;
use regex::Regex;

/// An expression that matches whole names only: the longest match may be another alternative than the first one.
pub(crate) fn whole(text: &str) -> Result<Regex, regex::Error> {
    Regex::new(&format!("^(?:{text})$"))
}

/// Which names are taken.
#[derive(Clone, Debug)]
pub struct TopicNames {
    regex: Option<Regex>,
    exclude_regex: Option<Regex>,
    exclude: Vec<String>,
}

impl TopicNames {
    /// Names that match `regex` as a whole, if there is one, without those that match `exclude_regex` or are in `exclude`, with
    /// or without the leading slash.
    ///
    /// # Errors
    /// If an expression is not valid: exit 2.
    pub fn new(
        regex: Option<&str>,
        exclude_regex: Option<&str>,
        exclude: &[String],
    ) -> Result<Self, Failure> {
        let whole = |text: &str| whole(text).map_err(Failure::usage);
        Ok(Self {
            regex: regex.map(whole).transpose()?,
            exclude_regex: exclude_regex.map(whole).transpose()?,
            exclude: exclude.iter().map(|name| name.trim_start_matches('/').to_owned()).collect(),
        })
    }

    /// Whether the topic of this full name is taken.
    pub fn take(&self, name: &str) -> bool {
        let matches = |regex: &Option<Regex>, default| regex.as_ref().map_or(default, |r| r.is_match(name));
        let excluded = self.exclude.iter().any(|n| n == name.trim_start_matches('/'));
        matches(&self.regex, true) && !matches(&self.exclude_regex, false) && !excluded
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_expression_matches_the_whole_name() {
        let of = |regex: Option<&str>, exclude: Option<&str>, names: &[&str]| {
            let names: Vec<String> = names.iter().map(ToString::to_string).collect();
            let taken = TopicNames::new(regex, exclude, &names).unwrap();
            ["/stress", "/strain_rate", "/packing"].map(|name| taken.take(name))
        };
        assert_eq!(of(None, None, &[]), [true, true, true]);
        assert_eq!(of(Some("/str|/stress"), None, &[]), [true, false, false]);
        assert_eq!(of(Some("/str.*"), Some(".*rate"), &[]), [true, false, false]);
        assert_eq!(of(None, None, &["packing"]), [true, true, false]);
        assert!(TopicNames::new(Some("("), None, &[]).is_err());
    }
}
