//! The parameters of a node as ros2-client declares, checks and changes them.

use super::descriptor::{FIXED, descriptor, unknown};
use crate::parameters::{ParameterValue, Parameters, parameter_text};
use ros2_client::NodeOptions;
use ros2_client::parameters::raw::ParameterDescriptor;

/// The parameter that every ROS 2 node has.
pub(crate) const USE_SIM_TIME: &str = "use_sim_time";

impl Parameters {
    pub(crate) fn node_options(&self) -> NodeOptions {
        let [checks, sets] = [self.clone(), self.clone()];
        // `/rosout` is a topic of the bus, like all others; our own servers know descriptions and both service mappings.
        let options = NodeOptions::new().enable_rosout(false).start_parameter_services(false);
        let declare =
            |options: NodeOptions, (name, value): (&'static str, _)| options.declare_parameter(name, value);
        let declared = self.snapshot().into_iter().fold(options, declare);
        declared
            .parameter_validator(Box::new(move |name, value| checks.check(name, value)))
            .parameter_set_action(Box::new(move |name, value| {
                sets.change(name, value.clone());
                Ok(())
            }))
    }

    /// Checks that a parameter may take this value now; the error is the reason why not. The node checks its own initial values with it,
    /// too.
    fn check(&self, name: &str, value: &ParameterValue) -> Result<(), String> {
        let spec = self.spec(name).ok_or_else(|| format!("no parameter {name:?}"))?;
        if matches!(value, ParameterValue::NotSet | ParameterValue::ByteArray(_)) {
            return Err(format!(
                "{name} is declared and cannot be deleted, or the type is not one of its own"
            ));
        }
        if self.snapshot().get(name) == Some(value) {
            return Ok(());
        }
        if spec.read_only {
            return Err(format!("{name} is {FIXED}"));
        }
        if !spec.range.contains(value) {
            return Err(format!("{name} must be {}, not {}", spec.range, parameter_text(value)));
        }
        Ok(())
    }

    pub(crate) fn use_sim_time(&self) -> bool {
        self.snapshot().get(USE_SIM_TIME) == Some(&ParameterValue::Boolean(true))
    }

    pub(super) fn check_all<'a>(
        &self,
        values: impl IntoIterator<Item = (&'a str, ParameterValue)>,
    ) -> Result<(), String> {
        values.into_iter().try_for_each(|(name, value)| {
            let declared = self.spec(name).map(|spec| std::mem::discriminant(&spec.default));
            if declared.is_some_and(|declared| declared != std::mem::discriminant(&value)) {
                return Err(format!("{name} has another type"));
            }
            self.check(name, &value)
        })
    }

    /// The names, sorted.
    pub(super) fn names(&self) -> Vec<String> {
        self.snapshot().keys().map(|name| (*name).to_owned()).collect()
    }

    pub(super) fn describe(&self, names: &[String]) -> Vec<ParameterDescriptor> {
        names.iter().map(|name| self.spec(name).map_or_else(|| unknown(name), descriptor)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parameters::{ParameterSpec, Range};
    use ros2_client::ParameterValue as Ros;

    fn declared() -> Parameters {
        let specs = [
            ParameterSpec::new("scene", "demo", "scene"),
            ParameterSpec::new("wait", 0.1, "time, s").within(Range::Positive).changeable(),
        ];
        Parameters::defaults(&specs)
    }

    #[test]
    fn a_changeable_parameter_takes_values_of_its_range_and_the_node_sees_them() {
        let declared = declared();
        let its = declared.clone();
        assert_eq!(declared.check("wait", &Ros::Double(0.5)), Ok(()));
        declared.change("wait", Ros::Double(0.5));
        assert_eq!(its.get::<f64>("wait"), 0.5);
        let error = declared.check("wait", &Ros::Double(-1.0)).unwrap_err();
        assert!(error.contains("greater than 0"), "{error}");
    }

    #[test]
    fn what_is_fixed_unknown_or_deleted_is_refused_with_the_reason() {
        let declared = declared();
        for (name, value, needle) in [
            ("scene", Ros::String("s1".into()), "read-only"),
            ("scenes", Ros::String("s1".into()), "no parameter"),
            ("wait", Ros::NotSet, "deleted"),
        ] {
            let error = declared.check(name, &value).unwrap_err();
            assert!(error.contains(needle), "{error}");
        }
        assert_eq!(declared.check("scene", &Ros::String("demo".into())), Ok(()), "no change is no error");
        let both = [("wait", Ros::Double(2.0)), ("scene", Ros::String("s1".into()))];
        assert!(declared.check_all(both).is_err());
        assert!(declared.check_all([("wait", Ros::Integer(2))]).unwrap_err().contains("type"));
    }
}
