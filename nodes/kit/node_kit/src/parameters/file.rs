//! ROS 2 parameter files: node keys (`/**`, `/ns/node`, nested namespaces), then `ros__parameters`.

use super::value::{ParameterError, ParameterValue};
use super::yaml::Yaml;
use grainlab_console::input;
use std::path::Path;

const PARAMETERS_KEY: &str = "ros__parameters";

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Given {
    /// Name, groups joined by dots.
    pub(super) name: String,
    pub(super) value: ParameterValue,
    /// It stands under a key with wildcards, which is for several nodes: one that does not declare it leaves it out.
    pub(super) for_several: bool,
}

/// The parameters that the file gives to `node` (fully qualified), in the order of the file.
///
/// A file without a key for the node is an error: it would be ignored without a message.
pub(super) fn read(path: &Path, node: &str) -> Result<Vec<Given>, ParameterError> {
    let text = input::text(path, input::SETTINGS)
        .map_err(|e| ParameterError(format!("{}: cannot read: {e}", path.display())))?;
    parse(&text, path, node)
}

fn parse(text: &str, path: &Path, node: &str) -> Result<Vec<Given>, ParameterError> {
    let file_error = |reason: String| ParameterError(format!("{}: {reason}", path.display()));
    let mut sections = Vec::new();
    collect_sections("", Yaml::parse(text).map_err(file_error)?, &mut sections).map_err(file_error)?;
    if !sections.iter().any(|(key, _)| matches(key, node)) {
        let keys: Vec<&str> = sections.iter().map(|(key, _)| key.as_str()).collect();
        let keys = if keys.is_empty() { "none".into() } else { keys.join(", ") };
        return Err(file_error(format!(
            "no key is for node {node}, so the file would be ignored; its keys: {keys}"
        )));
    }
    let mut given = Vec::new();
    for (key, parameters) in sections.into_iter().filter(|(key, _)| matches(key, node)) {
        let mut values = Vec::new();
        flatten("", parameters, &mut values).map_err(file_error)?;
        let for_several = key.contains('*');
        given.extend(values.into_iter().map(|(name, value)| Given { name, value, for_several }));
    }
    Ok(given)
}

/// Finds every `ros__parameters` and the node key above it.
fn collect_sections(key: &str, yaml: Yaml, sections: &mut Vec<(String, Yaml)>) -> Result<(), String> {
    let Yaml::Map(entries) = yaml else {
        let place = if key.is_empty() { "the top" } else { key };
        return Err(format!("at {place}: expected node keys with {PARAMETERS_KEY} under them"));
    };
    for (name, value) in entries {
        if name == PARAMETERS_KEY {
            if key.is_empty() {
                return Err(format!(
                    "{PARAMETERS_KEY} is at the top level: put a node key such as /** above it"
                ));
            }
            sections.push((key.into(), value));
        } else {
            collect_sections(&format!("{key}/{}", name.trim_start_matches('/')), value, sections)?;
        }
    }
    Ok(())
}

/// Turns nested groups into dotted names.
fn flatten(prefix: &str, yaml: Yaml, values: &mut Vec<(String, ParameterValue)>) -> Result<(), String> {
    let Yaml::Map(entries) = yaml else {
        return Err(format!("{PARAMETERS_KEY} must hold name: value lines"));
    };
    for (name, value) in entries {
        let name = if prefix.is_empty() { name } else { format!("{prefix}.{name}") };
        if matches!(value, Yaml::Map(_)) {
            flatten(&name, value, values)?;
        } else {
            let value = value.into_value().map_err(|reason| format!("parameter {name:?}: {reason}"))?;
            values.push((name, value));
        }
    }
    Ok(())
}

