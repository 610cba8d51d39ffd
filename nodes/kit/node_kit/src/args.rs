//! The ROS 2 command line: `--ros-args -r from:=to -p name:=value --params-file f --log-level info [--]`.

use std::path::PathBuf;

/// Why a command line is refused. The process then ends with [`crate::Exit::Usage`].
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct ArgsError(String);

/// One remap or parameter of the command line, `[node:]name:=value`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Assignment {
    /// The node it applies to; `None` for every node.
    pub node: Option<String>,
    /// Name of the parameter, or the old name of a remap: a topic, `__node` or `__ns`.
    pub name: String,
    /// Value of the parameter as YAML text, or the new name.
    pub value: String,
}

/// The ROS arguments of one process.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RosArgs {
    /// Remap rules in the order given.
    pub remaps: Vec<Assignment>,
    /// Parameters in the order given; a later one overrides an earlier one, and all override files.
    pub parameters: Vec<Assignment>,
    /// Parameter files in the order given; a later one overrides an earlier one.
    pub params_files: Vec<PathBuf>,
    /// The log level of this process's own lines.
    pub log_level: log::LevelFilter,
    /// Levels of single loggers, `--log-level ros2_client:=debug`; the logger is a Rust module path.
    pub logger_levels: Vec<(String, log::LevelFilter)>,
    /// True if log lines are published on `/rosout`.
    pub rosout: bool,
    /// True if log lines go to stderr.
    pub stderr: bool,
}

impl Default for RosArgs {
    fn default() -> Self {
        Self {
            remaps: Vec::new(),
            parameters: Vec::new(),
            params_files: Vec::new(),
            log_level: log::LevelFilter::Info,
            logger_levels: Vec::new(),
            rosout: true,
            stderr: true,
        }
    }
}

const REMAP_FORM: &str = "-r from:=to";
const PARAM_FORM: &str = "-p name:=value";

impl RosArgs {
    /// Splits a command line into its ROS arguments and everything else, in order.
    ///
    /// ROS arguments are those between `--ros-args` and `--` (or the end); both may occur several times.
    pub fn parse(args: &[String]) -> Result<(RosArgs, Vec<String>), ArgsError> {
        let mut ros = RosArgs::default();
        let mut plain = Vec::new();
        let mut inside = false;
        let mut rest = args.iter();
        while let Some(arg) = rest.next() {
            match (inside, arg.as_str()) {
                (_, "--ros-args") => inside = true,
                (true, "--") => inside = false,
                (true, option) => ros.take_option(option, &mut rest)?,
                (false, _) => plain.push(arg.clone()),
            }
        }
        Ok((ros, plain))
    }

    fn take_option<'a>(
        &mut self,
        option: &str,
        rest: &mut impl Iterator<Item = &'a String>,
    ) -> Result<(), ArgsError> {
        let mut value = |example: &'static str| {
            rest.next().cloned().ok_or_else(|| ArgsError(format!("{option} needs a value: {example}")))
        };
        match option {
            "-r" | "--remap" => {
                let rule = split_rule(option, &value(REMAP_FORM)?, REMAP_FORM)?;
                let name = rule.name.strip_prefix("rostopic://").unwrap_or(&rule.name).to_owned();
                self.remaps.push(Assignment { name, ..rule });
            }
            "-p" | "--param" => {
                self.parameters.push(split_rule(option, &value(PARAM_FORM)?, PARAM_FORM)?);
            }
            "--params-file" => self.params_files.push(value("--params-file run.yaml")?.into()),
            "--log-level" => {
                let text = value("--log-level info")?;
                match text.split_once(":=") {
                    Some((logger, level)) => self.logger_levels.push((logger.into(), parse_level(level)?)),
                    None => self.log_level = parse_level(&text)?,
                }
            }
            "--enable-rosout-logs" => self.rosout = true,
            "--disable-rosout-logs" => self.rosout = false,
            "--enable-stdout-logs" => self.stderr = true,
            "--disable-stdout-logs" => self.stderr = false,
            // Some launch tools always pass these; there is no external logger here.
            "--enable-external-lib-logs" | "--disable-external-lib-logs" => {}
            "-e" | "--enclave" => {
                let reason = "is not supported: DDS security is not built in; leave the option out";
                return Err(ArgsError(format!("{option} {reason}")));
            }
            "--log-config-file" => {
                let reason =
                    "is not supported: there is no configurable logger; use --log-level [logger:=]level";
                return Err(ArgsError(format!("{option} {reason}")));
            }
            unknown => {
                return Err(ArgsError(format!(
                    "unknown ROS argument {unknown:?}; known: -r, -p, --params-file, --log-level, \
                     --enable-/--disable-{{rosout,stdout}}-logs, and -- to end them"
                )));
            }
        }
        Ok(())
    }
}

