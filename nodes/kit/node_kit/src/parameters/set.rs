//! The parameter values of a node.

use super::spec::ParameterSpec;
use super::value::{FromParameter, ParameterError, ParameterValue, parameter_text, type_name};
use super::{file, yaml::parse_value};
use crate::{args::RosArgs, lock::lock, names::Names};
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};

/// Every declared parameter with its value, sorted by name. Clones share the values.
#[derive(Clone, Debug)]
pub struct Parameters {
    specs: Arc<[ParameterSpec]>,
    values: Arc<Mutex<BTreeMap<&'static str, ParameterValue>>>,
}

impl Parameters {
    /// Applies files and command line to the declared parameters; files first, later ones win.
    ///
    /// Every given parameter must be for this node and declared by it, of its type and within its range; only what a file
    /// gives to several nodes (`/**`) may be undeclared. An integer is accepted where a double is declared.
    pub fn resolve(
        specs: &[ParameterSpec],
        default_node: &str,
        names: &Names,
        args: &RosArgs,
    ) -> Result<Self, ParameterError> {
        let set = Self::defaults(specs);
        for path in &args.params_files {
            let origin = path.display().to_string();
            for given in file::read(path, &names.fully_qualified())? {
                if given.for_several && set.spec(&given.name).is_none() {
                    log::debug!("{origin}: {} is for another node", given.name);
                    continue;
                }
                set.assign(names, &origin, &given.name, given.value)?;
            }
        }
        for assignment in &args.parameters {
            let name = &assignment.name;
            if let Some(prefix) = assignment.node.as_deref()
                && ![default_node, names.node(), "*", "/**"].contains(&prefix)
            {
                return Err(ParameterError(format!(
                    "-p {prefix}:{name}: this process runs node {}, so the value would be ignored; remove the prefix or \
                     correct it",
                    names.fully_qualified()
                )));
            }
            let value = parse_value(&assignment.value)
                .map_err(|reason| ParameterError(format!("-p: parameter {name:?}: {reason}")))?;
            set.assign(names, "-p", name, value)?;
        }
        Ok(set)
    }

    /// The defaults alone.
    pub fn defaults(specs: &[ParameterSpec]) -> Self {
        let values = specs.iter().map(|s| (s.name, s.default.clone())).collect();
        Self { specs: specs.into(), values: Arc::new(Mutex::new(values)) }
    }

    pub(crate) fn spec(&self, name: &str) -> Option<&ParameterSpec> {
        self.specs.iter().find(|spec| spec.name == name)
    }

    fn assign(
        &self,
        names: &Names,
        origin: &str,
        name: &str,
        value: ParameterValue,
    ) -> Result<(), ParameterError> {
        let Some(spec) = self.spec(name) else {
            let known: Vec<&str> = lock(&self.values).keys().copied().collect();
            let known = if known.is_empty() { "none".into() } else { known.join(", ") };
            let node = names.fully_qualified();
            return Err(ParameterError(format!(
                "{origin}: node {node} has no parameter {name:?}; it has: {known}"
            )));
        };
        let value = coerce(value, &spec.default).map_err(|found| {
            let [expected, of] = [&spec.default, &found].map(type_name);
            let hint = match spec.default {
                ParameterValue::String(_) => "; put it in quotes: \"'text'\"",
                _ => "",
            };
            let found = parameter_text(&found);
            ParameterError(format!(
                "{origin}: parameter {name:?} is of type {expected}, but {found} is of type {of}{hint}"
            ))
        })?;
        if !spec.range.contains(&value) {
            let (value, range) = (parameter_text(&value), spec.range);
            return Err(ParameterError(format!(
                "{origin}: parameter {name:?} = {value} is out of range: {range}"
            )));
        }
        self.change(spec.name, value);
        Ok(())
    }

    /// The value of a declared parameter now.
    ///
    /// # Panics
    /// If the node does not declare `name` or declares it with another type: a mistake in the node's code, found by its
    /// first test.
    pub fn get<T: FromParameter>(&self, name: &str) -> T {
        let values = lock(&self.values);
        let value = values.get(name).unwrap_or_else(|| panic!("parameter {name:?} is not declared"));
        T::from_parameter(value).unwrap_or_else(|| panic!("parameter {name:?} is a {}", type_name(value)))
    }

    pub(crate) fn snapshot(&self) -> BTreeMap<&'static str, ParameterValue> {
        lock(&self.values).clone()
    }

    /// Replaces a value that was checked.
    pub(crate) fn change(&self, name: &str, value: ParameterValue) {
        if let Some(held) = lock(&self.values).get_mut(name) {
            *held = value;
        }
    }
}

