//! Names of nodes and topics: validation, expansion and remapping, as ROS 2 defines them.

use crate::args::RosArgs;

/// Why a name is refused.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct NameError(String);

/// Checks one token of a name: `[A-Za-z_][A-Za-z0-9_]*`.
fn check_token(token: &str, name: &str) -> Result<(), NameError> {
    let Some(first) = token.chars().next() else {
        return Err(NameError(format!(
            "name {name:?} has an empty part: write tokens separated by single slashes, as in /lab/stress"
        )));
    };
    if let Some(found) = token.chars().find(|c| !(c.is_ascii_alphanumeric() || *c == '_')) {
        return Err(NameError(format!(
            "name {name:?} contains {found:?}: only letters, digits and underscores are allowed between slashes"
        )));
    }
    if first.is_ascii_digit() {
        return Err(NameError(format!(
            "name {name:?} has a part that begins with a digit: begin it with a letter or an underscore"
        )));
    }
    Ok(())
}

/// The names of a node and its topics: node name, namespace and the remap rules that apply.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Names {
    node: String,
    namespace: String,
    /// Fully qualified `from` and `to`, in the order given; the first match wins.
    remaps: Vec<(String, String)>,
}

impl Names {
    /// A node in the root namespace with no remaps.
    pub fn new(node: &str) -> Result<Self, NameError> {
        check_token(node, node)?;
        Ok(Self { node: node.into(), namespace: "/".into(), remaps: Vec::new() })
    }

    /// A node in a namespace, such as `/exp1`.
    pub fn in_namespace(node: &str, namespace: &str) -> Result<Self, NameError> {
        let mut names = Self::new(node)?;
        names.namespace = checked_namespace(namespace)?;
        Ok(names)
    }

    /// The names from `args` for a node with the default name `default_node`.
    ///
    /// Rules with a node prefix (`node:from:=to`) apply when the prefix is `default_node`, as in rcl.
    pub fn from_args(default_node: &str, args: &RosArgs) -> Result<Self, NameError> {
        let mut names = Self::new(default_node)?;
        let rules = || args.remaps.iter().filter(|r| r.node.as_deref().is_none_or(|n| n == default_node));
        if let Some(rule) = rules().find(|r| r.name == "__node" || r.name == "__name") {
            check_token(&rule.value, &rule.value)?;
            names.node = rule.value.clone();
        }
        if let Some(rule) = rules().find(|r| r.name == "__ns") {
            names.namespace = checked_namespace(&rule.value)?;
        }
        for rule in rules().filter(|r| !r.name.starts_with("__")) {
            let pair = (names.expand(&rule.name)?, names.expand(&rule.value)?);
            names.remaps.push(pair);
        }
        Ok(names)
    }

    /// Names with this namespace and these remaps for another node.
    #[must_use]
    pub fn for_node(self, node: &str) -> Self {
        Self { node: node.into(), ..self }
    }

    /// The node's base name, as in `dem_simulator`.
    pub fn node(&self) -> &str {
        &self.node
    }

    /// The namespace: `/`, or `/a/b` without a slash at the end.
    pub fn namespace(&self) -> &str {
        &self.namespace
    }

    /// The fully qualified node name, as in `/exp1/dem_simulator`.
    pub fn fully_qualified(&self) -> String {
        join(&self.namespace, &self.node)
    }

    /// The resolved name of a topic: expanded with the namespace, then remapped.
    pub fn resolve(&self, topic: &str) -> Result<String, NameError> {
        let expanded = self.expand(topic)?;
        Ok(self.remaps.iter().find(|(from, _)| *from == expanded).map_or(expanded, |(_, to)| to.clone()))
    }

    /// A remapped name that is neither one of `topics` nor below the node's own name, as its services are.
    pub fn unknown_remap<'a>(&self, topics: impl IntoIterator<Item = &'a str>) -> Option<&str> {
        let known: Vec<String> = topics.into_iter().filter_map(|topic| self.expand(topic).ok()).collect();
        let own = self.fully_qualified() + "/";
        let is_known = |from: &&String| known.contains(*from) || from.starts_with(&own);
        self.remaps.iter().map(|(from, _)| from).find(|from| !is_known(from)).map(String::as_str)
    }

    /// Makes a name absolute: `x` becomes `/ns/x`, `~/x` becomes `/ns/node/x`, `/x` stays.
    fn expand(&self, name: &str) -> Result<String, NameError> {
        let absolute = if let Some(rest) = name.strip_prefix("~/") {
            join(&self.fully_qualified(), rest)
        } else if name == "~" {
            self.fully_qualified()
        } else if name.starts_with('/') {
            name.into()
        } else {
            join(&self.namespace, name)
        };
        for token in absolute[1..].split('/') {
            check_token(token, name)?;
        }
        Ok(absolute)
    }
}