/// Splits `[node:]left:=right`. A scheme such as `rostopic://` is not a node.
fn split_rule(option: &str, text: &str, example: &str) -> Result<Assignment, ArgsError> {
    let malformed = || ArgsError(format!("{option} {text:?} is not of the form {example}"));
    let (left, right) = text.split_once(":=").ok_or_else(malformed)?;
    let (node, name) = match left.split_once(':') {
        Some((node, name)) if !name.starts_with("//") => (Some(node), name),
        _ => (None, left),
    };
    if name.is_empty() || right.is_empty() || node == Some("") {
        return Err(malformed());
    }
    Ok(Assignment { node: node.map(Into::into), name: name.into(), value: right.into() })
}

/// Reads a ROS 2 severity; `fatal` is the facade's error level.
fn parse_level(text: &str) -> Result<log::LevelFilter, ArgsError> {
    match text.to_ascii_lowercase().as_str() {
        "trace" => Ok(log::LevelFilter::Trace),
        "debug" => Ok(log::LevelFilter::Debug),
        "info" => Ok(log::LevelFilter::Info),
        "warn" | "warning" => Ok(log::LevelFilter::Warn),
        "error" | "fatal" => Ok(log::LevelFilter::Error),
        _ => Err(ArgsError(format!(
            "log level {text:?} does not exist: use debug, info, warn, error or fatal"
        ))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(line: &str) -> Result<(RosArgs, Vec<String>), ArgsError> {
        let args: Vec<String> = line.split_whitespace().map(Into::into).collect();
        RosArgs::parse(&args)
    }

    #[test]
    fn ros_arguments_end_at_the_double_dash_and_may_come_twice() {
        let (ros, plain) = parse("run --ros-args -r a:=b -p x:=1 -- scene.toml --ros-args -p y:=2").unwrap();
        assert_eq!(plain, ["run", "scene.toml"]);
        assert_eq!(ros.parameters.iter().map(|p| p.name.as_str()).collect::<Vec<_>>(), ["x", "y"]);
        assert_eq!(ros.remaps, [Assignment { node: None, name: "a".into(), value: "b".into() }]);
    }

    #[test]
    fn node_prefixes_are_split_off_but_schemes_are_not() {
        let (ros, _) =
            parse("--ros-args -r dem:__ns:=/x -r rostopic://stress:=p -p servo:gain.xx:=3").unwrap();
        assert_eq!(
            ros.remaps[0],
            Assignment { node: Some("dem".into()), name: "__ns".into(), value: "/x".into() }
        );
        assert_eq!(ros.remaps[1], Assignment { node: None, name: "stress".into(), value: "p".into() });
        assert_eq!(ros.parameters[0].node.as_deref(), Some("servo"));
        assert_eq!(ros.parameters[0].name, "gain.xx");
    }

    #[test]
    fn a_value_may_hold_colons_and_equal_signs() {
        let (ros, _) = parse("--ros-args -p path:=a:=b:c").unwrap();
        assert_eq!((ros.parameters[0].name.as_str(), ros.parameters[0].value.as_str()), ("path", "a:=b:c"));
    }

    #[test]
    fn log_levels_are_read_for_all_and_for_single_loggers() {
        let (ros, _) =
            parse("--ros-args --log-level WARN --log-level ros2_client:=debug --disable-rosout-logs")
                .unwrap();
        assert_eq!(ros.log_level, log::LevelFilter::Warn);
        assert_eq!(ros.logger_levels, [("ros2_client".into(), log::LevelFilter::Debug)]);
        assert!(!ros.rosout && ros.stderr);
    }

    #[test]
    fn mistakes_are_refused_and_named() {
        for (line, needle) in [
            ("--ros-args -p dt", "\"dt\""),
            ("--ros-args -p", "needs a value"),
            ("--ros-args --dt 3", "\"--dt\""),
            ("--ros-args stress:=p", "\"stress:=p\""),
            ("--ros-args -r :=x", ":=x"),
            ("--ros-args --log-level loud", "\"loud\""),
            ("--ros-args -e /e", "security"),
        ] {
            let error = parse(line).expect_err(line).to_string();
            assert!(error.contains(needle), "{line}: {error}");
        }
    }
}