/// True if a node key is for `node`: `*` matches one token, `**` for any number of them.
fn matches(key: &str, node: &str) -> bool {
    fn tokens_match(key: &[&str], node: &[&str]) -> bool {
        match (key, node) {
            ([], []) => true,
            (["**", rest @ ..], _) => (0..=node.len()).any(|skipped| tokens_match(rest, &node[skipped..])),
            (["*", rest @ ..], [_, others @ ..]) => tokens_match(rest, others),
            ([first, rest @ ..], [token, others @ ..]) if first == token => tokens_match(rest, others),
            _ => false,
        }
    }
    let [key, node] = [key, node].map(|text| text.split('/').filter(|t| !t.is_empty()).collect::<Vec<_>>());
    tokens_match(&key, &node)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read_text(text: &str, node: &str) -> Result<Vec<(String, ParameterValue)>, ParameterError> {
        let given = parse(text, Path::new("run.yaml"), node)?;
        Ok(given.into_iter().map(|given| (given.name, given.value)).collect())
    }

    #[test]
    fn keys_match_by_name_wildcard_and_nested_namespace() {
        for (key, node, expected) in [
            ("/**", "/a/b/servo", true),
            ("/servo", "/servo", true),
            ("/servo", "/a/servo", false),
            ("/**/servo", "/a/b/servo", true),
            ("/**/servo", "/servo", true),
            ("/*/servo", "/a/servo", true),
            ("/*/servo", "/a/b/servo", false),
            ("/serv", "/servo", false),
        ] {
            assert_eq!(matches(key, node), expected, "{key} for {node}");
        }
        let nested = "lab:\n  servo:\n    ros__parameters: {gain: 2.0}\n";
        assert_eq!(read_text(nested, "/lab/servo").unwrap(), [("gain".into(), ParameterValue::Double(2.0))]);
    }

    #[test]
    fn groups_become_dotted_names_and_later_sections_come_later() {
        let text = "/**:\n  ros__parameters:\n    gain: 1\n    limits: {rate: 2.5, names: [a, b]}\nservo:\n  ros__parameters:\n    gain: 3\n";
        let values = read_text(text, "/servo").unwrap();
        assert_eq!(
            values,
            [
                ("gain".into(), ParameterValue::Integer(1)),
                ("limits.rate".into(), ParameterValue::Double(2.5)),
                ("limits.names".into(), ParameterValue::StringArray(vec!["a".into(), "b".into()])),
                ("gain".into(), ParameterValue::Integer(3)),
            ]
        );
    }

    #[test]
    fn any_scalar_is_a_name() {
        let text = "/**:\n  ros__parameters: {1: 2, y: 3, on: 4, true: 5, 1.5: 6}\n";
        let names: Vec<String> =
            read_text(text, "/servo").unwrap().into_iter().map(|(name, _)| name).collect();
        assert_eq!(names, ["1", "y", "on", "true", "1.5"]);
    }

    #[test]
    fn a_file_that_is_not_for_this_node_is_refused_naming_both() {
        let error = read_text("dem:\n  ros__parameters: {dt: 1.0}\n", "/lab/servo").unwrap_err();
        let text = error.to_string();
        assert!(text.contains("/lab/servo") && text.contains("/dem") && text.contains("run.yaml"), "{text}");
    }

    #[test]
    fn the_error_of_an_invalid_file_has_the_place() {
        for (text, needle) in [
            ("ros__parameters: {dt: 1}", "is at the top level"),
            ("- 1\n- 2\n", "node keys"),
            ("servo:\n  dt: 1\n", "/servo/dt"),
            ("/**:\n  ros__parameters:\n    a: [1, x]\n", "one type"),
            ("/**:\n  ros__parameters:\n    a:\n", "\"a\""),
            ("/**: [unclosed", "run.yaml"),
        ] {
            let error = read_text(text, "/servo").expect_err(text).to_string();
            assert!(error.contains(needle), "{text}: {error}");
        }
    }

    #[test]
    fn a_file_that_may_be_endless_or_is_too_large_is_refused_before_it_is_read() {
        let folder = tempfile::tempdir().unwrap();
        let large = folder.path().join("large.yaml");
        std::fs::write(&large, "#".repeat(2 << 20)).unwrap();
        for (path, cause) in [(Path::new("/dev/null"), "it is a device"), (&large, "more than 1048576 bytes")]
        {
            let ParameterError(error) = read(path, "/servo").unwrap_err();
            assert!(error.contains(cause), "{error}");
        }
    }
}