fn join(namespace: &str, name: &str) -> String {
    format!("{}/{name}", namespace.strip_suffix('/').unwrap_or(namespace))
}

/// Validates a namespace and removes a slash at its end.
fn checked_namespace(namespace: &str) -> Result<String, NameError> {
    if !namespace.starts_with('/') {
        return Err(NameError(format!("namespace {namespace:?} must begin with a slash, as in __ns:=/lab")));
    }
    let trimmed = namespace.trim_end_matches('/');
    if trimmed.is_empty() {
        return Ok("/".into());
    }
    for token in trimmed[1..].split('/') {
        check_token(token, namespace)?;
    }
    Ok(trimmed.into())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(args: &[&str]) -> Names {
        let owned: Vec<String> =
            std::iter::once("--ros-args").chain(args.iter().copied()).map(Into::into).collect();
        let (ros, rest) = RosArgs::parse(&owned).expect("valid arguments");
        assert!(rest.is_empty());
        Names::from_args("servo", &ros).expect("valid names")
    }

    #[test]
    fn relative_private_and_absolute_names_expand_as_in_ros() {
        let n = names(&["-r", "__ns:=/lab/a", "-r", "__node:=s1"]);
        assert_eq!(n.resolve("stress").unwrap(), "/lab/a/stress");
        assert_eq!(n.resolve("~/state").unwrap(), "/lab/a/s1/state");
        assert_eq!(n.resolve("/clock").unwrap(), "/clock");
        assert_eq!(n.fully_qualified(), "/lab/a/s1");
    }

    #[test]
    fn the_root_namespace_adds_no_second_slash() {
        assert_eq!(names(&[]).resolve("stress").unwrap(), "/stress");
        assert_eq!(names(&["-r", "__ns:=/"]).fully_qualified(), "/servo");
    }

    #[test]
    fn a_remap_of_no_topic_is_found() {
        let of = |rule: &str| {
            let (ros, _) =
                RosArgs::parse(&["--ros-args", "-r", "__ns:=/lab", "-r", rule].map(str::to_owned)).unwrap();
            let names = Names::from_args("dem", &ros).unwrap();
            names.unknown_remap(["stress", "/clock"]).map(str::to_owned)
        };
        for rule in ["stress:=p", "/lab/stress:=/p", "/clock:=/time", "~/get_parameters:=/get"] {
            assert_eq!(of(rule), None, "{rule}");
        }
        assert_eq!(of("stresss:=p").as_deref(), Some("/lab/stresss"));
        assert_eq!(of("clock:=time").as_deref(), Some("/lab/clock"), "the clock is in no namespace");
    }

    #[test]
    fn remaps_match_expanded_names_and_the_first_rule_wins() {
        let n = names(&["-r", "__ns:=/lab", "-r", "stress:=p2", "-r", "/lab/stress:=other", "-r", "~/x:=/y"]);
        assert_eq!(n.resolve("stress").unwrap(), "/lab/p2");
        assert_eq!(n.resolve("/lab/stress").unwrap(), "/lab/p2");
        assert_eq!(n.resolve("~/x").unwrap(), "/y");
        assert_eq!(
            n.resolve("/stress").unwrap(),
            "/stress",
            "an absolute name outside the namespace is another topic"
        );
    }

    #[test]
    fn a_rule_for_another_node_does_not_apply() {
        let n = names(&["-r", "dem:stress:=a", "-r", "servo:stress:=b", "-r", "dem:__ns:=/x"]);
        assert_eq!(n.resolve("stress").unwrap(), "/b");
    }

    #[test]
    fn bad_names_are_refused_with_the_name() {
        let n = names(&[]);
        for bad in ["", "a//b", "a/", "1a", "a-b", "~x", "/"] {
            let error = n.resolve(bad).expect_err(bad).to_string();
            assert!(error.contains(&format!("{bad:?}")), "{error}");
        }
        assert!(Names::in_namespace("n", "lab").unwrap_err().to_string().contains("begin with a slash"));
        assert!(Names::new("a/b").is_err());
    }
}
