//! The parameters of the node acoustic_probe as flags: with the same names, ranges and descriptions.

use clap::{Arg, ArgMatches, Command, FromArgMatches};
use grainlab_acoustic_probe::{Settings, methods_with, parameters};
use grainlab_console::Failure;
use grainlab_launcher::NodeKind;
use grainlab_node_kit::{Names, ParameterSpec, ParameterValue, Parameters, Range, RosArgs, parameter_text};

const NODE: NodeKind = NodeKind::AcousticProbe;

/// The values given, by the name of the parameter.
#[derive(Clone, Debug, Default)]
pub(super) struct Flags(Vec<(&'static str, String)>);

impl Flags {
    pub(super) fn of(given: &[(String, String)]) -> Result<Self, Failure> {
        let specs = parameters();
        let one = |(name, text): &(String, String)| {
            let spec = specs.iter().find(|spec| spec.name == name);
            let known = || specs.iter().map(|spec| spec.name).collect::<Vec<_>>().join(", ");
            let spec =
                spec.ok_or_else(|| Failure::usage(format!("no parameter {name}; there are: {}", known())))?;
            Ok((spec.name, text.clone()))
        };
        given.iter().map(one).collect::<Result<_, _>>().map(Self)
    }

    pub(super) fn settings(&self) -> Result<Settings, Failure> {
        let specs = parameters();
        let mut words = vec!["--ros-args".to_owned()];
        for (name, text) in &self.0 {
            let Some(spec) = specs.iter().find(|s| s.name == *name) else { continue };
            words.extend(["-p".to_owned(), format!("{name}:={}", yaml(spec, text))]);
        }
        let (ros, _) = RosArgs::parse(&words).map_err(Failure::usage)?;
        let names = Names::new(NODE.name()).map_err(Failure::usage)?;
        let parameters = Parameters::resolve(&specs, NODE.name(), &names, &ros);
        // The message refers to a flag, not to -p.
        let named = |e: &dyn std::fmt::Display| Failure::usage(e.to_string().replacen("-p: ", "", 1));
        let parameters = parameters.map_err(|e| named(&e))?;
        self.without_effect(&specs, &parameters)?;
        Settings::try_from(&parameters).map_err(|e| named(&e))
    }

    /// Refuses a flag that the method does not use, unless its value is the default.
    fn without_effect(&self, specs: &[ParameterSpec], parameters: &Parameters) -> Result<(), Failure> {
        let method: String = parameters.get("method");
        for (name, text) in &self.0 {
            let default = specs.iter().find(|s| s.name == *name).map(|s| &s.default);
            let is_default = match default {
                Some(ParameterValue::Double(v)) => parameters.get::<f64>(name) == *v,
                Some(ParameterValue::Integer(v)) => parameters.get::<i64>(name) == *v,
                Some(ParameterValue::DoubleArray(v)) => parameters.get::<Vec<f64>>(name) == *v,
                _ => false,
            };
            let others = methods_with(name).filter(|methods| !methods.contains(&method.as_str()));
            if let Some(methods) = others.filter(|_| !is_default) {
                return Err(Failure::usage(format!(
                    "--{} {text} has no effect with --method {method}: it is for {}",
                    name.replace('_', "-"),
                    methods.join(", ")
                )));
            }
        }
        Ok(())
    }
}

/// A value from the shell, as YAML.
fn yaml(spec: &ParameterSpec, text: &str) -> String {
    match &spec.default {
        ParameterValue::String(_) => serde_json::Value::from(text).to_string(),
        ParameterValue::DoubleArray(_) if !text.starts_with('[') => format!("[{text}]"),
        ParameterValue::Double(_) if text == "inf" => ".inf".to_owned(),
        _ => text.to_owned(),
    }
}

fn flag(spec: &ParameterSpec) -> Arg {
    let value = match &spec.default {
        ParameterValue::Double(_) => "NUMBER",
        ParameterValue::Integer(_) => "N",
        ParameterValue::DoubleArray(_) => "NUMBER,...",
        _ => "TEXT",
    };
    let default = match &spec.default {
        ParameterValue::String(text) => text.clone(),
        other => parameter_text(other),
    };
    let mut help = format!("{} [default: {default}", spec.description);
    if spec.range != Range::Any {
        help += &format!("; {}", spec.range);
    }
    Arg::new(spec.name)
        .long(spec.name.replace('_', "-"))
        .value_name(value)
        .help(help + "]")
        .help_heading("Measurement, as the parameters of the node acoustic_probe")
}

impl clap::Args for Flags {
    fn augment_args(command: Command) -> Command {
        command.args(parameters().iter().map(flag))
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl FromArgMatches for Flags {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let given = |spec: ParameterSpec| Some((spec.name, matches.get_one::<String>(spec.name)?.clone()));
        Ok(Self(parameters().into_iter().filter_map(given).collect()))
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Args as _;
    use grainlab_acoustics::MethodSettings;

    fn settings(words: &[&str]) -> Result<Settings, String> {
        let command = Flags::augment_args(Command::new("probe").allow_negative_numbers(true));
        let matches =
            command.try_get_matches_from([&["probe"], words].concat()).map_err(|e| e.to_string())?;
        Flags::from_arg_matches(&matches).unwrap().settings().map_err(|e| e.to_string())
    }

    #[test]
    fn every_parameter_is_a_flag_and_none_given_are_the_defaults() {
        assert_eq!(settings(&[]).unwrap(), Settings::default());
        for spec in parameters() {
            let flag = format!("--{}", spec.name.replace('_', "-"));
            let text = match &spec.default {
                ParameterValue::String(text) => text.clone(),
                ParameterValue::DoubleArray(list) if list.is_empty() => continue,
                ParameterValue::Double(v) if v.is_infinite() => "inf".to_owned(),
                other => parameter_text(other).replace(['[', ']', ' '], ""),
            };
            assert_eq!(settings(&[&flag, &text]).unwrap(), Settings::default(), "{flag} {text}");
        }
    }

    #[test]
    fn lists_and_axes_are_typed_as_elsewhere() {
        let s = settings(&["--wavelengths", "30,40,60", "--axis", "0,0,2", "--seed", "7"]).unwrap().0;
        let MethodSettings::Dispersion(d) = s.method else { panic!("the default") };
        assert_eq!((d.wavelengths, s.axis), (vec![30.0, 40.0, 60.0], Some(grainlab_core::Vec3::z())));
        assert_eq!(s.instrument.seed, 7);
    }

    #[test]
    fn a_flag_that_the_method_does_not_use_is_refused() {
        for (words, flag, methods) in [
            (&["--signal-to-noise", "0"][..], "--signal-to-noise", "first_arrival, cross_correlation"),
            (&["--jitter", "0.1"], "--jitter", "peak"),
            (&["--shots", "5"], "--shots", "cross_correlation"),
            (&["--cycles", "3"], "--cycles", "first_arrival"),
            (&["--method", "peak", "--wavelengths", "30,40,60"], "--wavelengths", "dispersion"),
        ] {
            let error = settings(words).unwrap_err();
            assert!(
                error.contains(flag) && error.contains("no effect") && error.contains(methods),
                "{error}"
            );
        }
        assert!(settings(&["--method", "peak", "--shots", "5", "--jitter", "1e-9"]).is_ok());
    }

    #[test]
    fn a_negative_friction_that_is_not_that_of_the_packing_is_refused() {
        let with = |mu| settings(&["--method", "peak", "--wave-friction", mu]);
        assert!(with("-0.5").unwrap_err().contains("wave_friction"));
        assert!(with("-1").is_ok() && with("0").is_ok());
    }
}