/// Converts `value` to the type of `like` where this is exact; else returns it unchanged.
pub(crate) fn coerce(value: ParameterValue, like: &ParameterValue) -> Result<ParameterValue, ParameterValue> {
    use ParameterValue as V;
    match (value, like) {
        (V::Integer(v), V::Double(_)) => Ok(V::Double(v as f64)),
        (V::IntegerArray(v), V::DoubleArray(_)) => {
            Ok(V::DoubleArray(v.into_iter().map(|v| v as f64).collect()))
        }
        // An empty list has no type.
        (V::IntegerArray(v), V::StringArray(_)) if v.is_empty() => Ok(V::StringArray(Vec::new())),
        (V::IntegerArray(v), V::BooleanArray(_)) if v.is_empty() => Ok(V::BooleanArray(Vec::new())),
        (value, like) if type_name(&value) == type_name(like) => Ok(value),
        (value, _) => Err(value),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parameters::spec::Range;

    fn specs() -> Vec<ParameterSpec> {
        vec![
            ParameterSpec::new("dt", 1e-6, "time step, s").within(Range::Positive),
            ParameterSpec::new("seed", 1_i64, "seed").within(Range::Integer { min: 0, max: i64::MAX }),
            ParameterSpec::new("scene", "demo", "scene"),
            ParameterSpec::new("law", "scaled", "law").within(Range::Choice(&["scaled", "literal"])),
            ParameterSpec::new("mu", vec![0.1], "friction of each phase")
                .within(Range::Double { min: 0.0, max: f64::INFINITY }),
        ]
    }

    fn resolve(args: &[&str]) -> Result<Parameters, ParameterError> {
        let owned: Vec<String> =
            std::iter::once("--ros-args").chain(args.iter().copied()).map(Into::into).collect();
        let (ros, _) = RosArgs::parse(&owned).expect("valid arguments");
        let names = Names::from_args("dem", &ros).expect("valid names");
        Parameters::resolve(&specs(), "dem", &names, &ros)
    }

    #[test]
    fn the_command_line_wins_over_files_and_the_last_one_wins() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("run.yaml");
        std::fs::write(&path, "/**:\n  ros__parameters: {dt: 5e-7, seed: 9}\n").unwrap();
        let file = path.to_str().unwrap();
        let set = resolve(&["-p", "dt:=1e-7", "--params-file", file, "-p", "dem:dt:=2e-7"]).unwrap();
        assert_eq!(set.get::<f64>("dt"), 2e-7);
        assert_eq!(set.get::<i64>("seed"), 9);
        assert_eq!(set.get::<String>("scene"), "demo", "untouched ones keep their default");
    }

    #[test]
    fn what_a_file_gives_to_several_nodes_may_be_undeclared_and_what_it_gives_to_this_one_may_not() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("all.yaml");
        let file = path.to_str().unwrap().to_owned();
        std::fs::write(&path, "/**:\n  ros__parameters: {dt: 2e-7, other: 3}\n").unwrap();
        assert_eq!(resolve(&["--params-file", &file]).unwrap().get::<f64>("dt"), 2e-7);
        std::fs::write(&path, "dem:\n  ros__parameters: {other: 3}\n").unwrap();
        assert!(resolve(&["--params-file", &file]).is_err());
    }

    #[test]
    fn integers_are_taken_for_doubles_and_nothing_else_is_converted() {
        let set = resolve(&["-p", "dt:=1", "-p", "mu:=[1, 2]", "-p", "scene:='12'"]).unwrap();
        assert_eq!(set.get::<f64>("dt"), 1.0);
        assert_eq!(set.get::<Vec<f64>>("mu"), [1.0, 2.0]);
        assert_eq!(set.get::<String>("scene"), "12");
        for (argument, needle) in [("seed:=1.5", "double"), ("scene:=12", "quotes"), ("dt:=fast", "string")] {
            let error = resolve(&["-p", argument]).expect_err(argument).to_string();
            assert!(error.contains(needle), "{argument}: {error}");
        }
    }

    #[test]
    fn an_unknown_parameter_is_named_with_what_exists() {
        let error = resolve(&["-p", "dtt:=1"]).unwrap_err().to_string();
        assert!(error.contains("\"dtt\"") && error.contains("dt, law, mu, scene, seed"), "{error}");
    }

    #[test]
    fn values_out_of_range_and_nan_are_refused_with_the_range() {
        for (argument, needle) in [
            ("dt:=0", "greater than 0"),
            ("dt:=.inf", "greater than 0"),
            ("dt:=.nan", "greater than 0"),
            ("seed:=-1", "at least 0"),
            ("law:=pid", "scaled, literal"),
            ("mu:=[0.1, -0.1]", "at least 0"),
            ("mu:=[.nan]", "at least 0"),
        ] {
            let error = resolve(&["-p", argument]).expect_err(argument).to_string();
            assert!(error.contains(needle), "{argument}: {error}");
        }
        assert_eq!(resolve(&["-p", "mu:=[.inf]"]).unwrap().get::<Vec<f64>>("mu"), [f64::INFINITY]);
    }

    #[test]
    fn a_prefix_for_another_node_is_an_error_rather_than_a_lost_value() {
        let error = resolve(&["-p", "servo:dt:=1"]).unwrap_err().to_string();
        assert!(error.contains("remove the prefix"), "{error}");
        assert!(
            resolve(&["-r", "__node:=sim", "-p", "sim:dt:=1"]).is_ok(),
            "the new name of this node is its name"
        );
    }
}
